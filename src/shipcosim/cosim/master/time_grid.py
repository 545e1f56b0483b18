"""The time grid of a run: communication points, and the rows of the table among them.

Steps are counted in integers. Time is the quotient of two integers, k p / q for a step size of p / q seconds, so that
it is the double nearest to the true time at every step, and an FMU steps by the difference of two times, so
that it ends where the next step begins. libcosim, which counts nanoseconds, gets the same numbers.
"""

from dataclasses import dataclass

import numpy as np

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.scenario.check import step_times
from shipcosim.units import steps_in, whole_steps


@dataclass(frozen=True)
class TimeGrid:
    """Communication steps `first` to `last` of a run whose step 0 begins at `start_time`.

    Parameters
    ----------
    start_time : float
        Of the scenario. [s]
    stop_time : float
        Of the scenario; FMUs get it even if the run ends earlier. [s]
    first, last : int
        Step that is done first, step before which the run ends.
    times : (n + 1,) array
        Communication points: times of the steps from number 0 on, up to the stop time. [s]
    steps_per_row : int
        Steps from one row of the table to the next; the rows are at multiples of it.
    """

    start_time: float
    stop_time: float
    first: int
    last: int
    times: np.ndarray
    steps_per_row: int

    @property
    def run_times(self) -> np.ndarray:
        """Times of the steps that are done, and of the end. [s]"""
        return self.times[self.first : self.last + 1]

    @property
    def row_times(self) -> np.ndarray:
        """Times of the rows of the table. [s]"""
        first_row = -(-self.first // self.steps_per_row) * self.steps_per_row
        return self.times[first_row : self.last + 1 : self.steps_per_row]


def time_grid_of(
    scenario: Scenario, start_time: float = 0.0, first: int = 0, until: float | None = None
) -> TimeGrid:
    """Time grid of a run.

    Parameters
    ----------
    scenario : Scenario
        Its times are on the same clock as `start_time`.
    start_time : float
        Time of step 0. [s]
    first : int
        Step that is done first.
    until : float, optional
        Where the run ends before the scenario does. [s]

    Raises
    ------
    ShipcosimError
        If a time does not fall on a step, or nothing is left to do.
    """
    # Times are compared in whole steps, so that rounding cannot move an end.
    step = scenario.step_size
    end = scenario.stop_time if until is None else until
    n, last = (whole_steps(time - start_time, step) for time in (scenario.stop_time, end))
    ends = {"stop time": (scenario.stop_time, n)} | (
        {} if until is None else {"until": (until, last)}
    )
    problems = [
        Problem(name, *_off_step(t, start_time, step)) for name, (t, k) in ends.items() if k is None
    ]
    # The run must end after its first step, and not after the scenario.
    if n is not None and last is not None and not first < last <= n:
        begin = start_time + first * step
        message = f"the run would go from {begin:g} s to {end:g} s."
        remedy = f"Its end must lie after {begin:g} s and not after the stop time, {scenario.stop_time:g} s."
        problems.append(Problem(list(ends)[-1], message, remedy))
    # An event between two steps could only act late: refuse it.
    for event in scenario.events:
        if whole_steps(event.time - start_time, step) is None:
            problems.append(Problem("event", *_off_step(event.time, start_time, step)))
    if problems or n is None or last is None:
        raise ShipcosimError(problems)
    steps_per_row = whole_steps(scenario.output_interval or step, step) or 1
    times = step_times(step, 0, n, start_time)
    return TimeGrid(start_time, scenario.stop_time, first, last, times, steps_per_row)


def _off_step(time, start_time, step):
    nearest = start_time + max(1, round(steps_in(time - start_time, step))) * step
    return (
        f"{time:g} s is no whole number of steps of {step:g} s after {start_time:g} s.",
        f"{nearest:.9g} s would be.",
    )
