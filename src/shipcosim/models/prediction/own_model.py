"""Equations of motion with the parts that a ship's own model lacks: residual load, thrust run-down.

Current, remaining load and the coefficients of a residual load that is linear in them (`wind_and_thrust_error`,
`damping_error`) are states beside the motion; `own_record` estimates them all.
"""

from collections.abc import Sequence
from typing import NamedTuple

from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, clip, exp, hypot, sqrt, where
from shipcosim.models.core.motion import Load, Vector
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.vessel import accelerations

COEFFICIENTS = (
    "surge_square",
    "surge_linear",
    "sway_square",
    "sway_linear",
    "yaw_by_sway_square",
    "yaw_by_sway_linear",
    "yaw_by_surge_sway",
    "yaw_square",
    "yaw_linear",
    "wind_X",
    "wind_Y",
    "wind_N",
    "wind_lever",
    "thrust_stern_X",
    "thrust_stern_Y",
    "thrust_bow",
    "wash_X",
    "wash_Y",
)
"""Coefficients of the residual load, in their order in the state."""
MEASURED = ("x", "y", "psi", "u", "v", "r")
"""States that the observer of the DP controller gives. [m, m, rad, m/s, m/s, rad/s]"""
STATES = (
    *MEASURED,
    "current_north",
    "current_east",
    "force_north",
    "force_east",
    "moment",
    *COEFFICIENTS,
)
"""States of the filter. [as `MEASURED`, m/s, m/s, N, N, N.m, 1]"""
CURRENT = slice(6, 8)
FORCE = slice(8, 10)
MOMENT = 10
COEFFICIENT = slice(11, None)
"""Their indices among the states. [1]"""
ARM = 0.42  # of the length, bow and stern thrusters from midships: assumed
SLOW = 0.2  # m/s, where linear and quadratic damping of one coefficient are alike
HELD = 1e4  # N, thrust at which run-down and wash are given
FASTEST = (20.0, 20.0, 1.0)
"""Surge, sway and yaw rate that no ship reaches here: there motion ends. [m/s, m/s, rad/s]"""
_TINY = 1e-6


class Learned(NamedTuple):
    """Prior knowledge learned over many ships, valid before this ship's record.

    Parameters
    ----------
    mean : (..., 18) array or tensor
        Expected coefficients. [1]
    std : (..., 29) array or tensor
        Standard deviations of all states at the start; of remaining force and moment at all times. [units of `STATES`]
    disturbance : (..., 2) array or tensor
        Random walk of the velocities u and v, and of r, in a second. [m/s, rad/s]
    noise : (..., 4) array or tensor
        Standard deviations of the observer's x and y, its heading, its u and v, and its r, each averaged over a second.
        [m, rad, m/s, rad/s]
    current_walk : (...) array or tensor
        Random walk of the current in a second. [m/s]
    force_time, moment_time, wind_time : like current_walk
        Correlation times of remaining force and moment, time constant of the mean of the wind. [s]
    lag : like current_walk
        Time constant with which thrust follows its command. [s]
    run_down_bow, run_down_stern : like current_walk
        Time in which thrust of 10 kN falls to a quarter when power is lost. [s]
    current_away : like current_walk
        Speed of the current in the four hypotheses that begin with one. [m/s]
    evidence : like current_walk
        Share of the likelihood of a second that tells hypotheses apart: errors of the observer last. [1]
    evidence_time : like current_walk
        Time in which it is forgotten. [s]
    """

    mean: Arithmetic
    std: Arithmetic
    disturbance: Arithmetic
    noise: Arithmetic
    current_walk: Arithmetic
    force_time: Arithmetic
    moment_time: Arithmetic
    wind_time: Arithmetic
    lag: Arithmetic
    run_down_bow: Arithmetic
    run_down_stern: Arithmetic
    current_away: Arithmetic
    evidence: Arithmetic
    evidence_time: Arithmetic


class Thrust(NamedTuple):
    """Delivered thrust: across at the bow, along and across at the stern.

    Parameters
    ----------
    bow, stern_X, stern_Y : float or (...) array or tensor
        [N, N, N]
    """

    bow: Arithmetic
    stern_X: Arithmetic
    stern_Y: Arithmetic


def thrust_told(thrusters: Load, hull: HullParameters) -> Thrust:
    """Thrust at bow and stern that gives a load.

    Parameters
    ----------
    thrusters : tuple of three floats or (...) arrays or tensors
        Load of all thrusters. [N, N, N.m]
    hull : HullParameters
        Whose length says where bow and stern are.

    Returns
    -------
    Thrust
        [N]

    References
    ----------
    Statics; port and starboard units are taken together.
    """
    # Two transverse forces at ± arm: Y = B + S, N = arm (B - S).
    X, Y, N = thrusters
    turning = N / (ARM * hull.length)
    return Thrust(0.5 * (Y + turning), X, 0.5 * (Y - turning))


def delivered(thrust: Thrust, command: Thrust, h: float, *, learned: Learned) -> Thrust:
    """Thrust a step later: it follows the command; without any command the propellers run down.

    Parameters
    ----------
    thrust : Thrust
        Delivered now; floats, (...) arrays or tensors.
    command : Thrust
        Commanded thrust.
    h : float
        Step. [s]
    learned : Learned
        Lag and times of running down.

    Returns
    -------
    Thrust
        Delivered then.

    Notes
    -----
    A free propeller is braked by its torque, which like its thrust is proportional to the square of its speed: 1/n
    grows evenly, and the thrust is that of now over (1 + h/T)², T in proportion to 1/n.

    References
    ----------
    Newton's law for a shaft with quadratic torque.
    """
    # All commands exactly zero means that power is lost.
    lost = (abs(command.bow) + abs(command.stern_X) + abs(command.stern_Y)) == 0.0
    share = 1.0 - exp(-h / learned.lag)
    # Shaft speed is proportional to the root of thrust, 1/n grows evenly: T(t) = T0 / (1 + t/τ)², τ ∝ 1/n.
    stern = sqrt((hypot(thrust.stern_X, thrust.stern_Y) + _TINY) / HELD)
    bow = sqrt((abs(thrust.bow) + _TINY) / HELD)
    slowed_stern = 1.0 + h * stern / learned.run_down_stern
    slowed_bow = 1.0 + h * bow / learned.run_down_bow
    factors = slowed_bow**-2, slowed_stern**-2, slowed_stern**-2
    # Lag of first order while there is power, run-down without.
    values = zip(thrust, command, factors, strict=True)
    return Thrust(
        *[where(lost, now * factor, now + share * (then - now)) for now, then, factor in values]
    )


def wind_and_thrust_error(
    coefficients: Sequence[Arithmetic], wind: Load, thrust: Thrust, hull: HullParameters
) -> Load:
    """Errors of the model's wind load and thrust: the part of the residual load that a step holds.

    Parameters
    ----------
    coefficients : sequence of 18 floats or (...) arrays or tensors
        In the order of `COEFFICIENTS`; those of wind and thrust count here, over the loads that the model has. [1]
    wind : tuple of three, like coefficients
        Wind load by the model. [N, N, N.m]
    thrust : Thrust
        Delivered, by the model. [N]
    hull : HullParameters
        Its length.

    Returns
    -------
    tuple of three, like coefficients
        [N, N, N.m]

    References
    ----------
    Statics.
    """
    c = coefficients
    # Errors of thrust at bow and stern act at the same arms.
    stern = c[14] * thrust.stern_Y
    bow = c[15] * thrust.bow
    # A side force of the wind may act at another place, told by a lever over a tenth of the length.
    N = c[11] * wind[2] + 0.1 * hull.length * c[12] * wind[1]
    return (
        c[9] * wind[0] + c[13] * thrust.stern_X,
        c[10] * wind[1] + stern + bow,
        N + ARM * hull.length * (bow - stern),
    )


def damping_error(
    coefficients: Sequence[Arithmetic],
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    wash: Arithmetic,
    hull: HullParameters,
) -> Load:
    """Hull loads that the ship's own model lacks, and the drag by the wash of running thrusters.

    Parameters
    ----------
    coefficients : sequence of 18 floats or (...) arrays or tensors
        In the order of `COEFFICIENTS`: of resistance, cross flow and turning over sizes that hulls have (of the
        length, draught and density), and of the wash, as a damping. [1]
    u_r, v_r, r : float or (...) array or tensor
        Velocity through the water and yaw rate. [m/s, m/s, rad/s]
    wash : like u_r
        Of the thrusters, by `wash_of`. [N]
    hull : HullParameters
        Length, draught, density.

    Returns
    -------
    tuple of three, like u_r
        [N, N, N.m]

    References
    ----------
    Forms of the terms: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 6;
    momentum drag of running thrusters in proportion to their speed, as `propulsion.azimuth`.
    """
    # The sizes ρ/2 L T (and lengths) make the coefficients dimensionless and of order one.
    c = coefficients
    length = hull.length
    size = 0.5 * hull.water_density * length * hull.draught
    # Yaw rate as the speed of bow and stern, so that all terms are forces.
    turn = length * r
    # Surge: quadratic and linear. 0.034 is the size that the resistance of hulls has.
    X = -0.034 * size * (c[0] * abs(u_r) + c[1] * SLOW) * u_r
    # Sway and yaw: cross flow, turning and Munk moment (c6 u v).
    Y = -size * (c[2] * abs(v_r) + c[3] * SLOW) * v_r
    N = (c[4] * abs(v_r) + c[5] * SLOW + c[6] * u_r) * v_r + (c[7] * abs(turn) + c[8] * SLOW) * turn
    # The wash drags at the stern.
    arm = ARM * length
    drag = -c[17] * wash * (v_r - arm * r)
    return X - c[16] * wash * u_r, Y + drag, -size * length * N - arm * drag


def wash_of(thrust: Thrust) -> Arithmetic:
    """Wash of running stern thrusters: momentum drag is in proportion to their speed, the root of thrust.

    Parameters
    ----------
    thrust : Thrust
        Delivered; floats or (...) arrays or tensors.

    Returns
    -------
    float or (...) array or tensor
        The thrust itself at `HELD`. [N]

    References
    ----------
    As `damping_error`.
    """
    return HELD * sqrt((hypot(thrust.stern_X, thrust.stern_Y) + _TINY) / HELD)


def moved(
    states: Sequence[Arithmetic],
    coefficients: Sequence[Arithmetic],
    air: Vector,
    thrust: Thrust,
    h: float,
    *,
    learned: Learned,
    hull: HullParameters,
    wind: WindParameters,
) -> list[Arithmetic]:
    """States a step later.

    Parameters
    ----------
    states : sequence of 11 floats or (...) arrays or tensors
        `STATES` but for the coefficients. [their units]
    coefficients : sequence of 18, like states
        `COEFFICIENTS`, which stay. [1]
    air : tuple of two, like states
        Velocity of the air, north and east. [m/s]
    thrust : Thrust
        Delivered in the middle of the step. [N]
    h : float
        Step. [s]
    learned : Learned
        Times in which remaining force and moment fade.
    hull, wind : HullParameters, WindParameters
        The ship's own model.

    Returns
    -------
    list of 11, like states
        [their units]

    Notes
    -----
    Midpoint rule; all that turns with the ship is taken at half the turn.

    References
    ----------
    Equations of motion as `ship.vessel`.
    """
    # Midpoint rule: everything that turns with the ship is evaluated at half the turn.
    half = 0.5 * h
    x, y, psi, u, v, r, current_north, current_east, force_north, force_east, moment = states
    middle = psi + half * r
    u_c, v_c = to_body(middle, current_north, current_east)
    # Wind, remaining force and thrust are held over the step, and so are their errors.
    load = wind_loads(*apparent_wind(middle, u, v, *air), wind=wind)
    force_X, force_Y = to_body(middle, force_north, force_east)
    error_X, error_Y, error_N = wind_and_thrust_error(coefficients, load, thrust, hull)
    X = load[0] + error_X + thrust.stern_X + force_X
    Y = load[1] + error_Y + thrust.stern_Y + thrust.bow + force_Y
    N = load[2] + error_N + ARM * hull.length * (thrust.bow - thrust.stern_Y) + moment
    wash = wash_of(thrust)

    def rates(u, v, r):
        # Damping depends on the velocity through the water, so it is evaluated within each stage.
        u_r = u - u_c
        v_r = v - v_c
        damping_X, damping_Y, damping_N = damping_error(coefficients, u_r, v_r, r, wash, hull)
        u_dot, v_dot, r_dot = accelerations(
            u_r, v_r, r, X + damping_X, Y + damping_Y, N + damping_N, hull=hull
        )
        # From rates through water to rates over ground: the current turns in body axes.
        return u_dot + r * v_c, v_dot - r * u_c, r_dot

    # Half a step, then the whole step with the slope of the middle.
    u_dot, v_dot, r_dot = rates(u, v, r)
    u_m = u + half * u_dot
    v_m = v + half * v_dot
    r_m = r + half * r_dot
    u_dot, v_dot, r_dot = rates(u_m, v_m, r_m)
    north, east = to_ned(psi + half * r_m, u_m, v_m)
    # Remaining force and moment are Gauss-Markov processes, whose mean decays.
    kept = exp(-h / learned.force_time)
    most_u, most_v, most_r = FASTEST
    return [
        x + h * north,
        y + h * east,
        psi + h * r_m,
        # Speeds are bounded, so a filter that diverges stays finite.
        clip(u + h * u_dot, -most_u, most_u),
        clip(v + h * v_dot, -most_v, most_v),
        clip(r + h * r_dot, -most_r, most_r),
        current_north,
        current_east,
        kept * force_north,
        kept * force_east,
        exp(-h / learned.moment_time) * moment,
    ]
