"""Motion of a ship in surge, sway and yaw, in a current that is uniform and holds over a step."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from .hull import hull_loads
from .kinematics import eta_dot, to_body
from .load_tables import DRIFT_33M9
from .maths import rk4, substeps, wrap
from .quantity import quantity

_LONGEST_SUBSTEP = 0.1  # s; the fastest mode of both hulls, sway with yaw at full speed, decays in about 2 s


class Vessel(NamedTuple):
    """State of a ship.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position north and east, heading. [m, m, rad]
    u, v, r : like x
        Velocity over ground in body axes. [m/s, m/s, rad/s]
    """

    x: Any
    y: Any
    psi: Any
    u: Any
    v: Any
    r: Any


@dataclass(frozen=True)
class DriftParameters:
    """What the waves' mean drift finds to act on."""

    drift_table: str = quantity(
        DRIFT_33M9,
        "1",
        "rows 'omega heading X Y N': mean wave drift loads per squared amplitude, N/m2, N.m/m2, by frequency in rad/s "
        "and heading in deg, 0 following, 90 towards starboard, 180 head",
        "VERES at zero speed, lengthened hull, grade B",
    )


def step(vessel, tau_X, tau_Y, tau_N, current_north, current_east, h, *, hull):
    """The ship a step later.

    M_RB ν̇ + C_RB(ν) ν + M_A ν̇_r + C_A(ν_r) ν_r + D(ν_r) = τ. Seen from the water, which moves uniformly,
    this is the same law with ν_r in place of ν: it is integrated there (Runge-Kutta), the way of the water is added.

    Parameters
    ----------
    vessel : Vessel
        State at the start.
    tau_X, tau_Y, tau_N : like the state
        Loads from outside in body axes, held over the step. [N, N, N.m]
    current_north, current_east : like the state
        Velocity of the water, held over the step. [m/s]
    h : float
        Step, divided into equal parts of at most 0.1 s. [s]
    hull : HullParameters
        The hull.

    Returns
    -------
    Vessel
        State at the end.
    """

    def rates(x, y, psi, u_r, v_r, r):
        return *eta_dot(psi, u_r, v_r, r), *accelerations(u_r, v_r, r, tau_X, tau_Y, tau_N, hull=hull)

    u_r, v_r = through_water(vessel.psi, vessel.u, vessel.v, current_north, current_east)
    state = vessel.x, vessel.y, vessel.psi, u_r, v_r, vessel.r
    parts = substeps(h, _LONGEST_SUBSTEP)
    for _ in range(parts):
        state = rk4(rates, state, h / parts)
    x, y, psi, u_r, v_r, r = state
    u_c, v_c = to_body(psi, current_north, current_east)
    return Vessel(x + h * current_north, y + h * current_east, wrap(psi), u_r + u_c, v_r + v_c, r)


def accelerations(u_r, v_r, r, tau_X, tau_Y, tau_N, *, hull):
    """Rates of the velocity through the water.

    Parameters
    ----------
    u_r, v_r, r : float or (...) array or tensor
        Velocity through the water. [m/s, m/s, rad/s]
    tau_X, tau_Y, tau_N : like u_r
        Loads from outside. [N, N, N.m]
    hull : HullParameters
        The hull.

    Returns
    -------
    tuple of three, like u_r
        Rates of u_r, v_r, r in body axes. [m/s2, m/s2, rad/s2]
    """
    X, Y, N = hull_loads(u_r, v_r, r, hull=hull)
    m, xg = hull.rigid_body[0], hull.centre_of_gravity_x
    X = X + tau_X + m * r * (v_r + xg * r)
    Y = Y + tau_Y - m * r * u_r
    N = N + tau_N - m * xg * r * u_r
    i11, i22, i26, i62, i66 = hull.inverse_mass
    return i11 * X, i22 * Y + i26 * N, i62 * Y + i66 * N


def through_water(psi, u, v, current_north, current_east):
    """Velocity relative to the water.

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


def nu_dot(vessel, tau_X, tau_Y, tau_N, current_north, current_east, *, hull):
    """Rates of the velocity over ground; with ν̇_c = (r v_c, -r u_c, 0) of a constant current.

    Parameters as `step`.

    Returns
    -------
    tuple of three, like the state
        Rates of u, v, r in body axes. [m/s2, m/s2, rad/s2]
    """
    u_c, v_c = to_body(vessel.psi, current_north, current_east)
    u_dot, v_dot, r_dot = accelerations(vessel.u - u_c, vessel.v - v_c, vessel.r, tau_X, tau_Y, tau_N, hull=hull)
    return u_dot + vessel.r * v_c, v_dot - vessel.r * u_c, r_dot
