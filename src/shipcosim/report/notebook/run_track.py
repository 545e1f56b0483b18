"""The track of a run as a picture: reference, way of the ship, where she was expected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from xarray import Dataset

from shipcosim.report.notebook.figures import Path, track_svg
from shipcosim.report.run.scene import expected_circles
from shipcosim.report.run.vessels import find_vessels, pose_of
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
    vessel = next(iter(find_vessels(table)), None)
    if vessel is None:
        return None
    north, east, heading = pose_of(table, vessel.pose)
    if not np.isfinite(north + east).any():
        return None
    paths = []
    if reference := vessel.aims.get("reference"):
        x, y = pose_of(table, reference[:2])
        paths.append(Path("reference", x, y, colour=palette.REFERENCE, style="--"))
    paths.append(Path(f"{vessel.name}, end filled", north, east, heading))
    return track_svg(paths, name, vessel.size, expected_circles(verdicts, vessel.pose))
