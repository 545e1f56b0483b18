"""Event indicators of a model-exchange FMU: their signs, and whether one has passed zero.

FMI counts a change between ``z <= 0`` and ``z > 0`` as a state event. An FMU that compares with < and > sees it only past
the zero, so an indicator that is zero waits for its sign.
"""

from collections.abc import Callable

import numpy as np

from shipcosim.cosim.slaves.slave import SlaveError

PARTS = 8
"""Parts of a step at whose ends the signs are looked at, besides the vertices of parabolas between them."""
ENDS = np.linspace(0.0, 1.0, PARTS + 1)
"""Where these parts end, from 0 at the start of the step to 1."""

HALVINGS = 20
"""Of such a part, to find where an indicator passes zero: to a ten millionth of the step."""


class EventIndicators:
    """Signs of the event indicators at the last event, and what has become of them.

    Parameters
    ----------
    n : int
        Number of indicators.
    getter : callable
        Takes an (n,) array and returns a call that fills it with their values at the present time and states.

    Attributes
    ----------
    may_be_zero : bool
        Whether one may be zero now, so that its sign is seen only a little later.
    """

    def __init__(self, n: int, getter: Callable[[np.ndarray], Callable[[], None]]):
        self._now = np.zeros(n)
        self._get_now = getter(self._now)
        # Values at the ends of the parts of a step, with a prepared call for each row.
        self._within = np.zeros((PARTS + 1, n))
        self._get_within = [getter(row) for row in self._within]
        self._signs = np.zeros(n)
        self.may_be_zero = False

    def keep(self) -> None:
        """Keep the signs of now, for which the discrete states have settled."""
        self._signs = self.signs()
        self.may_be_zero = bool(np.any(self._signs == 0.0))

    def signs(self) -> np.ndarray:
        """Signs of now, an (n,) array."""
        return np.sign(self._of_now())

    def has_followed(self, before: np.ndarray) -> bool:
        """Whether an update of the discrete states, with signs `before` it, has moved an indicator past zero.

        One that the update brings back to its sign of the last event caused it, and means something else from now on.
        """
        return bool((self._differ(self._of_now()) & (self.signs() != before)).any())

    def has_changed(self) -> bool:
        """Whether one is past zero, on another side than at the last event."""
        return bool(self._differ(self._of_now()).any())

    def change_within(
        self, start: float, end: float, go_to: Callable[[float], None]
    ) -> float | None:
        """Time within a step just after one has passed zero, even if it is back at the end; None where none has.

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
        times = start + (end - start) * ENDS
        values = self._within
        # The values at the start are those of the last question.
        values[0] = self._now
        for time, get in zip(times[1:].tolist(), self._get_within[1:], strict=True):
            go_to(time)
            get()
        _refuse_undefined(values)
        is_past = self._differ(values[1:-1]).any(axis=1)
        if is_past.any():
            row = int(is_past.argmax())
            return self._narrowed(float(times[row]), float(times[row + 1]), go_to)
        # A shorter way past zero and back has a peak between these times: the vertex of a parabola through three of them.
        with np.errstate(invalid="ignore"):  # an infinite value has no peak
            before = np.abs(values[:-2]) - np.abs(values[1:-1])
            after = np.abs(values[2:]) - np.abs(values[1:-1])
            is_peak = np.abs(before - after) < 2.0 * (before + after)
        for row, column in np.argwhere(is_peak):
            left, right = before[row, column], after[row, column]
            time = times[row + 1] + 0.5 * (times[1] - start) * (left - right) / (left + right)
            go_to(time)
            if start < time < end and self._differ(self._of_now()).any():
                return self._narrowed(float(times[row]), float(time), go_to)
        return None

    def _narrowed(self, low: float, high: float, go_to: Callable[[float], None]) -> float:
        """Time just past the first zero between two times, of which only the later is past one, by bisection. [s]"""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            go_to(middle)
            if self._differ(self._of_now()).any():
                high = middle
            else:
                low = middle
        return high

    def _differ(self, values):
        """Which values are past zero, on another side than at the last event."""
        signs = np.sign(values)
        return (signs != 0.0) & (signs != self._signs)

    def has_come_to_zero(self) -> bool:
        """Whether a positive indicator has become zero: that is an event too, because FMI counts zero as negative."""
        return bool(np.any((self._of_now() == 0.0) & (self._signs > 0.0)))

    def _of_now(self):
        if len(self._now):
            self._get_now()
            _refuse_undefined(self._now)
        return self._now


def _refuse_undefined(values):
    """Raise SlaveError for a NaN: it has no sign, and would be an event in every step."""
    undefined = np.isnan(values)
    if undefined.any():
        number = np.argwhere(undefined)[0, -1] + 1
        raise SlaveError(f"Its event indicator {number} is no number (NaN).")
