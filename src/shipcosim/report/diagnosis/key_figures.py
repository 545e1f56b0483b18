"""Key figures of a diagnosis: certainty, and errors before and after."""

from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.theme.numbers import metres, percent, plain
from shipcosim.report.theme.views import KeyFigure

_GAIN = {
    "before_m": "position error of the simulation after {:.4g} s, {}",
    "bias_observer_m": "the same with a bias observer, as DP systems have",
    "after_m": "the same with the cause in the model",
    "noise_floor_m": "what a perfect model would still miss",
}
_LEARNED = "the same with what the log teaches of the craft"


def key_figures(diagnosis: Diagnosis) -> tuple[KeyFigure, ...]:
    """Key figures of a diagnosis.

    Parameters
    ----------
    diagnosis : Diagnosis

    Returns
    -------
    tuple of KeyFigure
    """
    # The least certain cause decides.
    sure = [finding.probability for finding in diagnosis.physics]
    chance = [KeyFigure(percent(min(sure)), "probability that the cause is right")] if sure else []
    return (*chance, *_errors(diagnosis))


def _errors(diagnosis: Diagnosis) -> list[KeyFigure]:
    """Prediction errors before and after; before only if nothing was gained."""
    gain = diagnosis.gain
    base = diagnosis.baseline
    # With a gain: each error, then the share of the explainable error with its interval.
    if gain:
        judged = (
            "over all logs, each by what the others say"
            if "logs" in gain
            else "on rows kept from the fit"
        )
        # The gain of a learned craft has no causes in it.
        meanings = _GAIN | ({} if diagnosis.is_named else {"after_m": _LEARNED})
        found = [
            KeyFigure(metres(gain[name]), meaning.format(gain["horizon_s"], judged))
            for name, meaning in meanings.items()
            if gain[name] is not None
        ]
        if gain["share_of_explainable"] is not None:
            low, high = (f"{100 * edge:.0f}" for edge in gain["ci95"])
            meaning = f"of the explainable error removed (95 % sure: {low} to {high} %)"
            found.append(KeyFigure(percent(gain["share_of_explainable"]), meaning))
        return found
    # Without a gain: the errors of the model as it was.
    if base:
        after = f"after {base['horizon_s'][-1]:.4g} s"
        position = metres(base["position_error_m"][-1])
        heading = plain(base["heading_error_deg"][-1], 2)
        return [
            KeyFigure(position, f"position error of the simulation {after}"),
            KeyFigure(f"{heading}°", f"heading error {after}"),
        ]
    return []
