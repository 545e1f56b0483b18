"""Logs of small agile craft, made by kinematics alone: what they do is drawn, no model of a craft is used."""

import numpy as np

FINE = 0.02  # step of the motion [s]
STYLES = ("spin", "circles", "zig-zag", "wander", "stop and go")
METRES_PER_DEGREE = 111195.0


def boat(seed, style=None, step=None, minutes=None, noise=1.0):
    """Channels of a log, a dict of (n,) arrays by role in the roles' units, with `time`; half of them have a wind.

    Parameters
    ----------
    seed : int
    style : str, optional
        One of STYLES.
    step : float, optional
        Time from row to row. [s]
    minutes : float, optional
        Length of the log.
    noise : float
        Factor on the noise of all sensors; 0 is the same log without noise and at full resolution.
    """
    rng = np.random.default_rng([seed, 88])
    style = style or str(rng.choice(STYLES))
    step = step or float(rng.choice([0.1, 0.2, 0.5, 1.0], p=[0.4, 0.3, 0.2, 0.1]))
    seconds = 60.0 * minutes if minutes else float(rng.uniform(90.0, 420.0))
    time = np.arange(0.0, seconds, FINE)
    rate, speed, drift = _orders(rng, style, time)
    rate, speed = _late(rate, rng.uniform(0.4, 1.2)), _late(speed, rng.uniform(1.0, 3.0))
    heading = np.radians(rng.uniform(0.0, 360.0)) + np.cumsum(rate) * FINE
    sway = -drift * rate * np.maximum(speed, 0.2) + 0.03 * _late(
        rng.normal(size=len(time)) / FINE**0.5, 4.0
    )
    velocity = (speed + 1j * sway) * np.exp(1j * heading)
    position = np.cumsum(velocity) * FINE
    apparent = (_wind(rng, time) + velocity) * np.exp(-1j * heading)
    rows = np.round(np.arange(0.0, time[-1], step) / FINE).astype(int)
    log = {
        "time": time[rows],
        "north": position.real[rows],
        "east": position.imag[rows],
        "heading": np.degrees(heading[rows]),
        "surge": speed[rows],
        "sway": sway[rows],
        "yaw_rate": np.degrees(rate[rows]),
        "wind_speed": np.abs(apparent)[rows],
        "wind_from": np.degrees(np.angle(apparent))[rows],
    }
    return _as_measured(log, rng, noise)


def _orders(rng, style, time):
    """Rate of turn and speed as ordered, (n,) arrays [rad/s, m/s], and how much the craft drifts."""
    top, hold = rng.uniform(0.6, 2.5), rng.uniform(3.0, 12.0)
    steps = (time / hold).astype(int)
    levels = rng.uniform(-1.0, 1.0, (2, steps[-1] + 1))
    if style == "spin":
        rate = rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2) * (1.0 + 0.1 * levels[0, steps])
        return rate, np.full(len(time), 0.1 * top), rng.uniform(0.0, 0.3)
    if style == "circles":
        side = np.sign(levels[0, (time / (8.0 * hold)).astype(int)])
        return side * rng.uniform(0.15, 0.5), np.full(len(time), top), rng.uniform(0.1, 0.6)
    if style == "zig-zag":
        return (
            np.where(steps % 2, -1.0, 1.0) * rng.uniform(0.1, 0.4),
            np.full(len(time), top),
            rng.uniform(0.1, 0.6),
        )
    if style == "wander":
        return 0.4 * levels[0, steps], top * (0.6 + 0.4 * levels[1, steps]), rng.uniform(0.1, 0.6)
    return 0.2 * levels[0, steps], np.where(levels[1, steps] > 0.0, top, 0.0), rng.uniform(0.1, 0.6)


def _late(series, time_constant):
    """Response of first order, by its step."""
    share = FINE / time_constant
    from scipy.signal import lfilter

    return lfilter([share], [1.0, share - 1.0], series, zi=[(1.0 - share) * series[0]])[0]


def _wind(rng, time):
    """The wind over ground, where it comes from, as a complex number north + i east. [m/s]"""
    mean = rng.uniform(2.0, 8.0) * np.exp(2j * np.pi * rng.random())
    gusts = [_late(rng.normal(size=len(time)) / FINE**0.5, 8.0) for _ in range(2)]
    return mean * (1.0 + 0.2 * (gusts[0] + 1j * gusts[1]))


def _as_measured(log, rng, noise):
    """The log with noise and resolution."""
    n = len(log["time"])
    spread = {"heading": rng.uniform(0.1, 1.0), "yaw_rate": rng.uniform(0.1, 1.0), "wind_from": 3.0}
    spread["surge"] = spread["sway"] = rng.uniform(0.01, 0.05)
    spread["north"] = spread["east"] = rng.choice([0.02, 0.3])
    log = log | {role: log[role] + noise * std * rng.normal(size=n) for role, std in spread.items()}
    log["wind_speed"] = log["wind_speed"] * np.abs(1.0 + noise * 0.05 * rng.normal(size=n))
    for role in ("north", "east") if rng.random() < 0.3 else ():
        grain = 1e-5 * METRES_PER_DEGREE  # position written with five decimals of a degree
        log[role] = grain * np.round(log[role] / grain) if noise else log[role]
    log["heading"], log["wind_from"] = (
        np.mod(log[role], 360.0) for role in ("heading", "wind_from")
    )
    if rng.random() < 0.5:
        log = {role: values for role, values in log.items() if not role.startswith("wind")}
    return log
