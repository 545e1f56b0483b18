"""One running instance of an FMU, whatever its version of FMI, behind the same few calls; FMI 2.0. The door to FMPy.

Exchanging values is prepared once: `setter` and `getter` bind value references and a NumPy buffer to the function of
the FMU's library, and what they return is called in every step. Buffers hold Real as float64, Integer (and
Enumeration) and Boolean as int32, whatever the FMU's own types are; Long is Integer in 64 bits, for systems with an FMU
of FMI 3.0 that needs them.
"""

import os
import re
import sys
from collections.abc import Callable, Sequence
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, cast
from functools import partial
from pathlib import Path

import numpy as np

from shipcosim.cosim.slaves.in_process import Direct, object_of

BUFFER_TYPES = {"Integer": np.int32, "Boolean": np.int32, "Long": np.int64, "Real": np.float64}
"""Kinds of exchanged values, in an order in which each may follow those before it."""
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

    def get_strings(self, variables: Sequence) -> list[str]:
        """Values of String variables."""
        texts = (c_char_p * len(variables))()
        self.call("GetString", references(variables), len(variables), texts)
        return [(text or b"").decode() for text in texts]

    def set_strings(self, variables: Sequence, values: Sequence[str]) -> None:
        """Set String variables."""
        texts = (c_char_p * len(variables))(*(value.encode() for value in values))
        self.call("SetString", references(variables), len(variables), texts)

    def _long_setter(self, variables, buffer):
        """Setter from a buffer of 64 bits for an FMU with Integers of 32."""
        own = np.zeros(len(variables), dtype=np.int32)
        set_all = self.setter("Integer", variables, own)

        def set_narrowed():
            if (status := self.refuse_outside(buffer, own.dtype, variables)) is not None:
                return status
            own[:] = buffer
            return set_all()

        return set_narrowed

    def _long_getter(self, variables, buffer):
        """Getter into a buffer of 64 bits."""
        own = np.zeros(len(variables), dtype=np.int32)
        get_all = self.getter("Integer", variables, own)

        def get_widened():
            if (status := get_all()) >= FAILED:
                return status
            buffer[:] = own
            return OK

        return get_widened

    def refuse_outside(self, values: np.ndarray, kind: np.dtype, variables: Sequence) -> int | None:
        """Status of values that a type cannot hold, which are logged; None where it can hold all of them."""
        limits = np.finfo(kind) if kind.kind == "f" else np.iinfo(kind)
        low, high = int(limits.min), int(limits.max)
        for variable, value in zip(variables, values.tolist(), strict=True):
            if abs(value) != float("inf") and value == value and not low <= value <= high:
                self._note(ERROR, f"{variable.name} cannot be {value!r}: {kind} ends at {low:.4g} and {high:.4g}.")
                return ERROR
        return None

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
        if kind == "Long":
            return self._long_setter(variables, buffer)
        if self._direct is not None:
            return self._direct.setter(kind, variables, buffer)
        return self._exchange("Set", kind, variables, buffer)

    def getter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        if kind == "Long":
            return self._long_getter(variables, buffer)
        if self._direct is not None:
            return self._direct.getter(kind, variables, buffer)
        return self._exchange("Get", kind, variables, buffer)

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances from a time by a step size and returns the status."""
        if self._direct is not None:
            return self._direct.stepper()
        do_step, component = self._function("DoStep"), self.component
        return lambda time, step_size: do_step(component, time, step_size, 1)

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self.call("SetupExperiment", 0, 0.0, start_time, 1, stop_time)
        self.call("EnterInitializationMode")

    def _exchange(self, verb, kind, variables, buffer):
        pointer = (c_double if kind == "Real" else c_int) * len(variables)
        return partial(
            self._function(verb + kind),
            self.component,
            references(variables),
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


def references(variables):
    """Value references of variables as FMI 1.0 and 2.0 take them."""
    return (c_uint * len(variables))(*(variable.value_reference for variable in variables))


def _platform_hint(folder):
    binaries = Path(folder) / "binaries"
    there = sorted(path.name for path in binaries.iterdir()) if binaries.is_dir() else []
    return f"The FMU brings binaries for: {', '.join(there) or 'no platform'}; this is {sys.platform}."
