"""Components in model exchange that are wired together, integrated as one system of equations.

One solver has the states of all of them. Whenever it asks for derivatives, what they put out is carried to the inputs
that it feeds, so that nothing is held over a step of the master. Inputs from outside the group are held, as any others.

It takes components whose continuous inputs are joined directly or by factors and offsets, that have no event
indicators and step with the base step. An FMU's time and step events are made where they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
from shipcosim.cosim.slaves.slave import OK, SlaveError
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

    def __init__(self, members: Mapping[str, ModelExchange], wires: Sequence[Wire]):
        self._members = dict(members)
        self._wires = list(wires)
        self._solver: Cvode | None = None
        self._slices: dict[str, slice] = {}
        self._ends = [self._prepared(name) for name in self._members]
        self._factor = np.array([wire.factor for wire in self._wires])
        self._offset = np.array([wire.offset for wire in self._wires])
        self._put_out, self._fed = np.zeros(len(self._wires)), np.full(len(self._wires), np.nan)

    def _prepared(self, name: str) -> tuple[ModelExchange, np.ndarray, tuple, np.ndarray, tuple]:
        """A member with the rows of the wires from it and into it, and the calls that get and set them."""
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

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances the whole group from a time by a step size."""
        from shipcosim.cosim.slaves.cvode import SolverError

        def step(time, step_size):
            try:
                self._integrate(time, time + step_size)
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

        first = 0
        for name, slave in self._members.items():
            self._slices[name] = slice(first, first + slave.n_states)
            first += slave.n_states
        tolerance = min(slave.tolerance for slave in self._members.values())
        self._solver = Cvode(first, self._derivatives, 0, lambda *_: 0, min(tolerance, TOLERANCE))
        self._n = first
        return self._solver

    def _integrate(self, time, end):
        """Integrate to a time, through time and step events of the members."""
        solver = self._solver or self._start_solver()
        near = CLOSE * max(abs(end), end - time)
        n_events = 0
        now = time
        if any(slave.mode == EVENT for slave in self._members.values()):
            self._enter_continuous_time(solver, now)
        while now < end - near:
            stop = min(end, *(slave.next_event for slave in self._members.values()))
            if stop > now + near:
                reached, _ = solver.step(stop)
                now = stop if abs(reached - stop) <= near else reached
                self._derivatives(now, solver.states.ctypes.data_as(POINTER(c_double)), None)
            due = [
                slave
                for slave in self._members.values()
                if slave.completed_step() or slave.next_event <= now + near
            ]
            if due:
                for slave in due:
                    slave.handle_event(now)
                self._enter_continuous_time(solver, now)
                n_events += 1
            if n_events > MOST_EVENTS:
                raise SlaveError(
                    f"Together they had more than {MOST_EVENTS} events until t = {now:.9g} s."
                )

    def _enter_continuous_time(self, solver: Cvode, time: float) -> None:
        """Continue in continuous time, from the states that the members now have."""
        nominals = np.ones(self._n)
        for name, slave in self._members.items():
            part = self._slices[name]
            slave.enter_continuous(time, solver.states[part], nominals[part])
        self._settle()
        solver.start(time, nominals)

    def _derivatives(self, time, states, derivatives):
        """Derivatives of all states at a time; only sets time, states and inputs where no derivatives are wanted."""
        every = np.ctypeslib.as_array(states, (self._n,)) if self._n else np.empty(0)
        for name, slave in self._members.items():
            slave.set_time_and_states(time, np.ascontiguousarray(every[self._slices[name]]))
        self._settle()
        if derivatives is None or not self._n:
            return 0
        rates = np.ctypeslib.as_array(derivatives, (self._n,))
        for name, slave in self._members.items():
            own = np.zeros(slave.n_states)
            if status := slave.derivatives_into(own):
                return status
            rates[self._slices[name]] = own
        return 0

    def _settle(self):
        """Carry outputs to inputs until they agree: at once, or after as many sweeps as they follow each other."""
        settled = np.zeros(len(self._wires), dtype=bool)
        for _ in range(MOST_SWEEPS):
            for slave, sources, (get, got), _targets, _set in self._ends:
                if get is not None:
                    slave.checked("GetReal", get())
                    self._put_out[sources] = got
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
