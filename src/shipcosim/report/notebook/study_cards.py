"""The cards of comparisons of engines, replays, calibrations and sea trials."""

from __future__ import annotations

from collections.abc import Callable

from shipcosim.capability import Capability
from shipcosim.cosim.compare import OURS, Comparison
from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.report.calibration import words as calibration
from shipcosim.report.capability.page import page_of as capability_page
from shipcosim.report.diagnosis.by_log import error_table
from shipcosim.report.diagnosis.track_figures import error_rows
from shipcosim.report.notebook.card import Card
from shipcosim.report.replay.page import replay_outcome
from shipcosim.report.sea_trials import words as sea_trials
from shipcosim.report.theme.views import Block, Fact, Outcome, Table

MOST_ROWS = 12


def comparison_card(found: Comparison, name: str) -> Card:
    """Which engines ran, and the signals that differ most."""
    others = [engine for engine in found.seconds if engine != OURS]
    head = ("signal", "unit", "range", *others, "half the step")
    rows = tuple(
        (
            one.name,
            one.unit,
            f"{one.range:.4g}",
            *(
                f"{one.engines[engine].largest:.1e}" if engine in one.engines else "–"
                for engine in others
            ),
            f"{one.step.largest:.1e}" if one.step else "not tried",
        )
        for one in found.signals[:MOST_ROWS]
    )
    said = tuple(f"{engine}: {why}" for engine, why in found.left_out.items())
    said += tuple(
        f"{engine}: {remark}" for engine, remarks in found.remarks.items() for remark in remarks
    )
    return Card(
        title=f"Engines on {name}",
        facts=tuple(Fact(engine, f"{seconds:.1f} s") for engine, seconds in found.seconds.items()),
        outcome=_agreement(found, others),
        blocks=(
            Block(
                f"Largest differences, {len(rows)} of {len(found.signals)} signals",
                Table(rows, head),
            ),
            Block("Remarks", lines=said),
        ),
    )


def _agreement(found: Comparison, others: list[str]) -> Outcome:
    """The verdict as the command says it."""
    if not others and not found.failed:
        return Outcome("plain", "ALONE", "No other engine ran: only the step-size error is known.")
    limit = f"{found.tolerance:g} of its range"
    count = len(found.signals)
    if found.agree:
        return Outcome(
            "passed",
            "AGREE",
            f"{', '.join([OURS, *others])} agree on each of {count} signals to {limit}.",
        )
    if found.failed:
        return Outcome("failed", "FAILED", f"{', '.join(found.failed)} did not get to the end.")
    differing = sum(one.worst > found.tolerance for one in found.signals)
    return Outcome(
        "failed", "DIFFER", f"{differing} of {count} signals differ by more than {limit}."
    )


def replay_card(found: LogReplay, name: str, draw: Callable[[], str]) -> Card:
    """Errors of the predictions and the track, which `draw` gives as SVG."""
    faults = tuple(
        f"{fault.label}: {fault.note}" if fault.note else fault.label for fault in found.faults
    )
    return Card(
        title=f"Replay of {name}",
        facts=(Fact("Predictions", f"{found.tracks.horizon:.0f} s each"),),
        outcome=replay_outcome(found),
        blocks=(
            Block("Errors, root mean square", error_rows(errors_of(found.tracks))),
            Block("Remarks", lines=(*faults, *found.remarks)),
        ),
        draw=draw,
    )


def calibration_card(found: CalibratedShip) -> Card:
    """Numbers that moved most, and the errors that remain."""
    moved = tuple(calibration.moved_rows(found)[:MOST_ROWS])
    return Card(
        title=f"Calibration of {found.reference.system}",
        facts=(Fact("Logs", ", ".join(log.name for log in found.logs)),),
        outcome=calibration.outcome(found),
        blocks=(
            Block("Why", lines=found.refusals),
            Block("Moved most", Table(moved, ("", "before", "calibrated", "by tolerances"))),
            Block("Errors by log", error_table(calibration.errors_by_log(found), "calibrated")),
            Block("Remarks", lines=found.remarks),
        ),
    )


def capability_card(found: Capability) -> Card:
    """The notation, and the numbers by direction."""
    page = capability_page(found)
    return Card(
        title=f"Static DP capability of {found.vessel.name}",
        facts=page.facts,
        outcome=page.outcome,
        blocks=(
            Block("Numbers by direction", page.numbers, folded=True),
            Block("Thrusters", page.thrusters),
        ),
    )


def sea_trials_card(found: SeaTrialStudy, name: str) -> Card:
    """Sets of causes, and how they predict the side that was not fitted."""
    return Card(
        title=f"Sea trials of {name}",
        facts=(Fact("Trials", f"{len(found.trials)}"),),
        outcome=sea_trials.outcome(found),
        blocks=(
            Block("Causes", sea_trials.sets_table(found)),
            Block("Judged on the other side", sea_trials.held_out_table(found)),
            Block("What to do next", lines=tuple(sea_trials.next_steps(found))),
        ),
    )
