"""The hybrid predictor of paper IV: networks correct the model's accelerations, second by second.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper IV and ch. 4.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.predictor_inputs import Known, air_velocity
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

WINDOW = 3
"""Samples over which heading and velocities are averaged, one a second. [1]"""
PERIOD = 1.0
"""Time between samples, and between steps of a prediction. [s]"""


class Ensemble(NamedTuple):
    """Networks of one form, beside one another along the first axis of their weights.

    Parameters
    ----------
    layers : tuple of (weights, bias)
        (m, inputs, outputs) and (m, 1, outputs) arrays; hyperbolic tangents between them. [1]
    input_mean, input_std, output_mean, output_std : (9,) and (3,) arrays
        Scales. [m/s, m/s, rad/s, m/s2, m/s2, rad/s2, m/s2, m/s2, rad/s2; the last three]
    """

    layers: tuple
    input_mean: np.ndarray
    input_std: np.ndarray
    output_mean: np.ndarray
    output_std: np.ndarray


class Past(NamedTuple):
    """Memory of the predictor.

    Parameters
    ----------
    states : tuple of (psi, u, v, r)
        Of the last `WINDOW` samples, the newest last; headings are not wrapped. [rad, m/s, m/s, rad/s]
    wind : tuple of two floats
        Velocity of the air at the last sample, north and east. [m/s]
    thrusters : tuple of three floats
        Load of the thrusters at the last sample. [N, N, N.m]
    residual : tuple of three floats
        What the equations of motion missed in the last second. [m/s2, m/s2, rad/s2]
    """

    states: tuple
    wind: tuple
    thrusters: tuple
    residual: tuple


def ensemble_of(arrays: Mapping[str, np.ndarray]) -> Ensemble:
    """The networks from their arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``1.weights``, ``1.bias`` and so on, and the scales by their names. [1]

    Returns
    -------
    Ensemble
        [1]
    """
    count = sum(name.endswith(".weights") for name in arrays)
    layers = tuple((arrays[f"{k}.weights"], arrays[f"{k}.bias"]) for k in range(1, count + 1))
    return Ensemble(layers, *(arrays[name] for name in Ensemble._fields[1:]))


def outputs(ensemble: Ensemble, inputs: np.ndarray) -> np.ndarray:
    """Residual accelerations by each network.

    Parameters
    ----------
    ensemble : Ensemble
        The networks.
    inputs : (n, 9) array
        Velocities, accelerations of the equations of motion, last residual. [m/s, rad/s, m/s2, rad/s2]

    Returns
    -------
    (m, n, 3) array
        [m/s2, m/s2, rad/s2]
    """
    # Standardised inputs, tanh layers, and a linear last layer with its scale.
    values = (inputs - ensemble.input_mean) / ensemble.input_std
    for weights, bias in ensemble.layers[:-1]:
        values = np.tanh(values @ weights + bias)
    weights, bias = ensemble.layers[-1]
    return (values @ weights + bias) * ensemble.output_std + ensemble.output_mean


def model_acceleration(
    psi: Arithmetic,
    nu: tuple,
    air: tuple,
    thrusters: tuple,
    *,
    hull: HullParameters,
    wind: WindParameters,
) -> Load:
    """Acceleration over ground by the equations of motion, without a current.

    Parameters
    ----------
    psi : float or (...) array
        Heading. [rad]
    nu : tuple of three, like psi
        Velocities u, v, r. [m/s, m/s, rad/s]
    air : tuple of two, like psi
        Velocity of the air, north and east. [m/s]
    thrusters : tuple of three, like psi
        Load of the thrusters. [N, N, N.m]
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    tuple of three, like psi
        [m/s2, m/s2, rad/s2]
    """
    # Wind load at the present apparent wind, then M ν̇ = τ - C ν - D ν, without a current.
    load = wind_loads(*apparent_wind(psi, nu[0], nu[1], *air), wind=wind)
    return accelerations(*nu, *(a + b for a, b in zip(thrusters, load, strict=True)), hull=hull)


def begin(known: Known) -> Past:
    """The memory at the start.

    Parameters
    ----------
    known : Known
        Inputs of the predictor now, in floats.

    Returns
    -------
    Past
        As if she had been so before, without residual.
    """
    state = (known.ship.psi, known.ship.u, known.ship.v, known.ship.r)
    return Past((state,) * WINDOW, air_velocity(known), tuple(known.thrusters), (0.0, 0.0, 0.0))


def step(past: Past, known: Known, *, hull: HullParameters, wind: WindParameters) -> Past:
    """The memory a second later.

    Parameters
    ----------
    past : Past
        Of the last sample.
    known : Known
        Inputs of the predictor now, floats or (...) arrays.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    Past
        With this sample.
    """
    # What the model expected for the last second, against what happened: the residual is an input
    # of the networks.
    psi, *nu = past.states[-1]
    expected = model_acceleration(psi, tuple(nu), past.wind, past.thrusters, hull=hull, wind=wind)
    now = known.ship.u, known.ship.v, known.ship.r
    residual = tuple((b - a) / PERIOD - dot for a, b, dot in zip(nu, now, expected, strict=True))
    # Unwrap the heading: add the turn along the shorter arc.
    turned = known.ship.psi - psi
    state = (psi + np.arctan2(np.sin(turned), np.cos(turned)), *now)
    return Past((*past.states[1:], state), air_velocity(known), tuple(known.thrusters), residual)


def predict(
    past: Past,
    known: Known,
    ensemble: Ensemble,
    *,
    seconds: int,
    hull: HullParameters,
    wind: WindParameters,
) -> list[Motion]:
    """Motion of each second ahead.

    Parameters
    ----------
    past : Past
        With the sample of now; floats or (n,) arrays.
    known : Known
        Inputs of the predictor now.
    ensemble : Ensemble
        The networks.
    seconds : int
        How far ahead. [s]
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    list of Motion
        One a second.

    Notes
    -----
    Explicit steps of a second, the place by the mean of the velocities before and after; the residual is the mean of
    the networks. Wind and thrust are held.
    """
    # Start from averages over the last seconds, which removes noise and waves.
    psi, *nu = (sum(rate) / WINDOW for rate in zip(*past.states, strict=True))
    x = known.ship.x
    y = known.ship.y
    residual = past.residual
    motions = []
    for _ in range(seconds):
        # Acceleration by the model, then the correction by the mean of the networks. It is the next
        # input: the networks feed back on themselves.
        dot = model_acceleration(psi, tuple(nu), past.wind, past.thrusters, hull=hull, wind=wind)
        inputs = np.array([*nu, *dot, *residual]).T
        mean = outputs(ensemble, np.atleast_2d(inputs)).mean(axis=0)
        residual = mean[0].tolist() if inputs.ndim == 1 else mean.T
        # Explicit Euler for velocities; the position uses their mean.
        then = [
            value + PERIOD * (rate + missed)
            for value, rate, missed in zip(nu, dot, residual, strict=True)
        ]
        u, v, r = (0.5 * (a + b) for a, b in zip(nu, then, strict=True))
        north, east = to_ned(psi + 0.5 * PERIOD * r, u, v)
        x = x + PERIOD * north
        y = y + PERIOD * east
        psi = psi + PERIOD * r
        nu = then
        motions.append(Motion(x, y, psi, *nu))
    return motions
