"""Wind channels that are not what they are labelled in a part of the log: at both its ends the wind jumps.

No wind changes from one second to the next by just the factor of another unit, or by just the ship's heading, and back
again. So it does not take a ship that moves or turns to see it.
"""

import numpy as np

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.kinematics import complete_rows
from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of
from shipcosim.diagnose.log.thresholds import (
    BESIDE_JUMP,
    BETWEEN_JUMPS,
    CALM_WIND,
    JUMP_GAIN,
    JUMPS_GAIN,
    JUMPS_TIED,
    STEADINESS_LAG,
)

ROLES = ("wind_speed", "wind_from", "heading", "surge", "sway")


def jumping_wind(log: dict) -> list[Finding]:
    """Segments of mislabelled wind channels that begin and end with a jump; at most one finding.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; headings without jumps; labels put right.
    """
    rows = complete_rows(log, ROLES)
    if len(rows) < 4 * BETWEEN_JUMPS:
        return []
    part = {role: log[role][rows] for role in ("time", *ROLES)}
    logged = _wind(part)
    found = []
    for label in WIND_LABELS:
        undone = _wind(part | label.undo(part))
        gain, first, last = _best_pair(logged, undone)
        if gain > JUMPS_GAIN:
            segment = float(part["time"][first]), float(part["time"][last])
            found.append((gain, label, segment, _unsteadiness(undone[first:last])))
    if not found:
        return []
    most = max(gain for gain, *_ in found)
    gain, label, segment, _ = min(
        (entry for entry in found if entry[0] > most - JUMPS_TIED), key=lambda entry: entry[3]
    )
    probability = float(0.99 / (1.0 + np.exp(-gain)))
    return [finding_of(label, probability, segment)]


def _wind(part):
    """The wind over ground as a vector: the one that a fast craft meets changes with her speed. [m/s]"""
    apparent = part["wind_speed"] * np.exp(1j * np.radians(part["wind_from"] + part["heading"]))
    return apparent - (part["surge"] + 1j * part["sway"]) * np.exp(1j * np.radians(part["heading"]))


def _unsteadiness(wind):
    """Change of the wind over ground in a segment: what is too much in it goes with the ship. [m2/s2]"""
    return float(np.mean(np.abs(wind[STEADINESS_LAG:] - wind[:-STEADINESS_LAG]) ** 2))


def _best_pair(logged, undone):
    """Gain of undoing a mislabel between two rows, less the cost of choosing them, and the first and last row."""
    before, after = _means(logged)
    before_undone, after_undone = _means(undone)
    # Usual size of jumps, as if they were normal.
    scale = 1.4826 * np.median(np.abs(_jump(before, after)), axis=0) + 0.02
    begins = _gain(_jump(before, after), _jump(before, after_undone), scale)
    ends = _gain(_jump(before, after), _jump(before_undone, after), scale)
    begins, ends = (np.where(gain > JUMP_GAIN, gain, -np.inf) for gain in (begins, ends))
    best = np.maximum.accumulate(begins)[: len(begins) - BETWEEN_JUMPS] + ends[BETWEEN_JUMPS:]
    if not np.isfinite(best).any():
        return -np.inf, 0, 0
    end = int(np.argmax(best))
    first = int(np.argmax(begins[: end + 1])) + BESIDE_JUMP
    last = end + BETWEEN_JUMPS + BESIDE_JUMP - 1
    return float(best[end]) - 2.0 * np.log(len(begins)), first, last


def _means(wind):
    """Mean wind over the rows before each row, and over those from it on."""
    total = np.cumsum(np.r_[0.0, wind])
    means = (total[BESIDE_JUMP:] - total[:-BESIDE_JUMP]) / BESIDE_JUMP
    return means[:-BESIDE_JUMP], means[BESIDE_JUMP:]


def _jump(before, after):
    """Change of speed as a logarithm, and of direction in radians: (n, 2)."""
    speeds = [np.log(np.maximum(np.abs(mean), CALM_WIND)) for mean in (before, after)]
    return np.column_stack([speeds[1] - speeds[0], np.angle(after * np.conj(before))])


def _gain(given, otherwise, scale):
    return 0.5 * np.sum((given / scale) ** 2 - (otherwise / scale) ** 2, axis=1)
