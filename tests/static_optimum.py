"""Least power that can give a load, without limits of the rates: the reference that laws of allocation are measured by.

The thrust of a unit that turns is a vector within a cone, and abs(f)^1.5 is convex in it, so for one cone a unit the
least power is a convex problem, and with several cones a unit the best of a few such problems is the global optimum.
Each is solved by its dual: with three multipliers λ, what one more of each load may cost, every unit for itself takes
the vector that maximises b'λ f - c abs(f)^1.5, which is known in closed form, and Newton's method finds the λ at which
the units together give the load. NumPy, many loads at once; for tables and tests, not for use step by step.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from shipcosim.angles import TURN, wrap_series
from shipcosim.models.allocation.sqp import AllocatedThruster

_ROUNDS = 120
_TIGHT = 1e-7  # load that is missed for the dearest unit's price, over the largest thrust


class Optimum(NamedTuple):
    """Least power and the commands that take it.

    Parameters
    ----------
    power : (n,) array
        Power of all units. [W]
    thrusts, azimuths : (n, u) array
        Commands of the units. [N, rad]
    missed : (n, 3) array
        Load that cannot be given: the request minus what the commands give. [N, N, N.m]
    """

    power: np.ndarray
    thrusts: np.ndarray
    azimuths: np.ndarray
    missed: np.ndarray


def static_optimum(
    tau: np.ndarray,
    units: Sequence[AllocatedThruster],
    cones: Sequence[Sequence[tuple[float, float]]],
    *,
    yaw_lever: float,
) -> Optimum:
    """Commands of the least power for each of some loads.

    Parameters
    ----------
    tau : (n, 3) array
        Loads: X, Y, N. [N, N, N.m]
    units : sequence of AllocatedThruster
        The units. One with an azimuth rate turns and gives 0 or more, whatever its `least` says; any other has the
        direction `first` and reverses to its `least`.
    cones : sequence of sequences of pairs of float
        For each unit the intervals of angles that it may have, each of at most π or of 2π or more, which is no limit;
        of a unit that does not turn they are not used. [rad]
    yaw_lever : float
        A missed yaw moment weighs as a missed force at this distance. [m]

    Returns
    -------
    Optimum
        The best over all choices of one interval a unit.

    Raises
    ------
    ValueError
        If an interval is neither convex nor the whole circle.

    References
    ----------
    Convex duality: Boyd and Vandenberghe, Convex Optimization, Cambridge, 2004, ch. 5. That the allowed angles of an
    azimuth beside another make two convex cones: Skulstad, Data-based modelling of ships for motion prediction and
    control allocation, NTNU, 2021, paper V, fig. 3.
    """
    choices = [
        tuple(of_unit) if unit.azimuth_rate > 0.0 else ((unit.first, unit.first),)
        for unit, of_unit in zip(units, cones, strict=True)
    ]
    for first, last in (pair for of_unit in choices for pair in of_unit):
        if not (0.0 <= last - first <= np.pi or last - first >= 2.0 * np.pi):
            raise ValueError(
                f"cone from {first} to {last} rad: more than half a circle, which is not convex; split it"
            )
    tau = np.asarray(tau, float)
    found = [_convex(tau, units, chosen, yaw_lever) for chosen in product(*choices)]
    cost = [one.power + (one.missed**2 / _slack(units, yaw_lever)).sum(-1) / 2.0 for one in found]
    rows = np.arange(len(tau))
    best = np.argmin(cost, axis=0)
    return Optimum(*(np.stack(values)[best, rows] for values in zip(*found, strict=True)))


def _dearest(units):
    """Largest thrust, and the largest price of one newton more."""
    most = [max(unit.most, -unit.least) for unit in units]
    return max(most), max(1.5 * unit.price * f**0.5 for unit, f in zip(units, most, strict=True))


def _slack(units, yaw_lever):
    """Load that is missed for a multiplier of one."""
    most, price = _dearest(units)
    return _TIGHT * most / price * np.array([1.0, 1.0, yaw_lever**2])


def _convex(tau, units, cones, yaw_lever):
    """Optimum with one cone a unit: Levenberg's damped Newton on the dual, which is concave."""
    scale = np.array([1.0, 1.0, 1.0 / yaw_lever])
    most, price = _dearest(units)
    prices = tau * scale**2 * price / most
    value, slope, curve, thrusts, angles = _dual(prices, tau, units, cones, yaw_lever)
    damping = np.ones(len(tau))
    for _ in range(_ROUNDS):
        matrix = curve * scale[:, None] * scale + damping[:, None, None] * np.eye(3)
        step = np.linalg.solve(matrix, (slope * scale)[..., None])[..., 0] * scale
        new = _dual(prices + step, tau, units, cones, yaw_lever)
        good = new[0] >= value - 1e-12 * np.abs(value)
        prices = np.where(good[:, None], prices + step, prices)
        old = value, slope, curve, thrusts, angles
        value, slope, curve, thrusts, angles = (
            np.where(good.reshape(-1, *(1,) * (a.ndim - 1)), a, b)
            for a, b in zip(new, old, strict=True)
        )
        damping = np.maximum(np.where(good, 0.2 * damping, 8.0 * damping), 1e-10)
        if (np.abs(slope * scale).max(-1) < 1e-6).all():
            break
    missed = tau - _load(units, thrusts, angles)
    power = np.sum(
        [_price(unit, f) * np.abs(f) ** 1.5 for unit, f in zip(units, thrusts.T, strict=True)],
        axis=0,
    )
    return Optimum(power, thrusts, angles, missed)


def _load(units, thrusts, angles):
    """Load of commands."""
    X = thrusts * np.cos(angles)
    Y = thrusts * np.sin(angles)
    x, y = np.array([[unit.x, unit.y] for unit in units]).T
    return np.stack([X.sum(-1), Y.sum(-1), (x * Y - y * X).sum(-1)], -1)


def _price(unit, f):
    """Power over thrust^1.5; astern so that the power at both limits is the same."""
    if unit.least < 0.0:
        return np.where(f < 0.0, unit.price * (unit.most / -unit.least) ** 1.5, unit.price)
    return unit.price + 0.0 * f


def _dual(prices, tau, units, cones, yaw_lever):
    """Value of the dual, its slope and negative curvature, and the thrust and angle that each unit takes."""
    slack = _slack(units, yaw_lever)
    value = (prices * tau).sum(-1) - 0.5 * (prices**2 * slack).sum(-1)
    slope = tau - prices * slack
    curve = np.zeros((len(tau), 3, 3)) + np.diag(slack)
    thrusts = []
    angles = []
    for unit, cone in zip(units, cones, strict=True):
        effect = np.array([[1.0, 0.0], [0.0, 1.0], [-unit.y, unit.x]])
        gain, vector, f, angle, bend = _taken(unit, cone, prices @ effect)
        value = value - gain
        slope = slope - vector @ effect.T
        curve = curve + effect @ bend @ effect.T
        thrusts.append(f)
        angles.append(angle)
    return value, slope, curve, np.stack(thrusts, -1), np.stack(angles, -1)


def _taken(unit, cone, g):
    """What a unit takes where g is offered for a newton in each direction: gain, vector, thrust, angle, derivative."""
    middle, half = 0.5 * (cone[0] + cone[1]), min(0.5 * (cone[1] - cone[0]), np.pi)
    off = wrap_series(np.arctan2(g[:, 1], g[:, 0]) - middle, TURN)
    turned = np.clip(off, -half, half)
    angle = middle + turned
    size = np.hypot(g[:, 0], g[:, 1])
    along = size * np.cos(off - turned)
    turns = unit.azimuth_rate > 0.0
    along = np.maximum(along, 0.0) if turns else along
    price = _price(unit, along)
    f = (along / (1.5 * price)) ** 2
    most = np.where(along < 0.0, -min(unit.least, 0.0), unit.most)
    free = f < most
    f = np.sign(along) * np.minimum(f, most)
    gain = along * f - price * np.abs(f) ** 1.5
    u, t = (
        np.stack([np.cos(angle), np.sin(angle)], -1),
        np.stack([-np.sin(angle), np.cos(angle)], -1),
    )
    rate = np.where(free, 2.0 * np.abs(along) / (1.5 * price) ** 2, 0.0)
    bend = rate[:, None, None] * u[:, :, None] * u[:, None, :]
    inside = turns & (np.abs(off) < half)
    bend = (
        bend
        + np.where(inside, f / np.maximum(size, 1e-12), 0.0)[:, None, None]
        * t[:, :, None]
        * t[:, None, :]
    )
    return gain, f[:, None] * u, f, angle, bend
