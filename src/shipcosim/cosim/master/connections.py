"""Connections made one by one: strings at every step, parameters at the start."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from shipcosim.cosim.slaves.slave import BUFFER_TYPES, Slave
from shipcosim.ssp import Connection, Variable


@dataclass
class StringConnection:
    """A connection between String or Binary variables, made at every multiple of `period` base steps.

    Parameters
    ----------
    source, target : Slave
        FMUs at its ends.
    output, input : Variable
        Their variables.
    mapping : mapping, optional
        Replaces values; those that are not in it stay as they are.
    period : int
        In base steps.
    last : str, bytes or None
        The value passed on last.
    """

    source: Slave
    output: Variable
    target: Slave
    input: Variable
    mapping: Mapping | None = None
    period: int = 1
    last: str | bytes | None = None

    @property
    def place(self) -> str:
        """The connection, for messages."""
        return f"{self.source.name}.{self.output.name} -> {self.target.name}.{self.input.name}"

    def transfer(self, count: int) -> None:
        """Pass the value on where it is due after `count` base steps and has changed."""
        if count % self.period:
            return
        # Strings are expensive to set and change seldom: pass on changes only.
        value = self.source.get_strings([self.output])[0]
        value = (self.mapping or {}).get(value, value)
        if value != self.last:
            self.target.set_strings([self.input], [value])
            self.last = value


class Port(NamedTuple):
    """A variable of an FMU's instance, and the kind of its values, a key of BUFFER_TYPES."""

    slave: Slave
    variable: Variable
    kind: str


class ParameterConnection:
    """A connection into a parameter, made during the initialisation.

    Parameters
    ----------
    source, target : Port
        Its ends.
    how : Connection
        What happens to the value on the way.
    """

    def __init__(self, source: Port, target: Port, how: Connection):
        self.place = f"{source.slave.name}.{source.variable.name} -> {target.slave.name}.{target.variable.name}"
        self._source = source.slave
        self._target = target.slave
        self._how = how
        self._from = np.zeros(1, dtype=BUFFER_TYPES[source.kind])
        self._to = np.zeros(1, dtype=BUFFER_TYPES[target.kind])
        self._get = source.slave.getter(source.kind, [source.variable], self._from)
        self._set = target.slave.setter(target.kind, [target.variable], self._to)
        self._is_made = False

    def transfer(self) -> bool:
        """Pass the value on; true if it has changed."""
        self._source.check("Get", self._get())
        # The mapping comes first, then the linear transformation, as SSP orders them.
        value = self._from[0].item()
        if self._how.mapping is not None:
            value = self._how.mapping.get(value, value)
        if self._how.is_linear:
            value = self._how.factor * value + self._how.offset
        # The start iterates until nothing changes, so each transfer reports a change.
        changed = not self._is_made or value != self._to[0]
        self._to[0], self._is_made = value, True
        if changed:
            self._target.check("Set", self._set())
        return changed
