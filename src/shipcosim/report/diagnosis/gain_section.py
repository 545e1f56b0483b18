"""Section 5 of the page: what was gained?"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.prediction_errors import (
    MODELS,
    condition_table,
    gain_figures,
    models_to_show,
    removed,
)
from shipcosim.report.theme.numbers import metres, percent
from shipcosim.report.theme.views import Figure, Table

LACKING = {"other headings": "another quarter of headings", "free drift": "a drift without thrust"}


@dataclass(frozen=True)
class GainSection:
    """Errors of predictions before and after.

    Attributes
    ----------
    found : str
        The result in a few words.
    is_cosimulation, is_extended : bool
        Whether predictions are co-simulations or in array form; whether the extended system was among them.
    crude : str
        Over which time a crude model was measured by itself, on blocks of the log that were held out; else empty.
    errors : Table
        After 60 s, with each model; of a crude model after the craft's own time.
    figures : tuple of Figure
        Empty if there was too little data to measure it.
    conditions : Table
        By condition; without a row if there is no gain.
    missing : str
        Conditions that the log has too little of, as one text.
    extended, calibrated : str
        Errors in array form: with the causes; with every known number of the ship moved within its tolerance too. [m]
    difference : str
        Largest difference between co-simulation and array form, if it is known. [m]
    """

    found: str
    is_cosimulation: bool
    is_extended: bool
    crude: str = ""
    errors: Table = Table(())
    figures: tuple[Figure, ...] = ()
    conditions: Table = Table(())
    missing: str = ""
    extended: str = ""
    calibrated: str = ""
    difference: str = ""


def gain_section(diagnosis: Diagnosis) -> GainSection:
    """Section 5 of the page for the template."""
    gain = diagnosis.gain
    errors = diagnosis.predictions
    # A crude model has no co-simulation and only one comparison.
    if gain and "error_ratio" in gain:
        return _of_crude_model(gain)
    # Without an extension, only the models before it.
    models = models_to_show(tuple(MODELS), diagnosis)
    if diagnosis.extension is None or gain is None:
        models = [model for model in models if not model.startswith("extended")]
    found = _found(gain, diagnosis.verdict)
    is_extended = "extended" in models
    if errors is None:
        return GainSection(found, False, is_extended)
    # Conditions that the log has too little of to measure a gain.
    held_out = {one.condition for one in errors.held_out}
    return GainSection(
        found,
        errors.is_simulated,
        is_extended,
        errors=_errors(gain),
        figures=tuple(gain_figures(errors, models)),
        conditions=condition_table(errors) if gain else Table(()),
        missing=" and of ".join(text for name, text in LACKING.items() if name not in held_out),
        extended=metres(errors.extended) if gain else "",
        calibrated=metres(errors.calibrated) if gain else "",
        difference="" if errors.difference is None else metres(errors.difference),
    )


def _of_crude_model(gain: Mapping[str, Any]) -> GainSection:
    """Gain of thrust and damping per inertia, where no cause explains the rest."""
    # Error before, after, and what is left, with its interval.
    after, low, high = f"{gain['horizon_s']:g} s", *map(percent, gain["error_ratio_ci95"])
    rows = (
        ("Simulation as it was", metres(gain["before_m"])),
        ("with the named causes", metres(gain["after_m"])),
        ("Error left", f"{percent(gain['error_ratio'])} (95 % sure: {low} to {high})"),
    )
    table = Table(rows, head=(f"Position error after {after}", "Root mean square"))
    return GainSection(
        f"{percent(1.0 - gain['error_ratio'])} of the error", False, True, after, table
    )


def _found(gain: Mapping[str, Any] | None, verdict: str) -> str:
    if gain and gain["share_of_explainable"] is not None:
        return f"{percent(gain['share_of_explainable'])} of the explainable error"
    return "nothing to gain" if verdict == "consistent" else "none"


def _errors(gain: Mapping[str, Any] | None) -> Table:
    """Errors with each model, and the removed share of the explainable error."""
    if not gain:
        return Table(())
    rows = [
        ("Simulation as it was", metres(gain["before_m"])),
        ("with a bias observer", metres(gain["bias_observer_m"])),
        ("with the named causes", metres(gain["after_m"])),
        ("Noise floor", metres(gain["noise_floor_m"])),
    ]
    if gain["share_of_explainable"] is not None:
        rows.append(("Explainable error removed", removed(gain)))
    return Table(
        rows, head=("Position error after 60 s, rows kept from the fit", "Root mean square")
    )
