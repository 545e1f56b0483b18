"""Resistance in calm water: ITTC's friction line, Holtrop and Mennen's wetted surface, form factor and waves.

References
----------
Holtrop and Mennen, An approximate power prediction method, Int. Shipbuilding Progress 29, 1982, 166-170. ITTC 1957,
model-ship correlation line. Midship section and waterplane: Papanikolaou, Ship Design, Springer, 2014.
"""

from math import cos, exp, log10, sqrt

from shipcosim.models.core.constants import GRAVITY
from shipcosim.ships.estimates.estimate import EstimatedNumber, within
from shipcosim.ships.estimates.hull import HullDimensions

VISCOSITY = 1.19e-6  # m2/s, sea water at 15 deg C
APPENDAGES = 1.1
"""Resistance with rudder, thrusters and openings over that of the bare hull; assumed. [1]"""
MOST_FROUDE = 0.4
"""Beyond which the formula holds no more. [1]"""
FULL_SCALE = 20.0  # m; the correlation allowance is of ships, not of models and boats
_FINE = 0.11
_BROAD = 0.25


def midship_coefficient(block: float) -> float:
    """Midship section coefficient.

    Parameters
    ----------
    block : float
        Block coefficient. [1]

    Returns
    -------
    float
        [1]
    """
    return min(1.0, max(1.006 - 0.0056 * block**-3.56, 1.02 * block))


def wetted_surface(
    form: HullDimensions, midship: float | None = None, waterplane: float | None = None
) -> float:
    """Wetted surface of all hulls without appendages and bulb.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    midship, waterplane : float, optional
        Coefficients of midship section and waterplane; by the block coefficient if not given. [1, 1]

    Returns
    -------
    float
        [m2]
    """
    L = form.length
    B = form.breadth
    T = form.draught
    Cb = form.block
    # Coefficients by the block coefficient, unless they are given.
    Cm = midship_coefficient(Cb) if midship is None else midship
    Cwp = (1.0 + 2.0 * Cb) / 3.0 if waterplane is None else waterplane
    # Holtrop and Mennen's regression, without the bulb.
    shape = 0.453 + 0.4425 * Cb - 0.2862 * Cm - 0.003467 * B / T + 0.3696 * Cwp
    return form.hulls * L * (2.0 * T + B) * sqrt(Cm) * shape


def form_factor(
    form: HullDimensions, *, midship: float | None = None, lcb: float = 0.0, stern: float = 0.0
) -> float:
    """1 + k, the viscous resistance over that of a flat plate.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    midship : float, optional
        As of `wetted_surface`. [1]
    lcb : float
        Centre of buoyancy forward of midships, in per cent of the length. [1]
    stern : float
        Holtrop's: 10 of U-shaped sections, -10 of V-shaped ones. [1]

    Returns
    -------
    float
        [1]
    """
    L = form.length
    T = form.draught
    # Holtrop and Mennen 1982: c12 for the draught, the length of the run, 1 + k.
    Cp = _prismatic(form, midship)
    c12 = (
        0.479948 + 48.20 * max(T / L - 0.02, 0.0) ** 2.078 if T / L < 0.05 else (T / L) ** 0.2228446
    )
    shape = (form.breadth / _run(L, Cp, lcb)) ** 0.92497 * (0.95 - Cp) ** -0.521448
    return (1.0 + 0.003 * stern) * (
        0.93 + c12 * shape * max(0.01, 1.0 - Cp + 0.0225 * lcb) ** 0.6906
    )


def friction(speed: float, length: float) -> float:
    """ITTC's friction coefficient.

    Parameters
    ----------
    speed, length : float
        [m/s, m]

    Returns
    -------
    float
        [1]

    Examples
    --------
    >>> round(1e3 * friction(10.0, 119.0), 3)
    1.531
    """
    return 0.075 / (log10(max(speed * length / VISCOSITY, 1e3)) - 2.0) ** 2


def wave_resistance(
    form: HullDimensions,
    *,
    midship: float | None = None,
    waterplane: float | None = None,
    lcb: float = 0.0,
) -> float:
    """Wave resistance at the service speed of a hull without bulb and immersed transom.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    midship, waterplane, lcb : float
        As above. [1, 1, 1]

    Returns
    -------
    float
        [N]
    """
    L = form.length
    B = form.breadth
    T = form.draught
    # Wave resistance is computed for one hull, then counted for each.
    volume = form.volume / form.hulls
    Cp = _prismatic(form, midship)
    Cwp = min((1.0 + 2.0 * form.block) / 3.0, 0.98) if waterplane is None else waterplane
    # Within the range of the regression.
    froude = max(min(froude_number(form), MOST_FROUDE), 0.05)
    # c7: function of B/L in three ranges.
    slender = B / L
    c7 = (
        0.229577 * slender ** (1.0 / 3.0)
        if slender < _FINE
        else min(slender, 0.5 - 0.0625 / slender)
    )
    c7 = slender if _FINE <= slender <= _BROAD else c7
    # c1 contains the half angle of entrance.
    entrance = _entrance(form, volume, Cp, Cwp, lcb)
    c1 = 2223105.0 * c7**3.78613 * (T / B) ** 1.07961 * (90.0 - entrance) ** -1.37565
    # m1, m2 and lambda of Holtrop and Mennen 1982; no bulb, no transom.
    c16 = 8.07981 * Cp - 13.8673 * Cp**2 + 6.984388 * Cp**3 if Cp < 0.8 else 1.73014 - 0.7067 * Cp
    m1 = 0.0140407 * L / T - 1.75254 * volume ** (1.0 / 3.0) / L - 4.79323 * B / L - c16
    m2 = -1.69385 * Cp**2 * exp(-0.1 / froude**2)
    length = 1.446 * Cp - 0.03 * L / B if L / B < 12.0 else 1.446 * Cp - 0.36
    # R_w = c1 V rho g exp(m1 Fn^d + m2 cos(lambda Fn^-2)), d = -0.9.
    shape = exp(
        min(m1 * froude**-0.9 + m2 * cos(length / froude**2), 5.0)
    )  # beyond it there is no such ship
    return form.hulls * c1 * volume * form.density * GRAVITY * shape


def resistance(
    form: HullDimensions, surface: float | None = None, factor: float | None = None
) -> float:
    """Resistance at the service speed in calm water, a tenth of it that of appendages.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    surface : float, optional
        Wetted surface, where it is known. [m2]
    factor : float, optional
        1 + k, where it is known. [1]

    Returns
    -------
    float
        [N]
    """
    # Friction with form factor, correlation allowance, and waves.
    S = wetted_surface(form) if surface is None else surface
    viscous = friction(form.speed, form.length) * (form_factor(form) if factor is None else factor)
    pressure = 0.5 * form.density * S * form.speed**2
    return APPENDAGES * (pressure * (viscous + _allowance(form)) + wave_resistance(form))


def drag_coefficient(
    form: HullDimensions, surface: float | None = None, factor: float | None = None
) -> EstimatedNumber:
    """Quadratic damping in surge that has the resistance of the service speed.

    Parameters
    ----------
    form, surface, factor
        As of `resistance`.

    Returns
    -------
    EstimatedNumber
        X_uu. [N.s2/m2]
    """
    # X_uu u^2 equals the resistance at service speed.
    coefficient = -resistance(form, surface, factor) / form.speed**2
    source = f"Holtrop and Mennen 1982 with ITTC 1957 at {form.speed:.3g} m/s, and a tenth for appendages"
    # Beyond the formula only the order of magnitude is known: the tolerance says so.
    if froude_number(form) > MOST_FROUDE:
        return within(
            coefficient, 3.0, f"{source}; beyond the formula, the order of magnitude at best"
        )
    return within(coefficient, 0.5, source)


def froude_number(form: HullDimensions) -> float:
    """Froude number of the service speed.

    Parameters
    ----------
    form : HullDimensions
        The hull.

    Returns
    -------
    float
        [1]
    """
    return form.speed / sqrt(GRAVITY * form.length)


def _prismatic(form: HullDimensions, midship: float | None) -> float:
    return min(0.9, form.block / (midship_coefficient(form.block) if midship is None else midship))


def _run(L: float, Cp: float, lcb: float) -> float:
    """Length of the run."""
    return L * max(0.1, 1.0 - Cp + 0.06 * Cp * lcb / (4.0 * Cp - 1.0))


def _entrance(form: HullDimensions, volume: float, Cp: float, Cwp: float, lcb: float) -> float:
    """Half angle of entrance in deg."""
    L = form.length
    B = form.breadth
    # Holtrop and Mennen's half angle of entrance, in deg.
    run = _run(form.length, Cp, lcb)
    power = (
        (L / B) ** 0.80856 * (1.0 - Cwp) ** 0.30484 * max(0.01, 1.0 - Cp - 0.0225 * lcb) ** 0.6367
    )
    power *= (run / B) ** 0.34574 * (100.0 * volume / L**3) ** 0.16302
    return min(1.0 + 89.0 * exp(-power), 85.0)


def _allowance(form: HullDimensions) -> float:
    """Correlation allowance of a ship without bulb, with the draught at the bow that she has amidships."""
    if form.length < FULL_SCALE:
        return 0.0
    # Holtrop's C_A without bulb; c4 = T/L, at most 0.04.
    L = form.length
    hump = 0.003 * sqrt(L / 7.5) * form.block**4 * (0.04 - min(form.draught / L, 0.04))
    return 0.006 * (L + 100.0) ** -0.16 - 0.00205 + hump
