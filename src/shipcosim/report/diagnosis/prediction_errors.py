"""Figures and tables of prediction errors: by horizon, by what the ship did, by condition, with each model."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from xarray import Dataset

from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.gain import gain, parts
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, bars, line
from shipcosim.report.theme.numbers import plain
from shipcosim.report.theme.views import Figure, Table

MODELS = {
    "plain": ("plain model", palette.VERMILLION),
    "bias_observer": ("plain model with bias observer", palette.ORANGE),
    "extended": ("with the cause", palette.BLUE),
    "extended_observer": ("with the cause and a bias observer", palette.GREEN),
    "floor": ("noise floor", palette.FAINT),
}
CHANNELS = {
    "position": ("Position", "m"),
    "heading": ("Heading", "°"),
    "surge": ("Surge", "m/s"),
    "sway": ("Sway", "m/s"),
    "yaw_rate": ("Rate of turn", "°/s"),
}
BLOCKS = 3  # of 120 s, for an interval of a part of the predictions
HELD = {"other headings": "headings not fitted on", "free drift": "free drift, not fitted on"}


def rms(values: ArrayLike) -> float:
    """Root mean square of the finite values; NaN without any."""
    every = np.asarray(values, float)
    known = every[np.isfinite(every)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def models_to_show(models: Sequence[str], diagnosis: Diagnosis) -> list[str]:
    """These models; what a perfect one would miss is not known while something is wrong that has no name."""
    return [m for m in models if m != "floor" or diagnosis.verdict in ("named", "consistent")]


def error_figures(errors: Dataset, models: Sequence[str]) -> list[Figure]:
    """Errors over the horizon, a figure for position and heading each.

    Parameters
    ----------
    errors : xarray.Dataset
        Of a `Comparison`: channels by ``model``, ``horizon`` and ``segment``.
    models : sequence of str

    Returns
    -------
    list of Figure
    """
    figures, horizons = [], errors["horizon"].values
    for channel in ("position", "heading"):
        title, unit = CHANNELS[channel]
        traces = []
        for model in models:
            name, colour = MODELS[model]
            sizes = [rms(errors[channel].sel(model=model, horizon=h)) for h in horizons]
            traces.append(bars(name, [f"{h:.0f} s" for h in horizons], sizes, colour, unit))
        layout = {"barmode": "group", "xaxis": {"type": "category"}, "yaxis": {"rangemode": "tozero"}}
        figures.append(Figure(f"{title} error after 10, 30, 60 s", unit, tuple(traces), layout))
    return figures


def error_table(errors: Dataset, models: Sequence[str] = ("plain", "floor")) -> Table:
    """Root mean square errors after the longest horizon, by what the ship did and channel.

    Returns
    -------
    Table
        Each cell shows the models' errors, the last as the floor.
    """
    head = ("", "Segments", *(f"{title} [{unit}]" for title, unit in CHANNELS.values()))
    regimes, last = errors["regime"].values, errors.isel(horizon=-1)
    groups = [("all", np.arange(regimes.size))]
    groups += [(str(name), np.flatnonzero(regimes == name)) for name in np.unique(regimes)]
    rows = []
    for name, which in groups:
        cells = [
            " / ".join(plain(rms(last[channel].sel(model=model).isel(segment=which)), 2) for model in models)
            for channel in CHANNELS
        ]
        rows.append((name, str(which.size), *cells))
    return Table(tuple(rows), head, tight=tuple(range(2, 9)))


def condition_table(errors: Dataset, unseen: Mapping[str, Dataset]) -> Table:
    """Position errors after the longest horizon with each model, by condition, and the share that the causes remove.

    Parameters
    ----------
    errors : xarray.Dataset
        On the rows that were held out in time.
    unseen : dict of str to xarray.Dataset
        By condition that nothing was fitted on.

    Returns
    -------
    Table
    """
    models = (f"{name} [m]" for name, _ in MODELS.values())
    head = ("Held out", "Predictions", *models, "explainable error removed")
    groups = {"the later part": errors} | {f"of it {name}": part for name, part in parts(errors).items()}
    groups |= {HELD[name]: part for name, part in unseen.items()}
    rows = []
    for name, part in groups.items():
        last = part["position"].isel(horizon=-1)
        cells = [plain(rms(last.sel(model=model)), 2) for model in MODELS]
        rows.append((name, str(part.sizes["segment"]), *cells, removed(gain(part, fewest=BLOCKS))))
    return Table(tuple(rows), head, tight=tuple(range(1, 8)))


def removed(entry: Mapping[str, Any]) -> str:
    """Share of the explainable error that causes remove, with its interval, of an entry of `gain`."""
    if entry["share_of_explainable"] is None:
        return "nothing to remove"
    sure = " ({:.0f} to {:.0f} %)".format(*(100 * end for end in entry["ci95"])) if entry["ci95"] else ""
    return f"{100 * entry['share_of_explainable']:.0f} %{sure}"


def gain_figures(errors: Dataset, models: Sequence[str]) -> list[Figure]:
    """Errors after the longest horizon with each model: by what the ship did, and of each prediction."""
    regimes, last = errors["regime"].values, errors.isel(horizon=-1)
    names = [str(name) for name in np.unique(regimes)]
    by_regime, each = [], []
    for model in models:
        (name, colour), position = MODELS[model], last["position"].sel(model=model)
        sizes = [rms(position.isel(segment=regimes == regime)) for regime in names]
        by_regime.append(bars(name, names, sizes, colour, "m"))
        dots = {"mode": "markers", "marker": {"color": colour, "size": 5}}
        each.append(line(name, last["start_time"].values, position.values, colour, **dots))
    axis, title = {"rangemode": "tozero"}, "Position error after 60 s"
    return [
        Figure(f"{title}, by what the ship did", "m", tuple(by_regime), {"barmode": "group", "yaxis": axis}),
        Figure(f"{title}, each prediction", "m", tuple(each), {"xaxis": TIME, "yaxis": axis}),
    ]
