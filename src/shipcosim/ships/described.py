"""A ship file that was read: records, hull and thrusters, and problems of reading it."""

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, suggestion
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates.hull import HullDimensions
from shipcosim.ships.file import KINDS, ShipFile
from shipcosim.ships.thrusters import ShipThruster, units_of_ship
from shipcosim.ships.vessel import form_of, vessel_of

LONGEST = 200_000
"""Characters of a ship file."""
MOST_THRUSTERS = 6
"""Loads that the vessel takes."""


@dataclass(frozen=True, kw_only=True)
class Described:
    """A ship by her file.

    Attributes
    ----------
    name : str
        Of the file, or of the folder around a ``ship.toml``.
    path : Path
        The file.
    file : ShipFile
        What it says.
    form : HullDimensions
        Her main particulars.
    vessel : dict of str to Quantity
        Parameters of her hull, given or estimated.
    units : list of ShipThruster
        Her thrusters.
    """

    name: str
    path: Path
    file: ShipFile
    form: HullDimensions
    vessel: dict[str, Quantity]
    units: list[ShipThruster]

    @property
    def entries(self) -> dict[str, dict[str, Quantity]]:
        """Parameters by component."""
        return {"vessel": self.vessel} | {unit.name: unit.entries for unit in self.units}


def file_of(ship: str | Path) -> Path:
    """The ship file of a path: itself, or ``ship.toml`` in a folder."""
    path = Path(ship)
    return path / "ship.toml" if path.is_dir() else path


def read_file(path: Path) -> ShipFile:
    """Records of a ship file.

    Parameters
    ----------
    path : Path
        The file.

    Raises
    ------
    ShipcosimError
        With everything that cannot be read, each with what would be right.
    """
    return file_from(_text(path), path)


def file_from(text: str, path: Path) -> ShipFile:
    """Records from the text of a ship file; `path` is for messages. Raises as `read_file`."""
    content = _toml(text, path)
    try:
        return ShipFile.model_validate(content)
    except ValidationError as error:
        raise ShipcosimError(
            [_problem(path, content, detail) for detail in error.errors()]
        ) from None


def describe(path: str | Path, file: ShipFile | None = None) -> Described:
    """Describe a ship by all parameters of hull and thrusters; missing ones are estimated.

    Parameters
    ----------
    path : path
        Her file, or the folder around a ``ship.toml``.
    file : ShipFile, optional
        What it says, where it is read already.

    Raises
    ------
    ShipcosimError
        With everything that is missing or cannot be read.
    """
    # Collect all problems before raising, so that the user sees them at once.
    path = file_of(path)
    content = read_file(path) if file is None else file
    problems = []
    form = form_of(content, str(path), problems)
    # Names of thrusters become names of components: they
    # must differ, also from those of the system.
    names = [thruster.name for thruster in content.thrusters]
    if twice := sorted(
        {name for name in names if names.count(name) > 1 or name in ("vessel", "environment")}
    ):
        problems.append(
            Problem(
                f"{path}: thrusters",
                f"the name '{twice[0]}' is taken.",
                "Each has a name of its own.",
            )
        )
    if len(names) > MOST_THRUSTERS:
        message = f"she has {len(names)}."
        problems.append(
            Problem(f"{path}: thrusters", message, f"The model of a ship takes {MOST_THRUSTERS}.")
        )
    if not names:
        remedy = f"Add a [[thrusters]] with name, kind ({', '.join(KINDS)}), x and y."
        problems.append(Problem(f"{path}: thrusters", "she has none.", remedy))
    # Without main dimensions nothing can be estimated.
    if form is None:
        raise ShipcosimError(problems)
    # Hull first: thrusters use its density and dimensions.
    vessel = vessel_of(content, form, path, problems)
    units = units_of_ship(content.thrusters, form, content.source, path, problems)
    raise_errors(problems)
    name = path.parent.name if path.name == "ship.toml" else path.stem
    return Described(name=name, path=path, file=content, form=form, vessel=vessel, units=units)


def _text(path: Path) -> str:
    try:
        text = path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
    except OSError as error:
        raise error_at(str(path), f"cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise error_at(str(path), "is not UTF-8 text.", "Save the file in UTF-8.") from None
    if len(text) > LONGEST:
        raise error_at(
            str(path), f"has {len(text)} characters.", f"A ship file has at most {LONGEST}."
        )
    return text


def _toml(text: str, path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        # The parser tells the line in its message: put it where our messages have it.
        line = re.search(r" \(at line (\d+), column \d+\)", str(error))
        where = f"{path}, line {line[1]}" if line else str(path)
        reason = str(error).replace(line[0], "") if line else "brackets are nested too deep"
        raise error_at(
            where, f"is no TOML: {reason}.", "A key, =, a value; texts in quotes."
        ) from None


def _problem(path: Path, content: dict[str, Any], finding: Any) -> Problem:
    """Translate a finding of pydantic into our words."""
    keys = list(finding["loc"])
    kind = finding["type"]
    # Findings in thrusters have the thruster's name.
    if keys[:1] == ["thrusters"] and len(keys) > 1:
        return _of_thruster(path, content, keys, finding)
    last = str(keys[-1])
    record = ShipFile.model_fields
    where = (
        f"{path}: {'.'.join(map(str, keys[:-1] if kind == 'extra_forbidden' else keys))}".rstrip(
            ": "
        )
    )
    # An unknown key: suggest a similar one of the same section.
    if kind == "extra_forbidden":
        keys_there = record if len(keys) == 1 else type(record[keys[0]].default).model_fields
        return Problem(where, f"unknown key '{last}'.", suggestion(last, keys_there))
    return Problem(where, *_words(finding))


def _of_thruster(path: Path, content: dict[str, Any], keys: list, finding: Any) -> Problem:
    """Translate a finding in a thruster, called by its name."""
    # pydantic numbers the entries of a list alone; one that is no table has neither name nor kind.
    entry = content["thrusters"][keys[1]]
    thruster = entry if isinstance(entry, dict) else {"name": ""}
    name = thruster.get("name", keys[1] + 1)
    kind = finding["type"]
    where = f"{path}: thruster {name}"
    # An unknown or missing kind: pydantic cannot choose a record.
    if kind.startswith("union_tag"):
        stated_kind = thruster.get("kind")
        if stated_kind is None:
            return Problem(where, "nothing says its kind.", f"There is: {', '.join(KINDS)}.")
        return Problem(where, f"kind = {stated_kind!r}.", suggestion(str(stated_kind), KINDS))
    last = str(keys[-1])
    if kind == "extra_forbidden":
        return Problem(
            where, f"unknown key '{last}'.", suggestion(last, KINDS[str(keys[2])].model_fields)
        )
    if kind == "string_pattern_mismatch":
        return Problem(
            where,
            f"the name is {finding['input']!r}.",
            "A name has letters, digits and _, a letter first.",
        )
    return Problem(f"{where}, {last}" if len(keys) > 3 else where, *_words(finding))


def _words(finding: Any) -> tuple[str, str]:
    """What was found, and what would be right, for a finding of pydantic."""
    if finding["type"] == "missing":
        return f"nothing says {finding['loc'][-1]}.", ""
    if finding["type"] == "value_error":
        return str(finding["ctx"]["error"]), ""
    shown = repr(finding["input"])
    return f"found {shown[:60]}.", finding["msg"].replace("Input", "It", 1).rstrip(".") + "."
