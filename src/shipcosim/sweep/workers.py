"""Workers that run the chunks: local processes or a Dask cluster, by `concurrent.futures`."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Sequence
from concurrent.futures import (
    BrokenExecutor,
    CancelledError,
    Future,
)
from pathlib import Path
from time import monotonic
from typing import Any

from shipcosim.cosim.processes.pool import end_pool, new_pool, submitted
from shipcosim.errors import ShipcosimError, error_at, imported
from shipcosim.options import cores
from shipcosim.sweep.plan import Plan, PlannedRun
from shipcosim.sweep.work import Chunk, PackedJob, pack, run_chunk
from shipcosim.temporary import temporary_folder

PATIENCE = 20.0
"""Time that a scheduler may be without a worker, as while one is started anew. [s]"""


class Workers(ABC):
    """Workers that have a job and run chunks of it.

    Attributes
    ----------
    n : int
        How many run at a time.
    chunk_time : float
        How long a chunk should take. [s]
    ends : tuple of exception types
        Errors that mean that a worker has ended, not that the job is wrong.
    """

    n: int
    chunk_time: float
    ends: tuple[type[BaseException], ...]
    _executor: Any

    @abstractmethod
    def submit(self, runs: Sequence[PlannedRun]) -> Future[Chunk]:
        """Have some runs run."""

    @abstractmethod
    def check(self) -> None:
        """Raise ShipcosimError if no worker is left, and none has come for a while."""

    @abstractmethod
    def renew(self) -> None:
        """Replace workers that have ended."""

    @abstractmethod
    def close(self) -> None:
        """End without waiting for what still runs."""


class Processes(Workers):
    """Processes of this machine, which read the job from a file.

    Parameters
    ----------
    plan : Plan
    engine : str
    n : int, optional
        As many as there are cores where it is not given.
    """

    chunk_time = 2.0
    ends = (BrokenExecutor, CancelledError)

    def __init__(self, plan: Plan, engine: str, n: int | None = None):
        self.n = n or cores()
        self._folder = temporary_folder()
        self._job = Path(self._folder.name) / "job.pickle"
        self._job.write_bytes(pack(plan, engine, with_fmus=False).content)
        self._executor = new_pool(self._folder.name, self.n)

    def submit(self, runs: Sequence[PlannedRun]) -> Future[Chunk]:
        """See `Workers`."""
        return submitted(self._executor, run_chunk, str(self._job), runs)

    def check(self) -> None:
        """See `Workers`. A pool of processes says by itself that one has ended."""

    def renew(self) -> None:
        """See `Workers`."""
        end_pool(self._executor)
        self._executor = new_pool(self._folder.name, self.n)

    def close(self) -> None:
        """See `Workers`."""
        end_pool(self._executor)
        self._folder.cleanup()


class Cluster(Workers):
    """Workers of a Dask cluster; the job travels to them with its FMUs.

    Parameters
    ----------
    plan : Plan
    engine : str
    address : str
        Of the scheduler.

    Raises
    ------
    ShipcosimError
        If Dask is not installed, the scheduler does not answer, or it has no worker.
    """

    chunk_time = 5.0
    _alone_since: float | None = None
    """When it was found without a worker; None while it has some. [s]"""

    def __init__(self, plan: Plan, engine: str, address: str):
        with imported("--scheduler", "Dask is not installed.", "cluster"):
            from distributed import Client, KilledWorker  # pyright: ignore[reportMissingImports]
            from distributed.comm.core import CommClosedError  # pyright: ignore[reportMissingImports]
        self.ends = (KilledWorker, CommClosedError, CancelledError)
        # A cluster that ends is told in one sentence, not by tracebacks of the client's tasks.
        for name in ("distributed.client", "distributed.core", "distributed.utils"):
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._where = f"--scheduler {address}"
        try:
            self._client = Client(address, timeout=10, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise error_at(
                self._where,
                f"No scheduler of Dask answers: {str(error) or type(error).__name__}.",
                "Start one: dask scheduler, and on each machine dask worker ADDRESS --nthreads 1.",
            ) from None
        self.n = len(self._client.scheduler_info(n_workers=-1)["workers"])
        if not self.n:
            self._client.close()
            raise error_at(
                self._where, "It has no worker.", f"Start some: dask worker {address} --nthreads 1."
            )
        # The job goes to all workers once; each chunk then only refers to it.
        self._packed: PackedJob = pack(plan, engine, with_fmus=True)
        self._executor = self._client.get_executor(pure=False, retries=2)
        self.renew()

    def submit(self, runs: Sequence[PlannedRun]) -> Future[Chunk]:
        """See `Workers`."""
        self._alone_since = None
        return self._executor.submit(run_chunk, self._job, runs)

    def check(self) -> None:
        """See `Workers`. A scheduler without workers keeps what is to be done, and would wait for ever."""
        now = monotonic()
        if self._client.scheduler_info(n_workers=-1)["workers"]:
            self._alone_since = None
        elif self._alone_since is None:
            self._alone_since = now
        elif now > self._alone_since + PATIENCE:
            raise self._gone(f"it has had no worker for {PATIENCE:g} s")

    def renew(self) -> None:
        """Send the job to the workers that there are now."""
        try:
            self._job: Any = self._client.scatter(self._packed, broadcast=True, hash=False)
        except OSError as error:
            raise self._gone(str(error)) from None

    def _gone(self, why: str) -> ShipcosimError:
        return error_at(
            self._where,
            f"The cluster answers no more: {why}.",
            "Start it again, then the same command, which goes on.",
        )

    def close(self) -> None:
        """See `Workers`."""
        self._executor.shutdown(wait=False)
        self._client.close()
