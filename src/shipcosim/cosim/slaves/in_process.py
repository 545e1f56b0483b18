"""FMUs of our own shell, stepped without their C interface.

Such an FMU is an object in this very process: its binary turns C arrays into lists, calls a method of the object and
turns lists back into C arrays. Here the same methods are called with the same values in the same order. All else, from
the start to storing a state, goes through the binary.
"""

import struct
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.cosim.slaves.slave import ERROR, OK, Call, Step, Variables


def python_object_of(folder: Path, name: str) -> Any:
    """The Python object behind the FMU instance made last; None if it is not of our shell.

    The module that an FMU of ours enters by has a name unique to its content, so it does not matter from which folder
    the process has loaded it first.
    """
    # The entry module's name is unique to the content, so this finds the FMU's own copy of the
    # shell.
    entry = (Path(folder) / "resources" / "slavemodule.txt").read_text(encoding="utf-8").strip()
    shell = sys.modules.get(f"{entry}_code.shipcosim.fmi.shell")
    reference = getattr(getattr(shell, "Fmi2Slave", None), "newest", None)
    # The shell keeps a weak reference to its newest object. The name makes sure that it is this
    # instance.
    made = reference() if reference is not None else None
    ours = made is not None and made.instance_name == name and hasattr(made, "advance")
    return made if ours else None


class DirectCalls:
    """Prepared calls to the object behind an instance, in the form of those to a binary.

    Parameters
    ----------
    target : Fmi2Slave of an FMU's own copy of the shell
        The object.
    log : callable
        Takes (status, text) of what it logs.
    """

    def __init__(self, target: Any, log: Callable[[int, str], None]):
        self.target = target
        self._log = log

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """See `Slave.setter`."""
        if kind == "Real":
            return self._reals_setter(_references(variables), buffer)
        method = getattr(self.target, f"set_{kind.lower()}")
        references = _references(variables)

        # The object gets plain Python numbers, as it does from the binary.
        def set_all():
            values = buffer.tolist()
            try:
                method(
                    references, [value != 0 for value in values] if kind == "Boolean" else values
                )
            except Exception as error:
                return self._failed(error)
            return OK

        return set_all

    def getter(self, kind: str, variables: Variables, buffer: Any) -> Call:
        """See `Slave.getter`."""
        # The shell binds names to references once; each call then only reads attributes.
        get_values = self.target.prepared_getter(kind, _references(variables))
        # Packing is quicker than ``buffer[:] = values``.
        layout = struct.Struct(f"{len(buffer)}{'d' if kind == 'Real' else 'i'}")
        pack = partial(layout.pack_into, buffer, 0)

        def get_all():
            try:
                pack(*get_values())
            except Exception as error:
                return self._failed(self.target.failure(error))
            return OK

        return get_all

    def _reals_setter(self, references, buffer):
        set_values = self.target.real_setter(references)
        values_of = buffer.tolist

        def set_all():
            try:
                set_values(values_of())
            except Exception as error:
                return self._failed(self.target.failure(error))
            return OK

        return set_all

    def stepper(self) -> Step:
        """See `Slave.stepper`."""
        target = self.target
        advance = self.target.advance

        def step(time, step_size):
            try:
                advance(time, step_size)
            # A second Ctrl-C ends a step that takes too long.
            except KeyboardInterrupt:
                raise
            # BaseException: code of an FMU must not end the run, not even by sys.exit.
            except BaseException as error:
                return self._failed(target.failure(error))
            # Messages are collected by the object; pass them on as the binary would.
            if target.messages:
                for message in self.target.messages:
                    self._log(message.status, message.msg.replace("%%", "%"))
                self.target.messages.clear()
            return OK

        return step

    def _failed(self, error):
        self._log(ERROR, str(error))
        return ERROR


def _references(variables):
    return tuple(variable.value_reference for variable in variables)
