"""FMUs of FMI 2.0 for co-simulation.

Reference: FMI 2.0.4, section 4.
"""

from contextlib import suppress
from ctypes import byref, c_double, c_int, c_size_t
from functools import partial
from urllib.parse import unquote_to_bytes

import numpy as np

from shipcosim.cosim.slaves.library_slave import LibrarySlave, references
from shipcosim.cosim.slaves.messages import receive_messages
from shipcosim.cosim.slaves.slave import DISCARD, OK, Call, RunEnded, SlaveError, Step, Variables

TERMINATED = 3
"""The kind of status that tells whether the FMU has ended the run: fmi2Terminated."""


class Slave2(LibrarySlave):
    """An instance of an FMU of FMI 2.0 for co-simulation."""

    _prefix = "fmi2"
    _state_calls = {
        "get": "GetFMUstate",
        "set": "SetFMUstate",
        "free": "FreeFMUstate",
        "size": "SerializedFMUstateSize",
        "serialise": "SerializeFMUstate",
        "deserialise": "DeSerializeFMUstate",
    }

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        if kind == "Long":
            return self._long_setter(variables, buffer)
        if self._direct is not None:
            return self._direct.setter(kind, variables, buffer)
        return self._exchange("Set", kind, variables, buffer)

    def getter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        if kind == "Long":
            return self._long_getter(variables, buffer)
        if self._direct is not None:
            return self._direct.getter(kind, variables, buffer)
        return self._exchange("Get", kind, variables, buffer)

    def stepper(self) -> Step:
        """Prepared call that advances from a time by a step size and returns the status."""
        if self._direct is not None:
            return self._direct.stepper()
        do_step = self._function("DoStep")
        component = self.component
        return lambda time, step_size: do_step(component, time, step_size, 1)

    def check(self, function: str, status: int) -> None:
        """Raise SlaveError if the status says that the function failed, RunEnded if the FMU ends the run."""
        if function == "DoStep" and status == DISCARD:
            is_ended = c_int()
            with suppress(SlaveError):  # an FMU without this function ends no run
                ask = self._function("GetBooleanStatus")
                if ask(self.component, TERMINATED, byref(is_ended)) != OK:
                    is_ended = c_int()
            if is_ended.value:
                raise RunEnded
        super().check(function, status)

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

    def _instantiate(self):
        from fmpy import calloc, fmi2, free

        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        # These log text as a format: % in it would read wild memory.
        if self._is_python or self._is_container:
            callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(
                lambda env, name, status, kind, text: self.log_message(status, text)
            )
        else:
            receive_messages(self, callbacks, fmi2.fmi2CallbackLoggerTYPE)
        if self._is_python:
            # PythonFMU decodes blanks in the address of its resources alone, and ends the process where it does not
            # find them, as below a folder with an umlaut.
            call = self._fmu.fmi2Instantiate
            self._fmu.fmi2Instantiate = lambda name, kind, token, address, *more: call(
                name, kind, token, _decoded(address), *more
            )
        self._fmu.instantiate(callbacks=callbacks, loggingOn=True)


def _decoded(address: bytes) -> bytes:
    """Address of a folder as PythonFMU reads it."""
    plain = unquote_to_bytes(address)
    if b"%20" in plain:
        raise SlaveError(
            "PythonFMU finds nothing below a folder with '%20' in its name. Rename it."
        )
    return plain
