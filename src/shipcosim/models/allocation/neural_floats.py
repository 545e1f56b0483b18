"""`neural.propose` and `neural.taken` for one allocation in plain floats; tests compare them.

An allocator FMU computes one allocation a step. For vectors of three or four entries a NumPy call
costs more than its result; only the network is large enough for NumPy.
"""

from math import cos, exp, log, pi, remainder, sin, sqrt, tanh
from typing import NamedTuple

import numpy as np

from shipcosim.models.allocation import neural
from shipcosim.models.allocation.box_qp import multipliers_of
from shipcosim.models.allocation.neural import Units

_DEGREES = 180.0 / pi


class FloatThruster(NamedTuple):
    """A unit as `neural.Units` has it, and what follows from its numbers alone.

    Parameters
    ----------
    x, y : float
        Place over the lever. [1]
    azimuth, turn, first, last : float
        As of `neural.Units`. [rad, rad/s, rad, rad]
    least, most, rate : float
        The same. [N, N, N/s]
    astern, gentle : float
        Limit of thrust astern, and the thrust below which power is taken as quadratic. [N]
    steep : float
        Slope of the power at the limit, over that of the largest unit. [1]
    """

    x: float
    y: float
    azimuth: float
    turn: float
    first: float
    last: float
    least: float
    most: float
    rate: float
    astern: float
    gentle: float
    steep: float


class Floats(NamedTuple):
    """The units and the network for one allocation at a time.

    Parameters
    ----------
    units : tuple of FloatThruster
        The units. [as of FloatThruster]
    lever : float
        As of `neural.Units`. [m]
    largest : float
        The largest limit of thrust. [N]
    pairs : tuple of tuples
        Of each slipstream that can hit a unit: unit that makes it, unit that is hit, bearing, share kept on the axis,
        angle within which the loss falls, to the third. [1, 1, rad, 1, deg^3]
    weights : tuple of pairs of (k, m) and (m,) arrays
        The network. [1]
    """

    units: tuple
    lever: float
    largest: float
    pairs: tuple
    weights: tuple


def floats_of(units: Units, weights: tuple) -> Floats:
    """Units and network as floats, as `propose` needs them.

    Parameters
    ----------
    units : Units
        The units, in vectors of NumPy. [as its fields say]
    weights : tuple of pairs of (k, m) and (m,) arrays
        The network. [1]

    Returns
    -------
    Floats
        The same in floats.

    References
    ----------
    Definition.
    """
    # Quantities that depend on the units alone, computed once.
    u = units
    largest = float(units.most.max())
    astern = np.where(u.least < 0.0, -u.least, u.most)
    steep = u.full_power / u.full_power.max() * (largest / u.most) ** 1.5
    # Fields in the order of `FloatThruster`.
    own = (
        u.azimuth,
        u.turn,
        u.first,
        u.last,
        u.least,
        u.most,
        u.rate,
        astern,
        neural._GENTLE * u.most,
        steep,
    )
    columns = (
        np.asarray(values, float).tolist() for values in (u.x / u.lever, u.y / u.lever, *own)
    )
    # Only slipstreams that can hit a unit: the others keep all thrust.
    pairs = []
    kept = np.ones((len(u.x), len(u.x))) if u.tandem is None else u.tandem
    for front, behind in np.argwhere(kept < 1.0).tolist():
        bearing = float(u.bearing[front, behind])
        tandem = float(kept[front, behind])
        # Loss over the angle from the axis, as
        # `interaction.kept_share`: 130 / t^3 is its scale.
        # [deg^3]
        pairs.append((front, behind, bearing, tandem, 130.0 / tandem**3))
    return Floats(
        tuple(FloatThruster(*row) for row in zip(*columns, strict=True)),
        u.lever,
        largest,
        tuple(pairs),
        weights,
    )


def propose(
    thrusts: tuple,
    azimuths: tuple,
    smooth: tuple,
    tau: tuple,
    usable: list,
    lost: tuple,
    h: float,
    of: Floats,
) -> tuple[tuple, tuple, tuple]:
    """As `neural.propose`.

    Parameters
    ----------
    thrusts, azimuths : tuple of floats
        The last commands. [N, rad]
    smooth, tau : tuple of three floats
        Smoothed request before, request. [N, N, N.m]
    usable : list of floats
        Shares of their limits of thrust that units may give. [1]
    lost : tuple of three floats
        As `taken` gives for the last commands. [N, N, N.m]
    h : float
        Time since the last commands. [s]
    of : Floats
        Units and network.

    Returns
    -------
    tuple of three tuples
        Thrusts, angles and the smoothed request. [N, rad; N, N, N.m]

    References
    ----------
    As `neural`.
    """
    # Request with the slipstream loss added, over the largest thrust and the lever.
    asked = tuple((axis + less) / of.largest for axis, less in zip(tau, lost, strict=True))
    asked = asked[0], asked[1], asked[2] / of.lever
    # Bounds and effects of each unit at its last command.
    bounds = [
        _bounds(unit, f, share, h) for unit, f, share in zip(of.units, thrusts, usable, strict=True)
    ]
    effects = [_effect(unit, angle) for unit, angle in zip(of.units, azimuths, strict=True)]
    # Worth of each load at these angles, and the pull of each unit to its best direction.
    worth = _completed(thrusts, asked, effects, bounds, [unit.steep for unit in of.units], of)[1]
    pull = [_pull(unit, worth, effect) for unit, effect in zip(of.units, effects, strict=True)]
    # The network sees all of it, and puts out turning and prices.
    said = neural.network(
        _features(thrusts, effects, smooth, tau, usable, pull, of), of.weights
    ).tolist()
    angles = []
    # Turn each unit by the pull and the network's share, within its interval.
    for unit, angle, share, own, more in zip(of.units, azimuths, usable, pull, said, strict=False):
        turn = (
            tanh(neural._EAGERNESS * own + neural._SWAY * more) * unit.turn * h
            if share > 0.0
            else 0.0
        )
        angles.append(min(max(angle + turn, unit.first), unit.last) if unit.turn > 0.0 else angle)
    # Thrusts at the new angles and the network's prices.
    effects = [_effect(unit, angle) for unit, angle in zip(of.units, angles, strict=True)]
    steep = [
        unit.steep * exp(price) for unit, price in zip(of.units, said[len(angles) :], strict=True)
    ]
    found = _completed(thrusts, asked, effects, bounds, steep, of)[0]
    # First-order low-pass of the request.
    share = 1.0 - exp(-h / neural.SMOOTHING)
    return (
        tuple(found),
        tuple(angles),
        tuple(old + share * (new - old) for old, new in zip(smooth, tau, strict=True)),
    )


def taken(thrusts: tuple, azimuths: tuple, of: Floats) -> tuple[float, float, float]:
    """As `neural.taken`.

    Parameters
    ----------
    thrusts, azimuths : tuple of floats
        Commands. [N, rad]
    of : Floats
        The units.

    Returns
    -------
    tuple of three floats
        X, Y and N. [N, N, N.m]

    References
    ----------
    As `neural.effects`.
    """
    # Without slipstreams nothing is lost.
    if not of.pairs:
        return 0.0, 0.0, 0.0
    # Speed of each slipstream, as the root of thrust over its limit.
    limits = (
        unit.astern if f < 0.0 else unit.most for f, unit in zip(thrusts, of.units, strict=True)
    )
    wash = [sqrt(abs(f) / (limit + 1e-9) + 1e-6) for f, limit in zip(thrusts, limits, strict=True)]
    # Losses by several slipstreams multiply.
    kept = [1.0] * len(thrusts)
    for front, behind, bearing, tandem, spread in of.pairs:
        # A slipstream flows against the thrust that makes it.
        axis = azimuths[front] + pi if thrusts[front] > 0.0 else azimuths[front]
        cube = (abs(remainder(bearing - axis, 2.0 * pi)) * _DEGREES) ** 3
        # Share kept at this angle; a weak slipstream takes less of a strong unit.
        share = tandem + (1.0 - tandem) * cube / (spread + cube)
        kept[behind] *= 1.0 - (1.0 - share) * min(1.0, wash[front] / wash[behind])
    # Load of the lost thrusts.
    X = Y = N = 0.0
    for unit, f, angle, share in zip(of.units, thrusts, azimuths, kept, strict=True):
        c, s, arm = _effect(unit, angle)
        less = f * (1.0 - share)
        X = X + c * less
        Y = Y + s * less
        N = N + arm * less
    return X, Y, N * of.lever


def _bounds(unit, f, share, h):
    """Least and largest next thrust."""
    least = unit.least * share
    most = unit.most * share
    reach = unit.rate * h
    if least > 0.0:
        least = min(least, f + reach)  # a unit at rest goes up to its least thrust
    return min(max(f - reach, least), most), min(max(f + reach, least), most)


def _effect(unit, angle):
    """Load of one newton, the moment over the lever."""
    c = cos(angle)
    s = sin(angle)
    return c, s, unit.x * s - unit.y * c


def _pull(unit, worth, effect):
    """As `neural._pull`."""
    if unit.turn <= 0.0:
        return 0.0
    ahead = worth[0] - unit.y * worth[2]
    aside = worth[1] + unit.x * worth[2]
    return (effect[0] * aside - effect[1] * ahead) / sqrt(ahead * ahead + aside * aside + 1e-6)


def _features(thrusts, effects, smooth, tau, usable, pull, of):
    """As `neural.features`."""
    # Direction and size of the smoothed and of the present request; size stays that of the latter.
    rows = []
    floor = (neural._FLOOR * of.largest) ** 2
    for X, Y, N in (smooth, tau):
        N = N / of.lever
        size = sqrt(X * X + Y * Y + N * N + floor)
        rows.append((X / size, Y / size, N / size, 0.4 * log(size / of.largest) + 1.0))
    # Thrusts relative to the request, bounded by tanh.
    given = [tanh(f / size) for f in thrusts]
    sines = [effect[1] for effect in effects]
    cosines = [effect[0] for effect in effects]
    return np.array([*rows[1], *rows[0], *given, *usable, *pull, *sines, *cosines])


def _completed(thrusts, asked, effects, bounds, steep, of):
    """As `neural.completed`; `asked` is over the largest thrust, and the moment over the lever too."""
    found = []
    curves = []
    slopes = []
    free = []
    # Quadratic price at each thrust: curvature, slope and ease, all over the largest thrust.
    for f, (low, high), price, unit in zip(thrusts, bounds, steep, of.units, strict=True):
        f = min(max(f, low), high)
        curve = 0.5 * price / sqrt(max(abs(f), unit.gentle) / of.largest)
        found.append(f / of.largest)
        curves.append(curve)
        slopes.append(2.0 * curve * f / of.largest)
        free.append(1.0 / curve if high > low else 0.0)
    worth = 0.0, 0.0, 0.0
    # A soft request keeps the equations solvable where units cannot meet it.
    soft = (neural._SOFT,) * 3
    # Each round: three equations for the free units, then one Newton step.
    for _ in range(neural._ROUNDS):
        rows = [
            (X, Y, N, at - ease * slope, ease)
            for (X, Y, N), at, ease, slope in zip(effects, found, free, slopes, strict=True)
        ]
        worth = p, q, r = multipliers_of(asked, soft, rows)
        inside = True
        # Newton step of each unit; one that leaves its bounds stays at its bound.
        for k, (X, Y, N) in enumerate(effects):
            at = found[k]
            (low, high) = bounds[k]
            wanted = (at + free[k] * (X * p + Y * q + N * r - slopes[k])) * of.largest
            after = min(max(wanted, low), high)
            if after != wanted:
                free[k], inside = 0.0, False
            found[k] = after / of.largest
            # The slope follows the quadratic price to the new thrust.
            slopes[k] += curves[k] * (found[k] - at)
        if inside:
            break
    return [at * of.largest for at in found], worth
