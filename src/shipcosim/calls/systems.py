"""Systems: opened, checked, compared between engines, their capability."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim import library
from shipcosim.calls.arguments import (
    AnyPath,
    AnyScenario,
    AnySystem,
    AnyTime,
    Components,
    Reading,
    Settings,
    find,
    in_seconds,
    listed,
    mapping,
    named,
    path_or_name,
    system_and_scenario,
    without_none,
)
from shipcosim.errors import Problem, ShipcosimError, error_at, held_strictly
from shipcosim.keywords import with_known_keywords
from shipcosim.options import CountProgress, RunOptions
from shipcosim.results.check import CheckedFiles
from shipcosim.results.shown import parts_of
from shipcosim.scenario import Scenario
from shipcosim.ssp import System, SystemStructure, osp_file, pack
from shipcosim.ssp import read as read_structure
from shipcosim.staging import check_targets
from shipcosim.temporary import temporary_folder

if TYPE_CHECKING:
    from shipcosim.results.studies import CapabilityOfShip, EngineComparison

SYSTEM_OF_CAPABILITY = "gunnerus_dp"
"""Whose capability is computed where no system is given."""


def read(path: AnyPath, *, fmus: Iterable[AnyPath] | None = None) -> SystemStructure:
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
        It may have faults: `check` lists them.

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
    file = find("system", path)
    return read_structure(file, fmus=library.fmus(file) if fmus is None else fmus)


@with_known_keywords
def check(
    files: AnyPath | Sequence[AnyPath],
    *,
    channels: AnyPath | None = None,
    hosts: Sequence[str] = (),
    strict: bool = False,
) -> CheckedFiles:
    """Validate files: schema, then meaning. Loads no binary and runs nothing.

    Parameters
    ----------
    files : path or name, or a list of them
        Systems, scenarios, studies, causes, parameter sets, FMUs, ship files, channel files, measured data; of any
        other folder all that is in it.
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
        If there is no such tool, or none of the files and names is there.

    Examples
    --------
    >>> import shipcosim
    >>> shipcosim.check("four_corner").passed
    True
    """
    from shipcosim.checks import check_any, estimates_in, variables_in
    from shipcosim.ssp.portability.check import check_host

    tools = [hosts] if isinstance(hosts, str) else hosts
    for tool in tools:
        check_host(tool)
    table = None if channels is None else Path(channels)
    paths = {}
    by_file: dict[str, list[Problem]] = {}
    given = [os.fspath(file) for file in listed(files, "files")]
    for name in [name for each in given for name in library.files_of(each)]:
        try:
            paths[name] = library.find_any(name)
        except ShipcosimError as error:
            by_file[name] = error.problems
        else:
            by_file[name] = check_any(paths[name], table, tools)
    if not paths:
        missing = [problem for problems in by_file.values() for problem in problems]
        raise ShipcosimError(missing or Problem("files", "There is none.", "Name one to check."))
    held = {
        name: tuple(held_strictly(problems) if strict else problems)
        for name, problems in by_file.items()
    }
    variables = {name: tuple(rows) for name, path in paths.items() if (rows := variables_in(path))}
    estimates = {name: tuple(rows) for name, path in paths.items() if (rows := estimates_in(path))}
    return CheckedFiles(held, variables, estimates)


@with_known_keywords
def compare(
    what: AnyScenario | AnySystem,
    *,
    stop_time: AnyTime = None,
    step_size: AnyTime = None,
    set: Settings = None,
    parameters: Sequence[AnyPath] = (),
    components: Components = None,
    fmus: Sequence[AnyPath] = (),
    events: AnyPath | None = None,
    tolerance: float = 1e-9,
    as_read: bool = False,
    strict: bool = False,
    progress: CountProgress | None = None,
) -> EngineComparison:
    """Run on every installed engine, and on ours with half the step, and compare the signals.

    Parameters
    ----------
    what : Scenario, SystemStructure, System, path or name
        A scenario or a system; a name is a scenario's where there is one.
    stop_time, step_size : float, optional
        In place of the scenario's, or of the system's default experiment. [s]
    set : mapping of str to value, optional
        Start values by full name, in the FMUs' units.
    parameters : sequence of path
        Parameter sets (.ssv) over those of the scenario or system.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own.
    fmus : sequence of path
        Folders in which FMUs are looked for first.
    events : path, optional
        Scenario file of OSP (.json, .yaml): what happens besides.
    tolerance : float
        Difference above which a signal differs, relative to its range.
    as_read : bool
        Let libcosim and ecos read the file themselves, as their users run it.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
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

    reading = Reading(parameters=parameters, components=components, fmus=fmus, strict=strict)
    times = in_seconds({"stop_time": stop_time, "step_size": step_size}, ["stop_time", "step_size"])
    keys = without_none(times) | {"set": mapping("set", set)}
    system, scenario, remarks = system_and_scenario(what, reading, keys, events)
    with _as_read(what, system, scenario, parameters) if as_read else nullcontext({}) as tools:
        comparison = compare(
            system, scenario, RunOptions(progress=progress), tolerance=tolerance, **tools
        )
    name = scenario.name or system.name
    return EngineComparison(**parts_of(comparison), name=name, flaws=(*system.deviations, *remarks))


@contextmanager
def _as_read(
    given: AnyScenario | AnySystem,
    system: System,
    scenario: Scenario,
    parameters: Sequence[AnyPath],
) -> Iterator[dict[str, Any]]:
    """Arguments with which the tools of a comparison read a system's file themselves.

    Parameters
    ----------
    given : path or name
        An .ssp, a folder with a SystemStructure.ssd, or an OspSystemStructure.xml.
    system : System
        As we read it.
    scenario : Scenario
        Its steps.
    parameters : sequence of path
        Parameter sets that are not in the file: there must be none.

    Raises
    ------
    ShipcosimError
        If it is none of these, a component runs another FMU than the file says, or the system does not start at 0.
    """
    from shipcosim.cosim.engines.foreign_process import readers
    from shipcosim.ssp.portability.as_interpreted import taken_by, told_set

    if not isinstance(given, (str, os.PathLike)):
        raise error_at(
            "as_read", "There is no file that a tool could read.", "Give the path of one."
        )
    name = library.find_any(os.fspath(given))
    path = Path(name)
    fmus = library.fmus(name)
    if parameters:
        raise error_at(named("parameters"), "A tool that reads the file itself does not know them.")
    if system.swapped:
        message = f"A tool that reads the file itself runs the FMU that it names for {', '.join(system.swapped)}."
        raise error_at(
            name, message, f"Compare FMUs in place of others without {named('as_read')}."
        )
    if system.experiment.start_time:
        message = f"The system starts at {system.experiment.start_time:g} s, but a comparison starts at 0."
        raise error_at(name, message, "Let it start at 0.")
    with temporary_folder() as folder:
        if structure := osp_file(path):
            yield {"readers": readers(structure.resolve(), scenario)}
            return
        if path.is_dir():
            packed = Path(folder) / "system.ssp"
            pack(path, fmus, packed)
        elif path.suffix.lower() == ".ssp":
            packed = path.resolve()
        else:
            raise error_at(
                name,
                "The tools cannot read this themselves.",
                "Give an .ssp, a folder with a SystemStructure.ssd, or an OspSystemStructure.xml.",
            )
        yield {
            "readers": readers(packed, scenario, set_name=told_set(name, fmus=fmus)),
            "taken": partial(taken_by, path=name, fmus=fmus),
        }


@with_known_keywords
def capability(
    system: AnyPath = SYSTEM_OF_CAPABILITY,
    *,
    parameters: Sequence[AnyPath] = (),
    ship: str | None = None,
    failures: Sequence[Sequence[str]] = (),
    out: AnyPath | None = None,
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

    if out is not None:
        check_targets(Path(out))
    groups = [tuple(map(str, listed(failure or [failure], "failures"))) for failure in failures]
    sets = [Path(parameter) for parameter in listed(parameters, "parameters")]
    vessel = vessel_of(os.fspath(path_or_name("system", system)), sets, ship)
    result = CapabilityOfShip(**parts_of(capability_of(vessel, groups)))
    if out is not None:
        result.save(out, force=force)
    return result
