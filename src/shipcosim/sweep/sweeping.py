"""A study from beginning to end: planned, run as far as it is not on disk, summed up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.series import write_file
from shipcosim.sweep.plan import Plan
from shipcosim.sweep.running import rows_of
from shipcosim.sweep.storage import Store, check_installed
from shipcosim.sweep.summary import summarised
from shipcosim.sweep.workers import Cluster, Processes, Workers

if TYPE_CHECKING:
    import pandas

ENGINES = ("native", "fmpy")
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Swept:
    """What there is of a study after its runs.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Of the results.
    about : dict
        What study.json holds.
    runs, summary : DataFrame
        A row a run that is done; a row for each combination of the factors that remain.
    """

    plan: Plan
    folder: Path
    about: dict
    runs: pandas.DataFrame
    summary: pandas.DataFrame


def run_study(
    plan: Plan,
    folder: Path,
    *,
    engine: str = "native",
    scheduler: str | None = None,
    workers: int | None = None,
    at_most: int | None = None,
    progress: Progress | None = None,
    force: bool | None = None,
    again: bool = False,
) -> Swept:
    """Run what is not done of a study.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Of the results.
    engine : str
        ``"native"`` or ``"fmpy"``.
    scheduler : str, optional
        Address of a scheduler of Dask; processes of this machine without.
    workers : int, optional
        Processes of this machine; one a core where it is not given.
    at_most : int, optional
        Runs that are done now.
    progress : callable, optional
        Called with (runs done, runs in all).
    force, again : bool
        As of `Store`.

    Raises
    ------
    ShipcosimError
        If results cannot be written or workers cannot work; what is done stays.
    KeyboardInterrupt
        What is done stays.
    """
    check_installed()
    if engine not in ENGINES:
        raise ShipcosimError(Problem("engine", f"engine = {engine!r}.", "Studies are run by 'native' or 'fmpy'."))
    store = Store(folder, plan, engine, force, again)
    left = store.missing() if at_most is None else islice(store.missing(), at_most)
    if not store.done.all() and at_most != 0:
        _run(plan, left, store, lambda: _workers(plan, engine, scheduler, workers), progress)
    store.finish()
    runs = store.runs()
    summary = summarised(plan, runs)
    write_file(folder / "summary.csv", summary.to_csv(index=False).encode())
    return Swept(plan, folder, store.about(), runs, summary)


def _run(plan, numbers, store: Store, make: Callable[[], Workers], progress: Progress | None) -> None:
    workers = make()
    try:
        for rows in rows_of(plan, numbers, workers):
            store.add(rows)
            if progress is not None:
                progress(int(store.done.sum()), len(plan))
    finally:
        workers.close()
        store.flush()


def _workers(plan: Plan, engine: str, scheduler: str | None, n: int | None) -> Workers:
    return Processes(plan, engine, n) if scheduler is None else Cluster(plan, engine, scheduler)
