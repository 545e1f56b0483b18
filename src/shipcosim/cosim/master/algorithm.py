"""The master: brings the components to a consistent start, then steps them and passes their values on.

Steps are counted in integers. Time is the quotient of two integers, k p / q for a step size of p / q seconds, so that
it is the double nearest to the true time at every step, and an FMU is told to step by the difference of two times, so
that it ends where the next step begins. libcosim, which counts nanoseconds, gets the same numbers.
"""

from contextlib import contextmanager
from fractions import Fraction
from time import perf_counter

import numpy as np

from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import Problem
from shipcosim.scenario import whole_steps

SWEEPS = 200
"""Sweeps over the components, beyond one for each of them, in which the start has to become consistent."""
BETWEEN_REPORTS = 0.1  # s


class Failure(Exception):
    """A run cannot go on; `problem` says why."""

    def __init__(self, problem):
        super().__init__(str(problem))
        self.problem = problem


def step_times(step_size, first, last, start_time=0.0):
    """Times of the steps from one number to another, both included.

    Examples
    --------
    >>> step_times(0.05, 0, 3).tolist()
    [0.0, 0.05, 0.1, 0.15]

    A run that starts on a step of another one has the same times:

    >>> step_times(0.05, 0, 1, start_time=0.15).tolist() == step_times(0.05, 3, 4).tolist()
    True
    """
    step, before = Fraction(step_size).limit_denominator(10**12), whole_steps(start_time, step_size)
    if before is None:
        return start_time + step_times(step_size, first, last)
    return np.arange(before + first, before + last + 1) * float(step.numerator) / float(step.denominator)


class Master:
    """A system on its way through time.

    Parameters
    ----------
    parts : sequence of Part
        In the order in which they step.
    exchanges : mapping of str to Exchange
        By kind.
    texts : sequence of Text
        Connections between String variables.
    handovers : sequence of Handover
        Connections into parameters, made during initialisation.
    names : mapping of str to (sources, inputs)
        Names of the rows of each exchange, for messages.
    check_interrupt : callable
        Raises KeyboardInterrupt where the user wants to stop.
    sequential : bool
        Gauss-Seidel: a component sees what those before it have just put out. Otherwise Jacobi: what all put out
        at the start of the step.
    """

    def __init__(self, parts, exchanges, texts, handovers, names, check_interrupt, sequential=False):
        self._parts, self._exchanges, self._texts, self._names = parts, exchanges, texts, names
        self._handovers = handovers
        self._check_interrupt, self._sequential = check_interrupt, sequential
        self._all = list(exchanges.values())

    def initialise(self, start_time, stop_time):
        """Bring all components to a start at which every input equals what feeds it."""
        for part in self._parts:
            self._check_interrupt()
            with _blame(part, "at the start"):
                part.slave.enter_initialisation(start_time, stop_time)
                part.read()
        self._settle()
        for part in self._parts:
            with _blame(part, "at the end of the initialisation"):
                part.write()
                part.slave.exit_initialisation()
                part.read()
        self._transfer(0)
        self._check_finite(start_time)

    def resume(self, step):
        """Pass on what is due before a step, after values and FMUs have been brought into the state they had then."""
        self._transfer(step)

    def _settle(self):
        """Sweep over the components until no input changes any more."""
        self._transfer(0)
        before, moving = None, {}
        for sweep in range(SWEEPS + len(self._parts)):
            last, before = before, self._inputs()
            changed = [_passed_on(handover) for handover in self._handovers]
            if last == before and not any(changed):
                return
            if sweep >= SWEEPS:
                moving |= {name: abs(value - last[name]) for name, value in before.items() if value != last[name]}
            self._check_interrupt()
            for part in self._parts:
                with _blame(part, "at the start"):
                    part.write()
                    part.read()
            self._transfer(0)
        if any(change > 1e-12 * abs(before[name]) for name, change in moving.items()):
            names = ", ".join(name for name in before if name in moving)
            found = f"the start does not settle: after {SWEEPS} sweeps over the components {names} still change."
            remedy = "They lie on or behind a loop of direct feedthrough. One of it has to hold its output over a step."
            raise Failure(Problem("initialisation", found, remedy))

    def _inputs(self):
        """Values of all inputs by name."""
        return {
            name: value
            for kind, exchange in self._exchanges.items()
            for name, value in zip(self._names[kind][1], exchange.inputs.tolist(), strict=True)
        }

    def run(self, span, actions, settings, record, progress=None):
        """Step to the end, recording rows.

        Parameters
        ----------
        span : Span
            From which step to which, and the steps' times.
        actions : mapping of int to sequence of callables
            What events do before the step of this number.
        settings : sequence of (array, (n + 1, m) array)
            Settings of an exchange and the values that they take at each step of the span.
        record : callable
            Called when the values are those of the next row.
        progress : callable, optional
            Called with (steps done, steps in all) some ten times a second.

        Raises
        ------
        Failure, KeyboardInterrupt
        """
        clock, first, last, every, report_at = span.times.tolist(), span.first, span.last, span.every, perf_counter()
        for k in range(first, last):
            if k in actions:
                self._act(actions[k])
            if k % every == 0:
                record()
            self._check_interrupt()
            if progress is not None and perf_counter() >= report_at:
                progress(k - first, last - first)
                report_at = perf_counter() + BETWEEN_REPORTS
            self._step(k, clock)
            for target, values in settings:
                target[:] = values[k + 1 - first]
            self._transfer(k + 1)
            self._check_finite(clock[k + 1])
        if last % every == 0:
            record()
        if progress is not None:
            progress(last - first, last - first)

    def _act(self, actions):
        for action in actions:
            action()
        for exchange in self._all:
            exchange.refresh()

    def _step(self, k, clock):
        """Step all components; where none waits for another's outputs, those in own processes do it at once."""
        for part in self._parts:
            if self._sequential:
                self._transfer(k + 1)
            try:
                if k % part.multiple == 0:
                    part.write()
                    part.step(clock[k], clock[k + part.multiple] - clock[k])
                if self._sequential and (k + 1) % part.multiple == 0:
                    part.read()
            except SlaveError as error:
                raise _failed_step(part, clock[k], error) from error
        for part in () if self._sequential else self._parts:
            try:
                if (k + 1) % part.multiple == 0:
                    part.read()
            except SlaveError as error:
                raise _failed_step(part, clock[k + 1 - part.multiple], error) from error

    def _transfer(self, count):
        for exchange in self._all:
            exchange.transfer(count)
        for text in self._texts:
            _passed_on(text, count)

    def _check_finite(self, time):
        reals = self._exchanges.get("Real")
        if reals is None or np.isfinite(reals.seen).all():
            return
        row = int(np.flatnonzero(~np.isfinite(reals.seen))[0])
        found = f"is {reals.seen[row]} at t = {time:.9g} s."
        raise Failure(Problem(self._names["Real"][0][row], found, "Every value has to be a finite number."))


def _failed_step(part, time, error):
    return Failure(Problem(part.name, f"failed in the step from t = {time:.9g} s. {error}"))


def _passed_on(carried, *arguments):
    """What `transfer` of a Text or Handover returns; what the FMUs at its ends say becomes a Failure."""
    try:
        return carried.transfer(*arguments)
    except SlaveError as error:
        raise Failure(Problem(carried.place, f"its value cannot be passed on. {error}")) from error


@contextmanager
def _blame(part, when):
    """Turn what a slave says into a Failure of its component."""
    try:
        yield
    except SlaveError as error:
        raise Failure(Problem(part.name, f"failed {when}. {error}")) from error
