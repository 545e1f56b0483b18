"""FMUs of FMI 1.0 for co-simulation and for model exchange.

FMI 1.0 has no initialisation mode: an FMU is initialised with its start values, and inputs that are connected get what
feeds them right after that.

Reference: FMI 1.0.1 for co-simulation, section 3; FMI 1.0.1 for model exchange, section 2.
"""

from ctypes import byref, c_char, c_double, c_int, c_size_t
from functools import partial
from math import inf

import numpy as np

from shipcosim.cosim.slaves.library_slave import LibrarySlave, references
from shipcosim.cosim.slaves.messages import receive_messages
from shipcosim.cosim.slaves.model_exchange import CONTINUOUS, EVENT, EventUpdate, ModelExchange
from shipcosim.cosim.slaves.slave import (
    FAILED,
    OK,
    Call,
    RunEnded,
    SlaveError,
    Step,
    Variables,
)

TRUE = b"\x01"
FALSE = b"\x00"


class Slave1(LibrarySlave):
    """An instance of an FMU of FMI 1.0 for co-simulation."""

    _prefix = "fmi1"
    _terminate = "TerminateSlave"

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        if kind == "Long":
            return self._long_setter(variables, buffer)
        # FMI 1.0 has Booleans of one byte, unlike our buffers: use a buffer of the FMU's own type.
        native_buffer, signs, call = self._prepared("Set", kind, variables)

        # An alias with opposite sign (FMI 1.0) has the negated value of the base variable.
        def set_all():
            native_buffer[:] = buffer * signs
            return call()

        return set_all

    def getter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        if kind == "Long":
            return self._long_getter(variables, buffer)
        native_buffer, signs, call = self._prepared("Get", kind, variables)

        def get_all():
            if (status := call()) >= FAILED:
                return status
            np.multiply(native_buffer, signs, out=buffer)
            return OK

        return get_all

    def stepper(self) -> Step:
        """Prepared call that advances from a time by a step size and returns the status."""
        do_step = self._function("DoStep")
        component = self.component
        return lambda time, step_size: do_step(component, time, step_size, TRUE)

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Initialise the FMU for a run between two times."""
        self.call("InitializeSlave", start_time, TRUE, stop_time)

    def exit_initialisation(self) -> None:
        """Nothing: the FMU is initialised already."""

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made."""
        self.call("ResetSlave")
        self._messages.clear()

    def _prepared(self, verb, kind, variables):
        """Buffer of the FMU's own type, sign of each variable, and the prepared call."""
        native_buffer = np.zeros(
            len(variables),
            dtype={"Real": np.float64, "Integer": np.int32, "Boolean": np.int8}[kind],
        )
        signs = np.array(
            [-1 if variable.negated and kind != "Boolean" else 1 for variable in variables]
        )
        pointer = {"Real": c_double, "Integer": c_int, "Boolean": c_char}[kind] * len(variables)
        arguments = (
            references(variables),
            c_size_t(len(variables)),
            pointer.from_buffer(native_buffer),
        )
        return (
            native_buffer,
            signs,
            partial(self._function(verb + kind), self.component, *arguments),
        )

    def _symbol(self, function):
        return f"{self._identifier}_fmi{function}"

    def _instantiate(self):
        from fmpy import calloc, fmi1, free

        # FMPy 0.3.32 takes the status of these for a text.
        for name in ("InitializeSlave", "DoStep") if self._form == "Slave" else ():
            getattr(self._fmu.dll, self._symbol(name)).restype = c_int
        callbacks = fmi1.fmi1CallbackFunctions()
        callbacks.allocateMemory = fmi1.fmi1CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi1.fmi1CallbackFreeMemoryTYPE(free)
        receive_messages(self, callbacks, fmi1.fmi1CallbackLoggerTYPE)
        self._fmu.instantiate(functions=callbacks, loggingOn=True)
        if not self._fmu.component:
            raise SlaveError("It cannot be instantiated.")


class Model1(ModelExchange, Slave1):
    """An instance of an FMU of FMI 1.0 for model exchange: it has no modes, an event is a call."""

    NOMINALS = "GetNominalContinuousStates"

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Initialise the FMU."""
        self.call("SetTime", start_time)
        info = self._event_info()
        self.call("Initialize", FALSE, 0.0, byref(info))
        if info.terminateSimulation != FALSE:
            raise RunEnded

    def reset(self) -> None:
        """Raise SlaveError: models of FMI 1.0 cannot be reset."""
        raise SlaveError("A model of FMI 1.0 cannot be reset.")

    def _leave_initialisation(self):
        self.mode = EVENT

    def _enter_event_mode(self):
        self.mode = EVENT

    def _leave_event_mode(self):
        self.mode = CONTINUOUS

    def completed_step(self) -> bool:
        """Tell the FMU that a solver step is done; true if it asks for an event."""
        event = c_char()
        self.call("CompletedIntegratorStep", byref(event))
        return event.value != FALSE

    def _update_discrete_states(self):
        info = self._event_info()
        self.call("EventUpdate", FALSE, byref(info))
        # Without a time event the next one is infinitely far.
        next_event = info.nextEventTime if info.upcomingTimeEvent != FALSE else inf
        return EventUpdate(
            info.iterationConverged == FALSE, info.terminateSimulation != FALSE, next_event
        )

    @staticmethod
    def _event_info():
        from fmpy.fmi1 import fmi1EventInfo

        return fmi1EventInfo()
