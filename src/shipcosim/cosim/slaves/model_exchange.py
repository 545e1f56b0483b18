"""FMUs for model exchange behind the calls of a co-simulation slave; CVode integrates them.

A step of the master is integrated in steps that CVode chooses. State events end such a step just past a zero of an
event indicator, time events where the FMU announced them; after every step the FMU may ask for
an event of its own. Inputs are held over a step of the master. One that has changed is handed over in event mode, since
it jumps.

Reference: FMI 2.0.4 and FMI 3.0.1, section 3 of each.
"""

from __future__ import annotations

from collections.abc import Callable
from ctypes import POINTER, byref, c_bool, c_double, c_int, c_size_t
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shipcosim.cosim.slaves.event_indicators import EventIndicators
from shipcosim.cosim.slaves.fmi2 import Slave2
from shipcosim.cosim.slaves.fmi3 import Slave3
from shipcosim.cosim.slaves.library_slave import LibrarySlave
from shipcosim.cosim.slaves.slave import DISCARD, OK, Call, RunEnded, SlaveError, Step, Variables
from shipcosim.ssp import FmuDescription
from shipcosim.ssp.xml.document import is_true

if TYPE_CHECKING:
    from shipcosim.cosim.slaves.cvode import Cvode

TOLERANCE = 1e-8
"""Relative tolerance of the solver in each of its steps, where the default experiment of the FMU has none."""
MOST_ITERATIONS = 1000
MOST_EVENTS = 10_000
"""Largest number of updates in one event, and of events in one step of the master."""
MOST_STATES = 5000
"""Largest number of continuous states, whose Jacobian is dense."""
CLOSE = 1e-12
"""Times that differ by less than this part of them are the same."""
SHORTEST_LOOKED_INTO = 1e4
"""So many of those differences a solver's step is long at least in which an indicator may pass zero and come back."""
FARTHEST_PAST = 1e-6
"""Part of a step of the master by which a zero of an event indicator is passed at most to see its sign."""
MOST_EVENTS_AT_ONCE = 100
SHORTEST_TIME = 1e-6
"""So many events within this part of a step of the master are chattering."""
EVENT = "event mode"
CONTINUOUS = "continuous-time mode"


class EventUpdate(NamedTuple):
    """The FMU's answer to an update of its discrete states.

    Parameters
    ----------
    needs_update : bool
        Whether the discrete states have to be updated once more.
    terminates : bool
        Whether the FMU asks to end the simulation.
    next_event : float
        Time of its next event; infinite where it knows none. [s]
    """

    needs_update: bool
    terminates: bool
    next_event: float


class ModelExchange(LibrarySlave):
    """Parts that model-exchange slaves of all FMI versions share; the first of their bases.

    Parameters
    ----------
    name : str
        Name of the component.
    folder : path
        Where the FMU is unpacked.
    fmu : FmuDescription
        Its description.

    Attributes
    ----------
    followed : frozenset of (kind, name)
        Inputs that follow other components within a step, as `shipcosim.cosim.slaves.coupled` carries them over.
    close_group : callable or None
        Frees the solver of the group that this one makes the steps of; called when this one is freed.
    tolerance : float
        Relative tolerance of the solver that its default experiment asks for.
    mode : str or None
        Event mode, continuous-time mode, or None before the end of the initialisation.
    next_event : float
        Time of its next event; infinite where it knows none. [s]
    n_states, n_indicators : int
        Numbers of continuous states and of event indicators; known from the end of the initialisation on.
    """

    _form = "Model"
    DERIVATIVES = "GetDerivatives"
    NOMINALS = "GetNominalsOfContinuousStates"

    def __init__(self, name: str, folder: Path, fmu: FmuDescription):
        self._description = fmu
        self._capabilities = fmu.interfaces["ModelExchange"]
        self.tolerance = fmu.experiment.get("tolerance", TOLERANCE)
        self.mode: str | None = None
        self._solver: Cvode | None = None
        self.next_event = inf
        self._is_event_done = False
        self.followed: frozenset[tuple[str, str]] = frozenset()
        self.close_group: Callable[[], None] | None = None
        super().__init__(name, folder, fmu.identifier("ModelExchange"), fmu.token)

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind where they changed; returns the status."""
        set_all = super().setter(kind, variables, buffer)
        last = None
        last_held = None
        # Inputs that a common solver carries change continuously; only held inputs jump.
        held = np.array([(kind, variable.name) not in self.followed for variable in variables])

        def set_changed():
            nonlocal last, last_held
            values = buffer.tobytes()
            held_values = values if held.all() else buffer[held].tobytes()
            # Unchanged inputs need no call. Changes of followed inputs alone need no event either.
            if values == last or (self.mode == CONTINUOUS and held_values == last_held):
                return OK
            # A jump of an input is an event: FMI allows discontinuities only in event mode.
            if self.mode == CONTINUOUS:
                self._enter_event_mode()
            self._is_event_done = False
            last = values
            last_held = held_values
            return set_all()

        return set_changed

    def stepper(self) -> Step:
        """Prepared call that advances from a time by a step size; what fails raises SlaveError."""
        from shipcosim.cosim.slaves.cvode import SolverError

        def step(time, step_size):
            try:
                self._integrate_to(time, time + step_size)
            except SolverError as error:
                raise SlaveError(
                    f"{self.last_messages()} {error} At t = {self._time:.9g} s.".strip()
                ) from None
            return OK

        return step

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode and settle the discrete states."""
        from shipcosim.cosim.slaves.cvode import Cvode

        # Number of states and indicators may depend on parameters, so ask now.
        self._leave_initialisation()
        self.n_states, self.n_indicators = self._sizes()
        if self.n_states > MOST_STATES:
            raise SlaveError(
                f"It has {self.n_states} continuous states; at most {MOST_STATES} are integrated."
            )
        self._close_solver()
        self._solver = solver = Cvode(
            self.n_states, self._derivatives, self.n_indicators, self._indicators, self.tolerance
        )
        self._states = solver.states.ctypes.data_as(POINTER(c_double))
        self._events = EventIndicators(self.n_indicators, self._indicator_getter)
        # Discrete states must settle before continuous time begins (FMI, event iteration).
        self._iterate_event()

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made."""
        self._close_solver()
        self.mode = None
        super().reset()

    def free(self) -> None:
        """Free the solver, the instance and its library."""
        self._close_solver()
        super().free()

    # ------------------------------------------------------- what a group with one solver needs

    def plain_setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind without an event."""
        return super().setter(kind, variables, buffer)

    def checked(self, function: str, status: int) -> None:
        """Raise SlaveError if a status says that a prepared call failed."""
        if status >= DISCARD:
            self.check(function, status)

    def set_time_and_states(self, time: float, states: np.ndarray) -> None:
        """Set the time and the continuous states, (n_states,) array."""
        self._time = time
        self._set_time_and_states(time, states.ctypes.data_as(POINTER(c_double)))

    def derivatives_into(self, derivatives: np.ndarray) -> int:
        """Get the derivatives into an (n_states,) array; return the solver's status."""
        if not self.n_states:
            return 0
        return self._status_for_solver(
            self.DERIVATIVES, derivatives.ctypes.data_as(POINTER(c_double)), self.n_states
        )

    def handle_event(self, time: float) -> None:
        """Handle the event that is due, and stay in event mode."""
        self._time = time
        self._enter_event_mode()
        self._iterate_event()

    def enter_continuous(self, time: float, states: np.ndarray, nominals: np.ndarray) -> None:
        """Enter continuous time at a time; fill states and nominal values, (n_states,) arrays."""
        self._time = time
        # After a changed input the event iteration is still due.
        if self.mode == EVENT:
            if not self._is_event_done:
                self._iterate_event()
            self._leave_event_mode()
        # An event may have changed the states: read them back.
        if self.n_states:
            self.call(
                "GetContinuousStates", states.ctypes.data_as(POINTER(c_double)), self.n_states
            )
            self.call(self.NOMINALS, nominals.ctypes.data_as(POINTER(c_double)), self.n_states)
            usable = np.isfinite(nominals) & (nominals != 0.0)
            if not usable.all():
                number = int(usable.argmin())
                raise SlaveError(
                    f"The nominal value of its continuous state {number + 1} is {nominals[number]:g}. "
                    "It has to be a positive number."
                )

    def _close_solver(self):
        if self.close_group is not None:
            self.close_group()
            self.close_group = None
        if self._solver is not None:
            self._solver.close()
            self._solver = None

    def _integrate_to(self, time, end):
        """Integrate to a time, through all events on the way."""
        # Times closer than rounding are the same time.
        near = CLOSE * max(abs(end), end - time)
        farthest = FARTHEST_PAST * (end - time)
        n_events = 0
        counted_from = time
        # Inputs set since the last step have put the FMU into event mode.
        if self.mode == EVENT:
            self._time = time
            self._enter_continuous_time()
        while True:
            # A time event may be due at once, also at the end of the step.
            if self.next_event > self._time + near:
                if self._time >= end - near:
                    return
                stop = min(end, self.next_event)
                # An indicator that is zero now has its sign a little later.
                if self._events.may_be_zero:
                    is_event = self._pass_zero(min(self._time + farthest, stop))
                else:
                    is_event = self._solver_step(stop, near)
                if not is_event:
                    continue
            # An event: iterate the discrete states, then restart the solver from the new states.
            self._enter_event_mode()
            self._iterate_event()
            self._enter_continuous_time()
            n_events += 1
            # Too many events in one step: the model switches back and forth (chattering).
            if n_events > MOST_EVENTS:
                raise SlaveError(
                    f"It had more than {MOST_EVENTS} events until t = {self._time:.9g} s."
                )
            if n_events % MOST_EVENTS_AT_ONCE == 0:
                if self._time - counted_from <= SHORTEST_TIME * (end - time):
                    remedy = "It needs a hysteresis, or a state in which it slides or rests."
                    if self.next_event <= self._time + near:
                        remedy = f"It announces one for t = {self.next_event:.9g} s; the next has to lie ahead."
                    raise SlaveError(
                        f"It chatters at t = {self._time:.9g} s: {MOST_EVENTS_AT_ONCE} events within "
                        f"{self._time - counted_from:.1g} s, each of which causes the next. {remedy}"
                    )
                counted_from = self._time

    def _solver_step(self, stop, near):
        """Make one step of the solver, at most to a time; true if there is an event where it ends."""
        assert self._solver is not None  # since the initialisation
        before = self._solver.states.copy()
        reached, has_root = self._solver.step(stop)
        # The solver sees an indicator only at the ends of its steps. One that has passed zero and come back since has
        # two events in between: make the step again, up to a time between them.
        # In the shortest steps, just past an event, rounding decides the sign.
        between = None
        if reached - self._time > SHORTEST_LOOKED_INTO * near:
            between = self._events.change_within(self._time, reached, self._go_back_to)
        if between is not None:
            self._solver.states[:] = before
            self._solver.start(self._time, self._nominals)
            return self._solver_step(between, near)
        # Snap to the stop time, so that the master's time and the FMU's are equal.
        self._time = stop if abs(reached - stop) <= near else reached
        # The FMU's last evaluation may lie elsewhere, at a trial point of the solver.
        self._set_time_and_states(self._time, self._states)
        # Step event: the FMU asks for one. State event: an indicator has changed its sign.
        if self.completed_step() or self._events.has_changed():
            return True
        # A root is often exactly zero. FMUs that compare with < and > see no change there.
        self._events.may_be_zero = has_root
        return has_root and self._time == stop and self._events.has_come_to_zero()

    def _pass_zero(self, farthest):
        """Go past a zero of an indicator, at most to a time; true if there is an event.

        The states go on along their derivatives, over a time that doubles until a sign changes. Where none does, the
        indicator touches zero or stays there: then nothing moves.
        """
        assert self._solver is not None  # since the initialisation
        self._events.may_be_zero = False
        start = self._time
        states = np.ctypeslib.as_array(self._states, (max(self.n_states, 1),))
        before = states.copy()
        rates = np.zeros(max(self.n_states, 1))
        self.derivatives_into(rates)
        # The first try is a few roundings of the time long.
        past = 2 * np.spacing(max(abs(start), farthest - start))
        while past < farthest - start:
            past = min(2 * past, farthest - start)
            self._time = start + past
            states[:] = before + past * rates
            self._set_time_and_states(self._time, self._states)
            if self._events.has_changed():
                return True
        stays = (self._events.signs() == 0.0).any()
        self._time = start
        states[:] = before
        self._set_time_and_states(start, self._states)
        # From a new start the solver leaves out an indicator that stays at zero; else it would refuse to go on.
        if stays:
            self._solver.start(start, self._nominals)
        return self._events.has_come_to_zero()

    def _go_back_to(self, time):
        assert self._solver is not None  # since the initialisation
        self._set_time_and_states(time, self._solver.states_at(time))

    def _indicator_getter(self, values):
        """Prepared call that fills an (n_indicators,) array with the event indicators of now."""
        function, component = self._function("GetEventIndicators"), self.component
        pointer, n = values.ctypes.data_as(POINTER(c_double)), self.n_indicators

        def get():
            self.check("GetEventIndicators", function(component, pointer, n))

        return get

    def _iterate_event(self):
        """Event iteration: update the discrete states until they no longer change."""
        for _ in range(MOST_ITERATIONS):
            before = self._events.signs()
            needs_update, terminates, self.next_event = self._update_discrete_states()
            if terminates:
                raise RunEnded
            # What the update changed may have moved another indicator past zero: that is the next event, of the same time.
            if not needs_update and not self._events.has_followed(before):
                self._is_event_done = True
                return
        raise SlaveError(
            f"An event does not settle: discrete states still change after {MOST_ITERATIONS} updates."
        )

    def _enter_continuous_time(self):
        """Continue in continuous time, from the FMU's present states and nominal values."""
        assert self._solver is not None  # since the initialisation
        self._nominals = np.ones(self.n_states)
        self.enter_continuous(self._time, self._solver.states, self._nominals)
        # A zero gets its sign when time goes on.
        self._events.keep()
        self._solver.start(self._time, self._nominals)

    def _enter_event_mode(self):
        self.call("EnterEventMode")
        self.mode = EVENT

    def _leave_event_mode(self):
        self.call("EnterContinuousTimeMode")
        self.mode = CONTINUOUS

    def _leave_initialisation(self):
        self.call("ExitInitializationMode")
        self.mode = EVENT

    def _sizes(self) -> tuple[int, int]:
        """Numbers of continuous states and of event indicators."""
        return self._description.n_states, self._description.n_event_indicators

    def completed_step(self) -> bool:
        """Tell the FMU that a solver step is done; true if it asks for an event."""
        raise NotImplementedError

    def _update_discrete_states(self) -> EventUpdate:
        raise NotImplementedError

    def _derivatives(self, time, states, derivatives):
        self._set_time_and_states(time, states)
        return self._status_for_solver(self.DERIVATIVES, derivatives, self.n_states)

    def _indicators(self, time, states, values):
        self._set_time_and_states(time, states)
        return self._status_for_solver("GetEventIndicators", values, self.n_indicators)

    def _set_time_and_states(self, time, states):
        self.call("SetTime", time)
        if self.n_states:
            self.call("SetContinuousStates", states, self.n_states)

    def _status_for_solver(self, function, values, n):
        """Status for the solver: if the FMU discards, the solver tries a smaller step."""
        from shipcosim.cosim.slaves.cvode import RECOVERABLE

        status = self._function(function)(self.component, values, n)
        if status == DISCARD:
            return RECOVERABLE
        self.check(function, status)
        return 0


class Model2(ModelExchange, Slave2):
    """An instance of an FMU of FMI 2.0 for model exchange."""

    def completed_step(self):
        if is_true(self._capabilities.get("completedIntegratorStepNotNeeded")):
            return False
        event = c_int()
        terminates = c_int()
        self.call("CompletedIntegratorStep", 1, byref(event), byref(terminates))
        if terminates.value:
            raise RunEnded
        return event.value != 0

    def _update_discrete_states(self):
        from fmpy.fmi2 import fmi2EventInfo

        info = fmi2EventInfo()
        self.call("NewDiscreteStates", byref(info))
        next_event = info.nextEventTime if info.nextEventTimeDefined else inf
        return EventUpdate(
            info.newDiscreteStatesNeeded != 0, info.terminateSimulation != 0, next_event
        )


class Model3(ModelExchange, Slave3):
    """An instance of an FMU of FMI 3.0 for model exchange."""

    DERIVATIVES = "GetContinuousStateDerivatives"

    def _sizes(self):
        sizes = c_size_t(), c_size_t()
        for function, size in zip(
            ("GetNumberOfContinuousStates", "GetNumberOfEventIndicators"), sizes, strict=True
        ):
            self.call(function, byref(size))
        return sizes[0].value, sizes[1].value

    def completed_step(self):
        if not is_true(self._capabilities.get("needsCompletedIntegratorStep")):
            return False
        event = c_bool()
        terminates = c_bool()
        self.call("CompletedIntegratorStep", True, byref(event), byref(terminates))
        if terminates.value:
            raise RunEnded
        return event.value

    def _update_discrete_states(self):
        needed, terminates, nominals, values, defined, time = (
            *(c_bool() for _ in range(5)),
            c_double(),
        )
        self.call(
            "UpdateDiscreteStates",
            *map(byref, (needed, terminates, nominals, values, defined, time)),
        )
        return EventUpdate(needed.value, terminates.value, time.value if defined.value else inf)
