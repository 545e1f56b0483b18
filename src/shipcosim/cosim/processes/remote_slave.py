"""Components in their own processes: a crash or hang ends the component, not the run.

The process of a component does what a `Slave` does here, on the same bytes, so results are the same to the last digit.
"""

from collections.abc import Sequence
from contextlib import ExitStack, suppress
from threading import Event, Thread
from time import monotonic
from typing import Any, Self

import numpy as np

from shipcosim.cosim.processes.component_process import EXIT_TIMEOUT, ComponentProcess
from shipcosim.cosim.slaves.slave import OK, Call, Slave, SlaveError, Step, Variables
from shipcosim.ssp import Component, System
from shipcosim.temporary import temporary_folder


class RemoteSlave(Slave):
    """An instance of an FMU in the process of its component.

    Parameters
    ----------
    component : Component
        Whose FMU is instantiated.
    process : ComponentProcess
        Of this component.

    Raises
    ------
    SlaveError
        If the FMU cannot be instantiated.
    """

    def __init__(self, component: Component, process: ComponentProcess):
        self.name = component.name
        self._process = process
        self._is_stepping = False
        self._getters: list[int] = []
        self._fetched: dict[int, tuple[int, bytes]] = {}
        process.wait_for_start()
        process.request("its instantiation", "make", component)

    @property
    def messages(self) -> list[tuple[int, str]]:
        """Logged messages: (status, text)."""
        return self._process.messages

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind; the next call reports errors."""
        what = f"Set{kind}"
        number = self._prepared("setter", kind, variables, buffer)

        # No answer is awaited, so that all components can be sent their inputs at once.
        def set_all():
            self._finish()
            self._process.notify(what, what, number, buffer.tobytes())
            return OK

        return set_all

    def getter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        what = f"Get{kind}"
        number = self._prepared("getter", kind, variables, buffer)
        self._getters.append(number)

        def get_all():
            # Reading ends a step that is under way; its answer brought these values along.
            if self._is_stepping:
                self._finish()
            status, data = self._fetched.pop(number, None) or self._request(what, "get", number)
            buffer[:] = np.frombuffer(data, buffer.dtype)
            return status

        return get_all

    def stepper(self) -> Step:
        """Prepared call that advances by a step; the next call reports errors.

        The answer also brings the values of the getters.
        """
        number = self._prepared("stepper")

        def step(time, step_size):
            # Only send: the other components step meanwhile in their processes.
            self._finish()
            self._process.send_request("DoStep", "step", number, time, step_size, self._getters)
            self._is_stepping = True
            if not self._getters:  # then nothing waits for it
                self._finish()
            return OK

        return step

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU by its name without prefix."""
        self._call("call", function, *arguments)

    def check(self, function: str, status: int) -> None:
        """Raise SlaveError if the status or an earlier unanswered request failed."""
        self._call("check", function, status)

    def get_strings(self, variables: Variables) -> list[str] | list[bytes]:
        """Values of String variables."""
        return self._call("get_strings", tuple(variables))

    def set_strings(self, variables: Variables, values: Sequence) -> None:
        """Set String variables."""
        self._call("set_strings", tuple(variables), tuple(values))

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self._call("enter_initialisation", start_time, stop_time)

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode."""
        self._call("exit_initialisation")

    def state(self) -> bytes:
        """The whole state, which `restore` of any instance of this FMU takes."""
        return self._call("state")

    def restore(self, data: bytes) -> None:
        """Bring the instance into a state from `state`."""
        self._call("restore", data)

    def terminate(self) -> None:
        """End the simulation. A failure here no longer matters."""
        with suppress(SlaveError):
            self._call("terminate")

    def _call(self, method, *arguments: Any):
        return self._request(method, "call", method, *arguments)

    def _prepared(self, method, kind=None, variables=(), buffer=None):
        # The process has a buffer of its own of the same size; values travel as bytes.
        blank = None if buffer is None else np.zeros_like(buffer)
        return self._request("the preparation", "prepare", method, kind, tuple(variables), blank)

    def _request(self, *question):
        self._finish()
        return self._process.request(*question)

    def _finish(self):
        """Finish the step under way; values fetched with an earlier one are no longer valid."""
        self._fetched = {}
        if self._is_stepping:
            self._is_stepping = False
            self._fetched = dict(zip(self._getters, self._process.receive_answer(), strict=True))


class IsolatedInstances:
    """Instances of a system's FMUs, each in a process that is started beforehand; see `Instances`.

    Parameters
    ----------
    system : System
        Whose components get a process.
    timeout : float
        How long a component may take for an answer. [s]
    """

    def __init__(self, system: System, timeout: float):
        self._names = list(system.components)
        self._timeout = timeout

    def __enter__(self) -> Self:
        self._processes: dict[str, ComponentProcess] = {}
        self._over = Event()
        self._stack = ExitStack()
        # If one process cannot start, the stack ends those already started.
        with self._stack:  # undoes all where a process cannot be started
            folder = temporary_folder()
            folder = self._stack.enter_context(folder)
            self._stack.callback(self._end)
            # Start all processes first: they load Python in parallel.
            for name in self._names:
                self._processes[name] = ComponentProcess(name, folder, self._timeout)
            self._watchdog = Thread(target=self._watch, daemon=True)
            self._watchdog.start()
            self._stack = self._stack.pop_all()
        return self

    def __exit__(self, *_):
        self._stack.close()

    def instance_of(self, component: Component) -> RemoteSlave:
        """New instance of a component's FMU, nothing set. Raises SlaveError if it fails."""
        return RemoteSlave(component, self._processes[component.name])

    def _watch(self):
        while not self._over.wait(min(0.2, self._timeout / 4)):
            for process in self._processes.values():
                process.kill_if_late()

    def _end(self):
        # Tell all processes first, then wait: they end in parallel within one limit.
        self._over.set()
        for process in self._processes.values():
            process.close_input()
        limit = monotonic() + EXIT_TIMEOUT
        for process in self._processes.values():
            process.end(limit)
