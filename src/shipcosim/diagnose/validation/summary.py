"""Errors of predictions as values: root mean squares by horizon and condition, and what the causes gain in each."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray

from shipcosim.diagnose.validation.gain import CHANNELS, Comparison, gain, parts, rms
from shipcosim.diagnose.validation.thresholds import FEWEST_INTERVAL_BLOCKS


@dataclass(frozen=True)
class ConditionErrors:
    """Errors of the predictions made under one condition.

    Attributes
    ----------
    condition : str
        What the ship did, or what was held out of the fit.
    predictions : int
    rms : xarray.Dataset
        Root mean squares over the predictions, by channel over ``model`` and ``horizon``.
    gain : dict or None
        As the entry of diagnosis.json; None where no cause was named.
    """

    condition: str
    predictions: int
    rms: xarray.Dataset
    gain: dict | None


@dataclass(frozen=True)
class PredictionErrors:
    """Errors of predictions on rows that nothing was fitted on.

    Attributes
    ----------
    each : xarray.Dataset
        Of every prediction, as in `Comparison`.
    overall : ConditionErrors
    by_regime : tuple of ConditionErrors
        By what the ship did.
    held_out : tuple of ConditionErrors
        On conditions that are held out of the fit wherever in the log they are: ``"other headings"``, ``"free drift"``.
    is_simulated : bool
        Whether they are those of co-simulations, else of the model in array form.
    difference : float or None
        Largest distance between co-simulation and array form after the longest horizon. [m]
    extended, calibrated : float
        Position error in array form with the causes, and with every known number moved within its tolerance besides.
        [m]
    """

    each: xarray.Dataset
    overall: ConditionErrors
    by_regime: tuple[ConditionErrors, ...]
    held_out: tuple[ConditionErrors, ...]
    is_simulated: bool
    difference: float | None
    extended: float
    calibrated: float


def prediction_errors(
    comparison: Comparison,
    errors: xarray.Dataset,
    held_out: Mapping[str, xarray.Dataset],
    *,
    is_named: bool,
    is_simulated: bool,
) -> PredictionErrors:
    """Summary of errors.

    Parameters
    ----------
    comparison : Comparison
        In array form.
    errors : xarray.Dataset
        Its errors, or those of co-simulations.
    held_out : dict of str to xarray.Dataset
        Errors by condition that was held out of the fit.
    is_named : bool
        Whether a cause was named, so that there is a gain.
    is_simulated : bool
        Whether the errors are those of co-simulations.
    """
    apart = float(errors["difference"].isel(horizon=-1).max()) if "difference" in errors else None
    return PredictionErrors(
        errors,
        condition_errors("all", errors, is_named),
        tuple(condition_errors(str(name), part, is_named) for name, part in parts(errors).items()),
        tuple(condition_errors(name, part, is_named) for name, part in held_out.items()),
        is_simulated,
        apart,
        *(rms(comparison.errors, "position", model) for model in ("extended", "calibrated")),
    )


def condition_errors(
    condition: str, errors: xarray.Dataset, is_named: bool = False
) -> ConditionErrors:
    """Summary of the errors under one condition."""
    finite = errors[list(CHANNELS)].where(np.isfinite(errors[list(CHANNELS)]))
    squares = (finite**2).mean("segment")
    return ConditionErrors(
        condition,
        errors.sizes["segment"],
        np.sqrt(squares),
        gain(errors, fewest=FEWEST_INTERVAL_BLOCKS) if is_named else None,
    )
