"""Why a log could not have shown some causes: what it has too little of."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.hypotheses.cause import Cause, placeholders
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.report.diagnosis.words import title
from shipcosim.report.theme.numbers import plain


def not_testable_rows(
    problem: IdentificationProblem, names: Sequence[str], causes: Mapping[str, Cause] | None = None
) -> list[tuple[str, str, str]]:
    """Why this log could not have shown some causes: the cause, and what the log has of what would show it."""
    facts, known, rows = log_facts(problem), read_catalogue() if causes is None else causes, []
    for name in names:
        cause = known.get(name)
        reason = f"{_reason(cause, facts)}an effect of typical size would not have stood out"
        rows.append((title(name), cause.sentence if cause else "", reason))
    return rows


def _reason(cause: Cause | None, facts: Mapping[str, str | None]) -> str:
    """What the log lacks to show a cause, and a semicolon; nothing where its file does not say."""
    if cause is None or not cause.why_not_testable:
        return ""
    missing = [name for name in placeholders(cause.why_not_testable) if facts[name] is None]
    if missing:
        return f"there is no {missing[0].partition('_')[0]} in the log; "
    return cause.why_not_testable.format_map(facts) + "; "


def log_facts(problem: IdentificationProblem) -> dict[str, str | None]:
    """What a cause's file can say of a log, see `FACTS`; None for what the log does not have."""
    record, motion = problem.record, problem.motion
    return {
        "astern_share": f"{_reverse(problem):.0f} %",
        "speed": f"{_rms(np.hypot(motion.u, motion.v))} m/s",
        "surge": f"{_rms(motion.u)} m/s",
        "surge_acceleration": f"{_rms(np.gradient(motion.u, record.step))} m/s²",
        "sway": f"{_rms(motion.v)} m/s",
        "wind_speed": None if record.wind is None else f"{plain(float(np.mean(record.wind[0])), 2)} m/s",
        "yaw_rate": f"{_rms(np.degrees(motion.r))} °/s",
    }


def _rms(values: ArrayLike) -> str:
    return plain(float(np.sqrt(np.nanmean(np.asarray(values) ** 2))), 2)


def _reverse(problem: IdentificationProblem) -> float:
    shares = [np.mean(problem.record.units[name][0] < 0.0) for name in problem.model.azimuths]
    return 100.0 * max(shares, default=0.0)
