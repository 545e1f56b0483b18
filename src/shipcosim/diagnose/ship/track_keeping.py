"""Ships that a DP controller keeps on a track, many at once, in array form.

The controller adds its feedback to what the thrusters do anyway: the logged speeds and directions, or those of a
planned manoeuvre.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Record, ThrusterSeries
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.integrate import euler
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Motion

_FREQUENCY = 0.5  # rad/s times the root of length in m over gravity, of the controller: 0.09 rad/s for 33.9 m
_DAMPING = 0.8
_INTEGRAL = 0.1  # of the frequency
_ACROSS = 0.2  # how readily a unit turns, against how readily it changes its speed
_ANSWER = (
    4.0  # s, until the thrusters of a ship of 33.9 m do as told; others by the root of their length
)


def kept_on_track(
    ships: ShipModel,
    count: int,
    track: Motion,
    record: Record,
    dp: DpController,
    *,
    jolts: np.ndarray | None = None,
    held: Mapping[str, np.ndarray] | None = None,
) -> tuple[Motion, ThrusterSeries]:
    """Motion and thrusters of ships that a DP controller keeps on a track.

    Parameters
    ----------
    ships : ShipModel
        The real ships; its numbers may be (m,) arrays.
    count : int
        Number of ships m.
    track : Motion
        (n,) or (m, n) arrays.
    record : Record
        What the thrusters do anyway, (n,) or (m, n) arrays, and the wind.
    dp : DpController
    jolts : (n, 3, m) array, optional
        Changes of velocity at each row. [m/s, m/s, rad/s]
    held : dict of str to (n,) or (m, n) bool array, optional
        Where a thruster does as it is told and the controller leaves it alone.

    Returns
    -------
    tuple of Motion, dict of str to tuple of two arrays
        Motion, and speed and direction by thruster; (m, n) arrays.
    """
    # Inputs at the middle of each integration step, and the ships at the start of the track.
    h = record.step
    n = record.time.size
    parts = record.substeps(ships)
    inputs = [record.inputs(ships, (i + 0.5) / parts) for i in range(parts)]
    ship = Motion(*(np.zeros(count) + value[..., 0] for value in track))
    # Share of each thruster in a load, for each row: thrusters turn along the log.
    shares = dp.shares({name: azimuth for name, (_, azimuth) in record.units.items()}, held or {})
    shares = np.moveaxis(shares, -3, 0)
    # State of the controller: commanded forces and integral action.
    added = np.zeros((shares.shape[-2], count))
    integral = np.zeros((3, count))
    rates = Motion(*np.zeros((6, count)))
    rows = []
    units = {name: [] for name in ships.thrusters}
    # At each row: controller, first-order response of
    # the thrusters, then integration over the step.
    for k in range(n):
        rows.append(ship)
        load, integral = dp.load(ship, Motion(*(value[..., k] for value in track)), integral)
        added = dp.answer(added, load, shares[k])
        speeds = dp.speeds(added, record, k)
        for name, pair in speeds.items():
            units[name].append(pair)
        if k < n - 1:
            for i, part in enumerate(inputs):
                # a small ship answers within a row, through which a log's thrusters go on evenly
                now = dp.speeds(added, record, k + (i + 0.5) / parts) if parts > 1 else speeds
                driven = part.at(k)._replace(units=now)  # the record's wind alone
                ship, rates = _moved(ship, rates, driven, ships, h / parts, dp)
            if jolts is not None:
                ship = ship._replace(
                    u=ship.u + jolts[k][0], v=ship.v + jolts[k][1], r=ship.r + jolts[k][2]
                )
            # Limit the velocity, so that a ship out of control stays finite.
            ship = dp.bounded(ship)
            # At the end of a stretch start anew on the track, as the next row is much later.
            if k < n - 1 and record.is_last[k]:
                ship = Motion(*(np.zeros(count) + value[..., k + 1] for value in track))
                added = 0.0 * added
                integral = 0.0 * integral
                rates = Motion(*np.zeros((6, count)))
    # Stack the rows into series, of the motion and of each thruster.
    motion = Motion(*(np.stack(series, axis=-1) for series in zip(*rows, strict=True)))
    series = {}
    for name, pairs in units.items():
        speed, direction = (np.stack(part, axis=-1) for part in zip(*pairs, strict=True))
        series[name] = speed, direction
    return motion, series


def _between(series, row):
    """A series at a row, or linearly between two."""
    low = min(int(row), series.shape[-1] - 2)
    return (
        series[..., int(row)]
        if row == int(row)
        else (low + 1 - row) * series[..., low] + (row - low) * series[..., low + 1]
    )


def _moved(ship, last, inputs, model, h, dp):
    """The ships a step later by the rates in its middle, where those of the last step lead; and the rates."""
    # Midpoint rule, where the state at the middle is predicted with the rates of the last step.
    middle = Motion(*euler(ship, last, 0.5 * h))
    rates = motion_rates(dp.bounded(middle), inputs, model)
    return Motion(*euler(ship, rates, h)), rates


class DpController:
    """Proportional, derivative and slow integral action, allocated to the thrusters of a ship.

    Parameters
    ----------
    model : ShipModel
        The ship as the controller knows her.
    h : float
        Step. [s]
    fixed : collection of str
        Azimuth thrusters that cannot turn.
    """

    def __init__(self, model: ShipModel, h: float, fixed: Collection[str] = ()) -> None:
        hull = model.parts["hull"]
        # Thrusters as the controller knows them.
        self.thrusters = {name: dp_thruster_of(model, name) for name in model.thrusters}
        self.h = h
        self.model = model
        self.fixed = fixed
        # Bandwidth scales with the ship by Froude's law, and so does the delay of the thrusters.
        self.frequency = _FREQUENCY * np.sqrt(GRAVITY / hull.length) / 3.0
        self.delay = _ANSWER * np.sqrt(hull.length / 33.9)
        # Diagonal mass with added mass, and the limit of the load: an acceleration of 0.05 m/s2.
        self.mass = np.array(
            [hull.mass + hull.A11, hull.mass + hull.A22, hull.inertia_yaw + hull.A66]
        )
        self.most = 0.05 * self.mass * np.array([1.0, 1.0, 4.0 / hull.length])

    def bounded(self, ship: Motion) -> Motion:
        """The ships no faster than any ship is: one that cannot be steered so gets lost, not infinite."""
        most = np.sqrt(GRAVITY * self.model.length)
        u, v, r = (
            np.clip(value, -most, most) for value in (ship.u, ship.v, ship.r * self.model.length)
        )
        return ship._replace(u=u, v=v, r=r / self.model.length)

    def load(
        self, ship: Motion, want: Motion, integral: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Load that brings the ships back to the track, in their body frames; and the integral action."""
        # Position error in body axes, and velocity error.
        ahead, across = to_body(ship.psi, want.x - ship.x, want.y - ship.y)
        error = np.stack([ahead, across, want.psi - ship.psi])
        rate = np.stack([want.u - ship.u, want.v - ship.v, want.r - ship.r])
        # PID law tau = M (w^2 e + 2 zeta w e_dot +
        # integral), limited to what a ship can be asked for.
        w = self.frequency
        integral = integral + self.h * _INTEGRAL * w * w * w * error
        wanted = self.mass[:, None] * (w * w * error + 2.0 * _DAMPING * w * rate + integral)
        return np.clip(wanted, -self.most[:, None], self.most[:, None]), integral

    def answer(self, added: np.ndarray, load: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """Forces that the controller adds a step later, of first order towards those of a load; (k, m) array. [N]"""
        return added + min(self.h / self.delay, 1.0) * (_times(shares, load) - added)

    def shares(
        self, azimuths: Mapping[str, np.ndarray], held: Mapping[str, np.ndarray]
    ) -> np.ndarray:
        """What each thruster takes of a load on the ship, along and, where it turns, across its axis.

        Parameters
        ----------
        azimuths : dict of str to (...) array
            Where each thruster points.
        held : dict of str to (...) bool array
            Thrusters that take no part.

        Returns
        -------
        (..., k, 3) array
            For k forces, in the order of the thrusters.
        """
        # Columns of the allocation matrix: unit force
        # along each thruster and, if it turns, across it.
        columns = []
        eases = []
        for name, unit in self.thrusters.items():
            angle = unit.axis + (azimuths[name] if unit.pointed else 0.0 * azimuths[name])
            # Thrusters that are held or without thrust take no
            # part; turning is less readily used than speed.
            alone = held.get(name, False) if unit.ahead else True
            for i in range(self._forces(name)):
                c = np.cos(angle + 0.5 * np.pi * i)
                s = np.sin(angle + 0.5 * np.pi * i)
                columns.append(np.stack([c, s, unit.x * s - unit.y * c], axis=-1))
                eases.append(np.where(alone, 0.0, _ACROSS if i else 1.0)[..., None] + np.zeros(3))
        # Yaw moments are scaled to forces by a quarter of the length.
        scale = np.array([1.0, 1.0, 4.0 / self.model.length])
        ease = np.stack(np.broadcast_arrays(*eases), axis=-2)
        # Weighted pseudo-inverse of the allocation matrix, with a small damping term.
        Bt = ease * scale * np.stack(np.broadcast_arrays(*columns), axis=-2)
        return ease * scale * (Bt @ np.linalg.inv(np.swapaxes(Bt, -1, -2) @ Bt + 1e-2 * np.eye(3)))

    def shared(
        self, load: np.ndarray, azimuths: Mapping[str, np.ndarray], held: Mapping[str, np.ndarray]
    ) -> dict[str, np.ndarray]:
        """A load on the ship, (3, m) array, as forces along and across the axes of her thrusters, (2, m) arrays. [N]"""
        return self._by_thruster(_times(self.shares(azimuths, held), load))

    def _forces(self, name: str) -> int:
        """Number of directions in which the controller can have a thruster push."""
        return 2 if self.thrusters[name].turns and name not in self.fixed else 1

    def _by_thruster(self, forces: np.ndarray) -> dict[str, np.ndarray]:
        """Forces along and across the axis of each thruster."""
        by_name = {}
        place = 0
        for name in self.thrusters:
            of_thruster = forces[place : place + self._forces(name)]
            by_name[name] = (
                of_thruster
                if len(of_thruster) > 1
                else np.concatenate([of_thruster, np.zeros_like(of_thruster)])
            )
            place += len(of_thruster)
        return by_name

    def speeds(self, added: np.ndarray, record: Record, k: float) -> ThrusterSeries:
        """Speed and direction of each thruster: those of the record, changed by what the controller adds.

        The row may be a broken number, for a time between two.
        """
        by_thruster = {}
        for name, (along, across) in self._by_thruster(added).items():
            unit = self.thrusters[name]
            (n, azimuth) = (_between(series, k) for series in record.units[name])
            if not unit.ahead:
                by_thruster[name] = n + 0.0 * along, azimuth + 0.0 * along
                continue
            # Logged thrust plus the controller's, and a turn towards the force across.
            size = self.force(name, n) + along
            turn = 0.0
            if unit.turns:
                # a unit that hardly pushes cannot be told by its direction: it keeps it
                turn = np.clip(
                    across / np.maximum(np.abs(size), 0.02 * self.force(name, unit.most)), -0.5, 0.5
                )
            by_thruster[name] = (
                np.clip(self.speed(name, size), -unit.most, unit.most),
                azimuth + turn * np.sign(size),
            )
        return by_thruster

    def force(self, name: str, n: Arithmetic) -> np.ndarray:
        """Bollard thrust of a thruster at a speed in rev/s. [N]"""
        unit = self.thrusters[name]
        return np.where(n >= 0, unit.ahead, unit.astern) * n * np.abs(n)

    def speed(self, name: str, force: Arithmetic) -> np.ndarray:
        """Speed at which a thruster has that thrust at the bollard. [rev/s]"""
        unit = self.thrusters[name]
        # Inverse of the quadratic law.
        return np.sign(force) * np.sqrt(
            np.abs(force) / np.where(force >= 0, unit.ahead, unit.astern)
        )


def _times(shares: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Forces (k, m) of a load (3, m) by shares (1 or m, k, 3) or (k, 3)."""
    return (shares @ load.T[..., None])[..., 0].T
