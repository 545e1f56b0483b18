"""Equations of motion in surge, sway and yaw, in a uniform current held over a step.

References
----------
Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6; Skulstad, Data-based
modelling of ships for motion prediction and control allocation, NTNU, 2021, eq. 2.1 to 2.3.
"""

from dataclasses import dataclass

from shipcosim.angles import wrap
from shipcosim.models.core.integrate import rk4_motion, substeps
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic, times
from shipcosim.models.core.motion import Load, Motion, Triple, Vector
from shipcosim.models.core.parameters import required_table
from shipcosim.models.ship.hull import HullParameters, hull_loads

_LONGEST_SUBSTEP = (
    0.1  # s; the fastest mode of both hulls, sway with yaw at full speed, decays in about 2 s
)


@dataclass(frozen=True, kw_only=True)
class DriftParameters:
    """Wave drift coefficients."""

    drift_table: str = required_table(
        ("omega [rad/s]", "heading [deg]", "X [N/m2]", "Y [N/m2]", "N [N/m]"),
        "rows 'omega heading X Y N': mean wave drift loads per squared amplitude, N/m2, N.m/m2, by frequency in rad/s "
        "and heading in deg, 0 following, 90 towards starboard, 180 head",
    )


def step(
    vessel: Motion,
    tau_X: Arithmetic,
    tau_Y: Arithmetic,
    tau_N: Arithmetic,
    current_north: Arithmetic,
    current_east: Arithmetic,
    h: float,
    *,
    hull: HullParameters,
) -> Motion:
    """Motion of the ship one step later.

    M_RB ν̇ + C_RB(ν) ν + M_A ν̇_r + C_A(ν_r) ν_r + D(ν_r) = τ. Relative to the water, which moves uniformly, the
    equation is the same with ν_r in place of ν: it is integrated there by Runge-Kutta steps, and the way of the water
    is added.

    Parameters
    ----------
    vessel : Motion
        State at the start.
    tau_X, tau_Y, tau_N : like the state
        External loads in body axes, held over the step. [N, N, N.m]
    current_north, current_east : like the state
        Velocity of the water, held over the step. [m/s]
    h : float
        Step, divided into equal parts of at most 0.1 s. [s]
    hull : HullParameters
        The hull.

    Returns
    -------
    Motion
        State at the end.
    """

    # M ν̇_r + C(ν_r) ν_r + D(ν_r) ν_r = τ, with the loads held over the step.
    def rates(u_r, v_r, r):
        return accelerations(u_r, v_r, r, tau_X, tau_Y, tau_N, hull=hull)

    # Integrate in the frame of the water; its own displacement is added to the position.
    u_r, v_r = through_water(vessel.psi, vessel.u, vessel.v, current_north, current_east)
    x = vessel.x + h * current_north
    y = vessel.y + h * current_east
    psi = vessel.psi
    r = vessel.r
    # Sub-steps below the fastest mode of the hull.
    parts = substeps(h, _LONGEST_SUBSTEP)

    def turn(now):
        x, y, psi, u_r, v_r, r = now
        return rk4_motion(rates, x, y, psi, u_r, v_r, r, h / parts)

    x, y, psi, u_r, v_r, r = times(parts, turn, (x, y, psi, u_r, v_r, r))
    # Back to velocity over ground, at the new heading.
    u_c, v_c = to_body(psi, current_north, current_east)
    return Motion(x, y, wrap(psi), u_r + u_c, v_r + v_c, r)


def carried(
    vessel: Motion, change_north: Arithmetic, change_east: Arithmetic, *, hull: HullParameters
) -> Motion:
    """Motion of the ship right after the water has changed its velocity.

    Water that accelerates as one carries the ship: its pressure acts on her as on the water that she displaces, and the
    water around her adds its mass, (M_RB + M_A) ν̇_c if she floats freely. All of it (a share of 1) changes her velocity
    as the water's; none of it (0) lets her keep the velocity over ground that she had. In sway a share of
    A22/(m + A22) is the added mass alone, M_A ν̇_c.

    Parameters
    ----------
    vessel : Motion
        State before.
    change_north, change_east : like the state
        Change of the water's velocity. [m/s]
    hull : HullParameters
        Whose `current_acceleration` is that share.

    Returns
    -------
    Motion
        State after; the place is the same.

    References
    ----------
    Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 10, for M_A; Faltinsen,
    Sea Loads on Ships and Offshore Structures, Cambridge, 1990, for the pressure of the accelerated water.
    """
    # The water's change of velocity in body axes; the share is what carries the ship.
    u_c, v_c = to_body(vessel.psi, change_north, change_east)
    share = hull.current_acceleration
    x, y, psi, u, v, r = vessel
    return Motion(x, y, psi, u + share * u_c, v + share * v_c, r)


def accelerations(
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    tau_X: Arithmetic,
    tau_Y: Arithmetic,
    tau_N: Arithmetic,
    *,
    hull: HullParameters,
) -> Triple:
    """Rates of the velocity relative to the water, ν̇_r.

    Parameters
    ----------
    u_r, v_r, r : float or (...) array or tensor
        Velocity relative to the water and yaw rate. [m/s, m/s, rad/s]
    tau_X, tau_Y, tau_N : like u_r
        External loads. [N, N, N.m]
    hull : HullParameters
        The hull.

    Returns
    -------
    tuple of three, like u_r
        Rates of u_r, v_r, r in body axes. [m/s2, m/s2, rad/s2]
    """
    return _accelerations(
        hull_loads(u_r, v_r, r, hull=hull), u_r, v_r, r, tau_X, tau_Y, tau_N, hull
    )


def _accelerations(loads, u_r, v_r, r, tau_X, tau_Y, tau_N, hull):
    """`accelerations` from known hull loads."""
    X, Y, N = loads
    m = hull.rigid_body[0]
    xg = hull.centre_of_gravity_x
    # Rigid-body Coriolis and centripetal forces, C_RB(ν) ν, with the centre of gravity at x_G.
    X = X + tau_X + m * r * (v_r + xg * r)
    Y = Y + tau_Y - m * r * u_r
    N = N + tau_N - m * xg * r * u_r
    # Surge alone, sway and yaw coupled: ν̇_r = M⁻¹ τ.
    i11, i22, i26, i62, i66 = hull.inverse_mass
    return i11 * X, i22 * Y + i26 * N, i62 * Y + i66 * N


def through_water(
    psi: Arithmetic,
    u: Arithmetic,
    v: Arithmetic,
    current_north: Arithmetic,
    current_east: Arithmetic,
) -> Vector:
    """Velocity of the ship relative to the water.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    u, v : like psi
        Velocity over ground in body axes. [m/s]
    current_north, current_east : like psi
        Velocity of the water. [m/s]

    Returns
    -------
    tuple of two, like psi
        Components forward and to starboard. [m/s]

    Examples
    --------
    Lying still in a current to the south, heading north:

    >>> through_water(0.0, 0.0, 0.0, -0.5, 0.0)
    (0.5, 0.0)
    """
    u_c, v_c = to_body(psi, current_north, current_east)
    return u - u_c, v - v_c


def at_present(
    vessel: Motion,
    tau_X: Arithmetic,
    tau_Y: Arithmetic,
    tau_N: Arithmetic,
    current_north: Arithmetic,
    current_east: Arithmetic,
    *,
    hull: HullParameters,
) -> tuple[tuple, tuple, Load]:
    """Velocity through water, rates and hull loads at one time, from state and external loads.

    Parameters
    ----------
    vessel : Motion
        State.
    tau_X, tau_Y, tau_N : like the state
        External loads in body axes. [N, N, N.m]
    current_north, current_east : like the state
        Velocity of the water. [m/s]
    hull : HullParameters
        The hull.

    Returns
    -------
    relative : tuple of two, like the state
        Velocity relative to the water, u_r and v_r. [m/s]
    rates : tuple of three, like the state
        Of u, v, r over ground, ν̇ = ν̇_r + ν̇_c with ν̇_c = (r v_c, -r u_c, 0) of a constant current. [m/s2, m/s2, rad/s2]
    loads : tuple of three, like the state
        Loads of the water on the hull, as `hull.hull_loads`. [N, N, N.m]
    """
    u_c, v_c = to_body(vessel.psi, current_north, current_east)
    u_r = vessel.u - u_c
    v_r = vessel.v - v_c
    r = vessel.r
    # The hull loads are computed once, for the rates and as an output.
    loads = hull_loads(u_r, v_r, r, hull=hull)
    u_dot, v_dot, r_dot = _accelerations(loads, u_r, v_r, r, tau_X, tau_Y, tau_N, hull)
    # A constant current turns in body axes: ν̇_c = (r v_c, -r u_c, 0).
    return (u_r, v_r), (u_dot + r * v_c, v_dot - r * u_c, r_dot), loads
