"""Thrust allocation by a network that turns the azimuth thrusters, for any number of units.

The network sees the request, the smoothed request, the availability of the units and their last
commands. Its outputs are the turning of each azimuth and factors on the price of each thrust.
Thrusts then meet the request at the least price, within limits and rates. With an interaction,
the thrust lost in slipstreams is known and compensated, and no sector need be forbidden.

Units lie along the last axis: (n,) for one allocation, (..., n) for many at once.

References
----------
The idea, and limits: Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021,
paper V. Predicted variables completed to satisfy equalities: Donti, Rolnick and Kolter, DC3, ICLR 2021.
"""

from typing import NamedTuple

import numpy as np

from shipcosim.angles import wrap
from shipcosim.models.core.maths import (
    Arithmetic,
    clip,
    cos,
    library_of,
    maximum,
    minimum,
    pi,
    sin,
    sqrt,
    where,
)
from shipcosim.models.core.motion import Vector
from shipcosim.models.propulsion.interaction import kept_share

SMOOTHING = 20.0
"""Time constant of the smoothed request that the network sees. [s]"""
_FLOOR = 1e-3  # share of the largest thrust below which a request counts as this small
_SOFT = 1e-5  # what keeps thrusts finite where units cannot meet a request
_GENTLE = 0.02  # share of a unit's limit below which its power is taken as quadratic
_EAGERNESS = 0.6  # of turning by itself: a small angle in 10 s
_SWAY = 2.0  # what the network can add to it
_ROUNDS = 3  # of thrusts over their limits that others take over


class Units(NamedTuple):
    """The units, in vectors of one entry each.

    Parameters
    ----------
    x, y : (n,) array or tensor
        Place, forward and to starboard of the origin. [m]
    azimuth : like x
        Direction of a unit that does not turn, and of the others at the start. [rad]
    turn : like x
        Largest rate of turning; 0: does not turn. [rad/s]
    first, last : like x
        Interval of angles of a unit that turns, clockwise; without limits -inf, inf. [rad]
    least, most, rate : like x
        Limits of thrust, and its largest rate; a unit that turns has a positive least thrust. [N, N, N/s]
    full_power : like x
        Power at the limits of thrust. [W]
    lever : float
        A missed yaw moment weighs as a missed force at this distance. [m]
    bearing, tandem : (n, n) array or tensor, or None
        From unit i to unit j its direction, and the share of its thrust that j keeps on the axis of i's slipstream;
        without interaction None. [rad, 1]
    """

    x: Arithmetic
    y: Arithmetic
    azimuth: Arithmetic
    turn: Arithmetic
    first: Arithmetic
    last: Arithmetic
    least: Arithmetic
    most: Arithmetic
    rate: Arithmetic
    full_power: Arithmetic
    lever: float
    bearing: Arithmetic
    tandem: Arithmetic


class Commands(NamedTuple):
    """Commands and the smoothed request.

    Parameters
    ----------
    thrusts, azimuths : (..., n) array or tensor
        Commanded thrusts and directions. [N, rad]
    smooth : (..., 3) array or tensor
        Smoothed request. [N, N, N.m]
    """

    thrusts: Arithmetic
    azimuths: Arithmetic
    smooth: Arithmetic


def features(
    state: Commands, tau: Arithmetic, available: Arithmetic, pull: Arithmetic, *, units: Units
) -> Arithmetic:
    """Inputs of the network: numbers of order 1 that do not jump where an angle wraps.

    Parameters
    ----------
    state : Commands
        The last commands.
    tau : (..., 3) array or tensor
        Request. [N, N, N.m]
    available : (..., n) array or tensor
        1 where a unit can be used, 0 where not; in between the share of its thrust that it may give. [1]
    pull : (..., n) array or tensor
        Sine of the angle to the direction in which a newton of the unit is worth most. [1]
    units : Units
        The units.

    Returns
    -------
    (..., 8 + 5 n) array or tensor
        Direction and size of the request and of the smoothed one; thrusts over it, availability, pull, angles. [1]

    References
    ----------
    Definition.
    """
    # Direction and logarithmic size of the present request and of the smoothed one.
    library = library_of(tau)
    largest = units.most.max()
    now, size = _direction(tau, units.lever, largest)
    lately, before = _direction(state.smooth, units.lever, largest)
    # Thrusts relative to the request, bounded by tanh.
    thrusts = library.tanh(state.thrusts / size)
    rows = [now, _log(size, largest), lately, _log(before, largest), thrusts, available, pull]
    # Sine and cosine of the angles do not jump at half turns.
    return library.concatenate([*rows, sin(state.azimuths), cos(state.azimuths)], -1)


def network(seen: Arithmetic, weights: tuple) -> Arithmetic:
    """Layers of hyperbolic tangents, the last one too: each output is between -1 and 1.

    Parameters
    ----------
    seen : (..., k) array or tensor
        Inputs. [1]
    weights : tuple of pairs of arrays or tensors
        Matrix (k, m) and offsets (m,) of each layer. [1]

    Returns
    -------
    (..., m) array or tensor
        Outputs. [1]

    References
    ----------
    Definition of a feed-forward network.
    """
    library = library_of(seen)
    for matrix, offset in weights:
        seen = library.tanh(seen @ matrix + offset)
    return seen


def propose(
    state: Commands,
    tau: Arithmetic,
    available: Arithmetic,
    h: float,
    *,
    units: Units,
    weights: tuple,
) -> Commands:
    """Commands of the network: turning of units, and thrusts at its prices that meet the request.

    Without the network each unit turns to the direction in which a newton is worth most, as in the
    sequential quadratic program, at the price of its power. The network adds to turning and prices.

    Parameters
    ----------
    state : Commands
        The last commands.
    tau : (..., 3) array or tensor
        Request. [N, N, N.m]
    available : (..., n) array or tensor
        As of `features`. A unit at 0 gives nothing at once; what exceeds a share is taken back at once. [1]
    h : float
        Time since the last commands. [s]
    units : Units
        The units.
    weights : tuple
        As of `network`. [1]

    Returns
    -------
    Commands
        Within limits, rates and intervals of angles; angles are not wrapped.

    References
    ----------
    As this module.
    """
    # Limits of thrust, reduced where power is short.
    n = units.x.shape[-1]
    least = units.least * available
    most = units.most * available
    # Next thrusts can differ from the last by the rate.
    old = state.thrusts
    reach = units.rate * h
    least = where(
        least > 0.0, minimum(least, old + reach), least
    )  # a unit at rest goes up to its least thrust
    low = clip(old - reach, least, most)
    high = clip(old + reach, least, most)
    # Ask for more where slipstreams take thrust: the loss changes little within a step.
    asked = tau + taken(old, state.azimuths, units=units)
    # Effects without slipstreams, since the loss is already in the request.
    plain = units._replace(tandem=None)
    effect = effects(old, state.azimuths, units=plain)
    # What a newton of each load is worth at the present angles, without the network's prices.
    _, worth = completed(old, asked, effect, low, high, 1.0 + 0.0 * old, units=units)
    pull = _pull(worth, state.azimuths, units)
    # The network adds to the turning towards the best direction.
    outputs = network(features(state, tau, available, pull, units=units), weights)
    turns = library_of(pull).tanh(_EAGERNESS * pull + _SWAY * outputs[..., :n])
    # Units turn within their intervals; fixed units and missing ones keep their directions.
    reached = state.azimuths + turns * units.turn * h * (available > 0.0)
    azimuths = where(units.turn > 0.0, clip(reached, units.first, units.last), state.azimuths)
    # Solve again at the new angles, with the network's prices.
    effect = effects(old, azimuths, units=plain)
    prices = library_of(pull).exp(outputs[..., n:])
    thrusts, _ = completed(old, asked, effect, low, high, prices, units=units)
    # First-order low-pass of the request.
    share = 1.0 - np.exp(-h / SMOOTHING)
    return Commands(thrusts, azimuths, state.smooth + share * (tau - state.smooth))


def effects(thrusts: Arithmetic, azimuths: Arithmetic, *, units: Units) -> Arithmetic:
    """Load of one newton of each unit, slipstreams included.

    Parameters
    ----------
    thrusts, azimuths : (..., n) array or tensor
        Thrusts, for the slipstreams they make, and directions. [N, rad]
    units : Units
        The units.

    Returns
    -------
    (..., 3, n) array or tensor
        X, Y and N of a newton, the last one over the lever. [1]

    References
    ----------
    Thruster configuration matrix: Skulstad 2021, eq. 2.4, with the full yaw arm; slipstreams: `interaction`.
    """
    # Columns (cos a, sin a, (x sin a - y cos a) / lever).
    c = cos(azimuths)
    s = sin(azimuths)
    library = library_of(c)
    matrix = library.stack([c, s, (units.x * s - units.y * c) / units.lever], -2)
    # Slipstreams reduce the thrust of the units that they hit.
    if units.tandem is None:
        return matrix
    return matrix * kept_shares(thrusts, azimuths, units=units)[..., None, :]


def taken(thrusts: Arithmetic, azimuths: Arithmetic, *, units: Units) -> Arithmetic:
    """Load that slipstreams take from commanded thrusts.

    Parameters
    ----------
    thrusts, azimuths : (..., n) array or tensor
        Commands. [N, rad]
    units : Units
        The units.

    Returns
    -------
    (..., 3) array or tensor, or 0
        X, Y and N; 0 without interaction. [N, N, N.m]

    References
    ----------
    As `effects`.
    """
    if units.tandem is None:
        return 0.0
    # Lost thrust of each unit, then its load.
    lost = thrusts * (1.0 - kept_shares(thrusts, azimuths, units=units))
    c = cos(azimuths)
    s = sin(azimuths)
    library = library_of(c)
    rows = [(lost * c).sum(-1), (lost * s).sum(-1), (lost * (units.x * s - units.y * c)).sum(-1)]
    return library.stack(rows, -1)


def kept_shares(thrusts: Arithmetic, azimuths: Arithmetic, *, units: Units) -> Arithmetic:
    """Share of thrust that each unit keeps in the slipstreams of the others.

    Parameters
    ----------
    thrusts, azimuths : (..., n) array or tensor
        Commands. [N, rad]
    units : Units
        The units, with bearings.

    Returns
    -------
    (..., n) array or tensor
        0 to 1. [1]

    References
    ----------
    As `interaction.thrust_shares`. A slipstream's speed is proportional to the root of its unit's thrust over the limit.
    """
    # Speed of a slipstream, as the root of thrust over its limit.
    wash = sqrt(_used(thrusts, units) + 1e-6)
    # A slipstream flows against the thrust that makes it.
    towards = where(thrusts > 0.0, azimuths + pi, azimuths)
    # Angle between the slipstream and the direction to each other unit.
    off_axis = wrap(units.bearing - towards[..., :, None])
    shares = kept_share(off_axis, units.tandem, wash[..., :, None] / wash[..., None, :])
    # Losses by several slipstreams multiply.
    return library_of(shares).prod(shares, -2)


def completed(
    thrusts: Arithmetic,
    tau: Arithmetic,
    effect: Arithmetic,
    low: Arithmetic,
    high: Arithmetic,
    prices: Arithmetic,
    *,
    units: Units,
) -> Vector:
    """Thrusts within limits that meet a request at the least power, and what a newton of each load is worth.

    Parameters
    ----------
    thrusts : (..., n) array or tensor
        Thrusts around which power is taken as quadratic. [N]
    tau : (..., 3) array or tensor
        Request. [N, N, N.m]
    effect : (..., 3, n) array or tensor
        As `effects`. [1]
    low, high : (..., n) array or tensor
        Limits. [N]
    prices : (..., n) array or tensor
        Factors on the power of the units. [1]
    units : Units
        The units.

    Returns
    -------
    (..., n) array or tensor
        Thrusts. [N]
    (..., 3) array or tensor
        Power for one unit more of each load, the moment over the lever, over that of the largest unit at its limit. [1]

    References
    ----------
    Newton's step of the power's Lagrangian; a unit beyond a limit stays there, and the others meet what is left.
    """
    # Price P = c |f|^1.5, relative to the largest unit at its limit.
    library = library_of(thrusts)
    found = clip(thrusts, low, high)
    steep = (
        prices
        * (units.full_power / units.full_power.max())
        * (units.most.max() / units.most) ** 1.5
    )
    # Small thrusts count as quadratic: the curvature of |f|^1.5 is infinite at zero.
    used = maximum(abs(found), _GENTLE * units.most) / units.most.max()
    # Second and first derivative of the price at the present thrusts.
    curve = 0.5 * steep / sqrt(used)  # of 2/3 of the power over thrust
    slope = steep * sqrt(used) * found / maximum(abs(found), _GENTLE * units.most)
    # Everything over the largest thrust, so that the numbers are of order 1.
    request = _scaled(tau, units.lever)
    scale = units.most.max()
    # Units whose bounds coincide are not free.
    free = (high > low) * (1.0 + 0.0 * found)
    turned = library.swapaxes(effect, -1, -2)
    # A soft request keeps the system solvable where units cannot meet it.
    soft = _SOFT * library.eye(3, dtype=found.dtype)
    # Units that reach a bound stay there; the others take over in the next round.
    for _ in range(_ROUNDS):
        # Minimise the quadratic price subject to the request: B E B^T lambda = missing + B E slope.
        ease = free / curve
        missing = (request - (effect @ found[..., None])[..., 0]) / scale
        asked = missing + (effect @ (ease * slope)[..., None])[..., 0]
        across = (effect * ease[..., None, :]) @ turned
        worth = library.linalg.solve(across + soft, asked[..., None])
        # Newton step of each unit for these multipliers.
        step = ease * ((turned @ worth)[..., 0] - slope)
        wanted = found + scale * step
        after = clip(wanted, low, high)
        # Units that were clipped are no longer free; their slope follows the price.
        inside = wanted == after
        slope = slope + curve * (after - found) / scale
        free = free * inside
        found = after
        if bool(inside.all()):
            break
    return found, worth[..., 0]


def _pull(worth, azimuths, units):
    """Sine of the angle between a unit and its best direction; 0 for fixed units."""
    # Worth of a newton ahead and to starboard at the place of the unit, its moment included.
    X, Y, N = (worth[..., k][..., None] for k in range(3))
    ahead = X - units.y / units.lever * N
    aside = Y + units.x / units.lever * N
    # Small worth gives a small pull: there the best direction means little.
    size = sqrt(ahead * ahead + aside * aside + 1e-6)
    return (cos(azimuths) * aside - sin(azimuths) * ahead) / size * (units.turn > 0.0)


def power(thrusts: Arithmetic, *, units: Units) -> Arithmetic:
    """Power of thrusts, all units together.

    Parameters
    ----------
    thrusts : (..., n) array or tensor
        Thrusts. [N]
    units : Units
        The units.

    Returns
    -------
    (...) array or tensor
        [W]

    References
    ----------
    As `units.thruster_power`.
    """
    used = _used(thrusts, units)
    return (units.full_power * used * sqrt(used + 1e-9)).sum(-1)


def _used(thrusts, units):
    """Shares of their limits that thrusts use; 0 for a unit without thrust."""
    astern = where(
        units.least < 0.0, -units.least, units.most
    )  # the safety layer may reverse a unit that turns
    return abs(thrusts) / (where(thrusts < 0.0, astern, units.most) + 1e-9)


def _scaled(tau, lever):
    """Load with the moment over the lever. [N]"""
    return library_of(tau).stack([tau[..., 0], tau[..., 1], tau[..., 2] / lever], -1)


def _direction(tau, lever, largest):
    """A load over its size, and the size, which has a floor. [1, N]"""
    scaled = _scaled(tau, lever)
    size = sqrt((scaled * scaled).sum(-1)[..., None] + (_FLOOR * largest) ** 2)
    return scaled / size, size


def _log(size, largest):
    """Size on a scale of order 1."""
    return 0.4 * library_of(size).log(size / largest) + 1.0
