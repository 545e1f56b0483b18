"""The track of a run as a picture: reference, way of the ship, where she was expected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from xarray import Dataset

from shipcosim.report.notebook.figures import Circle, Path, track_svg
from shipcosim.report.run.roles import find_roles
from shipcosim.report.run.track import ship_size
from shipcosim.report.theme import palette
from shipcosim.scenario import Verdict


def run_track(table: Dataset, verdicts: Sequence[Verdict], name: str) -> str | None:
    """Track of a run as SVG; None without a ship in the table.

    Parameters
    ----------
    table : xarray.Dataset
        A run. [SI]
    verdicts : sequence of Verdict
        Expectations on x and y together are drawn as circles.
    name : str
        What is drawn.
    """
    roles = find_roles(table.data_vars)
    pose = [
        signal
        for signal in (roles.signal(roles.ship, axis) for axis in ("x", "y", "psi"))
        if signal
    ]
    if len(pose) < 3 or not np.isfinite(table[pose[0]].values + table[pose[1]].values).any():
        return None
    paths = []
    wanted = [
        signal
        for signal in (roles.signal(roles.reference, axis) for axis in ("x_d", "y_d"))
        if signal
    ]
    if len(wanted) == 2:
        east = table[wanted[1]].values
        north = table[wanted[0]].values
        paths.append(Path("reference", north, east, colour=palette.REFERENCE, style="--"))
    psi = np.degrees(table[pose[2]].values)
    paths.append(
        Path(
            f"{roles.ship or 'ship'}, start dashed, end filled",
            table[pose[0]].values,
            table[pose[1]].values,
            psi,
        )
    )
    return track_svg(paths, name, ship_size(table, roles), _circles(verdicts, pose[:2]))


def _circles(verdicts: Sequence[Verdict], position: list[str]) -> list[Circle]:
    """Where expectations on the position want the ship; a place asked for twice is held if it is each time."""
    held: dict[tuple[float, float, float], bool] = {}
    for verdict in verdicts:
        near = verdict.expect.near
        within = verdict.expect.within
        if verdict.expect.signal != position or near is None or within is None:
            continue
        numbers = [value for value in near if not isinstance(value, str)]
        if len(numbers) == 2:
            place = (numbers[0], numbers[1], within)
            held[place] = held.get(place, True) and verdict.passed
    return [Circle(*place, passed) for place, passed in held.items()]
