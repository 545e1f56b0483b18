"""What the arguments of a command ask for: a system, a scenario, start values, a table of inputs."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray

from shipcosim import cosim, library
from shipcosim.cli.console import print_problems
from shipcosim.cosim import interpolated
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.options import RunOptions
from shipcosim.scenario import Scenario, check_files, check_times, read_scenario
from shipcosim.scenario.osp import read_osp_scenario
from shipcosim.series import read_table
from shipcosim.ssp import System, read_system, with_values


def system_of(
    given: str,
    parameters: Iterable[Path] | None = None,
    option: str = "",
    strict: bool = False,
    components: Mapping[str, Path] | None = None,
    first: Iterable[Path] = (),
) -> System:
    """The system of a file, folder or name, with our FMUs built where they are missing or out of date.

    Parameters
    ----------
    given : str
        A name of a system or of an FMU, which then runs alone, or as for `shipcosim.ssp.read_system`.
    parameters : iterable of Path, optional
        Parameter sets over those of the system.
    option : str
        Where it was given, for messages.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
    components : mapping of str to Path, optional
        FMUs that components run in place of their own.
    first : iterable of Path
        Folders in which FMUs are looked for first.

    Raises
    ------
    ShipcosimError
        If it is no system, or a faulty one.
    """
    is_fmu = not Path(given).exists() and library.named("system", given) is None and library.named("fmu", given)
    path = library.find("fmu" if is_fmu else "system", given, option)
    return read_system(path, parameters or (), fmus=[*first, *library.fmus(path)], components=components, strict=strict)


def system_and_scenario(
    given: str,
    parameters: Sequence[Path] | None = None,
    stop_time: float | None = None,
    step_size: float | None = None,
    events: Path | None = None,
    strict: bool = False,
    components: Iterable[str] | None = None,
    fmus: Sequence[Path] | None = None,
) -> tuple[System, Scenario]:
    """System and scenario of an argument that is either.

    Parameters
    ----------
    given : str
        A scenario (.toml, or its name) or a system.
    parameters : sequence of Path, optional
        Parameter sets over those of the scenario or the system.
    stop_time, step_size : float, optional
        In place of those of the scenario or the system. [s]
    events : Path, optional
        Scenario file of OSP: what happens besides.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only. Without it this is said.
    components : iterable of str, optional
        FMUs in place of components' own, over those of the scenario; as for `parsed_components`.
    fmus : sequence of Path, optional
        Folders in which FMUs are looked for first.

    Raises
    ------
    ShipcosimError
        If there is no such thing, or the times do not fit.
    """
    swapped = parsed_components(components or ())
    if not is_scenario(given):
        system = system_of(given, parameters, strict=strict, components=swapped, first=fmus or ())
        print_problems(problem for problem in system.remarks if problem.flaw)
        return system, with_osp_events(experiment_of(system, stop_time, step_size), events)
    scenario = read_scenario(library.find("scenario", given))
    if missing := check_files(scenario):
        raise ShipcosimError(missing)
    system = cosim.system_of(scenario, parameters=parameters or (), components=swapped, strict=strict, fmus=fmus or ())
    print_problems(problem for problem in system.remarks if problem.flaw)
    times = {"stop_time": stop_time, "step_size": step_size}
    scenario = scenario.model_copy(update={name: time for name, time in times.items() if time is not None})
    if problems := [problem for problem in check_times(scenario) if problem.severity == "error"]:
        raise ShipcosimError(problems)
    return system, with_osp_events(scenario, events)


def system_to_export(
    given: str,
    parameters: Sequence[Path] | None,
    step_size: float | None,
    strict: bool = False,
    components: Iterable[str] | None = None,
) -> tuple[System, float]:
    """System of an argument that is a system or a scenario, with the scenario's start values, and its step size. [s]

    Parameters
    ----------
    given : str
        As for `system_and_scenario`.
    parameters : sequence of Path or None
        Parameter sets over those of the scenario or the system.
    step_size : float or None
        In place of that of the scenario or the system. [s]
    strict : bool
        Whether flaws of form are errors.
    components : iterable of str, optional
        As for `system_and_scenario`.

    Raises
    ------
    ShipcosimError
        If there is no such thing, or nothing says a step size.
    """
    if is_scenario(given):
        system, scenario = system_and_scenario(
            given, parameters, step_size=step_size, strict=strict, components=components
        )
        return with_values(system, scenario.set, given), scenario.step_size
    system = system_of(given, parameters, strict=strict, components=parsed_components(components or ()))
    return system, experiment_of(system, system.experiment.stop_time or step_size or 1.0, step_size).step_size


def is_scenario(given: str) -> bool:
    """Whether an argument that is a scenario or a system is a scenario: by its ending, else by what has this name.

    Raises
    ------
    ShipcosimError
        If it is neither.
    """
    if given.endswith(".toml") or Path(given.partition("#")[0]).exists():
        return given.endswith(".toml")
    scenarios, systems = library.names("scenario"), library.names("system")
    if given not in scenarios and given not in systems:
        raise ShipcosimError(
            Problem(given, "There is no such scenario or system.", suggestion(given, {*scenarios, *systems}))
        )
    return given in scenarios


def experiment_of(system: System, stop_time: float | None = None, step_size: float | None = None) -> Scenario:
    """Scenario in which nothing happens, for as long and in such steps as asked for or as the system says.

    Raises
    ------
    ShipcosimError
        If neither says it, or the two do not fit together.
    """
    stop = stop_time if stop_time is not None else system.experiment.stop_time
    step = step_size if step_size is not None else system.experiment.step_size
    problems = [
        Problem(option, f"{value} is no {what}.", f"Give {option} in seconds, greater than 0.")
        for option, value, what in (("--stop-time", stop, "stop time"), ("--step-size", step, "step size"))
        if value is None or not value > 0.0
    ]
    if stop is None or step is None or problems:
        raise ShipcosimError(problems)
    scenario = Scenario(description=f"Simulation of {system.name}", stop_time=stop, step_size=step)
    if problems := [Problem("--stop-time, --step-size", p.found, p.remedy) for p in check_times(scenario)]:
        raise ShipcosimError(problems)
    return scenario


def with_osp_events(scenario: Scenario, path: Path | None, start_time: float = 0.0) -> Scenario:
    """Scenario with the events of an OSP scenario file added; the same without a path. Remarks are printed.

    Parameters
    ----------
    scenario : Scenario
        Its steps are the run's.
    path : Path or None
        Of the file.
    start_time : float
        Of the run. [s]
    """
    if path is None:
        return scenario
    read = read_osp_scenario(path, scenario.step_size, scenario.stop_time, start_time)
    print_problems(read.remarks)
    more = {"events": [*scenario.events, *read.events]}
    return scenario.model_copy(update=more | ({"description": read.description} if read.description else {}))


def inputs_of(path: Path | None, system: System, linear: Sequence[str], max_gap: float | None) -> xarray.Dataset | None:
    """Table that feeds a system's inputs, or None without a path.

    Parameters
    ----------
    path : Path or None
        Of a table.
    system : System
        With the inputs.
    linear : sequence of str
        Columns, or patterns of them, that change linearly between their rows.
    max_gap : float or None
        Longest time between two rows. [s]

    Raises
    ------
    ShipcosimError
        If there is no such file or column, or no table for these options.
    """
    if path is None:
        if linear or max_gap is not None:
            found = "There is no table that this could be about."
            raise ShipcosimError(Problem("--interpolate, --max-gap", found, "Give one with --inputs."))
        return None
    table = interpolated(read_table(path), system, linear)
    return table if max_gap is None else table.assign_attrs(max_gap=max_gap)


def parsed_settings(settings: Iterable[str]) -> dict[str, Any]:
    """Values of ``--set component.name=value``, each read as TOML; what is no TOML is text.

    Examples
    --------
    >>> parsed_settings(["vessel.mass=5e5", "port.failed=true", "environment.spectrum=kaimal"])
    {'vessel.mass': 500000.0, 'port.failed': True, 'environment.spectrum': 'kaimal'}
    """
    values, problems = {}, []
    for setting in settings:
        name, sign, text = setting.partition("=")
        if not sign or not name.strip():
            problems.append(Problem("--set", f"'{setting}' sets nothing.", "Right would be component.name=value."))
        values[name.strip()] = _parsed(text.strip())
    if problems:
        raise ShipcosimError(problems)
    return values


def parsed_components(given: Iterable[str]) -> dict[str, Path]:
    """FMUs of ``--component component=FMU``: a path, or the name of an FMU, which is built where it has to be.

    Raises
    ------
    ShipcosimError
        If one is none of that.
    """
    found, problems = {}, []
    for one in given:
        name, sign, fmu = (part.strip() for part in one.partition("="))
        if not (sign and name and fmu):
            problems.append(Problem("--component", f"'{one}' swaps nothing.", "Right would be component=FMU."))
            continue
        try:
            found[name] = library.find("fmu", fmu, "--component").resolve()
        except ShipcosimError as error:
            problems += error.problems
    if problems:
        raise ShipcosimError(problems)
    return found


def _parsed(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):
        return text


def changed_by(
    settings: Iterable[str] | None,
    parameters: Iterable[Path] | None,
    options: RunOptions,
    resume: Path | None = None,
    components: Iterable[str] | None = None,
    fmus: Iterable[Path] | None = None,
) -> list[str]:
    """What the command line changes of what the files say, for the page: each a text."""
    changed = [f"--set {' = '.join(part.strip() for part in one.split('=', 1))}" for one in settings or ()]
    changed += [f"--parameters {one}" for one in parameters or ()]
    changed += [f"--component {' = '.join(part.strip() for part in one.split('=', 1))}" for one in components or ()]
    changed += [f"--fmus {one}" for one in fmus or ()]
    changed += [f"--engine {options.engine}"] if options.engine != RunOptions.engine else []
    changed += [f"--until {options.until:g} s"] if options.until is not None else []
    return changed + ([f"--from {resume}"] if resume is not None else [])


def isolation(isolate: bool, timeout: float | None) -> dict[str, Any]:
    """Options of a run that --isolate and --timeout stand for.

    Raises
    ------
    ShipcosimError
        If there is a timeout of nothing.
    """
    if timeout is not None and not isolate:
        raise ShipcosimError(Problem("--timeout", "Without --isolate there is no limit to a component's time."))
    return {"isolate": isolate} | ({} if timeout is None else {"timeout": timeout})
