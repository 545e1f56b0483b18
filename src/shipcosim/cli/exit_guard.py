"""Guard of the process: code of an FMU that ends it must not look like a run that went well.

C ends a process at once where it calls ``exit`` or ``_exit``, or crashes, and nothing of Python runs any more. Only
another process can tell, so the work of a command is done in a child.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux
_PASSED_ON = {signal.SIGINT, signal.SIGTERM} | (
    {signal.SIGHUP, signal.SIGQUIT} if os.name == "posix" else set()
)
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL", "SIGABRT")


def run_in_child(work: Callable[[], None]) -> None:
    """Do work that ends by itself; exit with 1 and a message where a library has ended the process.

    Parameters
    ----------
    work : callable
        It may raise SystemExit. On Linux it is done in a child process, in which this function returns; the process
        that called it exits as the child does.
    """
    if sys.platform != "linux":
        work()
        return
    reader, writer = os.pipe()
    parent = os.getpid()
    # Blocked before the child is there, so that none of its signals is missed.
    watched = {*_PASSED_ON, signal.SIGCHLD}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    child = os.fork()
    if child == 0:
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            work()
        finally:
            os.write(writer, b"done")
        return
    os.close(writer)
    status = _wait_for(child, watched)
    _exit_as(status, is_done=bool(_content(reader)))


def _wait_for(child: int, watched: set[signal.Signals]) -> int:
    """Status with which a child ends; signals that only this process was sent are passed on to it."""
    while True:
        sent = signal.sigwaitinfo(watched)
        if sent.si_signo != signal.SIGCHLD:
            # Ctrl-C of a terminal, which the kernel sends, reaches the child by itself.
            if sent.si_code <= 0:
                os.kill(child, sent.si_signo)
            continue
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status


def _content(reader: int) -> bytes:
    """What is in a pipe, which processes that are left may hold open."""
    os.set_blocking(reader, False)
    try:
        return os.read(reader, 8)
    except BlockingIOError:
        return b""


def _exit_as(status: int, is_done: bool) -> None:
    """End this process as the child has ended, or with 1 and a message where a library has ended it."""
    code = os.waitstatus_to_exitcode(status)
    name = signal.Signals(-code).name if code < 0 else ""
    if not is_done and (code >= 0 or name in _CRASHES):
        how = f"has crashed ({name})" if name else "has ended the process"
        sys.stderr.write(
            f"error: A program library, as a rule that of an FMU, {how}; there are no results.\n"
            "--isolate runs each FMU in a process of its own and keeps the rows so far.\n"
        )
        sys.exit(1)
    if name:
        # Shells see that a signal has ended the command.
        signal.signal(-code, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {-code})
        os.kill(os.getpid(), -code)
    sys.exit(code)
