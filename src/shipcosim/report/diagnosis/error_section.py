"""Section 2 of the page: what does the simulation get wrong?"""

from dataclasses import dataclass

from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.force_figures import force_figures
from shipcosim.report.diagnosis.prediction_errors import error_figures, error_table, models_to_show
from shipcosim.report.theme.numbers import metres
from shipcosim.report.theme.views import Figure, Table


@dataclass(frozen=True)
class ErrorSection:
    """Errors of predictions with the model as it was, and the force that it lacks.

    Attributes
    ----------
    found : str
        The result in a few words.
    figures : tuple of Figure
        Errors; empty if there was too little data for predictions.
    errors : Table
    has_floor : bool
        Whether the noise floor is shown too.
    forces : tuple of Figure
        The missing force; empty if it is not known.
    """

    found: str
    figures: tuple[Figure, ...]
    errors: Table
    has_floor: bool
    forces: tuple[Figure, ...]


def error_section(diagnosis: Diagnosis) -> ErrorSection:
    """Section 2 of the page for the template."""
    # Errors of the model as it was; the noise floor only where it is known.
    base = diagnosis.baseline
    errors = diagnosis.predictions
    models = models_to_show(("plain", "floor"), diagnosis)
    return ErrorSection(
        found=f"{metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:.4g} s"
        if base
        else "not measured",
        figures=() if errors is None else tuple(error_figures(errors.overall, models)),
        errors=Table(()) if errors is None else error_table(errors, models),
        has_floor="floor" in models,
        forces=() if diagnosis.force is None else tuple(force_figures(diagnosis.force)),
    )
