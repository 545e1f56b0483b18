"""Figures of a gain that the trial reports: beside a bias observer, and by conditions."""

from typing import Any

import xarray

from shipcosim.diagnose.validation.gain import (
    HORIZONS,
    MODELS,
    _resampled,
    parts,
    rms,
    share_explained,
)


def beyond_observer(errors: xarray.Dataset) -> float:
    """Share of what the bias observer leaves of the explainable error that the cause takes away beside one; or NaN."""
    rival, after = (
        rms(errors, "position", model) for model in ("bias_observer", "extended_observer")
    )
    return float(share_explained(rival, after, min(rms(errors, "position", "floor"), after)))


def chance_of_more(errors: xarray.Dataset, model: str, rival: str, seed: int = 1) -> float:
    """How sure it is that one model misses more than another after the longest horizon: share of bootstrap draws."""
    squares = errors["position"].isel(horizon=-1).sel(model=[model, rival]).values ** 2
    one, other = _resampled(squares, errors["start_time"].values, seed)
    return float((one > other).mean())


def by_condition(
    errors: xarray.Dataset, names: str, channel: str = "position", horizon: float = HORIZONS[-1]
) -> dict[Any, dict[str, float]]:
    """Root mean square errors of all models by conditions of the segments.

    Parameters
    ----------
    errors : xarray.Dataset
        Of a `Comparison`.
    names : str
        Coordinate of the segments, as ``"regime"`` or ``"heading_known"``.
    channel : str
    horizon : float
        [s]

    Returns
    -------
    dict of value to dict of str to float
        By value and model; and ``"segments"``, how many there are.
    """
    return {
        value: {model: rms(part, channel, model, horizon) for model in MODELS}
        | {"segments": part.sizes["segment"]}
        for value, part in parts(errors, names).items()
    }
