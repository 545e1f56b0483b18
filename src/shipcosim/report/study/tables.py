"""Results of a study of many runs for the page, and their columns in units to read."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shipcosim.report.study.static import static_curves
from shipcosim.report.theme.display import READ_AS
from shipcosim.report.theme.numbers import finite
from shipcosim.sweep.storage import read_part
from shipcosim.sweep.summary import RANGE

if TYPE_CHECKING:
    from pandas import DataFrame, Series

    from shipcosim.sweep import Swept

FACTOR = "factor"
SAMPLE = "sample"
QUANTITY = "quantity"
SUMMARY = "summary"
MOST_LEVELS = 40
"""Different numbers of a column that are still levels, which readers may choose from."""
_TRUTH = (False, True)


@dataclass(frozen=True)
class StudyTables:
    """Results of a study.

    Attributes
    ----------
    about : mapping
        ``study.json``: `name`, the `study` as read, `columns` with their role, unit, description and order of labels,
        `runs` planned, done and failed, `versions`; where known `engine`, `ship`, `beside` and `remarks`.
    runs : pandas.DataFrame
        A row a run. [units as `columns` says]
    summary : pandas.DataFrame
        A row for each combination of the factors that are left.
    tracks : pandas.DataFrame, optional
        `run`, `time` [s] and the signals that were kept of each run.
    tables : mapping of str to pandas.DataFrame
        Others that views name.
    pages : collection of int
        Runs whose page lies in the folder ``run-N`` beside this one.
    command : str
        What a user types to make this study; with ``--run N`` it simulates one row again.
    """

    about: Mapping[str, Any]
    runs: DataFrame
    summary: DataFrame
    tracks: DataFrame | None = None
    tables: Mapping[str, DataFrame] = field(default_factory=dict)
    pages: Collection[int] = ()
    command: str = "shipcosim sweep STUDY.toml"

    @property
    def study(self) -> Mapping[str, Any]:
        """The study as it was read, without `extends`."""
        return self.about.get("study", {})

    @property
    def name(self) -> str:
        """Name of the study."""
        return str(self.about.get("name") or "study")

    @property
    def every(self) -> dict[str, DataFrame]:
        """All tables that a view can name."""
        return {"runs": self.runs, "summary": self.summary, **self.tables}

    def columns(self, frame: DataFrame) -> dict[str, Column]:
        """Columns of one of the tables, as the study describes them."""
        return columns_of(frame, self.about.get("columns", ()))


def tables_of(swept: Swept, command: str) -> StudyTables:
    """Results of a study, with tables and pages of runs in its folder.

    Parameters
    ----------
    swept : Swept
    command : str
        What a user types to make this study.
    """

    # Tracks, static capability, and runs that have a page.
    folder = swept.folder
    tracks = swept.folder / "tracks.parquet"
    scenario = swept.plan.scenario
    views = swept.plan.study.view
    static_tables, remarks = static_curves(views, scenario.system_path, scenario.parameter_paths)
    matches = (
        re.fullmatch(r"run-([0-9]+)", page.parent.name) for page in folder.glob("run-*/report.html")
    )
    return StudyTables(
        about={
            **swept.about,
            "beside": static_tables,
            "remarks": [*swept.about.get("remarks", ()), *remarks],
            "ship": _ship(swept),
        },
        runs=swept.runs,
        summary=swept.summary,
        tracks=read_part(tracks) if tracks.is_file() else None,
        tables=swept.tables,
        pages=sorted(int(match[1]) for match in matches if match),
        command=command,
    )


def _ship(swept: Swept) -> dict[str, float]:
    """Length and breadth of the ship whose tracks are kept; empty if unknown. [m]"""
    # Sizes from the start values of the component whose signals are kept.
    tracks = swept.plan.study.tracks
    system = swept.plan.system
    name = system.split(tracks.signals[0])[0] if tracks is not None else None
    if name is None or not system.components[name].variables.keys() >= {"length", "breadth"}:
        return {}
    sizes = {size: system.components[name].start_value(size) for size in ("length", "breadth")}
    return {size: float(value) for size, value in sizes.items() if value is not None}


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    name, role, description : str
    unit : str
        As it is shown.
    values : (n,) array
        Numbers in `unit`, NaN where there is none; 0 and 1 of what is true or false; places in `labels`.
    labels : sequence of str
        Of what is no number, in their order.
    is_truth : bool
        Whether it is true or false.
    ranges : sequence of str
        Of a value that a study tells in part, as it runs not every case: ``">= 4"``, ``"1 to 3"``; else empty.
    """

    name: str
    role: str
    description: str
    unit: str
    values: NDArray
    labels: Sequence[str] = ()
    is_truth: bool = False
    ranges: Sequence[str] = ()

    def text_at(self, row: int) -> str:
        """Value of a row as text for readers; its bounds where not every case was run."""
        return self.ranges[row] if self.ranges else self.text(self.values[row])

    @property
    def is_number(self) -> bool:
        """Whether its values are numbers."""
        return not self.labels and not self.is_truth

    @property
    def levels(self) -> Sequence[float]:
        """Distinct values of a factor, or whole numbers, in order; empty if they are too many."""
        # Labels are levels; numbers only if they are few, and whole or a factor's.
        if self.labels:
            return [float(k) for k in range(len(self.labels))]
        levels = np.unique(finite(self.values))
        are_few = len(levels) <= MOST_LEVELS and (
            self.role == FACTOR or bool(np.all(levels == np.round(levels)))
        )
        return tuple(levels.tolist()) if are_few else ()

    @property
    def titled(self) -> str:
        """Name with unit.

        Examples
        --------
        >>> Column("wind", FACTOR, "", "m/s", np.zeros(1)).titled
        'wind [m/s]'
        """
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def text(self, value: float, with_name: bool = False) -> str:
        """A value as text for readers.

        Examples
        --------
        >>> Column("wind", FACTOR, "", "m/s", np.zeros(1)).text(7.5, with_name=True)
        'wind 7.5 m/s'
        """
        # Infinite means not reached before the end of the run.
        if not np.isfinite(value):
            return "never in the run" if value == np.inf else "–"
        if self.labels:
            return self.labels[int(value)]
        if self.is_truth:
            answer = "yes" if value else "no"
            return f"{self.name}: {answer}" if with_name or not value else answer
        gap = "" if self.unit in ("", "°") else " "
        number = f"{signed(value, 4 if self.role == FACTOR else 3)}{gap}{self.unit}"
        return f"{self.name} {number}" if with_name else number


Columns = Mapping[str, Column]


def signed(value: float, digits: int = 4) -> str:
    """A number as a table cell shows it.

    Examples
    --------
    >>> signed(-0.25), signed(10_000.0), signed(1234567.0)
    ('−0.25', '10000', '1.235e+06')
    """
    text = f"{value:.{digits}g}"
    # Python writes powers of ten from as many digits on as are asked for: 1e+04 is no number that people read.
    if 1.0 <= abs(value) < 1e6:
        text = f"{float(text):.10g}"
    return text.replace("-", "−").replace("e−", "e-")


def columns_of(frame: DataFrame, about_columns: Iterable[Mapping[str, Any]]) -> dict[str, Column]:
    """Columns of a table by name, without `run`, `error` and `input`.

    Parameters
    ----------
    frame : pandas.DataFrame
    about_columns : iterable of mapping
        Of columns: `name`, `role`, `unit`, `description`, `labels`. What is said of NAME holds for NAME_low and
        NAME_high.

    Returns
    -------
    dict of str to Column
        In the order of the table.
    """
    # Ends of an interval have the unit and role of their value.
    about = {str(entry["name"]): entry for entry in about_columns}
    for name, described in list(about.items()):
        for end in ("low", "high"):
            about.setdefault(f"{name}_{end}", described)
    columns = {}
    for name in map(str, frame.columns):
        # What is known of a value in part belongs to its column.
        is_range = name.endswith(RANGE) and name.removesuffix(RANGE) in frame
        if is_range or name in ("run", "error", "input"):
            continue
        column = column_of(name, cast("Series", frame[name]), about.get(name, {}))
        if f"{name}{RANGE}" in frame:
            column = replace(column, ranges=tuple(map(str, frame[f"{name}{RANGE}"])))
        columns[name] = column
    return columns


def column_of(name: str, values: Series, about: Mapping[str, Any]) -> Column:
    """One column in units to read: degrees, kN for large numbers."""
    made = Column(
        name, str(about.get("role") or ""), str(about.get("description") or ""), "", np.zeros(0)
    )
    # True or false, also where some values are missing.
    filled = values[values.notna()]
    if values.dtype.kind == "b" or (
        values.dtype.kind == "O" and len(filled) and all(value in _TRUTH for value in filled)
    ):
        return replace(made, values=_numbers(values), is_truth=True)
    # Numbers, in the unit to read.
    if values.dtype.kind in "iuf" or not len(filled):
        shown, unit = readable(_numbers(values), about.get("unit"))
        return replace(made, values=shown, unit=unit)
    # Texts that are all numbers become numbers; others become labels.
    texts = [label(value) for value in values]
    number = re.compile(r"[-+]?\d+(\.\d*)?", re.ASCII)
    if all(map(number.fullmatch, filter(None, texts))):
        return column_of(name, values.map(lambda value: float(label(value) or "nan")), about)
    # Labels in the order of the study, then as they occur.
    order = [label(value) for value in about.get("labels") or ()]
    there = dict.fromkeys(text for text in texts if text)
    labels = tuple(dict.fromkeys([*(entry for entry in order if entry in there), *there]))
    place = {label: float(k) for k, label in enumerate(labels)}
    return replace(
        made, values=np.array([place.get(text, np.nan) for text in texts]), labels=labels
    )


def readable(values: ArrayLike, unit: str | None) -> tuple[NDArray, str]:
    """Numbers with their unit for readers.

    Examples
    --------
    >>> readable([0.0, np.pi / 4], "rad")
    (array([ 0., 45.]), '°')
    """
    # Small quantities stay in their unit.
    numbers = np.asarray(values, float)
    shown, factor, least = READ_AS.get(unit or None, (unit or "", 1.0, 0.0))
    sizes = np.abs(finite(numbers))
    if sizes.size and sizes.max() < least:
        shown = unit or ""
        factor = 1.0
    # Round to 12 digits: 45 deg must not read 44.99999999.
    scaled = factor * numbers
    power = np.where(
        np.isfinite(scaled) & (scaled != 0.0), np.floor(np.log10(np.abs(scaled) + 1e-300)), 0.0
    )
    return np.round(scaled / 10.0**power, 11) * 10.0**power, {"deg": "°"}.get(shown, shown)


def _numbers(values: Series) -> NDArray:
    return values.to_numpy(float, na_value=np.nan)


def label(value: object) -> str:
    """A label as text; whole numbers as 2, not 2.0."""
    if value is None or value != value:
        return ""
    return f"{value:g}" if isinstance(value, float) else str(value)
