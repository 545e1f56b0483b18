"""The cards of diagnoses of one log and of several, and the log beside predictions of it as a picture."""

from __future__ import annotations

import numpy as np

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.report.diagnosis.key_figures import key_figures
from shipcosim.report.diagnosis.testability import VISIBLE, visible_rows
from shipcosim.report.diagnosis.track_figures import joined
from shipcosim.report.diagnosis.words import (
    discrepancy_rows,
    finding_rows,
    next_steps,
    outcome,
    title,
    title_of,
)
from shipcosim.report.joint import words as joint
from shipcosim.report.notebook.card import Block, Card
from shipcosim.report.notebook.figures import Path, track_svg
from shipcosim.report.theme import palette
from shipcosim.report.theme.views import Fact, Table, known_facts

COLOURS = (palette.ORANGE, palette.BLUE, palette.GREEN)


def diagnosis_card(found: Diagnosis, name: str) -> Card:
    """Verdict, findings with their sizes, errors before and after, what to do next.

    Parameters
    ----------
    found : Diagnosis
    name : str
        Its title.
    """
    alike = tuple((title_of(c), f"{100 * c.probability:.0f} %") for c in found.indistinguishable)
    silent = tuple(title(cause) for cause in found.not_testable)
    steps = next_steps(found, None, found.causes)
    if found.extended is not None:
        steps = [*steps, "Simulate the system with the cause in it: `.extended`."]
    return Card(
        title=name,
        facts=_facts(found),
        outcome=outcome(found, found.causes),
        blocks=(
            Block("Wrong, largest first", Table(discrepancy_rows(found))),
            Block(
                "Found", Table(list(finding_rows(found.findings)), ("", "probability", "", "size"))
            ),
            Block("This log cannot tell apart", Table(alike)),
            Block(
                "Errors",
                Table(tuple((figure.value, figure.meaning) for figure in key_figures(found))),
            ),
            Block("Remarks", lines=found.notes),
            Block("What to do next", lines=tuple(steps)),
            Block("This log could not have shown", lines=silent, folded=True),
            Block(VISIBLE, Table(visible_rows(found.smallest_visible)), folded=True),
        ),
        draw=None if (tracks := found.tracks) is None else lambda: tracks_svg(tracks, name),
    )


def _facts(found: Diagnosis) -> tuple[Fact, ...]:
    facts = [("System", found.system.name if found.system else "")]
    if found.log is not None:
        time = found.log.measured["time"].values
        facts.append(("Log", f"{(time[-1] - time[0]) / 60:.0f} min, {time.size} rows"))
    return known_facts(facts)


def joint_card(found: JointDiagnosis, name: str) -> Card:
    """What several logs say together, and each by itself.

    Parameters
    ----------
    found : JointDiagnosis
    name : str
        Its title.
    """
    head = ("log", "after", "position", "with causes", "heading", "with causes", "")
    return Card(
        title=name,
        facts=(
            Fact("System", found.system.name if found.system else "–"),
            Fact("Logs", ", ".join(found.logs)),
        ),
        outcome=joint.outcome(found),
        blocks=(
            Block("Wrong, largest first", Table(joint.discrepancy_rows(found))),
            Block("Faults of the data in common", Table(joint.fault_rows(found))),
            Block("Causes in common", Table(joint.cause_rows(found))),
            Block("Errors by log", Table(joint.error_rows(found), head)),
            Block("Each log by itself", Table(tuple(row[:4] for row in joint.log_rows(found)))),
            Block("Remarks", lines=tuple(found.remarks)),
            Block("What to do next", lines=tuple(joint.next_steps(found))),
        ),
    )


def tracks_svg(tracks: Tracks, name: str) -> str:
    """A log and predictions of it on one chart, as SVG."""
    seen = tracks.measured
    paths = [Path("measured", seen["north"].values, seen["east"].values, colour=palette.FAINT)]
    for (label, one), colour in zip(tracks.predicted.items(), COLOURS, strict=False):
        north, east = (np.asarray(joined(one, role)) for role in ("north", "east"))
        paths.append(
            Path(f"{label}, every {tracks.horizon:.0f} s anew", north, east, colour=colour)
        )
    return track_svg(paths, name)
