"""What the sections of the validation share: tables of text, pictures, and the ship under way."""

from math import hypot
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt

from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_loads, azimuth_replay
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters
from shipcosim.ships import read_ship

SHIPS = Path(__file__).resolve().parents[3] / "ssp" / "ships"
PICTURES = Path(__file__).resolve().parents[2] / "generated" / "pictures"
KNOT = 1852.0 / 3600.0
MODEL, REFERENCE, THIRD = "#1f5fa8", "#c8501e", "#5a8f3c"

plt.rcParams.update(
    {
        "svg.hashsalt": "shipcosim",
        "svg.fonttype": "none",
        "font.family": "sans-serif",
        "font.sans-serif": ["Helvetica", "Arial", "DejaVu Sans"],
        "font.size": 9,
        "axes.grid": True,
        "grid.linewidth": 0.4,
        "grid.color": "#dddddd",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "lines.linewidth": 1.2,
        "legend.frameon": False,
        "legend.fontsize": 8,
        "path.simplify_threshold": 0.5,
    }
)


def from_generated(text):
    """A template with its links as they are from docs/generated."""
    return text.replace("](../../generated/", "](").replace("](../../", "](../")


def parameters(kind, ship, component):
    """Parameters of a ship's component, as the class of parameters `kind`."""
    return read_ship(SHIPS / ship).parameters(kind, component)


def units(ship):
    """Port and starboard azimuth of a ship. Returns a list of two AzimuthParameters."""
    return [parameters(AzimuthParameters, ship, side) for side in ("port", "starboard")]


def hull_of(ship):
    """Hull of a ship, as HullParameters."""
    return parameters(HullParameters, ship, "vessel")


def thrust_loads(state, n, azimuth, azimuths):
    """Load of both azimuths at the same shaft speed and angle on a ship in still water.

    Parameters
    ----------
    state : motion.Motion
        The ship.
    n, azimuth : float or (m,) array
        Shaft speed and direction of thrust. [rev/s, rad]
    azimuths : list of AzimuthParameters

    Returns
    -------
    list of three
        X, Y, N. [N, N, N.m]
    """
    flow = state.u, state.v, state.r
    loads = [
        azimuth_loads(azimuth_replay(n, azimuth, *flow, unit=unit), *flow, unit=unit)[2:]
        for unit in azimuths
    ]
    return [port + starboard for port, starboard in zip(*loads, strict=True)]


def settle(state, rpm, azimuth, hull, azimuths, *, time=400.0, h=0.1):
    """A ship in still water after a while at fixed shaft speed and angle.

    Parameters
    ----------
    state : motion.Motion
        Start; floats or (m,) arrays.
    rpm, azimuth : like the state
        Both units. [rpm, rad]
    hull : HullParameters
    azimuths : list of AzimuthParameters
    time, h : float
        How long, and in which steps. [s]

    Returns
    -------
    motion.Motion
    """
    for _ in range(round(time / h)):
        load = thrust_loads(state, rpm / 60.0, azimuth, azimuths)
        state = vessel.step(state, *load, 0.0, 0.0, h, hull=hull)
    return state


def speed_of(state):
    """Speed through the water, of a scalar state. [m/s]"""
    return hypot(state.u, state.v)


def table(header, rows):
    """A table in Markdown; the first column to the left, the others to the right.

    Examples
    --------
    >>> print(table(["a", "b"], [["x", "1"]]))
    | a | b |
    |:--|--:|
    | x | 1 |
    """
    lines = [header, [":--"] + ["--:"] * (len(header) - 1), *rows]
    return "\n".join(
        "|" + "|".join(str(c) if i == 1 else f" {c} " for c in line) + "|"
        for i, line in enumerate(lines)
    )


def save(figure, name):
    """Keep a figure as pictures/NAME.svg, the same bytes for the same figure."""
    PICTURES.mkdir(exist_ok=True)
    figure.tight_layout()
    figure.savefig(PICTURES / f"{name}.svg", metadata={"Date": None, "Creator": None})
    plt.close(figure)
