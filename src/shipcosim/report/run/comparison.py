"""The page of two runs: both in one scene and in every plot, and their differences as numbers."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from xarray import Dataset

from shipcosim.angles import wrap_series
from shipcosim.errors import Problem, ShipcosimError, error_at, shortened
from shipcosim.report.run.derived import ERRORS, FROM_REFERENCE
from shipcosim.report.run.details import parsed
from shipcosim.report.run.moments import Moment
from shipcosim.report.run.page import RunPage, drawn_data, drawn_rows, shown_table
from shipcosim.report.run.panels import Panel, Section, constants_as_words, make_sections
from shipcosim.report.run.roles import Roles
from shipcosim.report.run.scene import make_run
from shipcosim.report.theme import palette
from shipcosim.report.theme.display import turned_to
from shipcosim.report.theme.numbers import extent, finite, plain
from shipcosim.report.theme.views import Block, Fact, Outcome, Table

COLOURS = (palette.BLUE, palette.PURPLE)
THE_LINE = (
    "ship",
    "delivered",
    "ship − reference",
    "from the reference",
)  # where a panel shows more than the run
MOST_MOMENTS = 5  # differences to go to
MOST_CHOSEN = 3  # signals that are drawn first where there is no ship, of both runs
MOST_CHANGES = 8  # start values that differ, at the top of the page
MOST_DIFFERENCES = 25  # signals in the table of differences
SAME = 1e-9  # of a signal's range: a difference below it is rounding


class Difference(NamedTuple):
    """Difference of a signal: rms, largest, its time, in the signal's unit; rms over its range."""

    signal: str
    unit: str
    rms: float
    largest: float
    time: float
    share: float


@dataclass(frozen=True)
class Pair:
    """Two runs on common times.

    Attributes
    ----------
    names : (str, str)
    tables : (Dataset, Dataset)
        As they were given. [SI]
    shown : (Dataset, Dataset)
        In the units of the page, on common times; no number where a run has none.
    roles : Roles
        Of the first.
    shift : float
        Added to the times of the second. [s]
    """

    names: tuple[str, str]
    tables: tuple[Dataset, Dataset]
    shown: tuple[Dataset, Dataset]
    roles: Roles
    shift: float


class Comparison(NamedTuple):
    """Two runs on common times, both with their names in one table, their differences, and what the page shows."""

    pair: Pair
    both: Dataset
    differences: list[Difference]
    page: RunPage


@np.errstate(over="ignore", invalid="ignore")
def compared(tables: tuple[Dataset, Dataset], names: tuple[str, str]) -> Comparison:
    """Put two runs on common times and compare them.

    Parameters
    ----------
    tables : (xarray.Dataset, xarray.Dataset)
        Runs of any systems. They are laid over each other by their times; where these have nothing in common, the
        second is moved to start with the first, and the page says so.
    names : (str, str)
        What they are called on the page.

    Returns
    -------
    Comparison
        Differences of pose, errors and thrust first, then the largest over its signal's range.

    Raises
    ------
    ShipcosimError
        If a run has no rows, or the two have no signal in common.
    """
    pair = lay_over(tables, names)
    differing = _ordered(pair, differences(pair))
    both = _merged(pair)
    return Comparison(pair, both, differing, _page(pair, both, differing))


def lay_over(tables: tuple[Dataset, Dataset], names: tuple[str, str]) -> Pair:
    """Two runs on common times.

    Raises
    ------
    ShipcosimError
        If a run has no rows, or the two have no signal in common.
    """
    empty = [name for name, table in zip(names, tables, strict=True) if not table.sizes["time"]]
    if empty:
        remedy = "Give one that has."
        raise ShipcosimError([Problem(name, "The run has no rows.", remedy) for name in empty])
    if not set(tables[0].data_vars) & set(tables[1].data_vars):
        remedy = "Give two runs of one system, or of similar systems."
        raise error_at(" and ".join(names), "The two have no signal in common.", remedy)
    # Where the runs have no time in common, move the second to the start of the first.
    times = [np.asarray(table["time"].values, float) for table in tables]
    apart = times[1][0] > times[0][-1] or times[1][-1] < times[0][0]
    shift = float(times[0][0] - times[1][0]) if apart else 0.0
    # All times of both runs; rounding makes equal times equal.
    common = np.union1d(np.round(times[0], 9), np.round(times[1] + shift, 9))
    # Both in the units of the first, interpolated to the common times; no value beyond a run's ends.
    roles, first = shown_table(tables[0], ())
    second = shown_table(tables[1], ())[1]
    first = _on(first, times[0], common)
    second = _on(second, times[1] + shift, common)
    return Pair(names, tables, (first, _like(second, first)), roles, shift)


def differences(pair: Pair) -> list[Difference]:
    """Differences of common signals while both runs go; angles the short way round.

    Parameters
    ----------
    pair : Pair

    Returns
    -------
    list of Difference
        The largest over its signal's range first; signals that are the same are left out. Where one run alone has a
        number, rms and largest are none and the share is infinite.
    """
    first, second = pair.shown
    start, end, _ = _covered(pair)
    time = first["time"].values
    rows = (time > start - CLOSE) & (time < end + CLOSE)
    time = time[rows]
    differing = []
    for name in (str(n) for n in first.data_vars if n in second):
        a = first[name].values[rows]
        b = second[name].values[rows]
        unit = first[name].attrs["units"]
        # Angles the short way round: a difference of 359 deg is one of 1 deg.
        gap = wrap_series(b - a) if unit == "deg" else b - a
        size = np.abs(np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, gap))
        if not np.isfinite(size).all():
            when = float(time[np.argmin(np.isfinite(size))])
            differing.append(Difference(name, unit, np.nan, np.nan, when, np.inf))
            continue
        # Over the range of the signal; a constant one has none: its size, else the difference.
        most = int(np.argmax(size))
        largest = float(size[most])
        span = max(extent(a), extent(b)) or float(np.max(np.abs(finite(a)), initial=0.0)) or largest
        # Smaller differences are rounding.
        if largest > SAME * max(span, np.finfo(float).tiny):
            rms = largest * float(np.sqrt(np.mean((size / largest) ** 2)))
            differing.append(Difference(name, unit, rms, largest, float(time[most]), rms / span))
    return sorted(differing, key=lambda difference: -difference.share)


def _covered(pair: Pair) -> tuple[float, float, bool]:
    """First and last time that both runs cover, and whether that is all of both. [s]"""
    ends = [table["time"].values[[0, -1]] for table in pair.tables]
    ends[1] = ends[1] + pair.shift
    start = max(ends[0][0], ends[1][0])
    end = min(ends[0][1], ends[1][1])
    return float(start), float(end), bool(np.allclose(ends[0], ends[1]))


def _on(shown: Dataset, clock: NDArray, time: NDArray) -> Dataset:
    """Interpolate a table from its times to others; a time may be there twice, as at an event. [s]"""
    clock = np.round(clock, 9)
    columns = {}
    for name, v in shown.data_vars.items():
        values = np.interp(time, clock, v.values, left=np.nan, right=np.nan)
        columns[name] = ("time", values, v.attrs)
    return xr.Dataset(columns, {"time": time})


def _like(shown: Dataset, other: Dataset) -> Dataset:
    """The table in the other's units, angles moved by whole turns to the other's."""
    columns = {}
    for name, v in shown.data_vars.items():
        if name in other:
            # Convert units by the factors that the page applies to both.
            to = other[name]
            has_unit = to.attrs["units"] == v.attrs["units"]
            values = v.values * (1.0 if has_unit else to.attrs["factor"] / v.attrs["factor"])
            values = turned_to(values, to.values) if to.attrs["units"] == "deg" else values
            columns[name] = v.copy(data=values).assign_attrs(to.attrs)
    return shown.assign(columns)


# What the page shows.


def _page(pair: Pair, merged: Dataset, differing: Sequence[Difference]) -> RunPage:
    drawn, thinned = drawn_rows(merged)
    runs = [
        run
        for table, name, shift in zip(pair.tables, pair.names, (0.0, pair.shift), strict=True)
        if (run := make_run(table, (), name, shift)) is not None
    ]
    sections = constants_as_words(_sections(pair), merged)
    choice = [str(name) for name in merged.data_vars]
    facts = []
    for name, table in zip(pair.names, pair.tables, strict=True):
        start, end = table["time"].values[[0, -1]]
        scenario = parsed(table.attrs.get("scenario", "")) or "run"
        facts.append(Fact(name, f"{scenario}, {start:g} to {end:g} s"))
    # Where the two differ most by what people compare runs by.
    moments = [
        Moment(d.time, f"{d.signal}: {plain(d.largest)} {d.unit} at {d.time:g} s")
        for d in differing[:MOST_MOMENTS]
    ]
    data = drawn_data(drawn, choice, runs, sections, ())
    if moments:
        data["opens_at"] = moments[0].time
        data["chosen"] = [
            f"{name}: {d.signal}" for d in differing[:MOST_CHOSEN] for name in pair.names
        ]
    return RunPage(
        title=f"{pair.names[0]} and {pair.names[1]}",
        facts=facts,
        outcome=_outcome(pair, differing),
        data=data,
        remarks=tuple(_remarks(pair)),
        expectations=(),
        key_figures=_table(differing),
        thinned=thinned,
        sections=sections,
        details=_details(pair),
        changed=_changed(pair),
        changed_title=f"Start values in {pair.names[0]} and {pair.names[1]}",
        figures_title="Differences",
        moments=moments,
    )


def _merged(pair: Pair) -> Dataset:
    """Signals of both runs, with the name of the run in front."""
    return xr.Dataset(
        {
            f"{run}: {name}": v.assign_attrs(long_name=f"{v.attrs['long_name']}, {run}")
            for run, shown in zip(pair.names, pair.shown, strict=True)
            for name, v in shown.data_vars.items()
        }
    )


def _sections(pair: Pair) -> Sequence[Section]:
    """Panels of the first run, with both runs in each."""
    made = []
    for section in make_sections(pair.shown[0], pair.roles, ()):
        doubled = [_doubled(panel, pair) for panel in section.panels]
        panels = [panel for panel in doubled if panel is not None]
        if panels:
            made.append(replace(section, panels=panels))
    return made


def _doubled(panel: Panel, pair: Pair) -> Panel | None:
    """A panel with both runs: one curve each by colour; several curves, the second run dashed."""
    # Only curves that both runs have; of several, those of the ship itself.
    lines = [line for line in panel.lines if line.signal in pair.shown[1]]
    main = [line for line in lines if line.label in THE_LINE] or lines
    if not main:
        return None
    # One curve each: the colour tells the runs apart.
    both = []
    for line in main:
        for name, colour, dash in zip(pair.names, COLOURS, ("solid", "dot"), strict=True):
            signal = f"{name}: {line.signal}"
            if len(main) == 1:
                both.append(replace(line, signal=signal, label=name, colour=colour, dash="solid"))
            else:
                # Several curves keep their colours; the line style tells the runs apart.
                label = f"{line.label}, {name}"
                both.append(replace(line, signal=signal, label=label, dash=dash))
    return replace(panel, lines=both, bands=())


def _outcome(pair: Pair, differing: Sequence[Difference]) -> Outcome:
    """One sentence: largest distance of the ships, else the signal that differs most."""
    common = sum(1 for name in pair.shown[0].data_vars if name in pair.shown[1])
    if not differing:
        return Outcome("passed", "SAME", f"All {common} signals that both have are the same.")
    differ = f"{len(differing)} of {common} signals differ"
    # Distance between the ships at each common time.
    first, second = pair.shown
    position = [pair.roles.signal(pair.roles.ship, axis) for axis in "xy"]
    if all(name in first and name in second for name in position):
        gap = np.hypot(*(second[name].values - first[name].values for name in position))
        if np.isfinite(gap).any() and np.nanmax(gap) > 0.0:
            when = first["time"].values[int(np.nanargmax(gap))]
            most = plain(float(np.nanmax(gap)))
            rms = plain(float(np.sqrt(np.nanmean(gap**2))))
            text = f"The ships lie up to {most} m apart, at {when:g} s; {rms} m rms."
            return Outcome("plain", "DIFFER", f"{text} {differ}.")
    # Without positions: the signal with the largest difference over its range.
    worst = max(differing, key=lambda difference: difference.share)
    return Outcome("plain", "DIFFER", f"{differ}, most of all {worst.signal}.")


CLOSE = 1e-8
"""Times are rounded to nanoseconds to be common. [s]"""


def _remarks(pair: Pair) -> list[str]:
    remarks = []
    first, second = pair.names
    # Runs without common times were moved; the reader must know.
    if pair.shift:
        remarks.append(
            f"The runs have no time in common: {second} is moved by {pair.shift:g} s to start with {first}."
        )
    # Differences cover only the time that both runs have.
    start, end, is_whole = _covered(pair)
    if not is_whole:
        remarks.append(f"Differences are for {start:g} to {end:g} s, which both runs cover.")
    # Signals that only one run has: name the first five.
    for name, shown, other in ((first, *pair.shown), (second, *pair.shown[::-1])):
        if alone := [str(signal) for signal in shown.data_vars if signal not in other]:
            remarks.append(f"Only in {name}: {shortened(alone)}.")
    return remarks


def _ordered(pair: Pair, differing: Sequence[Difference]) -> list[Difference]:
    """Differences of the most important signals first, then the others in order."""
    roles = pair.roles
    wanted = [roles.signal(roles.ship, axis) for axis in ("x", "y", "psi")]
    wanted += [FROM_REFERENCE, ERRORS["psi"]]
    wanted += [roles.signal(unit, "thrust") for unit in roles.thrusters]
    return sorted(differing, key=lambda one: [*wanted, one.signal].index(one.signal))


def _table(differing: Sequence[Difference]) -> Table:
    """The first of the differences as texts."""
    rows = [
        (d.signal, f"{plain(d.rms)} {d.unit}", f"{plain(d.largest)} {d.unit}", f"{d.time:g} s")
        for d in differing[:MOST_DIFFERENCES]
    ]
    return Table(rows, ("Signal", "rms", "Largest", "At")) if rows else Table(())


def _start_values(pair: Pair) -> Block | None:
    """Start values that differ."""
    texts = (parsed(table.attrs.get("start_values", "{}")) for table in pair.tables)
    values = [
        {name: _in_units(name, value, pair) for name, value in text.items()}
        for text in texts
        if isinstance(text, dict)
    ]
    return _unlike("Start values that differ", pair, values) if len(values) == 2 else None


def _in_units(name: str, value: Any, pair: Pair) -> str:
    """A start value in the page's unit, where the runs hold a signal of that name."""
    if not isinstance(value, float):
        return str(value)
    attributes = next((shown[name].attrs for shown in pair.shown if name in shown), {})
    return f"{value * attributes.get('factor', 1.0):.6g} {attributes.get('units', '')}".rstrip()


def _changed(pair: Pair) -> Sequence[str]:
    """The first start values that differ, for the top of the page."""
    detail = _start_values(pair)
    rows = detail.table.rows if detail else ()
    changes = [f"{name} {first} and {second}" for name, first, second in rows[:MOST_CHANGES]]
    more = len(rows) - len(changes)
    return (*changes, f"{more} more under Parameters") if more else changes


def _details(pair: Pair) -> Sequence[Block]:
    """Entries that differ between the attributes of the runs: start values, events, versions."""
    # Start values have a table of their own; long lists are left out.
    left_out = ("start_values", "remarks", "fmus")
    rest = [
        {str(key): parsed(value) for key, value in table.attrs.items() if key not in left_out}
        for table in pair.tables
    ]
    tables = (_start_values(pair), _unlike("Runs that differ", pair, rest))
    return [detail for detail in tables if detail is not None]


def _unlike(title: str, pair: Pair, contents: Sequence[Mapping[str, Any]]) -> Block | None:
    """A table of the entries that differ, or None."""
    names: Iterable[str] = dict.fromkeys([*contents[0], *contents[1]])
    entries = [(name, *(str(content.get(name, "–")) for content in contents)) for name in names]
    rows = [row for row in entries if row[1] != row[2]]
    return Block(title, Table(rows, ("", *pair.names))) if rows else None
