"""Evidence of the causes, their course, unmodelled errors, whiteness of innovations."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from shipcosim.diagnose.explanation.course import CourseFound
from shipcosim.diagnose.explanation.summary import LAGS, Evidence
from shipcosim.diagnose.inference.thresholds import ENOUGH, UNMODELLED
from shipcosim.report.diagnosis.estimates import shown_unit
from shipcosim.report.diagnosis.words import course_of, title, title_of
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import TIME, line, rounded, shade
from shipcosim.report.theme.numbers import finite, signed
from shipcosim.report.theme.views import Figure, Table

CHANNELS = ("north", "east", "heading", "surge", "sway", "yaw rate")
COLOURS = (palette.BLUE, palette.SKY, palette.PURPLE, palette.GREEN, palette.OLIVE, palette.ORANGE)
MOST_SETS = 12
WHITENESS = {"before": "Before: the plain model", "after": "After: with the causes"}
UNMODELLED_KINDS = {
    "slow": "a slow force in the ship's frame",
    "with the heading": "a force that turns with the heading",
    "from part to part": "the best cause's size, from part to part of the log",
    "beyond tolerances": "the ship's numbers, farther off than their tolerances say",
    "periodic": "a periodic force",
    "in a channel": "an error of a channel",
}


def evidence_table(evidence: Evidence) -> Table:
    """Gain in log-evidence of the best sets of causes over none, the best first."""
    rows = []
    for cause_set in evidence.sets[:MOST_SETS]:
        names = " + ".join(title(cause, component) for cause, component in cause_set.causes)
        rests = "the verdict rests on it" if cause_set.is_chosen else ""
        rows.append((names, signed(cause_set.gain), rests))
    return Table(rows, ("Set of causes", f"Nats, {ENOUGH:g} are clear", ""))


def course_figures(course: CourseFound) -> tuple[Figure, ...]:
    """The size of a cause over the log, each part by itself, and the course that was found."""
    finding = course.finding
    figures = []
    for size in course.sizes:
        unit, factor = (
            ("%", 100.0) if size.unit == "1" else shown_unit(size.unit, np.abs(size.size).max())
        )
        marks = line("each part of the log by itself", size.time, factor * size.size, palette.BLUE)
        marks |= {
            "mode": "markers",
            "error_y": {
                "type": "data",
                "array": rounded(2.0 * factor * size.std, 3),
                "thickness": 2,
            },
        }
        # The course is drawn from nothing to the size that all rows together give.
        neutral, full = course.neutral[size.parameter], finding.parameters[size.parameter].estimate
        time, share = course.drawn
        curve = factor * (neutral + (full - neutral) * share)
        figures.append(
            Figure(
                f"{title_of(finding)}: {size.parameter.replace('_', ' ')} over time",
                unit,
                (line(f"as found: {course_of(finding)}", time, curve, palette.VERMILLION), marks),
                {"xaxis": TIME},
                "Bars are two standard deviations. The line is what explains all rows together best.",
            )
        )
    return tuple(figures)


def unmodelled_table(unmodelled: Mapping[str, float]) -> Table:
    """Gain of errors that no cause describes, in addition to the chosen causes."""
    rows = []
    for kind, gain in unmodelled.items():
        # Above the threshold something unknown acts.
        acts = "it acts: the verdict is unknown" if gain > UNMODELLED else ""
        size = "none" if gain <= 0.0 else f"{gain:.1f}"
        rows.append((UNMODELLED_KINDS.get(kind, kind), size, acts))
    return Table(rows, ("Errors without a name", f"Nats, at most {UNMODELLED:g}", ""))


def whiteness_figures(evidence: Evidence) -> tuple[Figure, ...]:
    """Autocorrelation of the innovations before and after, on one scale."""
    # One scale for both, at least as wide as the band of white noise.
    every = np.stack(list(evidence.whiteness.values()))
    every = finite(every)
    between = (1.05 * float(every.min(initial=-0.19)), 1.05 * float(every.max(initial=0.19)))
    return tuple(
        _whiteness_figure(WHITENESS[name], values, evidence.step, evidence.rows, between)
        for name, values in evidence.whiteness.items()
    )


def _whiteness_figure(
    heading: str, correlation: NDArray, step: float, rows: int, between: tuple[float, float]
) -> Figure:
    """Autocorrelation of all channels over the lag, with the band of white noise."""
    # A curve for each channel that the log has.
    lag = step * np.arange(1, LAGS + 1)
    traces = [
        line(name, lag, correlation[:, i], COLOURS[i], mode="lines+markers", marker={"size": 4})
        for i, name in enumerate(CHANNELS)
        if np.isfinite(correlation[:, i]).any()
    ]
    # White noise of n rows stays within 2 / sqrt(n).
    width = 2 / np.sqrt(rows)
    shape = shade(palette.BAND, y=(-width, width))
    note = (
        "Autocorrelation of the whitened innovations; inside the band they are as white as noise."
    )
    layout = {"shapes": [shape], "xaxis": TIME, "yaxis": {"range": between}}
    return Figure(f"White? {heading}", "", tuple(traces), layout, note)
