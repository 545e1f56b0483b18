"""Section 5 of the page: what was gained?"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from shipcosim.diagnose.craft.learned import LearnedCraft
from shipcosim.diagnose.result import Diagnosis
from shipcosim.errors import capitalised
from shipcosim.report.diagnosis.prediction_errors import (
    MODELS,
    condition_table,
    gain_figure,
    models_to_show,
    removed,
)
from shipcosim.report.theme.numbers import metres, percent, plain
from shipcosim.report.theme.views import Figure, Table

LACKING = {"other headings": "another quarter of headings", "free drift": "a drift without thrust"}


_LEARNED = ("Learned from the log", "By the file", "Learned", "Error without it")


@dataclass(frozen=True)
class GainSection:
    """Errors of predictions before and after.

    Attributes
    ----------
    found : str
        The result in a few words.
    is_cosimulation, is_extended : bool
        Whether predictions are co-simulations or in array form; whether the extended system was among them.
    craft : str
        Over which time a learned craft was measured by itself, on parts of the log that were held out; else empty.
    errors : Table
        After 60 s, with each model; of a learned craft after her own time.
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
    numbers : Table
        Of a learned craft.
    logs : str
        Names of the logs that were predicted with the causes as the others sized them.
    """

    found: str
    is_cosimulation: bool
    is_extended: bool
    craft: str = ""
    errors: Table = Table(())
    figures: tuple[Figure, ...] = ()
    conditions: Table = Table(())
    missing: str = ""
    extended: str = ""
    calibrated: str = ""
    difference: str = ""
    numbers: Table = Table(())
    logs: str = ""


def gain_section(diagnosis: Diagnosis) -> GainSection:
    """Section 5 of the page for the template."""
    gain = diagnosis.gain
    errors = diagnosis.predictions
    # A learned craft has no co-simulation and only one comparison.
    if gain and "error_ratio" in gain:
        return _of_craft(gain, diagnosis)
    # Without an extension, only the models before it.
    models = models_to_show(tuple(MODELS), diagnosis)
    if diagnosis.extension is None or gain is None:
        models = [model for model in models if not model.startswith("extended")]
    message = "nothing to gain" if diagnosis.verdict == "consistent" else "none"
    if gain and gain["share_of_explainable"] is not None:
        message = f"{percent(gain['share_of_explainable'])} of the explainable error"
    is_extended = "extended" in models
    if errors is None:
        logs = gain["logs"] if gain and "logs" in gain else ()
        return GainSection(message, False, is_extended, errors=_errors(gain), logs=", ".join(logs))
    # Conditions that the log has too little of to measure a gain.
    held_out = {condition_errors.condition for condition_errors in errors.held_out}
    return GainSection(
        message,
        errors.is_simulated,
        is_extended,
        errors=_errors(gain),
        figures=(gain_figure(errors, models),),
        conditions=condition_table(errors) if gain else Table(()),
        missing=" and of ".join(text for name, text in LACKING.items() if name not in held_out),
        extended=metres(errors.extended) if gain else "",
        calibrated=metres(errors.calibrated) if gain else "",
        difference="" if errors.difference is None else metres(errors.difference),
    )


def _of_craft(gain: Mapping[str, Any], diagnosis: Diagnosis) -> GainSection:
    """Gain of the craft as the log teaches her, where no cause explains the rest."""
    # Error before, after, and what is left, with its interval.
    after, low, high = f"{gain['horizon_s']:g} s", *map(percent, gain["error_ratio_ci95"])
    craft = diagnosis.craft
    steady = craft.errors.steady if craft and craft.errors else None
    rows = (
        ("Simulation as it was", metres(gain["before_m"])),
        *((("velocity kept", metres(steady)),) if steady is not None else ()),
        ("with what the log teaches", metres(gain["after_m"])),
        ("Error left", f"{percent(gain['error_ratio'])} (95 % sure: {low} to {high})"),
    )
    table = Table(rows, head=(f"Position error after {after}", "Root mean square"))
    return GainSection(
        f"{percent(1.0 - gain['error_ratio'])} of the error",
        False,
        True,
        after,
        table,
        numbers=craft_table(craft),
    )


def _errors(gain: Mapping[str, Any] | None) -> Table:
    """Errors with each model, and the removed share of the explainable error."""
    if not gain:
        return Table(())
    errors = {
        "Simulation as it was": gain["before_m"],
        "with a bias observer": gain["bias_observer_m"],
        "with the named causes": gain["after_m"],
        "Noise floor": gain["noise_floor_m"],
    }
    rows = [(name, metres(error)) for name, error in errors.items() if error is not None]
    if gain["share_of_explainable"] is not None:
        rows.append(("Explainable error removed", removed(gain)))
    judged = "over all logs" if "logs" in gain else "rows kept from the fit"
    head = (f"Position error after {gain['horizon_s']:g} s, {judged}", "Root mean square")
    return Table(rows, head)


def craft_table(craft: LearnedCraft | None) -> Table:
    """Her numbers by the file and as learned, each with the error on held-out parts without it."""
    if craft is None:
        return Table(())
    rows = []
    for learned_number in craft.numbers:
        number = learned_number.number
        unit = "of the file's" if number.is_factor else number.unit
        given = "1" if number.is_factor else plain(number.given)
        learned = f"{plain(learned_number.value)} ± {plain(learned_number.std, 2)} {unit}"
        larger = learned_number.gain - 1.0
        without = f"+ {percent(larger)}" if craft.errors and larger >= 0.005 else ""
        rows.append((capitalised(number.name), given, learned, without))
    return Table(tuple(rows), head=_LEARNED)
