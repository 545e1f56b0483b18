"""The co-simulation algorithm: find a consistent start, then step and exchange values."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import contextmanager
from time import perf_counter

import numpy as np

from shipcosim.cosim.master.component import ComponentInstance
from shipcosim.cosim.master.connections import ParameterConnection, StringConnection
from shipcosim.cosim.master.recorder import Recorders
from shipcosim.cosim.master.signals import Exchange
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.profile import MASTER, Profile
from shipcosim.cosim.slaves.slave import RunEnded, SlaveError
from shipcosim.errors import Problem
from shipcosim.options import CountProgress

MOST_ITERATIONS = 200
"""Iterations over the components, beyond one for each of them, in which the start has to become consistent."""

BETWEEN_REPORTS = 0.1
"""Least time between two calls that report progress. [s]"""

Between = Callable[[int], tuple[int, int]]
"""Is called between two steps with the number of the next one. It returns the number of the step to go on with, an earlier
one where it has restored a state, and that of the step before which it is to be called again."""

SAME = 1e-12
"""Relative change of an input in an iteration below which it is taken for rounding."""


def now_and_then(progress: CountProgress | None) -> CountProgress:
    """What tells `progress`, if there is one, of the end and of steps some ten times a second."""
    report_at = perf_counter()

    def tell(done: int, total: int) -> None:
        nonlocal report_at
        if progress is not None and (done == total or perf_counter() >= report_at):
            progress(done, total)
            report_at = perf_counter() + BETWEEN_REPORTS

    return tell


class Failure(Exception):
    """A run cannot go on; `problem` tells why."""

    def __init__(self, problem: Problem):
        super().__init__(str(problem))
        self.problem = problem


class Ended(Exception):
    """A component has ended the run at a time. [s]"""

    def __init__(self, component: str, time: float):
        super().__init__(f"{component} ends the run at t = {time:.9g} s.")


class Master:
    """The master of a co-simulation: all components and the exchange between them.

    Parameters
    ----------
    components : sequence of ComponentInstance
        In the order in which they step.
    exchanges : mapping of str to Exchange
        By kind.
    string_connections : sequence of StringConnection
        Connections between String or Binary variables.
    parameter_connections : sequence of ParameterConnection
        Connections into parameters, made during initialisation.
    names : mapping of str to (sources, inputs)
        Names of the rows of each exchange, for messages.
    check_interrupt : callable
        Raises KeyboardInterrupt where the user wants to stop.
    sequential : bool
        Gauss-Seidel: a component sees what those before it have just put out. Otherwise Jacobi: what all put out
        at the start of the step.
    """

    def __init__(
        self,
        components: Sequence[ComponentInstance],
        exchanges: Mapping[str, Exchange],
        string_connections: Sequence[StringConnection],
        parameter_connections: Sequence[ParameterConnection],
        names: Mapping[str, tuple[list[str], list[str]]],
        check_interrupt: Callable[[], None],
        sequential: bool = False,
    ):
        self._components = components
        self._exchanges = exchanges
        self._names = names
        self._string_connections = string_connections
        self._parameter_connections = parameter_connections
        self._check_interrupt = check_interrupt
        self._sequential = sequential
        self._all_exchanges = list(exchanges.values())
        self.profile: Profile | None = None

    def count_in(self, profile: Profile) -> None:
        """Count the time of each component and phase from now on."""
        self.profile = profile
        self._transfer = profile.timed(MASTER, "exchange", self._transfer)
        for component in self._components:
            component.count_in(profile)

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Initialise all components, consistently: every input equals what feeds it. Times in s.

        Raises
        ------
        Failure, KeyboardInterrupt
        """
        # Enter the initialisation everywhere first: outputs exist only in this mode.
        for component in self._components:
            self._check_interrupt()
            with _failing(component, "at the start"):
                component.slave.enter_initialisation(start_time, stop_time)
                component.read()
        # Then exchange until each input equals its source, still in initialisation mode.
        self._iterate_start()
        # Leave the mode with the settled inputs, and read again: some outputs change only here.
        for component in self._components:
            with _failing(component, "at the end of the initialisation"):
                component.write()
                component.slave.exit_initialisation()
                component.read()
        # Exchange once more: the first step starts from these values.
        self._transfer(0)
        self._check_finite(start_time)

    def resume(self, step: int) -> None:
        """Exchange what is due before a step, after values and FMUs were restored."""
        self._transfer(step)

    def _iterate_start(self):
        """Iterate over the components in initialisation mode until no input changes."""
        # A fixed-point iteration: without an algebraic loop it ends after as many sweeps as the
        # longest chain of components.
        self._transfer(0)
        inputs = {}
        moving = {}
        feeding = [
            component for component in self._components if component.feeds
        ]  # the others change no input
        for iteration in range(MOST_ITERATIONS + len(self._components)):
            last = inputs
            # Settled: no input and no connected parameter has changed since the last sweep.
            inputs = self._inputs()
            changed = [_transferred(connection) for connection in self._parameter_connections]
            if iteration and last == inputs and not any(changed):
                return
            # Beyond the normal limit, note what still changes: the last sweeps name the loop.
            if iteration >= MOST_ITERATIONS:
                moving |= {
                    name: abs(value - last[name])
                    for name, value in inputs.items()
                    if value != last[name]
                }
            self._check_interrupt()
            # Write and read every component that feeds another one.
            for component in feeding:
                with _failing(component, "at the start"):
                    component.write()
                    component.read()
            self._transfer(0)
        # Changes within rounding are accepted: the loop has converged.
        if any(change > SAME * abs(inputs[name]) for name, change in moving.items()):
            names = ", ".join(name for name in inputs if name in moving)
            message = f"the start does not settle: after {MOST_ITERATIONS} sweeps over the components {names} still change."
            remedy = "They lie on or behind a loop of direct feedthrough. One of it has to hold its output over a step."
            raise Failure(Problem("initialisation", message, remedy))

    def _inputs(self):
        """Values of all inputs, by name."""
        return {
            name: value
            for kind, exchange in self._exchanges.items()
            for name, value in zip(self._names[kind][1], exchange.inputs.tolist(), strict=True)
        }

    def run(
        self,
        grid: TimeGrid,
        actions: Mapping[int, Sequence[Callable[[], None]]],
        external: Sequence[tuple[np.ndarray, np.ndarray]],
        recorders: Recorders,
        progress: CountProgress | None = None,
        between: Between | None = None,
    ) -> None:
        """Step to the end, recording rows.

        Parameters
        ----------
        grid : TimeGrid
            From which step to which, and the steps' times.
        actions : mapping of int to sequence of callables
            What events do before the step of this number.
        external : sequence of ((m,) array, (n + 1, m) array)
            External values of an exchange, and what they are at each step of the grid.
        recorders : Recorders
            Keep a row of the values where one is due.
        progress : callable, optional
            Called with (steps done, steps in all) some ten times a second.
        between : callable, optional
            Called before the first step; it may wait, and change signals.

        Raises
        ------
        Failure, Ended, KeyboardInterrupt
        """
        clock = grid.times.tolist()
        first = grid.first
        last = grid.last
        steps_per_row = grid.steps_per_row
        tell = now_and_then(progress)
        k = meeting = first
        while k < last:
            if between is not None and k == meeting:
                k, meeting = between(k)
            # Events act on the step that starts now, before its row is recorded.
            if k in actions:
                self._act(actions[k])
            # The row at time t holds the values at t, before the step.
            if k % steps_per_row == 0:
                recorders.record()
            self._check_interrupt()
            tell(k - first, last - first)
            # The step, then the exchange at its end: external values of the next time come with it.
            self._step(k, clock)
            for target, values in external:
                target[:] = values[k + 1 - first]
            self._transfer(k + 1)
            # A NaN would spread to all components; stop at the first one and name it.
            self._check_finite(clock[k + 1])
            k += 1
        # The final values are a row too.
        if last % steps_per_row == 0:
            recorders.record()
        tell(last - first, last - first)

    def give_back(self) -> None:
        """Bring the FMUs to the state that the run has reached, if they are not there already."""

    def take_back(self) -> None:
        """Go on from the state of the FMUs, which has been restored."""

    def _act(self, actions):
        for action in actions:
            action()
        for exchange in self._all_exchanges:
            exchange.refresh()

    def _step(self, k, clock):
        """Step all components; with Jacobi, those in other processes step in parallel."""
        sequential = self._sequential
        for component in self._components:
            # Gauss-Seidel: exchange before each component, so it sees the new outputs of those
            # before it.
            if sequential:
                self._transfer(k + 1)
            multiple = component.multiple
            try:
                # A component with a longer step moves only at its multiples. The step is the
                # difference of two grid times.
                if k % multiple == 0:
                    component.write()
                    component.step(clock[k], clock[k + multiple] - clock[k])
                if sequential and (k + 1) % multiple == 0:
                    component.read()
            except SlaveError as error:
                raise failed_step(component, clock[k], error) from error
        # Jacobi: read outputs only after all have stepped. Until then remote components work in
        # parallel.
        for component in () if sequential else self._components:
            try:
                if (k + 1) % component.multiple == 0:
                    component.read()
            except SlaveError as error:
                raise failed_step(component, clock[k + 1 - component.multiple], error) from error

    def _transfer(self, count):
        for exchange in self._all_exchanges:
            exchange.transfer(count)
        for connection in self._string_connections:
            _transferred(connection, count)

    def _check_finite(self, time):
        if "Real" not in self._exchanges:
            return
        # Check outputs with their overrides: these are the values that go on.
        values = self._exchanges["Real"].modified_sources
        if np.isfinite(values).all():
            return
        row = int(np.flatnonzero(~np.isfinite(values))[0])
        message = f"is {values[row]} at t = {time:.9g} s."
        raise Failure(
            Problem(self._names["Real"][0][row], message, "Every value has to be a finite number.")
        )


def failed_step(component: ComponentInstance, time: float, error: SlaveError) -> Failure | Ended:
    """The failure of a component in its step from a time on, or the end that it asks for. [s]"""
    if isinstance(error, RunEnded):
        return Ended(component.name, time)
    return Failure(Problem(component.name, f"failed in the step from t = {time:.9g} s. {error}"))


def _transferred(connection, *arguments):
    """Call `transfer` of a connection; an error of its FMUs becomes a Failure."""
    try:
        return connection.transfer(*arguments)
    except SlaveError as error:
        raise Failure(
            Problem(connection.place, f"its value cannot be passed on. {error}")
        ) from error


@contextmanager
def _failing(component, when):
    """Turn an error of a slave into a Failure of its component."""
    try:
        yield
    except SlaveError as error:
        raise Failure(Problem(component.name, f"failed {when}. {error}")) from error
