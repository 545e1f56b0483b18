"""The master's interface to an FMU instance of any FMI version, in any process.

Exchanging values is prepared once: `setter` and `getter` bind value references and a NumPy buffer to the function of
the FMU's library, and what they return is called in every step. Buffers hold Real as float64, Integer (and
Enumeration) and Boolean as int32, whatever the FMU's own types are; Long is Integer in 64 bits, for systems with an FMU
of FMI 3.0 that needs them.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shipcosim.ssp import Variable

Variables = Sequence[Variable]


Step = Callable[[float, float], int]
"""Goes on from a time by a step size, and returns the status."""


Call = Callable[[], int]
"""A prepared call of an FMU, which returns its status."""


BUFFER_TYPES = {"Integer": np.int32, "Boolean": np.int32, "Long": np.int64, "Real": np.float64}
"""Kinds of exchanged values, in an order in which each may follow those before it."""

STATUS = ["ok", "warning", "discard", "error", "fatal", "pending"]
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
FAILED = DISCARD
"""Lowest status of a call that has not done its work."""


class SlaveError(Exception):
    """A call to an FMU failed. The text is the FMU's message."""


class ProcessEnded(SlaveError):
    """The process of an FMU is no longer there, or was ended because it gave no answer."""


class RunEnded(SlaveError):
    """An FMU asks to end the simulation; this does not count as a failure."""

    def __init__(self):
        super().__init__("It asks to end the simulation.")


class Slave:
    """One instance of an FMU: the interface that the master uses.

    Attributes
    ----------
    name : str
        Name of the component.
    python_object : Fmu or None
        The object behind the instance, where it is one of our own shell in this process.
    """

    name: str
    python_object: Any = None

    @property
    def messages(self) -> list[tuple[int, str]]:
        """Messages of the FMU beyond status "ok": (status, text)."""
        raise NotImplementedError

    def remarks(self) -> list[str]:
        """Warnings that the FMU logged, with its name in front."""
        texts = [text for status, text in self.messages if status == WARNING]
        # PythonFMU's begin with the name already; a word that begins with the same letters is none.
        prefixes = (f"{self.name} ", f"{self.name}:", f"{self.name},")
        return [text if text.startswith(prefixes) else f"{self.name}: {text}" for text in texts]

    def setter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that sets variables of one kind from a buffer and returns the status."""
        raise NotImplementedError

    def getter(self, kind: str, variables: Variables, buffer: np.ndarray) -> Call:
        """Prepared call that gets variables of one kind into a buffer and returns the status."""
        raise NotImplementedError

    def stepper(self) -> Step:
        """Prepared call that advances from a time by a step size, both in s, and returns the status."""
        raise NotImplementedError

    def call(self, function: str, *arguments: Any) -> None:
        """Call a function of the FMU by its name without prefix, e.g. ``"Terminate"``."""
        raise NotImplementedError

    def check(self, function: str, status: int) -> None:
        """Raise SlaveError if the status says that the function failed."""
        raise NotImplementedError

    def get_strings(self, variables: Variables) -> list[str] | list[bytes]:
        """Values of String variables, or in FMI 3.0 of Binary ones."""
        raise NotImplementedError

    def set_strings(self, variables: Variables, values: Sequence) -> None:
        """Set String variables, or in FMI 3.0 Binary ones."""
        raise NotImplementedError

    def enter_initialisation(self, start_time: float, stop_time: float) -> None:
        """Enter the initialisation mode for a run between two times. [s, s]"""
        raise NotImplementedError

    def exit_initialisation(self) -> None:
        """Leave the initialisation mode."""
        raise NotImplementedError

    def state(self) -> bytes:
        """FMU state, serialised; `restore` of any instance of this FMU takes it, in another process too."""
        raise NotImplementedError

    def restore(self, data: bytes) -> None:
        """Bring the instance into a state from `state`."""
        raise NotImplementedError

    def rewind(self, state: Any) -> None:
        """Bring the instance, one of our own shell, into a state of its object from before the start."""
        raise NotImplementedError

    def terminate(self) -> None:
        """End the simulation. A failure here no longer matters."""
        raise NotImplementedError
