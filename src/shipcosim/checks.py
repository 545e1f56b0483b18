"""Checks of files of all kinds that the commands take."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, error_at, reading

if TYPE_CHECKING:
    from shipcosim.ssp import System

LATE = 1e9  # s; beyond what any run has
SMALLEST_STEP = 1e-6
OF_SHIP = {"particulars", "thrusters"}
OF_STUDY = {"factor", "quantity", "sample", "extends", "scenario"}
OF_CAUSE = {"cause", "sentence"}
OF_SCENARIO = {"system", "stop_time", "step_size", "events", "expect", "set"}
"""Keys that identify a kind of .toml file."""
OSP_SCENARIOS = (".json", ".yaml", ".yml")
NEAR = 1 << 16  # bytes: before its events a scenario has a description and defaults
TABLES = (".csv", ".csv.gz", ".nc", ".parquet")
OF_SYSTEMS = (*library.SYSTEMS, ".ssv", ".ssm", ".ssb", ".fmu")


def check_any(file: str, channels: Path | None = None, hosts: Iterable[str] = ()) -> list[Problem]:
    """Problems of a file; nothing is run and no binary loaded.

    Parameters
    ----------
    file : str
        A scenario, study, ship, cause or channel file (.toml), a scenario of OSP (.json, .yaml), a table (.csv,
        .csv.gz, .nc, .parquet), or a file of a system (see `shipcosim.ssp.check_file`).
    channels : path, optional
        Channel file of tables that are measured data.
    hosts : iterable of str
        Tools that are to read the file themselves; what they take otherwise is an error.

    Returns
    -------
    list of Problem

    Raises
    ------
    ShipcosimError
        If there is no such file.
    """
    path = Path(file.partition("#")[0])
    if not path.exists():
        raise error_at(file, "There is no such file or folder.", "Give the path of one.")
    try:
        if hosts and (problems := _host_problems(file, path, hosts)) is not None:
            return [*check_any(file, channels), *problems]
        if _is_ship(path):
            return check_ship_file(path)
        if path.suffix == ".toml":
            return _CHECKS[kind_of_toml(path)](path)
        if path.suffix.lower() in OSP_SCENARIOS and _names_events(path):
            return check_osp_scenario(path)
        if path.suffix.lower() in OF_SYSTEMS or path.is_dir() and not path.name.endswith(TABLES):
            return _check_system_file(file, path)
        if path.name.endswith(TABLES) and not channels and not _is_log(path):
            return check_table(path)
        return check_log(path, channels)
    except ShipcosimError as error:
        return error.problems


def _names_events(path: Path) -> bool:
    """Whether a file speaks of events near its beginning, as a scenario of OSP; records of a log do not."""
    with reading(path), path.open("rb") as file:
        return b"events" in file.read(NEAR)


def check_ship_file(path: Path) -> list[Problem]:
    """Problems of a ship file: missing and impossible numbers."""
    from shipcosim.ships.check import check_ship

    return check_ship(str(path))


def estimates_in(file: str) -> list[tuple[str, ...]]:
    """Estimated numbers of a ship as rows of text: number, value, tolerance, source; none for other files."""
    path = Path(file)
    if not _is_ship(path):
        return []
    from shipcosim.ships import describe
    from shipcosim.ships.check import estimated

    try:
        return [tuple(row) for row in estimated(describe(path))]
    except ShipcosimError:
        return []


def _is_ship(path: Path) -> bool:
    """Whether a path is a ship file, which has particulars or thrusters, or a folder with one."""
    if path.is_dir() or path.name == "ship.toml":
        return path.name == "ship.toml" or (path / "ship.toml").is_file()
    return path.suffix == ".toml" and kind_of_toml(path) == "ship"


def kind_of_toml(path: Path) -> str:
    """What a .toml describes, by its keys: ``"ship"``, ``"study"``, ``"cause"``, ``"channels"`` or ``"scenario"``."""
    from shipcosim.diagnose.log.roles import role_of

    keys = _keys_of(path)
    for kind, kind_keys in (
        ("ship", OF_SHIP),
        ("study", OF_STUDY),
        ("cause", OF_CAUSE),
        ("scenario", OF_SCENARIO),
    ):
        if keys & kind_keys:
            return kind
    return "channels" if any(role_of(key) for key in keys) else "scenario"


def is_scenario(path: Path) -> bool:
    """True for a .toml with several keys of a scenario, whatever is wrong with it; files of other tools have none."""
    return len(_keys_of(path) & OF_SCENARIO) > 1 and kind_of_toml(path) == "scenario"


def _keys_of(path: Path) -> set[str]:
    """Keys of the outermost table; empty for a file that is not text, which its reader reports."""
    from shipcosim.scenario import toml_of

    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError):
        return set()
    try:
        return set(toml_of(text))
    except ValueError:
        return _top_keys(text)  # faulty TOML: the reader of its kind says where


def _top_keys(text: str) -> set[str]:
    """Keys of the outermost table of a text that may be no TOML: those before the first table, and the tables."""
    keys = set()
    in_table = False
    for line in text.splitlines():
        name = _NAME.match(line[:LONGEST_NAME])
        if name is None:
            continue
        in_table = in_table or bool(name["table"])
        if name["table"] or not in_table:
            keys.add(name["key"])
    return keys


_NAME = re.compile(r"\s{0,8}(?P<table>\[{0,2})\s{0,8}\"?(?P<key>\w+)")
LONGEST_NAME = 100  # characters of a line in which its key is looked for


def check_cause_file(path: Path) -> list[Problem]:
    """Problems of the file of a cause."""
    from shipcosim.diagnose.hypotheses.catalogue import read_cause

    read_cause(path)
    return []


def check_channel_file(path: Path) -> list[Problem]:
    """Problems of a channel file, in itself."""
    from shipcosim.diagnose.log.channels import read_channels

    read_channels(path)
    return []


def check_study_file(path: Path) -> list[Problem]:
    """Problems of a study, in itself and with its scenario and system."""
    from shipcosim.sweep import plan_of, read_study

    plan_of(read_study(path), build=False)
    return []


def _host_problems(file: str, path: Path, hosts: Iterable[str]) -> list[Problem] | None:
    """How other tools would interpret a system, or a scenario's system with its exchanged FMUs; None for other files."""
    from shipcosim.scenario import check_files, read_scenario
    from shipcosim.ssp.portability.check import check_for

    is_system = path.suffix.lower() in library.SYSTEMS or path.is_dir()
    is_scenario = path.suffix.lower() == ".toml" and kind_of_toml(path) == "scenario"
    if not (is_system or is_scenario):
        return None
    system = file
    swapped = {}
    if path.suffix == ".toml":
        scenario = read_scenario(path)
        if check_files(scenario):
            return []
        system = scenario.system_path
        swapped = scenario.component_paths(build=False)
    fmus = library.fmus(system, build=False)
    return [
        problem
        for host in hosts
        for problem in check_for(host, system, fmus=fmus, components=swapped)
    ]


def variables_in(file: str) -> list[tuple[str, ...]]:
    """An FMU's variables as rows of text: name, causality, type, unit, start, description; none for other files."""
    from shipcosim.ssp.fmu.reader import describe_fmu
    from shipcosim.ssp.xml.document import Findings
    from shipcosim.ssp.xml.values import text_of

    fmu = describe_fmu(Path(file), Findings()) if file.lower().endswith(".fmu") else None
    return [
        (
            v.name,
            v.causality,
            v.type,
            v.unit or "",
            "" if v.start is None else text_of(v.start),
            v.description,
        )
        for v in (fmu.variables.values() if fmu else ())
    ]


def check_scenario_file(path: Path) -> list[Problem]:
    """Problems of a scenario, in itself and with its system."""
    from shipcosim.cosim import system_of
    from shipcosim.scenario import check_files, check_scenario, read_scenario
    from shipcosim.ssp import with_values

    scenario = read_scenario(path)
    if missing := check_files(scenario):
        return missing
    system = system_of(scenario, build=False)
    try:
        system = with_values(system, scenario.set, str(path))
        problems = []
    except ShipcosimError as error:
        problems = error.problems
    flaws = [problem for problem in system.remarks if problem.flaw]
    driven = _driven_by_water(str(path), system)
    return [*flaws, *problems, *check_scenario(scenario, system), *driven]


def _driven_by_water(file: str, system: System) -> list[Problem]:
    """Remarks on ships of a system that gain energy from still water."""
    from shipcosim.ships.passivity import driven_by_water

    # A component with other loads is a ship; a predictor has her numbers too.
    ships = {
        name: {variable: part.start_value(variable) for variable in part.variables}
        for name, part in system.components.items()
        if "tau_X_1" in part.variables
    }
    return [
        problem
        for name, values in ships.items()
        for problem in driven_by_water(f"{file}: {name}", values)
    ]


def check_osp_scenario(path: Path) -> list[Problem]:
    """Problems of a scenario of OSP, in itself and with the OspSystemStructure.xml beside it, where there is one."""
    from shipcosim.scenario import Scenario, check_scenario
    from shipcosim.scenario.osp import read_osp_scenario
    from shipcosim.ssp import osp_file, read_system

    structure = osp_file(path.parent)
    if structure is None:
        return read_osp_scenario(path, SMALLEST_STEP, LATE).remarks
    system = read_system(structure)
    step = system.experiment.step_size or SMALLEST_STEP
    stop = system.experiment.stop_time
    read = read_osp_scenario(path, step, stop or LATE)
    last = max((event.time for event in read.events), default=0.0) + step
    problems = check_scenario(
        Scenario(stop_time=stop or last, step_size=step, events=read.events), system
    )
    return [*read.remarks, *(replace(problem, where=str(path)) for problem in problems)]


def _is_log(path: Path) -> bool:
    """Whether a table has a column of the navigation, by its name, and so counts as measured data."""
    from shipcosim.diagnose.log.names.proposal import propose
    from shipcosim.diagnose.log.reader import columns_of
    from shipcosim.diagnose.log.roles import NAVIGATION

    columns = columns_of(path)
    if any("." in name for name in columns.values):
        return False  # signals of components
    roles = propose(columns).channels()
    return "time" in roles and not {*NAVIGATION, "latitude"}.isdisjoint(roles)


def check_log(path: Path, channels: Path | None = None) -> list[Problem]:
    """Faults of measured data as errors; what is ordinary in a log and handled, as remarks."""
    from shipcosim.diagnose.log.checks.examine import examine
    from shipcosim.diagnose.log.reader import read_log
    from shipcosim.diagnose.log.remarks import handled

    log = read_log(path, channels)
    problems = [Problem(str(path), remark, severity="remark") for remark in handled(log)]
    with np.errstate(all="ignore"):  # numbers beyond all bounds are among what it looks for
        faults = examine(log)
    for finding in faults:
        shown = [f"{first:g} to {last:g} s" for first, last in finding.segments[:3]]
        more = f" and {len(finding.segments) - 3} more" if len(finding.segments) > 3 else ""
        where = f"{path}, {', '.join(finding.channels[:3])}{', ...' if len(finding.channels) > 3 else ''}"
        values = "".join(f", {name} {e.estimate:.3g}" for name, e in finding.parameters.items())
        faults = f"{finding.cause}{values}: {finding.sentence}, {', '.join(shown) + more or 'throughout'}."
        problems.append(Problem(where, faults, f"Probability {finding.probability:.2f}."))
    return problems


def check_table(path: Path) -> list[Problem]:
    """Problems of a table: unordered or repeated times are errors, gaps and missing values remarks."""
    from shipcosim.series import read_table

    table = read_table(path)
    time = table["time"].values
    problems = []
    steps = np.diff(time)
    if not np.isfinite(time).all():
        problems.append(Problem(f"{path}, time", "Not every time is a number."))
    elif (steps <= 0.0).any():
        row = int(np.flatnonzero(steps <= 0.0)[0])
        remedy = "Times should increase from row to row."
        problems.append(
            Problem(
                f"{path}, row {row + 2}", f"{time[row + 1]:g} s follows {time[row]:g} s.", remedy
            )
        )
    elif len(steps) and steps.max() > 1.5 * np.median(steps):
        row = int(np.argmax(steps))
        message = f"{steps[row]:g} s without a row after {time[row]:g} s; the usual step is {np.median(steps):g} s."
        problems.append(Problem(f"{path}, time", message, severity="remark"))
    for name, variable in table.data_vars.items():
        missing = int(np.sum(~np.isfinite(variable.values))) if variable.dtype.kind == "f" else 0
        if missing:
            message = f"{missing} row{'s' * (missing > 1)} without a number."
            problems.append(Problem(f"{path}, {name}", message, severity="remark"))
    return problems


def _check_system_file(file: str, path: Path) -> list[Problem]:
    from shipcosim.ssp.check import check_file, problems_of
    from shipcosim.ssp.system_files import assemble

    fmus = library.fmus(path, build=False)
    if path.suffix.lower() in library.SYSTEMS or path.is_dir():
        system, findings = assemble(file, fmus=fmus)
        problems = problems_of(system, findings)
        if system is not None and not findings.errors:
            problems += _driven_by_water(file, system)
    else:
        problems = check_file(file, fmus=fmus)
    is_readable = not any(problem.is_error for problem in problems)
    if path.suffix.lower() == ".fmu" and is_readable:
        from shipcosim.cosim.slaves.validation import library_problems, validation_problems

        problems += [*validation_problems(path), *library_problems(path)]
    if any(problem.is_error for problem in problems):
        missing = [
            folder
            for folder in fmus
            if library.fmu_sources(folder.parents[1]) and not folder.is_dir()
        ]
        remedy = "`shipcosim build` builds them."
        problems += [
            Problem(str(folder), "There are no FMUs yet.", remedy, "remark") for folder in missing
        ]
    return problems


_CHECKS = {
    "ship": check_ship_file,
    "study": check_study_file,
    "cause": check_cause_file,
    "channels": check_channel_file,
    "scenario": check_scenario_file,
}
