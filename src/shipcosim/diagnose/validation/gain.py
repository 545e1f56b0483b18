"""What naming the cause is worth: how far predictions with each model are off, on rows that nothing was fitted on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray

from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem, fitted
from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.inference.predictions import (
    earth_fixed,
    missing,
    observed,
    predicted,
    reference,
    replayable,
    restarted,
)
from shipcosim.diagnose.inference.thresholds import DRAWS
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.measured_motion import at_rows, readings
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.validation.split import (
    HORIZONS,
    conditions,
    first_rows,
    in_rows,
    sorted_by,
    starts,
    trained,
)
from shipcosim.diagnose.validation.thresholds import BLOCK, FADES
from shipcosim.models.core.motion import Motion

MODELS = ("plain", "bias_observer", "extended", "extended_observer", "calibrated", "floor")
_HELD = {
    "plain": "bias_observer",
    "extended": "extended_observer",
    "calibrated": None,
    "floor": None,
}
CHANNELS = {"position": "m", "heading": "deg", "surge": "m/s", "sway": "m/s", "yaw_rate": "deg/s"}
_EARTH = tuple(
    ("earth", time) for time in (10.0, 40.0, 160.0)
)  # s, within which an observer learns a force
_BOTH = _EARTH + tuple(("body", time) for _, time in _EARTH)


@dataclass(frozen=True)
class Predictor:
    """A model with what it knows at each row.

    Attributes
    ----------
    record, model : Record and ShipModel
        As from `replayable`.
    original : ShipModel
        As it was before.
    motion : Motion
        By the rows until each row, (n,) arrays.
    """

    record: Record
    model: ShipModel
    original: ShipModel
    motion: Motion


@dataclass(frozen=True)
class Comparison:
    """Errors of predictions with each model.

    Attributes
    ----------
    errors : xarray.Dataset
        `CHANNELS` by ``model`` (`MODELS`), ``horizon`` [s] and ``segment``; coordinates of the segments as from
        `conditions`.
    fit : Fit
        The causes, fitted on the training rows.
    train : (n,) bool array
        Rows that were fitted on.
    rows : (s,) array of int
        Where the segments start.
    seen : Motion
        What the predictions are measured against.
    predictors : dict of str to Predictor
        Of the models ``plain`` and ``extended``.
    """

    errors: xarray.Dataset
    fit: Fit
    train: np.ndarray
    rows: np.ndarray
    seen: Motion
    predictors: dict[str, Predictor]


def compare(
    problem: IdentificationProblem,
    fit: Fit,
    *,
    train: np.ndarray | None = None,
    plain: ShipModel | None = None,
) -> Comparison | None:
    """Predict with the plain model, a bias observer, the causes of a fit, and see how far each is off.

    Parameters
    ----------
    problem : IdentificationProblem
        Prepared, of one log.
    fit : Fit
        To the whole log. Its causes are fitted again on the training rows; near its motion is the reference.
    train : (n,) bool array, optional
        Rows to fit on; the first 65 %.
    plain : ShipModel, optional
        The ship as the system has her, where the problem's has more corrected than that.

    Returns
    -------
    Comparison or None
        None where the other rows are too few or have too many gaps.
    """
    # Predictions wholly on training rows tune the observers; those that touch none are judged.
    record = problem.record
    train = first_rows(record) if train is None else train
    inside, rows = sorted_by(train, starts(record), record)
    if inside.size == 0 or rows.size == 0 or record.time[rows[-1]] - record.time[rows[0]] < BLOCK:
        return None
    # Causes are fitted again on the training rows alone.
    rounds = 3 if fit.hypotheses else 1
    part = fitted(trained(problem, train), fit.hypotheses, fit.values, rounds)
    # Reference: smoothed with a free force, so that it favours no model.
    linear = linearise(fit.motion, record, fit.model, [])
    seen = reference(linear, fit.motion, problem.noise, record, fit.model)
    # Calibrated has the fit's numbers of the training rows; the floor has those of the whole log,
    # as a lower limit of the error.
    extended = problem.model.with_values(part.values)
    ship_models = {
        "plain": problem.model if plain is None else plain,
        "extended": extended,
        "calibrated": calibrated(part),
        "floor": calibrated(fit),
    }
    models = _observed(problem, linear, fit.motion, seen, ship_models)
    if not fit.hypotheses and plain is None:
        models["extended"] = models["plain"]
    errors_by_model = {}
    predictors = {}
    # Errors of each model, with the held force of its observer where it has one.
    for name, held in _HELD.items():
        judged = _judged(models[name], inside[::2], rows, seen, held is not None)
        for label, (errors, _) in zip((name, held), judged, strict=False):
            errors_by_model[label] = errors
        # Predictions without a force start from what the observer knew that does best so.
        predictors[name] = models[name].predictor(judged[0][1], ship_models[name])
    variables = {
        channel: (
            ("model", "horizon", "segment"),
            np.stack([errors_by_model[label][channel] for label in MODELS]),
            {"units": unit},
        )
        for channel, unit in CHANNELS.items()
    }
    coordinates = {"model": list(MODELS), "horizon": list(HORIZONS)}
    coordinates |= conditions(record, seen, rows, train)
    return Comparison(xarray.Dataset(variables, coordinates), part, train, rows, seen, predictors)


def _judged(model, inside, rows, seen, holds):
    """Errors on the held-out rows with the observer that is best on the training rows: without a force, and with it.

    Returns
    -------
    list of tuple of dict and int
        Errors by channel, and the number of the observer.
    """
    # One pass over training and held-out starts; the observer is chosen by the longest horizon on
    # the training starts only.
    missed = model.missed(np.concatenate([inside, rows]), seen, holds)
    by_model = []
    tuning = (missed["position"][-1, ..., : len(inside)] ** 2).mean(-1)
    for some in (slice(0, 1), slice(1, None)) if holds else (slice(0, 1),):
        fade, number = np.unravel_index(tuning[some].argmin(), tuning[some].shape)
        errors = {
            channel: values[:, some][:, fade, number, len(inside) :]
            for channel, values in missed.items()
        }
        by_model.append((errors, number))
    return by_model


def calibrated(fit: Fit) -> ShipModel:
    """The ship model of a fit with every known number where the log would have it, within its tolerance."""
    # Shift every number by its posterior mean.
    changes = zip(fit.columns, fit.left, strict=True)
    moved = [
        (path, size * share) for column, share in changes for path, size in column.changes.items()
    ]
    return fit.model.with_values({path: fit.model.get(path) + by for path, by in moved})


@dataclass(frozen=True)
class _Model:
    """A model, ready to predict, with what several observers knew about it."""

    record: Any
    model: Any
    choices: tuple
    observers: Any

    def predictor(self, number, original):
        """The model with the estimates of one of its observers."""
        return Predictor(
            self.record,
            self.model,
            original,
            at_rows(self.observers.motion, number),
        )

    def missed(self, rows, seen, holds):
        """Errors of predictions from some rows, without a force and where it `holds` one by each of `FADES`.

        By channel, (horizons, 1 or 1 + fades, observers, s) arrays.
        """
        # Without the observed force, then with it at each rate of fading, all in one simulation.
        shares = np.array([0.0] + [1.0] * len(FADES) if holds else [0.0])[:, None, None]
        fades = np.array([0.0, *FADES])[: len(shares), None, None]
        motion = Motion(*(value[:, rows] + 0.0 * shares for value in self.observers.motion))
        force = shares[..., None] * self.observers.force[:, rows] if holds else None
        earth = np.array([frame == "earth" for frame, _ in self.choices])[:, None]
        horizons = in_rows(self.record)
        predictions = predicted(
            motion, rows, self.record, self.model, horizons, force, earth=earth, fades=fades
        )
        return missing(
            readings(predictions, self.model),
            seen,
            (rows + np.array(horizons)[:, None])[:, None, None],
        )


def _observed(problem, about_fit, motion, seen, ship_models):
    """Each ship model with its observers, all run over the log at once."""
    record = problem.record
    # All but the plain model share the linearisation about the fit's motion; only their defects
    # differ.
    about = {name: problem.motion if name == "plain" else motion for name in ship_models}
    linear = {
        name: restarted(about_fit, motion, record, model) for name, model in ship_models.items()
    }
    linear["plain"] = problem.base_of([]).whole()
    choices = {"plain": _BOTH, "extended": _BOTH, "calibrated": _EARTH[1:2], "floor": _EARTH[1:2]}
    # All pairs of model and observer, as one stack of filters.
    each = [(name, frame, time) for name in ship_models for frame, time in choices[name]]
    problems = [
        earth_fixed(linear[name], about[name], ship_models[name])
        if frame == "earth"
        else linear[name]
        for name, frame, _ in each
    ]
    # An observer that learns a force within a time T: random walk of the jolts' size over T.
    walks = np.stack([problem.noise.jolt / time for _, _, time in each])
    noise = replace(
        problem.noise, jolt=np.broadcast_to(problem.noise.jolt, walks.shape), walk=walks
    )
    observers = observed(
        problems,
        noise,
        record,
        [about[n] for n, _, _ in each],
        [ship_models[n] for n, _, _ in each],
    )
    models = {}
    for name, model in ship_models.items():
        mine = [i for i, (owner, _, _) in enumerate(each) if owner == name]
        models[name] = _Model(*replayable(record, model, seen), choices[name], observers.of(mine))
    return models


def rms(errors: xarray.Dataset, channel: str, model: str, horizon: float = HORIZONS[-1]) -> float:
    """Root mean square over the segments of one error of one model."""
    return float(np.sqrt((errors[channel].sel(model=model, horizon=horizon) ** 2).mean()))


def error_with(comparison: Comparison, numbers: Mapping[str, float]) -> float:
    """Root mean square position error after the longest horizon, by the plain model with other numbers. [m]

    Parameters
    ----------
    comparison : Comparison
        Its rows and what was known where they start are taken.
    numbers : mapping of str to float
        By ``place.name``, in the units of the ship's numbers.
    """
    # Start states are those that the plain model's observer knew.
    predictor = comparison.predictors["plain"]
    ends = comparison.rows + in_rows(predictor.record)[-1]
    off = missing(sailed(comparison, predictor.model.with_values(numbers)), comparison.seen, ends)
    return float(np.sqrt((off["position"] ** 2).mean()))


def sailed(comparison: Comparison, model: ShipModel) -> Motion:
    """Position after the longest horizon of each held-out stretch, from the plain model's estimate at its start.

    Parameters
    ----------
    comparison : Comparison
    model : ShipModel
        Or several, their numbers (m, 1) arrays.

    Returns
    -------
    Motion
        As instruments show it, (s,) arrays; (m, s) of several ships.
    """
    predictor = comparison.predictors["plain"]
    rows = comparison.rows
    start = at_rows(predictor.motion, rows)
    horizon = in_rows(predictor.record)[-1:]
    there = readings(predicted(start, rows, predictor.record, model, horizon), model)
    return at_rows(there, 0)


def baseline(errors: xarray.Dataset) -> dict[str, list[float]]:
    """The entry ``baseline`` of diagnosis.json: root mean square over the segments, of the plain model.

    Parameters
    ----------
    errors : xarray.Dataset
        Of a `Comparison`, or from `simulated`.

    Returns
    -------
    dict
    """
    return {
        "horizon_s": [int(time) for time in HORIZONS],
        "position_error_m": [rms(errors, "position", "plain", time) for time in HORIZONS],
        "heading_error_deg": [rms(errors, "heading", "plain", time) for time in HORIZONS],
    }


def gain(errors: xarray.Dataset, seed: int = 1, fewest: int = 1) -> dict[str, Any]:
    """The entry ``gain`` of diagnosis.json: root mean square position errors after 60 s.

    Parameters
    ----------
    errors : xarray.Dataset
        Of a `Comparison`, or from `simulated`.
    seed : int
        Of the bootstrap.
    fewest : int
        Blocks that it needs.

    Returns
    -------
    dict
        ``share_of_explainable`` and ``ci95`` are None where nothing was to explain, the second with too few blocks.
    """
    # Squares of position errors after the longest horizon: plain, bias observer, extended, floor; (4, s) array.
    squares = (
        errors["position"]
        .isel(horizon=-1)
        .sel(model=["plain", "bias_observer", "extended", "floor"])
        .values
        ** 2
    )
    # Root mean square errors of the models, and the share of the explainable error that the cause
    # removes.
    times = errors["start_time"].values
    before, rival, after, floor = roots(squares.mean(1))
    # Block bootstrap for its confidence interval: neighbouring predictions overlap, so blocks are
    # drawn instead of segments.
    drawn = share_explained(*roots(_resampled(squares, times, seed))[[0, 2, 3]])
    entry = gain_entry(int(HORIZONS[-1]), (before, after, floor), drawn, float(rival))
    if _blocks(times).max() + 1 < fewest:
        entry["ci95"] = None
    return entry


def gain_entry(
    horizon: float, errors: Sequence[float], drawn: np.ndarray, rival: float | None = None
) -> dict[str, Any]:
    """The entry ``gain`` of diagnosis.json.

    Parameters
    ----------
    horizon : float
        [s]
    errors : sequence of three floats
        Before, after, and of a perfect model. [m]
    drawn : (n,) array
        Share of the explainable error that is gone, by draws of the predictions.
    rival : float, optional
        Error of the bias observer. [m]
    """
    before, after, floor = map(float, errors)
    # The share is not defined where before and noise floor nearly agree.
    share = float(share_explained(before, after, floor))
    some = np.isfinite(share)
    return {
        "horizon_s": horizon,
        "before_m": before,
        "bias_observer_m": rival,
        "after_m": after,
        "noise_floor_m": floor,
        "share_of_explainable": share if some else None,
        "ci95": [float(q) for q in np.nanquantile(drawn, (0.025, 0.975))] if some else None,
    }


def parts(errors: xarray.Dataset, names: str = "regime") -> dict[Any, xarray.Dataset]:
    """The errors of a comparison by conditions of the segments.

    Parameters
    ----------
    errors : xarray.Dataset
    names : str
        Coordinate of the segments.

    Returns
    -------
    dict of value to xarray.Dataset
    """
    values = errors[names].values
    return {
        value.item(): errors.isel(segment=np.flatnonzero(values == value))
        for value in np.unique(values)
    }


def roots(means: np.ndarray) -> np.ndarray:
    """Roots of mean squares, the last two after and of a perfect model: it misses no more than one that there is."""
    *others, after, floor = np.sqrt(means)
    return np.stack([*others, after, np.minimum(floor, after)])


def share_explained(
    before: np.ndarray | float, after: np.ndarray | float, floor: np.ndarray | float
) -> np.ndarray:
    """Share of the explainable error that is gone: (before - after) / (before - floor), NaN where that is little."""
    worth = np.subtract(before, floor)
    some = worth > 0.05 * before
    return np.where(some, (before - after) / np.where(some, worth, 1.0), np.nan)


def _blocks(times):
    """Number of the block that each segment is in."""
    return np.unique((times - times[0]) // BLOCK, return_inverse=True)[1]


def resampled_sums(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Sums over as many columns as there are, drawn with repetition: (n, draws) array (bootstrap)."""
    count = values.shape[1]
    return values @ rng.multinomial(count, np.full(count, 1.0 / count), size=DRAWS).T


def _resampled(squares, times, seed):
    """Mean squares of draws of blocks, (models, draws) array."""
    block = _blocks(times)
    blocks = block.max() + 1
    # Sums of squares and counts by block; a draw's mean is the ratio of its sums.
    sums = np.stack(
        [np.bincount(block, weights, blocks) for weights in (*squares, np.ones(block.size))]
    )
    drawn = resampled_sums(sums, np.random.default_rng(seed))
    return drawn[:-1] / drawn[-1]
