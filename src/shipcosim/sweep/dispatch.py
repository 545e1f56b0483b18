"""Dispatch runs to workers in adaptive chunks; crashed workers are replaced."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator
from concurrent.futures import ALL_COMPLETED, FIRST_COMPLETED, CancelledError, Future, wait
from itertools import islice

from shipcosim.errors import error_at
from shipcosim.sweep.plan import Plan
from shipcosim.sweep.work import Chunk, Row
from shipcosim.sweep.workers import Workers

AHEAD = 2
"""Chunks that each worker has or waits for."""
MOST_RUNS = 1000
"""Of a chunk."""
CHECKED = 5.0
"""Time without an answer after which it is asked whether there are workers left. [s]"""
ENDS = 2
"""Worker crashes of a single run before the run counts as failed."""
ENDED = "Its worker process ended, more than once: the run crashes it, or needs more memory than there is."


class Dispatch:
    """Runs handed to workers in chunks.

    Parameters
    ----------
    plan : Plan
    numbers : iterator of int
        Of the runs.
    workers : Workers
        Who runs them.
    """

    def __init__(self, plan: Plan, numbers: Iterator[int], workers: Workers):
        self._plan = plan
        self._numbers = numbers
        self._workers = workers
        self._in_flight: dict[
            Future[Chunk], tuple[list[int], bool]
        ] = {}  # numbers, whether they run alone
        self._suspects: deque[list[int]] = deque()
        self._ends: Counter[int] = Counter()
        self._size = 1
        self._n_done = 0

    # Wait for any chunk, hand out its rows, and fill up again: workers never wait for each other.
    def rows(self) -> Iterator[list[Row]]:
        """Rows of finished runs, in any order.

        Raises
        ------
        ShipcosimError
            If workers end whatever they do, or something is wrong with all runs.
        """
        while self._fill():
            done = self._waited(FIRST_COMPLETED)
            # A pool breaks as a whole: if one process ends, all chunks under way are lost too.
            if any(self._is_lost(future) for future in done):
                done = self._waited(ALL_COMPLETED)
            lost = []
            for future in done:
                numbers, was_alone = self._in_flight.pop(future)
                if self._is_lost(future):
                    lost.append((numbers, was_alone))
                else:
                    yield self._taken(future.result())
            if lost:
                yield self._ended(lost)

    def _waited(self, until: str) -> set[Future[Chunk]]:
        """Chunks that are done, once the first or all are; raises ShipcosimError if no worker is left to do them."""
        while True:
            done, waiting = wait(self._in_flight, timeout=CHECKED, return_when=until)
            if done and (until == FIRST_COMPLETED or not waiting):
                return done
            self._workers.check()

    def _is_lost(self, future: Future[Chunk]) -> bool:
        error = CancelledError() if future.cancelled() else future.exception()
        return isinstance(error, self._workers.ends)

    def _fill(self) -> bool:
        """Give work to the workers; true if anything is under way. Suspects run alone."""
        # After a crash nothing else runs beside a suspect, so the next crash is surely its own.
        if self._suspects:
            if not self._in_flight:
                self._submit(self._suspects.popleft(), alone=True)
            return True
        # Each worker has a chunk in reserve, so that it does not wait for this process.
        while len(self._in_flight) < AHEAD * self._workers.n:
            chunk = list(islice(self._numbers, self._size))
            if not chunk:
                break
            self._submit(chunk)
        return bool(self._in_flight)

    def _submit(self, numbers: list[int], alone: bool = False) -> None:
        runs = [self._plan.run(number) for number in numbers]
        try:
            future = self._workers.submit(runs)
        # The future carries the error, so that a lost chunk is treated the same way everywhere.
        except Exception as error:  # a worker may have ended since its last answer
            if not isinstance(error, self._workers.ends):
                raise
            future = Future()
            future.set_exception(error)
        self._in_flight[future] = numbers, alone

    def _taken(self, chunk: Chunk) -> list[Row]:
        """Take the rows of a chunk; its duration decides the size of the next ones."""
        self._n_done += len(chunk.rows)
        if self._n_done > self._workers.n:  # the first run of each worker loads and compiles
            fitting = int(self._workers.chunk_time * len(chunk.rows) / max(chunk.seconds, 1e-6))
            # Aim at a fixed time per chunk. It grows by at most a factor of two, as the first runs
            # may be short by chance.
            self._size = min(max(fitting, 1), 2 * self._size, MOST_RUNS)
        return chunk.rows

    def _ended(self, lost: list[tuple[list[int], bool]]) -> list[Row]:
        """Rows of runs that crash their workers again and again; the others are run again."""
        # New workers first. Each lost chunk becomes a suspect and runs alone.
        self._workers.renew()
        failed = []
        for numbers, was_alone in lost:
            # A chunk that crashed alone is halved: bisection finds the run that crashes.
            if len(numbers) > 1:
                half = len(numbers) // 2 if was_alone else len(numbers)
                self._suspects.extend(part for part in (numbers[:half], numbers[half:]) if part)
                continue
            # A crash counts only if the run was alone.
            self._ends[numbers[0]] += was_alone
            if self._ends[numbers[0]] < ENDS:
                self._suspects.append(numbers)
            else:
                failed.append(Row(numbers[0], error=ENDED))
        # Nothing has worked and several runs crash: something is wrong with all of them.
        if not self._n_done and len(failed) and self._ends.total() >= 3 * ENDS:
            raise error_at(
                "workers",
                "Each worker process ends in its first run.",
                "Run the scenario alone to see why: shipcosim run SCENARIO --engine native.",
            )
        return failed
