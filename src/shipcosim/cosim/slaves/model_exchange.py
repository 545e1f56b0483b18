"""FMUs for model exchange behind the calls of a co-simulation slave: CVode integrates them, events are found in time.

A step of the master is integrated in steps that CVode chooses. State events end such a step where an event indicator
is zero, time events where the FMU has said; after every step the FMU may ask for an event of its own. Inputs are held
over a step of the master. One that has changed is handed over in event mode, since it jumps.

Reference: FMI 2.0.4 and FMI 3.0.1, section 3 of each.
"""

from collections.abc import Callable, Sequence
from ctypes import POINTER, byref, c_bool, c_double, c_int, c_size_t
from math import inf
from typing import NamedTuple

import numpy as np

from shipcosim.cosim.slaves.fmi2 import DISCARD, OK, Slave2, SlaveError
from shipcosim.cosim.slaves.fmi3 import Slave3
from shipcosim.ssp import FmuDescription
from shipcosim.ssp.xml.document import is_true

TOLERANCE = 1e-8
"""Relative tolerance of the solver in each of its steps, where the default experiment of the FMU has none."""
MOST_UPDATES = 1000
MOST_EVENTS = 10_000
"""Largest number of updates in one event, and of events in one step of the master."""
MOST_STATES = 5000
"""Largest number of continuous states, whose Jacobian is dense."""
CLOSE = 1e-12
"""Times that differ by less than this part of them are the same."""
EVENT, CONTINUOUS = "event mode", "continuous-time mode"


class Update(NamedTuple):
    """What an FMU says after an update of its discrete states."""

    again: bool
    ends: bool
    next_event: float


class ModelExchange:
    """What slaves of all versions of FMI share; comes before the version's own slave among the bases.

    Parameters
    ----------
    name : str
        Name of the component.
    folder : path
        Where the FMU is unpacked.
    fmu : FmuDescription
        Its description.
    """

    DERIVATIVES, NOMINALS = "GetDerivatives", "GetNominalsOfContinuousStates"

    def __init__(self, name, folder, fmu: FmuDescription):
        self._description = fmu
        self._traits = fmu.interfaces["ModelExchange"]
        self._mode = self._solver = None
        super().__init__(name, folder, fmu.identifier("ModelExchange"), fmu.token)

    def setter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that sets variables of one kind from a buffer where they have changed; returns the status."""
        set_all, last = super().setter(kind, variables, buffer), None

        def set_changed():
            nonlocal last
            values = buffer.tobytes()
            if values == last:
                return OK
            if self._mode == CONTINUOUS:
                self._enter_event_mode()
            self._is_settled, last = False, values
            return set_all()

        return set_changed

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances from a time by a step size; what fails raises SlaveError."""
        from shipcosim.cosim.slaves.cvode import SolverError

        def step(time, step_size):
            try:
                self._advance(time, time + step_size)
            except SolverError as error:
                raise SlaveError(f"{self.last_words()} {error} At t = {self._time:.9g} s.".strip()) from None
            return OK

        return step

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode and settle the discrete states."""
        from shipcosim.cosim.slaves.cvode import Cvode

        self._leave_initialisation()
        self._n, self._n_indicators = self._sizes()
        if self._n > MOST_STATES:
            raise SlaveError(f"It has {self._n} continuous states; at most {MOST_STATES} are integrated.")
        tolerance = self._description.experiment.get("tolerance", TOLERANCE)
        self._close_solver()
        self._solver = Cvode(self._n, self._derivatives, self._n_indicators, self._indicators, tolerance)
        self._states = self._solver.states.ctypes.data_as(POINTER(c_double))
        self._settle()

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made."""
        self._close_solver()
        self._mode = None
        super().reset()

    def free(self) -> None:
        """Free the solver, the instance and its library."""
        self._close_solver()
        super().free()

    def _close_solver(self):
        if self._solver is not None:
            self._solver.close()
            self._solver = None

    def _advance(self, time, end):
        """Integrate to a time, through all events on the way."""
        near, n_events = CLOSE * max(abs(end), end - time), 0
        if self._mode == EVENT:
            self._time = time
            self._go_on()
        while True:
            if self._next_event > self._time + near:
                if self._time >= end - near:
                    return
                if not self._integrate(min(end, self._next_event), near):
                    continue
            self._enter_event_mode()
            self._settle()
            self._go_on()
            n_events += 1
            if n_events > MOST_EVENTS:
                raise SlaveError(f"It had more than {MOST_EVENTS} events until t = {self._time:.9g} s.")

    def _integrate(self, stop, near):
        """Make one step of the solver; whether there is a state or step event where it ends."""
        reached, has_root = self._solver.step(stop)
        self._time = stop if abs(reached - stop) <= near else reached
        self._move(self._time, self._states)
        return self._completed_step() or has_root

    def _settle(self):
        """Update the discrete states until they no longer change."""
        for _ in range(MOST_UPDATES):
            again, ends, self._next_event = self._update_discrete_states()
            if ends:
                raise SlaveError("It asks to end the simulation.")
            if not again:
                self._is_settled = True
                return
        raise SlaveError(f"An event does not settle: discrete states still change after {MOST_UPDATES} updates.")

    def _go_on(self):
        """Continue in continuous time, from the states and nominal values that the FMU now has."""
        if not self._is_settled:
            self._settle()
        self._leave_event_mode()
        nominals = np.ones(self._n)
        if self._n:
            self.call("GetContinuousStates", self._states, self._n)
            self.call(self.NOMINALS, nominals.ctypes.data_as(POINTER(c_double)), self._n)
        self._solver.start(self._time, nominals)

    def _enter_event_mode(self):
        self.call("EnterEventMode")
        self._mode = EVENT

    def _leave_event_mode(self):
        self.call("EnterContinuousTimeMode")
        self._mode = CONTINUOUS

    def _leave_initialisation(self):
        self.call("ExitInitializationMode")
        self._mode = EVENT

    def _derivatives(self, time, states, derivatives):
        self._move(time, states)
        return self._evaluated(self.DERIVATIVES, derivatives, self._n)

    def _indicators(self, time, states, values):
        self._move(time, states)
        return self._evaluated("GetEventIndicators", values, self._n_indicators)

    def _move(self, time, states):
        self.call("SetTime", time)
        if self._n:
            self.call("SetContinuousStates", states, self._n)

    def _evaluated(self, function, values, n):
        """Status for the solver: where an FMU discards, a smaller step is tried."""
        from shipcosim.cosim.slaves.cvode import RECOVERABLE

        status = self._function(function)(self.component, values, n)
        if status == DISCARD:
            return RECOVERABLE
        self.check(function, status)
        return 0


class Model2(ModelExchange, Slave2):
    """An instance of an FMU of FMI 2.0 for model exchange."""

    @staticmethod
    def _load(**arguments):
        from fmpy.fmi2 import FMU2Model

        return FMU2Model(**arguments)

    def _sizes(self):
        return self._description.n_states, self._description.n_event_indicators

    def _completed_step(self):
        if is_true(self._traits.get("completedIntegratorStepNotNeeded")):
            return False
        event, ends = c_int(), c_int()
        self.call("CompletedIntegratorStep", 1, byref(event), byref(ends))
        if ends.value:
            raise SlaveError("It asks to end the simulation.")
        return event.value != 0

    def _update_discrete_states(self):
        from fmpy.fmi2 import fmi2EventInfo

        info = fmi2EventInfo()
        self.call("NewDiscreteStates", byref(info))
        next_event = info.nextEventTime if info.nextEventTimeDefined else inf
        return Update(info.newDiscreteStatesNeeded != 0, info.terminateSimulation != 0, next_event)


class Model3(ModelExchange, Slave3):
    """An instance of an FMU of FMI 3.0 for model exchange."""

    DERIVATIVES = "GetContinuousStateDerivatives"

    @staticmethod
    def _load(**arguments):
        from fmpy.fmi3 import FMU3Model

        return FMU3Model(**arguments)

    def _sizes(self):
        sizes = c_size_t(), c_size_t()
        for function, size in zip(("GetNumberOfContinuousStates", "GetNumberOfEventIndicators"), sizes, strict=True):
            self.call(function, byref(size))
        return tuple(size.value for size in sizes)

    def _completed_step(self):
        if not is_true(self._traits.get("needsCompletedIntegratorStep")):
            return False
        event, ends = c_bool(), c_bool()
        self.call("CompletedIntegratorStep", True, byref(event), byref(ends))
        if ends.value:
            raise SlaveError("It asks to end the simulation.")
        return event.value

    def _update_discrete_states(self):
        again, ends, nominals, values, defined, time = *(c_bool() for _ in range(5)), c_double()
        self.call("UpdateDiscreteStates", *map(byref, (again, ends, nominals, values, defined, time)))
        return Update(again.value, ends.value, time.value if defined.value else inf)
