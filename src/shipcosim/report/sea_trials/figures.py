"""Tracks of sea trials on one chart."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import line
from shipcosim.report.theme.views import Figure

_ALIKE = 5.0  # deg: of circles with steering as near as this, one is drawn


def track_figure(study: SeaTrialStudy, before: list[NDArray], after: list[NDArray]) -> Figure:
    """Turning circles on one chart, as measured, as modelled and with the causes; the first course points up."""
    traces = []
    for i in _chosen(study.trials):
        trial = study.trials[i]
        looks = [("measured", trial.measured, palette.MEASURED, 4.0)]
        looks += [("as modelled", before[i], palette.ORANGE, 1.3)]
        if study.best.hypotheses:
            looks += [("with the causes", after[i], palette.BLUE, 1.3)]
        for name, motion, colour, width in looks:
            across, ahead = _turned(motion)
            # True if a trace of that name is among them.
            is_drawn = any(trace["name"] == name for trace in traces)
            drawn = line(
                name, across, ahead, colour, width=width, legendgroup=name, showlegend=not is_drawn
            )
            hint = f"{_steering(trial):.0f}° at {trial.logged[0]:.0f} s: {name}"
            traces.append(drawn | {"hovertemplate": hint, "named": False})
    layout = {
        "xaxis": {"title": {"text": "to starboard"}},
        "yaxis": {"title": {"text": "ahead"}, "scaleanchor": "x"},
        "hovermode": "closest",
    }
    note = "From where the order was given. The measured circles drift with the current; the model sails in still water."
    return Figure("Turning circles", "m", traces, layout, note, height=520)


def _chosen(trials: Sequence[SeaTrial]) -> list[int]:
    """One circle by side and steering."""
    circles: dict[tuple[int, int], int] = {}
    for i, trial in enumerate(trials):
        if trial.kind == "turning circle":
            circles.setdefault((trial.side, round(_steering(trial) / _ALIKE)), i)
    return list(circles.values())


def _steering(trial: SeaTrial) -> float:
    """Angle of the helm. [deg]"""
    return float(np.degrees(np.arcsin(min(trial.steering, 1.0))))


def _turned(motion: NDArray) -> tuple[NDArray, NDArray]:
    """A track with its first course up: to starboard and ahead. [m]"""
    course = motion[0, 2] + np.arctan2(motion[0, 4], motion[0, 3])
    north = motion[:, 0] - motion[0, 0]
    east = motion[:, 1] - motion[0, 1]
    c = np.cos(course)
    s = np.sin(course)
    return c * east - s * north, c * north + s * east
