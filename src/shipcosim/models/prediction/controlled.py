"""Predict motion under DP: dead reckoning with reference, control law and thrust limits.

Dead reckoning holds the thrust of this moment. A controller holds the ship instead, or brings her to where she is ordered
to go: so it is run along the horizon, by the functions that it runs on itself.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.allocation.units import Allocated
from shipcosim.models.control import observer, pid, reference
from shipcosim.models.control.observer import DpShip, StateEstimate
from shipcosim.models.control.pid import ControlParameters, ControlState
from shipcosim.models.control.reference import ReferenceParameters, ReferenceState
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.maths import exp
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import quantity, required
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.dead_reckoning import advance, at_horizons
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.vessel import through_water

NOTHING = 1e-3
"""Thrust limit below which a unit counts as missing. [N]"""


@dataclass(frozen=True, kw_only=True)
class ObserverAhead:
    """Parameters of the observer along the horizon."""

    full_frequency: float = required(
        "rad/s", "wave frequency below which the control law slows down", minimum=0.1
    )
    bias_time: float = quantity(
        30.0,
        "s",
        "time in which the observer's bias follows its load",
        "chosen by seeds 300-311",
        minimum=0.1,
    )


class ControlLoop(NamedTuple):
    """The DP loop as the ship knows it.

    Parameters
    ----------
    reference : ReferenceParameters
        Of the reference model.
    ship : DpShip
        The ship in observer and control law.
    law : ControlParameters
        Of the control law.
    units : AllocationParameters
        Thrusters with their limits.
    design : Design
        Made of the same units by `pseudo_inverse.design`.
    observer : ObserverAhead
        Its parameters along the horizon.
    """

    reference: ReferenceParameters
    ship: DpShip
    law: ControlParameters
    units: AllocationParameters
    design: pseudo_inverse.ThrusterInverses
    observer: ObserverAhead


class _Now(NamedTuple):
    """The loop at one time: `motion` as `advance`, `bias` north, east, N, `before` last load."""

    motion: tuple
    desired: ReferenceState
    control: ControlState
    allocated: Allocated
    bias: Load
    before: Load


def predict(
    known: Known,
    surroundings: Surroundings,
    *,
    horizons: tuple[float, ...],
    longest_step: float,
    hull: HullParameters,
    wind: WindParameters,
    loop: ControlLoop,
) -> tuple[Motion, ...]:
    """Predict the motion of the ship together with her controller.

    Parameters
    ----------
    known : Known
        State now, desired motion, where it goes to, and the sea; floats, (...) arrays or tensors.
    surroundings : Surroundings
        Held, as in dead reckoning.
    horizons : tuple of float, increasing
        How far ahead. [s]
    longest_step : float
        Longest step; each stretch up to a horizon is divided into equal steps. [s]
    hull, wind : HullParameters, WindParameters
        The ship.
    loop : ControlLoop
        Her DP.

    Returns
    -------
    tuple of Motion
        One per horizon.

    Notes
    -----
    The estimate is taken to be right, except for the bias, which follows its load in `bias_time`. A unit
    that gives nothing now is missing. The load over a step is that of its middle, on the line through the last two.

    References
    ----------
    Equations of motion as `dead_reckoning.predict`; reference, control law and allocation as the functions of those
    modules. Running the controller ahead: Skulstad, Data-based modelling of ships, NTNU 2021, research question 5.
    """
    # Start with all parts of the loop at the present state.
    now = _start(known, surroundings, wind, loop)
    # A thruster without thrust now is taken as missing for the whole horizon.
    available = tuple(abs(thrust) > NOTHING for thrust in now.allocated.thrusts)
    return at_horizons(
        lambda now, h: _later(now, known, surroundings, available, h, hull, wind, loop),
        lambda now: Motion(*now.motion[:6]),
        now,
        horizons=horizons,
        longest_step=longest_step,
    )


def _start(known, around, wind, loop):
    """The loop now. The thrusters' load gives their thrusts and the last request."""
    ship = known.ship
    units = loop.units
    # Feedforward of the wind, as far as the controller believes its anemometer.
    fed = [
        known.wind_believed * load
        for load in wind_loads(known.wind_speed, known.wind_from, wind=wind)
    ]
    # A long step lets the allocation reach the present load, whatever its rate limits.
    rest = pseudo_inverse.at_rest(known.thrusters, parameters=units)
    all_of_them = {"available": (True, True, True), "parameters": units, "design": loop.design}
    return _Now(
        (
            *ship,
            *through_water(ship.psi, ship.u, ship.v, around.current_north, around.current_east),
        ),
        reference.resumed(known.desired, parameters=loop.reference),
        ControlState(*fed, *known.thrusters),
        pseudo_inverse.step(rest, known.thrusters, h=1e9, **all_of_them),
        (*to_ned(ship.psi, *known.bias[:2]), known.bias[2]),
        known.thrusters,
    )


def _later(now, known, around, available, h, hull, wind, loop):
    """The loop a step later: ship with the mid-step load, then reference, law and allocator."""
    given = now.allocated.tau_X, now.allocated.tau_Y, now.allocated.tau_N
    # Extrapolate the load to the middle of the step; add the known error of thrust.
    middle = tuple(
        new + 0.5 * (new - old) + error
        for new, old, error in zip(given, now.before, around.thrust_error, strict=True)
    )
    motion = advance(now.motion, middle, around, h, hull=hull, wind=wind)
    desired = reference.step(now.desired, known.goal, h, parameters=loop.reference)
    psi, u, v = motion[2:5]
    # Wind load at the new state; the same functions run on board.
    load = wind_loads(*apparent_wind(psi, u, v, around.wind_north, around.wind_east), wind=wind)
    bias = _bias(now, motion, known, around, load, h, hull, loop)
    fed = tuple(known.wind_believed * part for part in load)
    pace = observer.pace(known.wave_frequency, loop.observer.full_frequency)
    # The estimate is taken as perfect, apart from the bias.
    estimate = StateEstimate(*motion[:6], *bias, pace=pace)
    control = pid.step(now.control, estimate, desired, fed, h, ship=loop.ship, parameters=loop.law)
    allocated = pseudo_inverse.step(
        now.allocated, control[3:], available, h, parameters=loop.units, design=loop.design
    )
    return _Now(motion, desired, control, allocated, bias, given)


def _bias(now, motion, known, around, wind_load, h, hull, loop):
    """The observer's bias a step later: it follows the load that thrust and wind do not explain."""
    _, _, psi, u, v, r, u_r, v_r = motion
    # Remaining load: hull, remaining force, thrust error and the disbelieved part of the wind. The
    # observer's own damping is not part of the bias.
    X, Y, N = hull_loads(u_r, v_r, r, hull=hull)
    force_X, force_Y = to_body(psi, around.force_north, around.force_east)
    lost = 1.0 - known.wind_believed
    ship = loop.ship
    share = 1.0 - exp(-h / loop.observer.bias_time)
    error_X, error_Y, error_N = around.thrust_error
    X = X + force_X + error_X + lost * wind_load[0] + ship.damping_surge * u
    Y = Y + force_Y + error_Y + lost * wind_load[1] + ship.damping_sway * v
    N = N + around.moment + error_N + lost * wind_load[2] + ship.damping_yaw * r
    # The bias is kept in north-east and follows with a lag of first order.
    left = (*to_ned(psi, X, Y), N)
    return tuple(old + share * (new - old) for old, new in zip(now.bias, left, strict=True))
