"""Values that go from one component to another outside the arrays: texts in every step, parameters once."""

from dataclasses import dataclass

import numpy as np

from shipcosim.cosim.slaves.slave import BUFFER_TYPES, Slave
from shipcosim.ssp import Variable


@dataclass
class Text:
    """A connection between String or Binary variables, made at every multiple of `period` base steps."""

    source: Slave
    output: Variable
    target: Slave
    input: Variable
    mapping: dict | None = None
    period: int = 1
    last: str | bytes | None = None

    @property
    def place(self) -> str:
        """The connection, for messages."""
        return f"{self.source.name}.{self.output.name} -> {self.target.name}.{self.input.name}"

    def transfer(self, count: int) -> None:
        """Pass the text on where it is due and has changed."""
        if count % self.period:
            return
        text = self.source.get_strings([self.output])[0]
        text = (self.mapping or {}).get(text, text)
        if text != self.last:
            self.target.set_strings([self.input], [text])
            self.last = text


class Handover:
    """A connection into a parameter.

    Parameters
    ----------
    source, target : (Slave, Variable, kind)
        Kind is a key of BUFFER_TYPES.
    factor, offset, mapping
        As in Connection.
    """

    def __init__(self, source, target, factor=1.0, offset=0.0, mapping=None):
        (slave, variable, kind), (self._target, parameter, target_kind) = source, target
        self.place = f"{slave.name}.{variable.name} -> {self._target.name}.{parameter.name}"
        self._source, self._how = slave, (factor, offset, mapping or {})
        self._from = np.zeros(1, dtype=BUFFER_TYPES[kind])
        self._to = np.zeros(1, dtype=BUFFER_TYPES[target_kind])
        self._get = slave.getter(kind, [variable], self._from)
        self._set = self._target.setter(target_kind, [parameter], self._to)
        self._done = False

    def transfer(self) -> bool:
        """Pass the value on; whether it has changed."""
        self._source.check("Get", self._get())
        factor, offset, mapping = self._how
        value = mapping.get(self._from[0].item(), self._from[0].item())
        value = factor * value + offset if (factor, offset) != (1.0, 0.0) else value
        changed = not self._done or value != self._to[0]
        self._to[0], self._done = value, True
        if changed:
            self._target.check("Set", self._set())
        return changed
