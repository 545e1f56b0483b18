"""The course of a cause over time: when it begins, grows and ends, and what a log says of its size in each part."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipcosim.diagnose.finding import Candidate, Finding, Segment
from shipcosim.diagnose.inference.fitting import Fit

STEP = "step"
RAMP = "ramp"
SPELL = "spell"
SWITCHING = "switching"
KINDS = (STEP, RAMP, SPELL)
"""Courses that are tried first; several spells are switching."""


@dataclass(frozen=True)
class Course:
    """Size of a cause over time: 0 before its start.

    Attributes
    ----------
    kind : str
        ``"step"``: then 1. ``"ramp"``: rises to 1 at the end. ``"spell"``: 1 until the end, then 0; ``"switching"``:
        several spells.
    spells : tuple of (float, float)
        From when to when it is there, in order; of a step and a ramp until the end of the log. [s]
    """

    kind: str
    spells: tuple[Segment, ...]

    @property
    def start(self) -> float:
        """When it begins. [s]"""
        return self.spells[0][0]

    def moved(self, by: float, end: float) -> list[Course]:
        """The course with one of its edges moved by some time [s], each in turn; one at the end of the log stays."""
        edges = np.ravel(self.spells)
        moved = (edges + by * (np.arange(edges.size) == i) for i in np.flatnonzero(edges < end))
        return [
            replace(self, spells=tuple((float(a), float(b)) for a, b in times.reshape(-1, 2)))
            for times in moved
            if np.all(np.diff(times) > 0.0)
        ]

    def at(self, time: np.ndarray) -> np.ndarray:
        """Share of the size at some times, (n,) array."""
        if self.kind == RAMP:
            ((start, end),) = self.spells
            return np.clip((time - start) / (end - start), 0.0, 1.0)
        return np.any([(time >= start) & (time < end) for start, end in self.spells], axis=0) * 1.0


@dataclass(frozen=True)
class SizeOverTime:
    """The size of a parameter over the log, a part by itself each, in `unit`; (m,) arrays.

    Attributes
    ----------
    parameter, unit : str
    time : array
        Middle of each part. [s]
    size, std : array
    """

    parameter: str
    unit: str
    time: np.ndarray
    size: np.ndarray
    std: np.ndarray


@dataclass(frozen=True)
class CourseFound:
    """A cause with a course that explains a log better than any that is the same all along.

    Attributes
    ----------
    finding : Finding
        With its onset and course.
    gain : float
        Log-evidence over the best set of causes that stay the same. [nats]
    rivals : tuple of Candidate
        Other causes with a course that the log cannot tell from it.
    sizes : tuple of SizeOverTime
    neutral : dict of str to float
        By parameter: what it is without the cause, in the unit of the finding.
    drawn : tuple of two arrays
        Times [s], and the share of the size at each.
    steady : tuple of Fit
        Sets of steady causes of the whole log, best first.
    unmodelled : dict of str to float
        Gain of unmodelled errors beside it, by kind, over the whole log. [nats]
    """

    finding: Finding
    gain: float
    rivals: tuple[Candidate, ...]
    sizes: tuple[SizeOverTime, ...]
    neutral: dict[str, float]
    drawn: tuple[np.ndarray, np.ndarray]
    steady: tuple[Fit, ...]
    unmodelled: dict[str, float]
