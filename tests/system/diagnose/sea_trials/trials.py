"""Simulated sea trials: logs of ships with planted causes that sail straight legs, circles and a zig-zag by orders.

The ship is the model's, drawn within her tolerances: these logs say whether the inference is right, nothing about the
models. Their clock is bad: the true seconds between rows, 1 s by their stamps, wander between 0.75 and 1.2.
"""

import numpy as np
from diagnose import twin

from shipcosim.angles import wrap
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.models.core.motion import Motion
from shipcosim.models.propulsion.azimuth import turned
from shipcosim.series import make_table

FINE = 0.5  # s
RPM_LAG = 1.0  # s
WHITE = np.array([0.3, 0.3, np.radians(0.2), 0.03, 0.03, np.radians(0.05)])
ROLES = {
    "north": "m",
    "east": "m",
    "heading": "deg",
    "surge": "m/s",
    "sway": "m/s",
    "yaw_rate": "deg/s",
}
TO_LOG = (1.0, 1.0, 180.0 / np.pi, 1.0, 1.0, 180.0 / np.pi)
LEGS = (
    (20.0, 170.0),
    (-20.0, 170.0),
    (10.0, 170.0),
    (-10.0, 170.0),
    (32.0, 110.0),
    (-32.0, 110.0),
)  # deg, rpm
STRAIGHT, ROUND, SWING = 200.0, {20.0: 170.0, 10.0: 240.0, 32.0: 200.0}, 20.0  # s


def orders(time, slow=1.0):
    """Azimuth [rad] and speed [rpm] of the units that steer over time; all lasts longer by a factor."""
    azimuth, rpm, start = np.zeros(time.size), np.full(time.size, LEGS[0][1]), 0.0
    for angle, speed in LEGS:
        end = start + slow * (STRAIGHT + ROUND[abs(angle)])
        rpm[time >= start] = speed
        azimuth[(time >= start + slow * STRAIGHT) & (time < end)] = np.radians(angle)
        start = end
    start += slow * STRAIGHT
    for k in range(6):
        swing = (time >= start + k * slow * SWING) & (time < start + (k + 1) * slow * SWING)
        azimuth[swing] = np.radians(10.0) * (-1) ** k
    return azimuth, rpm


def duration(slow=1.0):
    """Of all of them. [s]"""
    return slow * (sum(STRAIGHT + ROUND[abs(angle)] for angle, _ in LEGS) + STRAIGHT + 8 * SWING)


def logs(problems, seed=0, model=None, slow=1.0, until=None):
    """Logs of ships with numbers changed, each also drawn within the tolerances of hull and thrusters.

    Parameters
    ----------
    problems : dict of str to dict of str to float
        By name, numbers of the ship and what they are; ``lag``: by how much the units answer late. [s]
    seed : int
    model : ShipModel, optional
        The lengthened Gunnerus without.
    slow : float
        Factor on all durations.
    until : float, optional
        End of the logs, that of the trials without. [s]

    Returns
    -------
    dict of str to xarray.Dataset
    """
    random, many = np.random.default_rng(seed), len(problems)
    model = model or twin.model()
    steered = [name for name in model.azimuths if model.parts[name].x < 0.0]
    ship = model.with_values(drawn(problems, random, model))
    lasts = duration(slow) if until is None else until
    time = np.arange(0.0, lasts, FINE)
    azimuth, rpm = orders(time, slow)
    lags = np.array([values.get("lag", 0.0) for values in problems.values()])
    zero = np.zeros(many)
    state = Motion(zero, zero, zero, zero + 5.4, zero, zero)
    angle, n, shown = zero, zero + rpm[0] / 60.0, []
    for now in time:
        shown.append(
            np.stack([np.broadcast_to(value, many) for value in readings(state, ship)], axis=1)
        )
        late = np.clip(((now - lags) / FINE).astype(int), 0, time.size - 1)
        angle = turned(angle, azimuth[late], np.radians(10.0) * FINE)
        n = rpm[late] / 60.0 + (n - rpm[late] / 60.0) * np.exp(-FINE / RPM_LAG)
        units = {name: (n, zero) for name in model.azimuths} | {
            name: (n, angle) for name in steered
        }
        units = {name: (zero, zero) for name in model.thrusters} | units
        state = _stepped(state, Inputs(now, units, None, None), ship)
    rate = 1.0 - 0.2 * np.sin(np.cumsum(random.normal(0.0, 0.05, int(lasts))))  # true seconds a row
    rows = np.minimum((np.cumsum(rate) / FINE).astype(int), time.size - 1)
    rows = rows[: np.argmax(rows >= time.size - 1) or None]
    found = np.stack(shown)[rows] + WHITE * random.standard_normal((rows.size, many, 6))
    tables = {}
    for i, name in enumerate(problems):
        found[:, i, 2] = wrap(found[:, i, 2]) % (2.0 * np.pi)
        columns = [
            (role, factor * values, unit, role)
            for (role, unit), factor, values in zip(
                ROLES.items(), TO_LOG, found[:, i].T, strict=True
            )
        ]
        for unit in model.azimuths:
            columns.append((f"{unit}_rpm", rpm[rows], "rpm", ""))
            angles = azimuth[rows] if unit in steered else np.zeros(rows.size)
            columns.append((f"{unit}_azimuth", np.degrees(angles), "deg", ""))
        tables[name] = make_table(np.arange(rows.size, dtype=float), columns)
    return tables


def drawn(problems, random, model):
    """Numbers of ships side by side: each with tolerances drawn anew and her planted numbers."""
    values = {}
    for path, size in model.tolerances.items():
        if path.partition(".")[0] in (model.vessel, *model.thrusters) and isinstance(
            model.get(path), float
        ):
            values[path] = model.get(path) + size * random.standard_normal(len(problems))
    planted = {path for changes in problems.values() for path in changes if path != "lag"}
    for path in planted:
        own = values.get(path, np.full(len(problems), model.get(path)))
        values[path] = np.array(
            [changes.get(path, one) for changes, one in zip(problems.values(), own, strict=True)]
        )
    return values


def _stepped(state, inputs, ship):
    """A midpoint step."""
    half = Motion(
        *(a + 0.5 * FINE * b for a, b in zip(state, motion_rates(state, inputs, ship), strict=True))
    )
    return Motion(
        *(a + FINE * b for a, b in zip(state, motion_rates(half, inputs, ship), strict=True))
    )
