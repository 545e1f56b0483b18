"""Options of a run: which engine runs it, from when to when, what feeds its inputs, in which processes.

What happens in the run (steps, start values, events) is the scenario's; how it is carried out is set here.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from numbers import Real
from sys import float_info
from typing import TYPE_CHECKING, TypedDict

from shipcosim.errors import error_at

if TYPE_CHECKING:
    import xarray

    from shipcosim.snapshot import Snapshot

TIMEOUT = 60.0
"""How long a component in its own process may take for an answer, if nothing else is given. [s]"""


CountProgress = Callable[[int, int], None]
"""Is called with how many are done, and of how many."""


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True, kw_only=True, eq=False)
class RunOptions:
    """How a run is carried out.

    Parameters
    ----------
    engine : str
        What runs the FMUs: ``"fmpy"`` (our own co-simulation master), ``"native"`` (the same, with models and loop
        compiled), ``"auto"`` (native where a run is long and can be compiled, else fmpy), ``"libcosim"`` or
        ``"ecos"``. The last two know neither `start_time` nor `until`, `resume`, `store`, `isolate`, `realtime` and
        `profile`.
    inputs : Dataset, optional
        Feeds inputs of the system, by their names. A variable's attribute ``interpolation`` says what it does between
        its rows: ``"held"``, the default, or ``"linear"``, angles the shorter way round. The table's attribute
        ``max_gap`` is the longest time between two rows that is not taken for lost data. [s]
    progress : callable, optional
        Called with (steps done, steps in all) some ten times a second.
    order : str, optional
        Order of the data exchange in place of the scenario's. ``"jacobi"``: every component steps with what the others
        had put out at the start of the step, as in libcosim. ``"gauss-seidel"``: with what those before it have just
        put out.
    start_time : float
        Time at the start, which the FMUs are told and the scenario's times are on. A run that continues has that of
        the run before. [s]
    until : float, optional
        Where the run ends, if not at the scenario's stop time. [s]
    resume : Snapshot or path, optional
        Where the run continues from: the scenario may have other events and another stop time from there on, and what
        was overridden then stays so. What happens before that time in the scenario is not done again.
    store : callable or path, optional
        Gets the snapshot of the whole system at the end of the run.
    isolate : bool
        Whether each component runs in a process of its own: one that crashes or hangs then ends the run like one that
        fails.
    timeout : float
        How long an isolated component may take for an answer. [s]
    realtime : float, optional
        Seconds of the run that pass in a second of the clock; as fast as the machine allows without.
    profile : bool
        Whether the seconds of each component and phase are counted, in the table's attribute ``profile``.

    Raises
    ------
    ShipcosimError
        If the timeout of isolated components or the pace is no positive number.
    """

    engine: str = "auto"
    inputs: xarray.Dataset | None = None
    progress: CountProgress | None = None
    order: str | None = None
    start_time: float = 0.0
    until: float | None = None
    resume: Snapshot | str | os.PathLike[str] | None = None
    store: Callable[[Snapshot], object] | str | os.PathLike[str] | None = None
    isolate: bool = False
    timeout: float = TIMEOUT
    realtime: float | None = None
    profile: bool = False

    def __post_init__(self):
        pace = self.realtime
        if pace is not None and not (isinstance(pace, Real) and 0.0 < pace <= float_info.max):
            raise error_at(
                "realtime",
                f"{pace!r:.60} is no pace.",
                "Give a positive number: 1.0 is as fast as the clock.",
            )
        if self.isolate and not 0.0 < self.timeout < float("inf"):
            raise error_at(
                "timeout", f"{self.timeout:g} s is no time limit.", "Give a positive number."
            )

    def changed(self, names: tuple[str, ...]) -> list[str]:
        """Names among these whose value is not the default."""
        return [name for name in names if getattr(self, name) != getattr(RunOptions, name)]


class RunKeywords(TypedDict, total=False):
    """`RunOptions` as keyword arguments, except for `start_time`, whose default `shipcosim.simulate` finds itself.

    Times may be amounts: ``until="10 min"``.
    """

    engine: str
    inputs: xarray.Dataset | None
    progress: CountProgress | None
    order: str | None
    until: float | str | None
    resume: Snapshot | str | os.PathLike[str] | None
    store: Callable[[Snapshot], object] | str | os.PathLike[str] | None
    isolate: bool
    timeout: float | str
    realtime: float | None
    profile: bool
