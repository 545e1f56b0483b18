"""One running instance of an FMU of FMI 3.0 for co-simulation: all types, arrays by their elements.

FMI knows an array only as a whole. An element that is set takes the rest of its array with it, as it was set before or
as the FMU starts it. Event mode and early return are not used, so that clocks do not tick.

Reference: FMI 3.0.1, sections 2.2 and 4.
"""

from collections.abc import Callable, Sequence
from ctypes import byref, c_bool, c_char_p, c_double, c_size_t, c_ubyte, c_uint, c_void_p, cast
from functools import partial
from math import prod

import numpy as np

from shipcosim.cosim.slaves.fmi2 import DISCARD, FAILED, OK, Slave
from shipcosim.ssp import Variable

TYPES = {
    "Float64": np.float64,
    "Float32": np.float32,
    "Boolean": np.bool_,
    "Enumeration": np.int64,
    **{f"{sign}Int{bits}": np.dtype(f"{sign.lower()}int{bits}") for sign in ("", "U") for bits in (8, 16, 32, 64)},
}


class Slave3(Slave):
    """An instance of an FMU of FMI 3.0."""

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
        groups = list(self._groups("Set", variables, buffer.dtype))

        def set_all():
            for group in groups:
                values = buffer[group.rows]
                status = self.refuse_outside(values, group.own.dtype, group.variables) if group.narrows else None
                if status is not None:
                    return status
                self._recall(group)
                group.own[group.places] = values
                self._remember(group)
                if (status := group.call()) >= FAILED:
                    return status
            return OK

        return set_all

    def getter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        groups = list(self._groups("Get", variables, buffer.dtype))

        def get_all():
            for group in groups:
                if (status := group.call()) >= FAILED:
                    return status
                values = group.own[group.places]
                status = self.refuse_outside(values, buffer.dtype, group.variables) if group.narrows else None
                if status is not None:
                    return status
                buffer[group.rows] = values
            return OK

        return get_all

    def stepper(self) -> Callable[[float, float], int]:
        """Prepared call that advances from a time by a step size and returns the status."""
        do_step, event, terminate, early, reached = self._function("DoStep"), c_bool(), c_bool(), c_bool(), c_double()
        results = byref(event), byref(terminate), byref(early), byref(reached)

        def step(time, step_size):
            status = do_step(self.component, time, step_size, True, *results)
            return DISCARD if status < FAILED and (terminate.value or early.value) else status

        return step

    def get_strings(self, variables: Sequence) -> list[str] | list[bytes]:
        """Values of String variables, or of Binary ones."""
        places = Places(variables)
        texts = (c_char_p * places.n)()
        if variables[0].kind == "Binary":
            sizes, data = (c_size_t * places.n)(), (c_void_p * places.n)()
            self._call_texts("GetBinary", places, sizes, data)
            values = [bytes((c_ubyte * n).from_address(at)) if n else b"" for n, at in zip(sizes, data, strict=True)]
        else:
            self.call("GetString", places.references, len(places.references), texts, places.n)
            values = [(text or b"").decode() for text in texts]
        return [values[place] for place in places.of]

    def set_strings(self, variables: Sequence, values: Sequence) -> None:
        """Set String variables, or Binary ones."""
        places, is_binary = Places(variables), variables[0].kind == "Binary"
        whole = [value for variable in places.wholes for value in self._texts(variable)]
        for place, value in zip(places.of, values, strict=True):
            whole[place] = value
        for variable, first in zip(places.wholes, places.firsts, strict=True):
            self._kept[variable.value_reference] = whole[first : first + _size(variable)]
        if is_binary:
            data = [(c_ubyte * max(len(value), 1)).from_buffer_copy(value or b"\0") for value in whole]
            pointers = (c_void_p * places.n)(*(cast(one, c_void_p).value for one in data))
            self._call_texts("SetBinary", places, (c_size_t * places.n)(*map(len, whole)), pointers)
        else:
            texts = (c_char_p * places.n)(*(value.encode() for value in whole))
            self.call("SetString", places.references, len(places.references), texts, places.n)

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self.call("EnterInitializationMode", False, 0.0, start_time, True, stop_time)

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made."""
        super().reset()
        self._kept.clear()

    def _call_texts(self, name, places, sizes, data):
        function = self._function(name)
        arguments = cast(sizes, function.argtypes[3]), cast(data, function.argtypes[4])
        self.call(name, places.references, len(places.references), *arguments, places.n)

    def _texts(self, variable):
        """Present values of a String or Binary variable, one for each element."""
        empty = b"" if variable.kind == "Binary" else ""
        return self._kept.get(variable.value_reference) or _starts(variable, empty)

    def _groups(self, verb, variables, kind):
        """For each of the FMU's types among the variables: their rows and the prepared call."""
        for name in dict.fromkeys(variable.type for variable in variables):
            rows = np.array([i for i, variable in enumerate(variables) if variable.type == name])
            of_type = [variables[row] for row in rows]
            function = self._function(f"{verb}{'Int64' if name == 'Enumeration' else name}")
            group = Group(self.component, function, of_type, rows, TYPES[name])
            ways = (kind, group.own.dtype) if verb == "Set" else (group.own.dtype, kind)
            group.narrows = name != "Boolean" and not np.can_cast(*ways)
            yield group

    def _recall(self, group):
        for variable, first in group.arrays:
            kept = self._kept.get(variable.value_reference)
            values = _starts(variable, 0) if kept is None else kept
            group.own[first : first + len(values)] = values

    def _remember(self, group):
        for variable, first in group.arrays:
            self._kept[variable.value_reference] = group.own[first : first + _size(variable)].copy()

    @staticmethod
    def _load(**arguments):
        from fmpy.fmi3 import FMU3Slave

        return FMU3Slave(**arguments)

    def _instantiate(self):
        self._kept = {}  # values that arrays were set to, by value reference
        self._fmu.instantiate(
            loggingOn=True, logMessage=lambda environment, status, category, text: self._log(status, text)
        )


class Places:
    """Where the values of variables lie in a call that takes whole arrays.

    Attributes
    ----------
    wholes, firsts : list of Variable, list of int
        Scalars and arrays, each once, and where the values of each begin.
    n : int
        Number of values in all.
    of : list of int
        Where the value of each variable lies.
    references : array of value references
    """

    def __init__(self, variables: Sequence[Variable]):
        wholes = {variable.value_reference: variable.whole or variable for variable in variables}
        sizes = [_size(whole) for whole in wholes.values()]
        self.wholes, self.n = list(wholes.values()), sum(sizes)
        self.firsts = [sum(sizes[:i]) for i in range(len(sizes))]
        begin = dict(zip(wholes, self.firsts, strict=True))
        self.of = [begin[variable.value_reference] + variable.place for variable in variables]
        self.references = (c_uint * len(wholes))(*wholes)


class Group:
    """Variables of one type of FMI 3.0 and the prepared call that gets or sets them.

    Attributes
    ----------
    own : (n,) array
        Values as the FMU has them, arrays as a whole.
    rows, places : (m,) array of int
        Rows in the buffer of the run, and where the same values lie in `own`.
    arrays : list of (Variable, first place)
    narrows : bool
        Whether the values go into a type that cannot hold all of them.
    """

    narrows = False

    def __init__(self, component, function, variables, rows, kind):
        found = Places(variables)
        self.variables, self.rows, self.places = variables, rows, np.array(found.of)
        self.own = np.zeros(found.n, dtype=kind)
        self.arrays = [pair for pair in zip(found.wholes, found.firsts, strict=True) if pair[0].dimensions]
        values = cast(self.own.ctypes.data, function.argtypes[3])
        self.call = partial(function, component, found.references, len(found.references), values, found.n)


def _size(variable):
    return prod(variable.dimensions)


def _starts(variable, empty):
    """Start values of all elements of a variable, as the FMU gives them."""
    start = variable.start if isinstance(variable.start, tuple) else (variable.start,)
    start = start if len(start) == _size(variable) else start[:1] * _size(variable)
    return [empty if value is None else value for value in start]
