"""Gains on conditions that are kept from the fit, wherever in the log they are: other headings, free drift."""

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.explanation.search import without_causes
from shipcosim.diagnose.explanation.verdict import JudgedLog
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.validation.gain import Comparison, compare
from shipcosim.diagnose.validation.missing_force import MissingForce, missing_forces
from shipcosim.diagnose.validation.split import is_idle, sorted_by, starts, without_headings
from shipcosim.diagnose.validation.thresholds import FEWEST_PREDICTIONS, LEAST_TRAINED


@dataclass(frozen=True)
class PredictedLog:
    """A judged log with predictions on rows that nothing was fitted on, in array form.

    Attributes
    ----------
    judged : JudgedLog
    is_named : bool
        Whether causes were named that predictions are made with; else only the plain model is compared.
    comparison : Comparison or None
        On the rows that were held out in time; None where there are too few.
    held_out : dict of str to Comparison
        By condition that was held out of the fit wherever in the log it is.
    force : MissingForce
        What the model lacks.
    """

    judged: JudgedLog
    is_named: bool
    comparison: Comparison | None
    held_out: dict[str, Comparison]
    force: MissingForce


def with_predictions(log: JudgedLog, is_named: bool) -> PredictedLog:
    """A judged log with predictions on rows and conditions that nothing was fitted on.

    Parameters
    ----------
    log : JudgedLog
    is_named : bool
        Whether causes of the physics are named; else predictions are made with the plain model alone.
    """
    problem = log.problem
    fit = log.fit if is_named else without_causes(log.fits)
    compared = log.explained.identification.comparison
    plain = compared.given(problem.model) if compared.started_craft else None
    comparison = compare(problem, fit, plain=plain)
    force = missing_forces(problem, fit if is_named else None)
    held_out = compare_held_out(problem, fit, plain) if is_named and comparison is not None else {}
    return PredictedLog(log, is_named, comparison, held_out, force)


def rows_without_condition(record: Record) -> dict[str, np.ndarray]:
    """Training rows for gains on conditions that are kept from the fit, wherever in the log they are.

    Parameters
    ----------
    record : Record

    Returns
    -------
    dict of str to (n,) bool array
        ``"other headings"``: all but the quarter circle with the most predictions in it of those that leave half of
        the rows. ``"free drift"``: all but the rows without thrust. What the log has none of is left out.
    """
    # Leave out a quarter circle of headings, in turn every 30 deg; the one that holds most
    # predictions counts.
    rows = starts(record)
    rows_by_condition = {}
    sectors = [
        without_headings(record, middle) for middle in np.radians(np.arange(0.0, 360.0, 30.0))
    ]
    tries = [
        (sorted_by(train, rows, record)[1].size, train)
        for train in sectors
        if train.mean() >= LEAST_TRAINED
    ]
    most = max(tries, key=lambda split: split[0], default=(0, None))
    if most[0]:
        rows_by_condition["other headings"] = most[1]
    # Free drift: predictions that lie wholly on rows without thrust.
    powered = ~is_idle(record)
    if sorted_by(powered, rows, record)[1].size and powered.mean() >= LEAST_TRAINED:
        rows_by_condition["free drift"] = powered
    return rows_by_condition


def compare_held_out(
    problem: IdentificationProblem, fit: Fit, plain: ShipModel | None = None
) -> dict[str, Comparison]:
    """Comparisons on conditions that nothing was fitted on, wherever in the log they are.

    Parameters
    ----------
    problem, fit, plain : IdentificationProblem, Fit and ShipModel
        As for `compare`.

    Returns
    -------
    dict of str to Comparison
        ``"other headings"``: predictions that start 15 deg or more from any heading fitted on; ``"free drift"``. Those
        that the log has enough of.
    """
    comparisons = {}
    for name, train in rows_without_condition(problem.record).items():
        comparison = compare(problem, fit, train=train, plain=plain)
        if comparison is not None and name == "other headings":
            # The comparison on some of its segments.
            which = ~comparison.errors["heading_known"].values
            some = np.flatnonzero(which)
            comparison = replace(
                comparison, errors=comparison.errors.isel(segment=some), rows=comparison.rows[some]
            )
        if comparison is not None and comparison.rows.size >= FEWEST_PREDICTIONS:
            comparisons[name] = comparison
    return comparisons
