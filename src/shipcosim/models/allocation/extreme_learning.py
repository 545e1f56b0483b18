"""Thrust allocation of paper I: one hidden layer of random weights, from load to commands.

Commands have the units of the thrusters (rpm, degrees of pitch). Allocator 1 sees the requested
load, allocator 2 its previous commands as well. The network knows neither limits nor rates: it
keeps them only as it learned them from the exercise.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.fixed_angles import FixedAngleParameters
from shipcosim.models.allocation.units import load, no_thrust, unit_effect
from shipcosim.models.core.maths import Arithmetic, clip, exp, where
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import UNITS, quantity


@dataclass(frozen=True, kw_only=True)
class ExtremeLearningParameters(FixedAngleParameters):
    """Units, and which of the trained networks commands them."""

    allocator: int = quantity(
        2,
        "1",
        "1: sees the requested load; 2: its previous commands as well",
        "choice",
        minimum=1,
        maximum=2,
    )
    signals: int = quantity(
        6,
        "1",
        "6: a command for each unit; 5: one for units 5 and 6 together",
        "paper I says both",
        minimum=5,
        maximum=6,
    )


class Network(NamedTuple):
    """A trained network, and the thrusters' range of commands.

    Parameters
    ----------
    scale : tuple of floats
        Sizes of the inputs, by which they are divided. [N, N, N.m, units of the commands]
    hidden : tuple of tuples
        Weights of each hidden neuron, one an input. [1]
    bias : tuple of floats
        Of the hidden neurons. [1]
    output : tuple of tuples
        Weights of each output, one a hidden neuron. [units of the commands]
    least, most : tuple of six floats
        Range of the commands in the exercise. [units of the commands]
    """

    scale: tuple
    hidden: tuple
    bias: tuple
    output: tuple
    least: tuple
    most: tuple


class Commanded(NamedTuple):
    """State of the allocator: as `units.Allocated`, with the commands in the thrusters' own units.

    Parameters
    ----------
    thrusts, azimuths : tuple of six floats or (...) arrays or tensors
        Thrusts that the commands give, within the units' limits; their directions. [N, rad]
    tau_X, tau_Y, tau_N : like a thrust
        Load of these thrusts, body frame. [N, N, N.m]
    saturated : bool or (...) array or tensor of bool
        True where a command is beyond its range, or a unit is missing. [1]
    commands : tuple of six
        Commands as the network gives them, whatever their range. [rpm, deg]
    """

    thrusts: tuple
    azimuths: tuple
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic
    saturated: Arithmetic
    commands: tuple


def network_of(arrays: Mapping[str, np.ndarray], parameters: ExtremeLearningParameters) -> Network:
    """The network that the parameters choose.

    Parameters
    ----------
    arrays : mapping of str to array
        ``A.S.scale``, ``A.S.hidden``, ``A.S.bias`` and ``A.S.output`` of allocator A with S signals, ``least`` and
        ``most``. [as `Network`]
    parameters : ExtremeLearningParameters
        Which.

    Returns
    -------
    Network
        [as its fields]

    Raises
    ------
    KeyError
        An array is missing.

    References
    ----------
    Definition.
    """
    # Allocator and number of signals select the weights; the range of commands is common.
    of = f"{parameters.allocator}.{parameters.signals}"
    scale, bias, least, most = (
        tuple(arrays[name].tolist()) for name in (f"{of}.scale", f"{of}.bias", "least", "most")
    )
    hidden, output = (
        tuple(map(tuple, arrays[f"{of}.{name}"].tolist())) for name in ("hidden", "output")
    )
    return Network(scale, hidden, bias, output, least, most)


def evaluate(network: Network, inputs: tuple) -> tuple:
    """Outputs of a network: β S(W x + b), S the sigmoid.

    Parameters
    ----------
    network : Network
        The network.
    inputs : tuple of floats or (...) arrays or tensors
        Requested load, and the previous commands where it sees them. [N, N, N.m, units of the commands]

    Returns
    -------
    tuple of five or six, like an input
        Commands. [units of the commands]

    References
    ----------
    Huang, Zhu, Siew, Extreme learning machine: a new learning scheme of feedforward neural networks, IJCNN, 2004.
    """
    # Inputs over their size in the exercise, as in training.
    x = [signal / size for signal, size in zip(inputs, network.scale, strict=True)]
    hidden = []
    # Hidden layer of sigmoids; the clip avoids an overflow of exp.
    for weights, bias in zip(network.hidden, network.bias, strict=True):
        z = clip(sum(w * signal for w, signal in zip(weights, x, strict=True)) + bias, -50.0, 50.0)
        hidden.append(1.0 / (1.0 + exp(-z)))
    return tuple(
        sum(w * signal for w, signal in zip(weights, hidden, strict=True))
        for weights in network.output
    )


def at_rest(tau: Load, *, parameters: ExtremeLearningParameters) -> Commanded:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : ExtremeLearningParameters
        Directions of the units.

    Returns
    -------
    Commanded
        The state.

    References
    ----------
    Definition.
    """
    return Commanded(*no_thrust(tau, parameters.start_azimuths), (0.0 * tau[0],) * UNITS)


def step(
    state: Commanded,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: ExtremeLearningParameters,
    design: Network,
) -> Commanded:
    """Commands for a requested load, one sample after the previous commands.

    Parameters
    ----------
    state : Commanded
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of six bools or (...) arrays or tensors of bool
        Whether the units can be used; the others do not take over: that would want another training. [1]
    h : float
        Time since the last commands. The network knows only that of its training. [s]
    parameters : ExtremeLearningParameters
        Units and limits.
    design : Network
        The trained network.

    Returns
    -------
    Commanded
        Commands and the load they give.

    Notes
    -----
    The thrust that a command gives is taken as quadratic in it, up to the unit's limits.

    References
    ----------
    Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper I, 2.3.
    """
    # Allocator 2 also sees its last commands.
    seen = state.commands[: parameters.signals] if parameters.allocator == 2 else ()
    outputs = evaluate(design, (*tau, *seen))
    # With five signals units 5 and 6 share one command.
    outputs = (*outputs, outputs[-1]) if parameters.signals < UNITS else outputs
    # A missing unit gives nothing; the others do not take over.
    commands = tuple(
        where(on, output, 0.0 * output) for output, on in zip(outputs, available, strict=True)
    )
    # Thrust of each command, for the load that is reported.
    weakest = parameters.of_units("thrust_min")
    strongest = parameters.of_units("thrust_max")
    limits = tuple(zip(design.least, design.most, weakest, strongest, strict=True))
    thrusts = tuple(
        _thrust(command, *limit) for command, limit in zip(commands, limits, strict=True)
    )
    # Saturated: a command beyond the range of the exercise, or a missing unit.
    over = sum(
        where(output < low, 1.0, where(output > high, 1.0, 0.0))
        for output, (low, high, *_) in zip(outputs, limits, strict=True)
    )
    missing = sum(where(on, 0.0, 1.0) for on in available)
    effect = tuple(map(unit_effect, *map(parameters.of_units, ("x", "y", "azimuth"))))
    given = load(thrusts, effect)
    return Commanded(thrusts, state.azimuths, *given, over + missing > 0.5, commands)


def _thrust(command, least, most, weakest, strongest):
    """Thrust of a command: quadratic within its range, constant beyond."""
    # Share of the range on this side; thrust of a propeller grows as the square of its speed.
    share = clip(where(command < 0.0, command / least, command / most), 0.0, 1.0)
    return share * share * where(command < 0.0, weakest, strongest)
