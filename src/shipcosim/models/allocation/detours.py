"""The long way round, for units that keep to one interval of angles.

A step looks for better angles near the last ones. So a unit that is wanted beyond the end of its interval stays at that
end, although it could be turned there through the rest of its interval. Where load is missed for a while, each unit that
gives only its least thrust and would help more than `FAR` away gives its thrust up and turns there.
"""

from math import inf
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.allocation.sqp import (
    AllocatedThruster,
    OptimalProblem,
    Turned,
    is_within,
)
from shipcosim.models.core.maths import Arithmetic, atan2, clip, cos, sin, where
from shipcosim.models.core.motion import Load

_WAIT = 5.0  # s for which load must be missed: longer than noise and gusts, assumed
_THERE = 1.0  # rad from the aim: nearer, the unit gives thrust again
FAR = 1.2
"""Angle beyond which steps do not find where a unit is wanted: what is nearer, they find. [rad]"""


class DetourMemory(NamedTuple):
    """Which units are on a detour.

    Parameters
    ----------
    turning : tuple of floats or (...) arrays or tensors
        1 while a unit turns idle to its aim, else 0. [1]
    aims : tuple, as many
        Angles that the units turn to. [rad]
    waited : like an aim
        How long load has been missed, less how long it has been met. [s]
    """

    turning: tuple
    aims: tuple
    waited: Arithmetic


def detours_at_rest(tau: Load, *, design: OptimalProblem) -> DetourMemory:
    """No unit on a detour.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    design : OptimalProblem
        The units. [as its fields]

    Returns
    -------
    DetourMemory
        The state.

    References
    ----------
    Definition.
    """
    none = (0.0 * tau[0],) * len(design.units)
    return DetourMemory(none, none, 0.0 * tau[0])


def detour_step(
    state: Turned, tau: Load, h: float, *, design: OptimalProblem
) -> tuple[DetourMemory, OptimalProblem]:
    """Send units on detours.

    Parameters
    ----------
    state : Turned
        State at the last commands. [as its fields]
    tau : tuple of three floats or (...) arrays or tensors
        Requested load. [N, N, N.m]
    h : float
        Time since the last commands. [s]
    design : OptimalProblem
        The units. [as its fields]

    Returns
    -------
    tuple of DetourMemory and OptimalProblem
        What is remembered, and the problem in which a unit on a detour has only the angles around its aim.

    References
    ----------
    The way round is this project's.
    """
    memory = state.memory
    zero = 0.0 * memory.waited
    # Noise meets the request now and then: that counts against the time, and ends it only if it is as long.
    waited = memory.waited + where(state.saturated, zero + h, zero - h)
    waited = clip(waited, zero, zero + 2.0 * _WAIT)
    # Missed load, as forces of one kind: a moment counts at the lever.
    X = tau[0] - state.tau_X
    Y = tau[1] - state.tau_Y
    N = (tau[2] - state.tau_N) / design.yaw_lever**2
    rows = zip(
        design.units, state.thrusts, state.azimuths, memory.turning, memory.aims, strict=True
    )
    units = []
    turning = []
    aims = []
    for unit, f, angle, turns, aim in rows:
        # A unit without limits turns the short way by itself.
        if unit.kind == "turning" and unit.last < inf:
            # The angle within the interval at which a force at this place takes most of the miss away.
            gx = X - unit.y * N
            gy = Y + unit.x * N
            middle = 0.5 * (unit.first + unit.last)
            width = 0.5 * (unit.last - unit.first)
            best = middle + clip(wrap(atan2(gy, gx) - middle), -width, width)
            helps = gx * cos(best) + gy * sin(best) > 0.0
            idle = f <= 1.01 * unit.least
            # Once on its way a unit keeps its aim until it is there.
            goes = (waited > _WAIT) & helps & idle & (abs(best - angle) > FAR)
            aim = where(goes & (turns < 0.5), best, aim)
            turns = where(goes, zero + 1.0, turns)
            unit, turns = on_its_way(unit, angle, aim, turns)
        units.append(unit)
        turning.append(turns)
        aims.append(aim)
    memory = DetourMemory(tuple(turning), tuple(aims), waited)
    return memory, design._replace(units=tuple(units))


def on_its_way(
    unit: AllocatedThruster, angle: Arithmetic, aim: Arithmetic, turns: Arithmetic
) -> tuple[AllocatedThruster, Arithmetic]:
    """A unit that turns idle to an aim.

    Parameters
    ----------
    unit : AllocatedThruster
        With its own interval of angles. [as its fields]
    angle, aim : float
        Where it is, and where it turns to. [rad, rad]
    turns : float
        1 while it is on its way, else 0. [1]

    Returns
    -------
    tuple of AllocatedThruster and float
        The unit, on its way with only the angles around its aim; and 0 where it has arrived, else as before.
        [as its fields, 1]

    References
    ----------
    Definition.
    """
    zero = 0.0 * turns
    # Outside of these angles the law takes the thrust away, then turns the unit there.
    first = clip(aim - _THERE, unit.first, unit.last)
    last = clip(aim + _THERE, unit.first, unit.last)
    turns = where(is_within(angle, first, last), zero, turns)
    moves = turns > 0.5
    first = where(moves, first, zero + unit.first)
    last = where(moves, last, zero + unit.last)
    return unit._replace(first=first, last=last), turns
