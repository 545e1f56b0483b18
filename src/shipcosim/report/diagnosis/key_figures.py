"""Key figures of a diagnosis: how sure, and how large the errors were and are."""

from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.theme.numbers import metres, percent, plain
from shipcosim.report.theme.views import KeyFigure


def key_figures(diagnosis: Diagnosis) -> tuple[KeyFigure, ...]:
    """The numbers that matter most.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    tuple of KeyFigure
    """
    sure = [f.probability for f in diagnosis.findings if f.kind == "physics"]
    chance = [KeyFigure(percent(min(sure)), "probability that the cause is right")] if sure else []
    return (*chance, *_errors(diagnosis))


def _errors(diagnosis: Diagnosis) -> list[KeyFigure]:
    """Errors of predictions before and after, or before only where nothing was gained."""
    gain, base = diagnosis.gain, diagnosis.baseline
    if gain:
        found = [
            KeyFigure(metres(gain["before_m"]), f"position error of the simulation after {gain['horizon_s']:g} s"),
            KeyFigure(metres(gain["bias_observer_m"]), "the same with a bias observer, as DP systems have"),
            KeyFigure(metres(gain["after_m"]), "the same with the cause in the model"),
            KeyFigure(metres(gain["noise_floor_m"]), "what a perfect model would still miss"),
        ]
        if gain["share_of_explainable"] is not None:
            low, high = (f"{100 * edge:.0f}" for edge in gain["ci95"])
            meaning = f"of the explainable error removed (95 % sure: {low} to {high} %)"
            found.append(KeyFigure(percent(gain["share_of_explainable"]), meaning))
        return found
    if base:
        after = f"after {base['horizon_s'][-1]:g} s"
        position, heading = metres(base["position_error_m"][-1]), plain(base["heading_error_deg"][-1], 2)
        return [
            KeyFigure(position, f"position error of the simulation {after}"),
            KeyFigure(f"{heading}°", f"heading error {after}"),
        ]
    return []
