"""Which rows of a log parameters are fitted on, and where on the others predictions can start and be checked."""

from dataclasses import replace

import numpy as np

from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.parts import InParts
from shipcosim.diagnose.numerics import running_sums
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import at_rows
from shipcosim.diagnose.validation.thresholds import (
    MEASURED_WITHIN,
    MOVING,
    SETTLED,
    STANDING,
    START_STEP,
    TRAINED,
    TURNING,
)
from shipcosim.models.core.motion import Motion

HORIZONS = (10.0, 30.0, 60.0)
"""Horizons of the predictions. [s]"""


def first_rows(record: Record, share: float = TRAINED) -> np.ndarray:
    """The first rows of a log, (n,) bool array."""
    return np.arange(record.time.size) < share * record.time.size


def without_headings(record: Record, middle: float, width: float = np.pi / 2.0) -> np.ndarray:
    """Rows whose heading is measured and not in a sector: training rows for a gain on headings not fitted on.

    Parameters
    ----------
    record : Record
    middle, width : float
        Of the sector. [rad]

    Returns
    -------
    (n,) bool array
    """
    return np.abs(np.angle(np.exp(1j * (record.measured[:, 2] - middle)))) > 0.5 * width


def is_idle(record: Record) -> np.ndarray:
    """Rows on which no thruster turns, (n,) bool array."""
    speeds = [np.abs(n) for n, _ in record.units.values() if np.any(n)]
    return (
        np.all([n < STANDING * n.max() for n in speeds], axis=0)
        if speeds
        else np.ones(record.time.size, bool)
    )


def in_rows(record: Record) -> list[int]:
    """The horizons in rows."""
    return [max(1, round(time / record.step)) for time in HORIZONS]


def starts(record: Record) -> np.ndarray:
    """Rows from which a prediction can be made and checked.

    Parameters
    ----------
    record : Record

    Returns
    -------
    (s,) array of int
        After observers have settled, where all that drives the ship is known and position and heading are measured.
    """
    horizons = in_rows(record)
    h = record.step
    # Evenly spaced starts after the observer has settled, so that the longest horizon still fits.
    rows = np.arange(
        round(SETTLED / h), record.time.size - horizons[-1], max(1, round(START_STEP / h))
    )
    # Cumulative count of rows with unknown inputs: equal at both ends where there is none between.
    lost = running_sums(~record.usable)
    # Position and heading must be measured near the start and near each horizon.
    measured = np.isfinite(record.measured[:, :3]).all(-1)
    near = np.convolve(measured, np.ones(2 * round(MEASURED_WITHIN / h) + 1), "same") > 0.0
    sound = (lost[rows + horizons[-1]] == lost[rows]) & near[rows]
    # The observer must have settled within the same stretch of the log.
    stretch = np.cumsum(record.is_last)
    sound &= stretch[rows] == stretch[np.maximum(rows - round(SETTLED / h), 0)]
    for k in horizons:
        sound &= near[rows + k]
    return rows[sound]


def sorted_by(train: np.ndarray, rows: np.ndarray, record: Record) -> tuple[np.ndarray, np.ndarray]:
    """Starts of predictions that are wholly on training rows, and of those that touch none.

    Parameters
    ----------
    train : (n,) bool array
    rows : (s,) array of int
    record : Record

    Returns
    -------
    tuple of two arrays of int
    """
    last = in_rows(record)[-1]
    # Training rows in each prediction, by a cumulative count.
    used = running_sums(train)
    used = used[rows + last + 1] - used[rows]
    return rows[used == last + 1], rows[used == 0]


def trained(problem: IdentificationProblem, train: np.ndarray) -> IdentificationProblem:
    """The case without the rows that are not to be trained on, up to the last one that is.

    Parameters
    ----------
    problem : IdentificationProblem
        Prepared, of one log.
    train : (n,) bool array

    Returns
    -------
    IdentificationProblem
    """
    n = np.flatnonzero(train)[-1] + 1
    train = train[:n]
    record = problem.record
    base = problem.linear
    # A step needs both of its rows to be training rows; other steps and measurements get no weight.
    steps = train[:-1] & train[1:]
    cut = record.part(slice(n))
    cut = replace(
        cut,
        measured=np.where(train[:, None], cut.measured, np.nan),
        usable=cut.usable & np.append(steps, True),
    )

    def part(rows):
        linear = base.part(rows)
        used = train[rows, None]
        driven = linear.driven[: len(steps[rows])] * steps[rows, None, None]
        seen = linear.seen * used[..., None]
        transition = linear.transition[: len(driven)]
        return linear._replace(
            transition=transition, driven=driven, seen=seen, whole=linear.whole & used
        )

    linear = InParts(n, base.columns, part)
    return replace(problem, record=cut, motion=at_rows(problem.motion, slice(n)), base=linear)


def conditions(
    record: Record, seen: Motion, rows: np.ndarray, train: np.ndarray
) -> dict[str, tuple]:
    """What the ship did in each prediction, as coordinates of its segment.

    Parameters
    ----------
    record : Record
    seen : Motion
        As the instruments show it, (n,) arrays.
    rows : (s,) array of int
        Starts.
    train : (n,) bool array

    Returns
    -------
    dict
        ``start_time``, ``regime`` (drifting without thrust, turning, moving, holding), and ``heading_known``: whether
        training rows have a heading within 15 deg.
    """
    # Distance sailed and range of heading over each prediction.
    spans = rows[:, None] + np.arange(in_rows(record)[-1] + 1)
    way = np.hypot(np.diff(seen.x[spans], axis=1), np.diff(seen.y[spans], axis=1)).sum(1)
    turn = np.ptp(seen.psi[spans], axis=1)
    idle = is_idle(record)[spans].all(1)
    # The first that applies: without thrust, turning, moving, else holding position.
    regime = np.select(
        [idle, turn > TURNING, way > MOVING * HORIZONS[-1]],
        ["drifting", "turning", "moving"],
        "holding",
    )
    heading = np.degrees(seen.psi[rows]) % 360.0
    # Degrees of heading with training rows, widened by 15 deg to both sides round the circle.
    used = np.bincount(np.degrees(seen.psi[train]).astype(int) % 360, minlength=360) > 0
    near = np.convolve(np.concatenate([used[-15:], used, used[:15]]), np.ones(31), "valid") > 0.0
    return {
        "start_time": (
            "segment",
            record.time[rows],
            {"units": "s", "long_name": "where the prediction starts"},
        ),
        "regime": ("segment", regime),
        "heading_known": ("segment", near[heading.astype(int) % 360]),
    }
