"""The cards of comparisons of engines, replays, calibrations and sea trials."""

from __future__ import annotations

import math
from collections.abc import Callable

from shipcosim.capability import Capability
from shipcosim.cosim.compare import OURS, Comparison, Difference
from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.replays import LogReplay
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.report.calibration import words as calibration
from shipcosim.report.capability.page import page_of as capability_page
from shipcosim.report.diagnosis.track_figures import error_rows
from shipcosim.report.notebook.card import Card
from shipcosim.report.replay.page import remarks_of, replay_outcome
from shipcosim.report.sea_trials import words as sea_trials
from shipcosim.report.theme.views import Block, Fact, Outcome, Table

MOST_ROWS = 12


def comparison_card(comparison: Comparison, name: str) -> Card:
    """Which engines ran, and the signals that differ most."""
    others = [engine for engine in comparison.seconds if engine != OURS]
    table = comparison_table(comparison)
    rows = table.rows[:MOST_ROWS]
    lines = [f"{engine}: {why}" for engine, why in comparison.left_out.items()]
    lines += [
        f"{engine}: {remark}"
        for engine, remarks in comparison.remarks.items()
        for remark in remarks
    ]
    return Card(
        title=f"Engines on {name}",
        facts=[Fact(engine, f"{seconds:.1f} s") for engine, seconds in comparison.seconds.items()],
        outcome=_agreement(comparison, others),
        blocks=(
            Block(
                f"Largest differences, {len(rows)} of {len(comparison.signals)} signals",
                Table(rows, table.head),
            ),
            Block("Remarks", lines=lines),
        ),
    )


def comparison_table(comparison: Comparison) -> Table:
    """A row a signal: where engines differ most, which of them agree, and by how much each differs from ours."""
    others = [engine for engine in comparison.seconds if engine != OURS]
    rows = []
    for signal in comparison.signals:
        absent = Difference(math.nan, math.nan, math.nan)
        differences = [signal.engines.get(engine, absent) for engine in others]
        cells = [signal.name, signal.unit, "", ""]
        if differences:
            worst = max(
                differences, key=lambda d: math.inf if math.isnan(d.relative) else d.relative
            )
            cells[2] = f"{worst.relative:.1e}"
            cells[3] = f"{worst.time:.6g}" if worst.largest else ""
        groups = " | ".join(" = ".join(group) for group in signal.agreeing)
        cells.append("all" if len(signal.agreeing) == 1 else groups)
        cells += [f"{difference.largest:.1e}" for difference in differences]
        step = signal.step
        cells += [f"{step.largest:.1e}", f"{step.relative:.1e}"] if step else ["not tried", ""]
        rows.append((*cells, f"{signal.range:.4g}"))
    # What decides stands first: columns that do not fit on a terminal are left out at the end.
    head = ("signal", "unit", "of range", "at t [s]", "agree", *others)
    return Table(rows, (*head, "half the step", "of range", "range"))


def _agreement(comparison: Comparison, others: list[str]) -> Outcome:
    """The verdict in the words of the command."""
    if not others and not comparison.failed:
        return Outcome("plain", "ALONE", "No other engine ran: only the step-size error is known.")
    limit = f"{comparison.tolerance:g} of its range"
    count = len(comparison.signals)
    if comparison.agree:
        return Outcome(
            "passed",
            "AGREE",
            f"{', '.join([OURS, *others])} agree on each of {count} signals to {limit}.",
        )
    if comparison.failed:
        return Outcome(
            "failed", "FAILED", f"{', '.join(comparison.failed)} did not get to the end."
        )
    differing = sum(signal.worst > comparison.tolerance for signal in comparison.signals)
    return Outcome(
        "failed", "DIFFER", f"{differing} of {count} signals differ by more than {limit}."
    )


def replay_card(replay: LogReplay, name: str, draw: Callable[[], str]) -> Card:
    """Errors of the predictions and the track, which `draw` gives as SVG."""
    return Card(
        title=f"Replay of {name}",
        facts=(Fact("Predictions", f"{replay.tracks.horizon:.0f} s each"),),
        outcome=replay_outcome(replay),
        blocks=(
            Block("Errors, root mean square", error_rows(errors_of(replay.tracks))),
            Block("Remarks", lines=remarks_of(replay)),
        ),
        draw=draw,
    )


def calibration_card(ship: CalibratedShip) -> Card:
    """Numbers that moved most, and the errors that remain."""
    return Card(
        title=f"Calibration of {ship.reference.system}",
        facts=(Fact("Logs", ", ".join(log.name for log in ship.logs)),),
        outcome=calibration.outcome(ship),
        blocks=calibration.blocks(ship),
    )


def capability_card(capability: Capability) -> Card:
    """The notation, and the numbers by direction."""
    page = capability_page(capability)
    return Card(
        title=f"Static DP capability of {capability.vessel.name}",
        facts=page.facts,
        outcome=page.outcome,
        blocks=(
            Block("Numbers by direction", page.numbers, folded=True),
            Block("Thrusters", page.thrusters),
        ),
    )


def sea_trials_card(study: SeaTrialStudy, name: str) -> Card:
    """Sets of causes, and how they predict the side that was not fitted."""
    return Card(
        title=f"Sea trials of {name}",
        facts=(Fact("Trials", sea_trials.trials(study)),),
        outcome=sea_trials.outcome(study),
        blocks=sea_trials.blocks(study),
    )
