"""The wind as a relation of the joint judgement: over ground it neither turns nor moves with the ship.

The apparent wind a, as a vector to where it comes from, turned by the heading, is the wind over ground plus the ship's
velocity: a E = W + w E, and W changes slowly. A mistake of heading or velocity makes it a other E, or c times another
form of the velocity; the time base has no part in it. Wind channels can have mistakes of their own: from north,
mirrored, over ground already, in another unit. Each reading is as likely as all of these together make it.
"""

import cmath
import math
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.log.checks.kinematics import after_gaps, complete_rows, filters, whiteness
from shipcosim.diagnose.log.mislabels import KNOT
from shipcosim.diagnose.log.readings.changes import LogInterpretation
from shipcosim.diagnose.log.readings.fit import likeliest_fits
from shipcosim.diagnose.log.thresholds import (
    CLEAR_MOTION,
    FEWEST_WIND_ROWS,
    MOST_FITTED,
    MOST_OF_WIND,
    WIND_LABEL_COST,
    WIND_ROWS,
    WIND_SCALE,
)
from shipcosim.diagnose.numerics import gaussian_filter, noise_by_differences

UNITS = {1.0: 0.0, KNOT: WIND_LABEL_COST, 1.0 / KNOT: WIND_LABEL_COST, 1.0 / 3.6: WIND_LABEL_COST}
"""Possible factors on the wind's speed, and their costs."""
SEEN = {"bow": 0.0, "mirrored": WIND_LABEL_COST, "north": WIND_LABEL_COST}
"""How the wind's direction may be counted, and what that costs."""


@dataclass(frozen=True)
class WindRelations:
    """The wind against the velocity, by heading's unit.

    Attributes
    ----------
    fits : dict of (unit, is the heading mirrored, seen, form of the velocity) to (likelihood, factor, variance)
        Seen = factor * told + what changes slowly; likelihood at that factor [nats], variance of the factor.
    """

    fits: dict[tuple[float, bool, str, tuple[bool, bool]], tuple[float, complex, float]]

    def likelihood(self, reading: LogInterpretation, angle: float) -> float:
        """How likely the wind is under a reading, over the likeliest. [nats]

        Parameters
        ----------
        reading : LogInterpretation
        angle : float
            By how much the change of position is turned against this reading. [rad]
        """
        # Factor of the velocity in the relation a E = W
        # + w E, before the turn of the wind's own frame.
        mirrored = "heading" in reading.mirrored
        flipped = "velocity" in reading.mirrored
        factor_of_velocity = complex(reading.velocity) * (
            cmath.exp(1j * angle) if "axes" in reading.free else 1.0
        )
        # Likelihood of each way in which the wind channels may be labelled, with its cost.
        scores = []
        for seen, cost in SEEN.items():
            key = (reading.heading_unit, mirrored, seen, (flipped, reading.earth))
            if key not in self.fits:
                return 0.0
            # Velocity over the earth, or wind from north,
            # moves the heading's factor to the other side.
            turned = reading.earth and seen != "north"
            factor = factor_of_velocity * (complex(reading.heading).conjugate() if turned else 1.0)
            factor *= complex(reading.heading) if seen == "north" and not reading.earth else 1.0
            scores += [
                _at(self.fits[key], factor / unit) - cost - more for unit, more in UNITS.items()
            ]
            # Factor 0: the wind is logged over ground already.
            scores.append(_at(self.fits[key], 0.0) - cost - WIND_LABEL_COST)
        # Sum the probabilities of all labels of the wind. The
        # floor limits what the wind can say against a reading.
        top = max(scores)
        return max(top + math.log(sum(math.exp(score - top) for score in scores)), -MOST_OF_WIND)


def _at(fit, factor):
    """Log-likelihood with the factor that a reading says, give or take what wind sensors are off."""
    likelihood, fitted, variance = fit
    # Wind sensors follow the velocity to about a fifth only, which widens the variance.
    wide = variance + (WIND_SCALE * abs(factor)) ** 2
    return likelihood - 0.5 * abs(fitted - factor) ** 2 / wide - math.log(wide / variance)


def wind_relations(log: dict, headings: dict[float, np.ndarray]) -> WindRelations:
    """The wind against the velocity in all forms; no fits where there is too little of them.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time`, and roles in their units as logged.
    headings : dict of (n,) arrays
        By how they are read. [deg]

    Notes
    -----
    A ship that hardly moves is not judged by it: noise of her velocity would make all factors too small.
    """
    # Complete rows, thinned to limit the cost.
    roles = ("wind_speed", "wind_from", "surge", "sway")
    rows = complete_rows(log, (*roles, "heading"))
    rows = rows[:: max(1, math.ceil(len(rows) / MOST_FITTED))]
    if not headings or len(rows) < FEWEST_WIND_ROWS:
        return WindRelations({})
    # Apparent wind and velocity as complex numbers: ahead and i times to starboard.
    time = log["time"][rows]
    apparent = log["wind_speed"][rows] * np.exp(1j * np.radians(log["wind_from"][rows]))
    velocity = log["surge"][rows] + 1j * log["sway"][rows]
    # Noise of the velocity attenuates the factor, so the ship must move well above this noise.
    if np.mean(np.abs(velocity) ** 2) < 2.0 * (CLEAR_MOTION * _noise(velocity)) ** 2:
        return WindRelations({})
    # A third of the noise ratios is enough for the wind.
    drafts = filters(time, after_gaps(time))[::3]
    fits: dict = {}
    # Turn the wind by each reading of the heading, and fit each form of the velocity to it.
    for unit, heading in headings.items():
        for mirrored in (False, True):
            turn = np.exp((-1j if mirrored else 1j) * np.radians(heading[rows]))
            seen = {"bow": apparent * turn, "mirrored": np.conj(apparent) * turn, "north": apparent}
            forms = _velocity_forms(velocity, turn)
            pairs = {
                (name, form): (wind, way)
                for name, wind in seen.items()
                for form, way in forms.items()
            }
            for (name, form), fit in likeliest_fits(drafts, pairs)[0].items():
                fits[unit, mirrored, name, form] = fit
    return WindRelations(_tamed(fits))


def _velocity_forms(velocity, turn):
    """Forms of the velocity, by whether it is mirrored and whether it is over the earth; as slow as wind sensors.

    Those turn with the ship and average what they feel: the velocity is averaged in her axes.
    """
    both = {mirrored: np.conj(velocity) if mirrored else velocity for mirrored in (False, True)}
    body = {(mirrored, False): series for mirrored, series in both.items()}
    earth = {(mirrored, True): series * np.conj(turn) for mirrored, series in both.items()}
    return {form: _slow(way) * turn for form, way in (body | earth).items()}


def _slow(way):
    return gaussian_filter(way.real, WIND_ROWS) + 1j * gaussian_filter(way.imag, WIND_ROWS)


def _noise(velocity):
    """Standard deviation of an axis from row to row, by third differences of four in five rows."""
    return float(np.quantile(np.abs(noise_by_differences(velocity, 3)), 0.8)) / 1.794


def _tamed(fits):
    """Likelihoods over the best one, and variances of the factors, by how much what is left hangs together."""
    # Residuals of the best fit show their correlation, by which all evidence is divided.
    best = max(fits.values(), key=lambda fit: fit.likelihood)
    rough = whiteness(np.column_stack([best.rest.real, best.rest.imag]))
    return {
        key: (
            (fit.likelihood - best.likelihood) / rough,
            fit.factor,
            rough * 2.0 * fit.variance / max(np.vdot(fit.reported, fit.reported).real, 1e-300),
        )
        for key, fit in fits.items()
    }
