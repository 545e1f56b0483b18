"""Moments of a run to go to: missed expectations first, then the events of the scenario."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shipcosim.report.run.expectations import Judged
from shipcosim.scenario import Scenario, Verdict


class Moment(NamedTuple):
    """A time of the run [s], what is to be seen there, and whether an expectation is missed."""

    time: float
    text: str
    missed: bool = False


def find_moments(
    verdicts: Sequence[Verdict], judged: Sequence[Judged], scenario: Scenario | None
) -> Sequence[Moment]:
    """What a reader looks at first.

    Parameters
    ----------
    verdicts : sequence of Verdict
        What was judged.
    judged : sequence of Judged
        The same as texts, in the same order.
    scenario : Scenario, optional
        What happened.

    Returns
    -------
    sequence of Moment
        Missed expectations, then events by time.
    """
    # A missed expectation is seen where it is missed by most. One without a row has no such time.
    missed = [
        Moment(verdict.time, f"{row.expected}: {row.worst} at {row.time}", True)
        for verdict, row in zip(verdicts, judged, strict=True)
        if not verdict.passed and np.isfinite(verdict.time)
    ]
    # Events of the same time are one moment.
    changed: dict[float, list[str]] = {}
    for event in scenario.events if scenario else ():
        changed.setdefault(event.time, []).extend(signal for _, signal, _ in event.changes)
    events = [
        Moment(time, f"{time:g} s: {', '.join(dict.fromkeys(signals))}")
        for time, signals in sorted(changed.items())
    ]
    return (*missed, *events)
