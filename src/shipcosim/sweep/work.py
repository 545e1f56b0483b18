"""A worker process: takes a job once, then chunks of runs, and returns a row per run."""

from __future__ import annotations

import atexit
import hashlib
import pickle
import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from shipcosim.cosim import Variation
from shipcosim.cosim.variations import OneAfterAnother
from shipcosim.errors import ShipcosimError
from shipcosim.options import RunOptions
from shipcosim.ssp import System
from shipcosim.sweep.plan import Plan, PlannedRun, Swapped
from shipcosim.sweep.quantities import Measure
from shipcosim.temporary import temporary_folder

MOST_JOBS = 2
MOST_SYSTEMS = 4
"""Jobs, and systems of each, that a worker keeps ready."""


@dataclass(frozen=True)
class Row:
    """The result of a run.

    Parameters
    ----------
    number : int
        In the plan.
    quantities : mapping of str to float or bool
        By name; none where the run failed.
    error : str
        Why it failed; empty where it did not.
    tracks : mapping of str to (n,) array
        Time and signals that are kept over time.
    """

    number: int
    quantities: Mapping[str, float | bool] = field(default_factory=dict)
    error: str = ""
    tracks: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Chunk:
    """Rows of some runs, and how long they took. [s]"""

    rows: list[Row]
    seconds: float


@dataclass(frozen=True)
class Job:
    """Everything that a worker needs besides the package: plan, engine, FMUs.

    Parameters
    ----------
    plan : Plan
        Without what only the process that wrote it can use.
    engine : str
        ``"native"`` or ``"fmpy"``.
    fmus : mapping of str to bytes
        FMUs by their hash, for workers that do not have the files.
    paths : mapping of str to str
        Hash of each FMU's file.
    """

    plan: Plan
    engine: str
    fmus: Mapping[str, bytes]
    paths: Mapping[str, str]


@dataclass(frozen=True)
class PackedJob:
    """A job as bytes with their hash, by which workers recognise it."""

    digest: str
    content: bytes = field(repr=False)


def pack(plan: Plan, engine: str, with_fmus: bool) -> PackedJob:
    """Pack a job for its way to the workers.

    Parameters
    ----------
    plan : Plan
    engine : str
    with_fmus : bool
        Whether FMUs travel along: to workers on other machines.
    """
    # Unpacked archives belong to this process and cannot travel.
    systems = {key: replace(system, _packages=()) for key, system in plan.systems.items()}
    files = {
        str(c.fmu.path): c.fmu.path
        for system in systems.values()
        for c in system.components.values()
    }
    # Hashes of the FMUs, so that a worker on another machine can tell if it has the same file.
    contents = {path: file.read_bytes() for path, file in files.items()}
    paths = {path: hashlib.sha256(content).hexdigest() for path, content in contents.items()}
    fmus = {paths[path]: content for path, content in contents.items()} if with_fmus else {}
    content = pickle.dumps(Job(replace(plan, systems=systems), engine, fmus, paths), protocol=5)
    return PackedJob(hashlib.sha256(content).hexdigest(), content)


class Column(NamedTuple):
    """The part of a signal that quantities need."""

    values: np.ndarray


def table_of(
    times: np.ndarray, columns: Iterable[tuple[str, np.ndarray, str, str]]
) -> dict[str, Column]:
    """Columns by name, as quantities need them of a table."""
    return {"time": Column(times)} | {name: Column(values) for name, values, *_ in columns}


def run_chunk(job: PackedJob | str, runs: Sequence[PlannedRun]) -> Chunk:
    """Run some runs of a job.

    Parameters
    ----------
    job : PackedJob or str
        The job, or the path of a file with its bytes.
    runs : sequence of PlannedRun

    Returns
    -------
    Chunk
    """
    with _ONE_AT_A_TIME:
        # The time to unpack the job is no part of the measured time: it occurs once.
        bench = _bench(job)
        began = perf_counter()
        return Chunk([bench.row(run) for run in runs], perf_counter() - began)


class _Bench:
    """A job in a worker, with its prepared systems."""

    def __init__(self, content: bytes):
        job: Job = pickle.loads(content)
        self._job = job
        self._plan = job.plan
        self._folder = temporary_folder()
        self._at: dict[str, Path] = {}
        self._ready: OrderedDict[Swapped, OneAfterAnother] = OrderedDict()
        measures: Sequence[Measure] = job.plan.measures
        self._tracked = tuple(job.plan.study.tracks.signals) if job.plan.study.tracks else ()
        # Only signals that a quantity or a track uses are kept: the rest would cost memory and
        # time.
        judged = [name for m in measures for one in m.expect for name in one.signals]
        self._signals = frozenset([*judged, *self._tracked])

    def _ready_for(self, run: PlannedRun) -> OneAfterAnother:
        """The prepared system of a run."""
        # Systems are cached by their swapped FMUs; the one unused for longest is closed.
        key = run.swapped if run.swapped in self._plan.systems else ()
        if key not in self._ready:
            while len(self._ready) >= MOST_SYSTEMS:
                self._ready.popitem(last=False)[1].close()
            system = self._system(self._plan.systems[key])
            options = RunOptions(engine=self._job.engine)
            self._ready[key] = OneAfterAnother(
                system, options, self._chosen, self._reduced, table_of
            )
        self._ready.move_to_end(key)
        return self._ready[key]

    def row(self, run: PlannedRun) -> Row:
        """Make a run and its row; any error becomes part of the row."""
        try:
            # Any error of a run must stay with this run: the worker goes on.
            done = self._ready_for(run).run(Variation(run.values, self._plan.scenario_of(run)))
        except Exception as error:
            return Row(
                run.number, error=str(error) if isinstance(error, ShipcosimError) else repr(error)
            )
        if done.error:
            return Row(run.number, error=done.error)
        tracks = {
            name: done.kept[f"track {name}"][1]
            for name in ("time", *self._tracked)
            if self._tracked
        }
        # Margins come from the start values, all other quantities from the table.
        quantities = {
            m.name: m.margin.of(run.values) if m.margin else done.kept[m.name][1].item()
            for m in self._plan.measures
        }
        return Row(run.number, quantities, tracks=tracks)

    def close(self) -> None:
        """Free the FMUs and remove what was unpacked."""
        for one in self._ready.values():
            one.close()
        self._folder.cleanup()

    def _chosen(self, names: list[str]) -> list[str]:
        return [name for name in names if name in self._signals]

    def _reduced(self, table: Any) -> dict[str, Any]:
        # Reduce right after the run: a table of all signals is never kept.
        found = {
            measure.name: measure.of(table)
            for measure in self._plan.measures
            if measure.margin is None
        }
        every = slice(None, None, self._plan.rows_per_track_row)
        tracks = {
            f"track {name}": table[name].values[every]
            for name in ("time", *self._tracked)
            if self._tracked
        }
        return found | tracks

    def _system(self, system: System) -> System:
        """The system with its FMUs at their place on this machine."""
        components = {
            name: replace(
                component, fmu=replace(component.fmu, path=self._path(component.fmu.path))
            )
            for name, component in system.components.items()
        }
        return replace(system, components=components)

    def _path(self, path: Path) -> Path:
        """Path of an FMU here: its own place if the file is the same, else a copy."""
        digest = self._job.paths[str(path)]
        if digest not in self._at:
            here = path
            # A file of the same path may differ on another machine, so its content decides.
            if not path.is_file() or hashlib.sha256(path.read_bytes()).hexdigest() != digest:
                here = Path(self._folder.name) / digest / path.name
                here.parent.mkdir(exist_ok=True)
                here.write_bytes(self._job.fmus[digest])
            self._at[digest] = here
        return self._at[digest]


_ONE_AT_A_TIME = threading.Lock()
"""Loading and resetting FMUs concerns the whole process: a worker with several threads runs one chunk at a time."""
_BENCHES: OrderedDict[str, _Bench] = OrderedDict()
"""Jobs that this process has made ready."""


def _bench(job: PackedJob | str) -> _Bench:
    name = job if isinstance(job, str) else job.digest
    if name not in _BENCHES:
        # A worker may serve several studies; keep the last few.
        while len(_BENCHES) >= MOST_JOBS:
            _BENCHES.popitem(last=False)[1].close()
        _BENCHES[name] = _Bench(Path(job).read_bytes() if isinstance(job, str) else job.content)
    _BENCHES.move_to_end(name)
    return _BENCHES[name]


@atexit.register
def _close_all() -> None:
    while _BENCHES:
        _BENCHES.popitem()[1].close()
