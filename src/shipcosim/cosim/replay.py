"""Open-loop predictions: many segments of a log, each run from the state logged at its start."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.cosim.master.compiled import LONG
from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.run import RunError, Simulation
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, suggestion
from shipcosim.options import CountProgress, RunOptions
from shipcosim.scenario import Scenario
from shipcosim.series import conversion
from shipcosim.ssp import System, with_values
from shipcosim.units import steps_in, whole_steps

if TYPE_CHECKING:
    import xarray


MOST_PROBLEMS = 20
"""Most bad segments of a record that a message lists."""


def replay(
    system: System,
    inputs: xarray.Dataset,
    starts: Sequence[float],
    duration: float,
    *,
    states: Mapping | None = None,
    step_size: float | None = None,
    output_interval: float | None = None,
    signals: Sequence[str] | None = None,
    progress: CountProgress | None = None,
) -> xarray.Dataset:
    """Run a system over segments of a record.

    Every segment is a run of its own: it starts from given values, and the table feeds the system's inputs at the
    record's times, which are also the times of the FMUs.

    Parameters
    ----------
    system : System
        With inputs that the table feeds.
    inputs : Dataset
        As for `simulate`. Only rows that a segment needs have to be without gap and NaN.
    starts : (n,) sequence of float
        Where the segments start. [s]
    duration : float
        Of each segment. [s]
    states : mapping of str to (n,) sequence or value
        Start values by signal, e.g. ``"vessel.x_start"``: one for each segment, or one for all. A DataArray with
        ``units`` is converted into the unit of the variable; other numbers are in this unit already.
    step_size : float, optional
        The system's own where it is not given. [s]
    output_interval : float, optional
        From row to row; every step where it is not given. [s]
    signals : sequence of str, optional
        Signals to keep; all by default.
    progress : callable, optional
        Called with (segments done, segments in all).

    Returns
    -------
    Dataset
        Dimensions ``segment`` and ``time``, the time since the segment's start; coordinate ``start_time`` of the
        segments.

    Raises
    ------
    ShipcosimError
        If a start value, the table or a segment's time does not fit; names the segment. As RunError if a run fails.

    Examples
    --------
    >>> predicted = replay(system, record, [100.0, 160.0], 60.0, states={  # doctest: +SKIP
    ...     "vessel.x_start": [0.0, 12.5], "vessel.psi_start": [0.0, 0.4]})
    >>> predicted["vessel.x"].sel(segment=1, time=30.0)  # doctest: +SKIP
    """
    times = np.asarray(starts, dtype=float)
    if times.ndim != 1 or len(times) == 0 or not np.isfinite(times).all():
        raise error_at(
            "replay", "starts is no list of times.", "Give the time of each segment's start."
        )
    # All FMUs run in this process.
    raise_errors(module_clashes(system, late_alone=True))
    # Plan all segments first, so that all errors are reported before a long computation.
    segments = _Segments(system, inputs, times, duration, step_size, output_interval, states or {})
    segments.check()
    rows = _SegmentRows(times, segments.states, signals)
    # The FMUs stay loaded for all segments; only their state is reset.
    with delayed_interrupt() as check_interrupt, Instances() as instances:
        for number in range(len(times)):
            simulation = segments.simulation(number)
            with _named(number, times):
                simulation.run(instances, check_interrupt)
            simulation.terminate()
            rows.put(number, simulation)
            if progress is not None:
                progress(number + 1, len(times))
    return rows.dataset()


class _Segments:
    """The runs of all segments."""

    def __init__(self, system, inputs, starts, duration, step_size, output_interval, states):
        step_size = step_size or system.experiment.step_size
        raise_errors(_bad_times(starts, duration, step_size, output_interval))
        self.system = system
        self.starts = starts
        self.duration = duration
        # Whether compiling pays depends on all segments together.
        steps = len(starts) * round(duration / step_size) * len(system.components)
        self.options = RunOptions(inputs=inputs, engine="native" if steps >= LONG else "fmpy")
        self.how = {"step_size": step_size, "output_interval": output_interval}
        # Start values of all segments, converted to the units of the variables once.
        self.states = {
            name: _per_segment(name, given, system, len(starts)) for name, given in states.items()
        }

    def check(self) -> None:
        """Raise ShipcosimError with the problems of all segments."""
        problems = []
        for number in range(len(self.starts)):
            try:
                with _named(number, self.starts):
                    self.simulation(number)
            except ShipcosimError as error:
                problems += error.problems
        if problems:
            raise ShipcosimError(problems[:MOST_PROBLEMS])

    def simulation(self, number: int) -> Simulation:
        """The planned run of a segment."""
        # The clock is the log's: FMUs that depend on time see the true time.
        start = float(self.starts[number])
        system = with_values(
            self.system, {name: values[number] for name, values in self.states.items()}, "states"
        )
        scenario = Scenario(
            description=f"Replay of {system.name}", stop_time=start + self.duration, **self.how
        )
        return Simulation(system, scenario, time_grid_of(scenario, start), self.options)


def _bad_times(starts, duration, step_size, output_interval):
    """Problems with the times of all segments."""
    if not step_size or not step_size > 0.0:
        yield Problem("replay", "No step size above 0 is known.", "Give step_size in seconds.")
        return
    # Durations must be whole steps, so that all segments have the same rows.
    for name, time in (("duration", duration), ("output_interval", output_interval or step_size)):
        if not (whole_steps(time, step_size) or 0) > 0:
            yield Problem(
                "replay",
                f"{name} = {time:g} s is no whole number of steps of {step_size:g} s.",
                f"The nearest would be {max(1, round(steps_in(time, step_size))) * step_size:.9g} s.",
            )
    if len(early := starts[starts + duration <= 0.0]):
        yield Problem(
            "replay",
            f"the segment at {early[0]:g} s ends before time 0.",
            "Shift the times of the table: runs end after 0.",
        )


def _per_segment(name, given, system, n):
    """Start value of a signal for each segment, in the unit of the variable."""
    unit = system.described(*system.split(name, "replay: states")).unit
    # A value with a unit is converted; a plain number is in the variable's unit.
    try:
        factor, offset = conversion(getattr(given, "attrs", {}).get("units"), unit)
    except ShipcosimError as error:
        raise error_at(f"replay: states: {name}", error.problems[0].found) from None
    values = np.asarray(given)
    # One value for all segments, or one per segment.
    if values.shape not in ((), (n,)):
        raise error_at(
            f"replay: states: {name}",
            f"{values.shape} values for {n} segments.",
            f"Give one, or {n}.",
        )
    values = values if (factor, offset) == (1.0, 0.0) else factor * values + offset
    return np.broadcast_to(values, (n,)).tolist()


@contextmanager
def _named(number, starts):
    """Add the segment's number and start to error messages."""
    try:
        yield
    except ShipcosimError as error:
        where = f"segment {number} at {starts[number]:.9g} s"
        problems = [
            replace(p, where=f"{where}: {p.where}" if p.where else where) for p in error.problems
        ]
        # A RunError keeps its table.
        if isinstance(error, RunError):
            raise RunError(problems, error.table) from error
        raise ShipcosimError(problems) from error


class _SegmentRows:
    """Rows of all segments: one (segments, rows) array per signal."""

    def __init__(self, starts: np.ndarray, states: Mapping, signals: Sequence[str] | None):
        self.starts = starts
        self.states = states
        self.signals = signals
        self.about: dict[str, tuple[str, str]] = {}
        self.arrays: dict[str, np.ndarray] = {}

    def put(self, number: int, simulation: Simulation) -> None:
        """Keep the rows of a segment's run."""
        columns = simulation.columns()
        if number == 0:
            self._allocate(simulation, columns)
        for name, values, *_ in columns:
            if name in self.arrays:
                self.arrays[name][number] = values

    def _allocate(self, simulation, columns):
        """Allocate arrays for all segments, from the size of the first."""
        columns = {name: (values, (unit, text)) for name, values, unit, text in columns}
        if unknown := [name for name in self.signals or () if name not in columns]:
            raise error_at(
                "replay: signals",
                f"there is no signal '{unknown[0]}'.",
                suggestion(unknown[0], columns),
            )
        # Time counts from the start of each segment, so it is the same for all.
        self.time = simulation.row_times - self.starts[0]
        shape = len(self.starts), len(self.time)
        for name in columns if self.signals is None else self.signals:
            self.about[name] = columns[name][1]
            self.arrays[name] = np.empty(shape, columns[name][0].dtype)
        self.attributes = simulation.attributes(complete=True) | {"states": json.dumps(self.states)}

    def dataset(self) -> xarray.Dataset:
        """The table, with the attributes of the first segment and the `states` of all."""
        import xarray

        variables = {
            name: (
                ("segment", "time"),
                values,
                dict(zip(("units", "long_name"), self.about[name], strict=True)),
            )
            for name, values in self.arrays.items()
        }
        coordinates = {
            "time": (
                "time",
                self.time,
                {"units": "s", "long_name": "time since the segment's start"},
            ),
            "start_time": (
                "segment",
                self.starts,
                {"units": "s", "long_name": "time of the segment's start"},
            ),
        }
        return xarray.Dataset(variables, coordinates, self.attributes)
