"""Consequence analysis: how much of the present load the other thrusters hold after each single failure.

A thruster gives a convex set of forces at its place: a line, or the disc or sector of an azimuth. Together they give the
sum of these sets, loads X, Y, N. The share of a load that they hold is where the ray along the load leaves this sum. It
is sought from inside: three points of the sum span a triangle that the ray passes through; the point of the sum that is
furthest out along the triangle's normal takes the place of one of them, until none is further out.

The balance is static: no gusts, no time to turn, no slipstreams. A sector wider than half a turn counts as its hull.

References
----------
What is asked for: IMO MSC.1/Circ.1580, Guidelines for vessels and units with dynamic positioning systems, 2017, on
consequence analysis. The search: Snethen, XenoCollide, in Game Programming Gems 7, 2008 (portal refinement), for a ray.
"""

from dataclasses import dataclass
from math import pi
from typing import Any, NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.allocation.units import turning_fields, unit_fields
from shipcosim.models.core.maths import (
    Arithmetic,
    atan2,
    clip,
    cos,
    exp,
    hypot,
    maximum,
    minimum,
    sin,
    sqrt,
    times,
    where,
    where_all,
)
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import UNITS, acts, numbered_units, quantity

GROUPS = 3
"""Most redundancy groups. [1]"""
MOST_SHARE = 10.0
"""Largest share: a ship that holds ten times the load counts as one without load. [1]"""
ROUNDS = 20
"""Points that the search tries. [1]"""
_TINY = 1e-6
"""Load in every direction, over that of all units, which is added so that there is a triangle to begin with. [1]"""


def _fields(number):
    """Place, direction, limits, turning and group of a unit."""
    group = f"units of one group (1 to {GROUPS}) fail together, as on one bus; 0: unit {number} is in none"
    return (
        unit_fields(number)
        | turning_fields(number)
        | {"group": quantity(0.0, "1", group, "none", minimum=0.0, maximum=float(GROUPS))}
    )


@dataclass(frozen=True, kw_only=True)
class BalanceParameters:
    """What counts as held."""

    load_time: float = quantity(
        60.0,
        "s",
        "time over which the requested load is averaged",
        "assumed: several periods of gusts and slow drift",
        minimum=1.0,
    )
    dynamic_factor: float = quantity(
        1.25,
        "1",
        "share of the mean load that must be held, for gusts and waves",
        "dynamic factor of DNV-ST-0111, Level 1",
        minimum=1.0,
    )


@dataclass(frozen=True, kw_only=True)
class ConsequenceParameters(BalanceParameters, numbered_units(_fields)):
    """Units, and what counts as held."""

    analysis_period: float = quantity(
        10.0, "s", "time between two analyses", "assumed", minimum=0.05
    )


class Units(NamedTuple):
    """Thrust sets of the units, in scaled loads.

    Parameters
    ----------
    force, lever : float
        What forces and moments are divided by: all thrust, and the longest lever. [N, m]
    rows : tuple of tuples
        Of each unit: x and y over the lever, middle and half width of its angles, least and most thrust over the force;
        empty where there is no such unit. [1, 1, rad, rad, 1, 1]
    """

    force: Arithmetic
    lever: Arithmetic
    rows: tuple


class Balance(NamedTuple):
    """What tells whether units hold a load.

    Parameters
    ----------
    units : Units
        From `units_of`. [as its fields]
    load_time, dynamic_factor : float
        As of `BalanceParameters`. [s, 1]
    """

    units: Units
    load_time: float
    dynamic_factor: float


class Averaged(NamedTuple):
    """Requested load, averaged.

    Parameters
    ----------
    load : tuple of three
        Sum of past loads, each weighted by how long ago it was. [N, N, N.m]
    weight : float
        Sum of the weights: 1 after a while. [1]
    """

    load: Load
    weight: Arithmetic


def units_of(parameters: Any) -> Units:
    """Thrust sets of the units.

    Parameters
    ----------
    parameters : ConsequenceParameters, or the parameters of an allocator
        With places, limits and turning of the units. [as their fields]

    Returns
    -------
    Units
        Scaled: forces by all thrust, moments by that at the longest lever, so that all loads are of one size.

    References
    ----------
    Definition.
    """
    p = parameters
    most = p.of_units("thrust_max")
    force = maximum(sum(most[1:], most[0]), 1.0)
    lever = 1.0
    rows = []
    for x, y in zip(p.of_units("x"), p.of_units("y"), strict=True):
        lever = maximum(lever, hypot(x, y))
    names = ("x", "y", "azimuth", "azimuth_rate", "azimuth_first", "azimuth_last")
    columns = map(p.of_units, (*names, "thrust_min", "thrust_max"))
    for x, y, azimuth, rate, first, last, low, high in zip(*columns, strict=True):
        if not acts(high):
            rows.append(())
            continue
        # Middle and half width of the angles: a fixed unit has one angle, and gives thrust both ways there.
        turns = rate > 0.0
        width = where(last > first, 0.5 * (last - first), pi)
        middle = where(turns, where(last > first, 0.5 * (first + last), 0.0), azimuth)
        least = where(turns, 0.0, low) / force
        rows.append((x / lever, y / lever, middle, where(turns, width, 0.0), least, high / force))
    return Units(force, lever, tuple(rows))


def averaged(
    state: Averaged, tau: Load, h: Arithmetic, *, parameters: BalanceParameters | Balance
) -> Averaged:
    """The average with one more load.

    Parameters
    ----------
    state : Averaged
        Before. [N, N, N.m, 1]
    tau : tuple of three floats
        Requested load. [N, N, N.m]
    h : float
        Time since the last one. [s]
    parameters : BalanceParameters or Balance
        The time of the average. [as its fields]

    Returns
    -------
    Averaged
        First-order low pass; the average is ``load`` over ``weight``, from the first load on.

    References
    ----------
    Definition.
    """
    share = 1.0 - exp(-h / parameters.load_time)
    load = tuple(
        before + share * (now - before) for before, now in zip(state.load, tau, strict=True)
    )
    return Averaged(load, state.weight + share * (1.0 - state.weight))


def held_share(
    load: Load, usable: tuple, *, units: Units, heading: float = 1.0, rounds: Any = ROUNDS
) -> Arithmetic:
    """Share of a load that units can hold.

    Parameters
    ----------
    load : tuple of three floats
        Load that the thrusters shall give. [N, N, N.m]
    usable : tuple of six
        Thrust that is left to each unit, over its own: 0 where it is lost. [1]
    units : Units
        From `units_of`.
    heading : float
        1: force and moment; 0: the force alone, whatever moment comes with it. [1]
    rounds : int or (...) array or tensor
        Points that the search tries; few give a share that is a little too small. [1]

    Returns
    -------
    float
        At least 1: they hold it. At most `MOST_SHARE`. [1]

    References
    ----------
    Snethen, XenoCollide, 2008.
    """
    # Direction of the load, scaled; without heading there is no moment and no lever.
    X, Y, N = load
    aim = X / units.force, Y / units.force, heading * N / (units.force * units.lever)
    size = sqrt(_dot(aim, aim))
    aim = tuple(part / maximum(size, 1e-12) for part in aim)

    # The first triangle: the tiny loads along the axes on the load's side. It is counter-clockwise about the load.
    zero = 0.0 * size
    x, y, z = (where(part < 0.0, zero - _TINY, zero + _TINY) for part in aim)
    turned = x * y * z < 0.0
    a = x, zero, zero
    b = zero, where(turned, zero, y), where(turned, z, zero)
    c = zero, where(turned, y, zero), where(turned, zero, z)

    def further(triangle):
        a, b, c = triangle
        normal = _cross(_minus(b, a), _minus(c, a))
        p = _furthest(normal, usable, units, heading)
        # On which side of the planes through the ray and each corner the new point lies.
        of_a, of_b, of_c = (_dot(_cross(corner, p), aim) for corner in triangle)
        # It takes the place of the corner that leaves the ray inside.
        first = (of_c >= 0.0) & (of_b <= 0.0)
        second = (of_a >= 0.0) & (of_c <= 0.0)
        third = (of_b >= 0.0) & (of_a <= 0.0)
        return (
            where_all(first, p, a),
            where_all(first, b, where_all(second, p, b)),
            where_all(first | second, c, where_all(third, p, c)),
        )

    a, b, c = times(rounds, further, (a, b, c))
    # Where the ray passes through the last triangle.
    normal = _cross(_minus(b, a), _minus(c, a))
    along = _dot(normal, aim)
    reach = where(along > 0.0, _dot(normal, a) / where(along > 0.0, along, 1.0), 0.0)
    share = minimum(reach / maximum(size, 1e-9), zero + MOST_SHARE)
    # Any ship holds no load.
    return where(size > 1e-9, share, zero + MOST_SHARE)


def failures_of(parameters: ConsequenceParameters) -> tuple:
    """What each single failure leaves of the units: unit 1 to 6 lost, group 1 to `GROUPS` lost.

    Parameters
    ----------
    parameters : ConsequenceParameters
        The units. [as its fields]

    Returns
    -------
    tuple of tuples
        Of each failure: 1 for each unit that it leaves, 0 for one that it takes; empty where it takes none. [1]

    References
    ----------
    Definition.
    """
    most = parameters.of_units("thrust_max")
    groups = parameters.of_units("group")
    units = range(UNITS)
    failures = [
        tuple(0.0 if unit == lost else 1.0 for unit in units) if acts(most[lost]) else ()
        for lost in units
    ]
    for group in range(1, GROUPS + 1):
        left = tuple(where(of_unit == group, 0.0, 1.0) for of_unit in groups)
        failures.append(left if any(acts(share, neutral=1.0) for share in left) else ())
    return tuple(failures)


def _furthest(normal, usable, units, heading):
    """The load of the units together that is furthest out along a direction."""
    nx, ny, nz = normal
    # The tiny load, then what each unit adds that is there.
    X, Y, N = (where(part < 0.0, -_TINY, _TINY) for part in normal)
    for row, share in zip(units.rows, usable, strict=True):
        if not row:
            continue
        x, y, middle, width, least, most = row
        x = heading * x
        y = heading * y
        # What a force at this place is worth, and the direction, within the unit's angles, that is worth most.
        gx = nx - y * nz
        gy = ny + x * nz
        angle = middle + clip(wrap(atan2(gy, gx) - middle), -width, width)
        fx = cos(angle)
        fy = sin(angle)
        thrust = share * where(gx * fx + gy * fy > 0.0, most, least)
        X = X + thrust * fx
        Y = Y + thrust * fy
        N = N + thrust * (x * fy - y * fx)
    return X, Y, N


def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def _minus(a, b):
    return tuple(first - other for first, other in zip(a, b, strict=True))
