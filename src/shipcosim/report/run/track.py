"""The outline of a ship, and where on her track to draw it."""

import numpy as np
from numpy.typing import NDArray

from shipcosim.report.run.vessels import Pair

HULL = (  # outline over length and breadth from amidships, starboard side from stern to bow; drawn, not measured
    (-0.5, 0.44),
    (-0.46, 0.5),
    (0.18, 0.5),
    (0.34, 0.37),
    (0.45, 0.17),
    (0.5, 0.0),
)
SPACING = 0.3  # outlines: apart in lengths, turned in deg, at most so many
TURN = 20.0
MOST = 40
SYMBOL = 0.08  # length of the outline of a ship of unknown size, over the extent of the track
SLENDERNESS = 3.5  # length over breadth of that outline


def hull_outline(length: float, breadth: float) -> tuple[NDArray, NDArray]:
    """Closed outline in body axes: forward and to starboard, (11,) each. [m, m]

    Examples
    --------
    >>> forward, starboard = hull_outline(10.0, 4.0)
    >>> float(forward.max()), float(starboard.min()), float(starboard.max())
    (5.0, -2.0, 2.0)
    """
    # Mirror the starboard side, without repeating the bow, and close the outline.
    starboard = np.array(HULL) * [length, breadth]
    port = starboard[-2::-1] * [1.0, -1.0]
    closed = np.vstack([starboard, port, starboard[:1]])
    return closed[:, 0], closed[:, 1]


def placed(
    outline: tuple[NDArray, NDArray], x: float, y: float, psi: float
) -> tuple[NDArray, NDArray]:
    """An outline on the chart: east and north of its corners. [m, m]"""
    # Rotate by the heading: north = x + c forward - s
    # starboard, east = y + s forward + c starboard.
    forward, starboard = outline
    c = np.cos(np.radians(psi))
    s = np.sin(np.radians(psi))
    return y + s * forward + c * starboard, x + c * forward - s * starboard


def outline_rows(x: NDArray, y: NDArray, psi: NDArray, length: float) -> list[int]:
    """Rows at which to draw the ship: first, last, and after enough motion or turning.

    Parameters
    ----------
    x, y, psi : (n,) array
        Pose. [m, m, deg]
    length : float
        Length of the ship. [m]

    Returns
    -------
    list of int
    """
    # Widen the spacing until the number of outlines is small enough to see the track.
    spacing = SPACING * length
    turn = TURN
    while True:
        rows = [0]
        for k in range(1, len(x)):
            last = rows[-1]
            if (
                np.hypot(x[k] - x[last], y[k] - y[last]) >= spacing
                or abs(psi[k] - psi[last]) >= turn
            ):
                rows.append(k)
        if len(rows) <= MOST:
            return rows if rows[-1] == len(x) - 1 else [*rows, len(x) - 1]
        spacing = 1.5 * spacing
        turn = 1.5 * turn


def symbol_size(x: NDArray, y: NDArray) -> Pair:
    """Size of an outline for a vessel of unknown size. [m, m]"""
    length = max(SYMBOL * max(float(np.ptp(x)), float(np.ptp(y))), 1.0)
    return length, length / SLENDERNESS
