"""What a million runs on a hundred workers cost: `PYTHONPATH=.venv/cluster python tests/bench/cluster`.

The dispatch of a study, as it is, on a clock of its own: workers are simulated, so are their times. What the one
process that dispatches spends on a run, on a row and on a task of Dask is measured first.
"""

from __future__ import annotations

import argparse
import io
import pickle
import time
from concurrent.futures import Future
from heapq import heappop, heappush
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import shipcosim.sweep.dispatch as running
from shipcosim.sweep import plan_of, read_study
from shipcosim.sweep.storage import Store
from shipcosim.sweep.work import Chunk, Row
from shipcosim.sweep.workers import Cluster, Workers

STUDY = """
scenario = "stationkeeping"

[[factor]]
name   = "wind"
signal = "environment.wind_speed"
from   = 4.0
to     = 12.0
count  = 100

[[factor]]
name  = "seed"
seeds = 10000

[[quantity]]
name   = "farthest"
signal = ["vessel.x", "vessel.y"]
near   = [0.0, 0.0]
reduce = "maximum"
"""
SAMPLE = 5000


class Costs(NamedTuple):
    """Seconds that one process spends: on a run that it sends, on a row that it gets, at the end, on a task."""

    sent: float
    row: float
    end: float
    task: float


class SimulatedCluster(Workers):
    """Workers whose chunks take what they are said to take, on a clock of their own.

    Parameters
    ----------
    n : int
    run : float
        Time of a run. [s]
    first : float
        Of the first run of a worker, which loads and compiles. [s]
    costs : Costs
    """

    chunk_time = Cluster.chunk_time

    def __init__(self, n: int, run: float, first: float, costs: Costs):
        self.n, self._run, self._costs = n, run, costs
        self.now, self.busy_here, self.busy_there, self.tasks = 0.0, 0.0, 0.0, 0
        self._free = [
            (0.0, first) for _ in range(n)
        ]  # when each worker is free, what it needs before it begins
        self._ends: list[tuple[float, int, Future]] = []

    def submit(self, runs):
        """See `Workers`."""
        self._spend(self._costs.sent * len(runs) + self._costs.task)
        free, before = heappop(self._free)
        taken = before + self._run * len(runs)
        end = max(self.now, free) + taken
        self.busy_there += taken
        self.tasks += 1
        heappush(self._free, (end, 0.0))
        future: Future = Future()
        future.set_result(Chunk([Row(run.number) for run in runs], taken))
        heappush(self._ends, (end, self.tasks, future))
        return future

    def wait(self, futures, timeout=None, return_when=None):
        """In place of `concurrent.futures.wait`: the clock goes on until a chunk is done."""
        self.now = max(self.now, self._ends[0][0])
        done = set()
        while self._ends and self._ends[0][0] <= self.now:
            done.add(heappop(self._ends)[2])
        self._spend(sum(len(future.result().rows) for future in done) * self._costs.row)
        return done, set(futures) - done

    def _spend(self, seconds: float) -> None:
        self.now += seconds
        self.busy_here += seconds

    def check(self):
        """See `Workers`."""

    def renew(self):
        """See `Workers`."""

    def close(self):
        """See `Workers`."""

    def is_lost(self, error):
        """See `Workers`."""
        return False


def measured(plan, folder: Path) -> Costs:
    """What this process spends, in CPU time, with a sample of the plan's runs."""
    start = time.process_time()
    runs = [plan.run(number) for number in range(SAMPLE)]
    io.BytesIO().write(pickle.dumps(runs, protocol=5))
    sent = (time.process_time() - start) / SAMPLE
    store = Store(folder, plan, "native")
    rows = [Row(number, {"farthest": 1.0}) for number in range(SAMPLE)]
    content = pickle.dumps(rows, protocol=5)
    start = time.process_time()
    store.add(pickle.loads(content))
    store.flush()
    row = (time.process_time() - start) / SAMPLE
    start = time.process_time()
    store.finish()
    return Costs(sent, row, (time.process_time() - start) / SAMPLE, of_a_task())


def of_a_task(tasks: int = 500) -> float:
    """CPU time of Dask's client and scheduler on a task that does nothing. [s]"""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        Client(cluster) as client,
    ):
        client.gather(client.map(abs, range(20), pure=False))
        start = time.process_time()
        for one in [client.submit(abs, number, pure=False) for number in range(tasks)]:
            one.result()
        return (time.process_time() - start) / tasks


def main() -> None:
    """Print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--workers", type=int, nargs="+", default=[100, 1000])
    arguments.add_argument("--run-times", type=float, nargs="+", default=[0.03, 0.1, 0.3, 1.0])
    arguments.add_argument(
        "--first", type=float, default=15.0, help="first run of a worker: it loads and compiles [s]"
    )
    given = arguments.parse_args()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "million.toml"
        path.write_text(STUDY)
        start = time.process_time()
        plan = plan_of(read_study(path))
        planned = time.process_time() - start
        costs = measured(plan, Path(folder) / "out")
    print(
        f"{len(plan)} runs, laid out in {planned:.1f} s. Here: {1e6 * costs.sent:.0f} us a run sent, ",
        end="",
    )
    print(
        f"{1e6 * costs.row:.0f} us a row, {1e6 * costs.end:.0f} us a row at the end, {1e3 * costs.task:.1f} ms a task\n"
    )
    print(
        "| workers | a run takes | whole study | workers busy | dispatching busy | tasks | then the table |"
    )
    print("|---|---|---|---|---|---|---|")
    for n in given.workers:
        for run in given.run_times:
            simulated = SimulatedCluster(n, run, given.first, costs)
            running.wait = simulated.wait
            done = sum(
                len(rows)
                for rows in running.Dispatch(plan, iter(range(len(plan))), simulated).rows()
            )
            assert done == len(plan)
            shares = [
                simulated.busy_there / (n * simulated.now),
                simulated.busy_here / simulated.now,
            ]
            shown = " | ".join(f"{100 * share:.0f} %" for share in shares)
            end = costs.end * len(plan)
            print(
                f"| {n} | {run:g} s | {simulated.now / 60:.1f} min | {shown} | {simulated.tasks} | {end:.0f} s |"
            )


if __name__ == "__main__":
    main()
