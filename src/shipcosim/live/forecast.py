"""What comes of a loss: a system runs on from its present state in a process of its own, and the run itself goes on."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Future
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, Self

from shipcosim.cosim.interactive import row_signals
from shipcosim.cosim.master.algorithm import Ended, Failure, Master
from shipcosim.cosim.master.run import Simulation
from shipcosim.cosim.master.time_grid import TimeGrid
from shipcosim.cosim.processes.pool import end_pool, new_pool, submitted
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.live.simulation import (
    Change,
    SystemState,
    apply_changes,
    endless_grid,
    endless_simulation,
    instances_of,
    restore,
)
from shipcosim.scenario import Scenario
from shipcosim.ssp import System
from shipcosim.temporary import temporary_folder

NICENESS = 10
"""The run itself goes first where cores are few."""


@dataclass(frozen=True)
class Question:
    """What a forecast is asked: from a state before a step on, each future with its changes, which signals are watched."""

    step: int
    state: SystemState
    steps: int
    futures: Sequence[Sequence[Change]]
    watched: Sequence[str]


class Forecaster:
    """Answers questions about the futures of a system, within a ``with`` statement.

    Parameters
    ----------
    system : System
        With all start values.
    scenario : Scenario
        Checked.
    """

    def __init__(self, system: System, scenario: Scenario):
        self._given = system, scenario

    def __enter__(self) -> Self:
        self._folder = temporary_folder()
        self._pool = new_pool(self._folder.name, 1)
        self._ready: Future[None] | None = None
        self._is_open = True
        return self

    def __exit__(self, *_: object) -> None:
        self._is_open = False
        end_pool(self._pool)
        self._folder.cleanup()

    def ask(self, question: Question, answer: Callable[[dict[str, Any]], object]) -> None:
        """Have a question answered; `answer` is called in another thread, unless all ends before."""

        def pass_on(result: Future[dict[str, Any]]) -> None:
            if self._is_open:
                error = ready.exception() or result.exception()
                answer({"error": str(error)} if error else result.result())

        try:
            # The process starts with the first question.
            ready = self._ready = self._ready or submitted(self._pool, _prepare, *self._given)
            submitted(self._pool, _answer, question).add_done_callback(pass_on)
        except BrokenExecutor as error:
            answer({"error": str(error)})


_prepared: list[tuple[Simulation, Master, TimeGrid]] = []
"""The system of this process."""


def _prepare(system: System, scenario: Scenario) -> None:
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    grid = endless_grid(scenario)
    simulation = endless_simulation(system, scenario, grid)
    master = simulation.begin(instances_of(system).__enter__(), lambda: None)
    _prepared.append((simulation, master, grid))


def _answer(question: Question) -> dict[str, Any]:
    """Of each future, rows of the watched signals, and the error that ended it early."""
    began = perf_counter()
    answers = [_future(question, changes) for changes in question.futures]
    milliseconds = 1e3 * (perf_counter() - began)
    return {"step": question.step, "answers": answers, "milliseconds": milliseconds}


def _future(question: Question, changes: Sequence[Change]) -> dict[str, Any]:
    simulation, master, grid = _prepared[0]
    part = replace(grid, first=question.step, last=question.step + question.steps)

    def between(k: int) -> tuple[int, int]:
        if k == part.first:
            restore(simulation, master, question.state)
        apply_changes(simulation, k, [change for change in changes if change[0] == k])
        return k, min([change[0] for change in changes if change[0] > k], default=part.last)

    simulation.recorders.n_rows = 0
    error = ""
    try:
        master.run(part, {}, (), simulation.recorders, None, between)
    except (Failure, Ended, SlaveError) as reason:
        error = str(reason)
    signals = row_signals(simulation.plan, "Real")
    columns = [signals.index(name) for name in question.watched]
    rows = simulation.recorders.by_kind["Real"].rows[: simulation.recorders.n_rows, columns]
    return {"rows": rows.tolist(), "error": error}
