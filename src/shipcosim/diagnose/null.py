"""What healthy logs like this one score by chance: the ship keeps the log's track under a DP, many times over.

Each of the healthy ships differs from the modelled one within its tolerances and has noise as in the log. Feedback
moves thrusters and weather together, and a ship that keeps still moves by its noise alone: both can look like a cause,
and here nothing is wrong that could be one.
"""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.evidence import gram
from shipcosim.diagnose.linear import innovations
from shipcosim.diagnose.plant import Drivers, Motion, motion_rates, shown
from shipcosim.diagnose.ranking import gains, prepared, probes
from shipcosim.diagnose.record import Record, first_motion
from shipcosim.models.thruster import AzimuthParameters

_FREQUENCY = 0.5  # rad/s times the square root of the length in m over gravity, of the DP: 0.09 rad/s on Gunnerus
_DAMPING = 0.8
_INTEGRAL = 0.1  # of the frequency
_ACROSS = 0.2  # how readily a unit turns, against how readily it changes its speed
_ANSWER = 4.0  # s, until thrusters do as told
_SLOW_STD, _SLOW_TIME = np.array([0.1, 0.1, np.radians(0.1)]), np.array([240.0, 240.0, 60.0])


def null_gains(case, motion, wanted, *, count=50, seed=0, batch=10):
    """Gain of suspects on healthy logs like this one.

    Parameters
    ----------
    case : Case
    motion : Motion
        The log's track.
    wanted : sequence of Suspect
        Those that are asked for.
    count : int
        Number of healthy ships.
    seed : int
    batch : int
        How many are filtered at once.

    Returns
    -------
    dict of str to (m,) array
        By the suspect's label. [nats]
    """
    records = healthy_records(case, motion, count, np.random.default_rng(seed))
    case = replace(case, suspects=tuple(wanted), known_of=case.suspects)
    found = {suspect.label: [] for suspect in wanted}
    for first in range(0, count, batch):
        record = _some(records, slice(first, first + batch))
        here = prepared(replace(case, record=record, motion=first_motion(record, case.plant)), rounds=1)
        columns = case.known(())
        added = [column for suspect in wanted for group in probes(suspect) for column in group]
        linear = here.base_of([*columns, *added])
        for products in gram(innovations(linear, case.noise, record)).products:
            for gain, suspect, _ in gains(products, columns, np.zeros(len(columns)), wanted, case.plant):
                found[suspect.label].append(gain)
    return {label: np.array(values) for label, values in found.items()}


def _some(records, which):
    """Some of several logs."""
    units = {name: tuple(series[which] for series in pair) for name, pair in records.units.items()}
    return replace(records, measured=records.measured[which], units=units)


def healthy_records(case, motion, count, rng):
    """Logs of healthy ships that keep to a track in the log's weather.

    Parameters
    ----------
    case : Case
    motion : Motion
        The track, (n,) arrays.
    count : int
        Number of ships m.
    rng : numpy.random.Generator

    Returns
    -------
    Record
        With the ships on the first axis.
    """
    plant, record, noise = _drawn(case.plant, count, rng), case.record, case.noise
    h, n = record.step, record.time.size
    base = [record.drivers(plant, share) for share in (0.0, 0.5)]
    ship = Motion(*(np.repeat(value[0], count) for value in motion))
    integral, told = np.zeros((3, count)), {name: np.zeros((2, count)) for name in plant.thrusters}
    jolts = rng.standard_normal((n, 3, count)) * (np.asarray(noise.jolt) * np.sqrt(h))[:, None]
    rows, units = [], {name: [] for name in plant.thrusters}
    dp = _Dp(case.plant, h)
    for k in range(n):
        rows.append(np.stack(ship))
        want = Motion(*(value[k] for value in motion))
        load, integral = dp.load(ship, want, integral)
        told = dp.answer(told, load, record, k)
        for name, (n_k, azimuth) in dp.speeds(told, record, k).items():
            units[name].append((n_k, azimuth))
        if k < n - 1:
            ship = _moved(ship, base, k, {name: series[-1] for name, series in units.items()}, plant, h, jolts[k])
    return _logged(rows, units, plant, case, rng)


def _drawn(plant, count, rng):
    """Ships within the tolerances of a plant."""
    values = {
        path: plant.get(path) + tolerance * rng.standard_normal(count)
        for path, tolerance in plant.tolerances.items()
        if not path.startswith(("instruments.", "water."))
    }
    return plant.with_values(values)


def _moved(ship, base, k, units, plant, h, jolt):
    """The ships a step later, by the middle of the step."""

    def at(drivers):
        wind = (None, None) if drivers.wind_speed is None else (drivers.wind_speed[k], drivers.wind_from[k])
        return Drivers(drivers.time[k], units, *wind)

    first = motion_rates(ship, at(base[0]), plant)
    middle = Motion(*(value + 0.5 * h * rate for value, rate in zip(ship, first, strict=True)))
    rates = motion_rates(middle, at(base[1]), plant)
    moved = Motion(*(value + h * rate for value, rate in zip(ship, rates, strict=True)))
    return moved._replace(u=moved.u + jolt[0], v=moved.v + jolt[1], r=moved.r + jolt[2])


class _Dp:
    """Proportional, derivative and slow integral action, shared out to the thrusters that the ship has."""

    def __init__(self, plant, h):
        hull = plant.parts["hull"]
        self.h, self.plant = h, plant
        self.frequency = _FREQUENCY * np.sqrt(9.81 / hull.length) / 3.0
        self.mass = np.array([hull.mass + hull.A11, hull.mass + hull.A22, hull.inertia_yaw + hull.A66])
        self.most = 0.05 * self.mass * np.array([1.0, 1.0, 4.0 / hull.length])

    def load(self, ship, want, integral):
        """Load that brings the ships back to the track, in their body frames; and the integral action."""
        c, s = np.cos(ship.psi), np.sin(ship.psi)
        dx, dy = want.x - ship.x, want.y - ship.y
        error = np.stack([c * dx + s * dy, c * dy - s * dx, want.psi - ship.psi])
        rate = np.stack([want.u - ship.u, want.v - ship.v, want.r - ship.r])
        w = self.frequency
        integral = integral + self.h * _INTEGRAL * w * w * w * error
        wanted = self.mass[:, None] * (w * w * error + 2.0 * _DAMPING * w * rate + integral)
        return np.clip(wanted, -self.most[:, None], self.most[:, None]), integral

    def answer(self, told, load, record, k):
        """Change of each thruster's force along and across its axis, after a step."""
        columns, places = [], []
        for name in told:
            unit, azimuth = self.plant.parts[name], record.units[name][1][k]
            turns = isinstance(unit, AzimuthParameters)
            angle = azimuth if turns else 0.5 * np.pi
            y = getattr(unit, "y", 0.0)
            for i, a in enumerate((angle, angle + 0.5 * np.pi) if turns else (angle,)):
                c, s = np.cos(a), np.sin(a)
                ease = _ACROSS if i else 1.0
                columns.append(ease * np.array([c, s, unit.x * s - y * c]))
                places.append((name, i, ease))
        B = np.stack(columns, axis=1)
        scale = np.array([1.0, 1.0, 4.0 / self.plant.parts["hull"].length])[:, None]
        B = scale * B
        forces = B.T @ np.linalg.solve(B @ B.T + 1e-2 * np.eye(3), scale * load)
        share, new = min(self.h / _ANSWER, 1.0), {name: value.copy() for name, value in told.items()}
        for (name, i, ease), force in zip(places, forces, strict=True):
            new[name][i] += share * (ease * force - told[name][i])
        return new

    def speeds(self, told, record, k):
        """Speed and direction of each thruster: the logged ones, changed by what the DP adds."""
        found = {}
        for name, (along, across) in told.items():
            unit, n, azimuth = self.plant.parts[name], record.units[name][0][k], record.units[name][1][k]
            if isinstance(unit, AzimuthParameters):
                ahead, astern = unit.bollard[:2]
                force = (ahead if n >= 0 else astern) * n * abs(n)
                # a unit that hardly pushes cannot be told by its direction: it keeps it
                size = force + along
                turn = np.clip(across / np.maximum(np.abs(size), 0.02 * ahead * (unit.rpm_max / 60.0) ** 2), -0.5, 0.5)
                speed = np.sign(size) * np.sqrt(np.abs(size) / np.where(size >= 0, ahead, astern))
                most = unit.rpm_max / 60.0
                found[name] = (np.clip(speed, -most, most), azimuth + turn * np.sign(size))
            else:
                k_T, most = 3600.0 * unit.thrust_coefficient, unit.rpm_max / 60.0
                size = k_T * n * abs(n) + along
                found[name] = (np.clip(np.sign(size) * np.sqrt(np.abs(size) / k_T), -most, most), azimuth + 0.0 * along)
        return found


def _logged(rows, units, plant, case, rng):
    """The log of the ships' motion, with the noise of the case and slow errors of position and heading."""
    record, (n, count) = case.record, (len(rows), rows[0].shape[1])
    motion = Motion(*np.moveaxis(np.stack(rows), 1, 0))  # (n, m) each
    measured = np.stack(shown(motion, case.plant), axis=-1)
    measured += rng.standard_normal(measured.shape) * np.asarray(case.noise.white)
    keep = np.exp(-record.step / _SLOW_TIME)
    slow = _SLOW_STD * rng.standard_normal((count, 3))
    for k in range(n):
        measured[k, :, :3] += slow
        slow = keep * slow + np.sqrt(1.0 - keep**2) * _SLOW_STD * rng.standard_normal((count, 3))
    measured = np.where(np.isfinite(record.measured)[:, None, :], measured, np.nan)
    series = {name: tuple(np.stack(s, axis=-1) for s in zip(*pairs, strict=True)) for name, pairs in units.items()}
    return Record(record.time, np.moveaxis(measured, 1, 0), series, record.wind, record.known)
