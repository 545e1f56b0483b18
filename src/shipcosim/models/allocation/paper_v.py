"""The neural allocator of paper V: an encoder turns a requested load into commands.

It keeps limits, rates, power and sectors only as well as it learned them; nothing enforces them.
It does not know missing units: a lost one gives nothing, and the others do not take over.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper V.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation.units import NamedUnits
from shipcosim.models.core.maths import Arithmetic, clip, cos, sin
from shipcosim.models.core.motion import Load
from shipcosim.models.core.networks import Memory, Network, evaluate, network_of

WIDTHS = (64, 64)
"""Units of the encoder's LSTM layers. [1]"""
_TOLERANCE = 1e-6  # of a sample: steps add up to a little less


@dataclass(frozen=True, kw_only=True)
class PaperVParameters(NamedUnits):
    """Two azimuth thrusters and a tunnel thruster; what the network knows of them lies in its weights."""


class Encoder(NamedTuple):
    """What `step` needs of the training.

    Parameters
    ----------
    encoder : Network
        The network from standardised loads to commands. [1]
    mean, std : (3,) array
        By which loads are standardised. [N, N, N.m]
    ranges : (5,) array
        By which outputs are multiplied: tunnel, port thrust, port azimuth, starboard thrust, starboard azimuth.
        [N, N, rad, N, rad]
    sample_time : float
        Time between two evaluations. [s]
    """

    encoder: Network
    mean: np.ndarray
    std: np.ndarray
    ranges: np.ndarray
    sample_time: float


class PaperVState(NamedTuple):
    """State of the allocator.

    Parameters
    ----------
    thrusts : tuple of three floats
        Commanded thrust of port, starboard and tunnel. [N]
    azimuths : tuple of three floats
        Commanded direction of port and starboard, clockwise from the bow; that of the tunnel. [rad]
    tau_X, tau_Y, tau_N : float
        Load of these commands, body frame. [N, N, N.m]
    saturated : bool
        True where a missing unit or a lack of power changes what the network commands. [1]
    commands : tuple of five floats
        Last outputs of the network, as `Encoder.ranges`. [N, N, rad, N, rad]
    memory : tuple of Memory
        Memory of the network. [1]
    since : float
        Time since the last sample. [s]
    """

    thrusts: tuple
    azimuths: tuple
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic
    saturated: Arithmetic
    commands: tuple
    memory: tuple[Memory, ...]
    since: float


def design(arrays: Mapping[str, np.ndarray]) -> Encoder:
    """Encoder and scales from the trained arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        Weights of the encoder, ``mean``, ``std``, ``ranges`` and ``sample_time``. [as Design]

    Returns
    -------
    Encoder
        What `step` needs. [as its fields]

    Raises
    ------
    KeyError
        An array is missing.
    """
    plain = (arrays["mean"], arrays["std"], arrays["ranges"], float(arrays["sample_time"]))
    return Encoder(network_of(arrays, "encoder"), *plain)


def at_rest(tau: Load, *, parameters: PaperVParameters) -> PaperVState:
    """State at the start: no thrust, an empty memory, and a sample is due.

    Parameters
    ----------
    tau : tuple of three floats
        Any load. [N, N, N.m]
    parameters : PaperVParameters
        Directions at the start.

    Returns
    -------
    PaperVState
        The state.
    """
    # The start angles also stand in the commands, so that nothing jumps before the first sample.
    azimuths = parameters.of_units("azimuth")
    commands = (0.0, 0.0, azimuths[0], 0.0, azimuths[1])
    # Infinite time since the last sample: the network is evaluated at once.
    memory = tuple(Memory(np.zeros(width), np.zeros(width)) for width in WIDTHS)
    return PaperVState((0.0,) * 3, azimuths, 0.0, 0.0, 0.0, False, commands, memory, inf)


def step(
    state: PaperVState,
    tau: Load,
    available: tuple,
    h: float,
    *,
    parameters: PaperVParameters,
    design: Encoder,
    shares: tuple = (1.0, 1.0, 1.0),
) -> PaperVState:
    """Commands for a requested load, `h` after the last ones.

    Parameters
    ----------
    state : PaperVState
        State at the last commands.
    tau : tuple of three floats
        Requested load, body frame. [N, N, N.m]
    available : tuple of three bools
        Whether port, starboard and tunnel can be used. [1]
    h : float
        Time since the last commands. [s]
    parameters : PaperVParameters
        Places and limits.
    design : Encoder
        What training left.
    shares : tuple of three floats
        Shares of their limits of thrust that power leaves to port, starboard and tunnel. [1]

    Returns
    -------
    PaperVState
        Commands and the load that they give.
    """
    # The network runs at its own sample time; in between its commands are held.
    commands = state.commands
    memory = state.memory
    since = state.since
    if since > design.sample_time * (1.0 - _TOLERANCE):
        # Standardise the load, and scale the outputs to thrusts and angles.
        outputs, memory = evaluate(
            design.encoder, (np.array(tau) - design.mean) / design.std, memory
        )
        commands = tuple((outputs * design.ranges).tolist())
        since = 0.0
    # Order of the thrusters here: port, starboard, tunnel.
    tunnel, port, port_azimuth, starboard, starboard_azimuth = commands
    wanted = (port, starboard, tunnel)
    azimuths = (port_azimuth, starboard_azimuth, 0.5 * np.pi)
    # Power and availability limit the thrusts; the network does not know of it.
    limits = zip(wanted, available, shares, parameters.limits, strict=True)
    thrusts = tuple(
        clip(f, share * low, share * high) if on else 0.0 for f, on, share, (low, high) in limits
    )
    # Load that these commands give.
    load = given((thrusts, azimuths), parameters=parameters)
    return PaperVState(thrusts, azimuths, *load, thrusts != wanted, commands, memory, since + h)


def given(commands: tuple[tuple, tuple], *, parameters: NamedUnits) -> Load:
    """Load of commands, by the full configuration matrix.

    Parameters
    ----------
    commands : tuple of two tuples of three floats or (...) arrays
        Thrusts and azimuths of port, starboard and tunnel. [N, rad]
    parameters : NamedUnits
        Places.

    Returns
    -------
    tuple of three, like a thrust
        X, Y, N. [N, N, N.m]
    """
    # Components of both azimuths in body axes.
    (port, starboard, tunnel), (a, b, _) = commands
    p = parameters
    X1 = port * cos(a)
    Y1 = port * sin(a)
    X2 = starboard * cos(b)
    Y2 = starboard * sin(b)
    # Moment N = x Y - y X of each unit.
    N = (
        p.port_x * Y1
        - p.port_y * X1
        + p.starboard_x * Y2
        - p.starboard_y * X2
        + p.tunnel_x * tunnel
    )
    return X1 + X2, Y1 + Y2 + tunnel, N
