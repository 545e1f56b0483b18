"""Logs of a ship that moves by a made-up law, independent of the models: smooth moves, waves, sensor noise.

Faults are planted by functions of a log; each returns the log and what should be found.
"""

import numpy as np

FINE = 0.05  # [s] step of the smooth motion


def motion(rng, kind, duration):
    """Smooth position and heading of the ship as sampled functions of time: t, north, east, heading, all fine."""
    t = np.arange(0.0, duration + 40.0, FINE)
    if kind == "transit":
        return t, *_transit(rng, t)
    step, turn, every = {"trial": (25.0, 60.0, 150.0), "work": (8.0, 15.0, 300.0), "hold": (0.5, 1.0, 200.0)}[kind]
    north, east, heading = (np.zeros_like(t) for _ in range(3))
    at = 20.0
    goal = np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)])
    heading += goal[2]
    while at < t[-1]:
        move = np.array([*rng.normal(0.0, step, 2), np.radians(rng.normal(0.0, turn))])
        move *= rng.random(3) < 0.7
        rise = _rise(t - at, rng.uniform(50.0, 120.0))
        for value, size in zip((north, east, heading), move, strict=True):
            value += size * rise
        at += rng.uniform(0.6, 1.4) * every
    wander = [_wander(rng, t, 60.0) for _ in range(3)]
    return t, north + 0.15 * wander[0], east + 0.15 * wander[1], heading + np.radians(0.4) * wander[2]


def _rise(t, length):
    x = np.clip(t / length, 0.0, 1.0)
    return x**3 * (10.0 - 15.0 * x + 6.0 * x**2)


def _transit(rng, t):
    rate, speed = np.zeros_like(t), np.full_like(t, rng.uniform(2.0, 5.0))
    at = 60.0
    while at < t[-1]:
        length = rng.uniform(40.0, 120.0)
        pulse = _rise(t - at, 15.0) - _rise(t - at - length, 15.0)
        rate += np.radians(rng.normal(0.0, 1.2)) * pulse
        speed += rng.normal(0.0, 0.3) * _rise(t - at, 60.0)
        at += length + rng.uniform(60.0, 200.0)
    rate += np.radians(0.05) * _wander(rng, t, 30.0)
    heading = rng.uniform(-np.pi, np.pi) + np.cumsum(rate) * FINE
    course = heading - 0.3 * rate / np.radians(2.0) * 0.3
    return np.cumsum(speed * np.cos(course)) * FINE, np.cumsum(speed * np.sin(course)) * FINE, heading


def _wander(rng, t, length):
    """Smooth random function of unit size with that correlation time."""
    knots = np.arange(t[0] - 4 * length, t[-1] + 5 * length, length)
    from scipy.interpolate import CubicSpline

    return CubicSpline(knots, rng.normal(size=len(knots)))(t)


def waves(rng, t, height):
    """First-order motion: surge and sway [m], yaw [rad]."""
    peak = 2 * np.pi / rng.uniform(5.0, 9.0)
    omega = peak * rng.uniform(0.75, 1.6, 20)
    size = np.exp(-(((omega - peak) / (0.25 * peak)) ** 2)) + 0.05
    size *= height / 4 * np.sqrt(2) / np.sqrt(np.sum(size**2))
    phase = rng.uniform(0, 2 * np.pi, (3, 20))
    factors = rng.uniform(0.3, 0.9), rng.uniform(0.3, 0.9), np.radians(rng.uniform(0.4, 1.5))
    return [
        f * (size * np.sin(np.multiply.outer(t, omega) + p)).sum(axis=-1) for f, p in zip(factors, phase, strict=True)
    ]


def healthy(seed, kind="work", rate=1.0, minutes=40, height=None, lag=None, dropouts=True):
    """A log without any fault: dict of arrays with roles in the units of the contract (heading in [0, 360))."""
    rng = np.random.default_rng([seed, 77])
    duration = minutes * 60.0
    t, north, east, heading = motion(rng, kind, duration)
    surge, sway, yaw = waves(rng, t, rng.uniform(0.1, 1.2) if height is None else height)
    lever = rng.uniform(-3, 3, 2)
    heading = heading + yaw
    north = north + (surge + lever[0]) * np.cos(heading) - (sway + lever[1]) * np.sin(heading)
    east = east + (surge + lever[0]) * np.sin(heading) + (sway + lever[1]) * np.cos(heading)
    v_north, v_east, r = (np.gradient(x, FINE) for x in (north, east, heading))
    lag = rng.uniform(0.0, 0.3) if lag is None else lag
    v_north, v_east = (_delayed(t, x, lag) for x in (v_north, v_east))
    time = np.arange(0.0, duration, 1.0 / rate)
    here = np.round(time / FINE).astype(int)
    n = len(time)
    bias = np.radians(rng.normal(0.0, 1.0))
    slow, white = rng.uniform(0.02, 0.15), rng.uniform(0.02, 0.2)
    psi = heading[here] + bias + np.radians(rng.uniform(0.02, 0.1)) * rng.normal(size=n)
    psi = psi + np.radians(0.1) * _wander(rng, time, 60.0)
    speed_noise = rng.uniform(0.005, 0.03)
    vn, ve = (v[here] + speed_noise * rng.normal(size=n) for v in (v_north, v_east))
    log = {
        "time": time,
        "north": north[here] + slow * _wander(rng, time, 150.0) + white * rng.normal(size=n),
        "east": east[here] + slow * _wander(rng, time, 150.0) + white * rng.normal(size=n),
        "heading": np.degrees(psi) % 360.0,
        "surge": vn * np.cos(psi) + ve * np.sin(psi),
        "sway": -vn * np.sin(psi) + ve * np.cos(psi),
        "yaw_rate": np.degrees(r[here]) + rng.uniform(0.01, 0.06) * rng.normal(size=n) + rng.normal(0.0, 0.005),
    }
    if rng.random() < 0.5:
        for role, quantum in {"north": 0.01, "east": 0.01, "heading": 0.1, "surge": 0.01, "sway": 0.01}.items():
            log[role] = np.round(log[role] / quantum) * quantum
        log["heading"] %= 360.0
    if dropouts:
        keep = rng.random(n) > rng.uniform(0.0, 0.02)
        for _ in range(rng.integers(0, 4)):
            start = rng.integers(0, n)
            keep[start : start + int(rng.uniform(1, 6) * rate)] = False
        keep[0] = True
        log = {role: values[keep] for role, values in log.items()}
    return log


def _delayed(t, values, lag):
    return np.interp(t - lag, t, values)
