"""Parts of a log in which a channel of the navigation is much noisier than elsewhere: rougher seas, or a worse receiver."""

import numpy as np

from shipcosim.angles import unwrap_series
from shipcosim.diagnose.log.checks.samples import quantum
from shipcosim.diagnose.log.checks.segments import best_segment
from shipcosim.diagnose.log.roles import NAVIGATION, ROLES
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.log.thresholds import (
    CALM_SHARE,
    FEWEST_FITTED,
    NOISIER_PART,
    NOISIER_PART_CLIP,
    NOISIER_PART_GAIN,
)
from shipcosim.diagnose.numerics import noise_by_differences, normal_size


def noisier_parts(log: dict) -> list[str]:
    """One sentence for each channel of the navigation that is much noisier in a part of the log than elsewhere.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s], increasing, and roles in their units.
    """
    sentences = []
    for role in NAVIGATION:
        if role not in log:
            continue
        values = log[role]
        time, noise = _noise_of_rows(log["time"], values, role == "heading")
        if len(noise) < FEWEST_FITTED:
            continue
        # Noise of the calm parts of the log. A rounded channel has at least the noise of its rounding.
        windows = np.array_split(noise, max(4, len(noise) // 60))
        calm = float(np.quantile([_level(window) for window in windows], CALM_SHARE))
        calm = max(calm, 0.3 * quantum(values), 1e-12)
        # Log-likelihood ratio of each row: normal noise that is larger by the factor, against the calm one.
        squares = (noise / calm) ** 2
        gains = 0.5 * squares * (1.0 - NOISIER_PART**-2) - np.log(NOISIER_PART)
        gain, segment = best_segment(time, np.minimum(gains, NOISIER_PART_CLIP))
        if segment is None or gain < NOISIER_PART_GAIN:
            continue
        # The middle of the part and of the rest must differ too: a few large rows are no noisier part.
        there = inside(time, [segment])
        larger, rest = _level(noise[there]), max(_level(noise[~there]), 0.3 * quantum(values))
        if larger < NOISIER_PART * rest:
            continue
        unit = ROLES[role].unit
        sentences.append(
            f"{role}: noise of {larger:.2g} {unit} from {segment[0]:.0f} to {segment[1]:.0f} s, of {rest:.2g} {unit} "
            "elsewhere: one noise is taken for the whole log."
        )
    return sentences


def _noise_of_rows(time, values, is_angle):
    """Times, and the noise of the values there, by their third differences."""
    usable = np.isfinite(values)
    time, values = time[usable], values[usable]
    if is_angle:
        values = np.degrees(unwrap_series(np.radians(values)))
    return time[3:], noise_by_differences(values, 3)


def _level(noise):
    """Standard deviation of the noise of some rows; 0 of none."""
    return float(normal_size(noise)) if len(noise) else 0.0
