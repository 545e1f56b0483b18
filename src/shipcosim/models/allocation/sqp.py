"""Thrusts and angles of any units by sequential quadratic programming, one convex program a step.

Around the last commands (f, α) the program of `box_qp` seeks changes (Δf, Δα) of least price that meet the request:

    Σ_i  c_i |f_i + Δf_i|^1.5 (to second order)  +  Σ_i q_i Δα_i² / 2  +  slack,
    Σ_i  b_i(α_i) Δf_i + f_i b_i'(α_i) Δα_i + s = τ - Σ_i b_i(α_i) f_i,      b(α) = (cos α, sin α, x sin α - y cos α)

with the limits of thrust, angle and their rates as bounds. q_i is the curvature of the power along α_i, f_i b_i·λ with
the last multipliers λ, times 1 + T/h, so that a unit turns towards the cheapest direction with the time constant T.
A second program for the thrusts alone, at the new angles, takes away the error of the linearised effect.

A unit stays within its interval of angles. Outside, as at the start, it gives no thrust and turns
to the nearer end. A unit that turns keeps at least its least thrust: it never reverses, and turning
has an effect at once. It may reverse only where another unit is missing: the remaining units could
not push the other way in time.
"""

from typing import Any, NamedTuple

from shipcosim.models.allocation.box_qp import Command, solve
from shipcosim.models.allocation.units import is_missed, no_thrust
from shipcosim.models.core.maths import (
    Arithmetic,
    clip,
    maximum,
    minimum,
    sincos,
    sqrt,
    where,
)
from shipcosim.models.core.motion import Load, Triple

_GENTLE = 0.02  # share of a unit's largest thrust below which its price is taken as quadratic
_STIR = 0.004  # share of a unit's largest thrust that turning reckons with at least, so that a unit at rest turns
_AT_END = 1e-9  # rad: an angle that turned to an end is beyond it by rounding alone
_TIGHT = 1e-6  # load that is missed for the dearest unit's price, over the largest thrust


class AllocatedThruster(NamedTuple):
    """A thruster as the law knows it.

    Parameters
    ----------
    x, y : float
        Place, forward and to starboard of the origin. [m]
    least, most : float
        Limits of thrust; `least` is 0 or more for a unit that turns, and negative for one that reverses. [N]
    least_degraded : float
        Least thrust where another unit is missing, negative where the unit may then reverse. [N]
    thrust_rate : float
        Quickest change of the thrust. [N/s]
    first, last : float
        Interval of angles, clockwise from the bow; without limits -inf, inf. [rad]
    azimuth_rate : float
        Quickest turning; 0 of a fixed direction. [rad/s]
    price : float
        Power over thrust^1.5, in any unit that is the same for all. [W/N^1.5]
    kind : str
        "turning", "fixed", or "none" where `most` is 0; `designed` sets it. A text, so that compiled code has one way
        for each unit. [1]
    largest : float
        Largest size of the thrust; `designed` sets it. [N]
    dearer_astern : float
        Price astern over that ahead, where the same full power gives another thrust; `designed` sets it. [1]
    """

    x: float
    y: float
    least: float
    most: float
    least_degraded: float
    thrust_rate: float
    first: float
    last: float
    azimuth_rate: float
    price: float
    kind: str = "none"
    largest: float = 0.0
    dearer_astern: float = 1.0


class OptimalProblem(NamedTuple):
    """Parameters in the form that a step needs.

    Parameters
    ----------
    units : tuple of AllocatedThruster
        The units, as `designed` completes them. [as of AllocatedThruster]
    turning_time : float
        Time constant of turning towards the cheapest direction. [s]
    yaw_lever, yaw_lever_degraded : float
        A missed yaw moment weighs as a missed force at this distance; the same where a unit is missing. [m]
    dearest : float
        Largest price of one newton more of a unit. [W/N]
    slack : float
        Load that is missed for a unit of price: so small that no price of power outweighs the request. [N per W/N]
    choice : ConeChoice, optional
        How `cones` chooses the intervals of angles; without it they stay. [as its fields]
    balance : Balance, optional
        Of all units, which tells whether those that are left hold position and heading. [as its fields]
    """

    units: tuple
    turning_time: float
    yaw_lever: float
    yaw_lever_degraded: float
    dearest: float
    slack: float
    choice: Any = None
    balance: Any = None


class Turned(NamedTuple):
    """State of the law.

    Parameters
    ----------
    thrusts, azimuths : tuple of floats or (...) arrays or tensors
        Commands of each unit; angles are not wrapped, so that they have no jumps. [N, rad]
    tau_X, tau_Y, tau_N : like a thrust
        Load of these commands, body frame. [N, N, N.m]
    saturated : bool or (...) array or tensor of bool
        True where limits or missing units keep the commands from meeting the request. [1]
    marginal : tuple of three, like a thrust
        Power that one unit more of each load would cost. [W/N, W/N, W/(N.m)]
    memory : ConeMemory or DetourMemory, optional
        What the choice of cones remembers, or which units are on a detour. [as its fields]
    average : Averaged, optional
        Request of the last minute. [as its fields]
    """

    thrusts: tuple
    azimuths: tuple
    tau_X: Arithmetic
    tau_Y: Arithmetic
    tau_N: Arithmetic
    saturated: Arithmetic
    marginal: tuple
    memory: Any = ()
    average: Any = ()


def designed(
    units: tuple, turning_time: float, yaw_lever: float, yaw_lever_degraded: float
) -> OptimalProblem:
    """Design for some units.

    Parameters
    ----------
    units : tuple of AllocatedThruster
        The units. [as of AllocatedThruster]
    turning_time, yaw_lever, yaw_lever_degraded : float
        As of `OptimalProblem`. [s, m, m]

    Returns
    -------
    OptimalProblem
        What `power_step` needs.

    References
    ----------
    Definition.
    """
    # Largest price of one more newton, d/df (c f^1.5) at full thrust: it scales the slack.
    dearest = max(1.5 * unit.price * sqrt(max(unit.most, -unit.least, 0.0)) for unit in units)
    dearest = max(dearest, 1e-9)
    slack = _TIGHT * max(unit.most for unit in units) / dearest
    units = tuple(map(_completed, units))
    return OptimalProblem(units, turning_time, yaw_lever, yaw_lever_degraded, dearest, slack)


def _completed(unit):
    """The unit with all quantities that follow from its limits, computed once."""
    turns = "turning" if unit.azimuth_rate > 0.0 else "fixed"
    # Astern a unit may have another limit at the same full power: the price is higher there.
    astern = -min(unit.least, unit.least_degraded)
    return unit._replace(
        kind=turns if unit.most > 0.0 else "none",
        largest=max(unit.most, -unit.least),
        dearer_astern=(unit.most / astern) ** 1.5 if astern > 0.0 else 1.0,
    )


def resting(tau: Load, azimuths: tuple) -> Turned:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    azimuths : tuple of floats
        Angles of the units. [rad]

    Returns
    -------
    Turned
        The state.

    References
    ----------
    Definition.
    """
    return Turned(*no_thrust(tau, azimuths), (0.0 * tau[0],) * 3)


def power_step(
    state: Turned,
    tau: Load,
    available: tuple,
    h: float,
    *,
    design: OptimalProblem,
    shares: tuple | None = None,
    parameters: Any = None,
) -> Turned:
    """Commands that meet a requested load at the least power, `h` after the last ones.

    Parameters
    ----------
    state : Turned
        State at the last commands.
    tau : tuple of three floats or (...) arrays or tensors
        Requested load, body frame. [N, N, N.m]
    available : tuple of bools or (...) arrays or tensors of bool
        Whether the units can be used; one that cannot gives 0 at once and keeps its angle. [1]
    h : float
        Time since the last commands, for the limits of the rates. [s]
    design : OptimalProblem
        The units.
    shares : tuple of floats or (...) arrays or tensors, optional
        Shares of their limits of thrust that power leaves to the units; what exceeds them is taken back at once,
        without limit of the rate. [1]
    parameters : any
        Of the FMU, as every law gets them; the design has what is needed of them. [as their fields]

    Returns
    -------
    Turned
        Commands and the load they give.

    References
    ----------
    Johansen, Fossen and Berge, Constrained nonlinear control allocation with singularity avoidance using sequential
    quadratic programming, IEEE Trans. Control Systems Technology 12(1), 2004. Instead of their price of a singular
    configuration, units that turn keep a least thrust.
    """
    whole = is_whole(available, design)
    # Units with their last commands and the bounds of the next.
    around = _around(state, available, whole, h, design, shares or (1.0,) * len(design.units))
    unmet, changes = _changes(around, tau, state.marginal, design, h)
    # A missed moment counts as a missed force at the lever; shorter levers put position first.
    lever = where(whole, design.yaw_lever, design.yaw_lever_degraded)
    slacks = (design.slack, design.slack, design.slack * lever * lever)
    solution, marginal = solve(unmet, changes, slacks)
    # Second program: thrusts alone at the new angles, which removes the error of linearising.
    turned = []
    forces = []
    near = []
    unmet = tau
    for at in around:
        # Command of this unit's thrust in the list of both kinds of changes.
        command = changes[len(changes) - len(solution)]
        near = [*near, solution[0]]
        solution = solution[1:]
        angle = at.azimuth
        # Apply the change of angle within the interval.
        if at.unit.kind == "turning":
            angle = clip(angle + solution[0], at.first, at.last)
            solution = solution[1:]
        # Effect at the new angle.
        effect = X, Y, N = _effect(at.unit, *sincos(angle))
        turned.append(angle)
        forces.append(command._replace(X=X, Y=Y, N=N))
        unmet = _less(unmet, effect, at.thrust)
    # Start from the first solution: it is near the second.
    solution = solve(unmet, forces, slacks, near)[0]
    thrusts = [
        clip(at.thrust + change, at.low, at.high)
        for at, change in zip(around, solution, strict=True)
    ]
    return _commanded(state, tau, around, thrusts, turned, forces, marginal, h, design)


def is_whole(available: tuple, design: OptimalProblem) -> Any:
    """Whether no unit is missing.

    Parameters
    ----------
    available : tuple
        As of `power_step`. [1]
    design : OptimalProblem
        The units. [as its fields]

    Returns
    -------
    bool, or like those of `available`
        True where all units that there are can be used. [1]

    References
    ----------
    Definition.
    """
    missing = sum(
        where(on, 0.0, 1.0)
        for on, unit in zip(available, design.units, strict=True)
        if unit.kind != "none"
    )
    return missing < 0.5


def _changes(around, tau, marginal, design, h):
    """Request less the load of the last commands, and the unknowns of the first program."""
    # Unknowns are the change of each thrust and, where it turns, of each angle.
    unmet = tau
    changes = []
    for at in around:
        unmet = _less(unmet, at.effect, at.thrust)
        ease, wanted, turn_ease = _cheapest(at, marginal, design, h)
        X, Y, N = at.effect
        changes.append(Command(X, Y, N, ease, wanted, at.low - at.thrust, at.high - at.thrust))
        # Turning by one radian moves the force across: f b'(alpha).
        if at.unit.kind == "turning":
            (X, Y, N) = at.turning
            # A unit almost at rest turns as if it had a little thrust, else it would never turn.
            stir = _STIR * at.unit.most
            f = where(abs(at.thrust) < stir, stir + 0.0 * at.thrust, at.thrust)
            changes.append(Command(f * X, f * Y, f * N, turn_ease, 0.0, at.left, at.right))
    return unmet, changes


def _commanded(state, tau, around, thrusts, turned, forces, marginal, h, design):
    """State after new commands."""
    zero = 0.0 * tau[0]
    all_thrusts = [zero] * len(state.thrusts)
    azimuths = list(state.azimuths)
    # Load that the new commands miss; moving is set while a unit is limited by its rate.
    unmet = tau
    moving = zero > 0.0
    for at, f, angle, force in zip(around, thrusts, turned, forces, strict=True):
        all_thrusts[at.index], azimuths[at.index] = f, angle
        unmet = _less(unmet, force[:3], f)
        moving = moving | (abs(f - at.thrust) > 0.999 * at.unit.thrust_rate * h)
        if at.unit.kind == "turning":
            moving = moving | (abs(angle - at.azimuth) > 0.999 * at.unit.azimuth_rate * h)
    # Saturated: the load is missed although no unit is still on its way.
    missed = is_missed(unmet, design.yaw_lever)
    X, Y, N = unmet
    load = (tau[0] - X, tau[1] - Y, tau[2] - N)
    return Turned(tuple(all_thrusts), tuple(azimuths), *load, missed & (moving == False), marginal)  # noqa: E712


class _Around(NamedTuple):
    """A unit with its last command and the bounds of the next."""

    index: int
    unit: AllocatedThruster
    thrust: Arithmetic
    azimuth: Arithmetic
    effect: Triple
    turning: Triple
    low: Arithmetic
    high: Arithmetic
    left: Arithmetic
    right: Arithmetic
    first: Arithmetic
    last: Arithmetic


def _around(state, available, whole, h, design, shares):
    """Units that exist, with their effects and bounds."""
    bounded_units = []
    units = zip(design.units, state.thrusts, state.azimuths, available, shares, strict=True)
    for index, (unit, f, angle, on, share) in enumerate(units):
        if unit.kind == "none":
            continue
        # Effect of the thrust at its angle, and derivative of the effect with the angle.
        s, c = sincos(angle)
        turning = (-s, c, unit.x * c + unit.y * s)
        # With a missing unit a unit may reverse, down to its degraded least thrust.
        bounds = _bounds(
            unit,
            f,
            angle,
            on,
            share * where(whole, unit.least, unit.least_degraded),
            share * unit.most,
            h,
        )
        bounded_units.append(_Around(index, unit, f, angle, _effect(unit, s, c), turning, *bounds))
    return bounded_units


def _bounds(unit, f, angle, on, least, most, h):
    """Bounds of the next thrust, of the change of the angle, and of the next angle."""
    # Thrust within its limits and its rate.
    reach = unit.thrust_rate * h
    reverses = least < 0.0
    high = minimum(most, f + reach)
    # A unit that never reverses moves up to its least thrust as fast as it can.
    low = where(
        reverses, clip(f - reach, least, most), minimum(clip(least, f - reach, f + reach), high)
    )
    high = where(reverses, clip(f + reach, least, most), high)
    # A fixed direction has no turning.
    if unit.kind == "fixed":
        return where(on, low, 0.0 * low), where(on, high, 0.0 * high), 0.0, 0.0, angle, angle
    # Inside its interval a unit turns at its rate, up to the ends.
    turn = unit.azimuth_rate * h
    end = clip(angle, unit.first, unit.last)
    inside = is_within(angle, unit.first, unit.last)
    # Outside, it first reduces its thrust to zero, then turns to the nearer end.
    fade = clip(0.0 * f, f - reach, f + reach)
    back = where(abs(f) > 0.0, 0.0 * angle, clip(end - angle, -turn, turn))
    left = where(inside, maximum(unit.first - angle, -turn), back)
    right = where(inside, minimum(unit.last - angle, turn), back)
    # A missing unit gives nothing at once and keeps its angle.
    return (
        where(on, where(inside, low, fade), 0.0 * f),
        where(on, where(inside, high, fade), 0.0 * f),
        where(on, left, 0.0 * f),
        where(on, right, 0.0 * f),
        where(inside, unit.first + 0.0 * f, angle + left),
        where(inside, unit.last + 0.0 * f, angle + right),
    )


def is_within(angle: Arithmetic, first: Arithmetic, last: Arithmetic) -> Any:
    """Whether an angle is in an interval or at its end, where rounding does not decide.

    Parameters
    ----------
    angle, first, last : float or (...) array or tensor
        The angle and the ends. [rad]

    Returns
    -------
    bool or (...) array or tensor of bool
        True within 1e-9 rad of the interval. [1]

    References
    ----------
    Definition.
    """
    return abs(clip(angle, first, last) - angle) < _AT_END


def _cheapest(at, marginal, design, h):
    """Ease and target of the change of thrust, and ease of turning, by the price of power."""
    # Slope of the price c |f|^1.5 is 1.5 c |f|^0.5.
    unit = at.unit
    f = at.thrust
    k = 1.5 * unit.price
    size = abs(f)
    # Below a small thrust the price is quadratic: its curvature stays finite.
    gentle = _GENTLE * unit.largest
    k = where(f < 0.0, k * unit.dearer_astern, k)
    # Quadratic price with the same slope and curvature: target and ease of the change.
    firm = maximum(size, gentle)
    root = sqrt(firm)
    above = where(size > gentle, 2.0, 1.0)
    ease = above * root / k
    wanted = -above * f
    if unit.kind == "fixed":
        return ease, wanted, 0.0
    # Curvature along the angle, f b . lambda, at least that of a small price.
    (X, Y, N) = at.effect
    (p, q, r) = marginal
    pull = X * p + Y * q + N * r
    pull = maximum(where(f < 0.0, -pull, pull), k * sqrt(gentle))
    # The factor 1 + T/h turns with the time constant T.
    return ease, wanted, 1.0 / (firm * pull * (1.0 + design.turning_time / h))


def _effect(unit: AllocatedThruster, s: Arithmetic, c: Arithmetic) -> Triple:
    """Load of one newton at an angle of given sine and cosine."""
    return c, s, unit.x * s - unit.y * c


def _less(tau, effect, f):
    """A load less that of a thrust."""
    return tau[0] - effect[0] * f, tau[1] - effect[1] * f, tau[2] - effect[2] * f
