"""Section 2 of the page, and figures and tables of prediction errors: by horizon, regime, condition and model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.summary import ConditionErrors, PredictionErrors
from shipcosim.report.diagnosis import by_log
from shipcosim.report.diagnosis.force_figures import force_figures
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line
from shipcosim.report.theme.numbers import percent, plain
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
HELD = {"other headings": "headings not fitted on", "free drift": "free drift, not fitted on"}


@dataclass(frozen=True)
class ErrorSection:
    """Errors of predictions with the model as it was, and the force that it lacks.

    Attributes
    ----------
    found : str
        The result in a few words.
    errors : Table
        Empty if there was too little data for predictions.
    has_floor : bool
        Whether the noise floor is shown too.
    forces : tuple of Figure
        The missing force; empty if it is not known.
    """

    found: str
    errors: Table
    has_floor: bool
    forces: tuple[Figure, ...]


def error_section(diagnosis: Diagnosis) -> ErrorSection:
    """Section 2 of the page for the template."""
    if isinstance(diagnosis, JointDiagnosis):
        table = by_log.error_table(diagnosis.errors)
        return ErrorSection(by_log.error_after(diagnosis), table, False, ())
    # Errors of the model as it was; the noise floor only where it is known.
    errors = diagnosis.predictions
    models = models_to_show(("plain", "floor"), diagnosis)
    return ErrorSection(
        found=by_log.error_after(diagnosis),
        errors=Table(()) if errors is None else error_table(errors, models),
        has_floor="floor" in models,
        forces=() if diagnosis.force is None else tuple(force_figures(diagnosis.force)),
    )


def models_to_show(models: Sequence[str], diagnosis: Diagnosis) -> list[str]:
    """Models to show; the noise floor is unknown while an unnamed error acts."""
    return [
        m for m in models if m != "floor" or diagnosis.verdict in ("named", "consistent", "form")
    ]


def _error(errors: ConditionErrors, channel: str, model: str, horizon: int = -1) -> float:
    """Root mean square error at a horizon, by default the longest."""
    return float(errors.rms[channel].sel(model=model).isel(horizon=horizon))


def error_table(errors: PredictionErrors, models: Sequence[str] = ("plain", "floor")) -> Table:
    """Root mean square errors by horizon, and at the longest by regime; for each channel.

    Each cell shows the models' errors, the last as the floor.
    """
    head = ("", "After", "Segments", *(f"{title} [{unit}]" for title, unit in CHANNELS.values()))
    horizons = errors.overall.rms["horizon"].values
    # All predictions together at each horizon, then by what the ship did.
    groups = [(errors.overall, k) for k in range(len(horizons))]
    groups += [(regime, -1) for regime in errors.by_regime]
    rows = []
    for condition, k in groups:
        cells = [
            " / ".join(plain(_error(condition, channel, model, k), 2) for model in models)
            for channel in CHANNELS
        ]
        name = condition.condition
        rows.append((name, f"{horizons[k]:g} s", str(condition.predictions), *cells))
    return Table(rows, head)


def condition_table(errors: PredictionErrors) -> Table:
    """Position errors at the longest horizon by condition and model, and the removed share."""
    # The later part of the log, its regimes, and conditions that were held out.
    models = (f"{name} [m]" for name, _ in MODELS.values())
    head = ("Held out", "Predictions", *models, "explainable error removed")
    groups = {"the later part": errors.overall} | {
        f"of it {condition.condition}": condition for condition in errors.by_regime
    }
    groups |= {HELD[condition.condition]: condition for condition in errors.held_out}
    rows = []
    for name, group in groups.items():
        cells = [plain(_error(group, "position", model), 2) for model in MODELS]
        rows.append((name, str(group.predictions), *cells, removed(group.gain)))
    return Table(rows, head)


def removed(entry: Mapping[str, Any] | None) -> str:
    """Removed share of the explainable error, with its interval, from an entry of `gain`."""
    if entry is None or entry["share_of_explainable"] is None:
        return "nothing to remove"
    # The interval only where there were enough predictions for one.
    sure = (
        " ({:.0f} to {:.0f} %)".format(*(100 * end for end in entry["ci95"]))
        if entry["ci95"]
        else ""
    )
    return percent(entry["share_of_explainable"]) + sure


def gain_figure(errors: PredictionErrors, models: Sequence[str]) -> Figure:
    """Error of each prediction at the longest horizon with each model."""
    last = errors.each.isel(horizon=-1)
    traces = []
    for model in models:
        name, colour = MODELS[model]
        position = last["position"].sel(model=model)
        dots = {"mode": "markers", "marker": {"color": colour, "size": 5}}
        traces.append(line(name, last["start_time"].values, position.values, colour, **dots))
    layout = {"xaxis": TIME, "yaxis": {"rangemode": "tozero"}}
    return Figure("Position error after 60 s, each prediction", "m", traces, layout)
