"""Plain fixed thrusters: a force as commanded, or quadratic in the speed of the shaft."""

from dataclasses import dataclass

from shipcosim.models.core.maths import Arithmetic, maximum, sqrt, where
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.propulsion.mapped import mapped_loads
from shipcosim.models.propulsion.thruster import LOSS, Loads

_LEAST_COEFFICIENT = 1e-9  # N.s2/rad2, only to divide by
_LEAST_THRUST = 1e-9  # N, below which the shaft stands


@dataclass(frozen=True, kw_only=True)
class FixedParameters:
    """A thruster that does not turn. It takes a force, a speed, or both; what nothing feeds is 0."""

    x: float = required("m", "position forward", share=0.02)
    y: float = required("m", "position to starboard", share=0.02)
    direction: float = quantity(
        0.0, "rad", "direction of positive thrust, clockwise from the bow", "ahead"
    )
    gain_ahead: float = quantity(
        1.0, "1", "thrust over commanded force, ahead", "neutral", tolerance=0.02, minimum=0.0
    )
    gain_astern: float = quantity(
        1.0, "1", "thrust over commanded force, astern", "neutral", tolerance=0.02, minimum=0.0
    )
    coefficient_ahead: float = quantity(
        0.0,
        "N.s2/rad2",
        "thrust over squared speed of the shaft, ahead",
        "not used",
        share=0.02,
        minimum=0.0,
    )
    coefficient_astern: float = quantity(
        0.0,
        "N.s2/rad2",
        "thrust over squared speed of the shaft, astern",
        "not used",
        share=0.02,
        minimum=0.0,
    )
    speed_loss: float = quantity(
        0.0,
        "s/m",
        "share of the thrust that each m/s of advance in its direction takes",
        "neutral",
        minimum=0.0,
    )
    thrust_loss: float = quantity(
        0.0, "1", LOSS, "neutral; gains and coefficients have the tolerance", maximum=1.0
    )


def fixed_loads(
    force: Arithmetic,
    speed: Arithmetic,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    *,
    thruster: FixedParameters,
) -> Loads:
    """Thrust of a fixed thruster and its load on the ship.

    With a commanded force F, a speed ω of the shaft, and the speed u_a of the water along the thruster,

        T = (gain F + coefficient ω abs(ω)) max(0, 1 - speed_loss u_a sign(T)),

    gain and coefficient ahead or astern by the sign of F and ω.

    Parameters
    ----------
    force : float or (...) array or tensor
        Commanded force, positive in the thruster's direction. [N]
    speed : like force
        Speed of the shaft. [rad/s]
    u_r, v_r, r : like force
        Velocity of the ship through the water, yaw rate. [m/s, m/s, rad/s]
    thruster : FixedParameters
        The thruster.

    Returns
    -------
    Loads
        Forces and load.

    References
    ----------
    Quadratic law: Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 9. The
    loss with speed is a straight line, assumed.

    Examples
    --------
    10 N on the starboard side turn the boat to port:

    >>> boat = FixedParameters(x=-0.4, y=0.3)
    >>> fixed_loads(10.0, 0.0, 0.0, 0.0, 0.0, thruster=boat)
    Loads(thrust=10.0, side_force=0.0, tau_X=10.0, tau_Y=0.0, tau_N=-3.0)
    """
    thrust = _static_thrust(force, speed, thruster)
    return mapped_loads(thrust, u_r, v_r, r, thruster=thruster)


def shaft_speed(force: Arithmetic, speed: Arithmetic, *, thruster: FixedParameters) -> Arithmetic:
    """Speed of the shaft that gives the thrust of `fixed_loads` in still water, as a log of the thruster has it.

    Parameters
    ----------
    force : float or (...) array or tensor
        Commanded force, positive in the thruster's direction. [N]
    speed : like force
        Speed that is commanded besides. [rad/s]
    thruster : FixedParameters
        Without coefficients a force says nothing of a speed, and the commanded one is given.

    Returns
    -------
    like force
        [rad/s]

    References
    ----------
    The quadratic law of `fixed_loads`, solved for ω.
    """
    thrust = _static_thrust(force, speed, thruster)
    coefficient = where(thrust < 0.0, thruster.coefficient_astern, thruster.coefficient_ahead)
    # The square root has no slope at 0, where a thrust is kept away from it.
    size = sqrt(maximum(abs(thrust), _LEAST_THRUST) / maximum(coefficient, _LEAST_COEFFICIENT))
    of_thrust = where(abs(thrust) < _LEAST_THRUST, 0.0, where(thrust < 0.0, -size, size))
    return where(coefficient > 0.0, of_thrust, speed)


def _static_thrust(force, speed, thruster):
    """Thrust without loss by advance. [N]"""
    # Ahead and astern have their own gains and coefficients.
    p = thruster
    thrust = force * where(force < 0.0, p.gain_astern, p.gain_ahead)
    return thrust + speed * abs(speed) * where(
        speed < 0.0, p.coefficient_astern, p.coefficient_ahead
    )
