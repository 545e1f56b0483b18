"""Wind channels that are not what they are labelled in a part of the log: at both its ends the wind jumps.

A label changes between two neighbouring rows. So the wind over ground, as logged, makes one of its largest changes from
row to row at either end of the part, and with the label undone one of usual size. What is large and usual the log's own
changes say, whatever their distribution: gusts have no normal one.
"""

import numpy as np

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.kinematics import complete_rows
from shipcosim.diagnose.log.checks.wind import ROLES
from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of
from shipcosim.diagnose.log.thresholds import (
    BETWEEN_JUMPS,
    JUMPS_GAIN,
    JUMPS_TIED,
    LARGEST_JUMPS,
    STEADINESS_LAG,
)


def jumping_wind(log: dict) -> list[Finding]:
    """Segments of mislabelled wind channels that begin and end with a jump; at most one finding.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s] and roles in their units, NaN where not to be used; labels corrected.
    """
    rows = complete_rows(log, ROLES)
    if len(rows) < 4 * BETWEEN_JUMPS:
        return []
    part = {role: log[role][rows] for role in ("time", *ROLES)}
    logged = _wind(part)
    candidates = []
    # For each label find the two jumps that undoing it explains best.
    for label in WIND_LABELS:
        undone = _wind(part | label.undo(part))
        gain, first, last = _best_pair(logged, undone)
        if gain > JUMPS_GAIN:
            segment = float(part["time"][first]), float(part["time"][last])
            candidates.append((gain, label, segment, _unsteadiness(undone[first:last])))
    if not candidates:
        return []
    # Labels that explain nearly as well are distinguished by the steadier wind over ground.
    most = max(gain for gain, *_ in candidates)
    gain, label, segment, _ = min(
        (entry for entry in candidates if entry[0] > most - JUMPS_TIED), key=lambda entry: entry[3]
    )
    probability = float(0.99 / (1.0 + np.exp(-gain)))
    return [finding_of(label, probability, segment)]


def _wind(part):
    """The wind over ground as a vector: the one that a fast craft meets changes with her speed. [m/s]"""
    apparent = part["wind_speed"] * np.exp(1j * np.radians(part["wind_from"] + part["heading"]))
    return apparent - (part["surge"] + 1j * part["sway"]) * np.exp(1j * np.radians(part["heading"]))


def _unsteadiness(wind):
    """Change of the wind over ground in a segment: what is too much in it follows the ship. [m2/s2]"""
    return float(np.mean(np.abs(wind[STEADINESS_LAG:] - wind[:-STEADINESS_LAG]) ** 2))


def _best_pair(logged: np.ndarray, undone: np.ndarray) -> tuple[float, int, int]:
    """Gain of undoing a mislabel between two rows, less the cost of choosing them, and the first and last row."""
    # Candidates for the ends are the rows of the largest changes.
    sizes = np.abs(np.diff(logged))
    ordered = np.sort(sizes)
    rows = 1 + np.sort(np.argsort(-sizes)[:LARGEST_JUMPS])
    # Change at the start of a part and at its end, as logged and with the label undone.
    begins = _gain(sizes[rows - 1], np.abs(undone[rows] - logged[rows - 1]), ordered)
    ends = _gain(sizes[rows - 1], np.abs(logged[rows] - undone[rows - 1]), ordered)
    total = begins[:, None] + ends
    # Ends must be in order and apart. The choice of both costs two logarithms of their number.
    total[rows[None] - rows[:, None] < BETWEEN_JUMPS] = -np.inf
    first, last = np.unravel_index(int(np.argmax(total)), total.shape)
    gain = float(total[first, last]) - 2.0 * np.log(rows.size)
    return gain, int(rows[first]), int(rows[last]) - 1


def _gain(given: np.ndarray, otherwise: np.ndarray, ordered: np.ndarray) -> np.ndarray:
    """How much commoner one size of changes is than another, by those of the log in order. [nats]"""
    # Rank of each change among the changes of the log: an empirical tail probability.
    above = [ordered.size + 1.0 - np.searchsorted(ordered, size) for size in (otherwise, given)]
    return np.log(above[0] / above[1])
