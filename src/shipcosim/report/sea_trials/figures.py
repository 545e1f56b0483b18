"""Figures of sea trials: tracks of turning circles, errors of features."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from shipcosim.diagnose.sea_trials.features import FEATURES
from shipcosim.diagnose.sea_trials.study import SeaTrialStudy
from shipcosim.diagnose.sea_trials.windows import SeaTrial
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import line, rounded
from shipcosim.report.theme.views import Figure

_ALIKE = 5.0  # deg: of circles with steering as near as this, one is drawn
_SHORT = {"turning circle": "circle", "zig-zag": "zig-zag", "straight run": "straight"}
_ROW = 30  # px


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


def error_figure(study: SeaTrialStudy) -> Figure:
    """Root mean square errors of the features by kind of trial, before and after, beside how well they repeat."""
    evidence = study.evidence
    spread = np.sqrt(np.diag(evidence.noise))
    errors = {"as modelled": evidence.predicted - evidence.measured}
    if study.best.hypotheses:
        errors["with the causes"] = study.after - evidence.measured
    kinds = dict.fromkeys(trial.kind for trial in study.trials)
    places = {
        f"{_SHORT[kind]}: {name}": rows
        for kind in kinds
        for name, rows in places_of(study.trials, kind).items()
    }
    names = [f"{name} [0.01 rad]" if name.endswith("drift") else name for name in places][::-1]

    def sizes(off):
        return rounded(
            [100.0 * np.sqrt(np.mean(np.square(off[rows]))) for rows in places.values()], 3
        )[::-1]

    traces = []
    for (name, off), colour in zip(errors.items(), (palette.ORANGE, palette.BLUE), strict=False):
        drawn = {"type": "bar", "orientation": "h", "name": name, "x": sizes(off), "y": names}
        traces.append(drawn | {"marker": {"color": colour}, "hovertemplate": "%{x:.3~g} %"})
    repeats = {
        "type": "scatter",
        "mode": "markers",
        "name": "how well trials repeat",
        "x": sizes(spread),
        "y": names,
    }
    look = {"color": palette.INK, "symbol": "line-ns-open", "size": 12}
    traces.append(repeats | {"marker": look, "hovertemplate": "%{x:.3~g} %"})
    layout = {
        "barmode": "group",
        "hovermode": "y unified",
        "xaxis": {"title": {"text": "%"}},
        "yaxis": {"automargin": True, "dtick": 1, "tickfont": {"size": 11}},
        "legend": {"orientation": "h", "x": 0.5, "xanchor": "center", "y": -0.1},
    }
    note = "Root mean square over all trials of the kind. Upright strokes: standard deviation with which trials repeat."
    return Figure("Errors of the features", "%", traces, layout, note, 110 + _ROW * len(names))


def places_of(trials: Sequence[SeaTrial], kind: str) -> dict[str, list[int]]:
    """By feature of a kind, its places among the features of all trials."""
    places: dict[str, list[int]] = {name: [] for name in FEATURES[kind]}
    at = 0
    for trial in trials:
        for name in FEATURES[trial.kind]:
            if trial.kind == kind:
                places[name].append(at)
            at += 1
    return places
