"""Thrust that DNV-ST-0111 Level 1 grants a thruster: nominal thrust, and what ventilation and the rest take from it."""

from dataclasses import dataclass
from math import erfc, sqrt

import numpy as np
from numpy.typing import NDArray

from shipcosim.angles import TURN, wrap_series
from shipcosim.capability.conditions import Condition
from shipcosim.capability.particulars import Hull

ETA_1 = {
    "open": 800.0,
    "cycloidal": 900.0,
    "tunnel": 900.0,
    "contra-rotating": 950.0,
    "ducted": 1200.0,
}
ETA_2_INLET = {"broken": 1.0, "rounded": 1.07, "other": 0.93}
ETA_2_ASTERN = {
    ("fixed", False): 0.9,
    ("fixed", True): 0.7,
    ("controllable", False): 0.65,
    ("controllable", True): 0.5,
}
ETA_M = {"geared": 0.93, "cycloidal": 0.91, "shaft": 0.97, "pod": 0.98, "rim-driven": 0.995}
BETA_MISC = 0.9


@dataclass(frozen=True)
class Thruster:
    """A thruster as the balance sees it.

    Attributes
    ----------
    name : str
        Of its component.
    kind : str
        ``"azimuth"``: thrust ahead in any direction; ``"tunnel"`` and ``"fixed"``: ahead and astern along `angle`.
    x, y : float
        Position forward and to starboard of the ship's origin. [m]
    diameter, submergence : float
        Of the propeller; of its shaft below the water. [m]
    power : float
        Largest power of the motor. [W]
    ducted : bool
        Whether the propeller is in a nozzle.
    ahead, astern : float
        Nominal thrust, both positive. [N]
    angle : float
        Where the thrust ahead of one that cannot turn points, clockwise from the bow. [rad]
    """

    name: str
    kind: str
    x: float
    y: float
    diameter: float
    submergence: float
    power: float
    ducted: bool
    ahead: float
    astern: float
    angle: float = 0.0


def nominal_thrust(
    diameter: float, power: float, eta_1: float, eta_2: float, eta_m: float
) -> float:
    """Thrust at the bollard, eta1 eta2 (D P eta_M)^(2/3) with D in m and P in kW.

    Parameters
    ----------
    diameter, power : float
        Of the propeller, of the motor. [m, W]
    eta_1, eta_2, eta_m : float
        Factors by kind of propeller, by direction or inlet, by transmission. [N/(m.kW)^(2/3), 1, 1]

    Returns
    -------
    float
        Thrust. [N]

    Examples
    --------
    A ducted rim drive of 1.9 m and 500 kW:

    >>> round(nominal_thrust(1.9, 500e3, 1200.0, 1.0, 0.995))
    115579
    """
    return eta_1 * eta_2 * (diameter * power / 1000.0 * eta_m) ** (2.0 / 3.0)


def ventilation(
    thruster: Thruster, hull: Hull, condition: Condition, weather_from: NDArray
) -> NDArray:
    """Share of the thrust that a propeller keeps near a moving surface.

    Phi(2 (2 xi / D) - 1.5 sigma), Phi the normal distribution, xi the submergence of the shaft, and sigma a measure of
    the relative motion and of the load on the propeller.

    Parameters
    ----------
    thruster : Thruster
    hull : Hull
    condition : Condition
    weather_from : (n,) array
        Clockwise from the bow. [rad]

    Returns
    -------
    (n,) array
        Between 0 and 1. [1]
    """
    x = thruster.x - hull.midship_x
    # Angle from the bow as a part of half a turn: the same on both sides.
    turned = np.abs(wrap_series(weather_from, TURN)) / np.pi
    # Relative motion: Hs, times factors of direction and of place along the ship, times a period
    # ratio of at most 1.
    period = 0.64 * np.sqrt(hull.length) / condition.zero_crossing_period
    heave = 0.85 * np.where(turned <= 0.5, 1.0 + 0.38 * turned, 1.38 - 0.38 * turned)
    place = 1.0 + 0.4 * min(x, 0.0) / hull.length
    # A heavily loaded propeller draws air earlier: √(T / D³), beyond its limit of 15.2.
    load = np.sqrt(thruster.ahead / thruster.diameter**3) / 15.2
    sigma = 0.25 * (heave * place * condition.wave_height * min(period, 1.0) + max(load - 1.0, 0.0))
    # Phi(depth - 1.5 sigma), with depth = 4 xi / D. The normal distribution is written with erfc.
    depth = 4.0 * thruster.submergence / thruster.diameter
    return np.array([0.5 * erfc((1.5 * spread - depth) / sqrt(2.0)) for spread in sigma])
