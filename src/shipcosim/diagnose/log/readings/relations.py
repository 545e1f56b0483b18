"""What holds between channels of a whole log: position against velocity, heading against rate, wind against heading.

With position p and velocity w as complex numbers and E = exp(i heading), the change of position is the integral of w E.
Any mistake of a sign, a frame or a unit makes it c times the integral of another *form*, such as conj(w) E or w alone,
with a complex factor c: its size is a matter of units and of the time base, its angle of frames. So a few forms, each
with c and with what is left unexplained, hold all that a log says about such mistakes.

Increments over a horizon are compared. The horizon is the one that tells most: it follows from the motion of the craft
and from the noise, not from a time of its own, so a time base that is wrong by a thousand does no harm.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from shipcosim.angles import wrap_series
from shipcosim.diagnose.log.thresholds import (
    ALONGSIDE,
    CLEARLY_APART,
    FEWEST_INCREMENTS,
    LARGEST_TURN,
    LITTLE_EXPLAINED,
    LONGEST_BRIDGE,
    MOST_INCREMENTS,
    RELATION_WINDOWS,
    ROBUST_ROUNDS,
    ROBUST_SHARE,
    TURNED_TOO_FAR,
)

__all__ = ["FORMS", "Relation", "position_relations", "rate_relations", "steadiness"]

FORMS = {
    ("as is", "body"): lambda w, e: w * e,
    ("mirrored", "body"): lambda w, e: np.conj(w) * e,
    ("as is", "mirrored"): lambda w, e: w * np.conj(e),
    ("mirrored", "mirrored"): lambda w, e: np.conj(w) * np.conj(e),
    ("as is", "earth"): lambda w, e: w,
    ("mirrored", "earth"): lambda w, e: np.conj(w),
}
"""Forms of the velocity over ground, by how surge and sway are taken and by what turns them."""


@dataclass(frozen=True)
class Relation:
    """One relation in one form: seen = c * told.

    Attributes
    ----------
    factor : complex
        Logarithm of c: of its size, and i times its angle. [1, rad]
    std : (float, float)
        Of both parts.
    unexplained : float
        Share of what is seen that is not c times what is told.
    count : float
        Independent increments.
    throughout : float
        Share of the log, by how much is seen to change, in which the relation holds.
    """

    factor: complex
    std: tuple[float, float]
    unexplained: float
    count: float
    throughout: float

    @property
    def evidence(self) -> float:
        """What it explains, of each of its axes as a log-likelihood. [nats]"""
        return -min(self.count, MOST_INCREMENTS) * math.log(self.unexplained + 1e-9)


def position_relations(log: dict, headings: dict, positions: dict) -> dict:
    """Position against velocity in each of the forms; empty where there is too little of them.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s], `surge` and `sway` [m/s].
    headings : dict of (n,) arrays
        By how they are read. [deg]
    positions : dict of (n,) complex arrays
        North and i times east, by how they are read. [m]

    Returns
    -------
    dict of (heading, position) to dict of form to Relation
    """
    velocity = log["surge"] + 1j * log["sway"]
    known = np.isfinite(velocity) & np.all([np.isfinite(v) for v in (*headings.values(), *positions.values())], axis=0)
    rows = np.flatnonzero(known)
    if len(rows) < 2 * FEWEST_INCREMENTS:
        return {}
    time, pairs = log["time"][rows], {}
    for heading, values in headings.items():
        if not _can_be_followed(wrap_series(np.diff(values[rows]))):
            continue
        turn = np.exp(1j * np.radians(values[rows]))
        ways = {form: _integral(time, change(velocity[rows], turn)) for form, change in FORMS.items()}
        for position, seen in positions.items():
            pairs |= {(heading, position, form): (seen[rows], way) for form, way in ways.items()}
    found: dict = {}
    for (heading, position, form), relation in _most_telling(time, pairs).items():
        found.setdefault((heading, position), {})[form] = relation
    return found


def rate_relations(time: np.ndarray, headings: dict, rate: np.ndarray) -> dict:
    """Heading against yaw rate; nothing where there is too little, or rows are too far apart to count turns.

    Parameters
    ----------
    time, rate : (n,) arrays
        [s, deg/s]
    headings : dict of (n,) arrays
        By how they are read. [deg]

    Returns
    -------
    dict of heading to Relation
    """
    rows = np.flatnonzero(np.isfinite(rate) & np.all([np.isfinite(v) for v in headings.values()], axis=0))
    if len(rows) < 2 * FEWEST_INCREMENTS:
        return {}
    told, pairs = _integral(time[rows], rate[rows]), {}
    for name, heading in headings.items():
        change = wrap_series(np.diff(heading[rows]))
        if _can_be_followed(change):
            beside = wrap_series(np.diff(heading[rows] - told))  # she can turn by more than half a turn between rows
            if not _can_be_followed(np.diff(told)) and np.quantile(np.abs(beside), 0.9) < ALONGSIDE:
                change = np.diff(told) + beside
            pairs[name] = np.r_[0.0, np.cumsum(change)].astype(complex), told.astype(complex)
    return _most_telling(time[rows], pairs)


def _can_be_followed(turns):
    return np.quantile(np.abs(turns), 1.0 - TURNED_TOO_FAR) <= LARGEST_TURN


def _integral(time, series):
    """By a spline: the trapezium loses a tenth of a motion with six rows a period."""
    return CubicSpline(time, series).antiderivative()(time)


def _most_telling(time, pairs):
    """The relation of each pair of what is seen and told: its factor over the horizon at which it is most certain.

    What is left unexplained is compared over one horizon for all of them, that at which they differ most.
    """
    factors, shares, most = {}, {}, -np.inf
    for horizon in _horizons(len(time)):
        first, count = _starts(time, horizon)
        if count < FEWEST_INCREMENTS or not pairs:
            continue
        relations = {
            key: _relation(seen[first + horizon] - seen[first], told[first + horizon] - told[first], count)
            for key, (seen, told) in pairs.items()
            if np.ptp(told) and np.ptp(seen)
        }
        if not relations:
            return {}
        for key, relation in relations.items():
            if key not in factors or np.hypot(*relation.std) < np.hypot(*factors[key].std):
                factors[key] = relation
        likely = np.array([relation.evidence for relation in relations.values()])
        apart = float(np.sum(np.minimum(likely.max() - likely, CLEARLY_APART))) + 1e-6 * float(likely.max())
        if apart > most:
            shares, most = relations, apart
    said = ("unexplained", "count", "throughout")
    if not shares or min(share.unexplained for share in shares.values()) > LITTLE_EXPLAINED:
        return {}
    return {k: replace(factors[k], **{name: getattr(share, name) for name in said}) for k, share in shares.items()}


def _horizons(rows) -> Iterator[int]:
    """Rows of a horizon, doubled from one to the next."""
    horizon = 1
    while horizon * FEWEST_INCREMENTS <= rows:
        yield horizon
        horizon *= 2


def _starts(time, horizon):
    """Rows at which increments over a number of rows begin, none across a hole; and how many are independent."""
    steps = np.diff(time, prepend=time[0])
    holes = np.cumsum(steps > LONGEST_BRIDGE * np.median(steps[1:]))
    stride = max(1, horizon // 4)
    first = np.arange(0, len(time) - horizon, stride)
    first = first[holes[first] == holes[first + horizon]]
    return first, len(first) * stride / horizon


def _relation(seen, told, count):
    """The relation of increments, by the windows of a log that agree best."""
    windows = np.array_split(np.arange(len(seen)), min(RELATION_WINDOWS, max(4, int(count / 2))))
    sums = np.array([_products(seen[w], told[w]) for w in windows])
    kept = np.ones(len(sums), bool)
    for _ in range(ROBUST_ROUNDS):
        factor = _factor(sums[kept].sum(axis=0))
        left = _left(sums, np.exp(factor))
        kept = left <= np.quantile(left, ROBUST_SHARE)
    both = sums[kept]
    seen2, told2, product = both.sum(axis=0)
    explained = min(float(np.abs(product) ** 2 / (seen2 * told2).real), 1.0) if (seen2 * told2).real > 0.0 else 0.0
    apart = np.array([_factor(both.sum(axis=0) - one) for one in both])
    spread = [np.sqrt((len(both) - 1) * np.mean(np.square(part))) for part in _parts(apart, _factor(both.sum(axis=0)))]
    regressions = -0.5 * np.log(max(explained, 1e-12))  # each way, noise makes the slope too small or too large
    stds = float(np.hypot(spread[0], regressions)), float(np.hypot(spread[1], 1e-6))
    factor = _factor(both.sum(axis=0))
    return Relation(factor, stds, 1.0 - explained, count * float(kept.mean()), _throughout(sums, np.exp(factor)))


def _throughout(sums, factor):
    """Share of what is seen to change in windows in which a factor explains it; no window counts for many."""
    seen = np.minimum(sums[:, 0].real, np.quantile(sums[:, 0].real, ROBUST_SHARE))
    holds = _left(sums, factor) < 0.5 * sums[:, 0].real
    return float(seen[holds].sum() / max(seen.sum(), 1e-300))


def _products(seen, told):
    return np.array([np.vdot(seen, seen), np.vdot(told, told), np.vdot(told, seen)])


def _factor(sums):
    """Logarithm of the factor between both, by their sizes and by the angle of their product."""
    seen2, told2, product = sums
    return 0.5 * np.log((seen2.real + 1e-300) / (told2.real + 1e-300)) + 1j * np.angle(product)


def _left(sums, factor):
    """What a factor leaves in each window."""
    return (sums[:, 0] - 2.0 * np.conj(factor) * sums[:, 2]).real + np.abs(factor) ** 2 * sums[:, 1].real


def _parts(apart, whole):
    """Deviation of sizes, and of angles the short way round."""
    return apart.real - whole.real, np.angle(np.exp(1j * (apart.imag - whole.imag)))


def steadiness(wind: np.ndarray) -> float:
    """Length of the mean over the mean length: 1 for a steady wind, less for one that turns with the ship.

    Parameters
    ----------
    wind : (n,) complex array
        [m/s]
    """
    return float(np.abs(np.mean(wind)) / max(np.mean(np.abs(wind)), 1e-9))
