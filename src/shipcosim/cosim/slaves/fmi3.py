"""FMUs of FMI 3.0 for co-simulation: all types, arrays by their elements.

FMI knows an array only as a whole. An element that is set takes the rest of its array with it, as it was set before or
as the FMU starts it. Event mode and early return are not used, so that clocks do not tick.

Reference: FMI 3.0.1, sections 2.2 and 4.
"""

from collections.abc import Sequence
from ctypes import byref, c_bool, c_char_p, c_double, c_size_t, c_ubyte, c_uint, c_void_p, cast
from functools import partial
from math import prod
from typing import Any

import numpy as np

from shipcosim.cosim.slaves.library_slave import LibrarySlave
from shipcosim.cosim.slaves.slave import DISCARD, FAILED, OK, Call, RunEnded, Step, Variables

TYPES = {
    "Float64": np.float64,
    "Float32": np.float32,
    "Boolean": np.bool_,
    "Enumeration": np.int64,
    **{
        f"{sign}Int{bits}": np.dtype(f"{sign.lower()}int{bits}")
        for sign in ("", "U")
        for bits in (8, 16, 32, 64)
    },
}


class Slave3(LibrarySlave):
    """An instance of an FMU of FMI 3.0 for co-simulation."""

    _prefix = "fmi3"
    _state_calls = {
        "get": "GetFMUState",
        "set": "SetFMUState",
        "free": "FreeFMUState",
        "size": "SerializedFMUStateSize",
        "serialise": "SerializeFMUState",
        "deserialise": "DeserializeFMUState",
    }

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        # FMI 3.0 has a call for each type, so group the variables by type once.
        groups = list(self._type_groups("Set", variables, buffer.dtype))

        def set_all():
            for group in groups:
                # Check the range before narrowing: a cast would wrap silently.
                values = buffer[group.rows]
                status = (
                    self.status_of_range(values, group.values.dtype, group.variables)
                    if group.narrows
                    else None
                )
                if status is not None:
                    return status
                # Setting an element sets the whole array: the other elements keep what was set
                # last.
                self._load_arrays(group)
                group.values[group.positions] = values
                for variable, first in group.arrays:
                    self._array_values[variable.value_reference] = group.values[
                        first : first + _size(variable)
                    ].copy()
                if (status := group.call()) >= FAILED:
                    return status
            return OK

        return set_all

    def getter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        groups = list(self._type_groups("Get", variables, buffer.dtype))

        def get_all():
            for group in groups:
                if (status := group.call()) >= FAILED:
                    return status
                values = group.values[group.positions]
                status = (
                    self.status_of_range(values, buffer.dtype, group.variables)
                    if group.narrows
                    else None
                )
                if status is not None:
                    return status
                buffer[group.rows] = values
            return OK

        return get_all

    def stepper(self) -> Step:
        """Prepared call that advances from a time by a step size and returns the status."""
        do_step = self._function("DoStep")
        event = c_bool()
        terminate = c_bool()
        early = c_bool()
        reached = c_double()
        results = byref(event), byref(terminate), byref(early), byref(reached)

        def step(time, step_size):
            status = do_step(self.component, time, step_size, True, *results)
            if status <= DISCARD and terminate.value:
                raise RunEnded
            # Event mode and early return are not used: a step that returns early is not done.
            return DISCARD if status < FAILED and early.value else status

        return step

    def get_strings(self, variables: Variables) -> list[str] | list[bytes]:
        """Values of String variables, or of Binary ones."""
        layout = ArrayLayout(variables)
        texts = (c_char_p * layout.n)()
        # Binary values are pointers and sizes; copy them, since the FMU owns the memory.
        if variables[0].kind == "Binary":
            sizes = (c_size_t * layout.n)()
            data = (c_void_p * layout.n)()
            self._call_binary("GetBinary", layout, sizes, data)
            values = [
                bytes((c_ubyte * n).from_address(at)) if n else b""
                for n, at in zip(sizes, data, strict=True)
            ]
            return [values[position] for position in layout.positions]
        self.call("GetString", layout.references, len(layout.references), texts, layout.n)
        return [(texts[position] or b"").decode() for position in layout.positions]

    def set_strings(self, variables: Variables, values: Sequence) -> None:
        """Set String variables, or Binary ones."""
        layout = ArrayLayout(variables)
        is_binary = variables[0].kind == "Binary"
        # All elements of the arrays as set last, with the new ones in place.
        whole: list[Any] = [
            value for variable in layout.variables for value in self._present_texts(variable)
        ]
        for position, value in zip(layout.positions, values, strict=True):
            whole[position] = value
        for variable, first in zip(layout.variables, layout.offsets, strict=True):
            self._array_values[variable.value_reference] = whole[first : first + _size(variable)]
        if is_binary:
            # Keep the buffers alive until the call is made; an empty value still needs an address.
            data = [
                (c_ubyte * max(len(value), 1)).from_buffer_copy(value or b"\0") for value in whole
            ]
            pointers = (c_void_p * layout.n)(
                *(cast(pointer_to, c_void_p).value for pointer_to in data)
            )
            self._call_binary(
                "SetBinary", layout, (c_size_t * layout.n)(*map(len, whole)), pointers
            )
        else:
            texts = (c_char_p * layout.n)(*(value.encode() for value in whole))
            self.call("SetString", layout.references, len(layout.references), texts, layout.n)

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times."""
        self.call("EnterInitializationMode", False, 0.0, start_time, True, stop_time)

    def reset(self) -> None:
        """Bring the instance back to where it was when it was made."""
        super().reset()
        self._array_values.clear()

    def _call_binary(self, name, layout, sizes, data):
        function = self._function(name)
        arguments = cast(sizes, function.argtypes[3]), cast(data, function.argtypes[4])
        self.call(name, layout.references, len(layout.references), *arguments, layout.n)

    def _present_texts(self, variable):
        """Values that a String or Binary variable was set to last, one for each element."""
        empty = b"" if variable.kind == "Binary" else ""
        return self._array_values.get(variable.value_reference) or _start_values(variable, empty)

    def _type_groups(self, verb, variables, kind):
        """For each FMI type among the variables: their rows and the prepared call."""
        for name in dict.fromkeys(variable.type for variable in variables):
            rows = np.array([i for i, variable in enumerate(variables) if variable.type == name])
            of_type = [variables[row] for row in rows]
            function = self._function(f"{verb}{'Int64' if name == 'Enumeration' else name}")
            group = TypeGroup(self.component, function, of_type, rows, TYPES[name])
            # A cast narrows on the way to the FMU (Set) or to the run (Get). Only then must values
            # be checked.
            ways = (kind, group.values.dtype) if verb == "Set" else (group.values.dtype, kind)
            group.narrows = name != "Boolean" and not np.can_cast(*ways)
            yield group

    def _load_arrays(self, group):
        for variable, first in group.arrays:
            kept = self._array_values.get(variable.value_reference)
            values = _start_values(variable, 0) if kept is None else kept
            group.values[first : first + len(values)] = values

    def _instantiate(self):
        self._array_values = {}  # values that arrays were set to, by value reference
        self._fmu.instantiate(
            loggingOn=True,
            logMessage=lambda environment, status, category, text: self.log_message(status, text),
        )


class ArrayLayout:
    """Places of variables' values in a call that takes whole arrays.

    Parameters
    ----------
    variables : sequence of Variable
        Scalars and elements of arrays.

    Attributes
    ----------
    variables, offsets : list of Variable, list of int
        Scalars and whole arrays, each once, and where the values of each begin.
    n : int
        Number of values in all.
    positions : list of int
        Where the value of each of the given variables lies.
    references : array of value references
        Of the scalars and whole arrays.
    """

    def __init__(self, variables: Variables):
        # An element stands for its whole array, once for all its elements.
        wholes: dict[int, Any] = {
            variable.value_reference: variable.whole or variable for variable in variables
        }
        sizes = [_size(whole) for whole in wholes.values()]
        self.variables = list(wholes.values())
        self.n = sum(sizes)
        self.offsets = [sum(sizes[:i]) for i in range(len(sizes))]
        # Place of each variable: begin of its array plus its own place in it.
        begin = dict(zip(wholes, self.offsets, strict=True))
        self.positions = [
            begin[variable.value_reference] + variable.place for variable in variables
        ]
        self.references = (c_uint * len(wholes))(*wholes)


class TypeGroup:
    """Variables of one type of FMI 3.0 and the prepared call that gets or sets them.

    Parameters
    ----------
    component : pointer
        The FMU's instance.
    function : ctypes function
        Of the FMU's library.
    variables : sequence of Variable
        Of one type.
    rows : (m,) array of int
        Their rows in the buffer of the run.
    dtype : type
        NumPy's type for that of the FMU.

    Attributes
    ----------
    values : (n,) array
        Values as the FMU has them, arrays as a whole.
    positions : (m,) array of int
        Where the values of `rows` lie in `values`.
    arrays : list of (Variable, int)
        Arrays among them and where their values begin.
    narrows : bool
        Whether the values go into a type that cannot hold all of them.
    """

    narrows = False

    def __init__(
        self,
        component: Any,
        function: Any,
        variables: Variables,
        rows: np.ndarray,
        dtype: Any,
    ):
        layout = ArrayLayout(variables)
        self.variables = variables
        self.rows = rows
        self.positions = np.array(layout.positions)
        self.values = np.zeros(layout.n, dtype=dtype)
        self.arrays = [
            pair
            for pair in zip(layout.variables, layout.offsets, strict=True)
            if pair[0].dimensions
        ]
        values = cast(self.values.ctypes.data, function.argtypes[3])
        self.call = partial(
            function, component, layout.references, len(layout.references), values, layout.n
        )


def _size(variable):
    return prod(variable.dimensions)


def _start_values(variable, empty):
    """Start values of all elements of a variable, from the description."""
    # One start value may stand for all elements.
    start = variable.start if isinstance(variable.start, tuple) else (variable.start,)
    start = start if len(start) == _size(variable) else start[:1] * _size(variable)
    return [empty if value is None else value for value in start]
