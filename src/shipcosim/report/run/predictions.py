"""Predictions in a run, compared with what the ship did afterwards."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from shipcosim.angles import unwrap_series, wrap_series
from shipcosim.report.run.roles import Roles, find_roles, join
from shipcosim.report.theme.packing import LEVELS, packed_series
from shipcosim.series import write_file

if TYPE_CHECKING:
    import pandas
    from xarray import Dataset

    from shipcosim.ssp import AnyPath

MOST_DRAWN = 1200  # predictions in the scene
UNITS = {
    "time": "s",
    "component": "",
    "horizon": "s",
    "x": "m",
    "y": "m",
    "psi": "rad",
    "true_x": "m",
    "true_y": "m",
    "true_psi": "rad",
    "error_north": "m",
    "error_east": "m",
    "error_heading": "rad",
    "position_region": "m",
    "heading_region": "rad",
    "in_position_region": "",
    "in_heading_region": "",
    "learned": "1",
}
"""Columns of the table of predictions, with their units."""


class PredictionSummary(NamedTuple):
    """How far off the predictions of one component are at one horizon.

    Attributes
    ----------
    component : str
    horizon : float
        [s]
    count : int
        Predictions whose time the run reached.
    position, heading : float
        Root mean square of distance and angle off. [m, rad]
    in_position_region, in_heading_region : float
        Shares within the regions; no number where there are none. [1]
    """

    component: str
    horizon: float
    count: int
    position: float
    heading: float
    in_position_region: float
    in_heading_region: float


def find_predictors(roles: Roles) -> dict[str, Sequence[int]]:
    """Components with the outputs of `interfaces.MotionPredictor`, and their horizons. [s]"""
    predictors = {}
    for component, connectors in roles.connectors.items():
        # A predictor has x, y and psi at the same horizons, and the time of its prediction.
        ends = [int(match[1]) for name in connectors if (match := re.fullmatch(r"x_(\d+)", name))]
        horizons = tuple(
            sorted(end for end in ends if {f"y_{end}", f"psi_{end}"} <= set(connectors))
        )
        if horizons and "predicted_at" in connectors:
            predictors[component] = horizons
    return predictors


def first_rows(table: Dataset, component: str) -> NDArray:
    """Rows at which a component has a new prediction."""
    # A new prediction changes its time; between two it is held.
    made = table[join(component, "predicted_at")].values
    return np.flatnonzero(np.r_[True, np.diff(made) != 0.0]) if len(made) else np.zeros(0, int)


def make_predictions(table: Dataset) -> pandas.DataFrame:
    """Every prediction of a run at every horizon.

    Parameters
    ----------
    table : xarray.Dataset
        A run.

    Returns
    -------
    pandas.DataFrame
        Columns as `UNITS`, angles in [-π, π); no rows where the system has no predictor or no ship. Truth and errors
        are no numbers where the run ends before, shares where there is no region.

    Notes
    -----
    The truth between two rows of the table is taken on the straight line. A region of 0 is none.
    """
    import pandas

    # One part for each predictor and horizon.
    roles = find_roles(table.data_vars)
    parts = []
    if roles.signal(roles.ship, "x") is not None:
        for component, horizons in find_predictors(roles).items():
            rows = first_rows(table, component)
            parts += [_at_horizon(table, rows, roles, component, end) for end in horizons]
    # Columns of all parts; also without predictors the table has its columns.
    columns = {
        name: np.concatenate([part[name] for part in parts]) if parts else np.zeros(0)
        for name in UNITS
    }
    frame = pandas.DataFrame(columns)
    return frame.sort_values(["component", "time", "horizon"], kind="stable", ignore_index=True)


def _at_horizon(
    table: Dataset, rows: NDArray, roles: Roles, component: str, horizon: int
) -> dict[str, NDArray]:
    """Columns of the predictions that one component made at these rows, at one horizon."""

    def read(connector):
        return _values_at(table, rows, join(component, connector))

    # Predicted pose, and the true pose when its time has come.
    time = read("predicted_at")
    place = {axis: read(f"{axis}_{horizon}") for axis in ("x", "y", "psi")}
    true = _truth(table, roles, time + horizon)
    # Heading error the short way round.
    off = {axis: place[axis] - true[axis] for axis in place}
    off["psi"] = wrap_series(off["psi"], 2.0 * np.pi)
    # Regions around the prediction; 0 means that there is none.
    circle = read(f"position_region_{horizon}")
    width = read(f"heading_region_{horizon}")
    return {
        "time": time,
        "component": np.full(len(time), component, dtype=object),
        "horizon": np.full(len(time), float(horizon)),
        **place,
        **{f"true_{axis}": values for axis, values in true.items()},
        "error_north": off["x"],
        "error_east": off["y"],
        "error_heading": off["psi"],
        "position_region": circle,
        "heading_region": width,
        "in_position_region": _within(np.hypot(off["x"], off["y"]), circle),
        "in_heading_region": _within(np.abs(off["psi"]), width),
        "learned": read("learned"),
    }


def _values_at(table: Dataset, rows: NDArray, name: str) -> NDArray:
    """Values of a signal at some rows; 0 where there is no such signal."""
    return table[name].values[rows].astype(float) if name in table else np.zeros(len(rows))


def _truth(table: Dataset, roles: Roles, time: NDArray) -> dict[str, NDArray]:
    """Pose of the ship at any times; NaN beyond the run."""
    clock = table["time"].values
    pose = {}
    for axis in ("x", "y", "psi"):
        # Interpolate the heading without jumps, and wrap it again afterwards.
        values = table[roles.signal(roles.ship, axis)].values.astype(float)
        values = unwrap_series(values) if axis == "psi" else values
        pose[axis] = np.where(time <= clock[-1] + 1e-6, np.interp(time, clock, values), np.nan)
    pose["psi"] = wrap_series(pose["psi"], 2.0 * np.pi)
    return pose


def _within(size: NDArray, region: NDArray) -> NDArray:
    """1 within the region, 0 outside, NaN where there is no region or no truth."""
    return np.where(np.isfinite(size) & (region > 0.0), (size <= region).astype(float), np.nan)


def predicted_tracks(table: Dataset, shift: float = 0.0) -> list[dict[str, Any]]:
    """What the scene draws of a run's predictions.

    Parameters
    ----------
    table : xarray.Dataset
        A run.
    shift : float
        Added to its times. [s]

    Returns
    -------
    list of dict
        One a predictor: its name, when its predictions were made [s], its horizons [s], and packed by horizon: place
        north and east [m], heading [deg], radius of the region [m].
    """
    tracks = []
    for component, horizons in find_predictors(find_roles(table.data_vars)).items():
        # Evenly fewer predictions where there are more than the scene can draw.
        rows = first_rows(table, component)
        drawn = np.linspace(0, len(rows) - 1, min(len(rows), MOST_DRAWN)).round().astype(int)
        rows = rows[np.unique(drawn)]

        def packed(connector, resolution, rows=rows, component=component):
            values = _values_at(table, rows, join(component, connector))
            values = np.degrees(unwrap_series(values)) if connector.startswith("psi") else values
            return packed_series(values, max(LEVELS, float(np.ptp(values)) / resolution))

        # Pack each column with the resolution that a screen shows.
        if len(rows):
            made_at = _values_at(table, rows, join(component, "predicted_at")) + shift
            parts = {"north": ("x_", 0.01), "east": ("y_", 0.01), "heading": ("psi_", 0.02)}
            parts |= {"radius": ("position_region_", 0.01)}
            columns = {
                what: [packed(f"{stem}{end}", r) for end in horizons]
                for what, (stem, r) in parts.items()
            }
            tracks.append(
                {
                    "name": component,
                    "made": packed_series(made_at, 1e9),
                    "horizons": list(horizons),
                    **columns,
                }
            )
    return tracks


def summarise(predictions: pandas.DataFrame) -> list[PredictionSummary]:
    """Prediction errors by component and horizon.

    Parameters
    ----------
    predictions : pandas.DataFrame
        As `make_predictions` gives them.

    Returns
    -------
    list of PredictionSummary
        Without what no run reached.
    """
    # Predictions whose horizon lies beyond the run have no truth.
    reached = predictions[np.isfinite(predictions["true_x"])]
    summaries = []
    groups: Any = reached.groupby(["component", "horizon"])
    for (component, horizon), of in groups:
        # Rms errors, and shares within the regions where there are regions.
        squares = of[["error_north", "error_east", "error_heading"]] ** 2
        north, east, heading = squares.mean(skipna=False)
        shares = of[["in_position_region", "in_heading_region"]].mean()
        summaries.append(
            PredictionSummary(
                component, horizon, len(of), np.sqrt(north + east), np.sqrt(heading), *shares
            )
        )
    return summaries


def texts(summaries: Iterable[PredictionSummary]) -> list[tuple[str, str, str, str]]:
    """Summaries in words: predictor and horizon, errors, share within the regions."""
    rows = []
    for summary in summaries:
        shares = {"places": summary.in_position_region, "headings": summary.in_heading_region}
        within = [f"{100.0 * x:.0f} % of {what}" for what, x in shares.items() if np.isfinite(x)]
        rows.append(
            (
                f"{summary.component}, {summary.horizon:g} s ahead",
                f"{summary.position:.2f} m rms",
                f"{np.degrees(summary.heading):.1f} deg rms",
                f"{' and '.join(within)} within the regions" if within else "no uncertainty given",
            )
        )
    return rows


def write_predictions(predictions: pandas.DataFrame, path: AnyPath) -> None:
    """Write a table of predictions as CSV, units in its header.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    named = predictions.rename(
        columns={name: f"{name} [{unit}]" for name, unit in UNITS.items() if unit}
    )
    write_file(path, named.to_csv(index=False, lineterminator="\n").encode())
