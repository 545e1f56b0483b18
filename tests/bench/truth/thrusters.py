"""Loads of the two azimuth units and the bow tunnel, from tables; rows are port, starboard and tunnel."""

import numpy as np

from truth.ship import BETA_STEP, PROPELLER_DIAMETER, WATER_DENSITY

DISC = np.pi / 4 * PROPELLER_DIAMETER**2
TIP = 0.7 * np.pi * PROPELLER_DIAMETER
UNITS = np.arange(2)[:, None]
OTHER_LIES = np.radians([[90.0], [-90.0]])  # where the other unit lies, from the bow


def axial_thrust(rpm, flow, coefficients):
    """Thrust along the axis (2, n) by the table, of units whose water meets them at `flow` along the axis."""
    tip = TIP / 60 * rpm
    place = (np.arctan2(flow, tip) + np.pi) / BETA_STEP
    left = np.minimum(place.astype(int), 143)
    ships = np.arange(rpm.shape[1])
    low = coefficients.propeller[UNITS, left, ships]
    coefficient = low + (coefficients.propeller[UNITS, left + 1, ships] - low) * (place - left)
    return 0.5 * WATER_DENSITY * DISC * (flow * flow + tip * tip) * coefficient


def side_force(rpm, along, across, coefficients):
    """Force across the axis (2, n): the jet's sideways momentum and the strut's drag and lift, each by its own."""
    spin = coefficients.side_spin * PROPELLER_DIAMETER / 60 * np.abs(rpm)
    flow = coefficients.side_flow * np.hypot(along, across)
    return -WATER_DENSITY * PROPELLER_DIAMETER**2 * (spin + flow) * across


def slipstream_factor(thrust, azimuth, knobs):
    """Factor on each unit's thrust from the other's slipstream, which leaves opposite to the thrust."""
    slip = azimuth + np.pi * (thrust > 0)
    miss = np.mod(slip - OTHER_LIES + np.pi, 2 * np.pi) - np.pi
    hit = np.exp(-0.5 * (miss / knobs.interaction_width) ** 2) * np.tanh(np.abs(thrust) / 1e3)
    return 1 - knobs.interaction * hit[::-1]


def lost_at_hull(thrust, azimuth, coefficients):
    """Share of each unit's thrust that the hull takes, (2, n), by the direction that it pushes to."""
    place = np.mod(azimuth + np.pi * (thrust < 0), 2 * np.pi) * (18 / np.pi)
    left = np.minimum(place.astype(int), 35)
    ships = np.arange(azimuth.shape[1])
    low = coefficients.hull_loss[UNITS, left, ships]
    return low + (coefficients.hull_loss[UNITS, left + 1, ships] - low) * (place - left)


def unit_loads(u_r, v_r, r, rpm, azimuth, coefficients, knobs):
    """Load of both units on ships that move through the water, (3 tuple of (n,)). [N, N, N m]"""
    x, y = coefficients.unit_x, coefficients.unit_y
    u, v = u_r - r * y, v_r + r * x
    c, s = np.cos(azimuth), np.sin(azimuth)
    along, across = c * u + s * v, c * v - s * u
    thrust = axial_thrust(rpm[:2], along, coefficients) * knobs.thrust[:2]
    thrust = thrust * np.where(rpm[:2] < 0, knobs.reverse_thrust, 1.0)
    if coefficients.hull_loss.any():
        thrust = thrust * (1 - lost_at_hull(thrust, azimuth, coefficients))
    if knobs.interaction.any():
        thrust = thrust * slipstream_factor(thrust, azimuth, knobs)
    side = side_force(rpm[:2], along, across, coefficients)
    force_x, force_y = c * thrust - s * side, s * thrust + c * side
    moment = x * force_y - y * force_x
    return force_x[0] + force_x[1], force_y[0] + force_y[1], moment[0] + moment[1]


def tunnel_load(u_r, rpm, coefficients, knobs):
    """Force of the tunnel thruster to starboard, (n,). [N]"""
    return (
        coefficients.tunnel
        * knobs.thrust[2]
        * rpm
        * np.abs(rpm)
        * np.exp(-((coefficients.tunnel_fading * u_r) ** 2))
    )
