"""Zones that thrusters cannot reach or must not enter: beyond a limit, in a forbidden sector."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, degrees, floor

import numpy as np
from xarray import Dataset

from shipcosim.report.run.vessels import Pair
from shipcosim.report.theme.numbers import finite

NEAR = 0.5  # of a limit: a run that stays farther from it is drawn without it, since its curves would be flat lines
BESIDE = 45.0  # deg: this far beyond the angles of the curves sectors are drawn


@dataclass(frozen=True)
class Zone:
    """Values between two numbers of the panel's unit."""

    lower: float
    upper: float


def thrust_zones(
    shown: Dataset, signals: Sequence[str | None], limits: Pair | None
) -> Sequence[Zone]:
    """Zones beyond the limits of a thruster, of those limits that the curves come near.

    Parameters
    ----------
    shown : xarray.Dataset
        The table in the page's units.
    signals : sequence of str
        The curves of the panel.
    limits : (float, float) or None
        Least and largest thrust. [N, N]

    Returns
    -------
    sequence of Zone
    """
    # Limits in the unit of the panel.
    span = _span(shown, signals)
    if limits is None or span is None:
        return ()
    factor = shown[signals[0]].attrs["factor"]
    least, most = (factor * limit for limit in limits)
    margin = 0.05 * (most - least)
    zones = []
    # Draw a limit only if a curve comes near it; else the curves would be flat.
    if span[1] >= NEAR * most > 0.0:
        zones.append(Zone(most, max(most, span[1]) + margin))
    if span[0] <= NEAR * least < 0.0:
        zones.append(Zone(min(least, span[0]) - margin, least))
    return zones


def angle_zones(
    shown: Dataset, signals: Sequence[str | None], sectors: Sequence[Pair]
) -> Sequence[Zone]:
    """Forbidden sectors among the angles that a panel shows, as often as the curves turn round.

    Parameters
    ----------
    shown : xarray.Dataset
        The table in the page's units: angles in deg, without jumps.
    signals : sequence of str
        The curves of the panel.
    sectors : sequence of (float, float)
        From and to. [rad, rad]

    Returns
    -------
    sequence of Zone
    """
    # Angles in the panel run over several turns: repeat each sector on every turn in view.
    span = _span(shown, signals)
    if span is None:
        return ()
    zones = []
    least = span[0] - BESIDE
    most = span[1] + BESIDE
    for start, end in ((degrees(a), degrees(b)) for a, b in sectors):
        turns = [
            360.0 * turn
            for turn in range(ceil((least - end) / 360.0), floor((most - start) / 360.0) + 1)
        ]
        zones += [Zone(max(start + turn, least), min(end + turn, most)) for turn in turns]
    return zones


def _span(shown: Dataset, signals: Sequence[str | None]) -> Pair | None:
    """Least and largest value of the curves."""
    values = np.concatenate([shown[name].values for name in signals if name in shown] or [[]])
    numbers = finite(values)
    return (float(numbers.min()), float(numbers.max())) if len(numbers) else None
