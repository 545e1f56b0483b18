"""The weather of a run: mean size and direction of wind, current and waves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from xarray import Dataset

from shipcosim.report.run.roles import Roles


@dataclass(frozen=True)
class Flow:
    """Wind, current or waves.

    Attributes
    ----------
    what : str
        "wind", "current" or "waves".
    size, unit : str
        Mean size, or least and largest.
    degrees : float
        Mean direction, clockwise from north. [deg]
    sense : str
        Whether it comes "from" there or goes "to" there.
    """

    what: str
    size: str
    unit: str
    degrees: float
    sense: str

    @property
    def arrow(self) -> float:
        """Angle by which an arrow to the south is turned clockwise to lie along the flow. [deg]"""
        return self.degrees if self.sense == "from" else self.degrees + 180.0


def weather(shown: Dataset, roles: Roles) -> Sequence[Flow]:
    """Wind, current and waves of the run, where there are any."""
    flows = []
    for what, sense in [("wind", "from"), ("current", "to")]:
        if f"{what} speed" in shown:
            # The mean of the environment is shown where the ship
            # has the same wind; a harbour changes it.
            means = [
                roles.signal(roles.environment, f"{what}_{part}_mean") for part in ("speed", sense)
            ]
            is_constant = roles.harbour is None and None not in means
            size, angle = means if is_constant else (f"{what} speed", f"{what} {sense}")
            flows.append((what, size, "m/s", angle, sense))
    # Waves need height and direction.
    height, source = (
        roles.signal(roles.environment, f"wave_{part}") for part in ("height", "from")
    )
    if height in shown and source in shown:
        flows.append(("waves", height, "m", source, "from"))
    shown_flows = []
    for what, size, unit, angle, sense in flows:
        # A flow that is zero all along is not shown.
        values = shown[size].values
        if np.nanmax(values) > 0.0:
            # A value, or from least to largest where it changes.
            least, largest = (f"{pick(values):.2g}" for pick in (np.nanmin, np.nanmax))
            text = least if least == largest else f"{least}–{largest}"
            # Mean of unit vectors: a plain mean fails across north.
            way = np.radians(shown[angle].values)
            mean = np.degrees(np.arctan2(np.nanmean(np.sin(way)), np.nanmean(np.cos(way))))
            shown_flows.append(Flow(what, text, unit, float(mean % 360.0), sense))
    return shown_flows
