"""Components in processes of their own: one that crashes, hangs or prints takes nothing of the run with it.

The process of a component does what a `Slave` does here, on the same bytes, so results are the same to the last digit.
"""

import os
import pickle
import signal
import subprocess
import sys
import tempfile
from collections import deque
from contextlib import ExitStack, suppress
from threading import Event, Thread
from time import monotonic

import numpy as np

from shipcosim.cosim.processes.child import receive, send
from shipcosim.cosim.slaves.slave import OK, Slave, SlaveError

START = "import sys; sys.path[:] = {path!r}; from shipcosim.cosim.processes.child import serve; serve()"
GREETING = 60.0  # s, for a process to start
FAREWELL = 5.0  # s, for a process that has nothing more to do
SHOWN = 1000  # lines that a component may print
LONGEST = 4096  # bytes of a line
LAST_LINES = 3


class Isolated:
    """Instances of a system's FMUs, each in a process that is started beforehand; see `Instances`.

    Parameters
    ----------
    system : System
        Whose components get a process.
    timeout : float
        How long a component may take for an answer. [s]
    """

    def __init__(self, system, timeout):
        self._names, self._timeout = list(system.components), timeout

    def __enter__(self):
        self._workers, self._over, self._stack = {}, Event(), ExitStack()
        with self._stack:  # undoes all where a process cannot be started
            folder = tempfile.TemporaryDirectory(prefix="shipcosim-", ignore_cleanup_errors=True)
            folder = self._stack.enter_context(folder)
            self._stack.callback(self._end)
            for name in self._names:
                self._workers[name] = Worker(name, folder, self._timeout)
            self._watchdog = Thread(target=self._watch, daemon=True)
            self._watchdog.start()
            self._stack = self._stack.pop_all()
        return self

    def __exit__(self, *_):
        self._stack.close()

    def instance_of(self, component):
        """Instance of a component's FMU in which nothing has been set yet. Raises SlaveError if it cannot be made."""
        return Remote(component, self._workers[component.name])

    def _watch(self):
        while not self._over.wait(min(0.2, self._timeout / 4)):
            for worker in self._workers.values():
                worker.end_if_late()

    def _end(self):
        self._over.set()
        for worker in self._workers.values():
            worker.dismiss()
        limit = monotonic() + FAREWELL
        for worker in self._workers.values():
            worker.end(limit)


class Worker:
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

    def __init__(self, name, folder, timeout):
        self.messages = []
        self._name, self._timeout, self._deadline, self._was_late = name, timeout, None, False
        self._last = deque(maxlen=LAST_LINES)
        self._process = subprocess.Popen(
            [sys.executable, "-c", START.format(path=sys.path)],
            env=os.environ | {"TMPDIR": folder, "TEMP": folder, "TMP": folder},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for the run alone; what it starts can be ended with it
        )
        self._reader = Thread(target=self._show, daemon=True)
        self._reader.start()

    def greet(self):
        """Wait until the process is there. Raises SlaveError if it does not come."""
        self._in_time("its start", GREETING, receive, self._process.stdout)

    def ask(self, what, function, *arguments):
        """What the process answers to a question.

        Parameters
        ----------
        what : str
            What to call it where no answer comes.
        function : str
            Method of `isolated.Desk`.
        *arguments
            Its arguments.

        Raises
        ------
        SlaveError
            If the FMU fails in it or in what it was told before, or no answer comes.
        """
        self.put(what, function, *arguments)
        return self.answer()

    def put(self, what, function, *arguments):
        """Put a question; `answer` has to be called next, and until then others can be asked too."""
        self._asked = what
        self._in_time(what, self._timeout, send, self._process.stdin, (True, function, *arguments))

    def answer(self):
        """Answer to the question that was put."""
        went_well, result, messages = self._in_time(self._asked, self._timeout, receive, self._process.stdout)
        self.messages += messages
        if not went_well:
            raise SlaveError(result)
        return result

    def tell(self, what, function, *arguments):
        """Have the process do something; whether it went well comes with the next answer."""
        self._in_time(what, self._timeout, send, self._process.stdin, (False, function, *arguments))

    def _in_time(self, what, limit, action, *arguments):
        self._deadline = monotonic() + limit
        try:
            return action(*arguments)
        except (OSError, EOFError, pickle.UnpicklingError):
            raise SlaveError(self._obituary(what, limit)) from None
        except BaseException:
            self._kill()
            raise
        finally:
            self._deadline = None

    def end_if_late(self):
        """End the process if it has not answered for too long, and what it has started if it has ended itself."""
        deadline = self._deadline
        if deadline is None:
            return
        if self._process.poll() is not None:
            self._kill()
        elif monotonic() > deadline:
            self._was_late = True
            self._kill()

    def dismiss(self):
        """Tell the process that it is not needed any more."""
        with suppress(OSError):
            self._process.stdin.close()

    def end(self, limit):
        """Wait for the end of the process, until a time of the monotonic clock; then end it."""
        try:
            self._process.wait(max(0.0, limit - monotonic()))
        except subprocess.TimeoutExpired:
            self._kill()
            self._process.wait()
        self._reader.join(1.0)
        self._process.stdout.close()

    def _kill(self):
        """End the process and all that it has started, which may hold the pipes open."""
        if os.name != "posix":
            self._process.kill()
            return
        with suppress(OSError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def _obituary(self, what, limit):
        """What became of the process."""
        try:
            code = self._process.wait(FAREWELL)
        except subprocess.TimeoutExpired:
            self._kill()
            code = self._process.wait()
        self._reader.join(1.0)
        said = f" It printed last:\n{''.join(self._last).rstrip()}" if self._last else ""
        if self._was_late:
            return f"Its process gave no answer to {what} within {limit:g} s and was ended.{said}"
        if code < 0:
            return f"Its process was ended in {what} by signal {-code}, {signal.strsignal(-code)}.{said}"
        return f"Its process ended itself in {what}, with exit code {code if code < 256 else hex(code)}.{said}"

    def _show(self):
        """Pass on to stderr what the component prints, with its name."""
        pipe, n = self._process.stderr, 0
        while line := pipe.readline(LONGEST):
            text, n = line.decode("utf-8", errors="replace").rstrip() + "\n", n + 1
            self._last.append(text)
            if n <= SHOWN:
                print(f"[{self._name}] {text}", end="", file=sys.stderr, flush=True)
            elif n == SHOWN + 1:
                print(f"[{self._name}] prints more than {SHOWN} lines; no more are shown", file=sys.stderr, flush=True)
        pipe.close()


class Remote:
    """An instance of an FMU in the process of its component; see `Slave`."""

    def __init__(self, component, worker):
        self.name, self._worker = component.name, worker
        self._is_stepping, self._getters, self._fetched = False, [], {}
        worker.greet()
        worker.ask("its instantiation", "make", component)

    @property
    def messages(self):
        """What it logged: (status, text)."""
        return self._worker.messages

    remarks = Slave.remarks

    def setter(self, kind, variables, buffer):
        """Prepared call that sets variables of one kind from a buffer; what goes wrong is said by the next call."""
        what, number = f"Set{kind}", self._prepared("setter", kind, variables, buffer)

        def set_all():
            self._finish()
            self._worker.tell(what, "set", what, number, buffer.tobytes())
            return OK

        return set_all

    def getter(self, kind, variables, buffer):
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        what, number = f"Get{kind}", self._prepared("getter", kind, variables, buffer)
        self._getters.append(number)

        def get_all():
            if self._is_stepping:
                self._finish()
            status, data = self._fetched.pop(number, None) or self._ask(what, "get", number)
            buffer[:] = np.frombuffer(data, buffer.dtype)
            return status

        return get_all

    def stepper(self):
        """Prepared call that advances from a time by a step size; what goes wrong is said by the next call.

        What the getters get then comes with it.
        """
        number = self._prepared("stepper")

        def step(time, step_size):
            self._finish()
            self._worker.put("DoStep", "step", number, time, step_size, self._getters)
            self._is_stepping = True
            if not self._getters:  # then nothing waits for it
                self._finish()
            return OK

        return step

    def call(self, function, *arguments):
        """Call a function of the FMU by its name without prefix."""
        self._call("call", function, *arguments)

    def check(self, function, status):
        """Raise SlaveError if the status, or what was put off until now, says that something failed."""
        self._call("check", function, status)

    def get_strings(self, variables):
        """Values of String variables."""
        return self._call("get_strings", tuple(variables))

    def set_strings(self, variables, values):
        """Set String variables."""
        self._call("set_strings", tuple(variables), tuple(values))

    def enter_initialisation(self, start_time, stop_time):
        """Enter the initialisation mode for a run between two times."""
        self._call("enter_initialisation", start_time, stop_time)

    def exit_initialisation(self):
        """Leave the initialisation mode."""
        self._call("exit_initialisation")

    def state(self):
        """The whole state, which `restore` of any instance of this FMU takes."""
        return self._call("state")

    def restore(self, data):
        """Bring the instance into a state from `state`."""
        self._call("restore", data)

    def terminate(self):
        """End the simulation. That an FMU fails to is no matter any more."""
        with suppress(SlaveError):
            self._call("terminate")

    def _call(self, method, *arguments):
        return self._ask(method, "call", method, *arguments)

    def _prepared(self, method, kind=None, variables=(), buffer=None):
        blank = None if buffer is None else np.zeros_like(buffer)
        return self._ask("the preparation", "prepare", method, kind, tuple(variables), blank)

    def _ask(self, *question):
        self._finish()
        return self._worker.ask(*question)

    def _finish(self):
        """See that a step has been done; what was got with the last one does not hold any longer."""
        self._fetched = {}
        if self._is_stepping:
            self._is_stepping = False
            self._fetched = dict(zip(self._getters, self._worker.answer(), strict=True))
