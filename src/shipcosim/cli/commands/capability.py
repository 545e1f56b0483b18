"""The command `shipcosim capability`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import AsJson, Force, Junit, Out, Quiet
from shipcosim.cli.outcomes.exits import Conclusion
from shipcosim.cli.start.completion import names_of


def capability(
    system: Annotated[
        str,
        typer.Argument(
            metavar="SYSTEM",
            help="A system with thrusters: a path or a name.",
            autocompletion=names_of("system"),
        ),
    ] = "gunnerus_dp",
    parameters: Annotated[
        list[Path] | None,
        typer.Option(
            "--parameters",
            metavar="X.SSV",
            help="Parameter set, or its name; repeatable, last wins.",
        ),
    ] = None,
    ship: Annotated[
        str | None,
        typer.Option(
            "--ship",
            metavar="FOLDER",
            help="Ship with capability.toml. [default: in ssp/ships, named as the last set]",
        ),
    ] = None,
    failure: Annotated[
        list[str] | None,
        typer.Option(
            "--failure",
            metavar="A,B",
            help="Thrusters that one failure takes out together; repeatable.",
        ),
    ] = None,
    out: Out = None,
    as_json: AsJson = False,
    junit: Junit = None,
    quiet: Quiet = False,
    force: Force = False,
) -> Conclusion:
    """Static DP capability of a ship: the weather that her thrusters balance, intact and after each single failure.

    By the formulae of DNV-ST-0111 Level 1, and by the simulator's own models. Leaves report.html, capability.csv and
    capability.nc in results/capability-SHIP.

    Example: shipcosim capability --failure port,tunnel
    """
    from shipcosim.calls.systems import capability as capability_of
    from shipcosim.cli.capability import print_capability

    groups = [
        tuple(name.strip() for name in given.split(",") if name.strip()) for given in failure or ()
    ]
    result = capability_of(system, parameters=parameters or (), ship=ship, failures=groups)
    folder = out or Path("results") / f"capability-{result.vessel.name}"
    result.save(folder, force=force)
    return Conclusion(result.vessel.name, result, lambda: print_capability(result, folder), folder)
