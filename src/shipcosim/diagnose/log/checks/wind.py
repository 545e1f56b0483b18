"""Wind channels that are not what they are labelled: the wind over ground must neither turn nor move with the ship."""

import numpy as np

from shipcosim.diagnose.finding import Finding, Segment
from shipcosim.diagnose.log.checks.kinematics import (
    Filter,
    Motion,
    after_gaps,
    complete_rows,
    filter_for,
    whiteness,
)
from shipcosim.diagnose.log.checks.segments import best_segment, in_segment
from shipcosim.diagnose.log.mislabels import KNOT, WIND_LABELS, finding_of
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log.thresholds import (
    BESIDE_SEGMENT,
    LABEL_CLIP,
    LABEL_GAIN,
    STEADIER,
    WIND_AVERAGING,
    WIND_GOES_ON,
    WIND_JUMP,
    WIND_SLOPE_NEAR,
    WIND_SLOPE_STD,
    WIND_UNIT_GAIN,
)
from shipcosim.diagnose.numerics import gaussian_filter

ROLES = ("wind_speed", "wind_from", "heading", "surge", "sway")
BOW = "from the bow"
MIRRORED = "mirrored"
NORTH = "from north"
SLOPES = {BOW: {"kn": KNOT, "m/s": 1.0 / KNOT, "over ground": 0.0}}
SLOPES |= {MIRRORED: {"apparent": 1.0}, NORTH: {"apparent": 1.0, "over ground": 0.0}}
LABEL = {
    (MIRRORED, "apparent"): WIND_LABELS[0],
    (NORTH, "apparent"): WIND_LABELS[1],
    (BOW, "over ground"): WIND_LABELS[2],
    (NORTH, "over ground"): WIND_LABELS[3],
    (BOW, "m/s"): WIND_LABELS[4],
    (BOW, "kn"): WIND_LABELS[5],
}


def mislabelled_wind(log: dict) -> list[Finding]:
    """Mislabelled wind channels, at most one.

    The apparent wind as a vector over north and east is the wind over ground less the ship's velocity. First the
    direction: read as labelled, mirrored, or from north, it turns with the ship under the wrong ones. Then how the
    vector follows the ship's velocity: one to one if it is what it should be, not at all if it is the wind over
    ground, by another factor if its unit is another.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; labels corrected.
    """
    rows = complete_rows(log, ROLES)
    if len(rows) < 100:
        return []
    time, speed, wind_from, heading, surge, sway = (log[role][rows] for role in ("time", *ROLES))
    # Velocity over ground, and the wind over north and east
    # with the direction as labelled, mirrored, or from north.
    velocity = (surge + 1j * sway) * np.exp(1j * np.radians(heading))
    angles = {BOW: wind_from + heading, MIRRORED: heading - wind_from, NORTH: wind_from}
    winds = {name: _axes(speed * np.exp(1j * np.radians(angle))) for name, angle in angles.items()}
    motion = Motion(time, _axes(velocity), _axes(velocity), after_gaps(time))
    # The wind sensor averages, so compare with the velocity averaged over the same time.
    width = WIND_AVERAGING / np.median(np.diff(time))
    slow = gaussian_filter(motion.velocity, width, axis=0)
    # What is left is the wind over ground: a random walk
    # with noise, with its own filter for each reading.
    levels = np.stack([wind - slow for wind in winds.values()], axis=2)
    filters = dict(zip(winds, filter_for(motion, levels), strict=True))
    # First how the direction is counted, then unit and frame of the speed in that reading.
    frame, segment, gain = _frame(time, winds, slow, filters)
    smooth = gaussian_filter(winds[frame], width, axis=0)
    return _finding(time, winds[frame], smooth, slow, filters[frame], frame, segment, gain)


def _axes(vector):
    return np.column_stack([vector.real, vector.imag])


def _frame(time, winds, slow, filters):
    """Convention of the direction, the segment, and the evidence; by default the logged label."""
    likely = {}
    # Log-likelihood of each row as apparent wind or as wind
    # over ground, whichever is likelier in the whole log.
    for name, whitener in filters.items():
        white = [whitener(wind_less) for wind_less in (winds[name] - slow, winds[name])]
        rows = [-0.5 * np.sum(np.clip(w, -LABEL_CLIP, LABEL_CLIP) ** 2, axis=1) for w in white]
        likely[name] = rows[int(rows[1].sum() > rows[0].sum())] - 2.0 * np.log(
            whitener.std * whitener.scale
        )
    best = (BOW, None, 0.0)
    # Best segment for each other reading. The wind over ground
    # must also be steadier there, as gusts can mimic evidence.
    for name in (MIRRORED, NORTH):
        gain, segment = best_segment(time, likely[name] - likely[BOW])
        rough = whiteness(in_segment(filters[name](winds[name] - slow), time, segment))
        steadier = _steadiness(winds[name], time, segment) - _steadiness(winds[BOW], time, segment)
        if gain / rough > max(LABEL_GAIN, best[2]) and steadier > STEADIER:
            best = (name, segment, gain / rough)
    return best


def _steadiness(wind, time, segment):
    """Length of the mean vector over the mean length: 1 for a steady wind, less if it turns with the ship."""
    wind = in_segment(wind, time, segment)
    return float(np.hypot(*wind.mean(axis=0)) / max(np.hypot(*wind.T).mean(), 1e-9))


def _finding(time, wind, smooth, slow, whitener: Filter, frame, segment, gain):
    """The mislabel that the slope on the ship's velocity leaves over."""
    # Whitened regression of the wind on the ship's velocity:
    # the slope tells apparent wind from wind over ground.
    y = whitener(wind)
    x = whitener(slow)
    if frame == BOW:
        return _unit(time, y, x, whitener(smooth), wind, slow)
    # Posterior of each kind by the distance of the slope from its value.
    slope, std = _slope(in_segment(y, time, segment), in_segment(x, time, segment))
    kinds = SLOPES[frame]
    weights = {
        kind: np.exp(-0.5 * ((slope - b) / np.hypot(std, 0.1)) ** 2) + 1e-12
        for kind, b in kinds.items()
    }
    kind = max(weights, key=lambda name: weights[name])
    return [_named(LABEL[frame, kind], segment, gain, weights[kind] / sum(weights.values()))]


def _unit(time, y, x, smooth, wind, slow):
    """Another unit, or the wind over ground with its direction from the bow, if the slope clearly says so."""
    findings = []
    # For each slope the gain in log-likelihood over slope 1, in rows, and the segment of most gain.
    for kind, b in SLOPES[BOW].items():
        gains = 0.5 * np.sum(
            np.clip(y - x, -LABEL_CLIP, LABEL_CLIP) ** 2
            - np.clip(y - b * x, -LABEL_CLIP, LABEL_CLIP) ** 2,
            axis=1,
        )
        gain, segment = best_segment(time, gains)
        # Weigh the evidence by the correlation of the
        # residuals; a unit of the whole log needs more.
        rough = whiteness(in_segment(y - b * x, time, segment))
        if gain / rough < (LABEL_GAIN if segment else WIND_UNIT_GAIN):
            continue
        # The slope must be near that of the unit, for the wind as
        # logged and smoothed: noise affects these differently.
        slope, std = _slope(in_segment(y, time, segment), in_segment(x, time, segment))
        also, _ = _slope(in_segment(smooth, time, segment), in_segment(x, time, segment))
        near = all(abs(estimate - b) < max(WIND_SLOPE_NEAR * b, 0.2) for estimate in (slope, also))
        # A unit changes the speed by its factor at both ends,
        # and corrected the wind goes on as beside the segment.
        near &= b == 0.0 or leaps(time, np.hypot(*wind.T), segment, b)
        near &= _goes_on(time, wind - slow, wind / b - slow if b else wind, segment)
        # The slope must be precise, and clearly not 1.
        if near and std < WIND_SLOPE_STD * max(b, 1.0) and abs(slope - 1.0) > 3.0 * std:
            findings.append(
                _named(LABEL[BOW, kind], segment, gain / rough + (0.0 if segment else 6.0), 1.0)
            )
    return sorted(findings, key=lambda finding: -finding.probability)[:1]


def leaps(time: np.ndarray, speed: np.ndarray, segment: Segment | None, factor: float) -> bool:
    """Whether the wind speed changes by a factor about where a segment begins and ends; true of the whole log.

    Parameters
    ----------
    time, speed : (n,) arrays
        [s, m/s]
    segment : (float, float) or None
        [s]
    factor : float
        Logged wind speed inside over that outside.
    """
    # Compare medians close to the ends of the segment, where the wind itself has hardly changed.
    here, outside = _about(time, segment)
    if not here.any() or not outside.any():
        return True
    return bool(
        abs(np.log(np.median(speed[here]) / np.median(speed[outside]) / factor)) < WIND_JUMP
    )


def _goes_on(time, labelled, right, segment):
    """Whether the corrected wind over ground continues through a segment better than the logged one.

    The ship's own way makes the wind that she meets stronger and weaker too, most of all that of a fast small craft.
    """
    here, outside = _about(time, segment)
    # Without neighbours there is nothing to compare.
    if not here.any() or not outside.any():
        return True
    usual = labelled[outside].mean(axis=0)
    off, off_labelled = (np.hypot(*(wind[here].mean(axis=0) - usual)) for wind in (right, labelled))
    return bool(off < WIND_GOES_ON * off_labelled)


def _about(time, segment):
    """Rows of a segment near its ends, and rows outside of it near them; empty for the whole log."""
    if segment is None:
        return np.zeros((2, len(time)), bool)
    here = inside(time, [segment])
    near = inside(time, [(end - BESIDE_SEGMENT, end + BESIDE_SEGMENT) for end in segment])
    return near & here, near & ~here


def _slope(y, x):
    # Least squares in units of the noise: slope and standard error.
    energy = max(float(np.sum(x * x)), 1e-9)
    return float(np.sum(x * y)) / energy, energy**-0.5


def _named(label, segment, gain, share):
    # Logistic function of the evidence over its threshold, times the share among the kinds.
    probability = float(share / (1.0 + np.exp(LABEL_GAIN - 6.0 - gain)))
    return finding_of(label, probability, segment)
