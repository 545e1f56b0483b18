"""Ctrl-C while FMUs run."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def delayed_interrupt() -> Iterator[Callable[[], None]]:
    """Hold Ctrl-C back until the callable that this yields is called, which then raises KeyboardInterrupt.

    Raised at any moment it would end up in the Python code of an FMU, whose host reports it as an error of the FMU. A
    second Ctrl-C is not held back: for an FMU that never returns.
    """
    # Ctrl-C is only noted here; the run asks for it where it can stop cleanly.
    noted = []

    def check():
        if noted:
            raise KeyboardInterrupt

    def note(number, frame):
        check()
        noted.append(number)

    # Only the main thread can receive signals.
    if threading.current_thread() is not threading.main_thread():
        yield check
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)
