"""What the arguments of a call mean: a system, a scenario, FMUs, start values, logs, times.

Every call of `shipcosim` takes the same kinds of arguments, and the command line passes its own through here, too.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, suggestion
from shipcosim.results.log import Log
from shipcosim.results.run import Run
from shipcosim.scenario import Scenario, check_files, check_times
from shipcosim.scenario import read_scenario as read_scenario_file
from shipcosim.scenario.model import problems_in
from shipcosim.ssp import (
    AnyPath,
    AnySystem,
    System,
    SystemStructure,
    default_step_size,
    fitting_values,
    read_system,
    step_remarks,
)
from shipcosim.units import UnitError, as_python, is_finite, seconds

if TYPE_CHECKING:
    import xarray

Settings = Mapping[str, object] | None
"""Start values by full name."""


Components = Mapping[str, AnyPath] | None
"""FMUs that components run in place of their own."""


AnyTime = float | str | None
"""A time as users give it: in s, or a text with a unit, such as ``"10 min"``."""


AnyScenario = AnyPath | Scenario

SYSTEM_OF_LOGS = "gunnerus_open"
"""System that logs are compared with if none is given."""


def named(argument: str) -> str:
    """An argument as errors name it, for scripts and for the command line.

    Examples
    --------
    >>> named("stop_time")
    'stop_time (--stop-time)'
    """
    option = _OPTIONS.get(argument, argument.replace("_", "-"))
    return f"{argument} (--{option})"


_OPTIONS = {"output_interval": "every", "causes": "effects"}
"""Options of the command line that are not called as the argument of the Python call is."""


def find(kind: str, given: Any, argument: str = "") -> Path:
    """Path of a file or name, as `library.find`; errors name the argument."""
    return library.find(kind, path_or_name(kind, given), named(argument) if argument else "")


def path_or_name(what: str, given: Any) -> AnyPath:
    """The same value; raises ShipcosimError where it is of another type, as a number is."""
    if not isinstance(given, (str, os.PathLike)):
        raise error_at(what, f"{given!r:.60} is neither a path nor a name.", "Give one of them.")
    return given


def listed(given: Any, what: str = "") -> list[AnyPath]:
    """Paths or names as a list, also for a single one; errors name the argument."""
    if given is None:
        return []
    if isinstance(given, (str, os.PathLike)) or not isinstance(given, Iterable):
        given = [given]
    return [path_or_name(what, item) for item in given]


def mapping(argument: str, given: Any) -> dict[str, Any]:
    """An argument that is a mapping of names, as a dict; numbers of NumPy become those of Python."""
    given = {} if given is None else given
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
        raise error_at("", f"{argument} = {given!r:.60}.", 'Give a dict: {"vessel.mass": 5e5}.')
    return {name: as_python(value) for name, value in given.items()}


def without_none(values: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments that were given."""
    return {name: value for name, value in values.items() if value is not None}


def in_seconds(arguments: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Arguments with times as numbers, where they were amounts such as ``"10 min"``. [s]"""
    converted = dict(arguments)
    problems = []
    for name in names:
        if isinstance(converted.get(name), str):
            try:
                converted[name] = seconds(converted[name])
            except UnitError as error:
                problems.append(Problem(name, error.found, error.remedy))
                continue
        # NaN compares with nothing, so no later check would see it; and no run ends that has no end.
        value = converted.get(name)
        if value is None:
            continue
        if isinstance(value, Real) and not isinstance(value, bool) and is_finite(value):
            converted[name] = float(value)
        else:
            wrong = f"{name} = {value!r:.60} is no time."
            problems.append(Problem(named(name), wrong, "Give a number of seconds."))
    raise_errors(problems)
    return converted


def fmus_of(components: Components) -> dict[str, Path]:
    """FMUs in place of components' own, by path or name."""
    paths = {}
    problems = []
    for name, fmu in mapping("components", components).items():
        try:
            paths[name] = find("fmu", fmu, "component").resolve()
        except ShipcosimError as error:
            problems += error.problems
    raise_errors(problems)
    return paths


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How systems are read: with which parameter sets and FMUs, and how strictly.

    Parameters
    ----------
    parameters : sequence of path
        Parameter sets over those of the system or scenario; the last wins.
    components : mapping of str to path or name, optional
        FMUs that components run in place of their own.
    fmus : sequence of path
        Folders in which FMUs are looked for first.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
    """

    parameters: Sequence[AnyPath] = ()
    components: Components = None
    fmus: Sequence[AnyPath] = ()
    strict: bool = False

    def system(self, given: AnySystem, argument: str = "") -> System:
        """The checked system of a file, folder, name or structure, with our FMUs built where they are out of date.

        Parameters
        ----------
        given : path, name, SystemStructure or System
            The name may be that of an FMU, which then runs alone.
        argument : str
            Where it was given, for errors.
        """
        swapped = fmus_of(self.components)
        parameters = listed(self.parameters, "parameters")
        if isinstance(given, System):
            if swapped:
                raise error_at(
                    "components",
                    "A system that is read keeps its FMUs.",
                    "Give its path, its name or a SystemStructure.",
                )
            return given
        if isinstance(given, SystemStructure):
            return given.checked(parameters, swapped)
        path = _path_of_system(given, argument)
        folders = [*self._fmu_folders(), *library.fmus(path)]
        return read_system(path, parameters, fmus=folders, components=swapped, strict=self.strict)

    def _fmu_folders(self) -> list[Path]:
        """Folders of FMUs that were given; ShipcosimError if one is not there."""
        folders = [Path(path) for path in listed(self.fmus, "fmus")]
        for folder in folders:
            if not folder.is_dir():
                raise error_at("fmus", f"There is no folder '{folder}'.", "Give folders with FMUs.")
        return folders

    def system_of_scenario(self, scenario: Scenario) -> System:
        """The system of a scenario, checked, with the parameter sets and FMUs of both."""
        from shipcosim.cosim import system_of

        raise_errors(check_files(scenario))
        return system_of(
            scenario,
            parameters=[Path(parameter) for parameter in listed(self.parameters)],
            components=fmus_of(self.components),
            strict=self.strict,
            fmus=self._fmu_folders(),
        )


def _path_of_system(given: AnyPath, argument: str) -> Path:
    if (
        isinstance(given, str)
        and not Path(given).exists()
        and library.named("system", given) is None
    ):
        if library.named("fmu", given) is not None:
            return find("fmu", given, argument)
    return find("system", given, argument)


def is_scenario(given: AnyPath) -> bool:
    """True for a scenario, False for a system: by the ending, else by which of them has this name.

    Raises
    ------
    ShipcosimError
        If it is neither.
    """
    text = os.fspath(given)
    if text.endswith(".toml") or Path(text.partition("#")[0]).exists():
        return text.endswith(".toml")
    scenarios = library.names("scenario")
    systems = library.names("system")
    if text not in scenarios and text not in systems:
        remedy = suggestion(text, {*scenarios, *systems})
        raise error_at(text, "There is no such scenario or system.", remedy)
    return text in scenarios


def read_scenario(scenario: AnyScenario) -> Scenario:
    """Read and check a scenario file.

    Parameters
    ----------
    scenario : path or name
        A Scenario comes back as it is.

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
    return (
        scenario
        if isinstance(scenario, Scenario)
        else read_scenario_file(find("scenario", scenario))
    )


def system_and_scenario(
    given: AnyScenario | AnySystem,
    reading: Reading,
    keys: Mapping[str, Any],
    events: AnyPath | None = None,
    *,
    needs_end: bool = True,
) -> tuple[System, Scenario, list[Problem]]:
    """System and scenario of an argument that is either; events of OSP are added.

    Parameters
    ----------
    given : path, name, Scenario, SystemStructure or System
        A name is a scenario's where there is one.
    reading : Reading
    keys : mapping
        Entries of the scenario that go before its own: times, start values.
    events : path, optional
        Scenario file of OSP.
    needs_end : bool
        Whether a stop time has to be given; one step is enough without.

    Returns
    -------
    tuple of System, Scenario and list of Problem
        The problems are remarks on the events.
    """
    scenario = given if isinstance(given, Scenario) else None
    if isinstance(given, (str, os.PathLike)) and is_scenario(given):
        scenario = read_scenario(given)
    if scenario is not None:
        system = reading.system_of_scenario(scenario)
    else:
        assert not isinstance(given, Scenario)
        system = reading.system(given)
        step = keys.get("step_size", system.experiment.step_size)
        if not needs_end and system.experiment.stop_time is None and step is not None:
            keys = {"stop_time": step, **keys}
    happening, remarks = with_osp_events(scenario_of(scenario, system, keys), events)
    if scenario is None and "step_size" not in keys:
        remarks += step_remarks(system, 0.0, happening.stop_time)
    return system, happening, remarks


def scenario_of(
    given: Scenario | None, system: System, keys: Mapping[str, Any], start_time: float = 0.0
) -> Scenario:
    """Scenario of entries over those of another one, or over the system's default experiment; its times checked.

    The run starts at `start_time`. [s]
    """
    if given is None:
        experiment = without_none({"stop_time": system.experiment.stop_time})
        entries = experiment | dict(keys)
        if "step_size" not in entries and "stop_time" in entries:
            step_size = default_step_size(system, start_time, entries["stop_time"])
            entries |= without_none({"step_size": step_size})
        entries.setdefault("description", f"Simulation of {system.name}")
        # The step of one FMU follows from its stop time; a system may have a step of its own.
        has_step = system.file.endswith(".fmu") or system.experiment.step_size is not None
        needed = ["stop_time"] if has_step else ["stop_time", "step_size"]
        if missing := [name for name in needed if name not in entries]:
            raise ShipcosimError(
                [
                    Problem(named(name), f"{name} is missing.", "Give it; times are in s.")
                    for name in missing
                ]
            )
    else:
        base = given.model_dump(exclude_defaults=True)
        entries = base | dict(keys)
        entries["set"] = base.get("set", {}) | keys.get("set", {})
        entries["events"] = [*base.get("events", ()), *keys.get("events", ())]
    try:
        scenario = Scenario.model_validate(entries)
    except ValidationError as error:
        problems = []
        for problem, detail in zip(problems_in(error, "simulate"), error.errors(), strict=True):
            argument = str(detail["loc"][0]) if detail["loc"] else ""
            is_time = argument in ("stop_time", "step_size", "output_interval")
            problems.append(replace(problem, where=named(argument)) if is_time else problem)
        raise ShipcosimError(problems) from None
    raise_errors(check_times(scenario, start_time))
    return (
        scenario
        if given is None
        else given.model_copy(update={name: getattr(scenario, name) for name in entries})
    )


def with_osp_events(
    scenario: Scenario, path: AnyPath | None, start_time: float = 0.0
) -> tuple[Scenario, list[Problem]]:
    """Scenario with the events of an OSP scenario file added, and remarks on them; the same without a path.

    Parameters
    ----------
    scenario : Scenario
        Its steps are the run's.
    path : path, optional
    start_time : float
        Of the run. [s]
    """
    from shipcosim.scenario.osp import read_osp_scenario

    if path is None:
        return scenario, []
    read = read_osp_scenario(Path(path), scenario.step_size, scenario.stop_time, start_time)
    update: dict[str, Any] = {"events": [*scenario.events, *read.events]}
    if read.description:
        update["description"] = read.description
    return scenario.model_copy(update=update), list(read.remarks)


def values_of_sets(
    parameters: Iterable[AnyPath], system: System
) -> tuple[dict[str, Any], list[Problem]]:
    """Start values of parameter sets as far as the system has what they are for, and remarks on the rest."""
    values: dict[str, Any] = {}
    remarks: list[Problem] = []
    for file in listed(parameters, "parameters"):
        fitting, left_out = fitting_values(file, system)
        values |= fitting
        remarks += left_out
    return values, remarks


def path_of_log(given: AnyPath) -> Path:
    """Path of measured data; a name is that of an example that the package ships."""
    path = Path(given)
    return path if path.exists() else library.named("example", str(given)) or path


def source_of(
    log: Any, channels: AnyPath | None
) -> tuple[AnyPath | xarray.Dataset, AnyPath | None]:
    """A log as the rooms below take it, with its channel file."""
    if isinstance(log, Log):
        return log.source, log.channels if channels is None else channels
    if isinstance(log, Run):
        return log.table, channels
    if hasattr(log, "data_vars"):
        return log, channels
    return path_of_log(path_or_name("log", log)), channels


def sources_of(logs: Any, channels: AnyPath | None) -> tuple[list[Any], AnyPath | None]:
    """Several logs as the rooms below take them, with their common channel file."""
    sources = []
    for log in logs:
        source, channels = source_of(log, channels)
        sources.append(source)
    return sources, channels


def check_inputs(
    logs: Iterable[Any], channels: AnyPath | None, causes: AnyPath | None = None
) -> None:
    """Raise ShipcosimError if a given file or folder does not exist."""
    problems = []
    remedy = "Give the path of one."
    for log in logs:
        is_path = isinstance(log, (str, os.PathLike))
        if is_path and not Path(log).is_file() and not Path(log).is_dir():
            names = library.names("example")
            hint = suggestion(str(log), names) if names else remedy
            problems.append(Problem(str(log), "There is no such file of measured data.", hint))
    if isinstance(channels, (str, os.PathLike)) and not Path(channels).is_file():
        problems.append(Problem(str(channels), "There is no such channel file.", remedy))
    if causes is not None and not Path(causes).is_dir():
        problems.append(Problem(str(causes), "There is no such folder of causes.", remedy))
    raise_errors(problems)


def name_of_log(source: Any) -> str:
    """Name of a log for pages: that of its file."""
    return Path(source).name if isinstance(source, (str, os.PathLike)) else "log"


def default_folder(source: Any, ending: str = "") -> Path:
    """Where a command puts the results of a log without --out.

    Examples
    --------
    >>> default_folder("logs/monday.csv.gz").as_posix()
    'results/monday'
    >>> default_folder("logs/monday.csv.gz", "-replay").as_posix()
    'results/monday-replay'
    """
    return Path("results") / f"{Path(name_of_log(source).removesuffix('.gz')).stem}{ending}"
