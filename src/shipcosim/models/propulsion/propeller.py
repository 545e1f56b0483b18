"""Thrust and torque of the azimuths' ducted propeller in all four quadrants.

With the hydrodynamic pitch angle β = atan2(u_a, 0.7 π n D) and C = ρ/2 (u_a² + (0.7 π n D)²) π D²/4,

    T = CT(β) C,  Q = CQ(β) D C,

which has no singular point: n = 0 is β = ±90 deg. From β = 0 to an angle in the first quadrant CT and CQ come from the
propeller's own polynomials KT(J) and KQ(J), J = u_a/(n D); elsewhere they are those of the open propeller B4-70, P/D
1.4, times factors over β, by which a propeller meets both its bollard points and the ends of its polynomials (assumed;
grade D outside the first quadrant).

References
----------
Four-quadrant form: Smogeli, Control of Marine Propellers, NTNU, 2006. Series: Roddy, Hess and Faller, Neural network
predictions of the 4-quadrant Wageningen propeller series, NSWCCD-50-TR-2006/004. Polynomial and scaling: nominal
model, azimuth thrusters.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.interpolation import EvenTable, even_table, interp_even
from shipcosim.models.core.maths import Arithmetic, atan2, pi, sqrt, where
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity, required, required_table
from shipcosim.models.core.tables import columns, parse

# Fourier coefficients of CT and CQ of B4-70, P/D 1.4: Roddy, Hess and Faller, Neural network predictions of the
# 4-quadrant Wageningen propeller series, NSWCCD-50-TR-2006/004, as tabulated in the Modelica library ShipSIM.
# fmt: off
_CT_COS = (
    0.018891, 0.28033, 0.01886, 0.0059973, -0.010858, -0.064362, -0.0015631, 0.050311, -0.00063924, -0.020315,
    0.0060866, 0.018917, -0.0041935, 0.0067181, 0.006423, 0.0072715, -0.0017483, 0.0017548, 0.003548, 0.000797,
    -0.00099109, 0.0022019, -0.0004753, -0.0052461, 0.00053469, 0.0009951, -0.0016191, -0.0034163, 0.00025212,
    4.6286e-05, -0.0020432,
)

_CT_SIN = (
    0, -0.65683, -0.0023066, 0.074446, -0.012398, 0.047921, 0.0071695, 0.00034276, -0.0029434, 0.020101, 0.0027097,
    0.001648, -0.0017983, 0.010989, -0.0016326, -0.013135, -3.0559e-05, 0.0046619, -0.0039988, -0.0074616,
    0.00018552, -0.00091938, -0.0041697, -0.0030539, 0.0014211, 0.00063486, -0.0027402, 9.2732e-05, 0.0011064,
    -0.00017769, 6.4717e-05,
)

_CQ_COS = (
    0.006273, 0.059067, -0.0034811, 0.0043989, 0.0004052, -0.011843, -0.003086, 0.013137, 0.0014057, -0.0056834,
    -0.00026129, 0.0045913, 0.00058107, 0.00012353, 0.0016486, 0.0043524, -0.00095606, -0.0020063, 0.00067764,
    0.002086, -0.00010021, -0.0014317, 0.00040246, 0.00034768, -0.0011234, -0.001822, 0.00034224, 0.00067856,
    -0.0008999, -0.0008462, 8.4567e-05,
)

_CQ_SIN = (
    0, -0.13718, 6.0201e-05, 0.020555, -0.0033632, 0.0089586, 0.0026638, 0.0009819, -0.0022511, 0.00087269,
    0.0031696, 0.0033156, -0.0021286, 0.0010776, 0.0013561, -0.0020842, -0.0020193, -0.00033011, 0.0010371,
    -0.0013432, -0.0012629, -0.00039292, 0.00015316, -0.0012626, -0.001106, 0.00076676, 0.00071063, -7.8099e-05,
    -0.00070479, 0.00066394, 0.00061846,
)

# fmt: on
_FACTORS = ("angle [deg]", "factor [1]")
_STEP = 0.1  # deg; linear interpolation then errs by at most 2e-5 in CT and 5e-6 in CQ, 1e-4 of their bollard values
_AREA = pi / 4.0  # of the disc, in D^2
_TIP = 0.7 * pi  # speed of the reference section in n D
_ALMOST_NONE = 1e-12  # N, keeps the derivative of the square root finite


class Curves(NamedTuple):
    """A propeller over the whole circle.

    Parameters
    ----------
    table : tuple
        CT, CQ and the weight of the scale outside the first quadrant over β, as `even_table` makes it. [1]
    bollard : tuple of four floats
        KT ahead and astern, KQ ahead and astern, over n abs(n). [1]
    """

    table: EvenTable
    bollard: tuple[float, float, float, float]


@dataclass(frozen=True, kw_only=True)
class PropellerParameters:
    """A propeller: its polynomials in the first quadrant, and factors on a series propeller elsewhere."""

    diameter: float = required("m", "propeller diameter", minimum=0.01)
    thrust_polynomial: str = required_table(
        ("end [deg]", "k0 [1]", "k1 [1]", "k2 [1]", "k3 [1]"),
        "row 'end k0 k1 k2 k3': KT over powers of the advance ratio, from no speed to a hydrodynamic pitch angle, deg",
    )
    torque_polynomial: str = required_table(
        ("end [deg]", "k0 [1]", "k1 [1]", "k2 [1]", "k3 [1]"),
        "row 'end k0 k1 k2 k3': KQ over powers of the advance ratio, from no speed to a hydrodynamic pitch angle, deg",
    )
    thrust_factors: str = required_table(
        _FACTORS,
        "rows 'angle factor': factor on CT of B4-70, P/D 1.4, by the hydrodynamic pitch angle, deg",
    )
    torque_factors: str = required_table(
        _FACTORS,
        "rows 'angle factor': factor on CQ of B4-70, P/D 1.4, by the hydrodynamic pitch angle, deg",
    )
    water_density: float = quantity(
        1025.0, "kg/m3", "density of the water", "sea water", minimum=1.0
    )
    inflow: float = quantity(
        1.0,
        "1",
        "share of the ship's speed that reaches the propeller; 0 keeps bollard thrust at any speed",
        "the polynomial is over ship speed",
        minimum=0.0,
    )
    thrust_scale: float = quantity(
        1.0,
        "1",
        "factor on the thrust; 1 for propeller with nozzle",
        "neutral",
        tolerance=0.01,
        minimum=0.0,
    )
    thrust_scale_outside: float = quantity(
        1.0,
        "1",
        "further factor on the thrust outside the first quadrant",
        "neutral",
        tolerance=0.05,
        minimum=0.0,
    )
    torque_scale: float = quantity(1.0, "1", "factor on the torque", "neutral", minimum=0.0)

    @cached_property
    def disc(self):
        """Dynamic factor ρ/2 π D²/4: C over the squared speed of the reference section. [kg/m]"""
        return 0.5 * _AREA * self.diameter**2 * self.water_density

    @property
    def curves(self):
        """CT and CQ over the whole circle, and bollard coefficients; cached by their tables."""
        return _curves(
            self.thrust_polynomial, self.thrust_factors, self.torque_polynomial, self.torque_factors
        )

    @cached_property
    def bollard(self):
        """Bollard thrust and torque over squared speed, ahead and astern. [N.s2, N.m.s2]"""
        D = self.diameter
        (KT_ahead, KT_astern, KQ_ahead, KQ_astern) = self.curves.bollard
        # T = ρ D⁴ K_T n², Q = ρ D⁵ K_Q n².
        K = self.water_density * D**4
        thrust = K * self.thrust_scale
        torque = K * D * self.torque_scale
        astern = thrust * self.thrust_scale_outside * KT_astern
        return thrust * KT_ahead, astern, torque * KQ_ahead, torque * KQ_astern


def propeller_loads(u_a: Arithmetic, n: Arithmetic, *, propeller: PropellerParameters) -> Vector:
    """Thrust and torque in all four quadrants.

    Parameters
    ----------
    u_a : float or (...) array or tensor
        Speed of advance of the unit through the water along its axis. [m/s]
    n : like u_a
        Shaft speed, negative astern. [rev/s]
    propeller : PropellerParameters
        The propeller.

    Returns
    -------
    tuple of two, like u_a
        Thrust along the axis, and torque that the shaft must give. [N, N.m]

    Examples
    --------
    One whose KT is 0.82 at no speed, 1.9 m wide, at 200 rpm:

    >>> tables = {"thrust_polynomial": "30 0.82 -0.7 0.2 -0.1", "torque_polynomial": "30 0.09 -0.04 0 0"}
    >>> tables |= {"thrust_factors": "-180 0.9; -90 1; 0 1.4; 30 0.4; 90 1; 180 0.9", "torque_factors": "-180 1; 180 1"}
    >>> thrust, torque = propeller_loads(0.0, 200.0 / 60.0, propeller=PropellerParameters(diameter=1.9, **tables))
    >>> round(thrust / (1025.0 * (200.0 / 60.0) ** 2 * 1.9**4), 9)
    0.82
    """
    return loads_at(u_a, propeller=propeller)(n)


def loads_at(u_a: Arithmetic, *, propeller: PropellerParameters) -> Callable[[Arithmetic], tuple]:
    """`propeller_loads` over shaft speed alone, for many speeds at one speed of advance.

    Parameters
    ----------
    u_a : float or (...) array or tensor
        Speed of advance of the unit through the water along its axis. [m/s]
    propeller : PropellerParameters
        The propeller.

    Returns
    -------
    callable
        ``loads(n)`` gives thrust and torque at a shaft speed. [N, N.m]
    """
    # Everything that does not depend on n is computed once: the drive calls this many times a step.
    D = propeller.diameter
    disc = propeller.disc
    table = propeller.curves.table
    outside_more = propeller.thrust_scale_outside - 1.0
    tip_per_n = _TIP * D
    thrust_scale = propeller.thrust_scale
    torque_scale = propeller.torque_scale
    u_a = propeller.inflow * u_a
    square = u_a * u_a

    def loads(n):
        # β = atan2(u_a, 0.7 π n D): no singular point at n = 0.
        tip = tip_per_n * n
        ct, cq, outside = interp_even(atan2(u_a, tip), table)
        # C = ρ/2 (u_a² + (0.7 π n D)²) π D²/4; T = CT C, Q = CQ D C.
        C = disc * (square + tip * tip)
        return thrust_scale * (1.0 + outside * outside_more) * ct * C, torque_scale * cq * D * C

    return loads


def bollard_torque(n: Arithmetic, *, propeller: PropellerParameters) -> Arithmetic:
    """Torque at bollard, without speed of advance.

    Parameters
    ----------
    n : float or (...) array or tensor
        Shaft speed. [rev/s]
    propeller : PropellerParameters
        The propeller.

    Returns
    -------
    like n
        Torque. [N.m]
    """
    _, _, ahead, astern = propeller.bollard
    return n * abs(n) * where(n < 0.0, astern, ahead)


def bollard_speed(thrust: Arithmetic, *, propeller: PropellerParameters) -> Arithmetic:
    """Shaft speed that gives a thrust at bollard, the inverse of the bollard thrust curve.

    Parameters
    ----------
    thrust : float or (...) array or tensor
        Thrust. [N]
    propeller : PropellerParameters
        The propeller.

    Returns
    -------
    like thrust
        Shaft speed. [rev/s]
    """
    # T = c n |n|, hence n = ±√(|T| / c), with its own coefficient astern.
    ahead, astern, _, _ = propeller.bollard
    back = thrust < 0.0
    speed = sqrt((abs(thrust) + _ALMOST_NONE) / where(back, astern, ahead))
    return where(back, -speed, speed)


def series(beta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thrust and torque coefficient of the open propeller B4-70, P/D 1.4, unscaled.

    Parameters
    ----------
    beta : (n,) array
        Hydrodynamic pitch angle. [rad]

    Returns
    -------
    tuple of two (n,) arrays
        CT, CQ. [1, 1]
    """
    # CT(β) = Σ a_k cos kβ + b_k sin kβ, and CQ likewise.
    order = np.arange(len(_CT_COS))
    c = np.cos(np.outer(beta, order))
    s = np.sin(np.outer(beta, order))
    return c @ _CT_COS + s @ _CT_SIN, c @ _CQ_COS + s @ _CQ_SIN


@lru_cache(maxsize=16)
def _curves(thrust_polynomial, thrust_factors, torque_polynomial, torque_factors):
    """Curves of a propeller from its tables."""
    # A fine table over the whole circle, so that one step needs no series.
    degrees = np.arange(-1800, 1801) * _STEP
    ct, cq = series(np.radians(degrees))
    ct, end = _coefficient(ct, degrees, thrust_factors, thrust_polynomial)
    cq, _ = _coefficient(cq, degrees, torque_factors, torque_polynomial)
    # Weight of the outside scale: 0 in the first quadrant, 1 well outside, linear between, so
    # thrust has no step.
    outside = np.interp(
        degrees, (-180.0, -30.0, 0.0, end, 60.0, 180.0), (1.0, 1.0, 0.0, 0.0, 1.0, 1.0)
    )
    # KT = CT π/8 (0.7 π)² at bollard: C in units of ρ n² D⁴. Ahead is β = 0, astern β = ±180
    # degrees.
    factor = 0.5 * _AREA * _TIP**2
    middle = len(ct) // 2
    bollard = (factor * np.array([ct[middle], -ct[0], cq[middle], -cq[0]])).tolist()
    return Curves(even_table(np.radians(degrees), ct, cq, outside), tuple(bollard))


def _coefficient(of_series, degrees, factors, polynomial):
    """CT or CQ over the whole circle: factors on the series, polynomial up to its end; the end."""
    at, factor = columns(factors, 2)
    coefficient = of_series * np.interp(degrees, at, factor)
    ((end, *k),) = parse(polynomial)
    # In the first quadrant the propeller's own polynomial applies: J = 0.7 π tan β.
    first = (degrees > -0.5 * _STEP) & (degrees < end + 0.5 * _STEP)
    J = _TIP * np.tan(np.radians(degrees[first]))
    # From KT(J) to CT(β): divide by π/8 ((0.7 π)² + J²) = π/8 (0.7 π)² / cos² β.
    coefficient[first] = (
        np.polyval(k[::-1], J) * np.cos(np.radians(degrees[first])) ** 2 / (0.5 * _AREA * _TIP**2)
    )
    return coefficient, end
