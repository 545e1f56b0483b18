"""Many variations of one run, in threads; compiled steps release Python, so all cores work."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import lru_cache
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.cosim.master.interrupt import delayed_interrupt
from shipcosim.cosim.master.result import attributes_of
from shipcosim.cosim.master.run import RunError, Simulation
from shipcosim.cosim.master.time_grid import time_grid_of
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.pythonfmu_code import module_clashes
from shipcosim.cosim.slaves.slave import Slave
from shipcosim.cosim.slaves.unpacked import UnpackedFmus
from shipcosim.errors import ShipcosimError, raise_errors
from shipcosim.options import RunOptions, cores
from shipcosim.scenario import Scenario, check_scenario, units_of, with_numbers
from shipcosim.series import make_table
from shipcosim.ssp import Component, System, with_values

if TYPE_CHECKING:
    import xarray

Choose = Callable[[list[str]], Iterable[str]]
Reduce = Callable[["xarray.Dataset"], Any]


@dataclass(frozen=True)
class Variation:
    """The values and scenario of one run.

    Parameters
    ----------
    values : mapping of str to value
        Start values by signal.
    scenario : Scenario
        Its events and stop time.
    """

    values: Mapping[str, Any]
    scenario: Scenario


@dataclass
class Done:
    """The result of one run.

    Parameters
    ----------
    error : str
        Why it failed; empty where it did not.
    remarks : list of str
        What should be known of it.
    times : (n,) array
        Of its rows. [s]
    kept : dict of str to (dimensions, array, attributes)
        Signals over time, or what they were reduced to.
    """

    error: str = ""
    remarks: list[str] = field(default_factory=list)
    times: np.ndarray = field(default_factory=lambda: np.empty(0))
    kept: dict[str, tuple[tuple[str, ...], np.ndarray, dict]] = field(default_factory=dict)


def simulate_many(
    system: System,
    scenario: Scenario,
    variations: Sequence[Variation],
    options: RunOptions,
    *,
    choose: Choose = tuple,
    reduce: Reduce | None = None,
    workers: int | None = None,
) -> xarray.Dataset:
    """Run a system through variations of a scenario; see `shipcosim.simulate_many`.

    Parameters
    ----------
    system : System
        With the start values that all runs have.
    scenario : Scenario
        Checked against the system; what all runs have in common.
    variations : sequence of Variation
        What each has of its own.
    options : RunOptions
        Engine, start and progress.
    choose : callable
        Says of all signals which are kept.
    reduce : callable, optional
        Gets the table of a run, gives a number or a mapping of names to numbers and arrays.
    workers : int, optional
        Runs at a time; as many as there are cores where it is not given.

    Returns
    -------
    Dataset
        Dimensions ``variation`` and ``time``.

    Raises
    ------
    ShipcosimError
        If a variation does not fit to the system, or all have failed.
    """
    # Variations with the same names and events need only one check: their numbers do not matter.
    runs = _Runs(system, options, choose, reduce)
    for variation in {_kind(variation): variation for variation in variations}.values():
        runs.check(variation)
    # Results come in any order; each goes to its own place.
    done: list[Done] = [Done() for _ in variations]
    with (
        delayed_interrupt() as runs.check_interrupt,
        _sources(min(workers or cores(), len(variations))) as sources,
    ):
        for n, (number, result) in enumerate(_in_threads(runs.run, variations, sources), start=1):
            done[number] = result
            if options.progress is not None:
                options.progress(n, len(variations))
    # Single failures are part of the result. If all fail, the input is probably wrong.
    if variations and all(run.error for run in done):
        raise ShipcosimError(f"All {len(done)} variations fail, the first with: {done[0].error}")
    attributes = attributes_of(system, scenario) | {
        "start_time": options.start_time,
        "engine": options.engine,
    }
    remarks = dict.fromkeys(text for run in done for text in run.remarks)
    return _dataset(variations, done, attributes | {"remarks": json.dumps(list(remarks))})


class _Runs:
    """The parts that all runs share."""

    check_interrupt: Callable[[], None]

    def __init__(
        self,
        system: System,
        options: RunOptions,
        choose: Choose,
        reduce: Reduce | None,
        table: Callable = make_table,
    ):
        # All FMUs run in this process.
        raise_errors(module_clashes(system, late_alone=True))
        self._system = system
        self._options = options
        self._reduce = reduce
        self._table = table
        # All runs have the same names as a rule, so the choice is computed once.
        self._choose = lru_cache(maxsize=64)(lambda names: tuple(choose(list(names))))
        self._unit_of = units_of(system)

    def check(self, variation: Variation) -> None:
        """Raise ShipcosimError if names or times of a variation do not fit the system."""
        for name in variation.values:
            self._system.split(name, "variation")
        problems = check_scenario(variation.scenario, self._system, self._options.start_time)
        raise_errors(problems)
        time_grid_of(variation.scenario, self._options.start_time)

    def run(self, variation: Variation, slaves: _Source) -> Done:
        """Make one run; its error is part of the result."""
        # The simulation of the last run is used again. After an error it is not trusted.
        simulation = slaves.last
        error = ""
        slaves.last = None
        try:
            system = with_values(self._system, variation.values, "variation")
            scenario = with_numbers(variation.scenario, self._unit_of)
            # If only numbers differ, rewind; otherwise plan a new run.
            if simulation is None or not simulation.rewind(system, scenario):
                grid = time_grid_of(scenario, self._options.start_time)
                simulation = Simulation(system, scenario, grid, self._options, repeated=True)
            simulation.run(slaves, self.check_interrupt)
            simulation.terminate()
        except RunError as failed:
            error = str(failed)
        except ShipcosimError as failed:
            return Done(str(failed))
        assert simulation is not None
        slaves.last = None if error else simulation
        return self._kept(simulation, error)

    def _kept(self, simulation, error):
        columns = simulation.columns(lambda names: self._choose(tuple(names)))
        done = Done(error, simulation.remarks(), simulation.row_times)
        if self._reduce is None:
            # Without `reduce` keep the signals; else only what it computes, so that memory stays
            # small.
            done.kept = {
                name: (("time",), values, {"units": unit, "long_name": text})
                for name, values, unit, text in columns
            }
        elif not error:
            reduced = self._reduce(self._table(simulation.row_times, columns))
            parts = reduced if isinstance(reduced, Mapping) else {"reduced": reduced}
            arrays = {str(name): np.asarray(value) for name, value in parts.items()}
            done.kept = {
                name: (tuple(f"{name}_{axis}" for axis in range(values.ndim)), values, {})
                for name, values in arrays.items()
            }
        return done


class _Source:
    """Instances of one worker. Loading and resetting FMUs is process-wide: one worker at a time.

    Attributes
    ----------
    last : Simulation or None
        The run before, in whose arrays the next one goes where start values alone differ.
    """

    last: Simulation | None = None

    def __init__(self, instances: Instances, lock: threading.Lock):
        self._instances = instances
        self._lock = lock

    def instance_of(self, component: Component) -> Slave:
        """See `SlaveSource`."""
        with self._lock:
            return self._instances.instance_of(component)


@contextmanager
def _sources(n: int) -> Iterator[list[_Source]]:
    """Instances for a number of workers, which share the unpacked FMUs."""
    lock = threading.Lock()
    with UnpackedFmus() as unpacked, ExitStack() as stack:
        yield [_Source(stack.enter_context(Instances(unpacked)), lock) for _ in range(n)]


def _in_threads(
    run: Callable[[Variation, _Source], Done],
    variations: Sequence[Variation],
    sources: Sequence[_Source],
) -> Iterator[tuple[int, Done]]:
    """Number and result of each run. The first runs alone: it compiles what the others share."""
    # Each worker takes free instances and puts them back; no two runs share an FMU.
    free: SimpleQueue[_Source] = SimpleQueue()
    for source in sources:
        free.put(source)

    def run_number(number):
        source = free.get()
        try:
            return number, run(variations[number], source)
        finally:
            free.put(source)

    numbers = range(len(variations))
    yield from map(run_number, numbers[:1] if len(sources) > 1 else numbers)
    if len(sources) > 1:
        with ThreadPoolExecutor(len(sources)) as pool:
            futures = [pool.submit(run_number, number) for number in numbers[1:]]
            try:
                # In order of completion, so that progress moves on. After an error the waiting runs
                # are dropped.
                for future in as_completed(futures):
                    yield future.result()
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise


def _kind(variation):
    """The properties on which the checks of a variation depend; numbers are not among them."""
    return (
        frozenset(variation.values),
        repr(variation.scenario.events),
        variation.scenario.stop_time,
    )


def _dataset(variations, done, attributes) -> xarray.Dataset:
    """All runs as one table."""
    import xarray

    # Failed runs have fewer rows; the longest run gives the time axis.
    times = max((run.times for run in done), key=len, default=np.empty(0))
    names = dict.fromkeys(name for run in done for name in run.kept)
    data = {}
    for name in names:
        dimensions, _, about = next(run.kept[name] for run in done if name in run.kept)
        data[name] = (
            ("variation", *dimensions),
            _stacked([run.kept.pop(name, None) for run in done]),
            about,
        )
    coordinates: dict[str, Any] = {
        "error": ("variation", np.array([run.error for run in done], dtype=str))
    }
    if any(dimensions[1:2] == ("time",) for dimensions, *_ in data.values()):
        coordinates["time"] = ("time", times, {"units": "s", "long_name": "time"})
    # The varied values are coordinates, so that results can be selected by them.
    for name in dict.fromkeys(name for variation in variations for name in variation.values):
        if name not in data:
            column = [variation.values.get(name) for variation in variations]
            mixed = any(value is None or isinstance(value, str) for value in column)
            coordinates[name] = ("variation", np.array(column, dtype=object if mixed else None))
    return xarray.Dataset(data, coordinates | {"variation": np.arange(len(done))}, attributes)


def _stacked(parts) -> np.ndarray:
    """(variations, ...) array; NaN where a run has no value, for example after a failure."""
    arrays = [None if part is None else part[1] for part in parts]
    present = [array for array in arrays if array is not None]
    shape = max((array.shape for array in present), default=())
    # The usual case: all runs complete. Otherwise fill up with NaN.
    if len(present) == len(arrays) and all(array.shape == shape for array in present):
        return np.stack(present)
    stacked = np.full((len(arrays), *shape), np.nan)
    for row, array in zip(stacked, arrays, strict=True):
        if array is not None:
            row[tuple(slice(n) for n in array.shape)] = array
    return stacked


class OneAfterAnother:
    """Runs of one system in the calling thread, one by one, with shared FMUs.

    Parameters
    ----------
    system, options, choose, reduce
        As of `simulate_many`; what runs is checked before.
    table : callable
        Makes what `reduce` gets from times and columns, where that is to be less than a Dataset.
    """

    def __init__(
        self,
        system: System,
        options: RunOptions,
        choose: Choose,
        reduce: Callable[[Any], Any],
        table: Callable = make_table,
    ):
        self._runs = _Runs(system, options, choose, reduce, table)
        self._stack = ExitStack()
        self._runs.check_interrupt = lambda: None
        self._source = self._stack.enter_context(_sources(1))[0]

    def run(self, variation: Variation) -> Done:
        """Make one run; its error is part of the result."""
        return self._runs.run(variation, self._source)

    def close(self) -> None:
        """Free the FMUs."""
        self._stack.close()
