"""Dead reckoning of paper II: networks give surge and sway velocity from wind and thrusters.

Position is that of GNSS while it works; while it is lost the networks' velocities are added up. They see the last ten
seconds of their inputs, and neither position nor velocity.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper II: "Dead
Reckoning of Dynamically Positioned Ships: Using an Efficient Recurrent Neural Network".
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.networks import Layer, Network, dense, empty_memory, evaluate, network_of
from shipcosim.models.prediction.outage import Measured

HISTORY = 10
"""Samples that a network sees, one a second. [1] Paper II, III-B."""
FEATURES = (
    "heading",
    "wind angle",
    "wind speed",
    "bow power",
    "bow action",
    "stern power",
    "stern action",
    "main power",
    "main action",
)
"""Inputs that paper II considers, Table III, except for the commands, of which it keeps none."""
UNITS = (0, 2, 4)
"""Foremost bow tunnel, foremost stern tunnel and port propeller: the paper takes one of each pair."""


class Regressor(NamedTuple):
    """A network of one velocity.

    Parameters
    ----------
    inputs : (n,) array of int
        Which of `FEATURES` it sees. [1]
    mean, std : (n,) array
        By which these are standardised. [units of the features]
    network : Network or tuple of two Layer
        LSTM over the samples, or a hidden layer of sigmoids over all of them and an output. [1]
    velocity_mean, velocity_std : float
        Of the velocity. [m/s]
    """

    inputs: np.ndarray
    mean: np.ndarray
    std: np.ndarray
    network: Network | tuple[Layer, Layer]
    velocity_mean: float
    velocity_std: float


class VelocityNetworks(NamedTuple):
    """Both networks, and the data that turn commands into power.

    Parameters
    ----------
    surge, sway : Regressor
        The networks. [m/s]
    full_power, full_command : (3,) array
        Power at full command of bow tunnel, stern tunnel and main propeller. [W, units of the maps]
    """

    surge: Regressor
    sway: Regressor
    full_power: np.ndarray
    full_command: np.ndarray


class State(NamedTuple):
    """State of the reckoning.

    Parameters
    ----------
    x, y : float or (...) array
        Position. [m]
    u, v : like x
        Velocity over ground in body axes. [m/s]
    sea : like x
        0: it knows nothing of the sea. [m2/s2]
    lost_for : like x
        Time since GNSS was lost; 0 while it works. [s]
    history : (..., HISTORY, features) array
        Latest samples of `FEATURES`, the newest last. [as `features`]
    """

    x: Arithmetic
    y: Arithmetic
    u: Arithmetic
    v: Arithmetic
    sea: Arithmetic
    lost_for: Arithmetic
    history: np.ndarray


def design(arrays: Mapping[str, np.ndarray]) -> VelocityNetworks:
    """The networks from trained arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``full_power``, ``full_command``, and of ``surge`` and ``sway`` each the fields of `Regressor` and the weights.
        [as Design]

    Returns
    -------
    VelocityNetworks
        [as its fields]

    Raises
    ------
    KeyError
        An array is missing.
    """
    return VelocityNetworks(
        surge=_regressor(arrays, "surge"),
        sway=_regressor(arrays, "sway"),
        full_power=arrays["full_power"],
        full_command=arrays["full_command"],
    )


def _regressor(arrays, axis):
    network: Network | tuple[Layer, Layer]
    # Two forms of paper II: an LSTM, or a feed-forward network over the whole history.
    if f"{axis}.hidden.weights" in arrays:
        first, last = (
            Layer(arrays[f"{axis}.{name}.weights"], arrays[f"{axis}.{name}.bias"])
            for name in ("hidden", "dense")
        )
        network = first, last
    else:
        network = network_of(arrays, axis)
    return Regressor(
        inputs=arrays[f"{axis}.inputs"].astype(int),
        mean=arrays[f"{axis}.mean"],
        std=arrays[f"{axis}.std"],
        network=network,
        velocity_mean=float(arrays[f"{axis}.velocity_mean"]),
        velocity_std=float(arrays[f"{axis}.velocity_std"]),
    )


# Power as an input is proportional to the cube of the command (propeller law).
def features(measured: Measured, full_power: np.ndarray, full_command: np.ndarray) -> np.ndarray:
    """Inputs that the paper considers.

    Parameters
    ----------
    measured : Measured
        Floats or (...) arrays.
    full_power, full_command : (3,) array
        As `VelocityNetworks`. [W, units of the maps]

    Returns
    -------
    (..., 9) array
        By `FEATURES`. Power is that of the cubed command, so it does not tell which way a thruster pushes, nor how fast
        the water flows through it. [rad, rad, m/s, and W, units of the maps]
    """
    signals = [measured.psi, measured.wind_from, measured.wind_speed]
    for unit, power, most in zip(UNITS, full_power, full_command, strict=True):
        action = measured.commands[unit]
        signals += [power * abs(action / most) ** 3, action]
    return np.stack(np.broadcast_arrays(*signals), axis=-1)


def start(measured: Measured, *, design: VelocityNetworks) -> State:
    """State at the start: at the position of GNSS, with this sample as the whole history.

    Parameters
    ----------
    measured : Measured
        Floats or (...) arrays. [as its fields]
    design : VelocityNetworks
        The networks. [as its fields]

    Returns
    -------
    State
        [as its fields]
    """
    now = features(measured, design.full_power, design.full_command)
    zero = 0.0 * measured.x
    return State(measured.x, measured.y, zero, zero, zero, zero, np.stack([now] * HISTORY, axis=-2))


def step(state: State, measured: Measured, h: float, *, design: VelocityNetworks) -> State:
    """State a sample later: p ← p + R(ψ) v h with the networks' v, or the position of GNSS.

    Parameters
    ----------
    state : State
        At the sample before; floats or (...) arrays. [as its fields]
    measured : Measured
        Measurements of now. [as its fields]
    h : float
        Time between the samples, that of the training. [s]
    design : VelocityNetworks
        The networks. [as its fields]

    Returns
    -------
    State
        [as its fields]

    References
    ----------
    Paper II, eq. (4).
    """
    # Velocities from the history up to the last sample, so that nothing later than the prediction
    # is used.
    u = velocity(state.history, design.surge)
    v = velocity(state.history, design.sway)
    north, east = to_ned(measured.psi, u, v)
    lost = measured.valid < 0.5
    # Add the newest sample, drop the oldest.
    now = features(measured, design.full_power, design.full_command)
    return State(
        np.where(lost, state.x + h * north, measured.x),
        np.where(lost, state.y + h * east, measured.y),
        u,
        v,
        state.sea,
        np.where(lost, state.lost_for + h, 0.0),
        np.concatenate((state.history[..., 1:, :], now[..., None, :]), axis=-2),
    )


def velocity(history: np.ndarray, regressor: Regressor) -> np.ndarray:
    """Velocity at the sample after a history.

    Parameters
    ----------
    history : (..., HISTORY, features) array
        Samples of `FEATURES`. [as `features`]
    regressor : Regressor
        The network. [1]

    Returns
    -------
    (...) array
        Velocity. [m/s]
    """
    # Only the inputs that this network was trained with, standardised.
    x = (history[..., regressor.inputs] - regressor.mean) / regressor.std
    if isinstance(regressor.network, Network):
        # LSTM: sample by sample, the last output counts.
        memory = empty_memory(regressor.network, x.shape[:-2])
        given = x[..., 0, :1]
        for k in range(x.shape[-2]):
            given, memory = evaluate(regressor.network, x[..., k, :], memory)
    else:
        # Feed-forward: sigmoid(z) = (1 + tanh(z/2)) / 2.
        hidden, last = regressor.network
        z = dense(x.reshape(*x.shape[:-2], -1), hidden)
        given = dense(0.5 * (1.0 + np.tanh(0.5 * z)), last)
    return regressor.velocity_mean + regressor.velocity_std * given[..., 0]
