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
from typing import Any

from shipcosim.cosim.processes.pool import end_pool, new_pool, submitted
from shipcosim.errors import error_at, imported
from shipcosim.options import cores
from shipcosim.sweep.plan import Plan, PlannedRun
from shipcosim.sweep.work import Chunk, PackedJob, pack, run_chunk
from shipcosim.temporary import temporary_folder


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
            remedy = (
                "Start one: dask scheduler, and on each machine dask worker ADDRESS --nthreads 1."
            )
            message = f"No scheduler of Dask answers: {str(error) or type(error).__name__}."
            raise error_at(self._where, message, remedy) from None
        self.n = len(self._client.scheduler_info(n_workers=-1)["workers"])
        if not self.n:
            self._client.close()
            message = "It has no worker."
            remedy = f"Start some: dask worker {address} --nthreads 1."
            raise error_at(self._where, message, remedy)
        # The job goes to all workers once; each chunk then only refers to it.
        self._packed: PackedJob = pack(plan, engine, with_fmus=True)
        self._executor = self._client.get_executor(pure=False, retries=2)
        self.renew()

    def submit(self, runs: Sequence[PlannedRun]) -> Future[Chunk]:
        """See `Workers`."""
        return self._executor.submit(run_chunk, self._job, runs)

    def renew(self) -> None:
        """Send the job to the workers that there are now."""
        try:
            self._job: Any = self._client.scatter(self._packed, broadcast=True, hash=False)
        except OSError as error:
            message = f"The cluster answers no more: {error}."
            remedy = "Start it again, then the same command, which goes on."
            raise error_at(self._where, message, remedy) from None

    def close(self) -> None:
        """See `Workers`."""
        self._executor.shutdown(wait=False)
        self._client.close()
