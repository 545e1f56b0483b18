"""The sea trials of a log: straight runs, turning circles and zig-zags, by what was ordered and what the ship did."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import xarray

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.finding import Segment
from shipcosim.diagnose.numerics import moving_average, running_sums, runs
from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.clock import own_clock
from shipcosim.diagnose.ship.inputs import Record, ThrusterSeries
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.models.core.constants import GRAVITY


@dataclass(frozen=True)
class SeaTrial:
    """One manoeuvre of a log, on the clock that follows from its own motion.

    Attributes
    ----------
    kind : str
        ``"straight run"``, ``"turning circle"`` or ``"zig-zag"``.
    side : int
        1 to starboard, -1 to port, of the first order; 0 of a straight run.
    logged : tuple of two floats
        First and last time in the log. [s]
    steering : float
        Median size of the steering, as the sine of an azimuth. [1]
    time : (n,) array
        From the start, even. [s]
    measured : (n, 6) array
        North, east, heading (unwrapped), surge, sway, yaw rate, SI; speeds as the way says.
    units : dict of str to tuple of two (n,) arrays
        Speed or thrust and direction of each thruster. [rev/s or N, rad]
    orders : bool
        Whether these are orders, which the units follow, instead of what the units did.
    """

    kind: str
    side: int
    logged: Segment
    steering: float
    time: np.ndarray
    measured: np.ndarray
    units: ThrusterSeries
    orders: bool

    @property
    def name(self) -> str:
        """``turning circle to port at 2316 s``."""
        to = {1: " to starboard", -1: " to port", 0: ""}[self.side]
        return f"{self.kind}{to if self.kind == 'turning circle' else ''} at {self.logged[0]:.0f} s"


def sea_trials_of(
    record: Record,
    model: ShipModel,
    lost: Sequence[Segment] = (),
    *,
    orders: bool = False,
) -> list[SeaTrial]:
    """The manoeuvres of a log in the order of time.

    Parameters
    ----------
    record : Record
        Of the repaired log.
    model : ShipModel
    lost : sequence of (float, float)
        Segments in which rows are lost; no trial reaches over one. [s]
    orders : bool
        Whether the log has orders: of a straight run at the largest one nobody knows the shaft speed.

    Returns
    -------
    list of SeaTrial
        Each on its own clock, in steps for the simulation.
    """
    # Rows with measurements, known inputs, and no lost segment.
    measured, whole = _bridged(record.measured)
    length = model.length
    helm = steering(record, model)
    speed = np.hypot(measured[:, 3], measured[:, 4])
    whole &= record.usable | (np.arange(whole.size) == whole.size - 1)
    for first, last in lost:
        whole &= (record.time < first - record.step) | (record.time > last + record.step)
    # Circles and zig-zags first, straight runs between them.
    manoeuvres = [*_circles(helm, measured), *_zig_zags(helm, measured, length)]
    busy = [rows for _, rows in manoeuvres]
    manoeuvres += _straight_runs(helm, record, measured, length, busy)
    # Only whole manoeuvres in which the ship makes way.
    kept = [(kind, rows) for kind, rows in manoeuvres if whole[rows].all()]
    fast = thresholds.UNDER_WAY * np.sqrt(GRAVITY * length)
    kept = [(kind, rows) for kind, rows in kept if np.mean(speed[rows]) > fast]
    # Correct the clock and the scale of the speed log by the motion itself.
    clock, scale = own_clock(record.time, measured, length)
    measured = measured.copy()
    measured[:, 3:5] *= scale
    kept = [
        manoeuvre
        for manoeuvre in kept
        if not (orders and manoeuvre[0] == "straight run" and _clipped(manoeuvre[1], record, model))
    ]
    trials = [
        _trial(kind, rows, record, measured, clock, helm, length, orders) for kind, rows in kept
    ]
    return sorted(trials, key=lambda trial: trial.logged)


def as_ordered(record: Record, log: xarray.Dataset, model: ShipModel) -> Record:
    """The record with the orders of thrusters as logged, not averaged over neighbouring rows: an order is a step.

    Parameters
    ----------
    record : Record
    log : xarray.Dataset
        The repaired log that it was made of.
    model : ShipModel

    Returns
    -------
    Record
    """
    time = log["time"].values
    # The nearest logged row, instead of an average.
    after = np.clip(np.searchsorted(time, record.time), 1, time.size - 1)
    at = after - (record.time - time[after - 1] < time[after] - record.time)
    units = {}
    for name, (speed, direction) in record.units.items():
        # Orders as logged; the averaged ones where the log has a hole.
        ordered = speed
        for drive, factor in (("thrust", 1.0), ("rpm", 1.0 / 60.0)):
            if drive in model.drives(name) and f"{name}_{drive}" in log:
                ordered = factor * _finite_or(log[f"{name}_{drive}"].values, speed, at)
        azimuth = f"{name}_azimuth"
        units[name] = (
            ordered,
            _finite_or(unwrap_series(np.radians(log[azimuth].values)), direction, at)
            if azimuth in log
            else direction,
        )
    return replace(record, units=units)


def _finite_or(series, otherwise, at):
    """Values of a series at some rows; a default for missing values."""
    return np.where(np.isfinite(series[at]), series[at], otherwise)


def steering(record: Record, model: ShipModel) -> np.ndarray:
    """Commanded yaw moment over the largest that the commanded thrusts could have, to starboard. (n,) [1]

    Of a ship with azimuths or a rudder it is the sine of their angle, of one with two fixed propellers their difference
    over their sum.
    """
    # Yaw moment of all steering thrusters by their shares of thrust, and the largest that they
    # could have.
    moment = most = np.zeros(record.time.size)
    for name, (speed, direction) in record.units.items():
        unit = dp_thruster_of(model, name)
        thrust = (
            speed
            if "thrust" in model.drives(name)
            else speed * abs(speed) * np.where(speed < 0, unit.astern, unit.ahead)
        )
        if unit.pushes_sideways:
            continue  # a tunnel thruster: no trial is steered with it
        angle = unit.axis + direction if unit.pointed else unit.axis
        moment = moment + thrust * (unit.x * np.sin(angle) - unit.y * np.cos(angle))
        most = most + abs(thrust) * (abs(unit.x) if unit.pointed else abs(unit.y))
    return np.where(most > 0.0, moment / np.maximum(most, 1e-9), 0.0)


def _bridged(measured):
    """Measurements with short holes filled, and whether each row has values all the same."""
    filled = measured.copy()
    whole = np.ones(len(measured), bool)
    rows = np.arange(len(measured))
    for channel in range(measured.shape[1]):
        there = np.isfinite(measured[:, channel])
        if not there.any():
            continue
        filled[:, channel] = np.interp(rows, rows[there], measured[there, channel])
        # Holes are filled linearly; long ones, and both ends, make rows unusable.
        for a, b in pairwise(np.flatnonzero(there)):
            if b - a - 1 > thresholds.LONGEST_HOLE:
                whole[a + 1 : b] = False
        whole[: np.argmax(there)] = False
        whole[len(there) - np.argmax(there[::-1]) :] = False
    return filled, whole


def _way(measured):
    """Distance sailed until each row. [m]"""
    return running_sums(np.hypot(*np.diff(measured[:, :2], axis=0).T))


def _runs(mask):
    """Runs of rows where a mask holds: slices."""
    return [slice(int(first), int(last)) for first, last in runs(mask)]


def _circles(helm, measured):
    """Rows of orders held until the ship has turned round, from where the order leaves its rest."""
    for side in (1.0, -1.0):
        # Runs of helm to one side that turn the ship far enough.
        for run in _runs(side * helm > thresholds.TURNING):
            turned = side * (measured[:, 2] - measured[run.start, 2])
            if turned[run.stop - 1] < np.radians(thresholds.CIRCLE):
                continue
            # Go back to where the order left its rest, and end after the wanted number of circles.
            start = run.start
            while (
                start > 0 and side * helm[start - 1] > thresholds.STEADY and start > run.start - 20
            ):
                start -= 1
            far = np.flatnonzero(turned[run] > np.radians(thresholds.CIRCLES))
            end = run.start + int(far[0]) + 1 if far.size else run.stop
            yield "turning circle", slice(max(start - 1, 0), end)


def _zig_zags(helm, measured, length):
    """Rows from the first order of a zig-zag to its last change of the helm."""
    way = _way(measured)
    side = np.where(helm > thresholds.ZIG_ZAG, 1, np.where(helm < -thresholds.ZIG_ZAG, -1, 0))
    # Times with helm to either side, in order.
    swings = [run for sign in (1, -1) for run in _runs(side == sign)]
    swings.sort(key=lambda run: run.start)
    chains = []
    for run in swings:
        if np.ptp(measured[run, 2]) > np.radians(thresholds.HALF_A_CIRCLE):
            continue
        last = chains[-1][-1] if chains else run
        # A swing continues the zig-zag if the helm is reversed soon and the swing is short.
        near = way[run.start] - way[last.stop - 1] < thresholds.REVERSED * length
        quick = way[run.stop - 1] - way[last.start] < 2.0 * thresholds.LONGEST_SWING * length
        if near and quick and side[run.start] != side[last.start]:
            chains[-1].append(run)
        else:
            chains.append([run])
    for chain in (chain for chain in chains if len(chain) > thresholds.SWINGS):
        start = chain[0].start
        # Go back to where the first order left its rest.
        while (
            start > 0 and abs(helm[start - 1]) > thresholds.STEADY and start > chain[0].start - 10
        ):
            start -= 1
        yield "zig-zag", slice(max(start - 1, 0), chain[-1].start + 1)


def _straight_runs(helm, record, measured, length, busy):
    """Rows of straight courses at held orders, after the speed has settled."""
    way = _way(measured)
    # Helm near zero on average, little turning, orders constant, and no other manoeuvre.
    held = np.abs(moving_average(helm, _rows_of_rest(record))) < thresholds.STEADY
    rate = moving_average(measured[:, 5], _rows_of_rest(record))
    speed = np.hypot(measured[:, 3], measured[:, 4])
    held &= np.abs(rate) * length < thresholds.STRAIGHT_RATE * speed
    for order, _ in record.units.values():
        held &= _held(order, record)
    for rows in busy:
        held[rows] = False
    for run in _runs(held):
        # Drop the first lengths, in which the speed still settles.
        after = np.flatnonzero(way[run] - way[run.start] > thresholds.SETTLED * length)
        if not after.size:
            continue
        rows = slice(run.start + int(after[0]), run.stop)
        if way[rows.stop - 1] - way[rows.start] > thresholds.STRAIGHT * length:
            yield "straight run", rows


def _rows_of_rest(record):
    """Rows over which a helmsman's corrections average out."""
    return max(int(thresholds.REST / record.step), 1)


def _clipped(rows, record, model):
    """Whether a thruster is ordered to its largest speed."""
    most = {name: getattr(model.parts[name], "rpm_max", np.inf) / 60.0 for name in record.units}
    return any(
        np.mean(speed[rows]) > thresholds.CLIPPED * most[name]
        for name, (speed, _) in record.units.items()
    )


def _held(series, record):
    """Whether an order stays near its value some seconds ago and hence."""
    rows = _rows_of_rest(record)
    size = 0.03 * np.max(np.abs(series)) + 1e-9
    off = np.abs(series - np.roll(series, rows)) < size
    return off & np.roll(off, -rows)


def _trial(kind, rows, record, measured, clock, helm, length, orders):
    """The rows of a manoeuvre on even steps of its own clock."""
    # Even steps of the ship's time scale on the corrected clock; orders are steps, so they are not
    # interpolated.
    seconds = clock[rows] - clock[rows][0]
    h = thresholds.STEP * np.sqrt(length)
    time = np.arange(int(seconds[-1] / h) + 1) * h

    def even(series):
        return np.interp(time, seconds, series[rows])

    nearest = np.argmin(np.abs(seconds[:, None] - time), axis=0) + rows.start
    units = {
        name: (speed[nearest], direction[nearest])
        for name, (speed, direction) in record.units.items()
    }
    # The first clear order gives the side.
    order = helm[rows][np.argmax(np.abs(helm[rows]) > thresholds.ZIG_ZAG)]
    side = 0 if kind == "straight run" else int(np.sign(order))
    logged = float(record.time[rows][0]), float(record.time[rows][-1])
    size = float(np.median(np.abs(helm[rows])))
    motion = np.stack([even(c) for c in measured.T], axis=1)
    return SeaTrial(kind, side, logged, size, time, motion, units, orders)
