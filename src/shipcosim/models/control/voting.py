"""Voting: from three position references, two compasses, rate gyro and anemometer to what observer and law use.

References
----------
`position_voting`, `compass_voting`; the wind's part: definition.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control import compass_voting, position_voting
from shipcosim.models.control.compass_voting import CompassVote, CompassVotingParameters
from shipcosim.models.control.observer import Measurement, StateEstimate
from shipcosim.models.control.position_voting import PositionVote, PositionVotingParameters
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic, choose, exp, minimum, where
from shipcosim.models.core.motion import Load, Motion
from shipcosim.models.core.parameters import quantity
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.ship.mast import MastParameters, wind_from_mast
from shipcosim.models.ship.sensor_messages import Telegrams, Wind


@dataclass(frozen=True, kw_only=True)
class VotingParameters(PositionVotingParameters, CompassVotingParameters):
    """Limits of the tests of all sensors."""

    wind_freeze_time: float = quantity(
        10.0,
        "s",
        "unchanged for so long while others change, the anemometer sticks",
        "assumed: ten samples",
    )
    wind_fade_time: float = quantity(
        60.0,
        "s",
        "time constant with which the wind's feedforward fades when the anemometer is rejected, and returns",
        "assumed: slow enough for the bias to take over",
        minimum=1e-3,
    )


class WindVote(NamedTuple):
    """State of the test of the anemometer.

    Parameters
    ----------
    wind : Wind
        Latest message; valid 1 where it is believed.
    unchanged : float or (...) array or tensor
        How long it has not changed. [s]
    share : like unchanged
        Share of the wind's load to feed forward. [1]
    load : tuple of three, like unchanged
        Load of the wind to feed forward. [N, N, N.m]
    """

    wind: Wind
    unchanged: Arithmetic
    share: Arithmetic
    load: Load


class VotingState(NamedTuple):
    """State of the voting.

    Parameters
    ----------
    positions : PositionVote
        Of the position references.
    compasses : CompassVote
        Of the compasses.
    wind : WindVote
        Of the anemometer.
    r : float or (...) array or tensor
        Yaw rate of the gyro. [rad/s]
    position_time, heading_time, wind_time : float
        Times of the latest samples. [s]
    position_new, heading_new : float
        1 where positions, or headings, came anew at the last step. [1]
    """

    positions: PositionVote
    compasses: CompassVote
    wind: WindVote
    r: Arithmetic
    position_time: float
    heading_time: float
    wind_time: float
    position_new: float
    heading_new: float


def start(
    t: float, telegrams: Telegrams, *, mast: MastParameters, wind: WindParameters
) -> VotingState:
    """State of the voting at the start, from the valid messages.

    Parameters
    ----------
    t : float
        Time. [s]
    telegrams : Telegrams
        First messages.
    mast : MastParameters
        Where the anemometer stands.
    wind : WindParameters
        Wind load coefficients.

    Returns
    -------
    VotingState
        State of the voting.
    """
    zero = 0.0 * telegrams.r
    given = telegrams.wind
    share = zero + given.valid
    return VotingState(
        position_voting.start(t, telegrams.positions),
        compass_voting.start(telegrams.compasses),
        WindVote(given, zero, share, _wind_load(given, share, (zero, zero, zero), mast, wind)),
        telegrams.r,
        *telegrams[4:],
        1.0,
        1.0,
    )


def step(
    t: float,
    state: VotingState,
    telegrams: Telegrams,
    estimate: StateEstimate,
    *,
    parameters: VotingParameters,
    mast: MastParameters,
    wind: WindParameters,
) -> tuple[VotingState, StateEstimate]:
    """State of the voting one sample later, from the messages that arrived.

    Parameters
    ----------
    t : float
        Time. [s]
    state : VotingState
        State at the last sample.
    telegrams : Telegrams
        Messages of the sensors.
    estimate : StateEstimate
        Of the observer at t.
    parameters : VotingParameters
        Limits.
    mast : MastParameters
        Where the anemometer stands.
    wind : WindParameters
        Wind load coefficients.

    Returns
    -------
    tuple of VotingState and Estimate
        State; and the estimate, moved to where positions are after dead reckoning.
    """
    # A message is new if its time differs from the last one's.
    heading_since = telegrams.heading_time - state.heading_time
    position_since = telegrams.position_time - state.position_time
    wind_since = telegrams.wind_time - state.wind_time
    unchanged = state.positions.unchanged
    quiet_positions = minimum(minimum(unchanged[0], unchanged[1]), unchanged[2])
    # Compasses first: the heading is needed for the velocity of the positions.
    compasses = choose(
        heading_since > 0.0,
        lambda: compass_voting.step(
            state.compasses,
            telegrams.compasses,
            telegrams.r,
            _heading_at(estimate, t - telegrams.heading_time),
            quiet_positions,
            heading_since,
            parameters=parameters,
        ),
        lambda: state.compasses,
    )
    quiet = minimum(*compasses.unchanged)

    # Positions: fade the shift of an earlier realignment first, and move the estimate with it.
    def with_new_positions():
        faded, north, east = position_voting.faded(
            state.positions, position_since, parameters=parameters
        )
        moved = estimate._replace(x=estimate.x + north, y=estimate.y + east)
        at = _at(moved, t - telegrams.position_time)
        voted = position_voting.step(
            t, faded, telegrams.positions, at, quiet, position_since, parameters=parameters
        )
        return voted, moved

    positions, estimate = choose(
        position_since > 0.0, with_new_positions, lambda: (state.positions, estimate)
    )
    # The anemometer counts as stuck only if other sensors change.
    quiet_all = minimum(quiet, positions.unchanged[0])
    air = choose(
        wind_since > 0.0,
        lambda: _wind(
            state.wind, telegrams.wind, quiet_all, wind_since, parameters, estimate, mast, wind
        ),
        lambda: state.wind,
    )
    came = where(position_since > 0.0, 1.0, 0.0), where(heading_since > 0.0, 1.0, 0.0)
    return VotingState(positions, compasses, air, telegrams.r, *telegrams[4:], *came), estimate


def measurement(state: VotingState) -> Measurement:
    """The measurement for the observer.

    Parameters
    ----------
    state : VotingState
        State of the voting.

    Returns
    -------
    Measurement
        Voted motion, and what of it is new and trusted.
    """
    # The measurement counts only where it is new and trusted.
    fix = state.positions.fix
    motion = Motion(fix.x, fix.y, state.compasses.psi, fix.u, fix.v, state.r)
    return Measurement(motion, state.position_new * fix.valid, state.heading_new)


def dead_reckoning_time(
    t: float, state: VotingState, *, parameters: VotingParameters
) -> Arithmetic:
    """Time since the last trusted position while the controller uses its model, else 0.

    Parameters
    ----------
    t : float
        Time. [s]
    state : VotingState
        State of the voting.
    parameters : VotingParameters
        Limits.

    Returns
    -------
    float or (...) array or tensor
        Time. [s]
    """
    age = t - state.positions.trusted_at
    return where(age > parameters.position_timeout, age, 0.0 * age)


def _heading_at(e, delay):
    """The observer's heading at a time before the estimate, wave motion included."""
    return e.psi + e.yaw_wave - delay * (e.r + e.r_wave)


def _at(e, delay):
    """Motion at a time before the estimate, wave motion included."""
    north, east = to_ned(
        e.psi, e.surge_wave - delay * (e.u + e.u_wave), e.sway_wave - delay * (e.v + e.v_wave)
    )
    return Motion(
        e.x + north, e.y + east, wrap(e.psi), e.u + e.u_wave, e.v + e.v_wave, e.r + e.r_wave
    )


def _wind(state, given, quiet, dt, p, estimate, mast, wind):
    """Test of the anemometer on a new message: stuck if it does not change while others do."""
    same = (given.speed == state.wind.speed) & (given.wind_from == state.wind.wind_from)
    unchanged = where(same, state.unchanged + dt, 0.0 * state.unchanged)
    stuck = (unchanged >= p.wind_freeze_time) & (quiet < p.wind_freeze_time)
    valid = where(stuck, 0.0, given.valid)
    # Fade the feedforward in and out: a step of the wind load would be a step of thrust.
    share = state.share + (1.0 - exp(-dt / p.wind_fade_time)) * (valid - state.share)
    load = _wind_load(given, share, (estimate.u, estimate.v, estimate.r), mast, wind)
    return WindVote(given._replace(valid=valid), unchanged, share, load)


def _wind_load(given, share, velocity, mast, wind):
    """Load of the measured wind on a moving ship, as far as the wind is believed."""
    # The anemometer stands off the origin: remove the velocity of its place by yaw.
    at_ship = wind_from_mast(given.speed, given.wind_from, *velocity, mast=mast)
    X, Y, N = wind_loads(*at_ship, wind=wind)
    return share * X, share * Y, share * N
