"""Tables of the reference pages, made from the code that they describe: commands, file formats, FMUs, causes, calls.
The ship that the reader steers is made here too.

The hook of the site (`site_hooks.py`) puts them where a page says ``<!-- generated: NAME -->``, NAME being a key of
`TABLES`. Nothing is stored: a page is what the code is when the site is built.
"""

import ast
import functools
import importlib
import re
import sys
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import typer
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

import shipcosim
from shipcosim import library
from shipcosim.calls.arguments import Reading, system_and_scenario
from shipcosim.cli.outcomes.exits import EXIT_CODES
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.hypotheses.cause import (
    Cause,
    CauseParameter,
    ExtensionRule,
    OnConnections,
)
from shipcosim.diagnose.log.channels import Channel
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.roles import ROLES, THRUSTER_ROLES
from shipcosim.report.live import live_page
from shipcosim.scenario.model import Event, Expectation, Record, Scenario
from shipcosim.ships import file as ship_file
from shipcosim.ships.given import Given
from shipcosim.sweep import study_model

ROOT = Path(__file__).resolve().parents[2]
MEANINGS = tomllib.loads((Path(__file__).parent / "meanings.toml").read_text(encoding="utf-8"))
"""What a key means, by record, where the record itself does not describe it."""
FMUS = {
    "Ship and sea": ["vessel", "rough_vessel", "environment", "harbour", "sensors"],
    "Thrusters": [
        "azimuth_thruster",
        "tunnel_thruster",
        "thruster_interaction",
        "fixed_thruster",
        "propeller_rudder",
        "mapped_thruster",
        "thruster_monitor",
        "consequence_analysis",
    ],
    "Control": ["reference", "dp_controller", "pid_controller", "helmsman", "steering_trial"],
    "Allocation, classical": [
        "allocator",
        "extended_allocator",
        "optimal_allocator",
        "fixed_angle_allocator",
        "optimal_units_allocator",
    ],
    "Allocation, learned": [
        "paper_i_allocator",
        "paper_v_allocator",
    ],
    "Prediction": [
        "predictor",
        "dp_predictor",
        "drift_predictor",
        "docking_predictor",
        "dead_reckoning",
    ],
    "Inserted by a diagnosis": ["earth_force", "drift_force", "varying_current", "instruments"],
}
"""FMUs by what they are for."""
RECORDS = {
    "scenario": [Scenario, Record, Event, Expectation],
    "study": [
        study_model.Study,
        study_model.Factor,
        study_model.Case,
        study_model.Sample,
        study_model.Distribution,
        study_model.Quantity,
        study_model.Summary,
        study_model.View,
        study_model.Tracks,
        study_model.Tune,
        study_model.Range,
        study_model.Objective,
    ],
    "ship": [
        ship_file.ShipFile,
        ship_file.Particulars,
        ship_file.Inertia,
        ship_file.Resistance,
        ship_file.Drag,
        ship_file.Wind,
        ship_file.Waves,
        ship_file.Control,
        *ship_file.KINDS.values(),
    ],
    "channels": [Channel, FileLayout],
    "cause": [Cause, CauseParameter, ExtensionRule, OnConnections],
}
"""Records of each kind of file, the outermost first."""
HEADINGS = {
    "Scenario": "The file",
    "Event": "`[[events]]`",
    "Expectation": "`[[expect]]`",
    "Record": "`[record]`",
    "Study": "The file",
    "Factor": "`[[factor]]`",
    "Case": "`[[factor.case]]`",
    "Sample": "`[sample]`",
    "Distribution": "`[sample.of]`: one entry a signal",
    "Quantity": "`[[quantity]]`",
    "Summary": "`[[summary]]`",
    "View": "`[[view]]`",
    "Tracks": "`[tracks]`",
    "Tune": "`[tune]`",
    "Range": "`[tune.of]`: one entry a signal",
    "Objective": "`[[tune.objective]]`",
    "ShipFile": "The file",
    "Particulars": "`[particulars]`",
    "Inertia": "`[mass]`",
    "Resistance": "`[resistance]`",
    "Drag": "`[drag]`",
    "Wind": "`[wind]`",
    "Waves": "`[waves]`",
    "Control": "`[control]`",
    "FixedPropeller": '`[[thrusters]]` with `kind = "fixed"`',
    "Azimuth": '`[[thrusters]]` with `kind = "azimuth"`',
    "Tunnel": '`[[thrusters]]` with `kind = "tunnel"`',
    "ThrustMap": '`[[thrusters]]` with `kind = "map"`',
    "PropellerWithRudder": '`[[thrusters]]` with `kind = "rudder"`',
    "Channel": "One entry a channel",
    "FileLayout": "`file`: how the log is written",
    "Cause": "The file",
    "CauseParameter": "`[parameters.NAME]`",
    "ExtensionRule": "`[extension]`",
    "OnConnections": "`[parameters.NAME.on_connections]`",
}
TYPES = {str: "text", float: "number", int: "whole number", bool: "true or false", Any: "any"}


def table(header: list[str], rows: Iterator[list[str]] | list[list[str]]) -> str:
    """A table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(
        f"| {' | '.join(cell.replace('|', '&#124;') for cell in row)} |" for row in lines
    )


# Commands


def command_group() -> Any:
    """The command `shipcosim` with its sub-commands."""
    importlib.import_module("shipcosim.cli.app")
    return typer.main.get_command(sys.modules["shipcosim.cli.app"].__dict__["app"])


def all_commands(group: Any, prefix: str = "shipcosim") -> Iterator[tuple[str, Any]]:
    """Name and command, of every command that does something."""
    for name, command in group.commands.items():
        if getattr(command, "commands", None):
            yield from all_commands(command, f"{prefix} {name}")
        else:
            yield f"{prefix} {name}", command


def commands() -> str:
    """Every command with its arguments, options and example."""
    return "\n\n".join(_command(name, command) for name, command in all_commands(command_group()))


def _command(name: str, command: Any) -> str:
    text, *shown = re.split(r"Examples?: ", (command.help or "").strip())
    prose = [" ".join(part.split()) for part in re.split(r"\n\s*\n", text) if part.strip()]
    examples = [line.strip() for line in "\n".join(shown).splitlines() if line.strip()]
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    usage = " ".join([name, *(_usage(p) for p in arguments), "[OPTIONS]"])
    rows = [_parameter(name, parameter) for parameter in command.params if parameter.name != "help"]
    heading = f"## {name.removeprefix('shipcosim ')}"
    parts = [heading, f"```text\n{usage}\n```", *map(_escaped, prose)]
    if examples:
        parts.append("```sh\n" + "\n".join(examples) + "\n```")
    if rows:
        parts.append(table(["argument, option", "meaning", "default"], rows))
    return "\n\n".join(parts)


def _usage(argument: Any) -> str:
    shown = argument.metavar or argument.name.upper()
    return shown if argument.required or shown.startswith("[") else f"[{shown}]"


def help_of(command: str, parameter: Any) -> str:
    """What an argument or option is, by the command itself or by `meanings.toml`."""
    return parameter.help or MEANINGS.get(command, {}).get(parameter.opts[0], "")


def _parameter(command: str, parameter: Any) -> list[str]:
    names = parameter.opts + parameter.secondary_opts
    if parameter.param_type_name == "argument":
        names = [parameter.metavar or parameter.name.upper()]
    elif not getattr(parameter, "is_flag", False):
        names = [f"{name} {parameter.metavar or 'TEXT'}" for name in names]
    default = parameter.default
    shown = "" if default in (None, False, (), [], "") or callable(default) else f"`{default}`"
    if parameter.required:
        shown = "required"
    text = " ".join(help_of(command, parameter).split())
    return [", ".join(f"`{name}`" for name in names), _escaped(text), shown]


def _escaped(text: str) -> str:
    return re.sub(r"([<*_])", r"\\\1", text)


# File formats


def format_of(kind: str) -> Callable[[], str]:
    """Function that describes the records of one kind of file."""

    def described() -> str:
        parts = []
        for record in RECORDS[kind]:
            parts.append(
                f"### {HEADINGS[record.__name__]} " + f"{{ #{kind}-{record.__name__.lower()} }}"
            )
            parts.append(_first_line(record))
            parts.append(table(["key", "value", "default", "meaning"], _keys(record)))
        return "\n\n".join(parts)

    return described


def _first_line(record: type) -> str:
    return (record.__doc__ or "").strip().partition("\n\n")[0].replace("\n", " ")


def _keys(record: type[BaseModel]) -> Iterator[list[str]]:
    for name, field in record.model_fields.items():
        annotation = _annotation(record, name, field)
        default = "required" if field.is_required() else _default(field)
        yield [f"`{field.alias or name}`", _kind(annotation), default, meaning_of(record, name)]


def meaning_of(record: type[BaseModel], name: str) -> str:
    """What a key means: by its own description, by the docstring of its record, or by `meanings.toml`."""
    field = record.model_fields[name]
    text = field.description or _attributes(record).get(name, "")
    return text or MEANINGS.get(section_of(record), {}).get(name, "")


def section_of(record: type[BaseModel]) -> str:
    """Section of `meanings.toml` for a record; kinds of thrusters share theirs."""
    return "Thruster" if record in ship_file.KINDS.values() else record.__name__


def _attributes(record: type) -> dict[str, str]:
    """Descriptions in the section Attributes of a docstring."""
    section = (record.__doc__ or "").partition("Attributes\n")[2]
    found: dict[str, str] = {}
    names: list[str] = []
    for line in section.splitlines()[1:]:
        entry = re.match(r"    (\w[\w, ]*) : ", line)
        if entry:
            names = [name.strip() for name in entry[1].split(",")]
        elif line.startswith("        "):
            for name in names:
                found[name] = f"{found.get(name, '')} {line.strip()}".strip().replace("``", "`")
    return found


def _annotation(record: type[BaseModel], name: str, field: Any) -> Any:
    # pydantic moves what is annotated into the metadata of the field
    return Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation


def _default(field: Any) -> str:
    if field.default_factory is not None or field.default is PydanticUndefined:
        return ""
    if field.default in (None, "", [], {}, (), False) or isinstance(field.default, BaseModel):
        return ""
    return f"`{field.default}`"


def _kind(annotation: Any) -> str:
    """The type of a key in words: a number in m, a text, a list of texts."""
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        unit = next(filter(None, map(_unit, inside[1:])), None)
        if unit is not None:
            return "number" if unit == "1" else f"number in {unit}"
        words = _kind(inside[0])
        if any("_seconds" in str(part) for part in inside[1:]):
            return "time in s"
        if any("_plain" in str(part) for part in inside[1:]):
            return "value"
        return words
    if origin in (Union, UnionType):
        kinds = [_kind(part) for part in inside if part is not NoneType]
        return " or ".join(dict.fromkeys(kinds))
    if origin is Literal:
        return ", ".join(f'`"{one}"`' if isinstance(one, str) else f"`{one}`" for one in inside)
    if origin in (list, tuple):
        kinds = list(dict.fromkeys(_kind(part) for part in inside if part is not Ellipsis))
        return f"list: {', '.join(kinds)}"
    if origin is dict:
        return f"table: {_kind(inside[1])}"
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return f"[table](#{_kind_of_file(annotation)}-{annotation.__name__.lower()})"
    if annotation is Given:
        return "number"
    return TYPES.get(annotation, getattr(annotation, "__name__", str(annotation)))


def _kind_of_file(record: type) -> str:
    return next(kind for kind, records in RECORDS.items() if record in records)


def _unit(metadata: Any) -> str | None:
    """Unit of a number of a ship file, which its reader holds."""
    function = getattr(metadata, "func", None)
    code = getattr(function, "__code__", None)
    if code is None or "unit" not in code.co_freevars:
        return None
    return function.__closure__[code.co_freevars.index("unit")].cell_contents


def roles() -> str:
    """Channels that a log can have."""
    rows = [[f"`{name}`", role.unit, role.meaning] for name, role in ROLES.items()]
    rows += [[f"`NAME_{name}`", role.unit, role.meaning] for name, role in THRUSTER_ROLES.items()]
    return table(["channel", "unit", "meaning"], rows)


def causes() -> str:
    """Causes that a diagnosis knows, with their parameters."""
    rows = []
    for name, cause in sorted(read_catalogue().items()):
        units = [
            f"`{key}`" + (f" [{value.unit}]" if value.unit != "1" else "")
            for key, value in cause.parameters.items()
        ]
        rows.append([f"`{name}`", cause.for_each, ", ".join(units), cause.sentence])
    return table(["cause", "one for each", "parameters", "what it says"], rows)


# FMUs, calls, exit codes


def fmus() -> str:
    """FMUs by what they are for; each name leads to its equations and variables."""
    lines = {entry.name: entry.line for entry in library.entries("fmu", ROOT)}
    parts = []
    for purpose, names in FMUS.items():
        rows = [[f"[{name}](fmus/{name}.md)", lines[name]] for name in names]
        parts += [f"## {purpose}", table(["FMU", "what it is"], rows)]
    return "\n\n".join(parts)


def python_api() -> str:
    """Every public name of the package, for mkdocstrings."""
    parts = []
    for name in sorted(shipcosim.__all__, key=lambda name: (name[0].isupper(), name)):
        found = getattr(shipcosim, name)
        found = getattr(found, "__wrapped__", found)
        parts.append(
            f"::: {found.__module__}.{found.__qualname__}\n    options:\n      heading: {name}"
        )
    return "\n\n".join(parts)


def exit_codes() -> str:
    """What every command says of how it ends."""
    return f"```text\n{EXIT_CODES}\n```"


LIVE = "live/four_corner.html"
"""File of the site that runs the DP system of the four-corner test in the reader's browser."""


def live_ship() -> str:
    """That file within a page."""
    return (
        f"This is it. It has more room [in a window of its own]({LIVE}).\n\n"
        f'<iframe src="{LIVE}" title="R/V Gunnerus on DP" loading="lazy" '
        f'style="width: 100%; height: 44rem; border: 0"></iframe>'
    )


@functools.cache
def live_file() -> str:
    """What `shipcosim export page four_corner` writes."""
    system, scenario, _ = system_and_scenario("four_corner", Reading(), {})
    return live_page(system, scenario)


def folders() -> str:
    """Every folder of the code with the first line of its `__init__.py`."""
    code = ROOT / "src" / "shipcosim"
    rows = []
    for file in sorted(code.rglob("__init__.py")):
        lines = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8")))
        folder = file.parent.relative_to(code).as_posix()
        if folder != "." and lines:
            rows.append([f"`{folder}`", _escaped(lines.partition("\n")[0])])
    return table(["folder", "holds"], rows)


TABLES: dict[str, Callable[[], str]] = {
    "commands": commands,
    "fmus": fmus,
    "roles": roles,
    "causes": causes,
    "python_api": python_api,
    "exit_codes": exit_codes,
    "folders": folders,
    "live_ship": live_ship,
    **{f"format_{kind}": format_of(kind) for kind in RECORDS},
}


def filled(text: str) -> str:
    """A page with its tables put in."""
    return re.sub(r"<!-- generated: (\w+) -->", lambda match: TABLES[match[1]](), text)
