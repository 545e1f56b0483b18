"""How far the simulation of a healthy ship is off: one that differs from her file within its tolerances alone."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.explanation.null_distribution import drawn_within_tolerances
from shipcosim.diagnose.inference.predictions import missing
from shipcosim.diagnose.validation.gain import Comparison, rms, sailed
from shipcosim.diagnose.validation.split import HORIZONS
from shipcosim.diagnose.validation.thresholds import FLOOR_VARIES, HEALTHY_SHIPS


@dataclass(frozen=True)
class HealthyErrors:
    """Errors of predictions with the shipped numbers beside those that healthy ships have on the same rows.

    Attributes
    ----------
    measured, largest : dict of str to float
        Root mean square after the longest horizon, ``"position"`` [m] and ``"heading"`` [deg], of the plain model on
        the log; and the largest that any of `HEALTHY_SHIPS` reaches.
    """

    measured: dict[str, float]
    largest: dict[str, float]

    def as_json(self) -> dict:
        """The entry ``healthy_errors`` of diagnosis.json: the largest errors of a healthy ship."""
        return {
            "horizon_s": HORIZONS[-1],
            "position_error_m": self.largest["position"],
            "heading_error_deg": self.largest["heading"],
        }

    @property
    def beyond(self) -> list[str]:
        """Errors that are larger than any healthy ship's."""
        return [
            channel for channel, error in self.measured.items() if error > self.largest[channel]
        ]


def healthy_errors(comparison: Comparison) -> HealthyErrors:
    """Errors of the plain model on the rows kept from the fit, beside those that healthy ships have there.

    A healthy ship's numbers are drawn within their tolerances; she sails the same stretches from the same states, and
    what the plain model misses of her adds to the noise floor of the log.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    HealthyErrors
    """
    plain = comparison.predictors["plain"].model
    # All ships sail at once, from the same states with the same inputs; the plain model is the
    # reference.
    ships = drawn_within_tolerances(plain, (HEALTHY_SHIPS, 1), np.random.default_rng(0))
    plain_motion = sailed(comparison, plain)
    off = missing(sailed(comparison, ships), plain_motion, np.arange(comparison.rows.size))
    # Errors beside the noise that no model is without.
    measured = {}
    largest = {}
    for channel in ("position", "heading"):
        measured[channel] = rms(comparison.errors, channel, "plain")
        # Error by tolerances and by noise add as variances; the worst ship sets the limit.
        floor = FLOOR_VARIES * rms(comparison.errors, channel, "floor")
        largest[channel] = float(np.sqrt((off[channel] ** 2).mean(-1) + floor**2).max())
    return HealthyErrors(measured, largest)
