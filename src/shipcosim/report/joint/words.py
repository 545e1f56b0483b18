"""What a diagnosis of several logs says, in sentences and rows."""

from collections.abc import Iterable

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.hypotheses.catalogue import read_faults
from shipcosim.diagnose.reference.common_findings import Shared
from shipcosim.diagnose.reference.held_out import LogErrors
from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.report.diagnosis.words import (
    ADD_A_CAUSE,
    cause_steps,
    craft_sentence,
    listed,
    manoeuvre_step,
    say_nothing,
    size_rows,
    title,
    title_of,
    told,
)
from shipcosim.report.theme.numbers import metres, percent, plain
from shipcosim.report.theme.views import Outcome


def outcome(found: JointDiagnosis) -> Outcome:
    """The common verdict as a word, and in one sentence or two."""
    data = [_told(one, found) for one in found.findings if one.what.kind == "data"]
    physics = [_told(one, found) for one in found.findings if one.what.kind == "physics"]
    log = f" The logs are faulty alike: {listed(data)}." if data else ""
    return Outcome(
        found.verdict, found.verdict.upper(), _sentence(found, physics, bool(data)) + log
    )


def _sentence(found: JointDiagnosis, physics: list[str], has_faults: bool) -> str:
    logs = f"{len(found.logs)} logs together"
    if found.verdict == "unknown":
        first = (
            f", first of all: {found.discrepancies[0].what.what}"
            if found.discrepancies
            else " by more than noise"
        )
        certain = f" Certain is: {listed(physics)}." if physics else ""
        unexplained = f"None of the known causes explains all of it.{craft_sentence(found.craft)}"
        return f"{logs}: the simulation is wrong{first}.{certain} {unexplained}"
    if found.verdict == "ambiguous":
        if not found.indistinguishable:
            return f"{logs} say nothing of the ship: their channels may be misread. Each log's own line says how."
        names = listed([title_of(one).lower() for one in found.indistinguishable], "or")
        certain = f" Certain is: {listed(physics)}." if physics else ""
        return f"Something is wrong, and {logs} cannot tell which: {names}.{certain}"
    if physics:
        return (
            f"{logs}: {'one thing is' if len(physics) == 1 else f'{len(physics)} things are'} not as modelled: "
            + (f"{listed(physics)}.")
        )
    if has_faults or any(found.own_faults(name) for name in found.logs):
        return f"{logs}: apart from faults of the logs, simulation and logs agree."
    return f"{logs}: simulation and logs agree, within noise and the tolerances of the model."


def _told(one: Shared[Finding], found: JointDiagnosis) -> str:
    """A common finding as a clause; one of the weather with its day, and one of some logs with how many."""
    text = told(one.what, found.causes)
    if one.what.component in found.logs:
        return f"{text} (on the day of {one.what.component})"
    if one.what.kind == "data" and one.what.note:
        text = one.what.note
    told_by = len(one.logs)
    all_logs = len(found.logs)
    return (
        text
        if one.what.kind == "physics" or told_by == all_logs
        else f"{text} (seen in {told_by} of {all_logs})"
    )


def discrepancy_rows(found: JointDiagnosis) -> list[tuple[str, ...]]:
    """Common discrepancies, largest first: in words, the mean size where they hold none, share of the error, logs."""
    rows = []
    for shared in found.discrepancies:
        one = shared.what
        unit = "" if one.unit == "1" else f" {one.unit}"
        in_words = any(letter.isdigit() for letter in one.what)
        size = f"{one.estimate:.2f} ± {one.std:.2f}{unit}" if one.std and not in_words else ""
        rows.append(
            (one.what, size, percent(one.share) if one.share else "", _which(shared.logs, found))
        )
    return rows


def _which(logs: Iterable[str], found: JointDiagnosis) -> str:
    logs = tuple(logs)
    return "all" if len(logs) == len(found.logs) else ", ".join(logs)


def fault_rows(found: JointDiagnosis) -> list[tuple[str, ...]]:
    """Faults of the data that the logs have in common: what, channels, in which logs, what was done."""
    rows = []
    for one in found.findings:
        if one.what.kind == "data":
            also = f"; put right in {', '.join(one.put_right)} too" if one.put_right else ""
            done = f"{read_faults()[one.what.cause].repair}{also}"
            rows.append(
                (
                    one.what.sentence or told(one.what),
                    ", ".join(one.what.channels),
                    _which(one.logs, found),
                    done,
                )
            )
    return rows


def cause_rows(found: JointDiagnosis) -> list[tuple[str, ...]]:
    """Common causes with their sizes: by all logs, and by each log alone."""
    rows = []
    for one in found.findings:
        if one.what.kind != "physics":
            continue
        day = one.what.component in found.logs
        name = title(one.what.cause, None if day else one.what.component)
        first = f"{one.what.component} (weather of the day)" if day else "all together"
        rows += [(name, first, *row) for row in _sizes(one.what)]
        for log, parameters in found.sizes.get(one.what.label, {}).items():
            by_log = Finding(one.what.cause, one.what.component, parameters=parameters)
            rows += [("", f"{log} alone", *row) for row in _sizes(by_log)]
    return rows


def _sizes(finding: Finding) -> list[tuple[str, str]]:
    """Parameters of a finding with their sizes; one empty row without any."""
    return size_rows(finding) or [("", finding.note)]


def error_rows(found: JointDiagnosis) -> list[tuple[str, ...]]:
    """Errors by log after each horizon: position and heading, before and after, and what judged it."""
    rows = []
    for name, one in found.errors.items():
        after = " / ".join(f"{horizon:.2g}" for horizon in one.horizon)
        cells = [
            _all(of.get(label), unit)
            for of, unit in ((one.position, " m"), (one.heading, "°"))
            for label in _BOTH
        ]
        rows.append((name, f"{after} s", *cells, judged_on(one)))
    return rows


_BOTH = ("before", "after")


def _all(values: tuple[float, ...] | None, unit: str) -> str:
    return "–" if values is None else " / ".join(plain(value, 2) for value in values) + unit


def predicted_better(found: JointDiagnosis) -> tuple[int, int]:
    """How many logs are predicted better with the common causes, in position after the longest horizon; of how many."""
    judged = [one.position for one in found.errors.values() if "after" in one.position]
    return sum(one["after"][-1] < one["before"][-1] for one in judged), len(judged)


def judged_on(one: LogErrors) -> str:
    """What an error after rests on."""
    if not one.fitted_on:
        return "–"
    text = (
        "sizes by all other logs"
        if len(one.fitted_on) > 2
        else f"sizes by {', '.join(one.fitted_on)}"
    )
    return (
        text
        if not one.own
        else f"{text}; {listed([title(c).lower() for c in one.own])} by this log itself"
    )


def log_rows(found: JointDiagnosis) -> list[tuple[str, ...]]:
    """What each log says by itself: verdict, faults of its own, causes, its largest discrepancy, error."""
    rows = []
    for name, one in found.logs.items():
        faults = [fault.sentence or told(fault) for fault in found.own_faults(name)]
        causes = [told(finding, found.causes) for finding in one.physics]
        first = one.discrepancies[0].what if one.discrepancies else "none"
        base = one.baseline
        error = (
            f"{metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:.2g} s"
            if base
            else "–"
        )
        rows.append(
            (
                name,
                one.verdict,
                "; ".join(faults) or "none",
                "; ".join(causes) or "none",
                first,
                error,
            )
        )
    return rows


def next_steps(found: JointDiagnosis, extended: str | None = None) -> list[str]:
    """What to do now.

    Parameters
    ----------
    found : JointDiagnosis
    extended : str, optional
        Path of the extended system, where something in it is other than it was.
    """
    steps = []
    faults = found.of_kind("data")
    if faults:
        what = listed(list(dict.fromkeys(one.note or told(one) for one in faults)))
        steps.append(f"Correct the channel file or the logging, for all logs at once: {what}.")
    own = [name for name in found.logs if found.own_faults(name)]
    if own:
        steps.append(
            f"Look at the faults of single logs: {', '.join(own)}. This diagnosis used repaired copies."
        )
    physics = found.of_kind("physics")
    steps += dict.fromkeys(cause_steps(physics, found.causes))
    if found.verdict == "ambiguous" and found.indistinguishable:
        steps.append(manoeuvre_step(found.prescription))
    if found.verdict == "unknown":
        steps.append(
            "Diagnose a log by itself: its page shows how the missing force goes with time, heading and wind."
        )
        steps.append(ADD_A_CAUSE)
    better, judged = predicted_better(found)
    if extended and 2 * better < judged:
        steps.append(
            f"Do not use {extended} yet: with it {judged - better} of {judged} logs are predicted no better. What is "
            "named is not all; mend first what stands beside it under what is wrong, largest first."
        )
    elif extended:
        steps.append(f"Simulate with the causes in the system: shipcosim simulate {extended}")
    if found.not_testable:
        steps.append(f"All logs together {say_nothing(found.not_testable, 'say')}")
    return steps or ["Nothing needs to be done."]
