"""The command `shipcosim new ship`."""

from pathlib import Path
from typing import Annotated

import typer

Thrusters = Annotated[
    list[str] | None,
    typer.Option(
        "--thruster",
        metavar="KEYS",
        help='"name=bow, kind=tunnel, x=25 m, ..."; repeatable. With --propulsion in addition.',
    ),
]


def ship(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Her name: letters, digits, - and _.")
    ],
    origin: Annotated[
        Path | None,
        typer.Option(
            "--from", metavar="FILE", help="Ship file to start from; nothing is asked then."
        ),
    ] = None,
    description: Annotated[str | None, typer.Option("--description", help="One line.")] = None,
    length: Annotated[
        str | None, typer.Option("--length", help='Between perpendiculars, "60 m".')
    ] = None,
    breadth: Annotated[str | None, typer.Option("--breadth")] = None,
    draught: Annotated[str | None, typer.Option("--draught")] = None,
    displacement: Annotated[str | None, typer.Option("--displacement", help='"2650 t".')] = None,
    speed: Annotated[str | None, typer.Option("--speed", help='Service speed, "12 kn".')] = None,
    power: Annotated[
        str | None, typer.Option("--power", help='Power of all main propellers, "2400 kW".')
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option("--kind", help="Kind of ship in Blendermann's table, for the wind."),
    ] = None,
    propulsion: Annotated[
        str | None, typer.Option("--propulsion", help="azimuths, screws or rudder.")
    ] = None,
    thrusters: Thrusters = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Ask nothing; take usual values for what is left out.")
    ] = False,
    force: Annotated[
        bool, typer.Option("--force", help="Write over files that are there.")
    ] = False,
) -> None:
    """Describe a ship of one's own in ships/NAME/ship.toml, and make the systems that run her.

    Asks for what it needs where there is a terminal. Once the file is changed, --from ships/NAME/ship.toml makes the
    systems again.

    Example: shipcosim new ship tern --length "60 m" --breadth "14 m" --draught "4.5 m" --yes
    """
    from shipcosim.cli.new_ship import answers_from, make

    given = {
        "description": description,
        "length": length,
        "breadth": breadth,
        "draught": draught,
        "displacement": displacement,
        "speed": speed,
        "power": power,
        "kind": kind,
        "layout": propulsion,
    }
    answers = None if origin else answers_from(name, given, thrusters or [], ask=not yes)
    make(name, origin, answers, force)
