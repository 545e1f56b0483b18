"""A yaw rate in rad/s where deg/s is stated: so small that it is below its own rounding, in all of a log or in a part.

Where the ship turns, heading against rate tells it; where she does not, the channel's noise does, which falls by the
same factor of 57 as the rate.
"""

import numpy as np

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.kinematics import heading_motion
from shipcosim.diagnose.log.checks.samples import quantum
from shipcosim.diagnose.log.checks.segments import best_segment, in_segment
from shipcosim.diagnose.log.mislabels import finding_of, mislabel_of_unit
from shipcosim.diagnose.log.thresholds import LIKELY_SIGNS, QUIET_CLIP, QUIET_GAIN, QUIETER
from shipcosim.diagnose.numerics import normal_size

RADIAN = mislabel_of_unit(("yaw_rate",), "rad/s", "deg/s")


def silent_rate(log: dict) -> list[Finding]:
    """A stretch, or a whole log, in which the yaw rate is too quiet to be in deg/s; at most one finding.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used.
    """
    motion = heading_motion(log)
    if motion is None:
        return []
    rate = motion.velocity[:, 0]
    # Resolution of the channel, and second differences as a measure of its noise.
    fine = quantum(rate)
    bends = np.abs(np.diff(rate, n=2, prepend=rate[:2]))
    # The heading turns, while the rate is below its own
    # resolution in the whole log: wrong unit throughout.
    if _is_below_its_resolution(rate, fine) and _turns(motion, None) > 3.0 * np.std(
        motion.slow(rate)
    ):
        return [finding_of(RADIAN, 0.98)] if _signs_turn(motion) else []
    # Usual noise of the log from its noisier windows;
    # below 3 resolutions it cannot be seen to fall.
    windows = np.array_split(bends, max(4, len(bends) // 60))
    usual = float(np.quantile([window.mean() for window in windows], 0.8))
    if usual <= 3.0 * fine:
        return []
    # Log-likelihood ratio of exponential distributions: noise 57 times smaller against usual noise.
    quiet = max(usual / (RADIAN.scale or 1.0), 0.25 * fine)
    gains = np.clip(np.log(usual / quiet) - bends / quiet + bends / usual, -QUIET_CLIP, QUIET_CLIP)
    gain, segment = best_segment(motion.time, gains)
    if segment is None or gain < QUIET_GAIN:
        return []
    # The segment must be much quieter, and the heading must turn more than the rate reports.
    inner = in_segment(bends, motion.time, segment).mean()
    outer = usual
    reported = np.std(in_segment(motion.slow(rate), motion.time, segment))
    if inner > QUIETER * outer or not _turns(motion, segment) > 3.0 * reported:
        return []
    return [finding_of(RADIAN, 0.9, segment)]


def _is_below_its_resolution(rate, fine):
    """Whether little is left but zeros of both signs and single smallest steps."""
    few = np.mean(np.abs(rate) > 1.5 * fine) < 0.1 if fine else not np.any(rate)
    return bool(few and len(np.unique(np.signbit(rate))) == 2)


def _signs_turn(motion):
    """Whether the signs of the rate, also of its zeros, agree with the turning of the heading."""
    sign = 1.0 - 2.0 * np.signbit(motion.velocity)
    turning = np.gradient(motion.seen, motion.time, axis=0)
    reported, seen = (motion.slow(series)[:, 0] for series in (sign, turning))
    return bool(np.corrcoef(reported, seen)[0, 1] > LIKELY_SIGNS)


def _turns(motion, segment):
    """Rate of the heading itself, without its noise, as standard deviation. [deg/s]"""
    rate = motion.slow(np.gradient(motion.seen[:, 0], motion.time))
    smooth = in_segment(motion.slow(rate), motion.time, segment)
    return float(normal_size(smooth - np.median(smooth)))
