"""The side of the shell that pythonfmu's binary calls. Writers of FMUs need `Fmu` only.

The binary looks for a class that has a base class named `Fmi2Slave`, makes an instance per component and calls the
methods below. It reports the `repr` of what they raise, and the queue of messages after every call that succeeds.
"""

import copy
import math
import operator
import os
import traceback
from pathlib import Path
from typing import NamedTuple

from . import state

CODE = Path(__file__).parents[2]
SHELL = str(Path(__file__).parent)
STATUSES = ("ok", "warning", "discard", "error", "fatal")


class FmuError(Exception):
    """Why an FMU cannot go on, in words for its user. The host's logger takes its text for a printf format."""

    def __repr__(self):
        return str(self).replace("%", "%%")


class Message(NamedTuple):
    """What the binary hands to the host's logger; its text is a printf format."""

    status: int
    category: str
    msg: str
    debug: bool = False


class _Access(dict):
    """Names behind a call's value references, found once per combination: references -> (names, fixed parameter or "")."""

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
        self[references] = tuple(variable.name for variable in found), fixed[0] if fixed else ""
        return self[references]


class Fmi2Slave:
    """FMI 2.0 co-simulation on an object that keeps its variables and its state as plain attributes.

    The instance's `__dict__` holds variables and state, all of it and nothing else; the slots hold what belongs to
    the component in its host.
    """

    __slots__ = ("__dict__", "instance_name", "start_time", "messages", "_initialising", "_initialised", "_stale")

    variables = ()
    groups = ()

    def __init_subclass__(cls, **kwargs):
        super().__init_subclass__(**kwargs)
        cls._real, cls._integer, cls._boolean, cls._string = (
            _Access(cls.variables, kind) for kind in ("Real", "Integer", "Boolean", "String")
        )
        cls._real_outputs = tuple(v.name for v in cls.variables if v.causality == "output" and v.type == "Real")
        cls._starts = {variable.name: variable.start for variable in cls.variables}

    def __init__(self, instance_name="", **_):
        self.instance_name = instance_name or type(self).__name__
        self.start_time = 0.0
        self.messages = []
        self._initialising = self._initialised = self._stale = False
        self.__dict__.update(self._starts)

    # life

    def setup_experiment(self, start_time, stop_time=None, tolerance=None):
        self.start_time = start_time

    def enter_initialization_mode(self):
        self._initialising = self._stale = True

    def exit_initialization_mode(self):
        if self._stale:
            self._start()
        self._initialising, self._initialised = False, True

    def do_step(self, time, step_size):
        try:
            self.step(time, step_size)
        except Exception as error:
            raise self._failure(error, f"in the step from t = {time:.9g} s to {time + step_size:.9g} s") from None
        self._check_outputs(time + step_size)
        return True

    def terminate(self):
        pass

    # values

    def set_real(self, references, values):
        names, fixed = self._real[tuple(references)]
        if not math.isfinite(sum(values)):
            self._check_finite(names, values)
        self._set(names, fixed, values)

    def set_integer(self, references, values):
        self._set(*self._integer[tuple(references)], values)

    def set_boolean(self, references, values):
        self._set(*self._boolean[tuple(references)], values)

    def set_string(self, references, values):
        self._set(*self._string[tuple(references)], values)

    def get_real(self, references):
        return self._get(self._real[tuple(references)][0])

    def get_integer(self, references):
        names = self._integer[tuple(references)][0]
        return [self._integer_value(name, value) for name, value in zip(names, self._get(names), strict=True)]

    def get_boolean(self, references):
        return [bool(value) for value in self._get(self._boolean[tuple(references)][0])]

    def get_string(self, references):
        return [str(value) for value in self._get(self._string[tuple(references)][0])]

    def _set(self, names, fixed, values):
        if fixed and self._initialised:
            raise FmuError(f"{self.instance_name}: parameter '{fixed}' is fixed, it can only be set before the run")
        self.__dict__.update(zip(names, values))  # noqa: B905, both come from one call
        self._stale = self._initialising

    def _get(self, names):
        if self._stale:
            self._start()
        values = self.__dict__
        return [values[name] for name in names]

    # state

    def _get_fmu_state(self):
        return self._initialising, self._initialised, self._stale, copy.deepcopy(self.__dict__)

    def _set_fmu_state(self, stored):
        self._initialising, self._initialised, self._stale, values = stored
        self.__dict__.clear()
        self.__dict__.update(copy.deepcopy(values))

    @classmethod
    def _fmu_state_to_bytes(cls, stored):
        return state.to_bytes(stored, cls.__module__, cls._packages())

    @classmethod
    def _fmu_state_from_bytes(cls, data):
        return state.from_bytes(data, cls.__module__, cls._packages())

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
        text = f"{self.instance_name}: {message}".replace("%", "%%")
        self.messages.append(Message(STATUSES.index(status), f"logStatus{status.capitalize()}", text))

    # checks

    def _start(self):
        problems = [
            f"parameter '{v.name}' is {problem}"
            for v in self.variables
            if v.causality == "parameter" and (problem := v.outside(self.__dict__[v.name]))
        ]
        if problems:
            raise FmuError(f"{self.instance_name}: {'; '.join(problems)}")
        try:
            self.start()
        except Exception as error:
            raise self._failure(error, f"at the start, t = {self.start_time:.9g} s") from None
        self._stale = False
        self._check_outputs(self.start_time)

    def _check_outputs(self, time):
        values = self.__dict__
        try:
            if math.isfinite(sum([values[name] for name in self._real_outputs])):
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
                text = f"output '{name}' is {value!r} at t = {time:.9g} s, not a finite number"
                raise FmuError(f"{self.instance_name}: {text}")

    def _check_finite(self, names, values):
        kinds = {variable.name: variable.causality for variable in self.variables}
        for name, value in zip(names, values, strict=True):
            if not math.isfinite(value):
                raise FmuError(f"{self.instance_name}: {kinds[name]} '{name}' was set to {value}, not a finite number")

    def _integer_value(self, name, value):
        try:
            value = operator.index(value)
        except TypeError:
            raise FmuError(f"{self.instance_name}: '{name}' is {value!r}, not a whole number") from None
        if not -(2**31) <= value < 2**31:
            raise FmuError(f"{self.instance_name}: '{name}' is {value}, which FMI's 32-bit integers cannot hold")
        return value

    def _failure(self, error, when):
        """The error to raise for an exception in the writer's code: whose, when, and its traceback below the shell."""
        trace = error.__traceback__
        while trace.tb_next and trace.tb_frame.f_code.co_filename.startswith(SHELL):
            trace = trace.tb_next
        lines = "".join(traceback.format_exception(type(error), error, trace)).rstrip()
        return FmuError(f"{self.instance_name}: exception {when}\n{lines.replace(str(CODE) + os.sep, '')}")
