"""The cards of diagnoses of one log and of several, and the log beside predictions of it as a picture."""

from __future__ import annotations

import numpy as np

from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.validation.tracks import Tracks
from shipcosim.report.diagnosis.summary import summary
from shipcosim.report.diagnosis.track_figures import joined
from shipcosim.report.diagnosis.words import facts_of, next_steps, outcome
from shipcosim.report.notebook.card import Card
from shipcosim.report.notebook.figures import Path, track_svg
from shipcosim.report.theme import palette
from shipcosim.report.theme.views import Block

COLOURS = (palette.ORANGE, palette.BLUE, palette.GREEN)


def diagnosis_card(diagnosis: Diagnosis) -> Card:
    """Verdict, summary, what to do next, and the track."""
    name = f"Diagnosis of {diagnosis.name}"
    steps = next_steps(diagnosis)
    if diagnosis.extended is not None:
        steps = [*steps, "Simulate the system with the cause in it: `.extended`."]
    return Card(
        title=name,
        facts=facts_of(diagnosis),
        outcome=outcome(diagnosis),
        blocks=(*summary(diagnosis), Block("What to do next", lines=steps)),
        draw=None if (tracks := diagnosis.tracks) is None else lambda: tracks_svg(tracks, name),
    )


def tracks_svg(tracks: Tracks, name: str) -> str:
    """A log and predictions of it on one chart, as SVG."""
    seen = tracks.measured
    paths = [Path("measured", seen["north"].values, seen["east"].values, colour=palette.FAINT)]
    for (label, prediction), colour in zip(tracks.predicted.items(), COLOURS, strict=False):
        north, east = (np.asarray(joined(prediction, role)) for role in ("north", "east"))
        paths.append(
            Path(f"{label}, every {tracks.horizon:.0f} s anew", north, east, colour=colour)
        )
    return track_svg(paths, name)
