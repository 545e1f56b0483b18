"""Values of one type on their way from outputs to inputs, as a few array operations for all components together."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Wire:
    """What feeds an input: ``factor * source + offset``, passed on at every multiple of `period` base steps.

    Parameters
    ----------
    source : int
        Row in the sources.
    factor, offset : float
        Transformation; 1 and 0 leave the value untouched.
    table : mapping, optional
        Replaces values of the source before that; those that are not in it stay as they are.
    period : int
        In base steps.
    added : tuple of Wire
        Whose values are added to this one's, in this order.
    """

    source: int
    factor: float = 1.0
    offset: float = 0.0
    table: dict | None = None
    period: int = 1
    added: tuple["Wire", ...] = ()

    @property
    def terms(self):
        """The wires of a sum; none where nothing is added."""
        return (replace(self, added=()), *self.added) if self.added else ()

    def passed_on(self, values):
        """What arrives of a source over time: (n,) arrays with one value for each base step."""
        values = values[np.arange(len(values)) // self.period * self.period]
        passed = values if self.table is None else np.array([self.table.get(v, v) for v in values.tolist()])
        if (self.factor, self.offset) != (1.0, 0.0):
            passed = self.factor * passed + self.offset
        return passed.astype(values.dtype)

    def arriving(self, columns):
        """What arrives over time of all sources, one column each, together."""
        arrived = self.passed_on(columns[self.source])
        return sum((wire.passed_on(columns[wire.source]) for wire in self.added), arrived)


class Changes:
    """Overrides and biases in force on an array of values: changed = scale * value + shift on some rows."""

    def __init__(self):
        self._by_row = {}
        self._set()

    def __bool__(self):
        return bool(self._by_row)

    def override(self, row, value):
        """Hold a row at a value."""
        self._set(row, (0, value))

    def bias(self, row, value):
        """Add a value to a row."""
        self._set(row, (1, value))

    def reset(self, row):
        """Let a row follow its source again."""
        self._by_row.pop(row, None)
        self._set()

    @property
    def in_force(self):
        """(scale, shift) of the changed rows."""
        return dict(self._by_row)

    def put(self, row, scale, shift):
        """Change a row as `in_force` says it."""
        self._set(row, (scale, shift))

    def apply(self, values):
        """Change the rows of an array in place."""
        if self._by_row:
            values[self._rows] = self._scale * values[self._rows] + self._shift

    def _set(self, row=None, change=None):
        if row is not None:
            self._by_row[row] = change
        self._rows = np.array(list(self._by_row), dtype=int)
        self._scale = np.array([scale for scale, _ in self._by_row.values()])
        self._shift = np.array([shift for _, shift in self._by_row.values()])


class Exchange:
    """Sources and inputs of one type, and the wires between them.

    Sources are the outputs of all components, which the components write into `outputs`, and after them the settings:
    values that come from outside any component. Every input has a wire; one that nothing feeds hangs on a setting.

    Parameters
    ----------
    n_outputs : int
        Number of outputs.
    settings : (m,) array
        Start values of the settings; its type is that of all values.
    wires : sequence of Wire
        One for each input, with those that are added to it.
    crossings : sequence of (setting, Exchange, source)
        Settings that follow a source of an exchange of another type.

    Attributes
    ----------
    version : int
        Grows whenever an input changes; not counted for Real, where every step changes some.
    """

    def __init__(self, n_outputs, settings, wires, crossings=()):
        kind = settings.dtype
        self.raw = np.concatenate([np.zeros(n_outputs, dtype=kind), settings])
        self.outputs, self.settings = self.raw[:n_outputs], self.raw[n_outputs:]
        self.seen = self.raw.copy()
        single, self._sums, n = _numbered(wires)
        self.plain = np.zeros(n, dtype=kind)
        self.inputs = np.zeros(len(wires), dtype=kind)
        self._carried = self.plain[: len(wires)]
        self.output_changes, self.input_changes = Changes(), Changes()
        self.version, self._counts_versions = 0, kind.kind != "f"
        self._crossings = crossings
        periods = sorted({wire.period for _, wire in single})
        self._groups = [_Group(single, period, n) for period in periods]

    def transfer(self, count):
        """Pass on what is due after `count` base steps, transformed and with overrides and biases."""
        for setting, exchange, source in self._crossings:
            self.settings[setting] = exchange.seen[source]
        np.copyto(self.seen, self.raw)
        self.output_changes.apply(self.seen)
        for group in self._groups:
            if count % group.period == 0:
                group.transfer(self.seen, self.plain)
        for row, terms in self._sums:
            total = 0.0
            for term in self.plain[terms].tolist():
                total += term  # one after the other, as libcosim does
            self.plain[row] = total
        self.refresh()

    def refresh(self):
        """Bring the inputs up to date after a change of overrides and biases."""
        before = self.inputs.tobytes() if self._counts_versions else b""
        np.copyto(self.inputs, self._carried)
        self.input_changes.apply(self.inputs)
        if self._counts_versions and before != self.inputs.tobytes():
            self.version += 1


def _numbered(wires):
    """(row, wire) of all that carry one value, (row, slice of terms) of the sums, and how many rows that makes.

    The terms of sums have rows of their own, behind those of the inputs.
    """
    single = [(row, wire) for row, wire in enumerate(wires) if not wire.added]
    sums, n = [], len(wires)
    for row, terms in ((row, wire.terms) for row, wire in enumerate(wires) if wire.added):
        single += enumerate(terms, start=n)
        sums.append((row, slice(n, n + len(terms))))
        n += len(terms)
    return single, sums, n


class _Group:
    """The wires of one period."""

    def __init__(self, single, period, n):
        rows = [row for row, wire in single if wire.period == period]
        due = [wire for _, wire in single if wire.period == period]
        self.period, self.rows, self.is_all = period, np.array(rows, dtype=int), len(rows) == n
        self.sources = np.array([wire.source for wire in due], dtype=int)
        linear = [i for i, wire in enumerate(due) if (wire.factor, wire.offset) != (1.0, 0.0)]
        self.linear = np.array(linear, dtype=int)
        self.factor = np.array([due[i].factor for i in linear])
        self.offset = np.array([due[i].offset for i in linear])
        self.tables = [(i, wire.table) for i, wire in enumerate(due) if wire.table is not None]

    def transfer(self, seen, plain):
        values = plain if self.is_all else np.empty(len(self.rows), dtype=plain.dtype)
        np.take(seen, self.sources, out=values, mode="clip")
        for i, table in self.tables:
            value = values[i].item()
            values[i] = table.get(value, value)
        if len(self.linear):
            values[self.linear] = self.factor * values[self.linear] + self.offset
        if not self.is_all:
            plain[self.rows] = values
