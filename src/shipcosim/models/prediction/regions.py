"""Regions about predictions that contain the truth in 90 % of cases.

Calibrated widths hold for ships like those of the calibration. What widens them for another is the predictor's own
record: how far she came from where she was foreseen ten seconds ago, which needs no truth.

References
----------
Normalised conformal prediction: Papadopoulos, Gammerman and Vovk, Normalized nonconformity measures for regression
conformal prediction, AIA 2008; the measure of difficulty is chosen here.
"""

from dataclasses import dataclass

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, exp, hypot, sqrt, where
from shipcosim.models.core.motion import Motion, Vector
from shipcosim.models.core.parameters import quantity

FORESIGHT = 10.0
"""How far ahead the predictions of the own record were made. [s]"""
JUST_LOST = 5.0
"""Up to this time after the loss of thrust regions are those of a ship that has just lost it. [s]"""
LONG_LOST = 60.0
"""After this time without thrust they are those of a long drift. [s]"""
HORIZONS = (10.0, 30.0, 60.0)
"""Horizons of the calibrated widths. [s]"""

_NONE = "neutral: not calibrated"


@dataclass(frozen=True, kw_only=True)
class RegionParameters:
    """Sizes of the regions about predictions 10, 30 and 60 s ahead, of a ship that lost all thrust 5 to 60 s ago."""

    position_half_width_10: float = quantity(
        0.0, "m", "radius of 90 % of the places in 10 s", _NONE, minimum=0.0
    )
    position_half_width_30: float = quantity(
        0.0, "m", "radius of 90 % of the places in 30 s", _NONE, minimum=0.0
    )
    position_half_width_60: float = quantity(
        0.0, "m", "radius of 90 % of the places in 60 s", _NONE, minimum=0.0
    )
    heading_half_width_10: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 10 s", _NONE, minimum=0.0
    )
    heading_half_width_30: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 30 s", _NONE, minimum=0.0
    )
    heading_half_width_60: float = quantity(
        0.0, "rad", "half-width of 90 % of the headings in 60 s", _NONE, minimum=0.0
    )

    first_position_share: float = quantity(
        1.0,
        "1",
        "factor on the radii in the first 5 s after the loss of thrust",
        "neutral",
        minimum=0.0,
    )
    first_heading_share: float = quantity(
        1.0,
        "1",
        "factor on the half-widths of heading in the first 5 s after the loss of thrust",
        "neutral",
        minimum=0.0,
    )
    later_position_share: float = quantity(
        1.0,
        "1",
        "factor on the radii later than 60 s after the loss of thrust",
        "neutral",
        minimum=0.0,
    )
    later_heading_share: float = quantity(
        1.0,
        "1",
        "factor on the half-widths of heading later than 60 s after the loss of thrust",
        "neutral",
        minimum=0.0,
    )
    ordinary_position_error: float = quantity(
        0.3,
        "m",
        "own error of 10 s at which the radii are 1.4 times as large",
        "chosen by seeds 300-311",
        minimum=1e-3,
    )
    ordinary_heading_error: float = quantity(
        0.01,
        "rad",
        "own error of 10 s at which the half-widths of heading are 1.4 times as large",
        "chosen by seeds 200-323",
        minimum=1e-4,
    )
    error_time: float = quantity(
        20.0, "s", "over which own errors are averaged", "assumed", minimum=1.0
    )

    @property
    def positions(self) -> tuple[float, float, float]:
        """Radii by horizon. [m]"""
        return self.position_half_width_10, self.position_half_width_30, self.position_half_width_60

    @property
    def headings(self) -> tuple[float, float, float]:
        """Half-widths by horizon. [rad]"""
        return self.heading_half_width_10, self.heading_half_width_30, self.heading_half_width_60


def own_errors(
    errors: Vector,
    ship: Motion,
    foreseen: Motion,
    h: float,
    *,
    regions: RegionParameters,
) -> Vector:
    """Mean errors of the predictor's own record, a sample later.

    Parameters
    ----------
    errors : tuple of two floats, (...) arrays or tensors
        Mean errors of position and heading up to now. [m, rad]
    ship : Motion
        The ship now, as estimated.
    foreseen : Motion
        Prediction for now, made ten seconds ago.
    h : float
        Time since the last sample. [s]
    regions : RegionParameters
        For the time over which errors are averaged.

    Returns
    -------
    tuple of two, like errors
        Position and heading. [m, rad]
    """
    # Moving averages of the prediction error made ten seconds ago; this needs no truth.
    share = 1.0 - exp(-h / regions.error_time)
    position = hypot(ship.x - foreseen.x, ship.y - foreseen.y)
    heading = abs(wrap(ship.psi - foreseen.psi))
    return errors[0] + share * (position - errors[0]), errors[1] + share * (heading - errors[1])


def widening(errors: Vector, lost_for: Arithmetic, *, regions: RegionParameters) -> Vector:
    """Factors on the calibrated widths: larger by the own errors, others at first and later, 0 while thrusters act.

    Parameters
    ----------
    errors : tuple of two floats, (...) arrays or tensors
        Mean own errors of position and heading. [m, rad]
    lost_for : like errors
        Time since all thrust was lost; negative while thrusters act. [s]
    regions : RegionParameters
        Calibrated sizes.

    Returns
    -------
    tuple of two, like errors
        For radii and for half-widths of heading. [1]
    """
    factors = []
    for error, ordinary, first, later in (
        (
            errors[0],
            regions.ordinary_position_error,
            regions.first_position_share,
            regions.later_position_share,
        ),
        (
            errors[1],
            regions.ordinary_heading_error,
            regions.first_heading_share,
            regions.later_heading_share,
        ),
    ):
        # √(1 + (error / ordinary)²): 1 for small errors, 1.4 at the ordinary one, then
        # proportional.
        grown = sqrt(1.0 + (error / ordinary) * (error / ordinary))
        # No region while thrusters act; then by the time since they were lost.
        drifting = where(lost_for > JUST_LOST, where(lost_for > LONG_LOST, later, 1.0), first)
        factors.append(grown * where(lost_for < 0.0, 0.0, drifting))
    return factors[0], factors[1]
