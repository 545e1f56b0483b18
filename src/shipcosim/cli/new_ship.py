"""Make a ship of one's own: questions to the user, and files."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from shipcosim import library
from shipcosim.cli.console import print_problems, shown_path
from shipcosim.cli.terminal import say, say_next
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, reading
from shipcosim.ships.writing import LAYOUTS, USUAL_LAYOUT, Answers, ship_text, thruster_from, usual
from shipcosim.temporary import temporary_folder

if TYPE_CHECKING:
    from shipcosim.ships import Described

QUESTIONS = {
    "length": "Length between perpendiculars",
    "breadth": "Breadth",
    "draught": "Draught",
    "displacement": "Displacement",
    "speed": "Service speed",
    "power": "Power of all main propellers together",
}


def answers_from(
    name: str, given: Mapping[str, str | None], thrusters: list[str], ask: bool
) -> Answers:
    """What the options say, and what the user answers to the rest.

    Parameters
    ----------
    name : str
        Of the ship.
    given : mapping of str to str or None
        Options.
    thrusters : list of str
        As `thruster_from` reads them.
    ask : bool
        Whether to ask; without a terminal nothing is.

    Returns
    -------
    Answers

    Raises
    ------
    ShipcosimError
        If a thruster is not written as it should be.
    """
    answers = Answers(thrusters=[thruster_from(text) for text in thrusters])
    for key, value in given.items():
        if value is not None:
            setattr(answers, key, value)
    ask = ask and _is_terminal()
    if ask and not answers.description:
        answers.description = _asked("What is she, in a line", name)
    answers.description = answers.description or name
    if ask and given["layout"] is None and not answers.thrusters:
        for layout, description in LAYOUTS.items():
            say(f"  {layout}: {description}")
        while answers.layout not in LAYOUTS:
            answers.layout = _asked("Propulsion", USUAL_LAYOUT)
    for key, question in QUESTIONS.items():
        _answer(answers, key, question, ask)
    return answers


def _asked(question: str, proposed: str) -> str:
    try:
        return typer.prompt(question, default=proposed, type=str)
    except typer.Abort:
        raise KeyboardInterrupt from None


def _is_terminal() -> bool:
    return sys.stdin.isatty()


def _answer(answers: Answers, key: str, question: str, ask: bool) -> None:
    """An answer, asked for until it can be read; the usual value if no answer can be asked for."""
    if getattr(answers, key):
        return
    try:
        proposed = usual(answers, key)
    except ValueError:
        return  # a wrong length is reported with the rest
    while ask:
        answer = _asked(question, str(proposed))
        setattr(answers, key, proposed if answer == proposed else answer)
        try:
            usual(answers, "power")
            return
        except ValueError as error:
            say(f"{error}")
    if key != "length":
        setattr(answers, key, proposed)


def make(name: str, origin: Path | None, answers: Answers | None, force: bool) -> None:
    """Write the ship file, the systems and a scenario; all of them or none.

    Parameters
    ----------
    name : str
        Of the ship.
    origin : Path or None
        Ship file to start from.
    answers : Answers or None
        Without `origin` what is known of her.
    force : bool
        Write over what is there.

    Raises
    ------
    ShipcosimError
        With everything that is wrong; nothing is written then.
    """
    from shipcosim.ships import describe, make_systems
    from shipcosim.ships.check import check_described
    from shipcosim.ships.described import file_from, file_of, read_file

    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise error_at("NAME", f"found {name!r}.", "A letter, then letters, digits, - and _.")
    project = library.project_of() or Path.cwd()
    target = project / "ships" / name / "ship.toml"
    source = file_of(library.find("ship", origin)) if origin else target
    with reading(source):
        text = source.read_text(encoding="utf-8-sig") if origin and source.is_file() else ""
    text = text if answers is None else ship_text(answers)
    ship = describe(source, read_file(source) if answers is None else file_from(text, target))
    problems = check_described(ship)
    raise_errors(problems)
    named = ship if ship.name == name else replace(ship, name=name)
    with temporary_folder() as folder:
        stage = Path(folder)
        systems = make_systems(named, stage / "ssp", library.fmus())
        files = {f"ssp/{path.name}": path for path in systems}
        kinds = [path.name.rpartition("_")[2] for path in systems]
        texts = {f"scenarios/{name}.toml": _scenario(named, "dp" in kinds)}
        if "dp" in kinds:
            texts[f"studies/{name}_failures.toml"] = _study(named)
        if "trials" in kinds:
            texts |= _trials(named)
        again = source.resolve() == target.resolve() and origin is not None
        if not again:
            texts[f"ships/{name}/ship.toml"] = text
            files |= {f"ships/{name}/{table}": source.parent / table for table in _tables(ship)}
        for number, (path, content) in enumerate(texts.items()):
            files[path] = stage / f"{number}.toml"
            files[path].write_text(content, encoding="utf-8")
        written = _put(project, files, force or again)
    remarks = [problem for problem in problems if problem.severity == "remark"]
    _say(written, remarks, name, kinds)


def _tables(ship: Described) -> list[str]:
    """CSV files that the ship file names."""
    tables = [
        ship.file.wind.table,
        ship.file.waves.table,
        *(getattr(thruster, "table", None) for thruster in ship.file.thrusters),
    ]
    return [table for table in tables if isinstance(table, str) and table != "none"]


def _put(project: Path, files: Mapping[str, Path], over: bool) -> list[Path]:
    """Move what was made to its place."""
    there = [project / name for name in files if (project / name).exists()]
    if there and not over:
        remedy = "Take another name, or --force to write over it."
        raise ShipcosimError([Problem(str(path), "It is there already.", remedy) for path in there])
    written = []
    for name, made in files.items():
        path = project / name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            if made.is_dir():
                shutil.copytree(made, path, dirs_exist_ok=True)
            else:
                shutil.copyfile(made, path)
        except OSError as error:
            raise error_at(str(path), f"cannot be written: {error.strerror or error}.") from None
        written.append(path)
    return written


def _scenario(ship: Described, has_dp: bool) -> str:
    """Write a first scenario of a ship: she holds her position, or sails ahead."""
    if has_dp:
        return HOLDS.format(name=ship.name)
    ahead = [f'"{name}" = {value:g}' for name, value in _half_ahead(ship)]
    return GOES.format(name=ship.name, inputs="\n".join(ahead))


def _study(ship: Described) -> str:
    """A study of failures: each thruster stops, in wind from all sides."""
    from shipcosim.ships.control import units_for_dp

    cases = [
        f'    {{ label = "{name} stops", events = [{{ time = 200.0, override = {{ "{name}.failed" = true }} }}] }},'
        for name in (unit.name for unit in units_for_dp(ship))
    ]
    return FAILURES.format(name=ship.name, cases="\n".join(cases))


def _trials(ship: Described) -> dict[str, str]:
    """Scenarios of a turning circle and a zig-zag, by path, with the limits of IMO's MSC.137(76)."""
    length = ship.form.length
    passing = length / ship.form.speed  # s, in which she goes her length
    circle = CIRCLE.format(
        name=ship.name, until=35.0 * passing, advance=4.5 * length, diameter=5.0 * length
    )
    # A slow ship may overshoot further.
    zig_zag = ZIG_ZAG.format(
        name=ship.name,
        until=45.0 * passing,
        first=min(max(5.0 + 0.5 * passing, 10.0), 20.0),
        second=min(max(17.5 + 0.75 * passing, 25.0), 40.0),
    )
    return {
        f"scenarios/{ship.name}_circle.toml": circle,
        f"scenarios/{ship.name}_zig_zag.toml": zig_zag,
    }


def _half_ahead(ship: Described) -> list[tuple[str, float]]:
    """Inputs that make her sail ahead, if the limits of her thrusters are known."""
    from shipcosim.ships.file import number

    inputs = []
    for unit, thruster in zip(ship.units, ship.file.thrusters, strict=True):
        value = unit.screw.rpm if unit.screw else number(getattr(thruster, "rpm", None), 100.0)
        if getattr(thruster, "command", "") == "thrust":
            inputs.append((f"{unit.name}_thrust", 0.5 * unit.most if unit.most else 1.0))
        elif unit.kind in ("fixed", "rudder", "azimuth"):
            inputs.append((f"{unit.name}_rpm", 0.5 * value))
    return inputs


def _say(written: list[Path], remarks: list[Problem], name: str, kinds: list[str]) -> None:
    for path in written:
        say(shown_path(path))
    print_problems(remarks)
    has_dp = "dp" in kinds
    more = {}
    if has_dp:
        more = {
            f"shipcosim capability {name}_dp": "the weather that her thrusters balance",
            f"shipcosim sweep studies/{name}_failures.toml": "each thruster lost, wind from all sides",
        }
    if "trials" in kinds:
        more[f"shipcosim run {name}_circle"] = "her turning circle beside IMO's limits"
    say_next(
        {
            f"shipcosim run {name}": "she holds her place in wind" if has_dp else "she goes ahead",
            f"shipcosim check ships/{name}/ship.toml": "what is estimated, what cannot be",
            **more,
            f"shipcosim new ship {name} --from ships/{name}/ship.toml --force": "makes the systems again",
        }
    )


HOLDS = """\
description = "{name} holds her place in a fresh breeze"
system      = "{name}_dp"
stop_time   = 300.0
step_size   = 0.05
output_interval = 0.5

[set]
"environment.wind_speed" = 8.0     # m/s
"environment.wind_from"  = "45 deg"

[[expect]]
signal = ["vessel.x", "vessel.y"]
near   = [0.0, 0.0]
within = 3.0                       # m
during = [200.0, 300.0]
"""
FAILURES = """\
description = "{name} loses each thruster, in wind from all sides"
scenario    = "{name}"
stop_time   = "500 s"                     # the failure is at 200 s

[[factor]]
name = "failure"
case = [
{cases}
]

[[factor]]
name   = "wind_from"
signal = "environment.wind_from"
from   = "0 deg"
to     = "330 deg"
count  = 12

[[quantity]]
name        = "excursion"
description = "largest distance from her place"
signal      = ["vessel.x", "vessel.y"]
near        = [0.0, 0.0]
reduce      = "maximum"
during      = ["200 s", "500 s"]

[[quantity]]
name        = "turned"
description = "largest turn off her heading"
signal      = "vessel.psi"
near        = 0.0
reduce      = "maximum"
during      = ["200 s", "500 s"]
"""
GOES = """\
description = "{name} goes ahead"
system      = "{name}_open"
stop_time   = 120.0
step_size   = 0.05
output_interval = 0.5

[set]
{inputs}

[[expect]]
signal    = "vessel.u"
at_least  = 0.01                   # m/s
statistic = "final"
"""
CIRCLE = """\
description = "{name} turns in a circle, 35 deg to starboard, at full ahead"
system      = "{name}_trials"
stop_time   = {until:.0f}
step_size   = 0.05
output_interval = 0.5

[[expect]]                         # MSC.137(76), for ships of 100 m and more: 4.5 lengths
signal    = "trial.advance_90"
at_most   = {advance:.4g}                   # m
statistic = "final"

[[expect]]                         # 5 lengths
signal    = "trial.tactical_diameter"
at_most   = {diameter:.4g}                   # m
statistic = "final"

[[expect]]                         # she has turned so far, else they are not read off yet
signal    = "trial.turned"
at_least  = "180 deg"
statistic = "final"
"""
ZIG_ZAG = """\
description = "{name} in a zig-zag 10/10, first to starboard, at full ahead"
system      = "{name}_trials"
stop_time   = {until:.0f}
step_size   = 0.05
output_interval = 0.5

[set]
"trial.helm"  = "10 deg"
"trial.check" = "10 deg"

[[expect]]                         # MSC.137(76), for ships of 100 m and more, by length over speed
signal    = "trial.overshoot_1"
at_most   = "{first:.3g} deg"
statistic = "final"

[[expect]]
signal    = "trial.overshoot_2"
at_most   = "{second:.3g} deg"
statistic = "final"

[[expect]]                         # she has swung to both sides
signal    = "trial.overshoot_2"
at_least  = "0.1 deg"
statistic = "final"
"""
