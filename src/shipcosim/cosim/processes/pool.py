"""Processes of this machine that run functions by `concurrent.futures`."""

import os
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from types import ModuleType
from typing import Any

from shipcosim.cosim.processes.child import end_with_parent
from shipcosim.options import cores


def new_pool(folder: str, n: int | None = None) -> ProcessPoolExecutor:
    """Processes that end with this one.

    Parameters
    ----------
    folder : str
        For what they leave, as they are ended by a signal and remove nothing.
    n : int, optional
        How many; as many as there are cores where it is not given.
    """
    begin = partial(_begin, os.getpid(), folder)
    return ProcessPoolExecutor(n or cores(), mp_context=get_context("spawn"), initializer=begin)


def submitted(pool: ProcessPoolExecutor, function: Callable, *arguments: Any) -> Future:
    """Have a process call a function of a module."""
    with _without_main_module():
        return pool.submit(function, *arguments)


def end_pool(pool: ProcessPoolExecutor) -> None:
    """End all processes without waiting for what still runs."""
    # Processes in a crashed or hanging run would not end by themselves.
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        process.terminate()
    for process in processes:
        process.join()


def _begin(parent: int, folder: str) -> None:
    """Prepare a worker: it ends with its parent, no Ctrl-C, and one thread for numerical libraries."""
    end_with_parent(parent)
    tempfile.tempdir = folder
    os.environ["TMPDIR"] = folder
    # All cores have a process each; more threads would only compete.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    from threadpoolctl import threadpool_limits

    threadpool_limits(1)


@contextmanager
def _without_main_module() -> Iterator[None]:
    """Keep new processes from importing the calling script, which would start its work again."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
