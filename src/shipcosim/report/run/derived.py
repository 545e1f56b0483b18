"""Derived signals: errors, distances, wind and current as speed and direction."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from xarray import Dataset, Variable

from shipcosim.angles import wrap_series
from shipcosim.report.run.roles import Roles
from shipcosim.report.theme.display import as_variable, unturned
from shipcosim.scenario import Verdict
from shipcosim.scenario.judge import rows_of

ERRORS = {"x": "north error", "y": "east error", "psi": "heading error"}
FROM_REFERENCE = "distance from reference"
FROM_EXPECTED = "distance from expected point"


def add_derived(
    shown: Dataset, table: Dataset, roles: Roles, verdicts: Sequence[Verdict]
) -> Dataset:
    """Add the derived signals whose inputs the table has.

    Parameters
    ----------
    shown : xarray.Dataset
        The table in the page's units.
    table : xarray.Dataset
        The same in SI.
    roles : Roles
        What the signals stand for.
    verdicts : sequence of Verdict
        Expectations: the distance from an expected point is shown in its window.

    Returns
    -------
    xarray.Dataset
    """
    # Errors first: distances are computed from them.
    shown = shown.assign(errors(shown, roles))
    return shown.assign({**distances(shown, table, roles, verdicts), **true_flow(shown, roles)})


def desired(roles: Roles, axis: str) -> str | None:
    """Signal that the ship's x, y or psi should follow: the reference, else the set point, or None."""
    reference = roles.signal(roles.reference, f"{axis}_d")
    return reference or next(iter(roles.anywhere(f"{axis}_set")), None)


def errors(shown: Dataset, roles: Roles) -> dict[str, Variable]:
    """Ship minus reference in x, y and psi; headings the short way round."""
    errors = {}
    # A heading error lies within half a turn.
    for axis, name in ERRORS.items():
        ship = roles.signal(roles.ship, axis)
        reference = desired(roles, axis)
        if ship and reference:
            error = shown[ship].values - shown[reference].values
            unit = shown[ship].attrs["units"]
            errors[name] = as_variable(wrap_series(error) if unit == "deg" else error, unit, name)
    return errors


def distances(
    shown: Dataset, table: Dataset, roles: Roles, verdicts: Sequence[Verdict]
) -> dict[str, Variable]:
    """Distance from the reference, and from the expected point within windows of expectations."""
    if not {ERRORS["x"], ERRORS["y"]} <= set(shown):
        return {}
    # Distance from north and east error.
    distance = np.hypot(shown[ERRORS["x"]].values, shown[ERRORS["y"]].values)
    distances = {FROM_REFERENCE: as_variable(distance, "m", FROM_REFERENCE)}
    # Distance as the expectation judged it, only where an expectation asks for a position.
    judged = judged_distance(table, [roles.signal(roles.ship, axis) for axis in "xy"], verdicts)
    if np.isfinite(judged).any():
        distances[FROM_EXPECTED] = as_variable(judged, "m", FROM_EXPECTED)
    return distances


def judged_distance(
    table: Dataset, signals: list[str | None], verdicts: Sequence[Verdict]
) -> NDArray:
    """Distance from the expected point within windows of expectations, NaN elsewhere, (n,)."""
    distance = np.full(table.sizes["time"], np.nan)
    for expect in (verdict.expect for verdict in verdicts):
        if expect.signal != signals or expect.near is None:
            continue
        # The target is a point, or signals that move.
        rows = rows_of(table, expect)
        gaps = []
        for signal, target in zip(expect.signal, expect.near, strict=True):
            middle = table[target].values[rows] if isinstance(target, str) else target
            gaps.append(table[signal].values[rows] - middle)
        distance[rows] = np.hypot.reduce(gaps, axis=0)
    return distance


def true_flow(shown: Dataset, roles: Roles) -> dict[str, Variable]:
    """Speed and direction of wind and current at the ship, from components north and east."""
    flows = {}
    for what, sense, suffix in [("wind", -1.0, "from"), ("current", 1.0, "to")]:
        # Harbours change wind and current; else those of the environment act on the ship.
        parts = [
            roles.signal(roles.harbour or roles.environment, f"{what}_{way}")
            for way in ("north", "east")
        ]
        if None not in parts:
            # Wind is named by where it comes from, so its components change sign.
            north, east = (sense * shown[part].values for part in parts)
            flows[f"{what} speed"] = as_variable(np.hypot(north, east), "m/s", f"{what} speed")
            angle = np.degrees(unturned(f"{what}_{suffix}", np.arctan2(east, north)))
            flows[f"{what} {suffix}"] = as_variable(angle, "deg", f"{what} {suffix}")
    return flows
