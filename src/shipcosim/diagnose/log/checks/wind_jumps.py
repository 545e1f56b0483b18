"""Wind channels that are not what they are labelled in a part of the log: at both its ends the wind jumps.

A label changes between two neighbouring rows. So the wind over ground, as logged, makes its two largest changes from row
to row at the ends of the part, larger than any gust's, and with the label undone changes of usual size. What is large
and usual the log's own changes say, whatever their distribution: gusts have no normal one.
"""

import numpy as np

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks.kinematics import complete_rows
from shipcosim.diagnose.log.checks.wind import ROLES
from shipcosim.diagnose.log.mislabels import WIND_LABELS, finding_of
from shipcosim.diagnose.log.thresholds import (
    ABOVE_GUSTS,
    BETWEEN_JUMPS,
    JUMPS_AT_ODDS,
    JUMPS_GAIN,
    JUMPS_TIED,
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
    ends = _ends(logged)
    if ends is None:
        return []
    first, after = ends
    # How much of both jumps each label explains.
    candidates = []
    for label in WIND_LABELS:
        undone = _wind(part | label.undo(part))
        gain = _gained(logged, undone, first, after)
        if gain > JUMPS_GAIN:
            candidates.append((gain, label, _unsteadiness(undone[first : after - 1])))
    if not candidates:
        return []
    # Labels that explain nearly as well are distinguished by the steadier wind over ground.
    most = max(gain for gain, *_ in candidates)
    gain, label, _ = min(
        (entry for entry in candidates if entry[0] > most - JUMPS_TIED), key=lambda entry: entry[2]
    )
    probability = float(0.99 / (1.0 + np.exp(JUMPS_AT_ODDS - gain)))
    segment = float(part["time"][first]), float(part["time"][after - 1])
    return [finding_of(label, probability, segment)]


def _wind(part):
    """The wind over ground as a vector: the one that a fast craft meets changes with her speed. [m/s]"""
    apparent = part["wind_speed"] * np.exp(1j * np.radians(part["wind_from"] + part["heading"]))
    return apparent - (part["surge"] + 1j * part["sway"]) * np.exp(1j * np.radians(part["heading"]))


def _unsteadiness(wind):
    """Change of the wind over ground in a segment: what is too much in it follows the ship. [m2/s2]"""
    return float(np.mean(np.abs(wind[STEADINESS_LAG:] - wind[:-STEADINESS_LAG]) ** 2))


def _ends(logged: np.ndarray) -> tuple[int, int] | None:
    """First row of a part and first row after it, at its largest two changes; None where other changes are as large."""
    sizes = np.abs(np.diff(logged))
    *_, third, second, largest = np.argsort(sizes)
    first, after = sorted((1 + int(second), 1 + int(largest)))
    stands_out = sizes[second] > ABOVE_GUSTS * sizes[third]
    return (first, after) if stands_out and after - first >= BETWEEN_JUMPS else None


def _gained(logged: np.ndarray, undone: np.ndarray, first: int, after: int) -> float:
    """Gain of undoing a mislabel in the rows from `first` to the one before `after`. [nats]"""
    ordered = np.sort(np.abs(np.diff(logged)))
    # Change at the start of the part and at its end, as logged and with the label undone.
    given = np.abs(logged[[first, after]] - logged[[first - 1, after - 1]])
    ends = undone[first] - logged[first - 1], logged[after] - undone[after - 1]
    return float(_gain(given, np.abs(ends), ordered).sum())


def _gain(given: np.ndarray, otherwise: np.ndarray, ordered: np.ndarray) -> np.ndarray:
    """How much commoner one size of changes is than another, by those of the log in order. [nats]"""
    # Rank of each change among the changes of the log: an empirical tail probability.
    above = [ordered.size + 1.0 - np.searchsorted(ordered, size) for size in (otherwise, given)]
    return np.log(above[0] / above[1])
