"""Channel files: which column of a log has which role, with its unit, sign and offset."""

from __future__ import annotations

import os
from difflib import get_close_matches
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from shipcosim.diagnose.log.roles import ROLES, role_of
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import toml_of

__all__ = ["Channel", "read_channels"]


class Channel(BaseModel):
    """Where a role comes from: ``sign * column + offset``, in `unit`, then turned into the role's unit."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    column: str = Field(min_length=1, description="name of the column, without its [unit]")
    unit: str | None = Field(default=None, description="unit of the column; default: the header's, else the role's")
    sign: Literal[1, -1] = 1
    offset: float = Field(default=0.0, description="added after the sign, in the unit of the column")


def read_channels(path: str | os.PathLike) -> dict[str, Channel]:
    """Read a channel file: TOML with one entry for each role, or for each connector of a system.

    ``surge = {column = "u", unit = "kn"}``, or ``surge = "u"`` where nothing else is to be said; a connector
    inside the system in quotes, ``"vessel.u" = {column = "log", unit = "kn"}``.

    Raises
    ------
    ShipcosimError
        If the file cannot be read, misspells a role, or has no time.
    """
    path = Path(path)
    try:
        content = toml_of(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ShipcosimError(Problem(str(path), f"cannot be read: {error}.")) from error
    channels, problems = {}, []
    for name, entry in content.items():
        where = f"{path}, {name}"
        problems += _misspelt(where, name)
        try:
            channels[name] = Channel.model_validate({"column": entry} if isinstance(entry, str) else entry)
        except ValidationError as error:
            problems += [_field_problem(where, detail) for detail in error.errors()]
    problems += _together(path, content)
    if problems:
        raise ShipcosimError(problems)
    return channels


def _misspelt(where, name):
    """A name that is almost a role; any other may be a connector of the system."""
    if role_of(name) is None and get_close_matches(name, ROLES, n=1, cutoff=0.75):
        yield Problem(where, "is no role.", suggestion(name, [*ROLES, "NAME_rpm", "NAME_azimuth", "NAME_thrust"]))


def _together(path, names):
    """Problems of the names as a set."""
    if "time" not in names:
        yield Problem(str(path), "says no column for time.", 'It should have, say, time = {column = "t"}.')
    for one, other in (("north", "east"), ("latitude", "longitude")):
        if (one in names) != (other in names):
            there, missing = (one, other) if one in names else (other, one)
            yield Problem(str(path), f"has {there} without {missing}.", "A position needs both.")
    if "north" in names and "latitude" in names:
        yield Problem(str(path), "gives the position twice.", "Give north and east, or latitude and longitude.")


def _field_problem(where, detail):
    field = ".".join(str(part) for part in detail["loc"])
    remedy = "A channel has column, unit, sign, offset."
    return Problem(f"{where}.{field}" if field else where, f"{detail['msg']}.", remedy)
