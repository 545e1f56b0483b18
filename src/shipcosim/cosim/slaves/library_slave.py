"""FMUs whose library this process loads through FMPy: the parts common to all FMI versions."""

import os
import re
from collections.abc import Mapping, Sequence
from ctypes import Array, byref, c_char, c_char_p, c_int, c_size_t, c_uint, c_void_p, cast
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.cosim.slaves.in_process import DirectCalls, python_object_of
from shipcosim.cosim.slaves.library_file import library_problem
from shipcosim.cosim.slaves.slave import (
    ERROR,
    FAILED,
    FATAL,
    OK,
    STATUS,
    Slave,
    SlaveError,
    Variables,
)

MOST_MESSAGES = 1000
"""Most messages of an instance that are kept."""


class LibrarySlave(Slave):
    """One instance of an FMU in this process.

    Parameters
    ----------
    name : str
        Name of the component.
    folder : path
        Where the FMU is unpacked.
    identifier : str
        modelIdentifier of the interface type.
    token : str
        GUID, or instantiation token in FMI 3.0.

    Raises
    ------
    SlaveError
        If its library cannot be loaded, or it refuses to be instantiated.
    """

    _prefix: str
    _form = "Slave"  # or "Model": which of FMPy's classes loads it
    _terminate = "Terminate"
    _state_calls: Mapping[str, str]
    _fmu: Any  # FMPy's
    component: Any

    def __init__(self, name: str, folder: Path, identifier: str, token: str):
        self.name = name
        self._identifier = identifier
        self._messages: list[tuple[int, str]] = []
        self._is_lost = False
        # Marks of the two kinds of FMU that need special care with messages and calls.
        self._is_python = (Path(folder) / "resources" / "slavemodule.txt").is_file()
        self._is_container = (Path(folder) / "resources" / "container.json").is_file()
        if problem := library_problem(folder, self._prefix[-1], identifier):
            raise SlaveError(problem)
        from fmpy import fmi1, fmi2, fmi3

        versions = {"fmi1": fmi1, "fmi2": fmi2, "fmi3": fmi3}
        fmpy_class = getattr(versions[self._prefix], f"FMU{self._prefix[-1]}{self._form}")
        # Loading may change the working directory; it is restored in any case.
        here = os.getcwd()
        try:
            self._fmu = fmpy_class(
                guid=token,
                modelIdentifier=identifier,
                unzipDirectory=str(folder),
                instanceName=name,
                requireFunctions=False,  # a missing one is reported where it is called
            )
            self._instantiate()
        except Exception as error:
            # The FMU's own messages tell more than the error, whose paths are those of the unpacked FMU.
            text = str(error).replace(f"{folder}{os.sep}", "")
            raise SlaveError(self.last_messages() or text) from error
        finally:
            os.chdir(here)  # FMPy stays in the library's folder where loading fails
        self.component = self._fmu.component
        self._folder: Path = folder
        self._find_python_object()

    @property
    def messages(self) -> list[tuple[int, str]]:
        """Messages of the FMU beyond status "ok": (status, text)."""
        return self._messages

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU by its name without prefix, e.g. ``"Terminate"``."""
        self.check(function, self._function(function)(self.component, *arguments))

    def check(self, function: str, status: int) -> None:
        """Raise SlaveError if the status says that the function failed."""
        if status >= FAILED:
            # After a fatal error FMI allows no further call, not even to free the instance.
            self._is_lost = status == FATAL
            label = STATUS[status] if status < len(STATUS) else str(c_int(status).value)
            raise SlaveError(
                f"{self._prefix}{function} returned '{label}'. {self.last_messages()}".strip()
            )

    def last_messages(self) -> str:
        """The FMU's last errors, or its last messages if there are none."""
        errors = [text for status, text in self.messages if status >= ERROR]
        words = "\n".join(errors[-3:] or [text for _, text in self.messages[-3:]])
        return re.sub(
            r"(?m)^Fatal py exception encountered: .*\n", "", words
        )  # PythonFMU's own, names no cause

    def free(self) -> None:
        """Free the instance and its library.

        Not after a fatal error: FMI forbids it, and PythonFMU, which calls every exception fatal and releases its
        objects then, would release them a second time.
        """
        self._direct = None
        if not self._is_lost:
            self._fmu.freeInstance()

    def reset(self) -> None:
        """Return the instance to its state after instantiation, also after the end of a run."""
        self.call("Reset")
        self._messages.clear()
        self._find_python_object()

    def rewind(self, state: Any) -> None:
        """Return an instance of our shell to a state of its object from before the start.

        Unlike after `reset` the object is the same, so prepared calls stay. It keeps its dataclasses of parameters, and
        makes those anew at the start whose values have changed.
        """
        target = self.python_object
        values = vars(target)
        # Parameter dataclasses are kept: the shell replaces only those whose values change.
        groups = {group.name: values[group.name] for group in target.groups if group.name in values}
        target._set_fmu_state(state)
        values.update(groups)
        target.messages.clear()
        self._messages.clear()

    def state(self) -> bytes:
        """The FMU's whole state as bytes; `restore` of any instance takes it."""
        names = self._state_calls
        state = c_void_p()
        size = c_size_t()
        # FMI: get a handle, ask for the size, serialise, free the handle.
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
        names = self._state_calls
        state = c_void_p()
        buffer = (c_char * len(data)).from_buffer_copy(data)
        self.call(
            names["deserialise"],
            self._as_bytes(names["deserialise"], 1, buffer),
            len(data),
            byref(state),
        )
        try:
            self.call(names["set"], state)
        finally:
            self.call(names["free"], byref(state))

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode."""
        self.call("ExitInitializationMode")

    def terminate(self) -> None:
        """End the simulation. A failure here no longer matters."""
        self._is_lost = self._function(self._terminate)(self.component) == FATAL

    def get_strings(self, variables: Variables) -> list[str] | list[bytes]:
        """Values of String variables."""
        texts = (c_char_p * len(variables))()
        self.call("GetString", references(variables), len(variables), texts)
        return [(text or b"").decode() for text in texts]

    def set_strings(self, variables: Variables, values: Sequence) -> None:
        """Set String variables."""
        texts = (c_char_p * len(variables))(*(value.encode() for value in values))
        self.call("SetString", references(variables), len(variables), texts)

    def _long_setter(self, variables, buffer):
        """Setter from a 64-bit buffer for an FMU with 32-bit integers."""
        narrow = np.zeros(len(variables), dtype=np.int32)
        set_all = self.setter("Integer", variables, narrow)

        # Refuse values that do not fit: a cast would wrap silently.
        def set_narrowed():
            if (status := self.status_of_range(buffer, narrow.dtype, variables)) is not None:
                return status
            narrow[:] = buffer
            return set_all()

        return set_narrowed

    def _long_getter(self, variables, buffer):
        """Getter into a 64-bit buffer."""
        narrow = np.zeros(len(variables), dtype=np.int32)
        get_all = self.getter("Integer", variables, narrow)

        def get_widened():
            if (status := get_all()) >= FAILED:
                return status
            buffer[:] = narrow
            return OK

        return get_widened

    def status_of_range(
        self, values: np.ndarray, kind: np.dtype, variables: Variables
    ) -> int | None:
        """Status, logged with its reason, if a type cannot hold a value; None if it holds all."""
        limits = np.finfo(kind) if kind.kind == "f" else np.iinfo(kind)
        low = int(limits.min)
        high = int(limits.max)
        for variable, value in zip(variables, values.tolist(), strict=True):
            # Infinity and NaN pass: a float type can hold them.
            if abs(value) != float("inf") and value == value and not low <= value <= high:
                self._note(
                    ERROR,
                    f"{variable.name} cannot be {value!r}: {kind} ends at {low:.4g} and {high:.4g}.",
                )
                return ERROR
        return None

    def _find_python_object(self):
        """Prepare direct calls if the instance is a Python object of our own shell."""
        target = python_object_of(self._folder, self.name) if self._is_python else None
        self._direct = None if target is None else DirectCalls(target, self._note)
        self.python_object = target

    def _as_bytes(self, function, position, buffer):
        return cast(buffer, self._function(function).argtypes[position])

    def _function(self, name):
        """Function of the FMU's library by its name without prefix; FMPy has set its types."""
        try:
            function = getattr(self._fmu.dll, self._symbol(name))
        except AttributeError:
            raise SlaveError(f"Its library has no function {self._symbol(name)}.") from None
        # A negative status is none of FMI: as a large number it is a failure.
        if function.restype is c_int:
            function.restype = c_uint
        return function

    def _symbol(self, function):
        """Name of a function in the FMU's library."""
        return f"{self._prefix}{function}"

    def log_message(self, status: int, message: bytes | None) -> None:
        """Keep a message of the FMU."""
        text = (message or b"").decode("utf-8", errors="replace")
        self._note(status, text.replace("%%", "%") if self._is_python else text)

    def _note(self, status, text):
        if status != OK and len(self._messages) < MOST_MESSAGES:
            self._messages.append((status, text))

    def _instantiate(self) -> None:
        """Instantiate the FMU, with logging."""
        raise NotImplementedError


def references(variables: Variables) -> Array:
    """Value references of variables as FMI 1.0 and 2.0 take them."""
    return (c_uint * len(variables))(*(variable.value_reference for variable in variables))
