"""What the instruments say: in the loop of the DP, and at 1 Hz in the log."""

from dataclasses import dataclass

import numpy as np

from truth.plant import to_body, to_earth
from truth.weather import gauss_markov, wave_motion

MAST_HEIGHT = 10.0  # of the antenna above the roll axis, for ships that roll [m]
GAUSS_MARKOV = (
    (0.1, 240.0),
    (0.1, 240.0),
    (np.radians(0.1), 60.0),
)  # north, east, heading: [m or rad, s]
WHITE = np.array([0.2, 0.2, np.radians(0.1), 0.02, 0.02, np.radians(0.05), 0.02, np.radians(1.0)])
ROLES = {  # unit and resolution of the log
    "north": ("m", 0.01),
    "east": ("m", 0.01),
    "heading": ("deg", 0.1),
    "surge": ("m/s", 0.01),
    "sway": ("m/s", 0.01),
    "yaw_rate": ("deg/s", 0.01),
    "wind_speed": ("m/s", 0.1),
    "wind_from": ("deg", 1.0),
    "port_rpm": ("rpm", 0.1),
    "port_azimuth": ("deg", 0.1),
    "starboard_rpm": ("rpm", 0.1),
    "starboard_azimuth": ("deg", 0.1),
    "tunnel_rpm": ("rpm", 1.0),
}
RECORDED = ("x", "y", "psi", "u", "v", "r", "roll", "roll_rate")
THRUSTER_ROWS = ("port_rpm", "starboard_rpm", "tunnel_rpm", "port_azimuth", "starboard_azimuth")


@dataclass(frozen=True)
class Noise:
    """Noise of one log's instruments; the slow part is the same in the loop and in the log."""

    slow: np.ndarray  # (3, ticks) of north, east, heading [m, m, rad]
    loop: np.ndarray  # (8, ticks) white, as WHITE
    log: np.ndarray  # (8, rows) white, as WHITE
    thrusters: np.ndarray  # (5, rows) white, of THRUSTER_ROWS [rpm, rad]
    wind_mean: float  # over how long the wind sensor averages [s]


def draw_noise(rng, ticks, rows):
    """Noise of the sizes of nominal-model.md, within a fifth of them; the heading is off by some 0.05 deg for good."""
    size = rng.uniform(0.8, 1.2, 8)
    slow = [
        size[i] * std * gauss_markov(rng, ticks, 1.0, time)
        for i, (std, time) in enumerate(GAUSS_MARKOV)
    ]
    slow[2] = slow[2] + np.radians(0.05) * rng.standard_normal()
    fine = np.array([0.3, 0.3, 3.0, np.radians(0.1), np.radians(0.1)])
    return Noise(
        slow=np.array(slow),
        loop=(size * WHITE)[:, None] * rng.standard_normal((8, ticks)),
        log=(size * WHITE)[:, None] * rng.standard_normal((8, rows)),
        thrusters=fine[:, None] * rng.standard_normal((5, rows)),
        wind_mean=rng.uniform(2.0, 3.0),
    )


def antenna(state, sensor, sea, period, waves_to):
    """Position, heading, velocity and yaw rate as a noiseless receiver with the ship's sensor knobs gives them.

    Parameters
    ----------
    state : sequence of eight arrays
        As RECORDED. [m, m, rad, m/s, m/s, rad/s, rad, rad/s]
    sensor : sequence of seven arrays
        Rows of the knobs in ``knobs.SENSOR``.
    sea : complex array
        Elevation, see `weather.elevation`. [m]
    period, waves_to : float or array
        [s, rad]

    Returns
    -------
    tuple of six arrays
        North, east, heading (continuous), velocity north and east, yaw rate. [m, m, rad, m/s, m/s, rad/s]
    """
    x, y, psi, u, v, r, roll, roll_rate = state
    bias, lever_x, lever_y, velocity_scale, rate_scale, position_scale, _ = sensor
    surge, sway, yaw, surge_rate, sway_rate, yaw_rate = wave_motion(psi, sea, period, waves_to)
    total, rate = psi + yaw, r + yaw_rate
    body_north, body_east = to_earth(psi, surge, sway)
    arm_north, arm_east = to_earth(total, lever_x, lever_y + MAST_HEIGHT * roll)
    v_north, v_east = to_earth(psi, u + surge_rate, v + sway_rate)
    turn_north, turn_east = to_earth(
        total, -rate * lever_y, rate * lever_x + MAST_HEIGHT * roll_rate
    )
    return (
        position_scale * (x + body_north + arm_north),
        position_scale * (y + body_east + arm_east),
        total + bias,
        velocity_scale * (v_north + turn_north),
        velocity_scale * (v_east + turn_east),
        rate_scale * rate,
    )


def relative_wind(state, wind, offset):
    """Wind that a mast with a direction error feels, where it blows to: ahead and to starboard. [m/s]"""
    psi, u, v = state[2], state[3], state[4]
    ahead, starboard = to_body(psi, wind[0], wind[1])
    return to_earth(offset, ahead - u, starboard - v)


def loop_readings(state, sensor, sea, period, waves_to, wind, slow, white):
    """What the DP reads at one tick: position and heading (3, n), body velocity (3, n), relative wind (2, n)."""
    north, east, heading, v_north, v_east, rate = antenna(state, sensor, sea, period, waves_to)
    eta = np.array([north, east, heading]) + slow + white[:3]
    u, v = to_body(eta[2], v_north, v_east)
    ahead, starboard = relative_wind(state, wind, sensor[6])
    ahead, starboard = to_earth(white[7], ahead * (1 + white[6]), starboard * (1 + white[6]))
    return eta, np.array([u, v, rate]) + white[3:6], np.array([ahead, starboard])


def running_mean(series, window, h):
    """Mean over the last `window` seconds, on the last axis."""
    total = np.concatenate(
        [np.zeros((*series.shape[:-1], 1)), np.cumsum(series, axis=-1) * h], axis=-1
    )
    edges = h * np.arange(total.shape[-1])
    start = np.maximum(edges[1:] - window, 0.0)
    early = np.array([np.interp(start, edges, row) for row in total])
    return (total[:, 1:] - early) / (edges[1:] - start)


def log_channels(record, grid, when, conditions, wind, sea, noise):
    """Channels of a log before faults, resolution and dropouts.

    Parameters
    ----------
    record : dict of (m,) arrays and "sensor" (7, m)
        States as RECORDED, thrusters as THRUSTER_ROWS as they measure themselves, sensor knobs; at the times of grid.
    grid : (m,) array
        [s]
    when : tuple of three (rows,) arrays
        True times at which navigation, thrusters and wind of each row were sampled. [s]
    conditions : Weather
    wind, sea : (2, m) and complex (m,) array
        Wind at the mast and elevation at the times of grid.
    noise : Noise

    Returns
    -------
    dict
        Role to (rows,) array in the units of ROLES; heading and directions not yet wrapped.
    """
    navigation, thrusters, air = when
    state = [record[name] for name in RECORDED]
    at = [np.interp(navigation, grid, row) for row in state]
    sensor = [np.interp(navigation, grid, row) for row in record["sensor"]]
    water = np.interp(navigation, grid, sea.real) + 1j * np.interp(navigation, grid, sea.imag)
    north, east, heading, v_north, v_east, rate = antenna(
        at, sensor, water, conditions.wave_period, conditions.waves_to
    )
    ticks = grid[0] + np.arange(noise.slow.shape[1])
    slow = [np.interp(navigation, ticks, row) for row in noise.slow]
    heading = heading + slow[2] + noise.log[2]
    surge, sway = to_body(heading, v_north, v_east)
    felt = np.array(relative_wind(state, wind, record["sensor"][6]))
    ahead, starboard = (
        np.interp(air, grid, row) for row in running_mean(felt, noise.wind_mean, grid[1] - grid[0])
    )
    speed, towards = np.hypot(ahead, starboard), np.arctan2(starboard, ahead)
    units = {
        name: np.interp(thrusters, grid, record[name]) + noise.thrusters[i]
        for i, name in enumerate(THRUSTER_ROWS)
    }
    return {
        "north": north + slow[0] + noise.log[0],
        "east": east + slow[1] + noise.log[1],
        "heading": np.degrees(heading),
        "surge": surge + noise.log[3],
        "sway": sway + noise.log[4],
        "yaw_rate": np.degrees(rate + noise.log[5]),
        "wind_speed": speed * np.abs(1 + noise.log[6]),
        "wind_from": np.degrees(towards + noise.log[7]) + 180.0,
        "port_rpm": units["port_rpm"],
        "port_azimuth": np.degrees(units["port_azimuth"]),
        "starboard_rpm": units["starboard_rpm"],
        "starboard_azimuth": np.degrees(units["starboard_azimuth"]),
        "tunnel_rpm": units["tunnel_rpm"],
    }


def wrap_and_round(channels):
    """Headings and the wind in [0, 360), azimuths in [-180, 180), all at the resolution of the log."""
    done = {}
    for role, values in channels.items():
        step = ROLES[role][1]
        values = np.round(values / step) * step
        if role in ("heading", "wind_from"):
            values = np.mod(values, 360.0)
        elif role.endswith("azimuth"):
            values = np.mod(values + 180.0, 360.0) - 180.0
        done[role] = np.round(values, 6)
    return done


def drop_out(channels, rng):
    """Ordinary dropouts: now and then a group of channels misses up to 3 samples, and a row is lost altogether.

    Returns
    -------
    tuple
        Channels with NaN, and which rows are kept (rows,) bool.
    """
    rows = channels["north"].size
    groups = (
        ("north", "east"),
        ("heading",),
        ("wind_speed", "wind_from"),
        ("port_rpm", "port_azimuth"),
        ("tunnel_rpm",),
    )
    channels = {role: values.copy() for role, values in channels.items()}
    for _ in range(rng.poisson(3.0 * rows / 2400)):
        start, length, group = rng.integers(rows), rng.integers(1, 4), rng.integers(len(groups))
        for role in groups[group]:
            channels[role][start : start + length] = np.nan
    kept = np.ones(rows, bool)
    kept[rng.integers(1, rows - 1, rng.poisson(2.0 * rows / 2400))] = False
    return channels, kept
