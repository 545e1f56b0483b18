"""Rows of all outputs and external values, in arrays made before the run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipcosim.cosim.master.signals import Exchange
from shipcosim.errors import ShipcosimError


class Recorders:
    """Recorders of all exchanges, which keep their rows together.

    Attributes
    ----------
    by_kind : dict of str to Recorder
        Of each exchange.
    n_rows : int
        Rows so far.
    """

    def __init__(self, by_kind: dict[str, Recorder]):
        self.by_kind = by_kind
        self.n_rows = 0

    def record(self) -> None:
        """Keep the present values as the next row."""
        for recorder in self.by_kind.values():
            recorder.record(self.n_rows)
        self.n_rows += 1


class Recorder:
    """Rows of the values of one exchange.

    Parameters
    ----------
    exchange : Exchange
        Whose outputs and inputs are recorded.
    n_rows : int
        Rows in all.
    external, inputs : sequence of int
        Rows of the exchange's external values and inputs that are recorded beside all outputs.

    Attributes
    ----------
    external, inputs : (n,) arrays of int
        Rows of the sources and of the inputs that are recorded beside all outputs.
    rows : (n_rows, signals) array
        Outputs, external values, inputs.

    Raises
    ------
    ShipcosimError
        If the table does not fit into memory.
    """

    def __init__(
        self,
        exchange: Exchange,
        n_rows: int,
        external: Sequence[int] = (),
        inputs: Sequence[int] = (),
    ):
        self._exchange = exchange
        self._n_outputs = len(exchange.outputs)
        # External values lie behind the outputs among the sources.
        self.external = np.array(external, dtype=int) + self._n_outputs
        self.inputs = np.array(inputs, dtype=int)
        self._first_input = self._n_outputs + len(self.external)
        shape = n_rows, self._first_input + len(self.inputs)
        # Reserve all memory now: a run must not fail at its end.
        try:
            self.rows = np.empty(shape, dtype=exchange.sources.dtype)
        except MemoryError:
            size = np.prod(shape, dtype=float) * exchange.sources.itemsize / 1e9
            raise ShipcosimError(
                f"A table of {n_rows} rows and {shape[1]} signals needs {size:.1f} GB of memory. "
                "A larger output_interval makes it smaller."
            ) from None

    def record(self, row: int) -> None:
        """Keep the present values as a row."""
        # Outputs with overrides, then the external values, then inputs that no output determines.
        values = self.rows[row]
        sources = self._exchange.modified_sources
        values[: self._n_outputs] = sources[: self._n_outputs]
        if len(self.external):
            values[self._n_outputs : self._first_input] = sources[self.external]
        if len(self.inputs):
            values[self._first_input :] = self._exchange.inputs[self.inputs]

    def columns(self, n_rows: int) -> list[np.ndarray]:
        """The first rows, (n_rows,) a view for each signal: outputs, external values, inputs."""
        return list(self.rows[:n_rows].T)
