"""The process of a component as the run sees it: start, requests, watchdog, end."""

import os
import signal
import subprocess
import sys
from collections import deque
from contextlib import suppress
from threading import Thread
from time import monotonic
from typing import Any, BinaryIO, cast

from shipcosim.cosim.processes.child import Garbled, receive, send
from shipcosim.cosim.slaves.slave import ProcessEnded, RunEnded, SlaveError
from shipcosim.errors import printable

START = (
    "import sys; sys.path[:] = {path!r}; from shipcosim.cosim.processes.child import serve; serve()"
)
START_TIMEOUT = 60.0
"""Time limit for a process to start. [s]"""
EXIT_TIMEOUT = 5.0
"""Time limit for a process to end. [s]"""
MOST_LINES = 1000
LAST_LINES = 3
"""Lines that a component prints and that are shown at most, and of them those that an error repeats."""
MOST_BYTES = 4096
"""Longest line of a component that is shown. [bytes]"""


class ComponentProcess:
    """The process of a component, from this side.

    Parameters
    ----------
    name : str
        Name of the component.
    folder : str
        For its temporary files; others remove it.
    timeout : float
        How long it may take for an answer. [s]
    """

    def __init__(self, name: str, folder: str, timeout: float):
        self.messages: list[tuple[int, str]] = []
        self._name = name
        self._timeout = timeout
        self._was_late = False
        self._deadline: float | None = None
        self._last: deque[str] = deque(maxlen=LAST_LINES)
        # TMPDIR: files that the FMU leaves behind are removed with the folder after the run.
        self._process = subprocess.Popen(
            [sys.executable, "-c", START.format(path=sys.path)],
            env=os.environ | {"TMPDIR": folder, "TEMP": folder, "TMP": folder},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the run alone; what it starts can be ended with it
        )
        self._requests = cast(BinaryIO, self._process.stdin)
        self._answers = cast(BinaryIO, self._process.stdout)
        # A thread reads the printed text at once; a full pipe would block the component.
        self._reader = Thread(target=self._print_output, daemon=True)
        self._reader.start()

    def wait_for_start(self) -> None:
        """Wait until the process answers. Raises SlaveError if it does not."""
        self._within("its start", START_TIMEOUT, receive, self._answers)

    def request(self, what: str, function: str, *arguments: Any) -> Any:
        """Send a request and return the answer.

        Parameters
        ----------
        what : str
            What to call it where no answer comes.
        function : str
            Method of `child.RequestHandler`.
        *arguments
            Its arguments.

        Raises
        ------
        SlaveError
            If the FMU fails in this or an earlier request, or no answer comes.
        """
        self.send_request(what, function, *arguments)
        return self.receive_answer()

    def send_request(self, what: str, function: str, *arguments: Any) -> None:
        """Send a request; `receive_answer` must follow. Other processes can work meanwhile."""
        self._requested = what
        self._within(what, self._timeout, send, self._requests, (True, function, *arguments))

    def receive_answer(self) -> Any:
        """Answer to the request that was sent."""
        went_well, result, messages = self._within(
            self._requested, self._timeout, receive, self._answers
        )
        self.messages += messages
        if not went_well:
            raise RunEnded if result is RunEnded else SlaveError(result)
        return result

    def notify(self, what: str, *arguments: Any) -> None:
        """Send a request to set values, without an answer; an error comes with the next answer."""
        self._within(what, self._timeout, send, self._requests, (False, "set", *arguments))

    def _within(self, what, limit, action, *arguments: Any):
        # The watchdog compares this deadline with the clock, and ends the process if it is late.
        self._deadline = monotonic() + limit
        try:
            return action(*arguments)
        # A broken pipe means that the process has ended: find out why.
        except (OSError, EOFError):
            raise ProcessEnded(self._cause_of_end(what, limit)) from None
        # Where an answer begins and ends is lost: as after a crash, the process is useless.
        except Garbled:
            self._kill()
            raise SlaveError(
                f"Its process gave no answer to {what} but other bytes: the FMU writes into files "
                "that it did not open. It was ended."
            ) from None
        # After an interrupt the answer would belong to an old request: end the process.
        except BaseException:
            self._kill()
            raise
        finally:
            self._deadline = None

    def kill_if_late(self) -> None:
        """End the process if its answer is late, and its children if it has ended."""
        deadline = self._deadline
        if deadline is None:
            return
        if self._process.poll() is not None:
            self._kill()
        elif monotonic() > deadline:
            self._was_late = True
            self._kill()

    def close_input(self) -> None:
        """Ask the process to end."""
        with suppress(OSError):
            self._requests.close()

    def end(self, limit: float) -> None:
        """Wait for the end of the process until a monotonic time; then end it."""
        try:
            self._process.wait(max(0.0, limit - monotonic()))
        except subprocess.TimeoutExpired:
            pass
        # What the FMU has started and left behind ends as well.
        self._kill()
        self._process.wait()
        self._reader.join(1.0)
        self._answers.close()

    def _kill(self):
        """End the process and its children, which may hold the pipes open."""
        if os.name != "posix":
            self._process.kill()
            return
        # The process leads a session of its own, so its group contains all that it started.
        with suppress(OSError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def _cause_of_end(self, what, limit):
        """Describe how the process ended."""
        # It may still be on its way to the end: give it time before the exit code is read.
        try:
            code = self._process.wait(EXIT_TIMEOUT)
        except subprocess.TimeoutExpired:
            self._kill()
            code = self._process.wait()
        self._reader.join(1.0)
        # The last printed lines often name the cause.
        message = f" It printed last:\n{''.join(self._last).rstrip()}" if self._last else ""
        if self._was_late:
            return (
                f"Its process gave no answer to {what} within {limit:g} s and was ended.{message}"
            )
        if code < 0:
            return f"Its process was ended in {what} by signal {-code}, {signal.strsignal(-code)}.{message}"
        return f"Its process ended itself in {what}, with exit code {code if code < 256 else hex(code)}.{message}"

    def _print_output(self):
        """Pass printed text on to stderr, with the component's name."""
        pipe = cast(BinaryIO, self._process.stderr)
        n = 0
        # Limit the length of a line and their number: a component may print without end.
        while line := pipe.readline(MOST_BYTES):
            text = printable(line.decode("utf-8", errors="replace").rstrip()) + "\n"
            n = n + 1
            self._last.append(text)
            if n <= MOST_LINES:
                print(f"[{self._name}] {text}", end="", file=sys.stderr, flush=True)
            elif n == MOST_LINES + 1:
                print(
                    f"[{self._name}] prints more than {MOST_LINES} lines; no more are shown",
                    file=sys.stderr,
                    flush=True,
                )
        pipe.close()
