"""A table for readers: degrees and kN, angles without jumps, few enough rows to draw."""

import numpy as np
import pandas
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from xarray import Dataset

from shipcosim.angles import unwrap_series
from shipcosim.report.theme.numbers import finite

READ_AS = {  # unit in the table: unit people read, factor, least size for which it pays
    "rad": ("deg", 180 / np.pi, 0.0),
    "rad/s": ("deg/s", 180 / np.pi, 0.0),
    "rad/s2": ("deg/s²", 180 / np.pi, 0.0),
    "N": ("kN", 1e-3, 1000.0),
    "N.m": ("kN·m", 1e-3, 1000.0),
    "W": ("kW", 1e-3, 1000.0),
    "m/s2": ("m/s²", 1.0, 0.0),
    "1": ("", 1.0, 0.0),
    None: ("", 1.0, 0.0),
}


def display_table(table: Dataset, ship_heading: str | None = None) -> Dataset:
    """The table in the units of the page.

    Parameters
    ----------
    table : xarray.Dataset
        Signals over `time`. [SI]
    ship_heading : str, optional
        Signal of the ship's heading: other headings are moved by whole turns to lie beside it.

    Returns
    -------
    xarray.Dataset
        Same rows and attributes; text signals are left out. What is drawn is the attribute `factor` times what the
        table holds, plus whole turns where it is an angle.
    """
    # One unit for each quantity on the whole page.
    units = units_to_read(table)
    columns = {}
    for name, variable in series_in(table).items():
        unit, factor = units.get(variable.attrs.get("units"), (variable.attrs.get("units"), 1.0))
        # Angles are drawn without jumps.
        values = unturned(str(name), variable.values) if unit == "deg" else variable.values
        columns[name] = as_variable(
            factor * np.asarray(values, float), unit, variable.attrs.get("long_name", ""), factor
        )
    # As an index of pandas, for which xarray need not import pint.
    clock = pandas.Index(np.asarray(table["time"].values, float))
    shown = xr.Dataset(columns, coords={"time": ("time", clock)}, attrs=table.attrs)
    # Headings next to each other must lie on the same turn.
    if ship_heading is not None:
        _align_headings(shown, ship_heading)
    return shown


def units_to_read(table: Dataset) -> dict[str | None, tuple[str, float]]:
    """Unit and factor to show for each unit of the table; the same on the whole page.

    Returns
    -------
    dict of str or None to (str, float)
    """
    chosen = {}
    # Largest size of each unit: kN pays only from 1000 N on.
    largest = dict.fromkeys([v.attrs.get("units") for v in table.variables.values()], 0.0)
    for variable in series_in(table).values():
        if variable.dtype.kind != "b" and variable.size and not np.isnan(variable.values).all():
            unit = variable.attrs.get("units")
            largest[unit] = max(largest[unit], np.nanmax(np.abs(variable.values)))
    # Small quantities stay in their unit.
    for unit, size in largest.items():
        shown, factor, least = READ_AS.get(unit, (unit, 1.0, 0.0))
        chosen[unit] = (shown, factor) if size >= least else (unit or "", 1.0)
    return chosen


def series_in(table: Dataset) -> dict[str, xr.Variable]:
    """The columns of numbers, as variables: making a DataArray looks through all names of the table."""
    series = {str(name): table.variables[name] for name in table.data_vars}
    return {name: v for name, v in series.items() if v.dtype.kind in "fiub" and v.dims == ("time",)}


def thinned(shown: Dataset, most: int) -> tuple[Dataset, int]:
    """The table with few enough rows to draw: extremes of each interval, so no peak is lost.

    Parameters
    ----------
    shown : xarray.Dataset
        Table to draw.
    most : int
        Rows that may be left.

    Returns
    -------
    (xarray.Dataset, int)
        The table, and how many rows each interval spans; 1 if nothing was thinned.
    """
    rows = shown.sizes["time"]
    if rows <= most:
        return shown, 1
    # Two rows for each interval: its least and its largest value.
    span = int(np.ceil(2 * rows / most))
    starts = np.arange(0, rows, span)
    drawn = np.unique(
        np.concatenate([starts, np.minimum(starts + span // 2, rows - 1), [rows - 1]])
    )
    thin = shown.isel(time=drawn)
    # Each signal has its own extremes; the rows in between only carry the times.
    for name, variable in shown.data_vars.items():
        thin[name] = ("time", _extremes(variable.values, drawn, starts, span), variable.attrs)
    return thin, span


def is_constant(values: NDArray) -> bool:
    """True if all values are the same finite number."""
    return len(values) > 0 and bool(np.isfinite(values[0])) and bool(np.all(values == values[0]))


def _extremes(values: NDArray, drawn: NDArray, starts: NDArray, span: int) -> NDArray:
    """Values for the rows `drawn`: least and largest of each interval, in their order."""
    answer = values[drawn].copy()
    position = {row: k for k, row in enumerate(drawn)}
    # Intervals with gaps, or without a second row, keep their plain values.
    for start in starts:
        part = values[start : start + span]
        if np.isnan(part).any() or start + span // 2 >= len(values):
            continue
        # Keep the order in time: a rise stays a rise.
        rows = sorted((int(np.argmin(part)), int(np.argmax(part))))
        answer[position[start]], answer[position[start + span // 2]] = part[rows[0]], part[rows[1]]
    # First and last value are exact: key figures and runs start and end there.
    answer[0], answer[-1] = values[0], values[-1]
    return answer


def as_variable(
    values: ArrayLike, unit: str | None, long_name: str, factor: float = 1.0
) -> xr.Variable:
    """A signal of the page."""
    return xr.Variable(
        "time", values, {"units": unit or "", "long_name": long_name, "factor": factor}
    )


def unturned(name: str, radians: ArrayLike) -> NDArray:
    """Angle without jumps at half turns; directions from north start in [0, 2 pi). [rad]"""
    values = unwrap_series(np.array(radians, float))
    # A direction from north starts within [0, 2 pi).
    if name.rpartition(".")[2].split("_")[-1] in ("from", "to", "mean"):
        values = values - 2 * np.pi * np.floor(finite(values)[:1].sum() / (2 * np.pi))
    return values


def _align_headings(shown: Dataset, psi: str) -> None:
    """Move other headings by whole turns to the ship's."""
    for name in shown.data_vars:
        if (
            name != psi
            and "psi" in str(name).rpartition(".")[2].split("_")
            and shown[name].attrs["units"] == "deg"
        ):
            shown[name].values[:] = turned_to(shown[name].values, shown[psi].values)


def turned_to(angles: NDArray, others: NDArray) -> NDArray:
    """Angles moved by whole turns to others at the same times. [deg]"""
    # The median decides, since single wraps must not.
    gaps = finite(angles - others)
    return angles - 360.0 * np.round(np.median(gaps) / 360.0) if len(gaps) else angles
