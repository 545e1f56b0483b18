"""FMUs of our own shell, stepped without their C interface.

Such an FMU is an object in this very process: its binary turns C arrays into lists, calls a method of the object and
turns lists back into C arrays. Here the same methods are called with the same values in the same order. All else, from
the start to storing a state, goes through the binary.
"""

import struct
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

OK, FATAL = 0, 4


def object_of(folder: Path, name: str):
    """The object behind the instance made last of an unpacked FMU, or None where it has none of our shell's.

    The module that an FMU of ours enters by has a name unique to its content, so it does not matter from which folder
    the process has loaded it first.
    """
    entry = (Path(folder) / "resources" / "slavemodule.txt").read_text(encoding="utf-8").strip()
    shell = sys.modules.get(f"{entry}_code.shipcosim.fmi.slave")
    reference = getattr(getattr(shell, "Fmi2Slave", None), "newest", None)
    made = reference() if reference is not None else None
    return made if made is not None and made.instance_name == name else None


class Direct:
    """Prepared calls to the object behind an instance, in the form of those to a binary.

    Parameters
    ----------
    target : Fmi2Slave of an FMU's own copy of the shell
        The object.
    tell : callable
        Takes (status, text) of what it logs.
    """

    def __init__(self, target, tell: Callable[[int, str], None]):
        self._target, self._tell = target, tell

    def setter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """See `Slave2.setter`."""
        method, references = self._method("set", kind), _references(variables)

        def set_all():
            try:
                method(references, buffer.tolist())
            except Exception as error:
                return self._failed(error)
            return OK

        def set_flags():
            try:
                method(references, [value != 0 for value in buffer.tolist()])
            except Exception as error:
                return self._failed(error)
            return OK

        return set_flags if kind == "Boolean" else set_all

    def getter(self, kind: str, variables: Sequence, buffer: np.ndarray) -> Callable[[], int]:
        """See `Slave2.getter`."""
        method, references = self._method("get", kind), _references(variables)
        pack = struct.Struct(f"{len(variables)}{'d' if kind == 'Real' else 'i'}").pack_into  # quicker than buffer[:] =

        def get_all():
            try:
                pack(buffer, 0, *method(references))
            except Exception as error:
                return self._failed(error)
            return OK

        return get_all

    def stepper(self) -> Callable[[float, float], int]:
        """See `Slave2.stepper`."""
        target, do_step = self._target, self._target.do_step

        def step(time, step_size):
            try:
                do_step(time, step_size)
            except Exception as error:
                return self._failed(error)
            if target.messages:
                self._hand_over()
            return OK

        return step

    def _method(self, verb, kind):
        return getattr(self._target, f"{verb}_{kind.lower()}")

    def _hand_over(self):
        for message in self._target.messages:
            self._tell(message.status, message.msg.replace("%%", "%"))
        self._target.messages.clear()

    def _failed(self, error):
        self._tell(FATAL, str(error))
        return FATAL


def _references(variables):
    return tuple(variable.value_reference for variable in variables)
