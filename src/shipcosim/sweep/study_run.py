"""A study from plan to tables: run what is not on disk, then summarise."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.errors import error_at
from shipcosim.series import write_file
from shipcosim.sweep.dispatch import Dispatch
from shipcosim.sweep.indices import has_indices, indices_of
from shipcosim.sweep.plan import Plan
from shipcosim.sweep.storage import Store, check_installed
from shipcosim.sweep.summary import summarised
from shipcosim.sweep.tuning import Search
from shipcosim.sweep.workers import Cluster, Processes, Workers

if TYPE_CHECKING:
    import pandas

ENGINES = ("native", "fmpy")
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Swept:
    """The results of a study after its runs.

    Parameters
    ----------
    plan : Plan
    folder : Path
        Of the results.
    about : dict
        What study.json holds.
    runs, summary : DataFrame
        A row a run that is done; a row for each combination of the factors that remain.
    tables : dict of str to DataFrame
        Others, by name: ``indices`` of samples of Saltelli's design, ``trials`` of a search.
    """

    plan: Plan
    folder: Path
    about: dict
    runs: pandas.DataFrame
    summary: pandas.DataFrame
    tables: dict[str, pandas.DataFrame]


def run_study(
    plan: Plan,
    folder: Path,
    *,
    engine: str = "native",
    scheduler: str | None = None,
    workers: int | None = None,
    at_most: int | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> Swept:
    """Run the part of a study that is not done yet.

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
    force : bool
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
        raise error_at("engine", f"engine = {engine!r}.", "Studies are run by 'native' or 'fmpy'.")
    if scheduler is not None and workers is not None:
        message = f"workers = {workers}, but the scheduler has workers of its own."
        raise error_at("workers (--workers)", message, "Leave one of them out.")
    # The store knows which runs are done, also from an interrupted study.
    store = Store(folder, plan, engine, force)
    search = Search(plan) if plan.study.tune else None
    _run(
        plan,
        _parts(plan, store, search),
        store,
        lambda: (
            Processes(plan, engine, workers)
            if scheduler is None
            else Cluster(plan, engine, scheduler)
        ),
        at_most,
        progress,
    )
    store.finish()
    # Tables follow from the stored runs alone, so they can be made again without running.
    runs = store.runs()
    summary = summarised(plan, runs)
    tables, remarks = _further(plan, runs, search)
    remarks = [*not_reached(plan), *remarks]
    if store.lost:
        message = f"{folder}: a table is missing or damaged; the {store.lost} runs that only it held are to be made again."
        remarks.insert(0, message)
    for name, table in {"summary": summary, **tables}.items():
        write_file(folder / f"{name}.csv", table.to_csv(index=False).encode())
    about = store.write_about(tables=list(tables), remarks=remarks)
    return Swept(plan, folder, about, runs, summary, tables)


def _further(
    plan: Plan, runs: pandas.DataFrame, search: Search | None
) -> tuple[dict[str, pandas.DataFrame], list[str]]:
    """Tables in addition to the summary, and remarks on them."""
    if search is not None:
        return {"trials": search.table(runs)}, []
    if not has_indices(plan):
        return {}, []
    indices, remarks = indices_of(plan, runs)
    return {"indices": indices}, remarks


def not_reached(plan: Plan) -> list[str]:
    """Remarks on expectations that are not judged because runs end earlier."""
    remarks = [remark for measure in plan.measures for remark in measure.remarks]
    # Measures need no more than the longest run has: where all are as long there is nothing to say.
    if any(level.stop_time is not None for levels in plan.levels for level in levels):
        ends = [plan.scenario_of(plan.run(number)).stop_time for number in range(len(plan))]
        for measure in plan.measures:
            if short := sum(not measure.is_reached_at(end) for end in ends):
                message = f"{short} of {len(ends)} runs end before {measure.needs:g} s"
                remarks.append(f"{measure.name}: {message} and have no value.")
    return remarks


def _parts(plan: Plan, store: Store, search: Search | None) -> Iterator[np.ndarray]:
    """Numbers of the runs to do, in parts that each depend on the one before."""
    if search is None:
        yield np.flatnonzero(~store.done)
        return
    # In a search each generation depends on the results of the last. Replay the finished ones from
    # disk.
    every = np.arange(len(plan)).reshape(plan.shape)
    for trials in search.generations():
        numbers = every[..., trials.start : trials.stop].ravel()
        yield numbers[~store.done[numbers]]
        # Without all results of a generation the next one cannot be proposed.
        if not store.done[numbers].all():
            return
        search.tell(store.rows())


def _run(
    plan: Plan,
    parts: Iterable[np.ndarray],
    store: Store,
    make: Callable[[], Workers],
    at_most: int | None,
    progress: Progress | None,
) -> None:
    workers = None
    room = at_most
    try:
        # `at_most` limits the runs of this call. Workers start only if there is something to do.
        for numbers in parts:
            now = numbers[:room]
            room = None if room is None else room - len(now)
            if not len(now):
                continue
            workers = workers or make()
            for rows in Dispatch(plan, map(int, now), workers).rows():
                store.add(rows)
                if progress is not None:
                    progress(int(store.done.sum()), len(plan))
    # Also after an interrupt: what is done is written.
    finally:
        if workers is not None:
            workers.close()
        store.flush()
