"""Channel files: which column of a log has which role, with its unit, sign and offset."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.roles import ROLES, role_of
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario.reader import complaint_of, read_toml


class Channel(BaseModel):
    """Where a role comes from: ``sign * column + offset``, in `unit`, then turned into the role's unit."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    column: str = Field(default="", description="name of the column, without its [unit]")
    unit: str | None = Field(
        default=None, description="unit of the column; default: the header's, else the role's"
    )
    sign: Literal[1, -1] = 1
    offset: float = Field(
        default=0.0, description="added after the sign, in the unit of the column"
    )
    map: tuple[tuple[float, float], ...] | None = Field(
        default=None,
        min_length=2,
        description="pairs of column and value in the role's unit, straight between them",
    )
    date: str | None = Field(
        default=None, description="of time: column with the date, beside one of clock times"
    )
    nanoseconds: str | None = Field(
        default=None, description="of time: column with these, beside one of seconds"
    )
    milliseconds: str | None = Field(
        default=None, description="of time: column with these, beside one of whole seconds"
    )
    hemisphere: str | None = Field(
        default=None, description="column of N and S, E and W, or of S and P for starboard and port"
    )
    quaternion: tuple[str, str, str, str] | None = Field(
        default=None,
        description="of the heading, instead of a column: the columns of w, x, y and z",
    )
    frame: Literal["NED", "ENU"] = Field(default="NED", description="of the quaternion")

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns that it takes."""
        named = (
            self.column,
            self.date,
            self.nanoseconds,
            self.milliseconds,
            self.hemisphere,
            *(self.quaternion or ()),
        )
        return tuple(name for name in named if name)

    @model_validator(mode="after")
    def _names_a_column(self) -> Channel:
        if bool(self.column) == (self.quaternion is not None):
            raise ValueError("it should name a column, or the four of a quaternion")
        if self.map is not None and any(b[0] <= a[0] for a, b in pairwise(self.map)):
            raise ValueError("the first numbers of the pairs of a map should increase")
        return self


@dataclass(frozen=True)
class ChannelFile:
    """Content of a channel file.

    Attributes
    ----------
    channels : dict of str to Channel
        By role or connector.
    form : FileLayout
        What it says of the form of the log, under ``file``.
    """

    channels: dict[str, Channel]
    form: FileLayout = field(default_factory=FileLayout)


def read_channels(path: str | os.PathLike) -> ChannelFile:
    """Read a channel file: TOML with one entry for each role, or for each connector of a system.

    ``surge = {column = "u", unit = "kn"}``, or ``surge = "u"`` where nothing else is to be said; a connector
    inside the system in quotes, ``"vessel.u" = {column = "log", unit = "kn"}``; ``file = {decimal = ","}`` of the file.

    Raises
    ------
    ShipcosimError
        If the file cannot be read, misspells a role, or has no time.
    """
    path = Path(path)
    content = read_toml(path, "Channel files")[1]
    channels = {}
    problems = []
    form = FileLayout()
    if "file" in content:
        try:
            form = FileLayout.model_validate(content.pop("file"))
        except ValidationError as error:
            problems += _field_problems(f"{path}, file", error, FileLayout)
    for name, entry in content.items():
        where = f"{path}, {name}"
        problems += _misspelt(where, name)
        try:
            channels[name] = Channel.model_validate(
                {"column": entry} if isinstance(entry, str) else entry
            )
        except ValidationError as error:
            problems += _field_problems(where, error, Channel)
    problems += _together(path, content) if content or form == FileLayout() else ()
    if problems:
        raise ShipcosimError(problems)
    return ChannelFile(channels, form)


def _misspelt(where, name):
    """A name that is almost a role; any other may be a connector of the system."""
    if role_of(name) is None and get_close_matches(name, ROLES, n=1, cutoff=0.75):
        yield Problem(
            where,
            "is no role.",
            suggestion(name, [*ROLES, "NAME_rpm", "NAME_azimuth", "NAME_thrust"]),
        )


def _together(path, names):
    """Problems of the names as a set."""
    if "time" not in names:
        yield Problem(
            str(path), "says no column for time.", 'It should have, say, time = {column = "t"}.'
        )
    for first, other in (("north", "east"), ("latitude", "longitude")):
        if (first in names) != (other in names):
            there, missing = (first, other) if first in names else (other, first)
            yield Problem(str(path), f"has {there} without {missing}.", "A position needs both.")
    if "north" in names and "latitude" in names:
        yield Problem(
            str(path),
            "gives the position twice.",
            "Give north and east, or latitude and longitude.",
        )


def _field_problems(where, error, record):
    """What is wrong with the fields of an entry."""
    for detail in error.errors():
        yield Problem(".".join(map(str, (where, *detail["loc"]))), *complaint_of(detail, record))
