"""The evidence behind a verdict as values: what sets of causes gain, how large they are, what is left of the log."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.explanation.course import CourseFound
from shipcosim.diagnose.explanation.search import without_causes
from shipcosim.diagnose.explanation.verdict import JudgedLog, gained
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.parts import explained
from shipcosim.diagnose.ship.model import ShipModel

MOVED = 2.0
"""Standard deviations, before and after the log, by which a number of the form has moved. [1]"""
STRAINED = 4.0
"""Deviation of a known number, in tolerances, above which it is reported. [1] Healthy ships of the
model's form reached 3.4."""
LAGS = 30
"""Lags of the autocorrelation of the innovations. [rows]"""


@dataclass(frozen=True)
class FormNumber:
    """A number of the form of the ship's loads, which the log has moved off the model's.

    Attributes
    ----------
    number : str
        ``place.name``.
    what : str
        In words.
    model, estimate, std : float
    unit : str
    """

    number: str
    what: str
    model: float
    estimate: float
    std: float
    unit: str


@dataclass(frozen=True)
class LoadForm:
    """How far the form of the ship's loads differs from the model's, as far as the log tells.

    Attributes
    ----------
    scale : float
        Over what is usual between a ship and her model; 0 is the model's form. [1]
    differs : dict of str to float
        By function, in words: root mean square of what it differs by, as a share of the model's. [1]
    numbers : tuple of FormNumber
        Those of the form that differ by more than twice their standard deviations, and those known within a tolerance
        that are off by more than `STRAINED` of it; most certain first.
    hides : tuple of str
        Causes that the log could have shown on a ship of the model's form: another form of her loads does the same.
    horizon_s, before_m, after_m : float or None
        Position error of predictions after this time, without the form and with it, on rows that its numbers were not
        fitted on; None where there are too few. [s, m, m]
    system_m : float or None
        The same with those of the numbers alone that the system has parameters for. [m]
    """

    scale: float
    differs: dict[str, float]
    numbers: tuple[FormNumber, ...] = ()
    hides: tuple[str, ...] = ()
    horizon_s: float | None = None
    before_m: float | None = None
    after_m: float | None = None
    system_m: float | None = None


@dataclass(frozen=True)
class SetEvidence:
    """A set of causes, each with its component, and its log-evidence over the ship without a cause. [nats]"""

    causes: tuple[tuple[str, str | None], ...]
    gain: float
    is_chosen: bool


@dataclass(frozen=True)
class CauseGain:
    """Log-evidence that a cause gains, and on simulated healthy logs; None where that was not computed. [nats]"""

    cause: str
    component: str | None
    gain: float
    null_gain: float | None


@dataclass(frozen=True)
class Evidence:
    """What a verdict on causes rests on.

    Attributes
    ----------
    sets : tuple of SetEvidence
        Best first, without the empty set.
    gains : tuple of CauseGain
        Of the set that the verdict rests on.
    unmodelled : dict of str to float
        Gain of unmodelled errors beside it, by kind. [nats]
    whiteness : dict of str to (LAGS, 6) array
        Autocorrelation of the whitened innovations ``"before"``, by the plain model, and ``"after"``, with the causes;
        from a lag of one row on, NaN for a channel that was not measured.
    step : float
        Time from row to row. [s]
    rows : int
    course : CourseFound or None
        A cause that begins, grows, or comes and goes.
    """

    sets: tuple[SetEvidence, ...]
    gains: tuple[CauseGain, ...]
    unmodelled: dict[str, float]
    whiteness: dict[str, np.ndarray]
    step: float
    rows: int
    course: CourseFound | None = None


def evidence_of(log: JudgedLog) -> Evidence:
    """The evidence behind a verdict."""
    problem = log.problem
    fit = log.fit
    nothing = without_causes(log.fits)
    # Before: known numbers at their shipped values. After: with the causes fitted.
    white = {"before": whiteness(problem, nothing, as_it_is=True)}
    if fit.hypotheses:
        white["after"] = whiteness(problem, fit)
    return Evidence(
        tuple(
            SetEvidence(
                tuple((s.cause, s.component) for s in other.hypotheses),
                other.score - nothing.score,
                other is fit,
            )
            for other in log.fits
            if other.hypotheses
        ),
        tuple(
            CauseGain(s.cause, s.component, gained(s, fit, log.fits), log.null_gains.get(s.label))
            for s in fit.hypotheses
        ),
        log.unmodelled,
        white,
        problem.record.step,
        problem.record.time.size,
        log.explained.course,
    )


def whiteness(problem: IdentificationProblem, fit: Fit, as_it_is: bool = False) -> np.ndarray:
    """Autocorrelation of the whitened innovations that a fit leaves.

    Parameters
    ----------
    problem : IdentificationProblem
    fit : Fit
    as_it_is : bool
        Without moving known numbers within their tolerances.

    Returns
    -------
    (LAGS, 6) array
        From a lag of one row on; NaN for a channel that was not measured.
    """
    # Innovations once the fit's effect is taken out; gaps stay missing.
    theta = 0.0 * fit.left if as_it_is else fit.left
    white = innovations(explained(fit.linear, theta), problem.noise, problem.record).white[..., 0]
    white = np.where(np.isfinite(problem.record.measured), white, np.nan)
    autocorrelation = np.full((LAGS, white.shape[1]), np.nan)
    # Normalised autocorrelation by channel, with enough values for all lags.
    for channel, values in enumerate(white.T):
        if np.isfinite(values).sum() > 10 * LAGS:
            values = values - np.nanmean(values)
            power = np.nanmean(values**2)
            autocorrelation[:, channel] = [
                np.nanmean(values[k:] * values[:-k]) / power for k in range(1, LAGS + 1)
            ]
    return autocorrelation


def load_form(log: JudgedLog) -> LoadForm | None:
    """How far the form of the ship's loads, or a number of hers, differs from the model's, beside the verdict's causes.

    None where neither does, or where a reference says what is known of her.
    """
    model = log.problem.model
    fit = log.fit
    if model.directions:
        return None
    sizes = model.form_sizes if model.form_scale else {}
    # Posterior of each number, in units of its column.
    std = np.sqrt(np.diag(fit.covariance))
    differences = []
    squares = {}
    for column, share, deviation in zip(fit.columns, fit.theta, std, strict=True):
        # Only columns of one lasting number: no causes, no quantities of the day.
        path, size = next(iter(column.changes.items()))
        if len(column.changes) > 1 or path in fit.values or column.is_of_day:
            continue
        is_form = path in sizes and column.prior == 1.0
        if is_form:
            # Mean square of the difference of a number of the form, uncertainty included.
            squares[path] = size**2 * (share**2 + deviation**2)
        # Report numbers that the log moves clearly, by their posterior or far beyond tolerance.
        least = 1.0 if is_form else STRAINED * column.prior
        if abs(share) > max(least, MOVED * deviation):
            number = _form_number(model, path, size * share, size * deviation)
            differences.append((abs(share) / deviation, number))
    if not model.form_scale and not differences:
        return None
    differs = {
        name: float(np.sqrt(sum(share * squares.get(path, 0.0) for path, share in numbers.items())))
        for name, numbers in (model.form_functions.items() if model.form_scale else ())
    }
    return LoadForm(
        model.form_scale,
        differs,
        tuple(number for _, number in sorted(differences, key=lambda pair: -pair[0])),
    )


def _form_number(model: ShipModel, path: str, off: float, std: float) -> FormNumber:
    about = model.about(path)
    value = float(model.get(path))
    return FormNumber(
        path, about["description"], value, float(value + off), float(std), about["unit"]
    )
