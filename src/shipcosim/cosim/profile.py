"""Where the time of a run goes: seconds by component and phase."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

PHASES = ("load", "start", "step", "exchange", "record")
"""Reading and instantiating FMUs; initialisation; their steps; values between them; rows of the table."""
MASTER = "master"
"""Stands for what belongs to no component."""


class Profile:
    """Seconds of a run, by component and phase. Phases in one another count once, as the inner one."""

    def __init__(self):
        self._seconds: dict[tuple[str, str], float] = {}
        self._inner = 0.0

    @contextmanager
    def during(self, component: str, phase: str) -> Iterator[None]:
        """Count the time of a block."""
        began = perf_counter()
        outer, self._inner = self._inner, 0.0
        try:
            yield
        finally:
            passed = perf_counter() - began
            self.add(component, phase, passed - self._inner)
            self._inner = outer + passed

    def timed(self, component: str, phase: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """A function whose time counts."""

        def counted(*arguments):
            with self.during(component, phase):
                return call(*arguments)

        return counted

    def add(self, component: str, phase: str, seconds: float) -> None:
        """Count some time. [s]"""
        key = component, phase
        self._seconds[key] = self._seconds.get(key, 0.0) + seconds

    def as_json(self) -> str:
        """Component, phase and seconds of each, as the attribute `profile` of a table."""
        return json.dumps([[*key, round(spent, 6)] for key, spent in self._seconds.items()])


def rows_of(profile: str) -> list[tuple[str, list[float]]]:
    """Seconds of each component in each of `PHASES`, the longest first.

    Parameters
    ----------
    profile : str
        The attribute of a table.
    """
    by_component: dict[str, list[float]] = {}
    for component, phase, seconds in json.loads(profile):
        by_component.setdefault(component, [0.0] * len(PHASES))[PHASES.index(phase)] += seconds
    return sorted(by_component.items(), key=lambda row: -sum(row[1]))
