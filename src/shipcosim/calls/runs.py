"""Runs: planned, simulated, judged, saved. `shipcosim.run` and `shipcosim run` both come through here."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from shipcosim.calls.arguments import (
    AnyPath,
    AnyScenario,
    AnySystem,
    AnyTime,
    Components,
    Reading,
    Settings,
    fmus_of,
    in_seconds,
    listed,
    mapping,
    named,
    read_scenario,
    scenario_of,
    values_of_sets,
    with_osp_events,
    without_none,
)
from shipcosim.cosim import Interrupted, RunError, Snapshot, interpolated, write_snapshot
from shipcosim.cosim import simulate as simulate_system
from shipcosim.cosim.simulate import clock_start, with_open_snapshot
from shipcosim.errors import Problem, ShipcosimError, error_at
from shipcosim.keywords import with_known_keywords
from shipcosim.options import RunKeywords, RunOptions
from shipcosim.results.run import Run
from shipcosim.scenario import (
    Record,
    Scenario,
    check_scenario,
    check_times,
    judge,
    units_of,
    with_numbers,
    within_run,
)
from shipcosim.scenario.signals import chosen
from shipcosim.ssp import System, read_log_config, settings_for, step_remarks, with_values
from shipcosim.ssp.read.structure import label
from shipcosim.staging import check_targets, set_file_aside
from shipcosim.units import as_python

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True)
class PreparedRun:
    """A run that is read and checked, and has not begun.

    Attributes
    ----------
    system : System
        What will run.
    scenario : Scenario
        What will happen, and what must hold.
    options : RunOptions
        How it is run.
    changed : tuple of str
        What this run changes of what the files say.
    remarks : tuple of Problem
        What does not stop the run and should be known.
    planned : float
        Stop time for which the expectations were written, where the scenario's is shorter. [s]
    """

    system: System
    scenario: Scenario
    options: RunOptions
    changed: tuple[str, ...] = ()
    remarks: tuple[Problem, ...] = ()
    planned: float = 0.0

    def run(self, out: AnyPath | None = None, *, force: bool = False) -> Run:
        """Simulate, judge, and write the results where a folder is given.

        Parameters
        ----------
        out : path, optional
            Folder of the results. What there is of a run that does not get to its end is written there, too.
        force : bool
            Replace earlier results instead of keeping them in a numbered folder beside it.

        Raises
        ------
        ShipcosimError
            If the results cannot be written. As RunError, with the rows so far, if the run fails.
        Interrupted
            On Ctrl-C, with the rows so far.
        """
        # A long run must not end with results that cannot be written.
        state = self.options.store
        state_file = Path(state) if isinstance(state, (str, os.PathLike)) else None
        check_targets(None if out is None else Path(out), state_file)

        # The state is written after the results, so that earlier states are kept until there is a new one.
        snapshots: list[Snapshot] = []
        options = (
            self.options if state_file is None else replace(self.options, store=snapshots.append)
        )
        try:
            table = simulate_system(self.system, self.scenario, options)
        except (Interrupted, RunError) as stop:
            if out is not None:
                self._save_part(stop, out, force)
            raise
        result = self.judged(table)
        if out is not None:
            result.save(out, force=force)
        for snapshot in snapshots:
            assert state_file is not None
            set_file_aside(state_file, force=force)
            write_snapshot(snapshot, state_file)
        return result

    def finish(self, out: AnyPath, *, force: bool = False) -> Run:
        """The run, or its part with `errors` where a component failed on its way, which is a finding; as `run` else."""
        try:
            return self.run(out, force=force)
        except RunError as error:
            if not error.table.sizes["time"]:
                raise
            return self.part(error)

    def judged(self, table: xarray.Dataset) -> Run:
        """The run of a table: its changes, the expectations within it, and whether they hold.

        Parameters
        ----------
        table : xarray.Dataset
            As `shipcosim.cosim.simulate` gives it.
        """
        # What a run was is kept in its table, and so in result.nc and on every page that is made of it.
        texts = [str(remark) for remark in self.remarks]
        during = json.loads(table.attrs.get("remarks", "[]"))
        table = table.assign_attrs(
            remarks=json.dumps([*texts, *during]), changed=json.dumps(list(self.changed))
        )
        # A whole run needs no words on what part of it is judged.
        first, last = table["time"].values[[0, -1]]
        planned = max(self.planned, self.scenario.stop_time)
        if first != 0.0 or last < planned - 1e-9:
            table = table.assign_attrs(judged_on=f"{first:g} to {last:g} s of {planned:g} s")
        reached, late = within_run(self.scenario, table, self.planned)
        in_numbers = with_numbers(
            self.scenario.model_copy(update={"expect": reached}), units_of(self.system)
        )
        verdicts = judge(table, in_numbers)
        table = self._recorded(table)
        result = Run(table, self.scenario, self.system, tuple(verdicts), tuple(late), self.remarks)
        return replace(
            result, table=table.assign_attrs(not_reached=json.dumps(result.claims_not_reached()))
        )

    def _recorded(self, table: xarray.Dataset) -> xarray.Dataset:
        """Signals that the scenario records, and those of its expectations; all signals if it chooses none."""
        if not self.scenario.record.signals:
            return table
        names = list(map(str, table.data_vars))
        there = {signal for expect in self.scenario.expect for signal in expect.signals}
        wanted = {*chosen(names, self.scenario.record.signals), *there}
        return table[[name for name in names if name in wanted]]

    def part(self, stop: Interrupted | RunError) -> Run:
        """The part of a run that did not get to its end; nothing is judged."""
        table = self._recorded(stop.table).assign_attrs(changed=json.dumps(list(self.changed)))
        errors = stop.problems if isinstance(stop, RunError) else ()
        return Run(table, self.scenario, self.system, remarks=self.remarks, errors=tuple(errors))

    def _save_part(self, stop: Interrupted | RunError, out: AnyPath, force: bool) -> None:
        """Save the rows so far, unless there are none."""
        if not stop.table.sizes["time"]:
            return
        try:
            self.part(stop).save_part(out, force=force)
        except ShipcosimError as error:
            if not isinstance(stop, RunError):
                raise
            stop.problems += error.problems


def with_record(
    scenario: Scenario, system: System, record: AnyPath | Sequence[AnyPath], has_interval: bool
) -> Scenario:
    """The scenario with what is recorded of it.

    Parameters
    ----------
    scenario : Scenario
    system : System
        Whose signals these are.
    record : path or sequence of path
        Signals, components, connectors or patterns, in place of the scenario's; or a LogConfig.xml of libcosim, which
        gives the interval of rows, too. A connected input in it stands for its source.
    has_interval : bool
        Whether the interval is asked for otherwise.
    """
    signals: list[str] = []
    for entry in [os.fspath(path) for path in listed(record, "record")]:
        if not entry.lower().endswith(".xml"):
            signals.append(entry)
            continue
        config = read_log_config(entry)
        sources = {label(end): label(source) for end, source in system.feeding.items()}
        signals += [sources.get(signal, signal) for signal in config.signals]
        if not has_interval:
            interval = config.steps * scenario.step_size
            scenario = scenario.model_copy(update={"output_interval": interval})
    if signals:
        scenario = scenario.model_copy(update={"record": Record(signals=signals)})
    return scenario


@with_known_keywords
def run(
    scenario: AnyScenario,
    *,
    set: Settings = None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    fmus: Sequence[AnyPath] = (),
    events: Iterable[Mapping[str, object]] = (),
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    output_interval: AnyTime = None,
    record: AnyPath | Sequence[AnyPath] = (),
    strict: bool = False,
    out: AnyPath | None = None,
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
        out and listed in `Run.remarks`.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own, over those of the scenario: ``{"allocator": "my_allocator"}``.
    fmus : sequence of path
        Folders in which FMUs are looked for first.
    events : iterable of mapping
        As in a scenario file; added to its own.
    stop_time, step_size, output_interval : float, optional
        In place of the scenario's, in s or such as ``"10 min"``. [s]
    record : str or path, or a sequence of them
        What the table keeps: ``"vessel.*"``, a component, a connector, a signal, or a LogConfig.xml of libcosim. All
        signals without. Signals of expectations are always kept.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
    out : path, optional
        Folder that gets result.nc, result.csv, report.html, verdict.json, predictions.csv; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    engine, inputs, progress, order, until, resume, store, isolate, timeout, realtime, profile
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
    prepared = prepare_run(
        scenario,
        set=set,
        parameters=parameters,
        components=components,
        fmus=fmus,
        events=events,
        stop_time=stop_time,
        step_size=step_size,
        output_interval=output_interval,
        record=record,
        strict=strict,
        **options,
    )
    return prepared.run(out, force=force)


def prepare_run(
    scenario: AnyScenario,
    *,
    set: Settings = None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    fmus: Sequence[AnyPath] = (),
    events: Iterable[Mapping[str, object]] = (),
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    output_interval: AnyTime = None,
    record: AnyPath | Sequence[AnyPath] = (),
    strict: bool = False,
    changed: Sequence[str] = (),
    **options: Any,
) -> PreparedRun:
    """Read and check a run of a scenario; arguments and errors as for `run`.

    `changed` are further texts on what this run changes, as the row of a study.
    """
    given = read_scenario(scenario)
    # Parameter sets may have been made for another system: what fits is taken as start values, not as sets.
    system = Reading(components=components, fmus=fmus, strict=strict).system_of_scenario(given)
    fitting, left_out = values_of_sets(parameters, system)
    start_values = settings_for(system, mapping("set", set))
    with_values(system, start_values, named("set"))

    # What runs in place of components' own FMUs is part of the scenario, so that the table repeats the run.
    swapped = {name: str(path) for name, path in fmus_of(components).items()}
    given = given.model_copy(update={"components": given.components | swapped})
    times = without_none(
        {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    )
    happening = scenario_of(
        given, system, times | {"set": fitting | start_values, "events": list(events)}
    )
    happening = with_record(happening, system, record, output_interval is not None)
    how = options_of(options)
    texts = [
        *changed,
        *(f"records {Path(path).name}" for path in listed(record)),
        *changes(start_values, parameters, components, fmus, how),
        *times_changed(times, happening),
        *(f"event at {event.time:g} s" for event in happening.events[len(given.events) :]),
    ]
    how = with_open_snapshot(how)
    return _prepared(system, happening, how, texts, left_out, given.stop_time)


@with_known_keywords
def simulate(
    system: AnySystem | None = None,
    scenario: AnyScenario | None = None,
    *,
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    output_interval: AnyTime = None,
    record: AnyPath | Sequence[AnyPath] = (),
    set: Settings = None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    events: Iterable[Mapping[str, object]] = (),
    start_time: AnyTime = None,
    interpolate: Sequence[str] = (),
    max_gap: AnyTime = None,
    strict: bool = False,
    out: AnyPath | None = None,
    force: bool = False,
    **options: Unpack[RunKeywords],
) -> Run:
    """Run a system, one of ours or anybody's.

    Parameters
    ----------
    system : SystemStructure, System, path or name, optional
        What runs; the scenario's system if not given. The name of an FMU runs it alone.
    scenario : Scenario, path or name, optional
        What happens; the keywords add to it and go before it. A .json or .yaml is a scenario of OSP.
    stop_time, step_size, output_interval : float, optional
        By default those of the system's default experiment, and every step is a row. In s, or such as
        ``"10 min"``. [s]
    record : str or path, or a sequence of them
        What the table keeps: ``"vessel.*"``, a component, a connector, a signal, or a LogConfig.xml of libcosim. All
        signals without. Signals of expectations are always kept.
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    parameters : sequence of path
        Parameter sets (.ssv) over those of the system, where it is not a `System`; the last wins.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own, over those of the scenario, where the system is no `System`.
    events : iterable of mapping
        As in a scenario file: ``{"time": 10.0, "override": {"vessel.tau_X_5": 1e4}}``.
    start_time : float, optional
        As in `shipcosim.options.RunOptions`; by default that of the system's default experiment. [s]
    interpolate : sequence of str
        Columns of `inputs`, or patterns such as ``"*"``, that change linearly between their rows; others are held.
    max_gap : float, optional
        Longest time between two rows of `inputs` that is not taken for lost data. [s]
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
    out : path, optional
        Folder that gets result.nc, result.csv, report.html, verdict.json, predictions.csv; nothing is written without.
    force : bool
        Replace files of these names there, instead of keeping them in a numbered folder beside it.
    engine, inputs, progress, order, until, resume, store, isolate, timeout, realtime, profile
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
    prepared = prepare_simulation(
        system,
        scenario,
        stop_time=stop_time,
        step_size=step_size,
        output_interval=output_interval,
        record=record,
        set=set,
        parameters=parameters,
        components=components,
        events=events,
        start_time=start_time,
        interpolate=interpolate,
        max_gap=max_gap,
        strict=strict,
        **options,
    )
    return prepared.run(out, force=force)


def prepare_simulation(
    system: AnySystem | None = None,
    scenario: AnyScenario | None = None,
    *,
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    output_interval: AnyTime = None,
    record: AnyPath | Sequence[AnyPath] = (),
    set: Settings = None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    events: Iterable[Mapping[str, object]] = (),
    start_time: AnyTime = None,
    interpolate: Sequence[str] = (),
    max_gap: AnyTime = None,
    strict: bool = False,
    **options: Any,
) -> PreparedRun:
    """Read and check a run of a system; arguments and errors as for `simulate`."""
    osp_events = None
    if isinstance(scenario, (str, os.PathLike)) and not is_osp(scenario):
        scenario = read_scenario(scenario)
    elif not isinstance(scenario, Scenario):
        osp_events = scenario
        scenario = None
    ship = system_for(system, scenario, parameters, components, strict)

    # A run that continues has the start time of the run before; a scenario's times are on a clock that starts at 0.
    begin = start_time
    if begin is None:
        continues = options.get("resume") is not None
        begin = ship.experiment.start_time if scenario is None and not continues else 0.0
    inputs = fed_by(options.get("inputs"), ship, interpolate, max_gap)
    how = options_of({"start_time": begin, **options, "inputs": inputs})
    start_values = settings_for(ship, mapping("set", set))
    with_values(ship, start_values, named("set"))
    times = without_none(
        {"stop_time": stop_time, "step_size": step_size, "output_interval": output_interval}
    )
    keys = times | {"set": start_values, "events": list(events)}
    texts = changes(start_values, parameters, components, (), how)
    how = with_open_snapshot(how)
    since = _clock_start(how, is_given=start_time is not None)
    happening = scenario_of(scenario, ship, keys, since)
    happening, remarks = with_osp_events(happening, osp_events, how.start_time)
    happening = with_record(happening, ship, record, output_interval is not None)
    texts += [f"records {Path(path).name}" for path in listed(record)]
    if scenario is None and step_size is None:
        remarks += step_remarks(ship, since, happening.stop_time)
    if scenario is not None:
        texts += times_changed(times, happening)
    return _prepared(
        ship, happening, how, texts, remarks, 0.0 if scenario is None else scenario.stop_time
    )


def _clock_start(options: RunOptions, is_given: bool) -> float:
    """Time from which the steps of a run count; one that continues takes no other one. [s]"""
    since = clock_start(options)
    if is_given and since != options.start_time:
        raise error_at(
            named("start_time"), f"it continues a run that started at {since:g} s.", "Leave it out."
        )
    return since


def system_for(
    system: AnySystem | None,
    scenario: Scenario | None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    strict: bool = False,
) -> System:
    """The checked system that is given, or the scenario's, with the scenario's parameter sets and FMUs."""
    if scenario is not None and not isinstance(system, System):
        components = {**scenario.component_paths(), **(components or {})}
        parameters = [*scenario.parameter_paths, *listed(parameters, "parameters")]
        system = scenario.system_path if system is None else system
    if system is None:
        raise error_at("simulate", "system is missing.", "Give a system or a scenario.")
    return Reading(parameters=parameters, components=components, strict=strict).system(system)


def fed_by(
    table: xarray.Dataset | None,
    system: System,
    interpolate: Sequence[str],
    max_gap: AnyTime,
) -> xarray.Dataset | None:
    """The table that feeds a system's inputs, with what its columns do between their rows; arguments of `simulate`."""
    if table is None:
        if interpolate or max_gap is not None:
            raise error_at(
                f"{named('interpolate')}, {named('max_gap')}",
                "There is no table to which this could apply.",
                f"Give one as {named('inputs')}.",
            )
        return None
    longest = in_seconds({"max_gap": max_gap}, ["max_gap"])["max_gap"]
    table = interpolated(table, system, interpolate)
    return table if longest is None else table.assign_attrs(max_gap=longest)


def is_osp(path: AnyPath) -> bool:
    """Whether a scenario file is one of OSP, by its ending."""
    return os.fspath(path).lower().endswith((".json", ".yaml", ".yml"))


def options_of(given: Mapping[str, Any]) -> RunOptions:
    """Options of a run, with times that are texts in seconds.

    Raises
    ------
    ShipcosimError
        If a time is none, or a timeout is given for components that are not isolated.
    """
    if given.get("timeout") is not None and not given.get("isolate"):
        raise error_at(named("timeout"), "Without isolate there is no limit to a component's time.")
    return RunOptions(**in_seconds(given, ("start_time", "until", "timeout")))


def changes(
    start_values: Mapping[str, object],
    parameters: Sequence[AnyPath],
    components: Components,
    fmus: Sequence[AnyPath],
    options: RunOptions,
) -> list[str]:
    """Changes of a run against its files, each as a text; files by their names, so that the folder does not matter."""
    texts = [f"{name} = {_text(value)}" for name, value in start_values.items()]
    texts += [f"parameter set {Path(parameter).name}" for parameter in listed(parameters)]
    texts += [f"{name} runs {Path(fmu).name}" for name, fmu in (components or {}).items()]
    texts += [f"FMUs of folder {Path(path).name}" for path in listed(fmus)]
    if options.engine != RunOptions.engine:
        texts.append(f"engine {options.engine}")
    if options.order is not None:
        texts.append(f"order {options.order}")
    if options.until is not None:
        texts.append(f"until {options.until:g} s")
    if isinstance(options.resume, (str, os.PathLike)):
        texts.append(f"continued from {Path(options.resume).name}")
    return texts


def times_changed(times: Mapping[str, object], scenario: Scenario) -> list[str]:
    """Times of this run that replace those of its scenario, each as a text."""
    return [f"{name.replace('_', ' ')} {getattr(scenario, name):g} s" for name in times]


def _text(value: object) -> str:
    """A start value as it is written in a file."""
    if isinstance(value, bool):
        return str(value).lower()
    return str(as_python(value))


def _prepared(
    system: System,
    scenario: Scenario,
    options: RunOptions,
    changed: Sequence[str],
    remarks: Sequence[Problem],
    planned: float,
) -> PreparedRun:
    """Check a scenario with its system, and gather what should be known before the run."""
    happening = with_values(system, scenario.set, str(scenario.path or "scenario"))
    since = clock_start(options)
    problems = check_scenario(scenario, happening, since)
    notable = [*remarks, *happening.deviations]
    if errors := [problem for problem in problems if problem.is_error]:
        raise ShipcosimError([*notable, *errors])  # a remark on what was left out may say why
    # A run that is shorter than planned leaves events and expectations out on purpose.
    of_times = check_times(scenario, since) if scenario.stop_time < planned else ()
    notable += [problem for problem in problems if problem not in of_times]
    return PreparedRun(system, scenario, options, tuple(changed), tuple(notable), planned)
