"""Manoeuvres that could be sailed next, as a ship would sail them: orders, way and heading under a simple helmsman.

Lengths of way are ship lengths at the speed of approach; angles are those of rudders or azimuths. Every manoeuvre is
sailed to both sides, on opposite courses, so that a current does not look like the ship.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.sea_trials import thresholds
from shipcosim.diagnose.sea_trials.sailing import settled, steered
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.thrusters import dp_thruster_of

_FULL = 1.0  # of the largest shaft speed of the trials
_HALF = 0.6
_SLOW = 0.35
_KEEPS_HEADING = 1.5, 1.0  # helm over heading error, and over rate of turn r L / U
_MOST_HELM = np.radians(35.0)


class Leg(NamedTuple):
    """A part of a manoeuvre.

    Attributes
    ----------
    way : float
        Its time, as way at the speed of approach. [ship lengths]
    power : float
        Shaft speed over the largest of the trials, astern where negative. [1]
    helm : float
        Angle of rudders or azimuths, towards the side of the manoeuvre. [rad]
    bow : float
        Speed of the bow thruster over its largest, towards the side of the manoeuvre. [1]
    held : bool
        Whether a helmsman holds the first heading instead.
    check : float
        Of a zig-zag: change of heading at which the helm is put over; 0 of any other. [rad]
    """

    way: float
    power: float
    helm: float = 0.0
    bow: float = 0.0
    held: bool = False
    check: float = 0.0


@dataclass(frozen=True)
class PlannedTrial:
    """A manoeuvre to be sailed to both sides.

    Attributes
    ----------
    name : str
    kind : str
        Of its features, a key of `FEATURES`.
    approach : float
        Shaft speed of the straight run before it, over the largest of the trials. [1]
    legs : tuple of Leg
        Those before the last `seen` are sailed first.
    seen : int
        How many legs, from the last, its features are taken from.
    """

    name: str
    kind: str
    approach: float
    legs: tuple[Leg, ...]
    seen: int

    @property
    def way(self) -> float:
        """Distance sailed on all legs. [ship lengths]"""
        return sum(leg.way for leg in self.legs)


def _planned(
    name: str, kind: str, approach: float, *legs: Leg, seen: int | None = None
) -> PlannedTrial:
    return PlannedTrial(name, kind, approach, legs, len(legs) if seen is None else seen)


def catalogue(model: ShipModel) -> list[PlannedTrial]:
    """Every manoeuvre that a ship can sail with the thrusters she has.

    Parameters
    ----------
    model : ShipModel

    Returns
    -------
    list of PlannedTrial
    """
    d = np.radians
    speeds = {"full speed": _FULL, "half speed": _HALF, "slow speed": _SLOW}
    fast = {name: power for name, power in speeds.items() if power != _SLOW}
    manoeuvres = [
        _planned(
            f"turning circle with {angle} deg at {name}",
            "turning circle",
            power,
            Leg(45.0, power, d(angle)),
        )
        for name, power in fast.items()
        for angle in (10, 20, 35)
    ]
    manoeuvres += [
        _planned(
            f"zig-zag {helm}/{check} at {name}",
            "zig-zag",
            power,
            Leg(30.0, power, d(helm), check=d(check)),
        )
        for name, power in fast.items()
        for helm, check in ((10, 10), (20, 20), (35, 5))
    ]
    turn = Leg(12.0, _FULL, d(20))
    amidships = Leg(6.0, _FULL)
    spiral = [Leg(12.0, _FULL, d(angle)) for angle in (20, 10, 5, 2.5)]
    manoeuvres += [
        _planned("pull-out from 20 deg at full speed", "pull-out", _FULL, turn, amidships, seen=1),
        _planned("spiral from 20 to 2.5 deg at full speed", "spiral", _FULL, *spiral),
        _planned(
            "speeding up from slow to full speed",
            "change of speed",
            _SLOW,
            Leg(12.0, _FULL, held=True),
        ),
        _planned("thrusters stopped at full speed", "change of speed", _FULL, Leg(10.0, 0.0)),
        _planned("crash stop from full speed", "change of speed", _FULL, Leg(6.0, -_FULL)),
    ]
    sideways = (dp_thruster_of(model, name).pushes_sideways for name in model.thrusters)
    return [*manoeuvres, *_with_bow_thruster(speeds)] if any(sideways) else manoeuvres


def _with_bow_thruster(speeds):
    for name, power in speeds.items():
        held = f"straight at {name}, heading held against the bow thruster"
        yield _planned(held, "course held", power, Leg(12.0, power, bow=1.0, held=True))
        for angle, bow, how in (
            (0, 1.0, "by the bow thruster alone"),
            (10, 1.0, "with 10 deg and bow thruster"),
            (20, 1.0, "with 20 deg and bow thruster"),
            (35, 1.0, "with 35 deg and bow thruster"),
            (20, -1.0, "with 20 deg against the bow thruster"),
            (35, -1.0, "with 35 deg against the bow thruster"),
        ):
            legs = Leg(45.0, power, np.radians(angle), bow)
            yield _planned(f"turning circle {how} at {name}", "turning circle", power, legs)


def as_trials(
    planned: Sequence[PlannedTrial],
    model: ShipModel,
    shafts: Mapping[str, float],
    changes: Mapping[str, float],
) -> list[tuple[PlannedTrial, list[SeaTrial]]]:
    """What a log would have of manoeuvres that a ship sails, without noise, in calm water.

    Parameters
    ----------
    planned : sequence of PlannedTrial
    model : ShipModel
    shafts : mapping of str to float
        Largest speed of each main thruster in the trials. [rev/s]
    changes : mapping of str to float
        By which her numbers differ from the model's.

    Returns
    -------
    list of (PlannedTrial, list of SeaTrial)
        Without those that she does not get through: a circle in which she does not turn round.
    """
    length = model.length
    h = thresholds.STEP * np.sqrt(model.length)
    # Each approach begins at its own steady speed straight ahead.
    approaches = sorted({manoeuvre.approach for manoeuvre in planned})
    units = {name: dp_thruster_of(model, name) for name in model.thrusters}
    orders = [_orders(units, shafts, power, 0.0, 0.0) for power in approaches]
    speeds = dict(zip(approaches, settled(orders, model, changes, h), strict=True))
    # Every manoeuvre to both sides, on opposite courses; all runs in one simulation.
    runs = [(manoeuvre, side) for manoeuvre in planned for side in (1, -1)]
    pilots = [
        _Pilot(manoeuvre, side, speeds[manoeuvre.approach], length, shafts, units)
        for manoeuvre, side in runs
    ]
    rows = [
        int(manoeuvre.way * length / speeds[manoeuvre.approach] / h) + 2 for manoeuvre, _ in runs
    ]
    start = [
        (0.0, 0.0, 0.0 if side > 0 else np.pi, speeds[manoeuvre.approach])
        for manoeuvre, side in runs
    ]
    motions, ordered = steered(pilots, start, max(rows), model, changes, h)
    sailed_pairs = []
    for i, plan in enumerate(planned):
        pair = [
            _seen(
                runs[k][0],
                runs[k][1],
                motions[k, : rows[k]],
                {n: (a[: rows[k], k], b[: rows[k], k]) for n, (a, b) in ordered.items()},
                h,
            )
            for k in (2 * i, 2 * i + 1)
        ]
        # Keep manoeuvres that the ship gets through to both sides.
        if all(trial is not None for trial in pair):
            sailed_pairs.append((plan, pair))
    return sailed_pairs


def _seen(manoeuvre, side, motion, units, h):
    """The part of a run that features are taken from, or nothing."""
    # Legs by their share of the way; the first ones may not belong to the features.
    ways = np.cumsum([0.0, *(leg.way for leg in manoeuvre.legs)]) / manoeuvre.way
    first = int(ways[-1 - manoeuvre.seen] * (len(motion) - 1))
    last = len(motion)
    # A circle ends after the wanted number of turns; one that is not reached does not count.
    if manoeuvre.kind == "turning circle":
        turned = side * (motion[:, 2] - motion[0, 2])
        if turned.max() < np.radians(thresholds.CIRCLES):
            return None
        last = int(np.argmax(turned > np.radians(thresholds.CIRCLES))) + 1
    part = slice(first, last)
    cut = {name: (speed[part], direction[part]) for name, (speed, direction) in units.items()}
    time = h * np.arange(last - first)
    helm = float(np.sin(abs(manoeuvre.legs[-1].helm)))
    return SeaTrial(
        manoeuvre.kind, side, (h * first, h * last), helm, time, motion[part], cut, True
    )


def _orders(units, shafts, power, helm, bow):
    """Speed and direction of every thruster, from shaft speed, helm to starboard and bow thruster to starboard."""
    orders = {}
    for name, unit in units.items():
        if unit.pushes_sideways:
            orders[name] = (bow * unit.most, 0.0)
        elif unit.pointed:
            orders[name] = (power * shafts.get(name, 0.0), -helm if unit.x < 0.0 else 0.0)
        else:
            share = np.sqrt(max(1.0 - np.sign(unit.y) * np.sin(helm), 0.0))
            orders[name] = (power * shafts.get(name, 0.0) * share, 0.0)
    return orders


class _Pilot:
    """Gives the orders of one run from the motion that it sees."""

    def __init__(self, planned, side, speed, length, shafts, units):
        self.planned = planned
        self.side = side
        self.speed = speed
        self.length = length
        self.shafts = shafts
        self.units = units
        self.ends = np.cumsum([leg.way for leg in planned.legs]) * length / speed
        self.first = None
        self.helm_to = side

    def __call__(self, time, psi, r):
        """Orders at a time [s], heading [rad] and rate of turn [rad/s]."""
        self.first = psi if self.first is None else self.first
        leg = self.planned.legs[
            min(int(np.searchsorted(self.ends, time, "right")), len(self.ends) - 1)
        ]
        # Course keeping by proportional and derivative action, within the largest helm.
        helm = self.side * leg.helm
        if leg.held:
            error, rate = _KEEPS_HEADING
            helm = error * (self.first - psi) - rate * r * self.length / self.speed
            helm = float(np.clip(helm, -_MOST_HELM, _MOST_HELM))
        # Zig-zag: reverse the helm when the heading has changed by the check angle.
        if leg.check:
            if self.helm_to * (psi - self.first) > leg.check:
                self.helm_to = -self.helm_to
            helm = self.helm_to * leg.helm
        return _orders(self.units, self.shafts, leg.power, helm, self.side * leg.bow)
