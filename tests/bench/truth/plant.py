"""Motion of a batch of ships, from their momentum.

The state is the momentum of ship and water in the body frame (Kirchhoff's equations), not the velocity; two-step
Adams-Bashforth moves it and the trapezoidal rule the position. Every array is (n,), one entry per ship, or has the
ships on its last axis. SI and radians; body frame x forward, y to starboard, psi clockwise from north.
"""

from typing import NamedTuple

import numpy as np

from truth.ship import GRAVITY, STRIP_X, TOW_X
from truth.thrusters import tunnel_load, unit_loads

LIFT_X = -2.3
X = STRIP_X[:, None]
METACENTRIC_HEIGHT = 1.7
ROLL_INERTIA = 9.2e6
ROLL_DAMPING = 0.1 * 2 * np.sqrt(ROLL_INERTIA * 531e3 * GRAVITY * METACENTRIC_HEIGHT)
WIND_ARM, HULL_ARM, THRUSTER_ARM, SWAY_ARM = 5.0, 1.5, 3.0, 0.3


class Ship(NamedTuple):
    """State of a batch; velocities follow from the momentum and are kept because every load needs them."""

    x: np.ndarray
    y: np.ndarray
    psi: np.ndarray
    roll: np.ndarray
    roll_rate: np.ndarray
    u: np.ndarray  # over ground
    v: np.ndarray
    r: np.ndarray
    u_r: np.ndarray  # through the water
    v_r: np.ndarray
    momentum: tuple  # of three [kg m/s, kg m/s, kg m2/s]
    rates: tuple  # of the momentum and of psi, one step ago; empty at the start
    remembered: (
        np.ndarray
    )  # (3, n) velocity through the water that the force with a memory remembers
    rpm: np.ndarray  # (3, n) real speed of port, starboard and tunnel propeller
    azimuth: np.ndarray  # (2, n) real direction of the units


def at_rest(x, y, psi, rpm, azimuth, coefficients, knobs):
    """Ships that lie still over ground."""
    still = np.zeros_like(psi)
    u_c, v_c = to_body(psi, knobs.current_north, knobs.current_east)
    momentum = momenta(still, still, still, u_c, v_c, coefficients, knobs)
    remembered = np.array([-u_c, -v_c, still])
    return Ship(
        x,
        y,
        psi,
        still,
        still,
        still,
        still,
        still,
        -u_c,
        -v_c,
        momentum,
        (),
        remembered,
        rpm,
        azimuth,
    )


def to_body(psi, north, east):
    """Components ahead and to starboard of a vector given by north and east."""
    c, s = np.cos(psi), np.sin(psi)
    return c * north + s * east, c * east - s * north


def to_earth(psi, ahead, starboard):
    """Components north and east of a vector given in the body frame."""
    c, s = np.cos(psi), np.sin(psi)
    return c * ahead - s * starboard, s * ahead + c * starboard


def momenta(u, v, r, u_c, v_c, coefficients, knobs):
    """Momentum of the ship (by its speed over ground) and of the water (by the speed through it)."""
    a11, a22, a26, a66 = coefficients.added
    m, inertia = coefficients.mass * knobs.mass, coefficients.inertia * knobs.mass
    return (
        m * u + a11 * (u - u_c),
        m * v + a22 * (v - v_c) + a26 * r,
        inertia * r + a26 * (v - v_c) + a66 * r,
    )


def velocities(momentum, u_c, v_c, coefficients, knobs):
    """Speed ahead, to starboard and in yaw through the water that belong to a momentum."""
    a11, a22, a26, a66 = coefficients.added
    m, inertia = coefficients.mass * knobs.mass, coefficients.inertia * knobs.mass
    p_x, p_y, p_n = momentum
    p_y = p_y - m * v_c
    m22, m66 = m + a22, inertia + a66
    det = m22 * m66 - a26 * a26
    return (p_x - m * u_c) / (m + a11), (m66 * p_y - a26 * p_n) / det, (m22 * p_n - a26 * p_y) / det


def hull_load(u_r, v_r, r, coefficients, knobs):
    """Resistance, lift and cross flow, strip by strip, with any linear damping: (3 tuple)."""
    speed = np.abs(u_r)
    drag = coefficients.drag * knobs.drag * speed ** (coefficients.drag_power - 1) * u_r
    lift = coefficients.lift * speed * v_r
    flow = v_r + X * r
    strips = coefficients.strips * np.abs(flow) ** (coefficients.cross_flow_power - 1) * flow
    y = -knobs.crossflow * strips.sum(axis=0) - lift - knobs.damping * v_r
    n = -knobs.crossflow * (X * strips).sum(axis=0) - LIFT_X * lift
    linear = coefficients.damping
    return -drag - knobs.damping * u_r - linear[0] * u_r, y - linear[1] * v_r, n - linear[2] * r


def memory_load(nu_r, remembered, coefficients, h):
    """Load of the water's memory, (3, n), and what it remembers a step later: in slow motion an added mass, in quick a
    damping."""
    newer = nu_r - remembered
    load = -coefficients.memory / coefficients.memory_time * newer
    return load, remembered - np.expm1(-h / coefficients.memory_time) * newer


def wind_load(psi, u, v, north, east, coefficients, knobs):
    """Load of a wind that blows to (north, east) on the moving ship: (3, n)."""
    along, across = to_body(psi, north, east)
    along, across = along - u, across - v
    place = np.mod(np.arctan2(across, along), 2 * np.pi) * (18 / np.pi)
    left = np.minimum(place.astype(int), 35)
    ships = np.arange(psi.size)
    low, high = coefficients.wind[:, left, ships], coefficients.wind[:, left + 1, ships]
    return (low + (high - low) * (place - left)) * (
        (along * along + across * across) * knobs.wind_scale
    )


def roll_step(ship, wind_y, hull_y, thruster_y, wave_slope, rolls, h):
    """Roll angle and rate after a step; wave_slope is that of the water across the ship."""
    stiffness = 531e3 * GRAVITY * METACENTRIC_HEIGHT
    moment = WIND_ARM * wind_y - HULL_ARM * hull_y - THRUSTER_ARM * thruster_y
    moment = moment - stiffness * (ship.roll - wave_slope) - ROLL_DAMPING * ship.roll_rate
    rate = ship.roll_rate + h * rolls * moment / ROLL_INERTIA
    return ship.roll + h * rate, rate


def step(ship, rpm_target, azimuth_target, wind, wave_slope, coefficients, knobs, h):
    """Move a batch of ships on by h.

    Parameters
    ----------
    ship : Ship
    rpm_target, azimuth_target : (3, n), (2, n) array
        What the drives turn the propellers and units to, as they measure it. [rpm, rad]
    wind : tuple of two (n,) arrays
        Wind over ground, where it blows to. [m/s]
    wave_slope : (n,) array
        Slope of the water across the ship. [rad]
    coefficients : Coefficients
    knobs : Knobs
    h : float
        [s]

    Returns
    -------
    Ship
    """
    u, v, r, u_r, v_r = ship.u, ship.v, ship.r, ship.u_r, ship.v_r
    unit_x, unit_y, unit_n = unit_loads(u_r, v_r, r, ship.rpm, ship.azimuth, coefficients, knobs)
    tunnel = tunnel_load(u_r, ship.rpm[2], coefficients, knobs)
    hull_x, hull_y, hull_n = hull_load(u_r, v_r, r, coefficients, knobs)
    memory, remembered = memory_load(np.array([u_r, v_r, r]), ship.remembered, coefficients, h)
    air_x, air_y, air_n = wind_load(ship.psi, u, v, *wind, coefficients, knobs)
    pull_x, pull_y = to_body(ship.psi, knobs.pull_north, knobs.pull_east)
    load_x = unit_x + hull_x + air_x + pull_x + knobs.force_x + memory[0]
    load_y = unit_y + tunnel + hull_y + air_y + pull_y + knobs.force_y + memory[1]
    load_n = (
        unit_n
        + coefficients.tunnel_x * tunnel
        + hull_n
        + air_n
        + TOW_X * pull_y
        + knobs.moment
        + memory[2]
    )
    roll, roll_rate = roll_step(
        ship, air_y, hull_y, unit_y + tunnel, wave_slope, coefficients.rolls, h
    )
    load_y = load_y - coefficients.mass * SWAY_ARM * (roll_rate - ship.roll_rate) / h

    p_x, p_y, p_n = ship.momentum
    a11, a22, a26, _ = coefficients.added
    munk = v_r * (a11 * u_r) - u_r * (a22 * v_r + a26 * r)
    rates = (r * p_y + load_x, -r * p_x + load_y, munk + load_n, r)
    p_x, p_y, p_n, psi = (
        value + h * (1.5 * now - 0.5 * before)
        for value, now, before in zip(
            (*ship.momentum, ship.psi), rates, ship.rates or rates, strict=True
        )
    )
    u_c, v_c = to_body(psi, knobs.current_north, knobs.current_east)
    u_r, v_r, r = velocities((p_x, p_y, p_n), u_c, v_c, coefficients, knobs)
    north_before, east_before = to_earth(ship.psi, u, v)
    u, v = u_r + u_c, v_r + v_c
    north, east = to_earth(psi, u, v)
    return Ship(
        ship.x + h / 2 * (north + north_before),
        ship.y + h / 2 * (east + east_before),
        psi,
        roll,
        roll_rate,
        u,
        v,
        r,
        u_r,
        v_r,
        (p_x, p_y, p_n),
        rates,
        remembered,
        *turn_drives(ship.rpm, ship.azimuth, rpm_target, azimuth_target, coefficients, knobs, h),
    )


def turn_drives(rpm, azimuth, rpm_target, azimuth_target, coefficients, knobs, h):
    """Propeller speeds lag, units turn the shorter way at up to 10 deg/s; both follow what they measure."""
    rpm_target = rpm_target - knobs.rpm - coefficients.rpm_error
    azimuth_target = azimuth_target + knobs.azimuth + coefficients.azimuth_error
    rpm = rpm + (rpm_target - rpm) * -np.expm1(-h / coefficients.drive_time)
    turn = np.mod(azimuth_target - azimuth + np.pi, 2 * np.pi) - np.pi
    most = np.radians(10.0) * h
    return rpm, azimuth + np.clip(turn * -np.expm1(-h / 0.5), -most, most)
