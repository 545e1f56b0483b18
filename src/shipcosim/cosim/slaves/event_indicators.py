"""Event indicators of a model-exchange FMU: their signs, and whether one has passed zero.

FMI counts a change between ``z <= 0`` and ``z > 0`` as a state event. An FMU that compares with < and > sees it only past
the zero, so an indicator that is zero waits for its sign.
"""

from collections.abc import Callable

import numpy as np

from shipcosim.cosim.slaves.slave import SlaveError

PARTS = 8
"""Parts of a step at whose ends the signs are looked at, besides the vertices of parabolas between them."""


class EventIndicators:
    """Signs of the event indicators at the last event, and what has become of them.

    Parameters
    ----------
    n : int
        Number of indicators.
    values : callable
        Fills an (n,) array with their values at the present time and states.

    Attributes
    ----------
    may_be_zero : bool
        Whether one may be zero now, so that its sign is seen only a little later.
    """

    def __init__(self, n: int, values: Callable[[np.ndarray], None]):
        self._now = np.zeros(n)
        self._values = values
        self._signs = np.zeros(n)
        self.may_be_zero = False

    def keep(self) -> None:
        """Keep the signs of now, for which the discrete states have settled."""
        self._signs = np.sign(self._of_now())
        self.may_be_zero = bool(np.any(self._signs == 0.0))

    def has_changed(self) -> bool:
        """Whether one is past zero, on another side than at the last event."""
        return self._differ(self._of_now())

    def change_within(
        self, start: float, end: float, go_to: Callable[[float], None]
    ) -> float | None:
        """Time within a step at which one has passed zero, even if it is back at the end; None where none has.

        Parameters
        ----------
        start, end : float
            The step. [s]
        go_to : callable
            Brings the FMU to a time within it.
        """
        # Most FMUs have no indicator, and this is asked after every step of the solver.
        if not len(self._now):
            return None
        times = np.linspace(start, end, PARTS + 1)
        values = np.zeros((PARTS + 1, len(self._now)))
        for k, time in enumerate(times):
            go_to(time)
            values[k] = self._of_now()
            if 0 < k < PARTS and self._differ(values[k]):
                return time
        # A shorter way past zero and back has a peak between these times: the vertex of a parabola through three of them.
        before = np.abs(values[:-2]) - np.abs(values[1:-1])
        after = np.abs(values[2:]) - np.abs(values[1:-1])
        is_peak = np.abs(before - after) < 2.0 * (before + after)
        for row, column in np.argwhere(is_peak):
            left, right = before[row, column], after[row, column]
            time = times[row + 1] + 0.5 * (times[1] - start) * (left - right) / (left + right)
            go_to(time)
            if start < time < end and self._differ(self._of_now()):
                return time
        return None

    def _differ(self, values):
        signs = np.sign(values)
        return bool(np.any((signs != 0.0) & (signs != self._signs)))

    def has_come_to_zero(self) -> bool:
        """Whether a positive indicator has become zero: that is an event too, because FMI counts zero as negative."""
        return bool(np.any((self._of_now() == 0.0) & (self._signs > 0.0)))

    def _of_now(self):
        if len(self._now):
            self._values(self._now)
            # Without a sign it would be an event in every step.
            undefined = np.isnan(self._now)
            if undefined.any():
                number = undefined.argmax() + 1
                raise SlaveError(f"Its event indicator {number} is no number (NaN).")
        return self._now
