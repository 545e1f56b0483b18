"""Explicit one-step integration of ordinary differential equations: Euler, midpoint, Runge-Kutta.

`euler` and `rk4` take any state. `rk4_pair`, `rk4_motion` and `midpoint_motion` are the same rules written out for the
states that every FMU step integrates, without loops over the state: about twice as fast in floats.
"""

from collections.abc import Callable, Sequence
from math import ceil

from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Vector

_EXACT = 1e-9  # share of a sub-step by which a step may exceed a whole number of them by rounding


def substeps(h: float, longest: float) -> int:
    """Number of equal sub-steps that make up a step.

    Parameters
    ----------
    h : float
        Step. [s]
    longest : float
        Longest sub-step, above 0. [s]

    Returns
    -------
    int
        Number of sub-steps, at least 1. [1]

    References
    ----------
    Definition.

    Examples
    --------
    >>> substeps(0.05, 0.05), substeps(0.1, 0.03)
    (1, 4)
    """
    # Recorded numbers have their own functions; the rounding margin is the same.
    maths = getattr(h, "maths", None)
    if maths is not None:
        return maths.maximum(maths.whole(ceil(h / longest - _EXACT)), 1)
    return max(1, ceil(h / longest - _EXACT))


def euler(state: Sequence, rates: Sequence, h: float) -> tuple:
    """The state one explicit Euler step later, y + h ẏ.

    Parameters
    ----------
    state : sequence of float or (...) array or tensor
        Values at the start. [any unit]
    rates : sequence like state
        Time derivatives at the start. [that unit/s]
    h : float
        Step. [s]

    Returns
    -------
    tuple like state
        Values at the end. [the unit of state]

    References
    ----------
    Definition of the explicit Euler method.

    Examples
    --------
    >>> euler((1.0, 0.0), (0.5, 2.0), 0.1)
    (1.05, 0.2)
    """
    return tuple([y + h * rate for y, rate in zip(state, rates, strict=True)])


def rk4(
    rates: Callable, state: Sequence, h: float, inputs: Sequence[tuple] = ((), (), ())
) -> tuple:
    """The state one step of the classical Runge-Kutta method of fourth order later.

    Parameters
    ----------
    rates : callable
        ``rates(*state, *inputs)`` gives the sequence of time derivatives. [unit of state/s]
    state : sequence of float or (...) array or tensor
        Values at the start. [any unit]
    h : float
        Step. [s]
    inputs : sequence of three tuples
        Further arguments of the rates: at the start, the middle and the end of the step. [any unit]

    Returns
    -------
    tuple like state
        Values at the end. [the unit of state]

    References
    ----------
    Definition of the classical Runge-Kutta method.

    Examples
    --------
    Decay over one time constant, a tenth at a time, against 1/e = 0.367879:

    >>> y = (1.0,)
    >>> for _ in range(10):
    ...     y = rk4(lambda y: (-y,), y, 0.1)
    >>> round(y[0], 6)
    0.36788
    """
    # k1 at the start, k2 and k3 in the middle, k4 at the end, weighted 1 : 2 : 2 : 1.
    start, middle, end = inputs
    half = 0.5 * h
    sixth = h / 6.0
    k1 = rates(*state, *start)
    k2 = rates(*euler(state, k1, half), *middle)
    k3 = rates(*euler(state, k2, half), *middle)
    k4 = rates(*euler(state, k3, h), *end)
    slopes = zip(state, k1, k2, k3, k4, strict=True)
    return tuple([y + sixth * (a + 2.0 * (b + c) + d) for y, a, b, c, d in slopes])


def rk4_pair(
    rates: Callable, x: Arithmetic, y: Arithmetic, h: float, start: tuple, middle: tuple, end: tuple
) -> Vector:
    """`rk4` of two variables, written out.

    Parameters
    ----------
    rates : callable
        ``rates(x, y, *inputs)`` gives the two time derivatives. [unit of x/s, unit of y/s]
    x, y : float or (...) array or tensor
        Values at the start. [any units]
    h : float
        Step. [s]
    start, middle, end : tuples
        Further arguments of the rates, at these times of the step. [any unit]

    Returns
    -------
    tuple of two, like x and y
        Values at the end. [the units of x and y]

    References
    ----------
    As `rk4`.
    """
    # The scheme of `rk4`, with the slopes of x (a, b, c, d) and y (p, q, r, s) as variables.
    half = 0.5 * h
    sixth = h / 6.0
    a, p = rates(x, y, *start)
    b, q = rates(x + half * a, y + half * p, *middle)
    c, r = rates(x + half * b, y + half * q, *middle)
    d, s = rates(x + h * c, y + h * r, *end)
    return x + sixth * (a + 2.0 * (b + c) + d), y + sixth * (p + 2.0 * (q + r) + s)


def rk4_motion(
    accelerations: Callable,
    x: Arithmetic,
    y: Arithmetic,
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    h: float,
) -> tuple:
    """`rk4` of η̇ = R(ψ) ν, ν̇ = f(ν), written out.

    Parameters
    ----------
    accelerations : callable
        ``accelerations(u, v, r)`` gives f. [m/s2, m/s2, rad/s2]
    x, y, psi : float or (...) array or tensor
        Position and heading at the start. [m, m, rad]
    u, v, r : like x
        Velocity in body axes at the start. [m/s, m/s, rad/s]
    h : float
        Step. [s]

    Returns
    -------
    tuple of six, like x
        x, y, psi, u, v, r at the end; psi is not wrapped. [m, m, rad, m/s, m/s, rad/s]

    References
    ----------
    As `rk4`. η̇ = R(ψ) ν: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021,
    ch. 2.
    """
    # Velocities first: their rates do not depend on position and heading.
    half = 0.5 * h
    sixth = h / 6.0
    u1, v1, r1 = accelerations(u, v, r)
    ub = u + half * u1
    vb = v + half * v1
    rb = r + half * r1
    u2, v2, r2 = accelerations(ub, vb, rb)
    uc = u + half * u2
    vc = v + half * v2
    rc = r + half * r2
    u3, v3, r3 = accelerations(uc, vc, rc)
    ud = u + h * u3
    vd = v + h * v3
    rd = r + h * r3
    u4, v4, r4 = accelerations(ud, vd, rd)
    # Then the rates of position at the four stages, with the heading of each stage.
    x1, y1 = to_ned(psi, u, v)
    x2, y2 = to_ned(psi + half * r, ub, vb)
    x3, y3 = to_ned(psi + half * rb, uc, vc)
    x4, y4 = to_ned(psi + h * rc, ud, vd)
    return (
        x + sixth * (x1 + 2.0 * (x2 + x3) + x4),
        y + sixth * (y1 + 2.0 * (y2 + y3) + y4),
        psi + sixth * (r + 2.0 * (rb + rc) + rd),
        u + sixth * (u1 + 2.0 * (u2 + u3) + u4),
        v + sixth * (v1 + 2.0 * (v2 + v3) + v4),
        r + sixth * (r1 + 2.0 * (r2 + r3) + r4),
    )


def midpoint_motion(
    accelerations: Callable,
    x: Arithmetic,
    y: Arithmetic,
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    r: Arithmetic,
    h: float,
    current_north: Arithmetic = 0.0,
    current_east: Arithmetic = 0.0,
) -> tuple:
    """η̇ = R(ψ) ν + (V_c, 0), ν̇ = f(ν) by the explicit midpoint rule, of second order, written out.

    Parameters
    ----------
    accelerations : callable
        ``accelerations(u, v, r)`` gives f. [m/s2, m/s2, rad/s2]
    x, y, psi : float or (...) array or tensor
        Position and heading at the start. [m, m, rad]
    u, v, r : like x
        Velocity relative to the water in body axes at the start. [m/s, m/s, rad/s]
    h : float
        Step. [s]
    current_north, current_east : like x
        Velocity V_c of the water. [m/s]

    Returns
    -------
    tuple of six, like x
        x, y, psi, u, v, r at the end; psi is not wrapped. [m, m, rad, m/s, m/s, rad/s]

    References
    ----------
    Definition of the explicit midpoint rule.
    """
    # Half a step with the slope at the start, then a whole step with the slope in the middle.
    half = 0.5 * h
    u_dot, v_dot, r_dot = accelerations(u, v, r)
    u_mid = u + half * u_dot
    v_mid = v + half * v_dot
    r_mid = r + half * r_dot
    u_dot, v_dot, r_dot = accelerations(u_mid, v_mid, r_mid)
    # The heading of the middle turns the velocity through the water; the current is added.
    north, east = to_ned(psi + half * r, u_mid, v_mid)
    return (
        x + h * (north + current_north),
        y + h * (east + current_east),
        psi + h * r_mid,
        u + h * u_dot,
        v + h * v_dot,
        r + h * r_dot,
    )
