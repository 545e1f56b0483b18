"""Propellers and their drives from diameter and power.

References
----------
DNV-ST-0111, Assessment of station keeping capability, December 2021: thrust at the bollard. Smogeli, Control of Marine
Propellers, NTNU, 2006: inertia. Ideal thrust: momentum theory. Advance at no thrust: of the Wageningen B series and the
Ka series in nozzle 19A over the pitch that has the same thrust at the bollard.
"""

from dataclasses import dataclass
from math import atan, degrees, pi, sqrt

import numpy as np

from shipcosim.models.propulsion.propeller import series
from shipcosim.ships.estimates.estimate import EstimatedNumber, within

DNV = {"open": 800.0, "ducted": 1200.0, "tunnel": 900.0}
"""Thrust over the power 2/3 of diameter and power. [N/(m.kW)^(2/3)]"""
ASTERN = {"open": 0.7, "ducted": 0.6, "tunnel": 1.0}
"""Largest thrust astern over ahead at the same power. [1]"""
USUAL_KT = {"open": 0.35, "ducted": 0.55, "tunnel": 0.40}
"""Thrust coefficient at the bollard. [1]"""
MOST_KT = 1.2
ZERO_THRUST = {"open": 2.4, "ducted": 1.84, "tunnel": 2.4}
"""Advance ratio at no thrust over the thrust coefficient at the bollard. [1]"""
RESPONSE = 5.0  # 1/s, 1/s; speed of the reference section in n D
INTEGRAL = 2.0
TIP = 0.7 * pi
_DISC = 0.125 * pi * TIP**2  # C over rho n^2 D^4


@dataclass(frozen=True, kw_only=True)
class Screw:
    """A propeller at its largest speed.

    Attributes
    ----------
    kind : str
        ``"open"``, ``"ducted"`` or ``"tunnel"``.
    diameter, power, thrust : float
        Of the propeller; of the motor; at the bollard ahead. [m, W, N]
    rpm : float
        Largest speed of the shaft. [rpm]
    density : float
        Of the water. [kg/m3]
    """

    kind: str
    diameter: float
    power: float
    thrust: float
    rpm: float
    density: float

    @property
    def thrust_coefficient(self) -> float:
        """KT at the bollard. [1]"""
        return self.thrust / (self.density * (self.rpm / 60.0) ** 2 * self.diameter**4)

    @property
    def torque(self) -> float:
        """At the largest speed and power. [N.m]"""
        return self.power / (2.0 * pi * self.rpm / 60.0)

    @property
    def torque_coefficient(self) -> float:
        """KQ at the bollard. [1]"""
        return self.torque / (self.density * (self.rpm / 60.0) ** 2 * self.diameter**5)


def bollard_thrust(kind: str, diameter: float, power: float) -> EstimatedNumber:
    """Thrust at the bollard.

    Parameters
    ----------
    kind : str
        ``"open"``, ``"ducted"`` or ``"tunnel"``.
    diameter, power : float
        [m, W]

    Returns
    -------
    EstimatedNumber
        [N]
    """
    return within(
        DNV[kind] * (diameter * power / 1000.0 * 0.95) ** (2.0 / 3.0),
        0.15,
        "DNV-ST-0111, 5 % lost in gears",
    )


def most_thrust(kind: str, diameter: float, power: float, density: float) -> float:
    """Thrust at the bollard that no propeller of this kind exceeds: momentum theory without losses.

    Parameters
    ----------
    kind : str
        As of `bollard_thrust`. In a duct the race does not contract.
    diameter, power, density : float
        [m, W, kg/m3]

    Returns
    -------
    float
        [N]
    """
    # Momentum theory: T = (2 rho A P^2)^(1/3); in a duct without contraction the factor is 4.
    disc = 0.25 * pi * diameter**2
    return ((2.0 if kind == "open" else 4.0) * density * disc * power**2) ** (1.0 / 3.0)


def shaft_speed(kind: str, diameter: float, thrust: float, density: float) -> EstimatedNumber:
    """Largest speed of the shaft, by a usual thrust coefficient.

    Parameters
    ----------
    kind : str
        As of `bollard_thrust`.
    diameter, thrust, density : float
        [m, N, kg/m3]

    Returns
    -------
    EstimatedNumber
        [rpm]
    """
    # n from KT = T / (rho n^2 D^4).
    rpm = 60.0 * sqrt(thrust / (density * USUAL_KT[kind] * diameter**4))
    return within(rpm, 0.15, f"KT {USUAL_KT[kind]} at the bollard; assumed")


def curves(screw: Screw) -> dict[str, EstimatedNumber]:
    """Thrust and torque of a propeller in four quadrants, through its bollard points.

    Parameters
    ----------
    screw : Screw
        The propeller.

    Returns
    -------
    dict of str to Estimate
        Tables thrust_polynomial, torque_polynomial, thrust_factors, torque_factors.

    Notes
    -----
    KT falls to 0 at J0, 2.4 KT of an open propeller, along KT (1 - 0.75 J/J0 - 0.25 J²/J0²), KQ to a third of its
    bollard value; in the other quadrants the series B4-70 is scaled to meet them and the thrust astern.
    """
    # Advance ratio at no thrust; the polynomials hold to 0.9 of it.
    zero = ZERO_THRUST[screw.kind] * screw.thrust_coefficient
    end = 0.9 * zero
    last = degrees(atan(0.9 * zero / TIP))
    # KT = KT0 (1 - 0.75 J/J0 - 0.25 J^2/J0^2), KQ falls to a third.
    thrust = (screw.thrust_coefficient, -0.75 / zero, -0.25 / zero**2)
    torque = (screw.torque_coefficient, -0.5 / zero, -0.17 / zero**2)
    # Values of both polynomials at their end.
    at_end = [k * (1.0 + a * end + b * end**2) for k, a, b in (thrust, torque)]
    # Series B4-70 at the bollard, at the end of the polynomials, and astern at the bollard.
    beta = np.radians([0.0, last, -180.0])
    bollard, beyond, back = (np.array(pair) for pair in zip(*series(beta), strict=True))
    # The series is a function of the angle of advance, tan(beta) = J / (0.7 pi):
    # C = K cos^2(beta) / (pi/8 (0.7 pi)^2).
    slope = np.cos(beta[1]) ** 2
    # Factors that make the series meet the bollard point, the
    # end of the polynomial and thrust astern.
    ahead = np.array([thrust[0], torque[0]]) / _DISC / bollard
    ends = np.array(at_end) * slope / _DISC / beyond
    astern = -np.array([ASTERN[screw.kind] * thrust[0], torque[0]]) / _DISC / back
    source = "form of the series B4-70, scaled to the bollard points"
    estimates = {}
    # Polynomials over the advance ratio up to that angle, and factors on the series elsewhere.
    for i, (name, (k, a, b)) in enumerate((("thrust", thrust), ("torque", torque))):
        estimates[f"{name}_polynomial"] = EstimatedNumber(
            f"{last:.4g} {k:.5g} {k * a:.5g} {k * b:.5g} 0", 0.0, source
        )
        rows = f"-180 {astern[i]:.4g}; -90 1; 0 {ahead[i]:.4g}; {last:.4g} {ends[i]:.4g}; 90 1; 180 {astern[i]:.4g}"
        estimates[f"{name}_factors"] = EstimatedNumber(rows, 0.0, source)
    return estimates


def drive(screw: Screw, rise: float) -> dict[str, EstimatedNumber]:
    """Motor and drive of a propeller.

    Parameters
    ----------
    screw : Screw
        The propeller.
    rise : float
        Time from no thrust to full thrust. [s]

    Returns
    -------
    dict of str to Estimate
        thrust_rate, rpm_max, torque_max, power_max, inertia, friction, proportional_gain, integral_gain.
    """
    # Smogeli's rule for the rotating mass; tunnels have light propellers.
    inertia = 24.0 * screw.diameter**5 * (0.3 if screw.kind == "tunnel" else 1.0)
    # A small floor keeps the gains of model boats above zero.
    inertia = max(inertia, 1e-5)
    return {
        "thrust_rate": EstimatedNumber(
            screw.thrust / rise, 0.0, f"full thrust in {rise:g} s; assumed"
        ),
        "rpm_max": EstimatedNumber(1.02 * screw.rpm, 0.0, "2 % above that of full thrust; assumed"),
        "torque_max": EstimatedNumber(
            1.05 * screw.torque, 0.0, "5 % above that of full power; assumed"
        ),
        "power_max": EstimatedNumber(1.05 * screw.power, 0.0, "5 % above the motor's; assumed"),
        "inertia": EstimatedNumber(inertia, 0.0, "24 kg/m3 D^5, Smogeli 2006, of a unit of 4 m"),
        "friction": EstimatedNumber(
            0.01 * screw.torque / (screw.rpm * pi / 30.0), 0.0, "1 % at full speed; assumed"
        ),
        "proportional_gain": EstimatedNumber(RESPONSE * inertia, 0.0, "5 1/s times the inertia"),
        "integral_gain": EstimatedNumber(RESPONSE * INTEGRAL * inertia, 0.0, "k_p over 0.5 s"),
    }
