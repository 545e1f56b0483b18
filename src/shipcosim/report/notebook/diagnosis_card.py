"""The cards of diagnoses of one log and of several, and the log beside predictions of it as a picture."""

from __future__ import annotations

import numpy as np

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.report.diagnosis.by_log import error_table, log_table
from shipcosim.report.diagnosis.key_figures import key_figures
from shipcosim.report.diagnosis.testability import VISIBLE, visible_rows
from shipcosim.report.diagnosis.track_figures import joined
from shipcosim.report.diagnosis.words import (
    discrepancy_rows,
    facts_of,
    finding_rows,
    next_steps,
    outcome,
    title,
    title_of,
)
from shipcosim.report.notebook.card import Block, Card
from shipcosim.report.notebook.figures import Path, track_svg
from shipcosim.report.theme import palette
from shipcosim.report.theme.views import Table

COLOURS = (palette.ORANGE, palette.BLUE, palette.GREEN)


def diagnosis_card(found: Diagnosis) -> Card:
    """Verdict, findings with their sizes, errors before and after, what to do next.

    Of several logs also the errors in each, and what each says by itself.
    """
    name = f"Diagnosis of {found.name}"
    several = isinstance(found, JointDiagnosis)
    which = "These logs" if several else "This log"
    alike = tuple((title_of(c), f"{100 * c.probability:.0f} %") for c in found.indistinguishable)
    silent = tuple(title(cause) for cause in found.not_testable)
    steps = next_steps(found)
    if found.extended is not None:
        steps = [*steps, "Simulate the system with the cause in it: `.extended`."]
    return Card(
        title=name,
        facts=facts_of(found),
        outcome=outcome(found),
        blocks=(
            Block("Wrong, largest first", Table(discrepancy_rows(found))),
            Block(
                "Found", Table(list(finding_rows(found.findings)), ("", "probability", "", "size"))
            ),
            Block(f"{which} cannot tell apart", Table(alike)),
            Block(
                "Errors",
                Table(tuple((figure.value, figure.meaning) for figure in key_figures(found))),
            ),
            Block("Errors by log", error_table(found.errors) if several else Table(())),
            Block("Each log by itself", log_table(found)),
            Block("Remarks", lines=found.notes),
            Block("What to do next", lines=tuple(steps)),
            Block(f"{which} could not have shown", lines=silent, folded=True),
            Block(VISIBLE, Table(visible_rows(found.smallest_visible)), folded=True),
        ),
        draw=None if (tracks := found.tracks) is None else lambda: tracks_svg(tracks, name),
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
