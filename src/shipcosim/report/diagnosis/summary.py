"""A diagnosis in short: its key figures, and what terminal and notebook show of it."""

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.by_log import error_table, log_table
from shipcosim.report.diagnosis.gain_section import craft_table
from shipcosim.report.diagnosis.testability import visible_rows
from shipcosim.report.diagnosis.words import discrepancy_rows, finding_rows, title, title_of
from shipcosim.report.theme.numbers import metres, percent, plain
from shipcosim.report.theme.views import Block, KeyFigure, Table

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
        figures = [
            KeyFigure(metres(gain[name]), meaning.format(gain["horizon_s"], judged))
            for name, meaning in meanings.items()
            if gain[name] is not None
        ]
        if gain["share_of_explainable"] is not None:
            low, high = (f"{100 * edge:.0f}" for edge in gain["ci95"])
            meaning = f"of the explainable error removed (95 % sure: {low} to {high} %)"
            figures.append(KeyFigure(percent(gain["share_of_explainable"]), meaning))
        return figures
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


def summary(diagnosis: Diagnosis) -> tuple[Block, ...]:
    """What a diagnosis found, in tables and lines; of several logs also by log."""
    several = isinstance(diagnosis, JointDiagnosis)
    logs = "These logs" if several else "This log"
    rivals = [(title_of(c), percent(c.probability)) for c in diagnosis.indistinguishable]
    findings = Table(list(finding_rows(diagnosis.findings)), ("", "probability", "", "size"))
    unseen = () if diagnosis.is_assumed else diagnosis.not_testable
    silent = (", ".join(map(title, unseen)),) if unseen else ()
    visible = Table(visible_rows(diagnosis.smallest_visible, diagnosis.not_testable))
    columns = diagnosis.log.measured.attrs.get("column_remarks", ()) if diagnosis.log else ()
    return (
        Block("Differences, largest first", Table(discrepancy_rows(diagnosis))),
        Block("Found", findings),
        Block("Learned of the craft", craft_table(diagnosis.craft)),
        Block(f"{logs} cannot tell apart", Table(rivals)),
        Block("Errors", Table(key_figures(diagnosis))),
        Block("Errors by log", error_table(diagnosis.errors) if several else Table(())),
        Block("Each log by itself", log_table(diagnosis)),
        Block(f"{logs} could not have shown", lines=silent, folded=True),
        # What would have shown matters most where nothing in the ship was found.
        Block(
            "Smallest fault that would have shown, in 9 of 10 cases",
            visible,
            folded=bool(diagnosis.physics),
        ),
        Block("Columns", lines=tuple(columns), folded=True),
        Block("Remarks", lines=diagnosis.notes),
    )
