"""FMI 2.0 interface of an FMU, called by the binary of pythonfmu. Writers of FMUs need `Fmu` only.

The binary looks for a class that has a base class named `Fmi2Slave`, makes an instance per component and calls the
methods below. It logs the `repr` of what they raise, and the queue of messages after other calls. A raised
exception is status fatal to it, which our loader makes an error.
"""

import copy
import functools
import math
import weakref
from collections.abc import Callable, Sequence
from typing import Any, ClassVar, NamedTuple

from shipcosim.fmi import state
from shipcosim.fmi.access import (
    Access,
    Found,
    getter,
    refuse_not_finite_inputs,
    refuse_not_finite_outputs,
    whole_number,
)
from shipcosim.fmi.failures import FmuError, Message, message_of, text_of
from shipcosim.fmi.pythonfmu_memory import keep
from shipcosim.fmi.variables import Parameters, Variable, text_of_left_out


class State(NamedTuple):
    """FMU state for the host. The owner is not part of the stored state."""

    owner: Any
    content: tuple


def _guarded(method: Callable) -> Callable:
    """Turn any exception of a method into an `FmuError` that names component and time."""

    @functools.wraps(method)
    def call(self, *arguments):
        try:
            return method(self, *arguments)
        except BaseException as error:
            raise self.failure(error) from None

    return call


def _differ(slave: Any, variables: Found, values: Sequence) -> bool:
    """True if values differ from the slave's: `start` depends only on the variables."""
    return variables.values(slave.__dict__) != tuple(values)


class Fmi2Slave:
    """FMI 2.0 co-simulation on an object that keeps its variables and its state as plain attributes.

    The instance's `__dict__` holds variables and state, all of it and nothing else; the slots hold what belongs to
    the component in its host.
    """

    __slots__ = (
        "__dict__",
        "instance_name",
        "start_time",
        "messages",
        "_in_binary",
        "_initialised",
        "_initialising",
        "_stale",
        "_time",
        "__weakref__",
    )

    variables: ClassVar[tuple[Variable, ...]] = ()
    groups: ClassVar[tuple[Parameters, ...]] = ()
    newest: ClassVar[Any] = (
        None  # refers to the instance that the binary made last, for a master in this process
    )

    def start(self) -> None:
        """Set state and outputs for the start; see `Fmu`."""

    def step(self, t: float, h: float) -> None:
        """Advance from t to t + h; see `Fmu`."""
        raise NotImplementedError

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        # Access by value references, for each type of FMI.
        cls._real, cls._integer, cls._boolean, cls._string = (
            Access(cls.variables, kind) for kind in ("Real", "Integer", "Boolean", "String")
        )
        # Real outputs are checked after each step; a prepared getter makes this fast.
        cls._real_outputs = tuple(
            v.name for v in cls.variables if v.causality == "output" and v.type == "Real"
        )
        cls._real_output_values = staticmethod(getter(cls._real_outputs))
        cls._starts = {variable.name: variable.start for variable in cls.variables}

    def __init__(self, instance_name: str = "", *, resources: str = "", **_: Any):
        self.instance_name = instance_name or type(self).__name__
        self.start_time = self._time = 0.0
        self.messages: list[Message] = []
        self._in_binary = bool(resources)
        if resources:
            Fmi2Slave.newest = weakref.ref(self)
        self._initialising = self._initialised = self._stale = False
        self.__dict__.update(self._starts)

    # life cycle

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        self.start_time = self._time = start_time

    def enter_initialization_mode(self) -> None:
        self._initialising = self._stale = True

    @_guarded
    def exit_initialization_mode(self) -> None:
        if self._stale:
            self._start()
        self._initialising = False
        self._initialised = True

    def advance(self, time: float, step_size: float) -> bool:
        """`do_step` for a master in this process; errors as in `real_setter`."""
        self._time = time
        self.step(time, step_size)
        self._time = time + step_size
        self._check_outputs()
        return True

    do_step = _guarded(advance)

    def terminate(self) -> None:
        pass

    # values

    @_guarded
    def set_real(self, references: Sequence[int], values: Sequence[float]) -> None:
        variables = self._real[tuple(references)]
        # One check of the sum is fast; the culprit is searched only if it fails.
        if not math.isfinite(sum(values)):
            refuse_not_finite_inputs(self.variables, variables.names, values)
        self._set(variables, values)

    @_guarded
    def set_integer(self, references: Sequence[int], values: Sequence[int]) -> None:
        self._set(self._integer[tuple(references)], values)

    @_guarded
    def set_boolean(self, references: Sequence[int], values: Sequence[bool]) -> None:
        self._set(self._boolean[tuple(references)], values)

    @_guarded
    def set_string(self, references: Sequence[int], values: Sequence[str]) -> None:
        self._set(self._string[tuple(references)], values)

    @_guarded
    def get_real(self, references: Sequence[int]) -> list[float]:
        return list(self._get(self._real[tuple(references)]))

    @_guarded
    def get_integer(self, references: Sequence[int]) -> list[int]:
        variables = self._integer[tuple(references)]
        return [
            whole_number(name, value)
            for name, value in zip(variables.names, self._get(variables), strict=True)
        ]

    @_guarded
    def get_boolean(self, references: Sequence[int]) -> list[bool]:
        return [bool(value) for value in self._get(self._boolean[tuple(references)])]

    @_guarded
    def get_string(self, references: Sequence[int]) -> list[str]:
        return [str(value) for value in self._get(self._string[tuple(references)])]

    def real_setter(self, references: tuple[int, ...]) -> Callable[[Sequence[float]], None]:
        """`set_real` for the same variables at every call, for a master in this process.

        Errors are raised as they are; `failure` turns them into those of `set_real`. The same in
        `prepared_getter`.
        """
        # Everything that does not change between calls is looked up once.
        variables = self._real[references]
        put = self.__dict__.update
        names = variables.names
        fixed = variables.fixed
        isfinite = math.isfinite

        def set_values(values: Sequence[float]) -> None:
            if not isfinite(sum(values)):
                refuse_not_finite_inputs(self.variables, names, values)
            if fixed and self._initialised:
                self._refuse(variables)
            if self._initialising:
                self._stale = self._stale or _differ(self, variables, values)
            put(zip(names, values, strict=True))

        return set_values

    def prepared_getter(self, kind: str, references: tuple[int, ...]) -> Callable[[], Sequence]:
        """`get_real`, `get_integer` or `get_boolean` for the same variables at every call."""
        # As in `real_setter`, look up once what does not change.
        variables = getattr(self, f"_{kind.lower()}")[references]
        values = self.__dict__
        take = variables.values
        names = variables.names

        def get_values() -> tuple:
            if self._stale:
                self._start()
            return take(values)

        def get_integers() -> list[int]:
            return [
                whole_number(name, value) for name, value in zip(names, get_values(), strict=True)
            ]

        def get_booleans() -> tuple[bool, ...]:
            return tuple(map(bool, get_values()))

        return {"Real": get_values, "Integer": get_integers, "Boolean": get_booleans}[kind]

    def _set(self, variables: Found, values: Sequence) -> None:
        # Fixed parameters may be set before the run only.
        if variables.fixed and self._initialised:
            self._refuse(variables)
        # A changed value during initialisation makes the start outdated.
        self._stale = self._initialising and (self._stale or _differ(self, variables, values))
        self.__dict__.update(zip(variables.names, values, strict=True))

    def _refuse(self, variables: Found) -> None:
        raise FmuError(f"parameter '{variables.fixed}' is fixed, it can only be set before the run")

    def _get(self, variables: Found) -> tuple:
        if self._stale:
            self._start()
        return variables.values(self.__dict__)

    # state

    @_guarded
    def _get_fmu_state(self) -> State:
        phase = self._time, self._initialising, self._initialised, self._stale
        return State(self, (phase, copy.deepcopy(self.__dict__)))

    @_guarded
    def _set_fmu_state(self, stored: State | FmuError) -> None:
        if isinstance(stored, FmuError):
            raise stored
        # Deep copies: the stored state must not change with the running FMU.
        phase, values = stored.content
        self._time, self._initialising, self._initialised, self._stale = phase
        self.__dict__.clear()
        self.__dict__.update(copy.deepcopy(values))

    @classmethod
    def _fmu_state_to_bytes(cls, stored: State) -> bytes:
        try:
            return state.to_bytes(stored.content, cls.__module__, cls._packages())
        except Exception as error:
            raise stored.owner.failure(FmuError(f"the state cannot be stored: {error}")) from None

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> State | FmuError:
        """The state, or an error: without an instance, an exception would crash the binary."""
        try:
            return State(None, state.from_bytes(data, cls.__module__, cls._packages()))
        except Exception as error:
            return FmuError(f"the state cannot be restored: {error}")

    @classmethod
    def _packages(cls) -> set[str]:
        return {cls.__module__.partition(".")[0], __name__.partition(".")[0]}

    # messages

    def _get_log_queue(self) -> list[Message]:
        return self.messages

    def log(self, message: str, status: str = "ok") -> None:
        """Send a message to the log of the host.

        Parameters
        ----------
        message : str
            Text.
        status : str
            "ok", "warning" or "error"; none of them stops the run, an exception does.
        """
        self.messages.append(
            message_of(f"{self.instance_name} at t = {self._time:.9g} s: {message}", status)
        )

    def failure(self, error: BaseException) -> FmuError:
        """Error to raise in place of another: component, time, earlier messages, traceback."""
        text = f"{self.instance_name} at t = {self._time:.9g} s: {text_of(error)}"
        # The binary loses its queue after an exception, so the messages go into the error.
        if self._in_binary:
            text = "\n".join([*(message.msg.replace("%%", "%") for message in self.messages), text])
            self.messages.clear()
            keep(type(self), self, self.messages)
        return FmuError(text)

    # checks

    def _start(self) -> None:
        # All missing or impossible parameters in one message.
        values = self.__dict__
        parameters = [variable for variable in self.variables if variable.causality == "parameter"]
        missing = [
            variable for variable in parameters if variable.is_left_out(values[variable.name])
        ]
        problems = [text_of_left_out(missing)] if missing else []
        for variable in parameters:
            if variable not in missing and (problem := variable.outside(values[variable.name])):
                problems.append(f"parameter '{variable.name}' is {problem}")
        if problems:
            raise FmuError("; ".join(problems))
        # Outputs at the start must be finite, as after a step.
        self.start()
        self._stale = False
        self._check_outputs()

    def _check_outputs(self) -> None:
        values = self.__dict__
        # One check of the sum is fast; the culprit is searched only if it fails.
        try:
            if math.isfinite(sum(self._real_output_values(values))):
                return
        except (KeyError, TypeError, ValueError):
            pass
        refuse_not_finite_outputs(self._real_outputs, values)
