"""Reading of scenario files, with every mistake reported at its line."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args, get_origin

from pydantic import BaseModel, ValidationError

from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, suggestion
from shipcosim.scenario.check import check_times
from shipcosim.scenario.locations import line_of, location_of
from shipcosim.scenario.model import Scenario

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

MOST_PARTS = 1000
"""Dots in a key of a TOML file: the parser takes time and memory by their square. A list may be as long as it is."""
_DOTTED = re.compile(r"""(?:\.\s*+(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')\s*+)++""")

_REMEDIES = {
    "string_type": "It should be a text in quotes.",
    "float_type": 'It should be a number, without quotes and with a decimal point, or a text such as "2.5 m".',
    "float_parsing": "It should be a number, without quotes and with a decimal point.",
    "bool_type": "It should be true or false.",
    "dict_type": "It should be a table: {key = value, ...}.",
    "int_type": "It should be a whole number, without quotes.",
    "list_type": "It should be a list: [ , ].",
    "model_type": "It should be a table: {key = value, ...}.",
    "too_short": "It takes more values than that.",
    "too_long": "It takes fewer values than that.",
}
"""What would be right, where pydantic's words would not help."""


def read_scenario(path: str | os.PathLike) -> Scenario:
    """Read and check a scenario file.

    Raises
    ------
    ShipcosimError
        With every problem of the file: its line, what was found, what would be right.
    """
    path = Path(path)
    # Read the text too: messages need its lines.
    text, content = read_toml(path)
    try:
        scenario = Scenario.model_validate(content)
    except ValidationError as error:
        raise ShipcosimError(_problems_of(path, text, error)) from None
    # Times are checked once the file is known, so that they too have lines.
    scenario._path = path
    raise_errors(check_times(scenario))
    return scenario


def read_toml(path: Path, kind: str = "Scenarios") -> tuple[str, dict[str, Any]]:
    """Text and content of a TOML file.

    Parameters
    ----------
    path : Path
    kind : str
        What such files are, as a message begins.

    Raises
    ------
    ShipcosimError
        If it cannot be read, or is not TOML.
    """
    text = _text(path)
    try:
        return text, toml_of(text)
    except ValueError as error:
        raise ShipcosimError(_no_toml(path, str(error), kind)) from error


def toml_of(text: str) -> dict[str, Any]:
    """Content of a TOML text.

    Raises
    ------
    ValueError
        If it is not TOML, or one that takes a reader without limits far too long: keys, brackets and numbers of
        thousands of parts.
    """
    # Keys, brackets and numbers of thousands of parts would take the parser far too long.
    if any(match[0].count(".") > MOST_PARTS for match in _DOTTED.finditer(text)):
        raise ValueError(f"a key has more than {MOST_PARTS} parts")
    try:
        content = tomllib.loads(text)
        too_large = any(abs(number) >= 2**64 for number in _whole_numbers(content))
    except RecursionError:
        raise ValueError("brackets or tables are nested too deep") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:
        raise ValueError("a number has thousands of digits") from None
    if too_large:
        raise ValueError("a whole number has more than 64 bits")
    return content


def _whole_numbers(content: Any) -> Iterator[int]:
    """All whole numbers in the content of a TOML text."""
    if isinstance(content, (dict, list)):
        for part in content.values() if isinstance(content, dict) else content:
            yield from _whole_numbers(part)
    elif isinstance(content, int):
        yield content


def _text(path: Path) -> str:
    try:
        # A name that is no text fits in no table and on no page.
        path.name.encode()
        return path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeEncodeError as error:
        shown = str(path).encode(errors="replace").decode()
        raise error_at(shown, "has a name that is no UTF-8.", "Rename the file.") from error
    except OSError as error:
        raise error_at(str(path), f"cannot be read: {error.strerror or error}.") from error
    except UnicodeDecodeError as error:
        # Line of the first byte that is no UTF-8.
        line = error.object[: error.start].count(b"\n") + 1
        raise error_at(
            f"{path}, line {line}",
            f"is not UTF-8 text: byte 0x{error.object[error.start]:02x} is none of its characters.",
            "Save the file in UTF-8.",
        ) from error


def _no_toml(path: Path, message: str, kind: str) -> Problem:
    """Message of the TOML parser, with its line where our messages have theirs."""
    line = re.search(r" \(at line (\d+), column \d+\)", message)
    where = f"{path}, line {line[1]}" if line else str(path)
    return Problem(
        where,
        f"is no TOML: {message.replace(line[0], '') if line else message}.",
        f"{kind} are text files in TOML: keys, =, values, texts in quotes.",
    )


def _problems_of(path: Path, text: str, error: ValidationError) -> list[Problem]:
    """Findings of pydantic in our words, one for each key, in file order."""
    problems = {}
    # Several findings on one key have one cause: keep the first.
    for finding in error.errors():
        keys = finding["loc"]
        where = line_of(text, keys), keys[: 3 if keys[:1] in (("events",), ("expect",)) else 2]
        problems.setdefault(
            where, Problem(location_of(path, text, keys), *complaint_of(finding, Scenario))
        )
    return [problems[where] for where in sorted(problems, key=lambda where: where[0])]


def complaint_of(finding: ErrorDetails, record: type[BaseModel]) -> tuple[str, str]:
    """Found and remedy for a finding of pydantic.

    Parameters
    ----------
    finding : dict
        One of ``ValidationError.errors()``.
    record : type
        Of the whole file.
    """
    # The record that the keys lead to knows which keys exist.
    part, keys = _part_at(record, finding["loc"])
    kind = finding["type"]
    last = str(keys[-1]) if keys else ""
    label = ".".join(map(str, keys))
    # Unknown, missing and our own checks first; pydantic's words for the rest.
    if kind == "extra_forbidden":
        return f"unknown key '{last}'.", suggestion(
            last, (field.alias or n for n, field in part.model_fields.items())
        )
    if kind == "missing":
        return f"'{last}' is missing.", ""
    if kind == "value_error":
        return f"{finding.get('ctx', {})['error']}".removesuffix(".") + ".", ""
    remedy = _REMEDIES.get(kind) or finding["msg"].replace("Input", "It", 1) + "."
    value = finding["input"]
    as_toml = (
        json.dumps(value, ensure_ascii=False) if isinstance(value, (bool, str)) else repr(value)
    )
    return f"{label} = {as_toml}." if label else f"is {as_toml}.", remedy


def _part_at(
    record: type[BaseModel], keys: tuple[int | str, ...]
) -> tuple[type[BaseModel], tuple[int | str, ...]]:
    """Innermost record on the path of keys, and the remaining keys."""
    # Follow the keys through records, lists and dictionaries of records.
    for number, key in enumerate(keys[:-1]):
        field = next(
            (field for name, field in record.model_fields.items() if key in (name, field.alias)),
            None,
        )
        kinds = list(_kinds_in(field.annotation)) if field else []
        part = next(
            (kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel)), None
        )
        if part is not None and len(rest := keys[number + 1 :]) > (
            is_many := list in kinds or dict in kinds
        ):
            return _part_at(part, rest[is_many:])
    return record, keys


def _kinds_in(annotation: Any) -> Iterator[Any]:
    """All types in an annotation."""
    yield get_origin(annotation) or annotation
    for inner in get_args(annotation):
        yield from _kinds_in(inner)
