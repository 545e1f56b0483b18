"""The side of the shell that pythonfmu's binary calls. Writers of FMUs need `Fmu` only.

The binary looks for a class that has a base class named `Fmi2Slave`, makes an instance per component and calls the
methods below. It logs the `repr` of what they raise with status fatal, and the queue of messages after other calls.
"""

import copy
import functools
import math
import operator
import os
import traceback
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from shipcosim.fmi import state
from shipcosim.fmi.pythonfmu_memory import keep

CODE = Path(__file__).parents[2]
SHELL = str(Path(__file__).parent)
STATUSES = ("ok", "warning", "discard", "error")


class FmuError(Exception):
    """Why an FMU cannot go on, in words for its user. The host's logger takes its text for a printf format."""

    def __repr__(self):
        return str(self).replace("%", "%%")


class Message(NamedTuple):
    """What the binary hands to the host's logger; its text is a printf format."""

    status: int
    category: str
    msg: str


class State(NamedTuple):
    """What the host holds as FMU state. The owner is not part of it."""

    owner: object
    content: tuple


class _Found(NamedTuple):
    """Names of variables, a fixed parameter among them or "", and what takes their values from a mapping as tuple."""

    names: tuple
    fixed: str
    values: Callable


class _Access(dict):
    """Variables behind a call's value references."""

    def __init__(self, variables, kind):
        super().__init__()
        self.variables, self.kind = variables, kind

    def __missing__(self, references):
        found = []
        for reference in references:
            if not 0 <= reference < len(self.variables) or self.variables[reference].type != self.kind:
                raise FmuError(f"there is no {self.kind} variable with value reference {reference}")
            found.append(self.variables[reference])
        fixed = [variable.name for variable in found if variable.causality == "parameter" and not variable.tunable]
        names = tuple(variable.name for variable in found)
        self[references] = _Found(names, fixed[0] if fixed else "", _getter(names))
        return self[references]


def _getter(names):
    """Function that takes the values of these names from a mapping, as a tuple."""
    if len(names) == 1:
        (name,) = names
        return lambda values: (values[name],)
    return operator.itemgetter(*names) if names else lambda values: ()


def _guarded(method):
    """Whatever a method raises reaches the binary as an `FmuError` that names component and time."""

    @functools.wraps(method)
    def call(self, *arguments):
        try:
            return method(self, *arguments)
        except BaseException as error:
            raise self.failure(error) from None

    return call


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

    variables = ()
    groups = ()
    newest = None  # refers to the instance that the binary made last: a master in this process can call it directly

    def __init_subclass__(cls, **kwargs):
        super().__init_subclass__(**kwargs)
        cls._real, cls._integer, cls._boolean, cls._string = (
            _Access(cls.variables, kind) for kind in ("Real", "Integer", "Boolean", "String")
        )
        cls._real_outputs = tuple(v.name for v in cls.variables if v.causality == "output" and v.type == "Real")
        cls._real_output_values = staticmethod(_getter(cls._real_outputs))
        cls._starts = {variable.name: variable.start for variable in cls.variables}

    def __init__(self, instance_name="", *, resources="", **_):
        self.instance_name = instance_name or type(self).__name__
        self.start_time = self._time = 0.0
        self.messages = []
        self._in_binary = bool(resources)
        if resources:
            Fmi2Slave.newest = weakref.ref(self)
        self._initialising = self._initialised = self._stale = False
        self.__dict__.update(self._starts)

    # life

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        self.start_time = self._time = start_time

    def enter_initialization_mode(self):
        self._initialising = self._stale = True

    @_guarded
    def exit_initialization_mode(self):
        if self._stale:
            self._start()
        self._initialising, self._initialised = False, True

    @_guarded
    def do_step(self, time, step_size):
        self._time = time
        self.step(time, step_size)
        self._time = time + step_size
        self._check_outputs()
        return True

    def terminate(self):
        pass

    # values

    @_guarded
    def set_real(self, references, values):
        found = self._real[tuple(references)]
        if not math.isfinite(sum(values)):
            self._check_finite(found.names, values)
        self._set(found, values)

    @_guarded
    def set_integer(self, references, values):
        self._set(self._integer[tuple(references)], values)

    @_guarded
    def set_boolean(self, references, values):
        self._set(self._boolean[tuple(references)], values)

    @_guarded
    def set_string(self, references, values):
        self._set(self._string[tuple(references)], values)

    @_guarded
    def get_real(self, references):
        return list(self._get(self._real[tuple(references)]))

    @_guarded
    def get_integer(self, references):
        found = self._integer[tuple(references)]
        return [_integer(name, value) for name, value in zip(found.names, self._get(found), strict=True)]

    @_guarded
    def get_boolean(self, references):
        return [bool(value) for value in self._get(self._boolean[tuple(references)])]

    @_guarded
    def get_string(self, references):
        return [str(value) for value in self._get(self._string[tuple(references)])]

    def real_setter(self, references):
        """`set_real` for the same variables every time, for a master in this process that can call it by itself.

        What goes wrong is raised as it is; `failure` turns it into what `set_real` raises. The same holds for
        `real_getter`.
        """
        found, put = self._real[references], self.__dict__.update

        def set_values(values):
            if not math.isfinite(sum(values)):
                self._check_finite(found.names, values)
            if found.fixed and self._initialised:
                self._refuse(found)
            put(zip(found.names, values, strict=True))
            self._stale = self._initialising

        return set_values

    def real_getter(self, references):
        """`get_real` for the same variables every time; see `real_setter`."""
        take, values = self._real[references].values, self.__dict__

        def get_values():
            if self._stale:
                self._start()
            return take(values)

        return get_values

    def _set(self, found, values):
        if found.fixed and self._initialised:
            self._refuse(found)
        self.__dict__.update(zip(found.names, values, strict=True))
        self._stale = self._initialising

    def _refuse(self, found):
        raise FmuError(f"parameter '{found.fixed}' is fixed, it can only be set before the run")

    def _get(self, found):
        if self._stale:
            self._start()
        return found.values(self.__dict__)

    # state

    @_guarded
    def _get_fmu_state(self):
        phase = self._time, self._initialising, self._initialised, self._stale
        return State(self, (phase, copy.deepcopy(self.__dict__)))

    @_guarded
    def _set_fmu_state(self, stored):
        if isinstance(stored, FmuError):
            raise stored
        phase, values = stored.content
        self._time, self._initialising, self._initialised, self._stale = phase
        self.__dict__.clear()
        self.__dict__.update(copy.deepcopy(values))

    @classmethod
    def _fmu_state_to_bytes(cls, stored):
        try:
            return state.to_bytes(stored.content, cls.__module__, cls._packages())
        except Exception as error:
            raise stored.owner.failure(FmuError(f"the state cannot be stored: {error}")) from None

    @classmethod
    def _fmu_state_from_bytes(cls, data):
        """The state, or why there is none: an exception here, where no instance is known, would crash the binary."""
        try:
            return State(None, state.from_bytes(data, cls.__module__, cls._packages()))
        except Exception as error:
            return FmuError(f"the state cannot be restored: {error}")

    @classmethod
    def _packages(cls):
        return {cls.__module__.partition(".")[0], __name__.partition(".")[0]}

    # messages

    def _get_log_queue(self):
        return self.messages

    def log(self, message, status="ok"):
        """Tell the user something through the host's log.

        Parameters
        ----------
        message : str
            Text.
        status : str
            "ok", "warning" or "error"; none of them stops the run, an exception does.
        """
        text = f"{self.instance_name} at t = {self._time:.9g} s: {message}".replace("%", "%%")
        self.messages.append(Message(STATUSES.index(status), f"logStatus{status.capitalize()}", text))

    def failure(self, error):
        """The error to raise instead: whose and when, what was logged before, the traceback below the shell."""
        text = str(error) if isinstance(error, FmuError) else f"exception\n{_traceback(error)}"
        text = f"{self.instance_name} at t = {self._time:.9g} s: {text}"
        if self._in_binary:
            text = "\n".join([*(message.msg.replace("%%", "%") for message in self.messages), text])
            self.messages.clear()
            keep(type(self), self, self.messages)
        return FmuError(text)

    # checks

    def _start(self):
        values = self.__dict__
        parameters = [variable for variable in self.variables if variable.causality == "parameter"]
        problems = [(variable.name, variable.outside(values[variable.name])) for variable in parameters]
        if any(problem for _, problem in problems):
            raise FmuError("; ".join(f"parameter '{name}' is {problem}" for name, problem in problems if problem))
        self.start()
        self._stale = False
        self._check_outputs()

    def _check_outputs(self):
        values = self.__dict__
        try:
            if math.isfinite(sum(self._real_output_values(values))):
                return
        except (KeyError, TypeError, ValueError):
            pass
        for name in self._real_outputs:
            value = values.get(name)
            try:
                right = math.isfinite(value)
            except (TypeError, ValueError):
                right = False
            if not right:
                raise FmuError(f"output '{name}' is {value!r}, not a finite number")

    def _check_finite(self, names, values):
        kinds = {variable.name: variable.causality for variable in self.variables}
        for name, value in zip(names, values, strict=True):
            if not math.isfinite(value):
                raise FmuError(f"{kinds[name]} '{name}' was set to {value}, not a finite number")


def _integer(name, value):
    """A value as FMI's 32-bit integer."""
    try:
        whole = operator.index(value)
    except TypeError:
        raise FmuError(f"'{name}' is {value!r}, not a whole number") from None
    if not -(2**31) <= whole < 2**31:
        raise FmuError(f"'{name}' is {whole}, which FMI's 32-bit integers cannot hold")
    return whole


def _traceback(error):
    """Traceback as Python prints it, without frames of host and shell, files named from the FMU's own folder."""
    trace = error.__traceback__
    while trace.tb_next and not _is_fmus_own(trace.tb_frame.f_code.co_filename):
        trace = trace.tb_next
    lines = "".join(traceback.format_exception(type(error), error, trace)).rstrip()
    return lines.replace(str(CODE) + os.sep, "")


def _is_fmus_own(file):
    return file.startswith(str(CODE)) and not file.startswith(SHELL)
