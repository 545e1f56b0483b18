"""A DP loop for any ship: the tuned loop, scaled with her size and limited by her thrust.

Froude scaling: all natural frequencies go with 1 over the root of the length. With
s = sqrt(33.9 m/L) the tuned loop of docs/dp-loop.md has s times its frequencies, and its time
constants over s. It is slower where a metre of error would ask for more than a fifth of the weakest
thrust. The observer's bandwidth follows: velocity disturbances grow with s^4, bias drift with s^6.
Noise, rates and latencies of sensors are the usual ones for any ship. s is at most 1.5: beyond it
the sensors leave no margin.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from shipcosim.ships.attainable import largest_multiple
from shipcosim.ships.estimates.estimate import EstimatedNumber

TUNED_LENGTH = 33.9
MOST_PACE = 1.5
SHARE = 0.2
TUNED = {"position": 0.0684, "heading": 0.101, "reference": pi / 60.0}  # rad/s
RULE = "rule of docs/your-own-ship.md"
DAMPING = 0.15
"""Damping that the controller assumes over mass and natural frequency. [1]"""
SENSORS = {
    "period": 0.1,
    "heading_latency": 0.1,
    "position_period": 0.2,
    "position_latency": 0.3,
    "wind_period": 1.0,
    "wind_latency": 0.5,
    "position_drift_std": 0.1,
    "position_drift_time": 240.0,
    "position_noise_std": 0.2,
    "velocity_noise_std": 0.02,
    "heading_drift_std": 0.1 * pi / 180.0,
    "heading_drift_time": 60.0,
    "heading_noise_std": 0.1 * pi / 180.0,
    "yaw_rate_noise_std": 0.05 * pi / 180.0,
    "wind_average_time": 3.0,
    "wind_speed_noise": 0.02,
    "wind_from_noise_std": pi / 180.0,
}
"""Usual DP sensors: Skulstad 2021, paper II, Table I, and message rates; assumed."""
OBSERVER = {
    "sample_period": 0.1,
    "position_period": 0.2,
    "heading_period": 0.1,
    "position_delay": 0.4,
    "heading_delay": 0.2,
    "position_noise": 0.12,
    "heading_noise": 0.1 * pi / 180.0,
    "velocity_noise": 0.012,
    "rate_noise": 0.05 * pi / 180.0,
    "wave_frequency": 1.1,
    "wave_frequency_min": 0.4,
    "wave_frequency_max": 2.0,
    "wave_peak_ratio": 0.96,
    "full_frequency": 1.1,
    "wave_time": 200.0,
    "wave_damping": 0.08,
    "wave_motion": 0.035,
    "wave_yaw": 0.00239,
}
"""Numbers of the tuned loop, docs/dp-loop.md."""
DISTURBANCES = {
    "velocity_disturbance": (5.54e-5, 4),
    "rate_disturbance": (2.34e-7, 4),
    "bias_drift": (1.93e-7, 6),
    "bias_drift_yaw": (3.98e-10, 6),
}
"""Intensity in the tuned loop, and the power of the pace with which it grows."""
FILTERS = {"wind_filter_time": 0.7, "force_filter_time": 1.19, "moment_filter_time": 1.23}


@dataclass(frozen=True, kw_only=True)
class ControlledShip:
    """Numbers of a ship that the rule needs.

    Attributes
    ----------
    length : float
        [m]
    mass : (3, 3) array
        With added mass. [kg, kg.m, kg.m2]
    reach : tuple of three floats
        Largest surge and sway force and yaw moment to either side that the thrusters give alone. [N, N, N.m]
    """

    length: float
    mass: np.ndarray
    reach: tuple[float, float, float]


def reach_of(
    effects: np.ndarray, least: np.ndarray, most: np.ndarray
) -> tuple[float, float, float]:
    """Largest surge and sway force and yaw moment, each alone and to the weaker side.

    Parameters
    ----------
    effects : (3, n) array
        Load of one newton of each thruster. [1, 1, m]
    least, most : (n,) array
        Limits of their thrust. [N]

    Returns
    -------
    tuple of three floats
        0 where the thrusters cannot give it without the others. [N, N, N.m]
    """
    # Scale forces and moment to one size, as the geometry needs it.
    force, moment = (max(float(np.abs(rows).max()), 1e-9) for rows in (effects[:2], effects[2]))
    scale = np.array([force, force, moment])
    # Each thruster gives the loads between its limits, along one line.
    sets = [
        np.outer((low, high), effect) / scale
        for low, high, effect in zip(least, most, effects.T, strict=True)
    ]
    # Reach in both directions of each axis; the weaker side counts.
    both = np.concatenate([np.eye(3), -np.eye(3)])
    multiples = largest_multiple(sets, np.ones((6, len(sets))), both / scale)
    X, Y, N = np.minimum(multiples[:3], multiples[3:]).tolist()
    return X, Y, N


def pace_of(loop: ControlledShip) -> tuple[float, float]:
    """Frequencies of position and heading over those of the tuned loop.

    Parameters
    ----------
    loop : ControlledShip
        The ship.

    Returns
    -------
    tuple of two floats
        [1, 1]
    """
    # Froude: frequencies go with the inverse root of the length.
    by_size = min(sqrt(TUNED_LENGTH / loop.length), MOST_PACE)
    # The heaviest axis and the weakest force: omega^2 m 1 m may ask for a fifth of the force.
    mass = max(loop.mass[0, 0], loop.mass[1, 1])
    force = min(loop.reach[:2])
    by_thrust = sqrt(SHARE * force / mass) / TUNED["position"]
    # The same in yaw for an error of 5 deg.
    turn = sqrt(SHARE * loop.reach[2] / (loop.mass[2, 2] * 5.0 * pi / 180.0)) / TUNED["heading"]
    # The slower of both rules decides.
    return min(by_size, by_thrust), min(by_size, turn)


def controller(loop: ControlledShip) -> dict[str, EstimatedNumber]:
    """Model, observer and law of the DP controller.

    Parameters
    ----------
    loop : ControlledShip
        The ship.

    Returns
    -------
    dict of str to Estimate
        Parameters of the controller, without its wind table and mast.
    """
    # Natural frequencies of the loop, and the error at which SHARE of the thrust is used.
    position, heading = pace_of(loop)
    m = loop.mass
    stiff = TUNED["position"] * position, TUNED["heading"] * heading
    error = SHARE * min(loop.reach[:2]) / (max(m[0, 0], m[1, 1]) * stiff[0] ** 2)
    # Model of the controller: mass, linear damping as a share of m omega, critically damped law.
    values = {
        "mass_surge": m[0, 0],
        "mass_sway": m[1, 1],
        "mass_sway_yaw": m[1, 2],
        "mass_yaw": m[2, 2],
        "damping_surge": DAMPING * m[0, 0] * stiff[0],
        "damping_sway": DAMPING * m[1, 1] * stiff[0],
        "damping_yaw": DAMPING * m[2, 2] * stiff[1],
        "surge_frequency": stiff[0],
        "sway_frequency": stiff[0],
        "yaw_frequency": stiff[1],
        "damping_ratio": 1.0,
        "position_error_max": min(max(error, 1.0), max(0.1 * loop.length, 1.0)),
        "heading_error_max": 20.0 * pi / 180.0,
        "wind_share": 1.0,
    }
    # Filters become slower with the loop, never faster.
    values |= {name: time / min(position, heading, 1.0) for name, time in FILTERS.items()}
    # Disturbances scale with the power of the pace that keeps the observer's bandwidth ratio.
    for name, (value, power) in DISTURBANCES.items():
        values[name] = (
            value
            * (heading if name in ("rate_disturbance", "bias_drift_yaw") else position) ** power
        )
    estimates = {name: EstimatedNumber(float(value), 0.0, RULE) for name, value in values.items()}
    return estimates | {
        name: EstimatedNumber(value, 0.0, "docs/dp-loop.md") for name, value in OBSERVER.items()
    }


def reference(loop: ControlledShip) -> dict[str, EstimatedNumber]:
    """How quickly the reference follows its setpoint, and how fast it may be.

    Parameters
    ----------
    loop : ControlledShip
        The ship.

    Returns
    -------
    dict of str to Estimate
        Parameters of the reference model.
    """
    # Largest speed: a share of frequency times length, at least 0.2 m/s.
    position, heading = pace_of(loop)
    speed = 0.3 * position * TUNED["reference"] * loop.length
    return {
        "position_frequency": EstimatedNumber(TUNED["reference"] * position, 0.0, RULE),
        "heading_frequency": EstimatedNumber(TUNED["reference"] * heading, 0.0, RULE),
        "speed_max": EstimatedNumber(max(speed, 0.2), 0.0, RULE),
    }


def sensors(length: float) -> dict[str, EstimatedNumber]:
    """Usual DP sensors, and a mast forward of midships.

    Parameters
    ----------
    length : float
        Of the ship. [m]

    Returns
    -------
    dict of str to Estimate
        Parameters of the sensors.
    """
    estimates = {
        name: EstimatedNumber(value, 0.0, "usual DP sensors; assumed")
        for name, value in SENSORS.items()
    }
    return estimates | mast(length)


def mast(length: float) -> dict[str, EstimatedNumber]:
    """Place of the anemometer.

    Parameters
    ----------
    length : float
        Of the ship. [m]

    Returns
    -------
    dict of str to Estimate
        mast_x, mast_y, mast_height. [m, m, m]
    """
    places = {
        "mast_x": 0.1 * length,
        "mast_y": 0.0,
        "mast_height": min(max(0.45 * length, 3.0), 40.0),
    }
    return {
        name: EstimatedNumber(value, 0.0, "on the wheelhouse; assumed")
        for name, value in places.items()
    }
