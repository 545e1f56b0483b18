"""Steering trials: the helm of a turning circle or of a zig-zag, and what is read off the ship's motion meanwhile.

References
----------
IMO, Standards for ship manoeuvrability, resolution MSC.137(76), 2002: the trials, and the names of what is read off.
"""

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, clip, cos, maximum, sin, where
from shipcosim.models.core.motion import Triple
from shipcosim.models.core.parameters import quantity


@dataclass(frozen=True, kw_only=True)
class SteeringTrialParameters:
    """What is ordered."""

    helm: float = quantity(
        0.6108652381980153,
        "rad",
        "angle of the helm (35 deg), positive turns the ship to starboard; of a zig-zag to its first side",
        "MSC.137(76), turning circle",
    )
    check: float = quantity(
        0.0,
        "rad",
        "change of heading at which the helm of a zig-zag is put over; 0: a turning circle",
        "choice",
        minimum=0.0,
    )
    helm_rate: float = quantity(
        0.040491638646268445,
        "rad/s",
        "rate at which the helm moves (65 deg in 28 s)",
        "SOLAS II-1/29, least rate of a steering gear",
        minimum=1e-4,
    )
    order_time: float = quantity(
        0.0, "s", "time of the first order; straight ahead until then", "choice", minimum=0.0
    )


class TrialState(NamedTuple):
    """How far a trial has gone.

    Parameters
    ----------
    x, y, psi : float or (...) array or tensor
        Position and heading at the first order; the ship's own until then. [m, m, rad]
    last_psi : like x
        Heading a step before. [rad]
    helm : like x
        Helm now, positive turns the ship to starboard. [rad]
    turned : like x
        Change of heading since the first order, clockwise, not wrapped. [rad]
    side : like x
        1 while the helm is to the first side, -1 to the other. [1]
    reversals : like x
        How often the helm was put over. [1]
    advance, transfer : like x
        Way along the first heading, and across it to the side of the turn, until she has turned by 90 deg. [m, m]
    tactical_diameter : like x
        Way across until she has turned by 180 deg. [m]
    overshoot_1, overshoot_2 : like x
        How far she turned on beyond the check angle after the first and the second time the helm was put over. [rad]
    """

    x: Arithmetic
    y: Arithmetic
    psi: Arithmetic
    last_psi: Arithmetic
    helm: Arithmetic = 0.0
    turned: Arithmetic = 0.0
    side: Arithmetic = 1.0
    reversals: Arithmetic = 0.0
    advance: Arithmetic = 0.0
    transfer: Arithmetic = 0.0
    tactical_diameter: Arithmetic = 0.0
    overshoot_1: Arithmetic = 0.0
    overshoot_2: Arithmetic = 0.0


def step(
    state: TrialState, t: float, motion: Triple, h: float, *, parameters: SteeringTrialParameters
) -> TrialState:
    """Trial one step later.

    Parameters
    ----------
    state : TrialState
        Trial at the start of the step.
    t : float or (...) array or tensor
        Time of the motion. [s]
    motion : tuple of three floats or (...) arrays or tensors
        Position north and east, heading. [m, m, rad]
    h : float
        Step. [s]
    parameters : SteeringTrialParameters
        What is ordered.

    Returns
    -------
    TrialState
        Trial at the end of the step.

    Notes
    -----
    What is read off is that of the last step before she has turned so far: at most a step's way short.

    References
    ----------
    MSC.137(76).
    """
    x, y, psi = motion
    has_begun = t >= parameters.order_time
    first_side = where(parameters.helm < 0.0, -1.0, 1.0)
    # Until the first order, the trial begins where the ship is.
    begun_x = where(has_begun, state.x, x)
    begun_y = where(has_begun, state.y, y)
    begun_psi = where(has_begun, state.psi, psi)
    turned = where(has_begun, state.turned + wrap(psi - state.last_psi), 0.0)
    # A zig-zag's helm is put over when she has turned by the check angle to the side of the helm.
    is_over = (parameters.check > 0.0) & (turned * first_side * state.side >= parameters.check)
    side = where(is_over, -state.side, state.side)
    reversals = state.reversals + where(is_over, 1.0, 0.0)
    # The helm moves towards what is ordered at a limited rate.
    ordered = where(has_begun, side * parameters.helm, 0.0)
    most = parameters.helm_rate * h
    helm = state.helm + clip(ordered - state.helm, -most, most)
    # Way along and across the first heading, read off until she has turned by 90 and by 180 deg.
    along = (x - begun_x) * cos(begun_psi) + (y - begun_y) * sin(begun_psi)
    across = (y - begun_y) * cos(begun_psi) - (x - begun_x) * sin(begun_psi)
    is_quarter = turned * first_side < 0.5 * pi
    is_half = turned * first_side < pi
    # Beyond the check angle she turns on, to the side that the helm has left.
    beyond = -side * first_side * turned - parameters.check
    return TrialState(
        begun_x,
        begun_y,
        begun_psi,
        psi,
        helm,
        turned,
        side,
        reversals,
        where(is_quarter, along, state.advance),
        where(is_quarter, first_side * across, state.transfer),
        where(is_half, first_side * across, state.tactical_diameter),
        where(reversals == 1.0, maximum(state.overshoot_1, beyond), state.overshoot_1),
        where(reversals == 2.0, maximum(state.overshoot_2, beyond), state.overshoot_2),
    )
