"""Logs made up for the tests: a ship that moves by sums of sines, measured with noise, with a fault put in."""

import numpy as np

from shipcosim.series import make_table

UNITS = {
    "north": "m",
    "east": "m",
    "heading": "deg",
    "surge": "m/s",
    "sway": "m/s",
    "yaw_rate": "deg/s",
    "wind_speed": "m/s",
    "wind_from": "deg",
}


def smooth(time, seed, size, periods=(73.0, 110.0, 170.0, 310.0)):
    """Sum of sines with random phases."""
    phases = np.random.default_rng(seed).uniform(0.0, 2 * np.pi, len(periods))
    return size * sum(
        np.sin(2 * np.pi * time / period + phase)
        for period, phase in zip(periods, phases, strict=True)
    )


def measured(minutes=20, seed=0, rate=None, noise=1.0):
    """Channels of a log at 1 Hz, a dict of arrays; `rate`: true seconds per logged second in 400 to 600 s."""
    random = np.random.default_rng(seed)
    logged = np.arange(60.0 * minutes)
    pace = np.where((logged > 400.0) & (logged <= 600.0), rate or 1.0, 1.0)
    fine = np.arange(0.0, 60.0 * minutes * 1.5, 0.05)
    true = np.r_[0.0, np.cumsum(pace[1:])]
    heading, surge, sway = (
        smooth(fine, seed + 1, 30.0),
        smooth(fine, seed + 2, 0.25),
        smooth(fine, seed + 3, 0.1),
    )
    course = np.exp(1j * np.radians(heading))
    velocity = course * (surge + 1j * sway)
    position = np.cumsum(velocity) * 0.05
    apparent = (7.0 * np.exp(1j * np.radians(200.0)) + velocity) / course
    values = {
        "north": position.real,
        "east": position.imag,
        "heading": heading,
        "surge": surge,
        "sway": sway,
        "yaw_rate": np.gradient(heading, 0.05),
        "wind_speed": np.abs(apparent),
        "wind_from": np.degrees(np.angle(apparent)),
    }
    spread = {
        "north": 0.2,
        "east": 0.2,
        "heading": 0.1,
        "surge": 0.02,
        "sway": 0.02,
        "yaw_rate": 0.05,
    }
    spread |= {"wind_speed": 0.2, "wind_from": 2.0}
    log = {
        role: np.interp(true, fine, v) + noise * spread[role] * random.normal(size=len(logged))
        for role, v in values.items()
    }
    log["heading"], log["wind_from"] = (
        np.mod(log["heading"], 360.0),
        np.mod(log["wind_from"], 360.0),
    )
    return {"time": logged, **log}


def table(log):
    """The log as `read_log` would give it."""
    return make_table(
        log["time"], [(role, log[role], UNITS[role], role) for role in log if role != "time"]
    )
