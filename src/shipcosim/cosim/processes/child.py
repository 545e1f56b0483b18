"""The process of one component: `serve` makes its slave and answers requests until the pipe closes.

What the FMU prints must not get into the pipes, and comes out at once, so that it is not lost where the FMU crashes.
"""

import ctypes
import os
import pickle
import signal
import sys
from collections.abc import Callable, Sequence
from io import TextIOWrapper
from threading import Thread
from time import sleep
from typing import Any, BinaryIO, cast

import numpy as np

from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.slave import RunEnded, SlaveError, Variables
from shipcosim.ssp import Component

MARK = b"shipcosim"
"""Begin of each message between a run and the process of a component."""
DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux: a component that hangs does not outlive the run


class Garbled(Exception):
    """Raised for a damaged message from a pipe: an FMU has written into it."""


def send(pipe: BinaryIO, message: object) -> None:
    """Write a message into a pipe."""
    # Mark, length and content: a pipe has no boundaries between messages.
    data = pickle.dumps(message, protocol=5)
    pipe.write(MARK + len(data).to_bytes(8, "little") + data)
    pipe.flush()


def receive(pipe: BinaryIO) -> Any:
    """Read a message from a pipe. Raises EOFError if the other end is closed, Garbled if the message is damaged."""
    head = pipe.read(len(MARK) + 8)
    # Without the mark the length may be any number, and reading would not end.
    if not head.startswith(MARK[: len(head)]):
        raise Garbled
    size = int.from_bytes(head[len(MARK) :], "little")
    data = pipe.read(size)
    if len(head) < len(MARK) + 8 or len(data) < size:
        raise EOFError
    try:
        return pickle.loads(data)
    except Exception as error:
        raise Garbled from error


def serve() -> None:
    """Serve requests from stdin; answer on stdout (success, result, new log messages).

    The first answer, to no request, says that the process is there. What wants no answer and fails is the answer to
    the next request.
    """
    # Ctrl-C goes to the whole terminal, but only the run may decide to stop.
    source, target, flush = _own_pipes()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with Instances() as instances:
        handler = RequestHandler(instances)
        failure = None
        send(target, (True, None, []))
        while True:
            try:
                wants_answer, function, *arguments = receive(source)
            except EOFError:
                return
            # After a failure skip all requests until the run has heard of it.
            if failure is None:
                result, failure = _done(getattr(handler, function), arguments)
            # Printed text goes out before the answer, so that it appears in order.
            if wants_answer:
                flush()
                send(
                    target,
                    (
                        failure is None,
                        result if failure is None else failure,
                        handler.new_messages(),
                    ),
                )
                failure = None


def end_with_parent(parent: int | None = None) -> None:
    """Make this process end with its parent process, also if that is killed.

    Parameters
    ----------
    parent : int, optional
        Number of that process, where it may have ended already.
    """
    parent = os.getppid() if parent is None else parent
    # Linux does it itself. Elsewhere a thread looks whether the parent has changed.
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
    elif os.name == "posix":
        Thread(target=_wait_for_orphaning, args=(parent,), daemon=True).start()


def _wait_for_orphaning(parent):
    while os.getppid() == parent:
        sleep(1.0)
    os._exit(1)


def _done(method, arguments):
    """Result and error of a call; one of them is None. The error is a text, or RunEnded."""
    try:
        return method(*arguments), None
    except RunEnded:
        return None, RunEnded
    except SlaveError as error:
        return None, str(error)
    except Exception as error:
        return None, f"{type(error).__name__}: {error}"


class RequestHandler:
    """Requests that the process answers; see `remote_slave.RemoteSlave`.

    Parameters
    ----------
    instances : Instances
        Where the FMU's instance comes from.
    """

    def __init__(self, instances: Instances):
        self._instances = instances
        self._n_told = 0
        self._slave: Any = None
        self._prepared: list[tuple[Callable, Any]] = []

    def make(self, component: Component) -> None:
        """Instantiate the FMU."""
        self._slave = self._instances.instance_of(component)

    def call(self, method: str, *arguments: Any) -> Any:
        """Call a method of the slave."""
        return getattr(self._slave, method)(*arguments)

    def prepare(
        self, method: str, kind: str, variables: Variables, buffer: np.ndarray | None
    ) -> int:
        """Prepare a frequent call once; return its number."""
        arguments = () if buffer is None else (kind, variables, buffer)
        self._prepared.append((getattr(self._slave, method)(*arguments), buffer))
        return len(self._prepared) - 1

    def set(self, what: str, number: int, data: bytes) -> None:
        """Make a prepared call that sets values."""
        call, buffer = self._prepared[number]
        buffer[:] = np.frombuffer(data, buffer.dtype)
        self._slave.check(what, call())

    def get(self, number: int) -> tuple[int, bytes]:
        """Make a prepared call that gets values; its status and the values."""
        call, buffer = self._prepared[number]
        return call(), buffer.tobytes()

    def step(
        self, number: int, time: float, step_size: float, getters: Sequence[int]
    ) -> list[tuple[int, bytes]]:
        """Make a prepared step, then get the values that will be asked for next."""
        # The answer to the step brings the outputs along: one message per step instead of several.
        self._slave.check("DoStep", self._prepared[number][0](time, step_size))
        return [self.get(getter) for getter in getters]

    def new_messages(self) -> list[tuple[int, str]]:
        """Messages logged since the last time."""
        messages = self._slave.messages if self._slave else []
        first = self._n_told
        self._n_told = len(messages)
        return messages[first:]


def _own_pipes():
    """The pipes to the run, closed to all others here, and a function that flushes printed text."""
    # Keep the pipes under new numbers. Print of the FMU then goes to stderr, not between the
    # answers.
    source = os.fdopen(os.dup(0), "rb")
    target = os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    for stream in (cast(TextIOWrapper, sys.stdout), cast(TextIOWrapper, sys.stderr)):
        stream.reconfigure(line_buffering=True, errors="replace")
    if os.name != "posix":
        return source, target, sys.stdout.flush
    # C code has its own buffer for stdout, which Python does not flush.
    library = ctypes.CDLL(None)
    stdout = ctypes.c_void_p.in_dll(library, "stdout" if sys.platform == "linux" else "__stdoutp")

    def flush():
        sys.stdout.flush()
        library.fflush(stdout)

    return source, target, flush
