"""Channels that are not what they are labelled: swapped, of the other sign, in another frame or unit.

Each suspect is a change of the channels that would undo it. Whether the changed log is the better one is judged by
the evidence of the residual steps, for the whole log and for the stretch where the change helps most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.finding import Estimate, Finding
from shipcosim.diagnose.noise import CLIP, Fit, fit
from shipcosim.diagnose.slope import slope_bounds
from shipcosim.diagnose.steps import Steps, steps_of

__all__ = ["MISLABELS", "Mislabel", "mislabelled", "undo"]

LEAST_GAIN = 20.0  # nats for a whole log; a segment pays for its choice besides
RIVAL = 5.0  # nats within which another explanation is as good
AGREEMENT = 1.15  # factor within which channels of the right units agree
SHORTEST = 30  # steps of a segment
KNOT, KMH, FOOT = 0.514444, 1 / 3.6, 0.3048  # m/s


@dataclass(frozen=True)
class Mislabel:
    """A suspect.

    Parameters
    ----------
    cause : str
        Cause of the contract.
    channels : tuple of str
        Roles that it concerns.
    sentence : str
        What it says of the log.
    undo : callable
        From the log (dict of arrays, SI and rad) to the channels that change.
    scale : float, optional
        Logged over true, for units.
    """

    cause: str
    channels: tuple[str, ...]
    sentence: str
    undo: Callable[[dict], dict]
    scale: float | None = None


def _negative(role):
    return Mislabel("sign", (role,), f"{role} has the other sign", lambda log: {role: -log[role]})


def _swapped(one, other):
    swap = lambda log: {one: log[other], other: log[one]}  # noqa: E731
    return Mislabel("channel_swap", (one, other), f"{one} and {other} are swapped", swap)


def _in_unit(roles, scale, sentence):
    undo = lambda log: {role: log[role] / scale for role in roles}  # noqa: E731
    return Mislabel("frame", roles, sentence, undo, scale)


def _body(north, east):
    """Body-fixed velocity from earth-fixed velocity that stands in these columns."""

    def undo(log):
        cosine, sine = np.cos(log["heading"]), np.sin(log["heading"])
        return {
            "surge": cosine * log[north] + sine * log[east],
            "sway": -sine * log[north] + cosine * log[east],
        }

    return undo


VELOCITY, RATE, HEADING = ("surge", "sway"), ("yaw_rate",), ("heading",)
MISLABELS = {
    "surge and sway swapped": _swapped("surge", "sway"),
    "north and east swapped": _swapped("north", "east"),
    **{f"{role} negative": _negative(role) for role in ("surge", "sway", "yaw_rate", "heading", "north", "east")},
    "velocity earth-fixed": Mislabel(
        "frame", VELOCITY, "surge and sway are the velocity northwards and eastwards", _body("surge", "sway")
    ),
    "velocity earth-fixed, east first": Mislabel(
        "frame", VELOCITY, "surge and sway are the velocity eastwards and northwards", _body("sway", "surge")
    ),
    "velocity in kn": _in_unit(VELOCITY, 1 / KNOT, "surge and sway are in kn, not m/s"),
    "velocity in km/h": _in_unit(VELOCITY, 1 / KMH, "surge and sway are in km/h, not m/s"),
    "velocity in ft/s": _in_unit(VELOCITY, 1 / FOOT, "surge and sway are in ft/s, not m/s"),
    "velocity not in kn": _in_unit(VELOCITY, KNOT, "surge and sway are in m/s, not kn"),
    "velocity not in km/h": _in_unit(VELOCITY, KMH, "surge and sway are in m/s, not km/h"),
    "velocity not in ft/s": _in_unit(VELOCITY, FOOT, "positions are in ft, not m, or surge and sway in m/s, not ft/s"),
    "rate in rad/s": _in_unit(RATE, np.pi / 180, "yaw_rate is in rad/s, not deg/s"),
    "rate not in rad/s": _in_unit(RATE, 180 / np.pi, "yaw_rate is in deg/s, not rad/s"),
    "rate in deg/min": _in_unit(RATE, 60.0, "yaw_rate is in deg/min, not deg/s"),
    "rate not in deg/min": _in_unit(RATE, 1 / 60.0, "yaw_rate is in deg/s, not deg/min"),
    "heading in rad": _in_unit(HEADING, np.pi / 180, "heading is in rad, not deg"),
    "heading not in rad": _in_unit(HEADING, 180 / np.pi, "heading is in deg, not rad"),
    "heading from east": Mislabel(
        "frame",
        HEADING,
        "heading is counted from east, counter-clockwise",
        lambda log: {"heading": 0.5 * np.pi - log["heading"]},
    ),
}


def undo(log: dict, name: str, segments=()) -> dict:
    """The log without that mislabel, within the segments or throughout."""
    changed = MISLABELS[name].undo(log)
    if segments:
        inside = np.any([(log["time"] >= a) & (log["time"] <= b) for a, b in segments], axis=0)
        changed = {role: np.where(inside, values, log[role]) for role, values in changed.items()}
    return log | changed


def mislabelled(log: dict) -> tuple[list[Finding], dict]:
    """Mislabelled channels of a log, most certain first, and the log without them.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` and navigation roles in SI units and rad, NaN where not to be used.
    """
    found = []
    while len(found) < 4 and (finding := _best(log)) is not None:
        log = undo(log, finding.transform, finding.segments)
        found.append(finding)
    return found, log


@dataclass(frozen=True)
class _Trial:
    name: str
    gain: float
    segment: tuple[float, float] | None = None


def _best(log):
    """The mislabel that explains most, None where nothing does well enough."""
    plain = steps_of(log)
    if not plain.known.any():
        return None
    right = fit(plain.residual, plain.known, plain.nuisances, plain.spikes)
    trials = []
    for name, suspect in MISLABELS.items():
        if all(role in log for role in suspect.channels):
            changed = steps_of(undo(log, name))
            trials += [t for t in _trials(name, plain, changed, right) if _is_possible(t, log, changed)]
    trials.sort(key=lambda trial: -trial.gain)
    if not trials or trials[0].gain < LEAST_GAIN:
        return None
    best = trials[0]
    rivals = [t for t in trials[1:] if t.gain > best.gain - RIVAL and t.name != best.name]
    return _finding(best, rivals, log["time"])


def _finding(best, rivals, time):
    suspect = MISLABELS[best.name]
    shares = np.exp([0.0, *(trial.gain - best.gain for trial in rivals), LEAST_GAIN - 5.0 - best.gain])
    parameters = {"scale": Estimate(suspect.scale, 0.0, "1")} if suspect.scale else {}
    return Finding(
        suspect.cause,
        suspect.channels,
        (best.segment,) if best.segment else (),
        parameters,
        float(1.0 / shares.sum()),
        sentence=f"{suspect.sentence}.",
        rivals=tuple(dict.fromkeys(MISLABELS[trial.name].sentence for trial in rivals)),
        transform=best.name,
    )


def _is_possible(trial, log, changed):
    """Whether a change of unit fits what the values can be, not only the size of their noise.

    The changed channels must agree with the others within `AGREEMENT`, and the logged ones must not.
    """
    suspect = MISLABELS[trial.name]
    if suspect.scale is None or trial.gain < LEAST_GAIN:
        return True
    first, last = trial.segment or (-np.inf, np.inf)
    if suspect.channels == HEADING:
        turn = np.nanmax(np.abs(log["heading"])) / (2 * np.pi)
        return trial.segment is None and (turn < 1.01 * suspect.scale if suspect.scale < 1.0 else turn > 1.5)
    axes = slice(2, 3) if suspect.channels == RATE else slice(0, 2)
    rows = (changed.time >= first) & (changed.time <= last)
    seen, motion, known = (x[rows, axes] for x in (changed.residual + changed.motion, changed.motion, changed.known))
    low, high = slope_bounds(seen, motion, known)
    agrees = low < AGREEMENT and high > 1.0 / AGREEMENT
    return agrees and not low < suspect.scale < high and np.isfinite([low, high]).all()


def _trials(name, plain, changed, right):
    """The change throughout, and where it helps most."""
    wrong = fit(changed.residual, changed.known, changed.nuisances, changed.spikes)
    stretch = np.log(_heading_stretch(name))
    whole = _Trial(name, wrong.score - right.score + stretch * np.sum(changed.known[:, 2]))
    noise = _quieter(right, wrong)
    for _ in range(3):
        inside, worth = _stretch(plain, changed, noise, stretch)
        length = inside.stop - inside.start
        if worth < LEAST_GAIN or length < SHORTEST or length > 0.9 * len(plain.time):
            return [whole]
        mixed = _mixture(plain, changed, inside)
        noise = fit(mixed.residual, mixed.known, mixed.nuisances, mixed.spikes)
    segment = (float(plain.time[inside.start]), float(plain.time[inside.stop - 1]))
    gain = noise.score - right.score + stretch * np.sum(changed.known[inside, 2])
    return [whole, _Trial(name, gain - 2 * np.log(len(plain.time)), segment)]


def _heading_stretch(name):
    """By how much the change stretches headings: their noise shrinks alike, which is no merit."""
    suspect = MISLABELS[name]
    return 1.0 / suspect.scale if suspect.scale and suspect.channels == HEADING else 1.0


def _quieter(one: Fit, other: Fit):
    """Of two fits the one whose typical residual is smaller."""
    sizes = [
        sum(np.log(np.median(np.abs(f.rest[:, a])) * w.std + 1e-12) for a, w in enumerate(f.whiteners) if w is not None)
        for f in (one, other)
    ]
    return one if sizes[0] <= sizes[1] else other


def _stretch(plain: Steps, changed: Steps, noise: Fit, stretch: float):
    """Rows in which the changed log fits best over the plain one: the largest sum of their difference; and that."""
    worth = stretch * changed.known[:, 2]
    for steps, sign in ((plain, 1.0), (changed, -1.0)):
        white = np.clip(noise.whiten(steps.residual), -1.5 * CLIP, 1.5 * CLIP)
        worth += sign * 0.5 * np.sum(white**2 * (plain.known & changed.known), axis=1)
    sums = np.r_[0.0, np.cumsum(worth)]
    lows = np.minimum.accumulate(sums)
    stop = int(np.argmax(sums - lows))
    return slice(int(np.argmin(sums[: stop + 1])), stop), float(np.max(sums - lows))


def _mixture(plain: Steps, changed: Steps, inside: slice):
    """The changed log inside, the plain one outside; nothing is known of the steps between."""
    parts = {}
    for field in ("residual", "motion", "nuisances", "known"):
        values = getattr(plain, field).copy()
        values[inside] = getattr(changed, field)[inside]
        for edge in (inside.start, min(inside.stop, len(values) - 1)):
            values[edge] = 0
        parts[field] = values
    return replace(plain, **parts)
