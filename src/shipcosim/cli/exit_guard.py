"""Guard of the process: code of an FMU that ends it must not look like a run that went well.

C ends a process at once where it calls ``exit`` or ``_exit``, or crashes, and nothing of Python runs any more. Only
another process can tell, so the work of a command is done in a child.
"""

import ctypes
import mmap
import os
import signal
import sys
import time
from collections.abc import Callable

_DIE_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux
_WATCHED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGCHLD")
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
    is_done = mmap.mmap(-1, 1)  # shared with the child
    parent = os.getpid()
    # Blocked before the child is there, so that none of its signals is missed.
    watched = {getattr(signal, name) for name in _WATCHED}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    child = os.fork()
    if child == 0:
        ctypes.CDLL(None).prctl(_DIE_WITH_PARENT, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, _interrupt_once())
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            work()
        finally:
            is_done[0] = 1
        return
    status = _wait_for(child, watched)
    _exit_as(status, bool(is_done[0]))


def _interrupt_once() -> Callable[..., None]:
    """Handler of SIGINT: sent to a whole group it comes twice, and the second must not end the clearing up."""
    last = -_SAME_INTERRUPT

    def interrupt(*_: object) -> None:
        nonlocal last
        if time.monotonic() - last > _SAME_INTERRUPT:
            last = time.monotonic()
            raise KeyboardInterrupt

    return interrupt


_SAME_INTERRUPT = 1.0  # s within which another SIGINT is the same one, passed on. Assumed.


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


def _exit_as(status: int, is_done: bool) -> None:
    """End this process as the child has ended, or with 1 and a message where a library has ended it."""
    code = os.waitstatus_to_exitcode(status)
    name = signal.Signals(-code).name if code < 0 else ""
    if not is_done and (code >= 0 or name in _CRASHES):
        how = f"has crashed ({name})" if name else "has ended the process"
        sys.stderr.write(
            f"error: A program library, usually that of an FMU, {how}. There are no results.\n"
            "--isolate runs each FMU in a process of its own and keeps the rows so far.\n"
        )
        sys.exit(1)
    sys.exit(code if code >= 0 else 128 - code)  # as shells write the end by a signal
