"""Faults of size: velocity or rate to scale, turned axes, a clock that runs wrong for a while, rows that were lost.

Each is a column of the residual steps. They are chosen one after the other, the most evident first, and fitted
together with the nuisances and the noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.noise import Fit, evidence, fit
from shipcosim.diagnose.slope import SLOW_SPANS, slope_bounds
from shipcosim.diagnose.steps import Steps

__all__ = ["Suspect", "sized"]

LEAST_GAIN = 8.0  # nats of a fault of the whole log; segments and jumps pay for their choice besides
SLAB = {"scale": 0.2, "turn": 0.3, "rate scale": 0.2, "clock": 0.3}  # typical size
TOLERANCE = {"scale": 0.01, "turn": 0.02, "rate scale": 0.01, "clock": 0.03, "lost": 1.5}  # no fault yet
BLOCKS = 300  # of a log, in which a clock is sought
SHORTEST = 15  # steps of a segment of wrong clock
MOST = 40  # faults
SEGMENT_COST = 2.0 * np.log(80.0)  # nats, for the choice among segments of half a minute and more
JUMP_COST = 20.0  # nats, for heavy tails of the noise
EDGE_REACH = 300  # steps in which the end of a segment is sought
MEMORY = 150  # steps that a jump is seen after it


@dataclass(frozen=True)
class Suspect:
    """A fault with its size.

    Parameters
    ----------
    name : str
        `scale`, `turn`, `rate scale`, `clock`, `lost` or `jump`.
    gain : float
        Evidence, less what the search costs. [nats]
    rows : slice
        Steps that it concerns.
    column : (n, 3) array
        Change of the residual steps by a fault of unit size.
    value, std : float
        Its size: share, share, rad, share, s.
    apart : tuple of (float, float)
        The size by position alone and by heading alone, each with standard deviation (infinite where it cannot say).
    """

    name: str
    gain: float
    rows: slice
    column: np.ndarray
    value: float = 0.0
    std: float = np.inf
    apart: tuple[tuple[float, float], ...] = ()


def sized(steps: Steps) -> tuple[list[Suspect], Fit]:
    """Faults of size in residual steps, and the fit with them."""
    chosen: list[Suspect] = []
    jumps: list[Suspect] = []
    while len(chosen) + len(jumps) < MOST:
        fitted = _fit(steps, chosen)
        best = max(_candidates(steps, fitted, chosen), key=lambda suspect: suspect.gain, default=None)
        if best is None or best.gain < LEAST_GAIN:
            break
        if best.name in ("lost", "jump"):
            jumps.append(best)
            steps = _broken(steps, best.rows)
        else:
            chosen.append(best)
    chosen, fitted = _kept(steps, chosen)
    return [*chosen, *jumps], fitted


def _broken(steps, rows):
    """The steps with nothing known of some of them."""
    parts = {name: getattr(steps, name).copy() for name in ("residual", "motion", "nuisances", "known")}
    for values in parts.values():
        values[rows] = 0
    return replace(steps, **parts)


def _fit(steps, chosen):
    columns = np.concatenate([steps.nuisances, *(s.column[:, :, None] for s in chosen)], axis=2)
    return fit(steps.residual, steps.known, columns, np.r_[steps.spikes, [SLAB[s.name] for s in chosen]])


def _candidates(steps, fitted, chosen):
    """The most evident fault of each sort that is not chosen yet."""
    yield from _whole(steps, fitted, chosen)
    for candidate in (_clock(steps, fitted), _jump(steps, fitted)):
        if candidate is not None:
            yield candidate


def _whole(steps, fitted, chosen):
    """Faults of the whole log."""
    position, heading = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    turned = np.column_stack([-steps.motion[:, 1], steps.motion[:, 0], 0.0 * steps.motion[:, 2]])
    columns = {
        "scale": steps.motion * position,
        "rate scale": steps.motion * heading,
        "clock": steps.motion,
        "turn": turned,
    }
    everything, taken = slice(0, len(steps.time)), {s.name for s in chosen if _is_whole(s, steps)}
    for name, column in columns.items():
        if name in taken or taken & {"clock"} and name != "turn":
            continue
        gain, value, std = (x[0] for x in fitted.gain(fitted.whiten(column[:, :, None]), SLAB[name]))
        suspect = Suspect(name, gain, everything, column, value, std)
        if abs(value) > TOLERANCE[name] and (name == "turn" or _is_beyond_noise(suspect, steps)):
            yield suspect


def _is_whole(suspect, steps):
    return suspect.rows.stop - suspect.rows.start == len(steps.time)


def _is_beyond_noise(suspect, steps):
    """Whether noise in the motion itself, which makes slopes too small, cannot be what shows."""
    seen = steps.residual + steps.motion
    axes = {"scale": [(0, 2)], "rate scale": [(2, 3)], "clock": [(0, 2), (2, 3)]}[suspect.name]
    for first, last in axes:
        parts = (x[:, first:last] for x in (seen, steps.motion, steps.known))
        low, high = slope_bounds(*parts, SLOW_SPANS)
        if low <= 1.0 <= high:
            return False
    return True


def _clock(steps, fitted):
    """The segment in which the clock runs most evidently wrong."""
    count = len(steps.time)
    edges = np.unique(np.linspace(0, count, min(BLOCKS, count // 5) + 1).astype(int))
    if len(edges) < 4:
        return None
    columns = np.zeros((count, 3, len(edges) - 1))
    for block, (first, last) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        columns[first:last, :, block] = steps.motion[first:last]
    match, energy = _projected(fitted, fitted.whiten(columns))
    matches = np.r_[0.0, np.cumsum(match)]
    energies = np.zeros((len(edges), len(edges)))
    energies[1:, 1:] = np.cumsum(np.cumsum(energy, axis=0), axis=1)
    own = np.diag(energies)
    span_energy = own[None, :] - energies - energies.T + own[:, None]
    nats, value, _ = evidence(matches[None, :] - matches[:, None], span_energy, SLAB["clock"])
    longest = 0.9 * count
    span = edges[None, :] - edges[:, None]
    nats[(span < SHORTEST) | (span > longest) | (np.abs(value) < TOLERANCE["clock"])] = -np.inf
    nats[(value < 0.0) & (value > -2.0 * _noise_share(fitted, span, span_energy))] = -np.inf
    first, last = np.unravel_index(np.argmax(nats), nats.shape)
    if not np.isfinite(nats[first, last]):
        return None
    return _refined(steps, fitted, int(edges[first]), int(edges[last]), int(edges[1]) * 2)


def _projected(fitted, columns):
    """Match and energy of columns (n, 3, k), whitened, beside what is fitted: (k,) and (k, k)."""
    flat, own = columns.reshape(-1, columns.shape[2]), fitted.columns.reshape(-1, fitted.columns.shape[2])
    shared = own.T @ flat
    prior = own.T @ fitted.rest.ravel() - fitted.precision * fitted.values
    match = flat.T @ fitted.rest.ravel() - shared.T @ (fitted.cov @ prior)
    return match, flat.T @ flat - shared.T @ fitted.cov @ shared


def _noise_share(fitted, count, energy):
    """Share of the motion's energy that can be noise of velocity and rate: it makes them look too large."""
    noise = sum(w.gain / (2.0 - w.gain) for w in fitted.whiteners if w is not None)
    return np.minimum(1.0, np.maximum(count, 0) * noise / np.maximum(energy, 1e-9))


def _refined(steps, fitted, first, last, reach):
    """The segment with its ends where the evidence puts them, and its size by position and by heading alone."""
    count = len(steps.time)
    for stride, pick in ((1, np.argmax), (max(1, EDGE_REACH // 75), _middle)):
        around = np.arange(-reach, reach + 1) if stride == 1 else stride * np.arange(-75, 76)
        for end in (0, 1, 0, 1) if stride == 1 else (0, 1):
            places = np.unique(np.clip(np.r_[around, 0] + (first, last)[end], 0, count))
            spans = [(int(at), last) if end == 0 else (first, int(at)) for at in places]
            spans = [(a, b) for a, b in spans if b - a >= SHORTEST]
            columns = np.stack([_inside(steps.motion, a, b) for a, b in spans], axis=2)
            nats, _, _ = fitted.gain(fitted.whiten(columns), SLAB["clock"])
            first, last = spans[int(pick(nats))]
    column = _inside(steps.motion, first, last)
    parts = np.stack([column, column * [1, 1, 0], column * [0, 0, 1]], axis=2)
    nats, values, stds = fitted.gain(fitted.whiten(parts), SLAB["clock"])
    gain = nats[0] / _roughness(fitted, first, last) - SEGMENT_COST
    apart = tuple(zip(values[1:], stds[1:], strict=True))
    return Suspect("clock", gain, slice(first, last), column, values[0], stds[0], apart)


def _middle(nats):
    """Median place by the evidence of each: where a ship hardly moves an end can be anywhere."""
    weights = np.exp(nats - nats.max())
    return np.searchsorted(np.cumsum(weights), 0.5 * weights.sum())


def _inside(values, first, last):
    column = np.zeros_like(values)
    column[first:last] = values[first:last]
    return column


def _roughness(fitted, first, last):
    """How much larger than elsewhere the noise is just outside a segment, at least 1."""
    length = last - first
    around = np.r_[fitted.rest[max(0, first - length) : first], fitted.rest[last : last + length]]
    return max(1.0, float(np.mean(around**2)) / max(float(np.mean(fitted.rest**2)), 1e-12))


def _jump(steps, fitted):
    """The step at which position or heading jumps most evidently: rows lost there, or another reference."""
    count = len(steps.time)
    nats = np.zeros(count)
    for axis, whitener in enumerate(fitted.whiteners):
        if whitener is not None:
            response = whitener.response(min(MEMORY, count))
            match = np.correlate(np.r_[fitted.rest[:, axis], np.zeros(len(response) - 1)], response, "valid")
            size = 0.5 if axis == 2 else 20.0
            nats += evidence(match, response @ response, size)[0] * steps.known[:, axis]
    at = int(np.argmax(nats))
    rows = slice(max(0, at - 1), at + 2)
    lost, std = _lost(steps, fitted, at, rows)
    name, value = ("lost", lost) if lost > max(TOLERANCE["lost"], 4.0 * std) else ("jump", 1.0)
    column = np.zeros_like(steps.residual)
    column[rows] = steps.residual[rows]
    return Suspect(name, float(nats[at] - np.log(count) - JUMP_COST), rows, column, value, std)


def _lost(steps, fitted, at, rows):
    """Seconds of motion that explain a jump, with standard deviation: infinite if the jump is no such motion."""
    near = slice(max(0, at - 5), at + 6)
    pace = np.median(steps.motion[near], axis=0) / np.median(np.diff(steps.time))
    noise = np.array([w.std if w else np.inf for w in fitted.whiteners]) * np.sqrt(2.0)
    jump, weight = steps.residual[rows].sum(axis=0), 1.0 / noise**2
    energy = np.sum(weight * pace**2)
    if energy < 1e-9:
        return 0.0, np.inf
    lost = np.sum(weight * pace * jump) / energy
    explained = 1.0 - np.sum(weight * (jump - lost * pace) ** 2) / np.sum(weight * jump**2)
    return (float(lost), float(energy**-0.5)) if explained > 0.8 else (0.0, np.inf)


def _kept(steps, chosen):
    """The suspects with the sizes of the joint fit, without those that it makes small."""
    while True:
        fitted = _fit(steps, chosen)
        count = len(steps.spikes)
        sizes = [(fitted.values[count + i], np.sqrt(fitted.cov[count + i, count + i])) for i in range(len(chosen))]
        final = [replace(s, value=float(v), std=float(d)) for s, (v, d) in zip(chosen, sizes, strict=True)]
        weak = [s for s in final if abs(s.value) < max(TOLERANCE[s.name], 3.0 * s.std)]
        if not weak:
            return final, fitted
        weakest = min(weak, key=lambda s: abs(s.value) / s.std)
        chosen = [s for s, f in zip(chosen, final, strict=True) if f is not weakest]
