"""Added mass, inertia, cross-flow drag and manoeuvring derivatives of a hull from her main particulars.

References
----------
Söding, Prediction of ship steering capabilities, Schiffstechnik 29, 1982. Clarke, Gedling and Hine, The application of
manoeuvring criteria in hull design using linear theory, Trans. RINA 125, 1983. Hoerner, Fluid-Dynamic Drag, 1965, the
curve over breadth and draught as in Faltinsen, Sea Loads on Ships and Offshore Structures, Cambridge, 1990, ch. 6.
"""

from dataclasses import dataclass
from math import hypot, pi, sqrt

import numpy as np

from shipcosim.models.core.constants import GRAVITY
from shipcosim.ships.estimates.estimate import EstimatedNumber, within

SODING = "Söding 1982: 2.7 rho V^(5/3)/L^2"
CLARKE = "Clarke, Gedling and Hine 1983"
_HOERNER = (
    (0.0, 0.35, 0.45, 0.50, 0.56, 0.65, 0.83, 1.0, 1.3, 1.65, 2.3, 3.0, 4.0),
    (1.97, 1.90, 1.79, 1.20, 1.08, 1.00, 0.88, 0.83, 0.76, 0.69, 0.63, 0.59, 0.56),
)
"""Half breadth over draught, drag coefficient."""
FLATTEST = 8.0
"""Breadth over draught at which that curve ends. [1]"""
TIME_CONSTANTS = {"X_u": 30.0, "Y_v": 18.0, "N_r": 9.4}
"""Time constants of linear damping, over the root of length and gravity; fitted to the models in
docs/generated/ship-estimates.md. [1]"""
SLOW_FROUDE = 0.04
"""Over which it fades: 1.1 m/s of a ship of 76 m, twice the speeds of DP; assumed. [1]"""


@dataclass(frozen=True, kw_only=True)
class HullDimensions:
    """Main particulars of a hull, or of each of the hulls that she has.

    Attributes
    ----------
    length, breadth, draught : float
        Between perpendiculars; of the waterline of one hull; mean. [m]
    block : float
        Block coefficient. [1]
    hulls : int
        Number of equal hulls. [1]
    density : float
        Of the water. [kg/m3]
    speed : float
        Service speed. [m/s]
    """

    length: float
    breadth: float
    draught: float
    block: float
    hulls: int
    density: float
    speed: float

    @property
    def volume(self) -> float:
        """Displaced by all hulls. [m3]"""
        return self.hulls * self.block * self.length * self.breadth * self.draught

    @property
    def mass(self) -> float:
        """Mass of the displaced water. [kg]"""
        return self.density * self.volume


def added_masses(form: HullDimensions) -> dict[str, EstimatedNumber]:
    """Added mass at low frequency; sway is Clarke's, yaw follows from it by strip theory.

    Of two hulls each counts for itself: what one does to the other is left out.

    Parameters
    ----------
    form : HullDimensions
        The hull.

    Returns
    -------
    dict of str to Estimate
        A11, A22, A26, A62, A66. [kg, kg, kg.m, kg.m, kg.m2]

    Notes
    -----
    The yaw moment has the gyration radius of the strips' added mass: 0.29 L of a box, 0.19 L of a hull with fine ends.
    Clarke's own formula for it falls below a tenth of that for ships as broad as a third of their length.
    """
    L = form.length
    B = form.breadth
    T = form.draught
    rho = form.density
    # Each hull counts for itself.
    volume = form.volume / form.hulls
    # Surge: Söding's formula from volume and length.
    A11 = 2.7 * rho * volume ** (5.0 / 3.0) / L**2
    # Sway: Clarke, Gedling and Hine; a floor for hulls broader than their data.
    sway = 1.0 + 0.16 * form.block * B / T - 5.1 * (B / L) ** 2
    A22 = 0.5 * rho * L**3 * pi * (T / L) ** 2 * max(sway, 0.3)
    # Coupling of sway and yaw: zero, with the uncertainty of its lever.
    lever = 0.05 * L
    share = form.hulls
    # Of a hull flatter than the formulae's only the order of magnitude is known.
    flat = B / T > FLATTEST
    coupling = EstimatedNumber(
        0.0, share * lever * A22, "0: acts midships; tolerance 0.05 L of the added mass in sway"
    )
    return {
        "A11": EstimatedNumber(
            share * A11,
            max(0.3 * share * A11, 0.08 * form.mass),
            f"{SODING}; tolerance 8 % of the mass",
        ),
        "A22": within(share * A22, 2.0 if flat else 0.4, CLARKE),
        "A26": coupling,
        "A62": coupling,
        "A66": within(
            share * A22 * (0.23 * L) ** 2,
            2.0 if flat else 0.5,
            f"strips of {CLARKE}'s added mass in sway, gyration 0.23 L",
        ),
    }


def inertia_yaw(mass: float, length: float, breadth: float, centre_x: float) -> EstimatedNumber:
    """Moment of inertia about midships, with a gyration radius of a quarter of the length.

    Parameters
    ----------
    mass : float
        Of the ship. [kg]
    length, breadth : float
        Between perpendiculars; of the whole ship. [m]
    centre_x : float
        Centre of gravity forward of midships. [m]

    Returns
    -------
    EstimatedNumber
        [kg.m2]
    """
    # Inertia about the centre of gravity, then Steiner's term to midships.
    about_centre = mass * (0.25 * length) ** 2
    # A box has m (L² + B²) / 12: what its breadth adds is unknown of a ship.
    tolerance = hypot(0.15 * about_centre, mass * breadth**2 / 12.0)
    return EstimatedNumber(
        about_centre + mass * centre_x**2,
        tolerance,
        "gyration radius 0.25 L, Fossen 2021; tolerance 15 % and the breadth of a box",
    )


def cross_flow_drag(form: HullDimensions) -> EstimatedNumber:
    """Drag coefficient of the hull in sway, by breadth over draught.

    Parameters
    ----------
    form : HullDimensions
        The hull.

    Returns
    -------
    EstimatedNumber
        [1]

    Notes
    -----
    The tolerance is wide: published values of ships go from 0.6 to 1.5.
    """
    return within(
        float(np.interp(0.5 * form.breadth / form.draught, *_HOERNER)),
        0.6,
        "Hoerner's curve over B/(2T)",
    )


def manoeuvring_derivatives(form: HullDimensions, sway_mass: float) -> dict[str, EstimatedNumber]:
    """Linear derivatives under way, which hold the added mass' Coriolis load already.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    sway_mass : float
        Added mass in sway. [kg]

    Returns
    -------
    dict of str to Estimate
        Y_uv, Y_ur, N_uv, N_ur, X_rv; and added_mass_coriolis, 0.
    """
    L = form.length
    B = form.breadth
    T = form.draught
    Cb = form.block
    # Clarke's derivatives are non-dimensional with 1/2 rho L^n and pi (T/L)^2.
    scale = 0.5 * form.density * form.hulls * pi * (T / L) ** 2
    return {
        "added_mass_coriolis": EstimatedNumber(0.0, 0.0, f"the derivatives of {CLARKE} hold it"),
        "Y_uv": within(-scale * L**2 * (1.0 + 0.40 * Cb * B / T), 0.3, CLARKE),
        "Y_ur": within(scale * L**3 * (0.5 - 2.2 * B / L + 0.08 * B / T), 0.5, CLARKE),
        "N_uv": within(
            -scale * L**3 * (0.5 + 2.4 * T / L), 0.5, f"{CLARKE}; the Mariner has 0.64 of it"
        ),
        "N_ur": within(-scale * L**4 * max(0.25 + 0.039 * B / T - 0.56 * B / L, 0.1), 0.3, CLARKE),
        "X_rv": within(
            0.7 * sway_mass,
            0.3,
            "0.7 of the added mass in sway; assumed, as MMG derivatives have it",
        ),
    }


def linear_damping(
    form: HullDimensions, surge: float, sway: float, yaw: float
) -> dict[str, EstimatedNumber]:
    """Linear damping of a ship that hardly makes way, from time constants that grow with the root of her length.

    Parameters
    ----------
    form : HullDimensions
        The hull.
    surge, sway, yaw : float
        Mass and moment of inertia with the added ones. [kg, kg, kg.m2]

    Returns
    -------
    dict of str to EstimatedNumber
        X_u, Y_v, Y_r, N_v, N_r, linear_damping_speed.

    Notes
    -----
    The time constants are those with which this damping, and what else is estimated, comes nearest to six models that
    were identified at low speed, which differ among themselves by a factor of ten.

    References
    ----------
    Damping by time constants: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021,
    ch. 6. The six models: docs/generated/ship-estimates.md.
    """
    # D = M / T with time constants that grow with the root of the length.
    root = sqrt(form.length / GRAVITY)
    times = {name: constant * root for name, constant in TIME_CONSTANTS.items()}
    masses = {"X_u": surge, "Y_v": sway, "N_r": yaw}
    values = {name: -masses[name] / times[name] for name in masses}
    estimates = {
        name: within(value, 1.5, f"time constant {times[name]:.3g} s; six ships near rest differ")
        for name, value in values.items()
    }
    # Sway by yaw can have either sign; beyond 1 it would drive her.
    share = 0.2 * sqrt(abs(values["Y_v"] * values["N_r"]))  # a mass below zero is reported later
    coupling = EstimatedNumber(
        0.0, share, "0; tolerance 0.2 of the root of Y_v N_r, as Fossen 1996"
    )
    speed = SLOW_FROUDE * sqrt(GRAVITY * form.length)
    source = f"Froude number {SLOW_FROUDE:g}, assumed; under way the derivatives hold"
    fading = EstimatedNumber(speed, 0.0, source)
    return {**estimates, "Y_r": coupling, "N_v": coupling, "linear_damping_speed": fading}
