"""The system of a scenario, with its parameter sets and swapped FMUs."""

from collections.abc import Iterable
from pathlib import Path

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, raise_errors
from shipcosim.scenario import Scenario, check_scenario, units_of, with_numbers
from shipcosim.scenario.locations import problem_at
from shipcosim.ssp import System, read_system, with_values
from shipcosim.ssp.flatten.hierarchy import Swapped
from shipcosim.ssp.flatten.swapped import WHERE


def system_of(
    scenario: Scenario,
    *,
    system: Path | None = None,
    parameters: Iterable[Path] = (),
    components: Swapped = None,
    strict: bool = False,
    build: bool = True,
    fmus: Iterable[Path] = (),
) -> System:
    """Read the system of a scenario.

    Parameters
    ----------
    scenario : Scenario
        Names the system, parameter sets and FMUs in place of components' own.
    system : Path, optional
        In place of the scenario's.
    parameters : iterable of Path
        Parameter sets over the scenario's.
    components : mapping of str to Path, optional
        FMUs in place of components' own, over the scenario's.
    strict : bool
        Refuse what breaks a standard, also where it can mean one thing only.
    build : bool
        Build FMUs that are missing or out of date, which runs their source.
    fmus : iterable of Path
        Folders in which FMUs are looked for first.

    Raises
    ------
    ShipcosimError
        With everything that is wrong.
    """
    # Arguments of the call come before the scenario's own.
    path = scenario.system_path if system is None else system
    swapped = scenario.component_paths(build)
    # A problem with a swapped FMU is reported at its line in the scenario file.
    of_scenario = {f"{WHERE}, {name}": name for name in swapped if name not in (components or {})}

    def located(problem: Problem) -> Problem:
        name = of_scenario.get(problem.where)
        return (
            problem_at(scenario, ("components", name), problem.found, problem.remedy)
            if name
            else problem
        )

    try:
        return read_system(
            path,
            [*scenario.parameter_paths, *parameters],
            fmus=[*fmus, *library.fmus(path, build)],
            components=swapped | dict(components or {}),
            strict=strict,
        )
    except ShipcosimError as error:
        raise ShipcosimError([located(problem) for problem in error.problems]) from None


def prepared(
    system: System, scenario: Scenario, start_time: float = 0.0
) -> tuple[System, Scenario]:
    """The system with the scenario's start values, and the scenario in the units of the signals; both checked.

    Parameters
    ----------
    system : System
        Checked.
    scenario : Scenario
        With names and values as they are written.
    start_time : float
        From which the steps of a run count. [s]

    Raises
    ------
    ShipcosimError
        If they do not fit.
    """
    system = with_values(system, scenario.set, str(scenario.path or "scenario"))
    raise_errors(check_scenario(scenario, system, start_time))
    return system, with_numbers(scenario, units_of(system))
