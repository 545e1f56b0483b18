"""The system of a scenario, with its parameter sets and with the FMUs that it swaps."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from shipcosim import library
from shipcosim.scenario import Scenario
from shipcosim.ssp import System, read_system


def system_of(
    scenario: Scenario,
    *,
    system: Path | None = None,
    parameters: Iterable[Path] = (),
    components: Mapping[str, Path] | None = None,
    strict: bool = False,
    build: bool = True,
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

    Raises
    ------
    ShipcosimError
        With everything that is wrong.
    """
    path = scenario.system_path if system is None else system
    return read_system(
        path,
        [*scenario.parameter_paths, *parameters],
        fmus=library.fmus(path, build),
        components=scenario.component_paths(build) | dict(components or {}),
        strict=strict,
    )
