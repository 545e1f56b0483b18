"""Exchange of values of one type from outputs to inputs, by array operations for all components."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

Modifier = tuple[float, float]
"""(scale, shift): an override is (0, value), a bias (1, value)."""


@dataclass(frozen=True)
class InputConnection:
    """The source of an input: ``factor * source + offset``, at multiples of `period` base steps.

    Parameters
    ----------
    source : int
        Row in the sources.
    factor, offset : float
        Linear transformation; 1 and 0 leave the value untouched.
    mapping : mapping, optional
        Replaces values of the source before that; those that are not in it stay as they are.
    period : int
        In base steps.
    added : tuple of InputConnection
        Whose values are added to this one's, in this order.
    """

    source: int
    factor: float = 1.0
    offset: float = 0.0
    mapping: Mapping | None = None
    period: int = 1
    added: tuple[InputConnection, ...] = ()

    @property
    def is_linear(self) -> bool:
        """Whether factor and offset change values."""
        return (self.factor, self.offset) != (1.0, 0.0)

    @property
    def terms(self) -> tuple[InputConnection, ...]:
        """The connections that make up a sum; none where nothing is added."""
        return (replace(self, added=()), *self.added) if self.added else ()

    def transferred(self, values: np.ndarray) -> np.ndarray:
        """Values of a source as they arrive: (n,) arrays with one value per base step."""
        # Between two transfers the input holds the last value passed on.
        values = values[np.arange(len(values)) // self.period * self.period]
        passed = (
            values
            if self.mapping is None
            else np.array([self.mapping.get(v, v) for v in values.tolist()])
        )
        if self.is_linear:
            passed = self.factor * passed + self.offset
        return passed.astype(values.dtype)

    def input_values(self, columns: Sequence[np.ndarray]) -> np.ndarray:
        """Values of all sources together as they arrive, (n,), from one (n,) array per source."""
        arrived = self.transferred(columns[self.source])
        for connection in self.added:
            arrived = arrived + connection.transferred(columns[connection.source])
        return arrived


class Modifiers:
    """Overrides and biases that act on an array of values: scale * value + shift on some rows.

    Attributes
    ----------
    version : int
        Grows whenever one of them changes.
    """

    def __init__(self):
        self._by_row: dict[int, Modifier] = {}
        self.version = 0
        self._update()

    def override(self, row: int, value: float) -> None:
        """Hold a row at a value."""
        self.put(row, 0, value)

    def bias(self, row: int, value: float) -> None:
        """Add a value to a row."""
        self.put(row, 1, value)

    def reset(self, row: int) -> None:
        """Let a row follow its source again."""
        self._by_row.pop(row, None)
        self._update()

    def put(self, row: int, scale: float, shift: float) -> None:
        """Let a modifier act on a row."""
        self._by_row[row] = scale, shift
        self._update()

    @property
    def active(self) -> dict[int, Modifier]:
        """Modifiers by row."""
        return dict(self._by_row)

    def apply(self, values: np.ndarray) -> None:
        """Modify the rows of an array in place."""
        if self._by_row:
            values[self._rows] = self._scale * values[self._rows] + self._shift

    def _update(self):
        # The version tells the exchange that its inputs may differ although no source changed.
        self.version += 1
        self._rows = np.array(list(self._by_row), dtype=int)
        self._scale = np.array([scale for scale, _ in self._by_row.values()])
        self._shift = np.array([shift for _, shift in self._by_row.values()])


class Exchange:
    """Sources and inputs of one type, and the connections between them.

    Sources are the outputs of all components, which the components write into `outputs`, and behind them the external
    values, which come from outside any component. Every input has a connection; one that nothing feeds is connected to
    an external value.

    Parameters
    ----------
    n_outputs : int
        Number of outputs.
    external : (m,) array
        Start values of what comes from outside; its type is that of all values.
    connections : sequence of InputConnection
        One for each input, with those that are added to it.
    type_changes : sequence of (row of external, Exchange, source)
        External values that follow a source of an exchange of another type.

    Attributes
    ----------
    sources : (n_outputs + m,) array
        Outputs as the components put them out, and external values; `outputs` and `external` are its parts.
    modified_sources : like sources
        The same with overrides and biases.
    transferred : (k,) array
        What connections bring: values of the inputs before overrides and biases, and behind them the terms of sums.
    inputs : (number of connections,) array
        Values that the components get.
    numbered : tuple
        (row, connection) of all that bring one value, (row, slice of terms) of the sums, and the number of rows.
    type_changes : sequence of (row of external, Exchange, source)
        As given.
    version : int
        Grows whenever an input changes; not counted for Real, where every step changes some.
    """

    def __init__(
        self,
        n_outputs: int,
        external: np.ndarray,
        connections: Sequence[InputConnection],
        type_changes: Sequence[tuple[int, Exchange, int]] = (),
    ):
        dtype = external.dtype
        # One array for outputs and external values: a connection needs one index, whatever its
        # source.
        self.sources = np.concatenate([np.zeros(n_outputs, dtype=dtype), external])
        self.outputs = self.sources[:n_outputs]
        self.external = self.sources[n_outputs:]
        self.modified_sources = self.sources.copy()
        # Sums have rows for their terms behind the inputs, so every connection brings one value.
        self.numbered = single, self._sums, n = _numbered(connections)
        self.transferred = np.zeros(n, dtype=dtype)
        self.inputs = np.zeros(len(connections), dtype=dtype)
        self._unmodified_inputs = self.transferred[: len(connections)]
        self.output_modifiers = Modifiers()
        self.input_modifiers = Modifiers()
        self.version = 0
        # Types other than Real are set in the FMU only when the version grows.
        self._counts_versions = dtype.kind != "f"
        self.type_changes = type_changes
        # Connections with the same period are passed on together.
        periods = sorted({connection.period for _, connection in single})
        self._groups = [_ConnectionGroup(single, period, n) for period in periods]
        # If nothing changed since the last transfer there is nothing to do; valid if all are due
        # each step.
        self._may_rest = self._counts_versions and periods in ([], [1])
        self._passed_on = ()

    def reset(self, external: np.ndarray) -> None:
        """Start again in the same arrays, from other external start values, (m,)."""
        for array in (self.outputs, self.transferred, self.inputs):
            array[:] = 0
        self.external[:] = external
        self.modified_sources[:] = self.sources
        self.output_modifiers = Modifiers()
        self.input_modifiers = Modifiers()
        self.version = 0
        self._passed_on = ()

    def transfer(self, count: int) -> None:
        """Pass on what is due after `count` base steps, transformed and with overrides and biases.

        Values of types other than Real change seldom: where none has since the last time, nothing is to be done.
        """
        # Copies between types happen first: their sources are outputs of another exchange.
        for row, exchange, source in self.type_changes:
            self.external[row] = exchange.modified_sources[source]
        if self._may_rest and self._passed_on == self._state():
            return
        # Overrides act on a copy: the component's own output stays known for a reset.
        self.modified_sources[:] = self.sources
        self.output_modifiers.apply(self.modified_sources)
        # Pass on the connections that are due; the others hold their last value.
        for group in self._groups:
            if count % group.period == 0:
                group.transfer(self.modified_sources, self.transferred)
        # Sums come last, from the terms that were just passed on.
        for row, terms in self._sums:
            total = 0.0
            for term in self.transferred[terms].tolist():
                total += term  # one after the other, as libcosim does
            self.transferred[row] = total
        self.refresh()
        if self._may_rest:
            self._passed_on = self._state()

    def _state(self):
        """All sources of the inputs, to detect that none has changed."""
        modifiers = self.output_modifiers.version, self.input_modifiers.version
        return self.sources.tobytes(), self.transferred.tobytes(), modifiers

    def refresh(self) -> None:
        """Update the inputs after a change of overrides and biases."""
        before = self.inputs.tobytes() if self._counts_versions else b""
        self.inputs[:] = self._unmodified_inputs
        self.input_modifiers.apply(self.inputs)
        if self._counts_versions and before != self.inputs.tobytes():
            self.version += 1


def _numbered(connections):
    """Numbered single connections, sums with their terms' rows, and the number of rows.

    The terms of sums have rows of their own, behind those of the inputs.
    """
    single = [
        (row, connection) for row, connection in enumerate(connections) if not connection.added
    ]
    sums = []
    n = len(connections)
    for row, terms in (
        (row, connection.terms) for row, connection in enumerate(connections) if connection.added
    ):
        single += enumerate(terms, start=n)
        sums.append((row, slice(n, n + len(terms))))
        n += len(terms)
    return single, sums, n


class _ConnectionGroup:
    """The connections of one period."""

    def __init__(self, single, period, n):
        # Indices and factors as arrays: a transfer is then a few NumPy operations.
        rows = [row for row, connection in single if connection.period == period]
        due = [connection for _, connection in single if connection.period == period]
        self.period = period
        self.rows = np.array(rows, dtype=int)
        self.is_all = len(rows) == n
        self.sources = np.array([connection.source for connection in due], dtype=int)
        # Only transformed rows are multiplied: others stay exact to the last bit.
        linear = [i for i, connection in enumerate(due) if connection.is_linear]
        self.linear = np.array(linear, dtype=int)
        self.factor = np.array([due[i].factor for i in linear])
        self.offset = np.array([due[i].offset for i in linear])
        self.mappings = [
            (i, connection.mapping)
            for i, connection in enumerate(due)
            if connection.mapping is not None
        ]

    def transfer(self, sources, transferred):
        # If the group covers all rows it writes straight into them.
        values = transferred if self.is_all else np.empty(len(self.rows), dtype=transferred.dtype)
        # Order of SSP: mapping first, then the linear transformation.
        sources.take(self.sources, out=values, mode="clip")
        for i, mapping in self.mappings:
            value = values[i].item()
            values[i] = mapping.get(value, value)
        if len(self.linear):
            values[self.linear] = self.factor * values[self.linear] + self.offset
        if not self.is_all:
            transferred[self.rows] = values
