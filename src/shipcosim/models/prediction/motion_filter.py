"""Filter of a ship's motion that bridges a loss of GNSS, with learned parameters.

With GNSS it is an observer of position, velocity and the load that thrust and wind do not explain (current, wave drift,
errors of the model). Without, it integrates the same model, in which thrust and wind are measured and the load is held,
and fades to its mean of the last minutes. Loads are accelerations of the ship.
"""

from collections.abc import Mapping
from typing import NamedTuple

from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import Arithmetic, cos, exp, maximum, sin
from shipcosim.models.prediction.outage import Measured

SEA_TIME = 60.0  # s, over which the roughness of the sea is averaged; assumed


class FilterNumbers(NamedTuple):
    """Numbers of the filter.

    Parameters
    ----------
    bow, stern, ahead, astern : float or (...) array
        Acceleration by a thruster's squared command: to starboard of a tunnel, forward of a main propeller. [m/s2]
    surge_time, sway_time : like bow
        Time constants of the velocity, mass over damping. [s]
    wind_surge_1, wind_surge_3, wind_sway_1, wind_sway_3 : like bow
        Acceleration by squared apparent wind speed, of cos γ and cos 3γ forward, sin γ and sin 3γ to starboard. [1/m]
    position_by_position, position_by_velocity, velocity_by_position, velocity_by_velocity : like bow
        Gains in a calm: correction by innovation, a second. [1/s, 1, 1/s2, 1/s]
    load_by_position, load_by_velocity : like bow
        The same of the load. [1/s3, 1/s2]
    position_in_sea, velocity_in_sea, load_in_sea : like bow
        Gains are divided by 1 plus this times the variance of the sea. [s2/m2]
    load_time, mean_time : like bow
        Time in which the load fades to its mean while GNSS is lost, and over which the mean is taken. [s]
    """

    bow: Arithmetic
    stern: Arithmetic
    ahead: Arithmetic
    astern: Arithmetic
    surge_time: Arithmetic
    sway_time: Arithmetic
    wind_surge_1: Arithmetic
    wind_surge_3: Arithmetic
    wind_sway_1: Arithmetic
    wind_sway_3: Arithmetic
    position_by_position: Arithmetic
    position_by_velocity: Arithmetic
    velocity_by_position: Arithmetic
    velocity_by_velocity: Arithmetic
    load_by_position: Arithmetic
    load_by_velocity: Arithmetic
    position_in_sea: Arithmetic
    velocity_in_sea: Arithmetic
    load_in_sea: Arithmetic
    load_time: Arithmetic
    mean_time: Arithmetic


class State(NamedTuple):
    """State of the filter.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Position, without the motion in waves. [m]
    u, v : like x
        Velocity over ground in body axes. [m/s]
    load_north, load_east : like x
        Acceleration that thrust and wind do not explain. [m/s2]
    mean_north, mean_east : like x
        Its mean over the last minutes with GNSS. [m/s2]
    sea : like x
        Variance of velocity by GNSS about the filtered one. [m2/s2]
    lost_for : like x
        Time since GNSS was lost; 0 while it works. [s]
    """

    x: Arithmetic
    y: Arithmetic
    u: Arithmetic
    v: Arithmetic
    load_north: Arithmetic
    load_east: Arithmetic
    mean_north: Arithmetic
    mean_east: Arithmetic
    sea: Arithmetic
    lost_for: Arithmetic


def design(arrays: Mapping) -> FilterNumbers:
    """The filter's parameters from trained arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        By the names of `FilterNumbers`. [as Design]

    Returns
    -------
    FilterNumbers
        [as its fields]

    Raises
    ------
    KeyError
        A number is missing.

    References
    ----------
    Definition.
    """
    return FilterNumbers(*(float(arrays[name]) for name in FilterNumbers._fields))


def start(measured: Measured, *, design: FilterNumbers) -> State:
    """State at the start: at the position of GNSS, at rest.

    Parameters
    ----------
    measured : Measured
        Floats, (...) arrays or tensors.
    design : FilterNumbers
        Numbers of the filter; they give the shape alone.

    Returns
    -------
    State

    References
    ----------
    Definition.
    """
    zero = 0.0 * (measured.x + design.bow)
    return State(measured.x + zero, measured.y + zero, *(zero,) * 8)


def step(state: State, measured: Measured, h: float, *, design: FilterNumbers) -> State:
    """State one sample later.

    Parameters
    ----------
    state : State
        At the sample before; floats, (...) arrays or tensors.
    measured : Measured
        Measurements of now.
    h : float
        Time between the samples. [s]
    design : FilterNumbers
        Numbers of the filter.

    Returns
    -------
    State

    Notes
    -----
    In each body axis, with the time constant T and the acceleration a of thrust, wind and load,

        u <- u e^(-h/T) + a T (1 - e^(-h/T)),

    then position, velocity and load are corrected by the innovations of position and velocity, with less gain in a
    rougher sea.

    References
    ----------
    Observer with bias load: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021,
    ch. 13. Gains by the variance of the sea: assumed, of the form that a Kalman gain has over the noise.
    """
    d = design
    psi = measured.psi
    valid = measured.valid
    # Prediction: accelerations of thrust and wind, plus the estimated load turned into body axes.
    forward, side = _accelerations(measured, d)
    load = to_body(psi, state.load_north, state.load_east)
    u = _advanced(state.u, forward + load[0], d.surge_time, h)
    v = _advanced(state.v, side + load[1], d.sway_time, h)
    # Displacement with the mean of old and new velocity (trapezoidal rule).
    north, east = to_ned(psi, 0.5 * h * (state.u + u), 0.5 * h * (state.v + v))
    x = state.x + north
    y = state.y + east
    # Innovations of position and velocity in body axes; zero while GNSS is lost.
    ahead, sideways_error = (
        valid * error for error in to_body(psi, measured.x - x, measured.y - y)
    )
    faster = valid * (measured.u - u)
    sideways = valid * (measured.v - v)
    # Variance of the velocity innovation: mostly waves. A rough sea lowers all gains.
    sea = state.sea + h / SEA_TIME * valid * (
        0.5 * (faster * faster + sideways * sideways) - state.sea
    )
    # Correct position, velocity and load, each with gains of its own.
    k = h / (1.0 + d.position_in_sea * sea)
    north, east = to_ned(
        psi,
        k * (d.position_by_position * ahead + d.position_by_velocity * faster),
        k * (d.position_by_position * sideways_error + d.position_by_velocity * sideways),
    )
    x = x + north
    y = y + east
    k = h / (1.0 + d.velocity_in_sea * sea)
    u = u + k * (d.velocity_by_position * ahead + d.velocity_by_velocity * faster)
    v = v + k * (d.velocity_by_position * sideways_error + d.velocity_by_velocity * sideways)
    k = h / (1.0 + d.load_in_sea * sea)
    north, east = to_ned(
        psi,
        k * (d.load_by_position * ahead + d.load_by_velocity * faster),
        k * (d.load_by_position * sideways_error + d.load_by_velocity * sideways),
    )
    # Without GNSS the load fades to its mean; with GNSS the mean follows the load slowly.
    fades = (1.0 - valid) * (1.0 - exp(-h / d.load_time))
    follows = valid * (1.0 - exp(-h / d.mean_time))
    load_north = state.load_north + north + fades * (state.mean_north - state.load_north)
    load_east = state.load_east + east + fades * (state.mean_east - state.load_east)
    mean_north = state.mean_north + follows * (load_north - state.mean_north)
    mean_east = state.mean_east + follows * (load_east - state.mean_east)
    # Time since the loss, zero while GNSS works.
    lost_for = (1.0 - valid) * (state.lost_for + h)
    return State(x, y, u, v, load_north, load_east, mean_north, mean_east, sea, lost_for)


def _accelerations(measured, d):
    """Accelerations by thrust and wind, forward and to starboard."""
    bow_1, bow_2, stern_1, stern_2, port, starboard = measured.commands
    speed = measured.wind_speed
    wind_from = measured.wind_from
    # Loads of wind and thrusters grow with the square of wind speed and command.
    square = speed * speed
    # Main propellers: different coefficients ahead and astern.
    forward = d.ahead * (_ahead(port) + _ahead(starboard)) - d.astern * (
        _ahead(-port) + _ahead(-starboard)
    )
    # Wind by the first and third harmonic of its direction: even in surge, odd in sway.
    forward = forward + square * (
        d.wind_surge_1 * cos(wind_from) + d.wind_surge_3 * cos(3.0 * wind_from)
    )
    side = d.bow * (_signed(bow_1) + _signed(bow_2)) + d.stern * (
        _signed(stern_1) + _signed(stern_2)
    )
    return forward, side + square * (
        d.wind_sway_1 * sin(wind_from) + d.wind_sway_3 * sin(3.0 * wind_from)
    )


def _ahead(command):
    """Square of a command that is positive, else 0."""
    positive = maximum(command, 0.0 * command)
    return positive * positive


def _signed(command):
    """Square of a command with its sign."""
    return command * abs(command)


def _advanced(velocity, acceleration, time, h):
    """Velocity one sample later, with linear damping, exactly: u e^(-h/T) + a T (1 - e^(-h/T))."""
    kept = exp(-h / time)
    return velocity * kept + acceleration * time * (1.0 - kept)
