"""What a channel file can say of the form of a log, where the file itself leaves it open."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class FileLayout(BaseModel):
    """The entry ``file`` of a channel file. What is not said is found out from the file."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    separator: str | None = Field(
        default=None, description="between cells; a blank stands for any number of blanks"
    )
    decimal: Literal[".", ","] | None = Field(
        default=None, description="decimal sign; the other one groups thousands"
    )
    encoding: str | None = Field(default=None, description="of the text, say latin-1 or utf-16")
    names: tuple[str, ...] | None = Field(
        default=None, description="of the columns, in a file without a header"
    )
    dates: Literal["dmy", "mdy", "ymd"] | None = Field(
        default=None, description="order of day, month and year"
    )
    sheet: str | None = Field(
        default=None, description="of a workbook; the one with the most cells if not given"
    )
    name: str | None = Field(
        default=None, description="column with the names of values, one value a row"
    )
    value: str | None = Field(default=None, description="column with these values")
