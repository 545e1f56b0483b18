"""A propeller and the rudder behind it, by published regressions, as the MMG standard method takes them.

References
----------
Kijima, Katsuno, Nakiri and Furukawa, On the manoeuvring performance of a ship with the parameter of loading condition,
J. SNAJ 168, 1990. Fujii: gradient of the rudder's normal force. Yasukawa and Yoshimura, J Mar Sci Technol 20, 2015:
the method, and the numbers of KVLCC2 that are taken where no formula is at hand. Taylor: wake. DNV: rudder area.
"""

from shipcosim.ships.estimates.estimate import EstimatedNumber, within
from shipcosim.ships.estimates.hull import HullDimensions

KIJIMA = "Kijima et al. 1990"
KVLCC2 = "as of KVLCC2, Yasukawa and Yoshimura 2015"


def rudder_area(form: HullDimensions) -> EstimatedNumber:
    """Area of the movable rudder.

    Parameters
    ----------
    form : HullDimensions
        The hull.

    Returns
    -------
    EstimatedNumber
        [m2]
    """
    area = form.length * form.draught / 100.0 * (1.0 + 25.0 * (form.breadth / form.length) ** 2)
    return within(area, 0.25, "DNV's least area, LT/100 (1 + 25 (B/L)^2)")


def propeller_and_rudder(
    form: HullDimensions, *, single: bool, span: float, area: float, covered: float
) -> dict[str, EstimatedNumber]:
    """Wake, deduction, rudder force and its effect on the hull.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    single : bool
        One propeller on the centreline, or one of two.
    span, area : float
        Of the rudder. [m, m2]
    covered : float
        Diameter of the propeller over the span of the rudder. [1]

    Returns
    -------
    dict of str to Estimate
        Parameters of a propeller with a rudder, without places and open-water curve.
    """
    L = form.length
    Cb = form.block
    # Taylor's wake fractions for single and twin screws.
    wake = max(0.5 * Cb - 0.05 if single else 0.55 * Cb - 0.20, 0.02)
    # Fujii's lift gradient depends on the aspect ratio of the rudder.
    aspect = span**2 / area
    return {
        "wake": EstimatedNumber(wake, 0.08, "Taylor"),
        "thrust_deduction": EstimatedNumber(0.6 * wake, 0.05, "0.6 of the wake fraction"),
        "lift_gradient": within(
            6.13 * aspect / (aspect + 2.25), 0.1, "Fujii: 6.13 a/(a + 2.25), a the aspect ratio"
        ),
        "covered": EstimatedNumber(min(covered, 1.0), 0.05, "diameter over span"),
        "race_gain": EstimatedNumber(0.55, 0.1, KVLCC2),
        "wake_ratio": EstimatedNumber(1.05, 0.1, KVLCC2),
        "straightening_starboard": EstimatedNumber(0.55, 0.15, f"{KVLCC2}, mean of both sides"),
        "straightening_port": EstimatedNumber(0.45, 0.15, f"{KVLCC2}, mean of both sides"),
        "straightening_x": within(-0.71 * L, 0.15, KVLCC2),
        "rudder_deduction": EstimatedNumber(
            0.45 - 0.28 * Cb, 0.15, f"{KIJIMA}: 1 - t_R = 0.28 C_B + 0.55"
        ),
        "hull_share": EstimatedNumber(
            max(0.5 * Cb - 0.1, 0.0), 0.15, f"read off the curve of {KIJIMA}"
        ),
        "hull_x": within(-0.45 * L, 0.1, KIJIMA),
    }
