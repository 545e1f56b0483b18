"""What a run keeps: rows of all outputs and settings, in arrays made before the first step."""

import numpy as np

from shipcosim.errors import ShipcosimError


class Recorder:
    """Rows of the values of one exchange.

    Parameters
    ----------
    exchange : Exchange
        Whose outputs and inputs are recorded.
    n_rows : int
        Rows in all.
    settings, inputs : sequence of int
        Rows of the exchange's settings and inputs that are recorded beside all outputs.

    Raises
    ------
    ShipcosimError
        If the table does not fit into memory.
    """

    def __init__(self, exchange, n_rows, settings=(), inputs=()):
        self._exchange = exchange
        self._n_outputs = len(exchange.outputs)
        self._settings = np.array(settings, dtype=int) + self._n_outputs
        self._inputs = np.array(inputs, dtype=int)
        self._first_input = self._n_outputs + len(self._settings)
        shape = n_rows, self._first_input + len(self._inputs)
        try:
            self._rows = np.empty(shape, dtype=exchange.raw.dtype)
        except MemoryError:
            size = np.prod(shape, dtype=float) * exchange.raw.itemsize / 1e9
            raise ShipcosimError(
                f"A table of {n_rows} rows and {shape[1]} signals needs {size:.1f} GB of memory. "
                "A larger output_interval makes it smaller."
            ) from None

    def record(self, row):
        """Keep the present values as a row."""
        values, seen = self._rows[row], self._exchange.seen
        values[: self._n_outputs] = seen[: self._n_outputs]
        if len(self._settings):
            values[self._n_outputs : self._first_input] = seen[self._settings]
        if len(self._inputs):
            values[self._first_input :] = self._exchange.inputs[self._inputs]

    def columns(self, n_rows):
        """The first rows, (n_rows,) an array for each signal: outputs, settings, inputs."""
        return list(np.ascontiguousarray(self._rows[:n_rows].T))
