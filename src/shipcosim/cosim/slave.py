"""One running instance of an FMU, FMI 2.0 or 3.0, behind the same few calls. The only door to FMPy.

Exchanging values is prepared once: `setter` and `getter` bind value references and a NumPy buffer to the function of
the FMU's library, and what they return is called in every step. Buffers hold Real as float64, Integer (and
Enumeration) and Boolean as int32, whatever the FMU's own types are.
"""

import os
import re
import sys
from collections.abc import Callable, Sequence
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, cast
from functools import partial
from pathlib import Path

import numpy as np

from shipcosim.cosim.direct import Direct, object_of

BUFFER_TYPES = {"Integer": np.int32, "Boolean": np.int32, "Real": np.float64}
STATUS = ["ok", "warning", "discard", "error", "fatal", "pending"]
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
FAILED = DISCARD
"""Status from which on a call has not done its work."""


class SlaveError(Exception):
    """A call to an FMU failed. The text is what the FMU said about it."""


class Slave:
    """One instance of an FMU.

    Parameters
    ----------
    name : str
        Name of the component.
    folder : path
        Where the FMU is unpacked.
    identifier : str
        modelIdentifier of its co-simulation.
    token : str
        GUID, or instantiation token in FMI 3.0.

    Raises
    ------
    SlaveError
        If its library cannot be loaded, or it refuses to be instantiated.
    """

    def __init__(self, name: str, folder: Path, identifier: str, token: str):
        self.name = name
        self.messages: list[tuple[int, str]] = []
        self._is_lost = False
        self._is_python = (Path(folder) / "resources" / "slavemodule.txt").is_file()
        self._is_container = (Path(folder) / "resources" / "container.json").is_file()
        here = os.getcwd()
        try:
            self._fmu = self._load(
                guid=token, modelIdentifier=identifier, unzipDirectory=str(folder), instanceName=name
            )
            self._instantiate()
        except Exception as error:
            raise SlaveError(self.last_words() or f"{error} {_platform_hint(folder)}".strip()) from error
        finally:
            os.chdir(here)  # FMPy stays in the library's folder where loading fails
        self.component = self._fmu.component
        self._folder = folder
        self._find_object()

    def call(self, function: str, *arguments) -> None:
        """Call a function of the FMU by its name without prefix, e.g. ``"Terminate"``."""
        self.check(function, self._function(function)(self.component, *arguments))

    def check(self, function: str, status: int) -> None:
        """Raise SlaveError if the status says that the function failed."""
        if status >= FAILED:
            self._is_lost = status == FATAL
            label = STATUS[status] if status < len(STATUS) else str(status)
            raise SlaveError(f"{self._prefix}{function} returned '{label}'. {self.last_words()}".strip())

    def last_words(self) -> str:
        """What the FMU logged as errors, or else what it logged last."""
        errors = [text for status, text in self.messages if status >= ERROR]
        words = "\n".join(errors[-3:] or [text for _, text in self.messages[-3:]])
        return re.sub(r"(?m)^Fatal py exception encountered: .*\n", "", words)  # PythonFMU's own, names no cause

    def remarks(self) -> list[str]:
        """Warnings that the FMU logged, with its name before them."""
        texts = [text for status, text in self.messages if status == WARNING]
        return [text if text.startswith(self.name) else f"{self.name}: {text}" for text in texts]

    def free(self) -> None:
        """Free the instance and its library.

        Not after a fatal error: FMI forbids it, and PythonFMU, which calls every exception fatal and releases its
        objects then, would release them a second time.
        """
        self._direct = None
        if not self._is_lost:
            self._fmu.freeInstance()

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made, also after the end of a run."""
        self.call("Reset")
        self.messages.clear()
        self._find_object()

    def state(self) -> bytes:
        """The whole state, which `restore` of any instance of this FMU takes, in another process too."""
        names, state, size = self._state_calls, c_void_p(), c_size_t()
        self.call(names["get"], byref(state))
        try:
            self.call(names["size"], state, byref(size))
            data = (c_char * size.value)()
            self.call(names["serialise"], state, self._as_bytes(names["serialise"], 2, data), size)
        finally:
            self.call(names["free"], byref(state))
        return data.raw

    def restore(self, data: bytes) -> None:
        """Bring the instance into a state from `state`."""
        names, state, buffer = self._state_calls, c_void_p(), (c_char * len(data)).from_buffer_copy(data)
        self.call(names["deserialise"], self._as_bytes(names["deserialise"], 1, buffer), len(data), byref(state))
        try:
            self.call(names["set"], state)
        finally:
            self.call(names["free"], byref(state))

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode."""
        self.call("ExitInitializationMode")

    def terminate(self) -> None:
        """End the simulation. That an FMU fails to is no matter any more."""
        self._is_lost = self._function("Terminate")(self.component) == FATAL

    def _find_object(self):
        target = object_of(self._folder, self.name) if self._is_python else None
        self._direct = None if target is None else Direct(target, self._note)

    def _as_bytes(self, function, position, buffer):
        return cast(buffer, self._function(function).argtypes[position])

    def _function(self, name):
        return self._fmu._functions[self._prefix + name]

    def _log(self, status, message):
        text = (message or b"").decode("utf-8", errors="replace")
        self._note(status, text.replace("%%", "%") if self._is_python else text)

    def _note(self, status, text):
        if status != OK and len(self.messages) < 1000:
            self.messages.append((status, text))


class Slave2(Slave):
    """An instance of an FMU of FMI 2.0."""

    _prefix = "fmi2"
    _state_calls = {
        "get": "GetFMUstate",
        "set": "SetFMUstate",
        "free": "FreeFMUstate",
        "size": "SerializedFMUstateSize",
        "serialise": "SerializeFMUstate",
        "deserialise": "DeSerializeFMUstate",
    }

    def setter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        if self._direct is not None:
            return self._direct.setter(kind, variables, buffer)
        return self._exchange("Set", kind, variables, buffer)

    def getter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        if self._direct is not None:
            return self._direct.getter(kind, variables, buffer)
        return self._exchange("Get", kind, variables, buffer)

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances from a time by a step size and returns the status."""
        if self._direct is not None:
            return self._direct.stepper()
        do_step, component = self._function("DoStep"), self.component
        return lambda time, step_size: do_step(component, time, step_size, 1)

    def get_strings(self, variables: Sequence) -> list[str]:
        """Values of String variables."""
        texts = (c_char_p * len(variables))()
        self.call("GetString", _references(variables), len(variables), texts)
        return [(text or b"").decode() for text in texts]

    def set_strings(self, variables: Sequence, values: Sequence[str]) -> None:
        """Set String variables."""
        texts = (c_char_p * len(variables))(*(value.encode() for value in values))
        self.call("SetString", _references(variables), len(variables), texts)

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self.call("SetupExperiment", 0, 0.0, start_time, 1, stop_time)
        self.call("EnterInitializationMode")

    def _exchange(self, verb, kind, variables, buffer):
        pointer = (c_double if kind == "Real" else c_int) * len(variables)
        return partial(
            self._function(verb + kind),
            self.component,
            _references(variables),
            c_size_t(len(variables)),
            pointer.from_buffer(buffer),
        )

    @staticmethod
    def _load(**arguments):
        from fmpy.fmi2 import FMU2Slave

        return FMU2Slave(**arguments)

    def _instantiate(self):
        from fmpy import calloc, fmi2, free
        from fmpy.logging import addLoggerProxy

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(lambda env, name, status, kind, text: self._log(status, text))
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        if not (self._is_python or self._is_container):  # they log text as a format: % in it would read wild memory
            addLoggerProxy(byref(callbacks))
        self._fmu.instantiate(callbacks=callbacks, loggingOn=True)


class Slave3(Slave):
    """An instance of an FMU of FMI 3.0: scalar variables, no event mode, no early return."""

    _prefix = "fmi3"
    _state_calls = {
        "get": "GetFMUState",
        "set": "SetFMUState",
        "free": "FreeFMUState",
        "size": "SerializedFMUStateSize",
        "serialise": "SerializeFMUState",
        "deserialise": "DeserializeFMUState",
    }

    def setter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        groups = list(self._groups("Set", variables))

        def set_all():
            for rows, own, call in groups:
                own[:] = buffer[rows]
                if (status := call()) >= FAILED:
                    return status
            return OK

        return set_all

    def getter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        groups = list(self._groups("Get", variables))

        def get_all():
            for rows, own, call in groups:
                if (status := call()) >= FAILED:
                    return status
                buffer[rows] = own
            return OK

        return get_all

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances from a time by a step size and returns the status."""
        from ctypes import c_bool

        do_step, event, terminate, early, reached = self._function("DoStep"), c_bool(), c_bool(), c_bool(), c_double()
        results = byref(event), byref(terminate), byref(early), byref(reached)

        def step(time, step_size):
            status = do_step(self.component, time, step_size, True, *results)
            return DISCARD if status < FAILED and (terminate.value or early.value) else status

        return step

    def get_strings(self, variables: Sequence) -> list[str]:
        """Values of String variables."""
        texts = (c_char_p * len(variables))()
        self.call("GetString", _references(variables), len(variables), texts, len(variables))
        return [(text or b"").decode() for text in texts]

    def set_strings(self, variables: Sequence, values: Sequence[str]) -> None:
        """Set String variables."""
        texts = (c_char_p * len(variables))(*(value.encode() for value in values))
        self.call("SetString", _references(variables), len(variables), texts, len(variables))

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self.call("EnterInitializationMode", False, 0.0, start_time, True, stop_time)

    def _groups(self, verb, variables):
        """For each of the FMU's types among the variables: their rows, a buffer of this type and the prepared call."""
        for name in dict.fromkeys(variable.type for variable in variables):
            rows = np.array([i for i, variable in enumerate(variables) if variable.type == name])
            own = np.zeros(len(rows), dtype=_FMI3_TYPES[name])
            function = self._function(f"{verb}{'Int64' if name == 'Enumeration' else name}")
            values = cast(own.ctypes.data, function.argtypes[3])
            references = _references([variables[row] for row in rows])
            yield rows, own, partial(function, self.component, references, len(rows), values, len(rows))

    @staticmethod
    def _load(**arguments):
        from fmpy.fmi3 import FMU3Slave

        return FMU3Slave(**arguments)

    def _instantiate(self):
        self._fmu.instantiate(
            loggingOn=True, logMessage=lambda environment, status, category, text: self._log(status, text)
        )


_FMI3_TYPES = {
    "Float64": np.float64,
    "Float32": np.float32,
    "Boolean": np.bool_,
    "Enumeration": np.int64,
    **{f"Int{bits}": np.dtype(f"int{bits}") for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": np.dtype(f"uint{bits}") for bits in (8, 16, 32, 64)},
}


def _references(variables):
    return (c_uint * len(variables))(*(variable.value_reference for variable in variables))


def _platform_hint(folder):
    binaries = Path(folder) / "binaries"
    there = sorted(path.name for path in binaries.iterdir()) if binaries.is_dir() else []
    return f"The FMU brings binaries for: {', '.join(there) or 'no platform'}; this is {sys.platform}."
