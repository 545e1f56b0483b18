"""Manoeuvres by which causes can be told from each other, as tracks and thruster settings for any ship.

Lengths are proportional to the ship's, times to the root of her length: every ship meets the same accelerations.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.inference.innovations import Noise
from shipcosim.diagnose.numerics import gaussian_filter
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs, Record
from shipcosim.diagnose.ship.measured_motion import at_rows, wind_over_ground
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.diagnose.ship.track_keeping import DpController
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion

LONGEST = 15.0
"""No manoeuvre takes longer. [min]"""
_LENGTH = 33.9  # m, of the ship that the figures of the library are for
_PUSH = 0.012  # m/s2, of the ship by one thruster's push
_OPPOSED = (
    0.004  # m/s2: azimuth thrusters push against each other that much, so that each has a direction
)
_STRAIGHT = 0.01  # rad
_STEP = 2.0  # s
_STEADY = 2.0  # steps: thrusters follow the plan that smoothly


@dataclass(frozen=True)
class Push:
    """A thruster with a planned command, which the DP controller does not use.

    Attributes
    ----------
    thruster : str
    start, end : float
        [s]
    force : float
        Along its axis, astern where negative. [N]
    azimuth : tuple of two floats
        Direction at start and end; turned through evenly. [rad]
    """

    thruster: str
    start: float
    end: float
    force: float
    azimuth: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Manoeuvre:
    """A track and pushes of thrusters, and when the DP controller is off.

    Attributes
    ----------
    name : str
    legs : tuple of (float, float, float, float)
        Duration, and where the ship is then: ahead and to starboard of where she started, and turned.
        [s, m, m, rad]
    pushes : tuple of Push
    free : tuple of (float, float)
        From when to when the DP is off and thrusters stand still. [s]
    """

    name: str
    legs: tuple[tuple[float, float, float, float], ...]
    pushes: tuple[Push, ...] = ()
    free: tuple[tuple[float, float], ...] = ()

    @property
    def minutes(self) -> float:
        """Duration. [min]"""
        return sum(leg[0] for leg in self.legs) / 60.0


def library(model: ShipModel, fixed: Collection[str] = ()) -> list[Manoeuvre]:
    """All manoeuvres for a ship, none longer than `LONGEST`.

    Parameters
    ----------
    model : ShipModel
    fixed : collection of str
        Azimuth thrusters that cannot turn.

    Returns
    -------
    list of Manoeuvre
    """
    # Scale from the reference ship: lengths with her length, times with its root (Froude).
    share = model.length / _LENGTH
    T = 60.0 * np.sqrt(share)
    side = 30.0 * share
    mass = model.parts["hull"].mass
    turn = 0.5 * np.pi
    corners = [(1.5, side, 0.0), (1.5, side, side), (1.5, 0.0, side), (1.5, 0.0, 0.0)]
    manoeuvres = [
        Manoeuvre(
            "turn by 90 deg and hold", _legs(T, (0.5, 0, 0, 0), (1.5, 0, 0, turn), (2, 0, 0, turn))
        ),
        Manoeuvre(
            "full circle of headings on the spot",
            _legs(T, (0.5, 0, 0, 0), (6, 0, 0, 4 * turn), (0.5, 0, 0, 4 * turn)),
        ),
        Manoeuvre(
            f"box of {side:.0f} m at one heading",
            _legs(T, *(leg for t, x, y in corners for leg in ((t, x, y, 0.0), (0.25, x, y, 0.0)))),
        ),
        _steps("surge", T, (side, 2.5 * side), 0),
        _steps("sway", T, (0.3 * side, 0.75 * side), 1),
        Manoeuvre(
            "free drift with idle thrusters",
            _legs(T, (0.5, 0, 0, 0), (3, 0, 0, 0)),
            free=((0.5 * T, 4.0 * T),),
        ),
        _pulses(
            "pulses of one thruster after the other",
            T,
            dict.fromkeys(model.thrusters, mass * _PUSH),
        ),
    ]
    if model.azimuths:
        manoeuvres.append(
            _pulses(
                "reversal of each azimuth thruster",
                T,
                dict.fromkeys(model.azimuths, -mass * _PUSH),
            )
        )
    sweeps = _sweeps(model, T, [name for name in model.azimuths if name not in fixed], mass * _PUSH)
    return [manoeuvre for manoeuvre in (*manoeuvres, *sweeps) if manoeuvre.minutes <= LONGEST]


def _legs(
    T: float, *legs: tuple[float, float, float, float]
) -> tuple[tuple[float, float, float, float], ...]:
    return tuple((T * duration, float(x), float(y), float(psi)) for duration, x, y, psi in legs)


def _steps(axis, T, lengths, along):
    """Out and back twice, the second time faster."""
    legs = []
    for length in lengths:
        there = (length, 0.0) if along == 0 else (0.0, length)
        legs += [
            (1.25, *there, 0.0),
            (0.25, *there, 0.0),
            (1.25, 0.0, 0.0, 0.0),
            (0.25, 0.0, 0.0, 0.0),
        ]
    return Manoeuvre(f"steps in {axis} at two speeds", _legs(T, *legs))


def _pulses(name, T, forces):
    """Each thruster alone does something for a minute; the others hold the ship against it."""
    starts = [T * (0.5 + 1.5 * i) for i in range(len(forces))]
    pushes = tuple(
        Push(unit, a, a + T, force) for a, (unit, force) in zip(starts, forces.items(), strict=True)
    )
    return Manoeuvre(name, _legs(T, (0.5 + 1.5 * len(forces), 0, 0, 0)), pushes)


def _sweeps(model, T, azimuths, force):
    """Each azimuth thruster turns its slipstream across its nearest neighbour, which pushes ahead or astern.

    A neighbour that held the ship against it would have its own slipstream in the first: equal losses, no net load.
    """
    pushes = []
    start = 0.5 * T
    for name in azimuths:
        # The neighbour whose inflow this thruster's slipstream disturbs.
        here = model.parts[name]
        x = here.neighbour_x
        y = here.neighbour_y
        near = next(
            (o for o in azimuths if np.hypot(model.parts[o].x - x, model.parts[o].y - y) < 1e-6),
            None,
        )
        if near not in (None, name):
            at = np.arctan2(here.y - y, here.x - x)  # away from the neighbour
            ahead = (
                0.0 if len(pushes) % 4 == 0 else np.pi
            )  # and astern the next time: the ship comes to rest
            span = np.pi / 3.0 if ahead == 0.0 else -np.pi / 3.0
            pushes.append(Push(name, start, start + 0.8 * T, force, (at - span, at + span)))
            pushes.append(Push(near, start, start + 0.8 * T, force, (ahead, ahead)))
            start += T
    legs = _legs(T, (start / T + 0.75, 0, 0, 0))
    return [
        Manoeuvre(
            "sweep of each azimuth thruster's slipstream across its neighbour", legs, tuple(pushes)
        )
    ][: len(pushes)]


def step_for(model: ShipModel) -> float:
    """Time from row to row of a manoeuvre. [s]"""
    return _STEP * float(np.sqrt(model.length / _LENGTH))


def planned(
    manoeuvres: Sequence[Manoeuvre],
    dp: DpController,
    start: tuple[float, float, float, float],
    wind: tuple[float, float] | None,
) -> tuple[Motion, Record, dict[str, np.ndarray]]:
    """Tracks, thruster settings, and where the DP controller leaves them alone, of several manoeuvres side by side.

    Parameters
    ----------
    manoeuvres : sequence of Manoeuvre
    dp : DpController
        What the track needs by its ship is told to the thrusters beforehand.
    start : tuple of four floats
        Time, position and heading at the start. [s, m, m, rad]
    wind : tuple of two floats, or None
        Speed, and direction over ground that it comes from. [m/s, rad]

    Returns
    -------
    tuple of Motion, Record, dict of str to (c, n) bool array
        (c, n) arrays; by thruster, where it does as planned. The shorter end with keeping the place.
    """
    rows = max(rows_of(manoeuvre, dp.h) for manoeuvre in manoeuvres)
    time = dp.h * np.arange(rows)
    # Tracks of all manoeuvres on the same times, with mean wind throughout.
    track = Motion(
        *(
            np.stack(s)
            for s in zip(*(_track(manoeuvre, time, start) for manoeuvre in manoeuvres), strict=True)
        )
    )
    shape = len(manoeuvres), rows
    series = None if wind is None else (np.full(shape, wind[0]), np.full(shape, wind[1]))
    plans = [
        _thrusters(manoeuvre, time, at_rows(track, i), start, wind, dp)
        for i, manoeuvre in enumerate(manoeuvres)
    ]
    units = {
        name: (np.stack([p[name][0] for p in plans]), np.stack([p[name][1] for p in plans]))
        for name in plans[0]
    }
    blank = np.full((len(manoeuvres), rows, 6), np.nan)
    record = Record(start[0] + time, blank, units, series, np.ones(rows, bool))
    held = {
        name: np.stack([_held(manoeuvre, name, time) for manoeuvre in manoeuvres]) for name in units
    }
    return track, record, held


def _held(manoeuvre, name, time):
    return _inside(
        (*manoeuvre.free, *((p.start, p.end) for p in manoeuvre.pushes if p.thruster == name)), time
    )


def rows_of(manoeuvre: Manoeuvre, step: float) -> int:
    """Number of rows of a manoeuvre."""
    return 1 + round(60.0 * manoeuvre.minutes / step)


def _track(manoeuvre, time, start):
    """The track by smooth legs: at rest at both ends, without a step in acceleration."""
    at = 0.0
    place = np.zeros(3)
    way = np.zeros((3, time.size))
    # Quintic from rest to rest, 10 s^3 - 15 s^4 + 6 s^5, added leg by leg.
    for duration, *where in manoeuvre.legs:
        share = np.clip((time - at) / duration, 0.0, 1.0)
        way += (
            (np.array(where) - place)[:, None] * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        )
        at = at + duration
        place = np.array(where)
    # From the start's axes to north and east, and velocities in body axes by differences.
    _, north, east, heading = start
    c = np.cos(heading)
    s = np.sin(heading)
    x = north + c * way[0] - s * way[1]
    y = east + s * way[0] + c * way[1]
    psi = heading + way[2]
    x_dot, y_dot, r = (np.gradient(value, time) for value in (x, y, psi))
    return Motion(x, y, psi, *to_body(psi, x_dot, y_dot), r)


def _inside(spans, time):
    return np.any(
        [np.zeros(time.size, bool), *((time >= a) & (time < b) for a, b in spans)], axis=0
    )


def _thrusters(manoeuvre, time, track, start, wind, dp):
    """Speed and direction of each thruster by the plan. [rev/s, rad]"""
    model = dp.model
    free = _inside(manoeuvre.free, time)
    alone = {}
    for push in manoeuvre.pushes:
        inside = _inside(((push.start, push.end),), time)
        share = np.clip((time - push.start) / (push.end - push.start), 0.0, 1.0)
        azimuth = push.azimuth[0] + share * (push.azimuth[1] - push.azimuth[0])
        alone.setdefault(push.thruster, []).append((inside, push.force, azimuth))
    # Load of the thrusters by which the ship would follow the track. (3, n)
    still = {name: (np.zeros(time.size), np.zeros(time.size)) for name in dp.model.thrusters}
    air = (None, None) if wind is None else tuple(np.full(time.size, value) for value in wind)
    drift = motion_rates(track, Inputs(start[0] + time, still, *air), dp.model)
    wanted = [np.gradient(value, time) for value in (track.u, track.v, track.r)]
    load = dp.mass[:, None] * (np.stack(wanted) - np.stack([drift.u, drift.v, drift.r]))
    # Share the load among the thrusters stretch by stretch; pushed thrusters are left out and their
    # load subtracted.
    opposed = _opposed_forces(dp)
    wishes = {name: np.zeros((2, time.size)) for name in model.thrusters}
    for rows, left in _stretches(alone, time.size):
        rest = load[:, rows]
        for name in left:
            inside, force, azimuth = next(push for push in alone[name] if push[0][rows].all())
            rest = rest - _load_of(name, force, azimuth[rows], model)
        axes_here = {name: np.zeros(rows.size) for name in model.thrusters}
        for name, forces in dp.shared(rest, axes_here, dict.fromkeys(left, True)).items():
            wishes[name][:, rows] = np.where(
                free[rows], 0.0, forces + (0.0 if left else opposed[name][:, None])
            )
    return {
        name: _setting(name, wishes[name], alone.get(name, ()), time, dp)
        for name in model.thrusters
    }


def _stretches(alone, rows):
    """Consecutive rows in which the same thrusters are pushed, and which these are."""
    pushed = [
        tuple(n for n, pushes in alone.items() if any(p[0][k] for p in pushes)) for k in range(rows)
    ]
    edges = [0, *(k for k in range(1, rows) if pushed[k] != pushed[k - 1]), rows]
    return [(np.arange(a, b), pushed[a]) for a, b in zip(edges[:-1], edges[1:], strict=True)]


def _load_of(name, force, azimuth, model):
    unit = model.parts[name]
    if name not in model.azimuths:
        azimuth = np.full_like(azimuth, dp_thruster_of(model, name).axis)
    X = force * np.cos(azimuth)
    Y = force * np.sin(azimuth)
    return np.stack([X, Y, unit.x * Y - getattr(unit, "y", 0.0) * X])


def _opposed_forces(dp):
    """Forces of the azimuth thrusters against each other, slipstreams outwards, that leave no load on the ship."""
    model = dp.model
    forces = {name: np.zeros(2) for name in dp.model.thrusters}
    able = [name for name in model.azimuths if name not in dp.fixed]
    if len(able) < 2:
        return forces
    # Wish to pull inwards, less the part that leaves a net load: projection on the null space of B.
    places = np.array([[model.parts[name].x, model.parts[name].y] for name in able])
    inwards = places.mean(0) - places
    inwards /= np.maximum(np.linalg.norm(inwards, axis=1), 1e-9)[:, None]
    B = np.hstack([[[1.0, 0.0], [0.0, 1.0], [-y, x]] for x, y in places])
    wish = inwards.ravel() - np.linalg.pinv(B) @ (B @ inwards.ravel())
    size = _OPPOSED * model.parts["hull"].mass
    return forces | {
        name: size * force for name, force in zip(able, wish.reshape(-1, 2), strict=True)
    }


def _setting(name, wish, pushes, time, dp):
    """Speed and direction for forces along x and y of the ship, and for pushes; as smooth as thrusters are."""
    turns = name in dp.model.azimuths and name not in dp.fixed
    force = wish[0]
    azimuth = np.full(time.size, dp.model.fixed.get(name, 0.0))
    # Direction and size of the force; pushes take precedence.
    if turns:
        force = np.hypot(*wish)
        azimuth = np.arctan2(wish[1], wish[0])
    for inside, push, direction in pushes:
        force = np.where(inside, push, force)
        azimuth = np.where(inside, direction, azimuth) if turns else azimuth
    # Hold the direction through zero force by interpolation.
    azimuth = (
        np.interp(time, time[force != 0.0], np.unwrap(azimuth[force != 0.0]))
        if np.any(force)
        else azimuth
    )
    # Shaft speed for the force within 80 % of the limit, smoothed as thrusters respond.
    most = 0.8 * dp.model.parts[name].rpm_max / 60.0
    speed = np.clip(dp.speed(name, force), -most, most)
    return tuple(gaussian_filter(series, _STEADY, ends="held") for series in (speed, azimuth))


def cannot_turn(record: Record, model: ShipModel) -> tuple[str, ...]:
    """Azimuth thrusters without a rate of turning, or that point straight ahead or astern throughout a log."""
    across = {name: np.abs(np.sin(record.units[name][1])).max() for name in model.azimuths}
    return tuple(
        n for n in model.azimuths if model.parts[n].azimuth_rate == 0.0 or across[n] < _STRAIGHT
    )


def true_wind(record: Record, motion: Motion, model: ShipModel) -> tuple[float, float] | None:
    """Mean wind over ground of a log: speed, and where it comes from. [m/s, rad]; None where it has no wind."""
    if record.wind is None:
        return None
    speed, direction = record.wind
    if model.wind_is_true:
        north = -speed * np.cos(direction)
        east = -speed * np.sin(direction)
    else:
        north, east = wind_over_ground(speed, direction, motion)
    # Mean of the components, as directions wrap.
    north = float(np.mean(north))
    east = float(np.mean(east))
    return float(np.hypot(north, east)), float(np.arctan2(-east, -north))


def sized(noise: Noise, factor: float) -> Noise:
    """Noise of averaged rows: each is the mean of a given number of rows."""
    less = np.sqrt(factor)
    return replace(noise, white=np.asarray(noise.white) / less, wave=np.asarray(noise.wave) / less)
