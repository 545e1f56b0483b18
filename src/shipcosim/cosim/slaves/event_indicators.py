"""Event indicators of a model-exchange FMU: their signs, and whether one has passed zero.

FMI counts a change between ``z <= 0`` and ``z > 0`` as a state event. An FMU that compares with < and > sees it only past
the zero, so an indicator that is zero waits for its sign.
"""

from collections.abc import Callable

import numpy as np

from shipcosim.cosim.slaves.slave import SlaveError


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
        signs = np.sign(self._of_now())
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
