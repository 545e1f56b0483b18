"""What a run keeps: rows of all outputs and external values, in arrays made before the first step."""

from collections.abc import Sequence

import numpy as np

from shipcosim.cosim.master.signals import Exchange
from shipcosim.errors import ShipcosimError


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

    Raises
    ------
    ShipcosimError
        If the table does not fit into memory.
    """

    def __init__(self, exchange: Exchange, n_rows: int, external: Sequence[int] = (), inputs: Sequence[int] = ()):
        self._exchange = exchange
        self._n_outputs = len(exchange.outputs)
        self._external = np.array(external, dtype=int) + self._n_outputs
        self._inputs = np.array(inputs, dtype=int)
        self._first_input = self._n_outputs + len(self._external)
        shape = n_rows, self._first_input + len(self._inputs)
        try:
            self._rows = np.empty(shape, dtype=exchange.sources.dtype)
        except MemoryError:
            size = np.prod(shape, dtype=float) * exchange.sources.itemsize / 1e9
            raise ShipcosimError(
                f"A table of {n_rows} rows and {shape[1]} signals needs {size:.1f} GB of memory. "
                "A larger output_interval makes it smaller."
            ) from None

    def record(self, row: int) -> None:
        """Keep the present values as a row."""
        values, sources = self._rows[row], self._exchange.modified_sources
        values[: self._n_outputs] = sources[: self._n_outputs]
        if len(self._external):
            values[self._n_outputs : self._first_input] = sources[self._external]
        if len(self._inputs):
            values[self._first_input :] = self._exchange.inputs[self._inputs]

    def columns(self, n_rows: int) -> list[np.ndarray]:
        """The first rows, (n_rows,) an array for each signal: outputs, external values, inputs."""
        return list(np.ascontiguousarray(self._rows[:n_rows].T))
