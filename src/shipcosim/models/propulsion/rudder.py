"""A propeller with a rudder in its race, by the MMG standard method.

The thrust is that of the propeller's own polynomial in the wake of the hull, which grows thinner with drift and
turning; the rudder works in the race and in the flow that the hull has straightened, and the force on it acts on the
hull ahead of it too.

References
----------
Yasukawa and Yoshimura, Introduction of MMG standard method for ship maneuvering predictions, J Mar Sci Technol 20,
2015, 37-52.
"""

from dataclasses import dataclass

from shipcosim.models.core.maths import Arithmetic, atan2, cos, exp, maximum, pi, sin, sqrt, where
from shipcosim.models.core.motion import Vector
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.propulsion.thruster import LOSS, Loads

_TINY = 1e-12  # m2/s2, keeps the derivative of the square root finite


@dataclass(frozen=True, kw_only=True)
class PropellerRudderParameters:
    """A propeller and the rudder behind it, on the centreline."""

    diameter: float = required("m", "propeller diameter", minimum=0.01)
    propeller_x: float = required("m", "position of the propeller forward", share=0.02)
    k0: float = required("1", "KT at no advance", share=0.03, minimum=0.0)
    k1: float = required("1", "KT over the advance ratio", share=0.03)
    k2: float = required("1", "KT over the squared advance ratio", share=0.05)
    astern: float = quantity(
        0.5,
        "1",
        "thrust astern over ahead at no advance",
        "assumed, open propeller",
        tolerance=0.1,
        minimum=0.0,
    )
    wake: float = required(
        "1", "wake fraction at the propeller, straight ahead", tolerance=0.03, maximum=1.0
    )
    wake_rate: float = quantity(
        0.0, "1", "C1: how soon drift thins the wake", "wake as straight ahead", share=0.1
    )
    wake_change_starboard: float = quantity(
        1.0,
        "1",
        "C2 for drift to starboard of the propeller's flow, beta_P > 0",
        "no change",
        tolerance=0.1,
    )
    wake_change_port: float = quantity(1.0, "1", "C2 for beta_P < 0", "no change", tolerance=0.1)
    thrust_deduction: float = required("1", "t_P", tolerance=0.03, maximum=1.0)

    rudder_x: float = required("m", "position of the rudder forward", share=0.02)
    rudder_area: float = required("m2", "area of the movable rudder", share=0.02, minimum=1e-6)
    lift_gradient: float = required(
        "1", "f_alpha: normal force over the sine of the inflow angle", share=0.05
    )
    covered: float = required(
        "1", "eta: propeller diameter over rudder span", share=0.02, minimum=0.0
    )
    race_gain: float = required(
        "1", "kappa: share of the race's gain of speed at the rudder", share=0.1, minimum=0.0
    )
    wake_ratio: float = required(
        "1", "epsilon: 1 - wake at the rudder over that at the propeller", share=0.05
    )
    straightening_starboard: float = required("1", "gamma_R for beta_R > 0", share=0.1)
    straightening_port: float = required("1", "gamma_R for beta_R < 0", share=0.1)
    straightening_x: float = required(
        "m", "l_R: where the yaw rate counts for the rudder's inflow", share=0.1
    )
    rudder_deduction: float = required(
        "1", "t_R: loss of the rudder's drag", tolerance=0.05, maximum=1.0
    )
    hull_share: float = required(
        "1", "a_H: side force on the hull over that on the rudder", share=0.1
    )
    hull_x: float = required("m", "x_H: where the side force on the hull acts", share=0.05)
    water_density: float = quantity(
        1025.0, "kg/m3", "density of the water", "sea water", minimum=1.0
    )
    thrust_loss: float = quantity(0.0, "1", LOSS, "neutral; k0 has the tolerance", maximum=1.0)


def propeller_in_wake(
    n: Arithmetic,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    *,
    unit: PropellerRudderParameters,
) -> Vector:
    """Thrust of a propeller behind a hull, and the speed of the water that reaches it.

    With the drift angle at the propeller β_P = atan2(-(v + x_P r), abs(u)),

        u_P = u (1 - w) (1 + (1 - exp(-C1 abs(β_P))) (C2 - 1)),
        T = ρ (k0 D⁴ n abs(n) + k1 D³ abs(n) u_P + k2 D² u_P abs(u_P)),

    which is ρ n² D⁴ KT(J) ahead; k0 counts as less astern.

    Parameters
    ----------
    n : float or (...) array or tensor
        Speed of the shaft, negative astern. [rev/s]
    u_r, v_r, r : like n
        Velocity of the ship through the water, yaw rate. [m/s, m/s, rad/s]
    unit : PropellerRudderParameters
        The propeller.

    Returns
    -------
    tuple of two, like n
        Thrust without its deduction, speed of advance. [N, m/s]

    References
    ----------
    As the module; that the angle is of the velocity at the propeller, and the law astern, are assumed.
    """
    p = unit
    D = unit.diameter
    # Drift angle at the propeller; to either side the wake changes by its own C2.
    drift = atan2(-(v_r + p.propeller_x * r), abs(u_r))
    change = where(drift < 0.0, p.wake_change_port, p.wake_change_starboard)
    # Speed of advance: u (1 - w), where drift reduces the wake w.
    u_p = u_r * (1.0 - p.wake) * (1.0 + (1.0 - exp(-p.wake_rate * abs(drift))) * (change - 1.0))
    # Thrust by the K_T polynomial, written in n and u_p, so that it is defined at n = 0.
    k0 = p.k0 * where(n < 0.0, p.astern, 1.0)
    thrust = k0 * D**4 * n * abs(n) + p.k1 * D**3 * abs(n) * u_p + p.k2 * D**2 * u_p * abs(u_p)
    return (1.0 - p.thrust_loss) * p.water_density * thrust, u_p


def rudder_normal_force(
    angle: Arithmetic,
    thrust: Arithmetic,
    u_p: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    *,
    unit: PropellerRudderParameters,
) -> Arithmetic:
    """Normal force on a rudder in the race of a propeller.

    With the gain of speed in the race from the thrust, u_∞² = u_P² + 8 T/(π ρ D²),

        u_R² = ε² (η (u_P + κ (u_∞ - u_P))² + (1 - η) u_P²),  v_R = γ (-v - l_R r),
        F_N = ρ/2 A_R (u_R² + v_R²) f_α sin(δ - atan2(v_R, u_R)).

    Parameters
    ----------
    angle : float or (...) array or tensor
        Rudder angle δ, positive to starboard, which turns the ship to starboard. [rad]
    thrust, u_p : like angle
        As `propeller_in_wake`. [N, m/s]
    v_r, r : like angle
        Velocity of the ship through the water to starboard, yaw rate. [m/s, rad/s]
    unit : PropellerRudderParameters
        The rudder.

    Returns
    -------
    like angle
        Force, positive where it turns the ship to starboard. [N]

    References
    ----------
    As the module; -v stands for U β, which differs by 2 % at 20 deg of drift. Thrust astern does not reach the rudder
    (assumed), and neither does the flow of a ship that goes astern: there u_R is that of the race alone.
    """
    p = unit
    # The race's gain of speed from the thrust (momentum theory): u_∞² = u_P² + 8 T / (π ρ D²).
    ahead = maximum(u_p, 0.0 * u_p)
    race = 8.0 * maximum(thrust, 0.0 * thrust) / (pi * p.water_density * p.diameter**2)
    behind = sqrt(ahead * ahead + race + _TINY)
    # At the rudder only a part of that gain is reached.
    inner = ahead + p.race_gain * (behind - ahead)
    # Mean of the squares over the part of the rudder inside the race and the part outside.
    u_rudder = p.wake_ratio * sqrt(
        p.covered * inner * inner + (1.0 - p.covered) * ahead * ahead + _TINY
    )
    # Cross flow at the rudder, straightened by hull and propeller.
    across = -v_r - p.straightening_x * r
    v_rudder = across * where(across < 0.0, p.straightening_port, p.straightening_starboard)
    # Normal force of a thin rudder: ρ/2 A f_α V² sin(inflow angle).
    square = u_rudder * u_rudder + v_rudder * v_rudder
    size = 0.5 * p.water_density * p.rudder_area * p.lift_gradient
    return size * square * sin(angle - atan2(v_rudder, u_rudder))


def propeller_rudder_loads(
    n: Arithmetic,
    azimuth: Arithmetic,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    *,
    unit: PropellerRudderParameters,
) -> Loads:
    """Load of a propeller and its rudder on the ship.

    Parameters
    ----------
    n : float or (...) array or tensor
        Speed of the shaft, negative astern. [rev/s]
    azimuth : like n
        Direction into which the rudder turns the race, clockwise from the bow as that of an azimuth thruster: positive
        turns the ship to port. [rad]
    u_r, v_r, r : like n
        Velocity of the ship through the water, yaw rate. [m/s, m/s, rad/s]
    unit : PropellerRudderParameters
        Propeller and rudder.

    Returns
    -------
    Loads
        Thrust of the propeller after its deduction, side force of the rudder alone, and their load.

    References
    ----------
    As the module.
    """
    p = unit
    # A positive rudder angle turns the ship to starboard, a positive azimuth to port: opposite
    # signs.
    thrust, u_p = propeller_in_wake(n, u_r, v_r, r, unit=p)
    normal = rudder_normal_force(-azimuth, thrust, u_p, v_r, r, unit=p)
    side = -normal * cos(azimuth)
    # Thrust deduction: the propeller's suction adds resistance. The rudder's drag is reduced
    # likewise.
    given = (1.0 - p.thrust_deduction) * thrust
    surge = given + (1.0 - p.rudder_deduction) * normal * sin(azimuth)
    # The rudder's side force also acts on the hull in front of it, a_H of it at x_H.
    return Loads(
        given,
        side,
        surge,
        (1.0 + p.hull_share) * side,
        (p.rudder_x + p.hull_share * p.hull_x) * side,
    )
