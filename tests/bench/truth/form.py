"""Ships of another form than the model's: how drag, wind, damping, memory and thrust of one drawn ship differ.

Each is drawn at a few places and interpolated in between, so that no diagnosis wins by sharing its shape.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

ALONG = np.linspace(-1.0, 1.0, 5)  # places along the hull, over half its length
ROUND = np.arange(0.0, 361.0, 45.0)  # places round the ship [deg]
DRAG_ALONG = 0.30
WIND_ROUND = 0.15
EXPONENT = 0.15  # of the resistance, and of the cross flow
DAMPING = 0.4  # of the quadratic one at the speeds below
SPEEDS = (1.0, 0.3, 0.02)  # m/s, m/s, rad/s
MEMORY = 0.25  # of the added mass
MEMORY_TIMES = (3.0, 12.0)  # s
ROLLS = (0.6, 1.4)
TUNNEL_FADING = 0.4  # s/m
HULL_LOSS = 0.10  # of a unit's thrust, in any direction but ahead


@dataclass(frozen=True)
class Form:
    """How one ship differs; `mean` is that of the model.

    Attributes
    ----------
    strips : callable
        Factor on the drag of a strip, by its place over half the length. [1]
    wind : (3, 37) array
        Factors on surge, sway and yaw of the wind load, every 10 deg round the circle. [1]
    drag_power : float
        Of the speed. [1]
    damping : (3,) array
        Linear damping over the quadratic one at SPEEDS. [1]
    memory, memory_time : (3,) array
        Force that remembers: share of the added mass [1], and for how long [s].
    rolls : float
        Factor on how lively the ship rolls, 0 for one that does not. [1]
    tunnel_fading : float
        [s/m]
    cross_flow_power : float
        Of the speed of the flow across a strip. [1]
    hull_loss : (2, 37) array
        Share of each unit's thrust that the hull takes, by its direction every 10 deg round the circle. [1]
    """

    strips: object
    wind: np.ndarray
    drag_power: float
    damping: np.ndarray
    memory: np.ndarray
    memory_time: np.ndarray
    rolls: float
    tunnel_fading: float
    cross_flow_power: float
    hull_loss: np.ndarray


def draw_form(rng, size=1.0):
    """A form within `size` times what the constants above say, uniformly."""

    def within(most, shape=()):
        return size * most * rng.uniform(-1.0, 1.0, shape)

    factors, round_ship = (
        1.0 + within(DRAG_ALONG, ALONG.size),
        1.0 + within(WIND_ROUND, (3, ROUND.size)),
    )
    round_ship[:, -1] = round_ship[:, 0]
    grid = np.arange(0.0, 361.0, 10.0)

    def round_the_circle(rows):
        return np.array([CubicSpline(ROUND, row, bc_type="periodic")(grid) for row in rows])

    return Form(
        strips=CubicSpline(ALONG, factors),
        wind=round_the_circle(round_ship),
        drag_power=2.0 + within(EXPONENT),
        damping=size * DAMPING * rng.uniform(0.0, 1.0, 3),
        memory=size * MEMORY * rng.uniform(0.0, 1.0, 3),
        memory_time=rng.uniform(*MEMORY_TIMES, 3),
        rolls=rng.uniform(*ROLLS) if size else 0.0,
        tunnel_fading=size * TUNNEL_FADING * rng.uniform(),
        cross_flow_power=2.0 + within(EXPONENT),
        hull_loss=round_the_circle(
            size * HULL_LOSS * rng.uniform(0.0, 1.0, (2, ROUND.size)) * (ROUND % 360.0 > 0.0)
        ),
    )
