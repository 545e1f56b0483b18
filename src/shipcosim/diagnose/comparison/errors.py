"""Simulated against measured: errors of open-loop predictions from smoothed measurements, over a craft's own times."""

from collections.abc import Iterable

import numpy as np

from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.thresholds import (
    ANSWER,
    FEWEST_STARTS,
    LONGEST_ANSWER,
    MOST_OF_LOG,
    MOST_STARTS,
    SHORTEST_ANSWER,
)
from shipcosim.diagnose.inference.predictions import missing, predicted, replayable
from shipcosim.diagnose.numerics import root_mean_square, running_sums
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import at_rows, readings, true_motion
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.smoothing import froude_time
from shipcosim.diagnose.ship.time_scales import response_times
from shipcosim.models.core.motion import Motion

_LADDER = np.array([1.0, 2.0, 3.0, 6.0, 10.0])


def horizons_of(model: ShipModel, motion: Motion, span: float, step: float) -> tuple[float, ...]:
    """Horizons that fit a craft's own time constants: a sixth, a half and the whole of the time in which she answers.

    Parameters
    ----------
    model : ShipModel
    motion : Motion
        Near the measured one.
    span, step : float
        Length of the log, and time from row to row. [s]

    Returns
    -------
    tuple of float
        Rounded, increasing. [s]
    """
    # A multiple of the ship's middle time constant, or what bounds and length of the log allow.
    unit = froude_time(model.length)
    answer = np.clip(
        ANSWER * response_times(model, motion).middle, SHORTEST_ANSWER * unit, LONGEST_ANSWER * unit
    )
    longest = max(min(float(answer), MOST_OF_LOG * span), 6.0 * step)
    # Round to a ladder of plain numbers in each decade, nearest on the logarithmic scale.
    power = 10.0 ** np.floor(np.log10(longest))
    rounded = float(power * _LADDER[np.abs(np.log(_LADDER * power / longest)).argmin()])
    return tuple(float(f"{rounded * share:.3g}") for share in (1.0 / 6.0, 0.5, 1.0))


def errors_of(record: Record, measured: MeasuredForce, model: ShipModel) -> dict[str, list[float]]:
    """Errors of the simulation of a ship: the entry ``baseline`` of diagnosis.json.

    Predictions start all over the log from the measured motion, smoothed without a model, and run with the logged
    thrusters and wind.

    Parameters
    ----------
    record : Record
    measured : MeasuredForce
        Of the log.
    model : ShipModel

    Returns
    -------
    dict
        Horizons [s], and root mean squares of the errors after each, in position [m] and heading [deg].
    """
    span = float(record.time[-1] - record.time[0])
    # Predictions need enough starts: halve the horizons until the log has them.
    horizons = horizons_of(model, measured.motion, span, record.step)
    rows = starts_of(record, measured, horizons[-1])
    while rows.size < FEWEST_STARTS and horizons[-1] > 6.0 * record.step:
        horizons = tuple(0.5 * horizon for horizon in horizons)
        rows = starts_of(record, measured, horizons[-1])
    # The smoothed measurements serve as initial state and as truth.
    seen = measured.smooth_motion
    counts = counts_of(horizons, record.step)
    # Errors of the predictions by channel, (horizons, s) arrays.
    logged, ship = replayable(record, model, seen)
    start = true_motion(at_rows(seen, rows), ship)
    predictions = predicted(start, rows, logged, ship, counts)
    off = missing(readings(predictions, ship), seen, rows + np.array(counts)[:, None])
    return {
        "horizon_s": [count * record.step for count in counts],
        "position_error_m": [root_mean_square(errors) for errors in off["position"]],
        "heading_error_deg": [root_mean_square(errors) for errors in off["heading"]],
    }


def errors_over_none(
    record: Record, measured: MeasuredForce, errors: dict[str, list[float]]
) -> dict[str, float]:
    """Errors of the simulation over those of no model at all, which keeps surge, sway and yaw rate as they are.

    Parameters
    ----------
    record : Record
    measured : MeasuredForce
    errors : dict
        As from `errors_of`.

    Returns
    -------
    dict of str to float
        ``position`` and ``heading``: the larger of the two of the longer horizons.
    """
    # The same starts as the simulation's, so that the errors compare.
    rows = starts_of(record, measured, errors["horizon_s"][-1])
    seen = measured.smooth_motion
    counts = np.array(counts_of(errors["horizon_s"], record.step))[1:, None]
    kept = sailed_steadily(at_rows(seen, rows), counts * record.step)
    # Ratio of root mean squares by horizon; the worst counts.
    off = missing(kept, seen, rows + counts)
    ratios = {}
    for channel, name in (("position", "position_error_m"), ("heading", "heading_error_deg")):
        none = np.sqrt((off[channel] ** 2).mean(axis=1))
        ratios[channel] = float((np.array(errors[name])[1:] / np.maximum(none, 1e-12)).max())
    return ratios


def sailed_steadily(start: Motion, time: np.ndarray) -> Motion:
    """The motion of a craft some time [s] later, if it keeps its velocity and its rate of turn."""
    # With constant velocities the ship sails along an arc: its chord is the distance times sinc of
    # half the turn, in the direction at half the turn.
    (x, y, psi, u, v, r) = start
    turned = (
        np.exp(1j * psi)
        * (u + 1j * v)
        * time
        * np.exp(0.5j * r * time)
        * np.sinc(0.5 * r * time / np.pi)
    )
    kept = (value + 0.0 * time for value in (u, v, r))
    return Motion(x + turned.real, y + turned.imag, psi + r * time, *kept)


def counts_of(horizons: Iterable[float], step: float) -> list[int]:
    """Rows in each horizon [s] of a log with that step [s] from row to row."""
    return [max(1, round(horizon / step)) for horizon in horizons]


def starts_of(record: Record, measured: MeasuredForce, horizon: float) -> np.ndarray:
    """Rows from which predictions start, as many as touch no gap; else any from which one can be made."""
    # Starts whose horizon reaches no row with unknown inputs, by cumulative counts.
    reach = round(horizon / record.step)
    rows = np.arange(0, record.time.size - reach)
    lost = running_sums(~record.usable)
    good = rows[
        (lost[rows + reach] == lost[rows]) & measured.usable[rows] & measured.usable[rows + reach]
    ]
    # Gaps in the motion matter less: they are accepted where there are too few starts.
    good = good if good.size >= FEWEST_STARTS else rows[lost[rows + reach] == lost[rows]]
    # Evenly thinned, to limit the work.
    return good[:: max(1, good.size // MOST_STARTS)]
