"""Model-exchange components that are connected and integrated as one system of equations.

One solver has the states of all of them. Whenever it asks for derivatives, what they put out is carried to the inputs
that it feeds, so that nothing is held over a step of the master. Inputs from outside the group are held, as any others.

It takes components whose continuous inputs are joined directly or by factors and offsets, that have no event
indicators and step with the base step. An FMU's time and step events are made where they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import POINTER, c_double
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.slaves.model_exchange import (
    CLOSE,
    EVENT,
    MOST_EVENTS,
    TOLERANCE,
    ModelExchange,
)
from shipcosim.cosim.slaves.slave import OK, SlaveError, Step
from shipcosim.ssp import Variable

if TYPE_CHECKING:
    from shipcosim.cosim.slaves.cvode import Cvode

MOST_SWEEPS = 100
"""Sweeps over the group in which its outputs have to agree with its inputs."""
SAME = 1e-13
"""Relative change of an input below which it has settled."""


@dataclass(frozen=True)
class Wire:
    """A connection within a group: ``input = factor * output + offset``; ends are (component, variable)."""

    source: tuple[str, Variable]
    target: tuple[str, Variable]
    factor: float = 1.0
    offset: float = 0.0


class CoupledModels:
    """A group of components with one solver.

    Parameters
    ----------
    members : mapping of str to ModelExchange
        By name, in the order in which they step; initialised when the first step is made.
    wires : sequence of Wire
        All connections between them.
    """

    # The members' states lie in sequence in the solver's vector, a slice for each.
    def __init__(self, members: Mapping[str, ModelExchange], wires: Sequence[Wire]):
        self._members = dict(members)
        self._wires = list(wires)
        self._solver: Cvode | None = None
        self._slices: dict[str, slice] = {}
        self._ends = [self._prepared(name) for name in self._members]
        self._factor = np.array([wire.factor for wire in self._wires])
        self._offset = np.array([wire.offset for wire in self._wires])
        # NaN differs from every value, so the first sweep sets all inputs.
        self._put_out, self._fed = np.zeros(len(self._wires)), np.full(len(self._wires), np.nan)

    def _prepared(self, name: str) -> tuple[ModelExchange, np.ndarray, tuple, np.ndarray, tuple]:
        """A member, its connections out and in, and the calls that get and set their values."""
        slave = self._members[name]
        sources = np.array(
            [i for i, wire in enumerate(self._wires) if wire.source[0] == name], dtype=int
        )
        targets = np.array(
            [i for i, wire in enumerate(self._wires) if wire.target[0] == name], dtype=int
        )
        got = np.zeros(len(sources))
        given = np.zeros(len(targets))
        getter = (
            slave.getter("Real", [self._wires[i].source[1] for i in sources], got)
            if len(sources)
            else None
        )
        setter = (
            slave.plain_setter("Real", [self._wires[i].target[1] for i in targets], given)
            if len(targets)
            else None
        )
        return slave, sources, (getter, got), targets, (setter, given)

    def stepper(self) -> Step:
        """Prepared call that advances the whole group from a time by a step size."""
        from shipcosim.cosim.slaves.cvode import SolverError

        def step(time, step_size):
            try:
                self._integrate(time, time + step_size)
            # Name all members: the solver cannot tell whose equations failed.
            except SolverError as error:
                names = ", ".join(self._members)
                raise SlaveError(f"{names}, integrated together: {error}") from None
            return OK

        return step

    def close(self) -> None:
        """Free the solver."""
        if self._solver is not None:
            self._solver.close()
            self._solver = None

    def _start_solver(self) -> Cvode:
        from shipcosim.cosim.slaves.cvode import Cvode

        # The slices follow the order of the members.
        first = 0
        for name, slave in self._members.items():
            # A group sees no events of state; its members were chosen by what their descriptions list.
            if slave.n_indicators:
                raise SlaveError(
                    f"{name} has {slave.n_indicators} event indicators that its modelDescription.xml does not list. "
                    "Add an EventIndicator for each to its ModelStructure."
                )
            self._slices[name] = slice(first, first + slave.n_states)
            first += slave.n_states
        # The strictest member decides the tolerance of the common solver.
        tolerance = min(slave.tolerance for slave in self._members.values())
        self._solver = Cvode(first, self._derivatives, 0, lambda *_: 0, min(tolerance, TOLERANCE))
        self._n = first
        return self._solver

    def _integrate(self, time, end):
        """Integrate to a time, through time and step events of the members."""
        solver = self._solver or self._start_solver()
        # Times closer than rounding are the same time.
        near = CLOSE * max(abs(end), end - time)
        n_events = 0
        now = time
        # After the start or a changed input, members are in event mode: continue from their new
        # states.
        if any(slave.mode == EVENT for slave in self._members.values()):
            self._enter_continuous_time(solver, now)
        while now < end - near:
            # The solver must not step over the next time event of any member.
            stop = min(end, *(slave.next_event for slave in self._members.values()))
            if stop > now + near:
                reached, _ = solver.step(stop)
                # Snap to the stop time, so that times do not drift by rounding.
                now = stop if abs(reached - stop) <= near else reached
                # The solver's last evaluation may lie elsewhere; bring members to the point that
                # was reached.
                self._derivatives(now, solver.states.ctypes.data_as(POINTER(c_double)), None)
            # Members with a step event or a time event due now.
            due = [
                slave
                for slave in self._members.values()
                if slave.completed_step() or slave.next_event <= now + near
            ]
            if due:
                for slave in due:
                    slave.handle_event(now)
                # An event may change states: all members go on together from the new ones.
                self._enter_continuous_time(solver, now)
                n_events += 1
            # Too many events in one step: a model that switches back and forth (chattering).
            if n_events > MOST_EVENTS:
                raise SlaveError(
                    f"Together they had more than {MOST_EVENTS} events until t = {now:.9g} s."
                )

    def _enter_continuous_time(self, solver: Cvode, time: float) -> None:
        """Continue in continuous time, from the present states of the members."""
        nominals = np.ones(self._n)
        for name, slave in self._members.items():
            part = self._slices[name]
            slave.enter_continuous(time, solver.states[part], nominals[part])
        # Inputs follow the outputs before the solver starts, or its first derivatives would be
        # wrong.
        self._settle()
        solver.start(time, nominals)

    def _derivatives(self, time, states, derivatives):
        """Derivatives of all states; without `derivatives` only set time, states and inputs."""
        # Each member gets its slice of the state vector.
        every = np.ctypeslib.as_array(states, (self._n,)) if self._n else np.empty(0)
        for name, slave in self._members.items():
            slave.set_time_and_states(time, np.ascontiguousarray(every[self._slices[name]]))
        # Then outputs are carried to inputs, so that no value is older than the states.
        self._settle()
        if derivatives is None or not self._n:
            return 0
        # Collect dx/dt member by member.
        rates = np.ctypeslib.as_array(derivatives, (self._n,))
        for name, slave in self._members.items():
            of_slave = np.zeros(slave.n_states)
            if status := slave.derivatives_into(of_slave):
                return status
            rates[self._slices[name]] = of_slave
        return 0

    def _settle(self):
        """Carry outputs to inputs until they agree."""
        # Fixed-point iteration. A chain without direct feedthrough settles at once; an algebraic
        # loop needs more sweeps.
        settled = np.zeros(len(self._wires), dtype=bool)
        for _ in range(MOST_SWEEPS):
            for slave, sources, (get, got), _targets, _set in self._ends:
                if get is not None:
                    slave.checked("GetReal", get())
                    self._put_out[sources] = got
            # Relative change below SAME is rounding.
            wanted = self._factor * self._put_out + self._offset
            settled = np.abs(wanted - self._fed) <= SAME * np.maximum(
                np.abs(wanted), np.abs(self._fed)
            )
            if settled.all():
                return
            self._fed = wanted
            for slave, _sources, _get, targets, (put, given) in self._ends:
                if put is not None:
                    given[:] = wanted[targets]
                    slave.checked("SetReal", put())
        inputs = ", ".join(
            f"{self._wires[i].target[0]}.{self._wires[i].target[1].name}"
            for i in np.flatnonzero(~settled)
        )
        raise SlaveError(
            f"An algebraic loop does not settle: {inputs} still change after {MOST_SWEEPS} sweeps."
        )
