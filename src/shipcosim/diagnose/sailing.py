"""Ships that keep to a track under a DP, many at once, in array form.

Feedback is what a bridge would add to thrusters that are already told something: the logged speeds and directions, or
those of a planned manoeuvre.
"""

import numpy as np

from shipcosim.diagnose.plant import Drivers, Motion, motion_rates
from shipcosim.diagnose.thrusters import pusher_of

_FREQUENCY = 0.5  # rad/s times the square root of the length in m over gravity, of the DP: 0.09 rad/s on Gunnerus
_DAMPING = 0.8
_INTEGRAL = 0.1  # of the frequency
_ACROSS = 0.2  # how readily a unit turns, against how readily it changes its speed
_ANSWER = 4.0  # s, until the thrusters of a ship of 33.9 m do as told; others by the root of their length


def sailed(ships, count, track, record, dp, *, jolts=None, held=None):
    """Motion and thrusters of ships that a DP brings along a track.

    Parameters
    ----------
    ships : Plant
        The real ships; its numbers may be (m,) arrays.
    count : int
        Number of ships m.
    track : Motion
        (n,) or (m, n) arrays.
    record : Record
        What the thrusters are told anyway, (n,) or (m, n) arrays, and the wind.
    dp : Dp
    jolts : (n, 3, m) array, optional
        Changes of velocity at each row. [m/s, m/s, rad/s]
    held : dict of str to (n,) or (m, n) bool array, optional
        Where the DP has no say over a thruster.

    Returns
    -------
    tuple of Motion, dict of str to tuple of two arrays
        Motion, and speed and direction by thruster; (m, n) arrays.
    """
    h, n = record.step, record.time.size
    parts = record.substeps(ships)
    base = [record.drivers(ships, 0.5 * i / parts) for i in range(2 * parts)]
    ship = Motion(*(np.zeros(count) + value[..., 0] for value in track))
    integral, told = np.zeros((3, count)), {name: np.zeros((2, count)) for name in ships.thrusters}
    rows, units = [], {name: [] for name in ships.thrusters}
    for k in range(n):
        rows.append(ship)
        load, integral = dp.load(ship, Motion(*(value[..., k] for value in track)), integral)
        told = dp.answer(told, load, record, k, {name: where[..., k] for name, where in (held or {}).items()})
        for name, pair in dp.speeds(told, record, k).items():
            units[name].append(pair)
        if k < n - 1:
            told_now = {name: series[-1] for name, series in units.items()}
            for i in range(parts):
                ship = _moved(ship, base[2 * i : 2 * i + 2], k, told_now, ships, h / parts)
            if jolts is not None:
                ship = ship._replace(u=ship.u + jolts[k][0], v=ship.v + jolts[k][1], r=ship.r + jolts[k][2])
            ship = dp.bounded(ship)
    motion = Motion(*(np.stack(series, axis=-1) for series in zip(*rows, strict=True)))
    series = {name: tuple(np.stack(s, axis=-1) for s in zip(*pairs, strict=True)) for name, pairs in units.items()}
    return motion, series


def _moved(ship, base, k, units, plant, h):
    """The ships a step later, by the middle of the step."""

    def at(drivers):
        wind = (None, None) if drivers.wind_speed is None else (drivers.wind_speed[..., k], drivers.wind_from[..., k])
        return Drivers(drivers.time[k], units, *wind)

    first = motion_rates(ship, at(base[0]), plant)
    middle = Motion(*(value + 0.5 * h * rate for value, rate in zip(ship, first, strict=True)))
    rates = motion_rates(middle, at(base[1]), plant)
    return Motion(*(value + h * rate for value, rate in zip(ship, rates, strict=True)))


class Dp:
    """Proportional, derivative and slow integral action, shared out to the thrusters that the ship has.

    Parameters
    ----------
    plant : Plant
        The ship as the DP knows her.
    h : float
        Step. [s]
    fixed : collection of str
        Azimuth thrusters that cannot turn.
    """

    def __init__(self, plant, h, fixed=()):
        hull = plant.parts["hull"]
        self.pushers = {name: pusher_of(plant, name) for name in plant.thrusters}
        self.h, self.plant, self.fixed = h, plant, fixed
        self.frequency = _FREQUENCY * np.sqrt(9.81 / hull.length) / 3.0
        self.delay = _ANSWER * np.sqrt(hull.length / 33.9)
        self.mass = np.array([hull.mass + hull.A11, hull.mass + hull.A22, hull.inertia_yaw + hull.A66])
        self.most = 0.05 * self.mass * np.array([1.0, 1.0, 4.0 / hull.length])

    def bounded(self, ship):
        """The ships no faster than any ship is: one that a DP of this kind cannot steer gets lost, not infinite."""
        most = np.sqrt(9.81 * self.plant.parts["hull"].length)
        u, v, r = (np.clip(value, -most, most) for value in (ship.u, ship.v, ship.r * self.plant.parts["hull"].length))
        return ship._replace(u=u, v=v, r=r / self.plant.parts["hull"].length)

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

    def answer(self, told, load, record, k, held):
        """Change of each thruster's force along and across its axis, after a step."""
        forces = self.shared(load, {name: record.units[name][1][..., k] for name in told}, held)
        share = min(self.h / self.delay, 1.0)
        return {name: value + share * (forces[name] - value) for name, value in told.items()}

    def shared(self, load, azimuths, held):
        """A load on the ship as forces along and across the axes of her thrusters.

        Parameters
        ----------
        load : (3, m) array
        azimuths : dict of str to float or (m,) array
            Where each thruster points.
        held : dict of str to bool or (m,) bool array
            Thrusters that take no part.

        Returns
        -------
        dict of str to (2, m) array
            [N]
        """
        columns, places = [], []
        for name, azimuth in azimuths.items():
            unit = self.pushers[name]
            angle = unit.axis + (azimuth if unit.pointed else 0.0) + np.zeros(np.shape(azimuth))
            for i in range(2 if unit.turns and name not in self.fixed else 1):
                c, s = np.cos(angle + 0.5 * np.pi * i), np.sin(angle + 0.5 * np.pi * i)
                alone = held.get(name, False) if unit.ahead else True
                ease = np.where(alone, 0.0, _ACROSS if i else 1.0)
                columns.append(ease[..., None] * np.stack([c, s, unit.x * s - unit.y * c], axis=-1))
                places.append((name, i, ease))
        scale = np.array([1.0, 1.0, 4.0 / self.plant.parts["hull"].length])
        B = scale[:, None] * np.stack(np.broadcast_arrays(*columns), axis=-1)
        Bt = np.swapaxes(B, -1, -2)
        inner = np.linalg.solve(B @ Bt + 1e-2 * np.eye(3), (scale[:, None] * load).T[..., None])
        forces = (Bt @ inner)[..., 0].T
        found = {name: np.zeros((2, load.shape[1])) for name in azimuths}
        for (name, i, ease), force in zip(places, forces, strict=True):
            found[name][i] = ease * force
        return found

    def speeds(self, told, record, k):
        """Speed and direction of each thruster: those that it is told anyway, changed by what the DP adds."""
        found = {}
        for name, (along, across) in told.items():
            unit, n, azimuth = self.pushers[name], record.units[name][0][..., k], record.units[name][1][..., k]
            if not unit.ahead:
                found[name] = n + 0.0 * along, azimuth + 0.0 * along
                continue
            size, turn = self.force(name, n) + along, 0.0
            if unit.turns:
                # a unit that hardly pushes cannot be told by its direction: it keeps it
                turn = np.clip(across / np.maximum(np.abs(size), 0.02 * self.force(name, unit.most)), -0.5, 0.5)
            found[name] = np.clip(self.speed(name, size), -unit.most, unit.most), azimuth + turn * np.sign(size)
        return found

    def force(self, name, n):
        """Bollard thrust of a thruster at a speed in rev/s. [N]"""
        unit = self.pushers[name]
        return np.where(n >= 0, unit.ahead, unit.astern) * n * np.abs(n)

    def speed(self, name, force):
        """Speed at which a thruster has that thrust at the bollard. [rev/s]"""
        unit = self.pushers[name]
        return np.sign(force) * np.sqrt(np.abs(force) / np.where(force >= 0, unit.ahead, unit.astern))
