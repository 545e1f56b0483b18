"""What `import shipcosim` offers, in one place."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

from pydantic import ValidationError

from shipcosim import library
from shipcosim.cosim import Variation, system_of
from shipcosim.cosim import simulate as _simulate
from shipcosim.cosim import simulate_many as _simulate_many
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.options import RunKeywords, RunOptions
from shipcosim.results.calls import with_known_keywords
from shipcosim.results.log import Log
from shipcosim.results.run import Run
from shipcosim.results.shown import parts_of
from shipcosim.results.signals import chosen
from shipcosim.scenario import Scenario, check_files, check_scenario, check_times, judge, within_run
from shipcosim.scenario import read_scenario as _read_scenario
from shipcosim.scenario.model import problems_in
from shipcosim.series import read_table, write_table
from shipcosim.ssp import (
    System,
    SystemStructure,
    fitting_values,
    new,
    osp_file,
    parameter,
    read_system,
    with_values,
    write_ssv,
)
from shipcosim.ssp import read as _read
from shipcosim.staging import staged
from shipcosim.units import UnitError, seconds

if TYPE_CHECKING:
    import pandas
    import xarray

    from shipcosim.diagnose.pipeline import Progress
    from shipcosim.diagnose.reference.reference import Reference
    from shipcosim.results.check import CheckedFiles
    from shipcosim.results.diagnosis import DiagnosisOfLog, DiagnosisOfLogs
    from shipcosim.results.studies import Calibration, CapabilityOfShip, EngineComparison, Replay, SeaTrials
    from shipcosim.results.study import StudyResult

    AnyLog = str | os.PathLike[str] | xarray.Dataset | Log | Run
    AnySystem = str | os.PathLike[str] | SystemStructure | System

__all__ = [
    "Log",
    "Problem",
    "Run",
    "Scenario",
    "ShipcosimError",
    "System",
    "SystemStructure",
    "calibrate",
    "capability",
    "check",
    "compare",
    "diagnose",
    "judge",
    "new",
    "parameter",
    "read",
    "read_log",
    "read_scenario",
    "read_table",
    "replay",
    "run",
    "sea_trials",
    "simulate",
    "simulate_many",
    "sweep",
    "write_ssv",
    "write_table",
]

SYSTEM_OF_LOGS, SYSTEM_OF_CAPABILITY = "gunnerus_open", "gunnerus_dp"
"""What logs are held against, and whose capability is computed, where nobody says: as for the commands."""
EXTENDED, CALIBRATED = ("extended.ssp", "extended.ssv"), ("calibrated.ssv", "reference.json")
"""Files that an earlier diagnosis or calibration may have left, and a later one does not always write."""


@with_known_keywords
def run(
    scenario: Scenario | str | os.PathLike[str],
    *,
    set: Mapping[str, object] | None = None,
    parameters: Sequence[str | os.PathLike[str]] = (),
    components: Mapping[str, str | os.PathLike[str]] | None = None,
    events: Iterable[Mapping[str, object]] = (),
    stop_time: float | str | None = None,
    step_size: float | str | None = None,
    output_interval: float | str | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    **options: Unpack[RunKeywords],
) -> Run:
    """Run a scenario and judge what it expects.

    Parameters
    ----------
    scenario : Scenario, path or name
        A scenario file, or its name: ``"four_corner"``.
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units; over those of the scenario.
    parameters : sequence of path
        Parameter sets (.ssv) over the scenario's own, as the extended.ssv of a diagnosis; what does not fit is left
        out and said in `Run.remarks`.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own, over those of the scenario: ``{"allocator": "my_allocator"}``.
    events : iterable of mapping
        As in a scenario file; added to its own.
    stop_time, step_size, output_interval : float, optional
        In place of the scenario's, in s or such as ``"10 min"``. [s]
    out : path, optional
        Folder that gets result.nc, result.csv, report.html, predictions.csv; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    engine, inputs, progress, order, until, resume, store, isolate, timeout
        As in `shipcosim.options.RunOptions`.

    Returns
    -------
    Run

    Raises
    ------
    ShipcosimError
        If something does not fit together, or the run fails.

    Examples
    --------
    >>> import shipcosim
    >>> gust = shipcosim.run("gust", stop_time=2.0)
    >>> gust.passed, gust["vessel.psi"].attrs["units"], len(gust.not_judged)
    (True, 'rad', 4)
    """
    given = scenario if isinstance(scenario, Scenario) else read_scenario(scenario)
    if missing := check_files(given):
        raise ShipcosimError(missing)
    swapped = _components(components)
    system = system_of(given, components=swapped)
    times = {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    fitting, remarks = _fitting(parameters, system)
    given = given.model_copy(update={"components": given.components | {k: str(v) for k, v in swapped.items()}})
    keys = _given(times) | {"set": fitting | _mapping("set", set), "events": list(events)}
    shown = _scenario(given, system.experiment, keys)
    return _run(system, shown, _options(options), out, force, remarks=remarks, planned=given.stop_time)


@with_known_keywords
def simulate(
    system: AnySystem | None = None,
    scenario: Scenario | str | os.PathLike[str] | None = None,
    *,
    stop_time: float | str | None = None,
    step_size: float | str | None = None,
    output_interval: float | str | None = None,
    set: Mapping[str, object] | None = None,
    components: Mapping[str, str | os.PathLike[str]] | None = None,
    events: Iterable[Mapping[str, object]] = (),
    start_time: float | str | None = None,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    **options: Unpack[RunKeywords],
) -> Run:
    """Run a system, one of ours or anybody's.

    Parameters
    ----------
    system : SystemStructure, System, path or name, optional
        What runs; the scenario's system if not given.
    scenario : Scenario, path or name, optional
        What happens; the keywords add to it and go before it.
    stop_time, step_size, output_interval : float, optional
        Where nobody says anything, the system's default experiment does, and every step is a row. In s,
        or such as ``"10 min"``. [s]
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own, over those of the scenario, where the system is no `System`.
    events : iterable of mapping
        As in a scenario file: ``{"time": 10.0, "override": {"vessel.tau_X_5": 1e4}}``.
    start_time : float, optional
        As in `shipcosim.options.RunOptions`; where nobody says anything, the system's default experiment does. [s]
    out : path, optional
        Folder that gets result.nc, result.csv, report.html, predictions.csv; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    engine, inputs, progress, order, until, resume, store, isolate, timeout
        As in `shipcosim.options.RunOptions`: `until` and `store` stop at a time and keep the state of the whole
        system, `resume` continues from there; `isolate` has each component run in a process of its own.

    Returns
    -------
    Run
        Its `table` has one row per output interval, `time` in s; variables are named ``component.connector``. It is
        read like its table: ``run["vessel.x"]``.

    Raises
    ------
    ShipcosimError
        If something does not fit together, or the run fails.

    Examples
    --------
    >>> import shipcosim
    >>> drift = shipcosim.simulate("gunnerus_open", stop_time=1.0, step_size=0.1, set={"port_rpm": 60.0})
    >>> drift.sizes["time"], bool(drift["vessel.u"][-1] > 0.0)
    (11, True)
    """
    if scenario is not None and not isinstance(scenario, Scenario):
        scenario = read_scenario(scenario)
    system = _system(system, scenario, _components(components))
    if start_time is None:
        continues = options.get("resume") is not None
        start_time = system.experiment.start_time if scenario is None and not continues else 0.0
    times = {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    keys = _given(times) | {"set": _mapping("set", set), "events": list(events)}
    planned = 0.0 if scenario is None else scenario.stop_time
    scenario = _scenario(scenario, system.experiment, keys)
    how = _options({"start_time": start_time, **options})
    return _run(system, scenario, how, out, force, planned=planned)


@with_known_keywords
def simulate_many(
    system: AnySystem | None = None,
    scenario: Scenario | str | os.PathLike[str] | None = None,
    variations: Sequence[Mapping[str, Any]] | pandas.DataFrame | xarray.Dataset = (),
    *,
    record: str | Sequence[str] | None = None,
    reduce: Callable[[xarray.Dataset], Any] | None = None,
    workers: int | None = None,
    stop_time: float | str | None = None,
    step_size: float | str | None = None,
    output_interval: float | str | None = None,
    set: Mapping[str, object] | None = None,
    components: Mapping[str, str | os.PathLike[str]] | None = None,
    events: Iterable[Mapping[str, object]] = (),
    engine: str = "native",
    progress: Callable[[int, int], None] | None = None,
) -> xarray.Dataset:
    """Run many variations of one run, on all cores.

    Each is the run that `simulate` makes of its values, whatever runs beside it. Models are compiled once; without a
    compiler Python steps, and the remarks say so.

    Parameters
    ----------
    system, scenario, stop_time, step_size, output_interval, set, components, events
        As of `simulate`: what all variations have in common.
    variations : list of mappings, DataFrame or Dataset
        What each has of its own: start values by full name, ``{"environment.seed": 3, "vessel.mass": "550 t"}``.
        ``"parameters"`` among the names is a list of parameter sets (.ssv), ``"events"`` a list of events beside those
        of all, ``"stop_time"`` its own end. A missing value (NaN) leaves what all have.
    record : str or sequence of str, optional
        Signals, components, connectors or patterns such as ``"*.thrust"``; everything if not given.
    reduce : callable, optional
        Gets the table of each run and gives a number, or a mapping of names to numbers and arrays, which is all that
        is kept of the run.
    workers : int, optional
        Runs at a time; one a core if not given.
    engine : str
        ``"native"`` or ``"fmpy"``, as in `shipcosim.options.RunOptions`.
    progress : callable, optional
        Called with (runs done, runs in all).

    Returns
    -------
    Dataset
        Signals over ``variation`` and ``time``. Coordinates are the start values of each variation, and ``error``: why
        it failed, empty where it did not. Rows that a run does not reach are NaN.

    Raises
    ------
    ShipcosimError
        If a name does not exist, or no variation runs.

    Examples
    --------
    >>> import shipcosim
    >>> speeds = [{"port_rpm": 60.0}, {"port_rpm": 80.0}]
    >>> runs = shipcosim.simulate_many("gunnerus_open", variations=speeds, record="vessel.u", stop_time=1.0)
    >>> dict(runs.sizes), bool(runs["vessel.u"][1, -1] > runs["vessel.u"][0, -1])
    ({'variation': 2, 'time': 21}, True)
    """
    if engine not in ("native", "fmpy"):
        found = f"engine = {engine!r}."
        raise ShipcosimError(Problem("simulate_many()", found, "Variations are run by 'native' or 'fmpy'."))
    if scenario is not None and not isinstance(scenario, Scenario):
        scenario = read_scenario(scenario)
    system = _system(system, scenario, _components(components))
    start_time = system.experiment.start_time if scenario is None else 0.0
    times = {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    keys = _given(times) | {"set": _mapping("set", set), "events": list(events)}
    scenario = _scenario(scenario, system.experiment, keys)
    varied = [_variation(system, scenario, dict(one)) for one in _records(variations)]
    wanted = [record] if isinstance(record, str) else record
    return _simulate_many(
        with_values(system, scenario.set, str(scenario.path or "scenario")),
        scenario,
        varied,
        RunOptions(engine=engine, start_time=start_time, progress=progress),
        choose=tuple if wanted is None else lambda names: chosen(names, wanted),
        reduce=reduce,
        workers=workers,
    )


@with_known_keywords
def sweep(
    study: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    engine: str = "native",
    set: Mapping[str, object] | None = None,
    at_most: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    force: bool = False,
) -> StudyResult:
    """Run a study: a scenario many times, with other weather, events, parameters.

    It goes on where it was interrupted. A run that fails is a row with its error.

    Parameters
    ----------
    study : path or name
        A study file, or its name: ``"wind_limits"``.
    out : path, optional
        Folder of the results; results/STUDY without.
    scheduler : str, optional
        Address of a scheduler of Dask; processes of this machine without.
    workers : int, optional
        Processes of this machine; one a core without.
    engine : str
        ``"native"`` or ``"fmpy"``, as in `shipcosim.options.RunOptions`.
    set : mapping of str to value, optional
        Start values of all runs, over those of scenario and study; factors go before them.
    at_most : int, optional
        Do at most so many runs now.
    progress : callable, optional
        Called with (runs done, runs in all).
    force : bool
        Do all runs again, and replace earlier results.

    Returns
    -------
    StudyResult

    Raises
    ------
    ShipcosimError
        If something does not fit together, or results cannot be written.
    """
    from shipcosim.results.study import StudyResult
    from shipcosim.sweep import plan_of, read_study, run_study

    plan = plan_of(read_study(_found("study", study)), _mapping("set", set))
    folder = Path("results") / plan.study.name if out is None else Path(out)
    swept = run_study(
        plan,
        folder,
        engine=engine,
        scheduler=scheduler,
        workers=workers,
        at_most=at_most,
        progress=progress,
        force=force,
        again=force,
    )

    def run_again(number: int) -> Run:
        return run(plan.alone(number), engine=engine)

    found = StudyResult(**parts_of(swept), simulate=run_again)
    found.page().save(folder / "report.html")
    return found


def read(path: str | os.PathLike[str], *, fmus: Iterable[str | os.PathLike[str]] | None = None) -> SystemStructure:
    """Read a system structure to look at it, change it, run it, write it.

    Parameters
    ----------
    path : path or name
        A .ssp (with ``#Variant.ssd`` behind it for another SSD), a folder with a SystemStructure.ssd, a .ssd, or the
        name of a system.
    fmus : iterable of path, optional
        Folders searched for FMUs that are not beside the SSD; those of its project and ours if not given.

    Returns
    -------
    SystemStructure
        It may have faults: `check` tells them.

    Raises
    ------
    ShipcosimError
        If there is no such system.

    Examples
    --------
    >>> import shipcosim
    >>> sorted(shipcosim.read("otter_open").components)
    ['environment', 'left', 'right', 'vessel']
    """
    found = _found("system", path)
    return _read(found, fmus=library.fmus(found) if fmus is None else fmus)


def read_scenario(scenario: str | os.PathLike[str]) -> Scenario:
    """Read and check a scenario file.

    Parameters
    ----------
    scenario : path or name

    Raises
    ------
    ShipcosimError
        With every problem of the file: its line, what was found, what would be right.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.read_scenario("gust").system
    'gunnerus_dp'
    """
    return _read_scenario(_found("scenario", scenario))


@with_known_keywords
def read_log(log: AnyLog, channels: str | os.PathLike[str] | None = None) -> Log:
    """Read a measured log, every row of it, to look at it before it is diagnosed.

    Parameters
    ----------
    log : path, name of an example, or xarray.Dataset
        Measured data, see docs/measured-data.md.
    channels : path, optional
        Channel file: which column is what, in which unit.

    Returns
    -------
    Log

    Raises
    ------
    ShipcosimError
        With all that is wrong: a column that is missing, not numeric or in a unit of something else, no time.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.read_log("gunnerus_log")["heading"].attrs["units"]
    'deg'
    """
    from shipcosim.diagnose.log.reader import read_log

    source, channels = _source(log, channels)
    return Log(_name(source), read_log(source, channels), source, channels)


@overload
def diagnose(
    log: AnyLog,
    system: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    causes: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    reference: str | os.PathLike[str] | Reference | None = None,
) -> DiagnosisOfLog: ...
@overload
def diagnose(
    log: Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    causes: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    reference: str | os.PathLike[str] | Reference | None = None,
) -> DiagnosisOfLogs: ...
@with_known_keywords
def diagnose(
    log: AnyLog | Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    causes: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    reference: str | os.PathLike[str] | Reference | None = None,
) -> DiagnosisOfLog | DiagnosisOfLogs:
    """Say what the simulation gets wrong of a log, and why: causes by name, the system with them, what that gains.

    Parameters
    ----------
    log : path, name of an example, Log, Run, xarray.Dataset, or a list of them
        Measured data, see docs/measured-data.md; several logs of one ship are weighed together.
    system : path, name, SystemStructure or System, optional
        The ship that the log is held against; gunnerus_open if not given.
    channels : path, optional
        Channel file: which column is what, in which unit.
    causes : path, optional
        Folder with further causes.
    progress : callable, optional
        Called with what is being done, in words; for the co-simulations also with how many are done and of how many.
    out : path, optional
        Folder that gets diagnosis.json, report.html, and extended.ssp and extended.ssv where a cause of the physics
        is named; nothing is left on the disk without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    reference : path or Reference, optional
        What logs in which the ship was well say of her, as a calibration leaves it: what has changed since is told.

    Returns
    -------
    DiagnosisOfLog
        Or DiagnosisOfLogs of a list.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    from shipcosim.diagnose.joint_pipeline import diagnose_jointly
    from shipcosim.diagnose.pipeline import diagnose
    from shipcosim.results.diagnosis import DiagnosisOfLog, DiagnosisOfLogs

    ship = _ship(system)
    with _written(out, force, EXTENDED) as stage:
        if isinstance(log, Sequence) and not isinstance(log, str):
            sources = [_source(one, channels)[0] for one in log]
            found = diagnose_jointly(sources, ship, channels, causes, progress, out=stage, reference=reference)
            result = DiagnosisOfLogs(**parts_of(found))
        else:
            source, channels = _source(log, channels)
            found = diagnose(source, ship, channels, causes, progress, out=stage, reference=reference)
            result = DiagnosisOfLog(**parts_of(found))
        if stage is not None:
            result.write(stage)
    if out is None or result.extension is None:
        return result
    at_home = {kind: Path(out) / f"extended.{kind}" for kind in ("ssp", "ssv")}
    return replace(result, extension=replace(result.extension, **at_home))


@with_known_keywords
def replay(
    log: AnyLog,
    system: AnySystem | None = None,
    before: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    *,
    horizon: float | str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Replay:
    """Predict a log piece by piece, each from the measured state, with one system or with two.

    Parameters
    ----------
    log
        As for `diagnose`, one log.
    system : path, name, SystemStructure or System, optional
        The ship, or the ``extended`` system of a diagnosis; gunnerus_open if not given.
    before : like `system`, optional
        The system to compare with.
    channels : path, optional
        Channel file.
    horizon : float, optional
        Length of each prediction; one that fits the craft and the log if not given. [s]
    progress : callable, optional
        Called with (predictions done, predictions in all).

    Returns
    -------
    Replay

    Raises
    ------
    ShipcosimError
        Data or systems that cannot be used.
    """
    from shipcosim.diagnose.replays import replay_log
    from shipcosim.results.studies import Replay

    source, channels = _source(log, channels)
    after = _system(SYSTEM_OF_LOGS if system is None else system)
    systems = {"simulated": after} if before is None else {"before": _system(before), "after": after}
    found = replay_log(source, systems, channels, horizon=_times({"horizon": horizon})["horizon"], progress=progress)
    return Replay(**parts_of(found), name=_name(source), systems=tuple(one.name for one in systems.values()))


@with_known_keywords
def calibrate(
    logs: AnyLog | Sequence[AnyLog],
    system: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    causes: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> Calibration:
    """Fit a ship's numbers to logs in which she is known to be well: her own parameter set, and a reference.

    Parameters
    ----------
    logs, system, channels, causes, progress
        As for `diagnose`.
    out : path, optional
        Folder that gets calibrated.ssv, reference.json and report.html, the page alone where the logs are refused;
        nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.

    Returns
    -------
    Calibration
        Its ``reference`` is what `diagnose` takes.

    Raises
    ------
    ShipcosimError
        Data, system or causes that cannot be used.
    """
    from shipcosim.diagnose.calibration_pipeline import calibrate
    from shipcosim.results.studies import Calibration

    several = logs if isinstance(logs, Sequence) and not isinstance(logs, str) else [logs]
    sources = [_source(one, channels)[0] for one in several]
    with _written(out, force, CALIBRATED) as stage:
        result = Calibration(**parts_of(calibrate(sources, _ship(system), channels, causes, progress, out=stage)))
        if stage is not None:
            result.page().save(stage / "report.html")
    return result


@with_known_keywords
def sea_trials(
    log: AnyLog,
    system: AnySystem | None = None,
    channels: str | os.PathLike[str] | None = None,
    causes: str | os.PathLike[str] | None = None,
    *,
    orders: bool = False,
) -> SeaTrials:
    """Say what a simulation gets wrong of a ship's trials: straight runs, turning circles, zig-zags.

    Parameters
    ----------
    log, system, channels, causes
        As for `diagnose`, one log.
    orders : bool
        Whether the thrusters' channels are orders, which the units follow, instead of feedback.

    Returns
    -------
    SeaTrials

    Raises
    ------
    ShipcosimError
        Data that cannot be used; no turning circle.
    """
    from shipcosim.diagnose.sea_trials.study import study
    from shipcosim.results.studies import SeaTrials

    source, channels = _source(log, channels)
    ship = _system(SYSTEM_OF_LOGS if system is None else system)
    found = study(source, ship, channels, causes, orders=orders)
    return SeaTrials(**parts_of(found), name=_name(source), system=ship.name)


@with_known_keywords
def compare(
    what: Scenario | AnySystem,
    *,
    stop_time: float | str | None = None,
    step_size: float | str | None = None,
    set: Mapping[str, object] | None = None,
    tolerance: float = 1e-9,
    progress: Callable[[int, int], None] | None = None,
) -> EngineComparison:
    """Run on every engine that is installed, and on ours with half the step; say by how much each signal differs.

    Parameters
    ----------
    what : Scenario, SystemStructure, System, path or name
        A scenario or a system; a name is a scenario's where there is one.
    stop_time, step_size : float, optional
        In place of the scenario's, or of the system's default experiment. [s]
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    tolerance : float
        Difference from which on a signal differs, relative to its range.
    progress : callable, optional
        Called with (parts done, parts in all).

    Returns
    -------
    EngineComparison

    Raises
    ------
    ShipcosimError
        If our own engine cannot run it.
    """
    from shipcosim.cosim.compare import compare
    from shipcosim.results.studies import EngineComparison

    given = what if isinstance(what, Scenario) else None
    if isinstance(what, (str, os.PathLike)) and _is_scenario(what):
        given = read_scenario(what)
    system = _system(what if given is None else None, given)
    times = _given({"stop_time": stop_time, "step_size": step_size})
    scenario = _scenario(given, system.experiment, times | {"set": _mapping("set", set), "events": []})
    found = compare(system, scenario, RunOptions(progress=progress), tolerance=tolerance)
    return EngineComparison(**parts_of(found), name=scenario.name or system.name)


@with_known_keywords
def capability(
    system: str | os.PathLike[str] = SYSTEM_OF_CAPABILITY,
    *,
    parameters: Sequence[str | os.PathLike[str]] = (),
    ship: str | None = None,
    failures: Sequence[Sequence[str]] = (),
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> CapabilityOfShip:
    """Static DP capability: the weather that a ship's thrusters balance, intact and after each single failure.

    Parameters
    ----------
    system : path or name
        A system with thrusters.
    parameters : sequence of path or name
        Parameter sets over the system's own; the last wins.
    ship : path or name, optional
        Ship with capability.toml; the one that is named as the last set if not given.
    failures : sequence of sequence of str
        Thrusters that one failure takes out together: ``[("port", "tunnel")]``.
    out : path, optional
        Folder that gets report.html, capability.csv and capability.nc; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.

    Returns
    -------
    CapabilityOfShip

    Raises
    ------
    ShipcosimError
        With everything that is missing or cannot be.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.capability().notation
    'DP capability-L1(5, 4, 0, 0)'
    """
    from shipcosim.capability import capability_of, vessel_of
    from shipcosim.results.studies import CapabilityOfShip

    sets = [parameters] if isinstance(parameters, (str, os.PathLike)) else parameters
    groups = [(one,) if isinstance(one, str) else tuple(one) for one in failures]
    result = CapabilityOfShip(**parts_of(capability_of(vessel_of(system, sets, ship), groups)))
    if out is not None:
        result.save(out, force=force)
    return result


@with_known_keywords
def check(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    *,
    channels: str | os.PathLike[str] | None = None,
    hosts: Sequence[str] = (),
    strict: bool = False,
) -> CheckedFiles:
    """Validate files: schema, then meaning. Loads no binary and runs nothing.

    Parameters
    ----------
    files : path or name, or a list of them
        Systems, scenarios, parameter sets, FMUs, ship files, measured data.
    channels : path, optional
        Channel file of measured data.
    hosts : sequence of str
        ``"libcosim"`` or ``"ecos"``: what it would ignore or refuse is an error.
    strict : bool
        Refuse what breaks a standard, even where it can mean one thing only.

    Returns
    -------
    CheckedFiles

    Raises
    ------
    ShipcosimError
        If there is no such file, name or tool.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.check("four_corner").passed
    True
    """
    from shipcosim.checks import check_any, variables_in
    from shipcosim.errors import held_strictly
    from shipcosim.results.check import CheckedFiles
    from shipcosim.ssp.portability.check import check_host

    several = [files] if isinstance(files, (str, os.PathLike)) else files
    tools = [hosts] if isinstance(hosts, str) else hosts
    for tool in tools:
        check_host(tool)
    paths = {os.fspath(one): library.find_any(os.fspath(one)) for one in several}
    table = None if channels is None else Path(channels)
    found = {name: check_any(path, table, tools) for name, path in paths.items()}
    held = {name: tuple(held_strictly(problems) if strict else problems) for name, problems in found.items()}
    rows = {name: tuple(variables_in(path)) for name, path in paths.items()}
    return CheckedFiles(held, {name: variables for name, variables in rows.items() if variables})


def _is_scenario(given: str | os.PathLike[str]) -> bool:
    return os.fspath(given).endswith(".toml") or library.named("scenario", os.fspath(given)) is not None


@contextmanager
def _written(out, force, names):
    """A folder whose files move into `out` at the end; None where nothing is to be written."""
    if out is None:
        yield None
        return
    with staged(Path(out), names, force=force) as stage:
        yield stage


def _name(source):
    return Path(source).name if isinstance(source, (str, os.PathLike)) else "log"


def _run(system, scenario, options, out, force, *, remarks=(), planned=0.0):
    """Simulate, judge what lies within the run, and write it where somebody asks for that.

    `planned` is the stop time for which the expectations were written. [s]
    """
    remarks = [*remarks, *(one for one in system.remarks if one.where not in system.components)]
    happening = with_values(system, scenario.set, str(scenario.path or "scenario"))
    of_times = check_times(scenario) if scenario.stop_time < planned else ()  # a shorter run leaves things out
    remarks += [one for one in check_scenario(scenario, happening) if one not in of_times and one.severity != "error"]
    table = _simulate(system, scenario, options)
    judged, late = within_run(scenario, table, planned)
    verdicts = judge(table, scenario.model_copy(update={"expect": judged}))
    result = Run(table, scenario, system, tuple(verdicts), tuple(late), tuple(remarks))
    if out is not None:
        result.save(out, force=force)
    return result


def _system(system, scenario=None, components=None):
    """The checked system that a user means, or the scenario's where none is given."""
    if system is None:
        system = scenario.system_path if scenario is not None else _missing("system", "Give a system or a scenario.")
    if isinstance(system, System):
        if components:
            found = "A system that is read keeps its FMUs."
            raise ShipcosimError(Problem("components", found, "Give its path, its name or a SystemStructure."))
        return system
    parameters = () if scenario is None else scenario.parameter_paths
    swapped = ({} if scenario is None else scenario.component_paths()) | (components or {})
    if not isinstance(system, SystemStructure):
        system = _found("system", system)
        if osp_file(system):
            return read_system(system, parameters, components=swapped)
        system = read(system)
    return system.checked(parameters, swapped)


def _components(given: Mapping[str, str | os.PathLike[str]] | None) -> dict[str, Path]:
    """FMUs in place of components' own, by path or name."""
    return {name: _found("fmu", fmu).resolve() for name, fmu in _mapping("components", given).items()}


def _ship(system):
    """The ship of a diagnosis: a structure stays one, so that what was changed in it is in the extended system too."""
    if isinstance(system, (System, SystemStructure)):
        return system
    path = _found("system", SYSTEM_OF_LOGS if system is None else system)
    return read_system(path) if osp_file(path) else read(path)


def _source(log, channels):
    """A log for the functions of the rooms, with its channel file."""
    if isinstance(log, Log):
        return log.source, log.channels if channels is None else channels
    if isinstance(log, Run):
        return log.table, channels
    return log if hasattr(log, "data_vars") else _found("example", log), channels


def _found(kind, given):
    """Path of what a user means; `library.find` says what there is where there is no such thing."""
    if not isinstance(given, (str, os.PathLike)):
        raise ShipcosimError(Problem(kind, f"{given!r:.60} is neither a path nor a name.", "Give one of them."))
    return library.find(kind, given)


def _fitting(parameters: Sequence[str | os.PathLike[str]], system: System) -> tuple[dict[str, Any], list[Problem]]:
    """Start values of parameter sets as far as the system has what they are for, and remarks on the rest."""
    values, remarks = {}, []
    for file in [parameters] if isinstance(parameters, (str, os.PathLike)) else parameters:
        fitting, left_out = fitting_values(file, system)
        values |= fitting
        remarks += left_out
    return values, remarks


def _records(variations) -> list[Mapping[str, Any]]:
    """Variations as mappings; what is missing in a table is left out."""
    if hasattr(variations, "to_dataframe"):
        variations = variations.to_dataframe()
    if not hasattr(variations, "to_dict"):
        return [_mapping("variations", one) for one in variations]
    rows = variations.to_dict("records")
    return [{str(name): value for name, value in row.items() if value == value} for row in rows]


def _variation(system: System, scenario: Scenario, given: dict[str, Any]) -> Variation:
    """A variation as the engine takes it: parameter sets as values, its own events and end in its scenario."""
    fitting, _ = _fitting(given.pop("parameters", ()), system)
    own = _given({"stop_time": given.pop("stop_time", None)}) | {"set": {}, "events": list(given.pop("events", ()))}
    values = {name: value.item() if hasattr(value, "item") else value for name, value in given.items()}
    is_plain = not own["events"] and "stop_time" not in own
    return Variation(fitting | values, scenario if is_plain else _scenario(scenario, system.experiment, own))


def _mapping(name, given):
    if given is not None and not isinstance(given, Mapping):
        raise ShipcosimError(Problem("", f"{name} = {given!r:.60}.", 'Give a dict: {"vessel.mass": 5e5}.'))
    return dict(given or {})


def _given(keys):
    return {name: value for name, value in keys.items() if value is not None}


def _scenario(given, experiment, keys):
    """Scenario of keys, over those of another one or over the system's default experiment; checked."""
    if given is None:
        keys = _given({"stop_time": experiment.stop_time, "step_size": experiment.step_size}) | keys
    else:
        had = given.model_dump(exclude_defaults=True)
        keys["set"] = had.get("set", {}) | keys["set"]
        keys["events"] = [*had.get("events", ()), *keys["events"]]
        keys = had | keys
    try:
        scenario = Scenario.model_validate(keys)
    except ValidationError as error:
        raise ShipcosimError(problems_in(error, "simulate")) from None
    problems = [problem for problem in check_times(scenario) if problem.severity == "error"]
    if problems:
        raise ShipcosimError(problems)
    return scenario if given is None else given.model_copy(update={name: getattr(scenario, name) for name in keys})


def _options(given: Mapping[str, Any]) -> RunOptions:
    return RunOptions(**_times(given))


def _times(given: Mapping[str, Any]) -> dict[str, Any]:
    """Keywords with the times among them in seconds."""
    found, problems = dict(given), []
    for name in {"start_time", "until", "timeout", "horizon"} & found.keys():
        if isinstance(found[name], str):
            try:
                found[name] = seconds(found[name])
            except UnitError as error:
                problems.append(Problem(name, error.found, error.remedy))
    if problems:
        raise ShipcosimError(problems)
    return found


def _missing(name, remedy):
    raise ShipcosimError(Problem("simulate", f"{name} is missing.", remedy))
