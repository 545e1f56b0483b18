"""Sensors: true values with Gauss-Markov error, white noise and bias, sampled at a period of their own.

Sample k is taken at the first step that starts at k * period or later, of the truth at that time, with random numbers
that depend on the seed and k alone. So a finer step gives the same measurements.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper II, Table I,
read as the nominal model says under sensors.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, atan2, cos, exp, hypot, sin, sqrt
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.core.sampling import normals, samples_due

_PAPER = "thesis paper II, Table I"
_COURSE = "parameter sheet 7 (TMR4240), grade B"


@dataclass(frozen=True, kw_only=True)
class SensorParameters:
    """Errors of position and heading reference, velocity sensors and anemometer."""

    period: float = required("s", "sample period", minimum=1e-3)
    position_drift_std: float = required(
        "m", "stationary standard deviation of the Gauss-Markov error, north and east each", minimum=0.0
    )
    position_drift_time: float = required("s", "its correlation time", minimum=1e-3)
    position_noise_std: float = required("m", "white noise of north and east each", minimum=0.0)
    heading_drift_std: float = required(
        "rad", "stationary standard deviation of the Gauss-Markov error of the heading", minimum=0.0
    )
    heading_drift_time: float = required("s", "its correlation time", minimum=1e-3)
    heading_noise_std: float = required("rad", "white noise of the heading", minimum=0.0)
    velocity_noise_std: float = required("m/s", "white noise of surge and sway each", minimum=0.0)
    yaw_rate_noise_std: float = required("rad/s", "white noise of the yaw rate", minimum=0.0)
    x_bias: float = quantity(0.0, "m", "bias of the north position", _PAPER + ": within 0.2 m; 0 in our scenarios")
    y_bias: float = quantity(0.0, "m", "bias of the east position", _PAPER + ": within 0.2 m; 0 in our scenarios")
    psi_bias: float = quantity(0.0, "rad", "bias of the heading", _PAPER + ": within 0.1 deg; 0 in our scenarios")
    wind_average_time: float = required("s", "span of the mean that the anemometer gives", minimum=0.0)
    wind_speed_noise: float = required("1", "white noise of the wind speed, over the wind speed", minimum=0.0)
    wind_from_noise_std: float = required("rad", "white noise of the wind direction", minimum=0.0)
    seed: int = quantity(1, "1", "seed of all errors", "any", minimum=0)


class Truth(NamedTuple):
    """What is measured: motion, low-frequency and wave motion added, and apparent wind; true or as measured.

    Parameters
    ----------
    x, y, psi : float or (m,) array or tensor
        Position and heading. [m, m, rad]
    u, v, r : like x
        Velocity over ground in body axes. [m/s, m/s, rad/s]
    apparent_wind_speed, apparent_wind_from : like x
        Wind relative to the ship, from the bow. [m/s, rad]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    u: Arithmetic
    v: Arithmetic
    r: Arithmetic
    apparent_wind_speed: Arithmetic
    apparent_wind_from: Arithmetic


class SensorState(NamedTuple):
    """State of the sensors between samples.

    Parameters
    ----------
    taken : int
        Samples taken so far, counted from t = 0. [1]
    drift : tuple of three
        Gauss-Markov errors of x, y, psi. [m, m, rad]
    wind : tuple of pairs
        Latest samples of the wind's components from ahead and from starboard. [m/s, m/s]
    measured : Truth
        Last sample, which holds until the next.
    """

    taken: int
    drift: tuple
    wind: tuple
    measured: Truth


def start(t: float, truth: Truth, *, parameters: SensorParameters) -> SensorState:
    """First sample, with the Gauss-Markov errors drawn from their stationary distribution.

    Parameters
    ----------
    t : float
        Time of the start. [s]
    truth : Truth
        True values at t.
    parameters : SensorParameters
        Errors and sample period.

    Returns
    -------
    SensorState
        State after the first sample.
    """
    k = samples_due(t, parameters.period) - 1
    numbers = normals("sensors", parameters.seed, k, 11)
    stds = parameters.position_drift_std, parameters.position_drift_std, parameters.heading_drift_std
    drift = tuple(std * number for std, number in zip(stds, numbers[:3], strict=True))
    return _sampled(k, drift, (), numbers, truth, parameters)


def step(t: float, state: SensorState, truth: Truth, *, parameters: SensorParameters) -> SensorState:
    """State after all samples that are due by t.

    Parameters
    ----------
    t : float
        Time at the start of a step. [s]
    state : SensorState
        State after the samples before.
    truth : Truth
        True values at t.
    parameters : SensorParameters
        Errors and sample period.

    Returns
    -------
    SensorState
        State after the samples.
    """
    due = samples_due(t, parameters.period)
    while state.taken < due:
        numbers = normals("sensors", parameters.seed, state.taken, 11)
        drift = _wandered(state.drift, numbers, parameters)
        state = _sampled(state.taken, drift, state.wind, numbers, truth, parameters)
    return state


def _wandered(drift, numbers, parameters):
    """Gauss-Markov errors one period later, exactly: b <- phi b + sigma sqrt(1 - phi^2) w, phi = exp(-period/T)."""
    position = exp(-parameters.period / parameters.position_drift_time)
    heading = exp(-parameters.period / parameters.heading_drift_time)
    position_kick = parameters.position_drift_std * sqrt(1.0 - position * position)
    heading_kick = parameters.heading_drift_std * sqrt(1.0 - heading * heading)
    return (
        position * drift[0] + position_kick * numbers[0],
        position * drift[1] + position_kick * numbers[1],
        heading * drift[2] + heading_kick * numbers[2],
    )


def _sampled(k, drift, wind, numbers, truth, parameters):
    """State after sample k, with its random numbers."""
    p = parameters
    latest = (
        truth.apparent_wind_speed * cos(truth.apparent_wind_from),
        truth.apparent_wind_speed * sin(truth.apparent_wind_from),
    )
    wind = (*wind, latest)[-max(1, round(p.wind_average_time / p.period)) :]
    ahead, starboard = (sum(component) / len(wind) for component in zip(*wind, strict=True))
    measured = Truth(
        truth.x + drift[0] + p.position_noise_std * numbers[3] + p.x_bias,
        truth.y + drift[1] + p.position_noise_std * numbers[4] + p.y_bias,
        wrap(truth.psi + drift[2] + p.heading_noise_std * numbers[5] + p.psi_bias),
        truth.u + p.velocity_noise_std * numbers[6],
        truth.v + p.velocity_noise_std * numbers[7],
        truth.r + p.yaw_rate_noise_std * numbers[8],
        hypot(ahead, starboard) * (1.0 + p.wind_speed_noise * numbers[9]),
        wrap(atan2(starboard, ahead) + p.wind_from_noise_std * numbers[10]),
    )
    return SensorState(k + 1, drift, wind, measured)
