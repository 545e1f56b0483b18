"""Vote on three position references: which are believed, and their common position.

At each message: a reference that does not change while others do is frozen. One far from the observer's prediction is
out while another, which does not agree with it, is near. Pairs that are apart are noticed, and the one at fault is the
one that is apart from most, of equals the one that moved otherwise than the measured velocity says. What the rest
agrees on must lie near the prediction; the longer there was no trusted position, the farther from it. So a jump that
all references agree on is believed in the end.

References
----------
IMO MSC.1/Circ.1580 and IMCA M 252, which ask for such tests without giving formulae; the formulae are our own.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.maths import Arithmetic, clip, exp, hypot, maximum, minimum, where
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.parameters import quantity
from shipcosim.models.ship.sensor_messages import Fix

PAIRS = ((0, 1), (0, 2), (1, 2))
_PAIRS_OF = (
    ((0, 1), (1, 2)),
    ((0, 0), (2, 2)),
    ((1, 0), (2, 1)),
)  # of each reference: number of the pair, other one
_COUNTS_MORE = 1e6  # m, by which being apart from one more reference outweighs any movement


@dataclass(frozen=True, kw_only=True)
class PositionVotingParameters:
    """Limits of the tests of position references."""

    position_freeze_time: float = quantity(
        3.0, "s", "unchanged for so long while others change, a reference is frozen", "assumed"
    )
    position_apart_max: float = quantity(
        2.0,
        "m",
        "distance of two references from which they disagree",
        "six standard deviations of noise 0.2 m",
    )
    position_drift_max: float = quantity(
        0.8,
        "m",
        "the same of their low-pass filtered distance",
        "five standard deviations of drifts of 0.1 m",
    )
    position_drift_filter: float = quantity(
        20.0, "s", "time constant of that filter", "assumed", minimum=1e-3
    )
    position_memory: float = quantity(
        60.0,
        "s",
        "how long it is remembered that a reference moved otherwise than measured velocity",
        "assumed",
    )
    position_innovation_max: float = quantity(
        2.0,
        "m",
        "distance from the prediction from which a position is not believed",
        "as position_apart_max",
    )
    position_model_error: float = quantity(
        0.003,
        "m/s2",
        "acceleration that the model may miss: the limit grows with half of it times the square of the time without "
        "trusted position",
        "assumed: 1.7 kN on 560 t",
        minimum=0.0,
    )
    position_return_time: float = quantity(
        30.0, "s", "a rejected reference is believed again after agreeing for so long", "assumed"
    )
    position_timeout: float = quantity(
        1.5,
        "s",
        "time without a trusted position from which the controller rides on its model",
        "assumed",
    )
    realignment_time: float = quantity(
        8.0,
        "s",
        "time constant with which the estimate goes to the position that returns after dead reckoning",
        "tried on twenty runs: quick against the loop, no jump of the thrust",
        minimum=1e-3,
    )


class PositionVote(NamedTuple):
    """State of the vote on position references; what is of each reference comes in tuples of three.

    Parameters
    ----------
    fixes : tuple of three Fix
        Latest messages.
    unchanged : tuple of three
        How long each has not changed. [s]
    memory : tuple of six
        North and east: movement of each beyond the measured velocity, forgotten slowly. [m]
    apart : tuple of six
        North and east: low-pass filtered differences of the `PAIRS`. [m]
    believed : tuple of three
        0 from a fault until it is believed again, else 1. [1]
    agreed : tuple of three
        How long each has agreed with what is used. [s]
    used : tuple of three
        1 of each that is part of the voted position. [1]
    fix : Fix
        Voted position and velocity, the position with the shift; valid 1 where it is trusted.
    north_rate, east_rate : float or (...) array or tensor
        Measured velocity over ground. [m/s]
    north_shift, east_shift : like north_rate
        What is added to positions after dead reckoning, fading, so that the estimate returns smoothly. [m]
    trusted_at : like north_rate
        Time at which the last trusted position came. [s]
    """

    fixes: tuple[Fix, Fix, Fix]
    unchanged: tuple
    memory: tuple
    apart: tuple
    believed: tuple
    agreed: tuple
    used: tuple
    fix: Fix
    north_rate: Arithmetic
    east_rate: Arithmetic
    north_shift: Arithmetic
    east_shift: Arithmetic
    trusted_at: Arithmetic


def start(t: float, fixes: tuple[Fix, Fix, Fix]) -> PositionVote:
    """State of the vote at the start: the mean of the valid references.

    Parameters
    ----------
    t : float
        Time. [s]
    fixes : tuple of three Fix
        First messages.

    Returns
    -------
    PositionVote
        State of the vote.
    """
    zero = 0.0 * fixes[0].x
    used = tuple(zero + fix.valid for fix in fixes)
    three = (zero,) * 3
    six = (zero,) * 6
    one = zero + 1.0
    mean = _mean(fixes, used)
    return PositionVote(
        fixes, three, six, six, (one,) * 3, three, used, mean, zero, zero, zero, zero, zero + t
    )


def step(
    t: float,
    state: PositionVote,
    fixes: tuple[Fix, Fix, Fix],
    predicted: Motion,
    quiet: Arithmetic,
    dt: Arithmetic,
    *,
    parameters: PositionVotingParameters,
) -> PositionVote:
    """Vote on new messages.

    Parameters
    ----------
    t : float
        Time. [s]
    state : PositionVote
        State after the messages before, faded by `faded`.
    fixes : tuple of three Fix
        Messages.
    predicted : Motion
        As the observer has it for the time of the messages, motion in waves included.
    quiet : float or (...) array or tensor
        How long no other sensor has changed. [s]
    dt : float
        Time since the last messages. [s]
    parameters : PositionVotingParameters
        Limits.

    Returns
    -------
    PositionVote
        State of the vote; `fix` is the position to use.
    """
    p = parameters
    age = t - state.trusted_at
    # Which references may be used at all: valid, not frozen, and believed so far.
    unchanged, usable = _usable(state, fixes, quiet, dt, p)
    candidates = tuple([a * b for a, b in zip(usable, state.believed, strict=True)])
    rates = _rates(fixes, candidates, predicted)
    # Compare each reference with the observer, its movement with the velocity, and the pairs.
    innovations = [_innovation(state, fix, predicted) for fix in fixes]
    memory = _memory(state, fixes, innovations, rates, dt, p)
    off = [hypot(*both) for both in innovations]
    apart, disagree = _pairs(state, fixes, usable, dt, p)
    # Without a trusted position the prediction error grows: d = a t² / 2 for an unmodelled
    # acceleration a.
    limit = p.position_innovation_max + 0.5 * p.position_model_error * age * age
    # Order: keep those near the prediction, then remove the worst of those that disagree.
    candidates = _near_if_any(candidates, disagree, [distance <= limit for distance in off])
    candidates = _without_worst(candidates, disagree, memory)
    mean = _mean(fixes, candidates)
    # The common position must lie near the prediction too, or it is not trusted.
    off_north, off_east = _innovation(state, mean, predicted)
    near = where(hypot(off_north, off_east) <= limit, mean.valid, 0.0)
    # After dead reckoning the position returns with a shift that fades: the estimate does not jump.
    back = near * where(age > p.position_timeout, 1.0, 0.0)
    north = state.north_shift - back * off_north
    east = state.east_shift - back * off_east
    used = tuple([near * candidate for candidate in candidates])
    agreed = _agreed(state, usable, used, disagree, [distance - limit for distance in off], dt)
    return PositionVote(
        fixes,
        unchanged,
        memory,
        apart,
        believed_again(
            fixes, state.believed, candidates, agreed, return_time=p.position_return_time
        ),
        agreed,
        used,
        Fix(mean.x + north, mean.y + east, mean.u, mean.v, near),
        *rates,
        north,
        east,
        where(near > 0.5, t, state.trusted_at),
    )


def faded(
    state: PositionVote, dt: float, *, parameters: PositionVotingParameters
) -> tuple[PositionVote, Arithmetic, Arithmetic]:
    """State with the shift faded over some time, and the movement of the estimate by it.

    Parameters
    ----------
    state : PositionVote
        State of the vote.
    dt : float
        Time since then. [s]
    parameters : PositionVotingParameters
        Limits.

    Returns
    -------
    tuple of PositionVote and two like state.north_shift
        State, and what is to be added to the estimated position. [m, m]
    """
    # First-order decay; the change of the shift moves the estimate.
    keep = exp(-dt / parameters.realignment_time)
    north = keep * state.north_shift
    east = keep * state.east_shift
    moved = north - state.north_shift, east - state.east_shift
    return state._replace(north_shift=north, east_shift=east), *moved


def _usable(state, fixes, quiet, dt, p):
    """Time without change of each reference; 1 for those that are valid and not frozen."""
    unchanged = tuple(
        [
            where((new.x == old.x) & (new.y == old.y), time + dt, 0.0 * time)
            for new, old, time in zip(fixes, state.fixes, state.unchanged, strict=True)
        ]
    )
    # Frozen: no change, while some other sensor changes. If all rest, the ship may be at rest.
    usable = []
    for i, fix in enumerate(fixes):
        others = minimum(quiet, minimum(unchanged[i - 1], unchanged[i - 2]))
        frozen = (unchanged[i] >= p.position_freeze_time) & (others < p.position_freeze_time)
        usable.append(where(frozen, 0.0, fix.valid))
    return unchanged, tuple(usable)


def _mean(fixes, weights):
    """Weighted mean of messages; valid 1 if there is any weight."""
    (first, second, third) = fixes
    (a, b, c) = weights
    total = a + b + c
    # No weight at all gives zero, and valid 0, instead of a division by zero.
    share = 1.0 / maximum(total, 1.0)
    return Fix(
        (a * first.x + b * second.x + c * third.x) * share,
        (a * first.y + b * second.y + c * third.y) * share,
        (a * first.u + b * second.u + c * third.u) * share,
        (a * first.v + b * second.v + c * third.v) * share,
        where(total > 0.5, 1.0, 0.0),
    )


def _rates(fixes, candidates, predicted):
    """Measured velocity over ground, north and east; the predicted one if nothing measures it."""
    mean = _mean(fixes, candidates)
    u = where(mean.valid > 0.5, mean.u, predicted.u)
    v = where(mean.valid > 0.5, mean.v, predicted.v)
    return to_ned(predicted.psi, u, v)


def _innovation(state, fix, predicted):
    """A position minus the predicted one, north and east, in the frame of the estimate."""
    return fix.x + state.north_shift - predicted.x, fix.y + state.east_shift - predicted.y


def _memory(state, fixes, innovations, rates, dt, p):
    """Movement of each reference beyond the velocity; for a new one its innovation."""
    keep = exp(-dt / p.position_memory)
    memory = []
    # Displacement by the trapezoidal rule from the measured velocity.
    north = 0.5 * dt * (state.north_rate + rates[0])
    east = 0.5 * dt * (state.east_rate + rates[1])
    # Movement of the reference minus that displacement, summed with forgetting.
    for i, (new, old, fresh) in enumerate(zip(fixes, state.fixes, innovations, strict=True)):
        was_valid = old.valid > 0.5
        memory.append(
            where(was_valid, keep * state.memory[2 * i] + new.x - old.x - north, fresh[0])
        )
        memory.append(
            where(was_valid, keep * state.memory[2 * i + 1] + new.y - old.y - east, fresh[1])
        )
    return tuple(memory)


def _pairs(state, fixes, usable, dt, p):
    """Filtered, limited differences of all pairs; 1 for those that are apart."""
    most = p.position_apart_max
    gain = 1.0 - exp(-dt / p.position_drift_filter)
    apart = []
    disagree = []
    # Two tests per pair: the distance now (jumps), and the filtered distance (slow drift), with a
    # smaller limit.
    for k, (i, j) in enumerate(PAIRS):
        both = usable[i] * usable[j]
        x = fixes[i].x - fixes[j].x
        y = fixes[i].y - fixes[j].y
        was = state.apart[2 * k : 2 * k + 2]
        north = both * (was[0] + gain * (clip(x, -most, most) - was[0]))
        east = both * (was[1] + gain * (clip(y, -most, most) - was[1]))
        far = (hypot(x, y) > p.position_apart_max) | (hypot(north, east) > p.position_drift_max)
        disagree.append(where(far, both, 0.0))
        apart += [north, east]
    return tuple(apart), tuple(disagree)


def _near_if_any(candidates, disagree, near):
    """Candidates near the prediction, or in agreement with one that is; all if none is near.

    So two that jump together do not outvote a third.
    """
    near = [
        where(is_near, candidate, 0.0) for is_near, candidate in zip(near, candidates, strict=True)
    ]
    is_any_near = sum(near) > 0.5
    kept = []
    # A candidate stays if it is near, or agrees with one that is near. If none is near, the
    # prediction may be wrong: keep all.
    for i, ((k, first), (n, two)) in enumerate(_PAIRS_OF):
        agreeing = maximum(near[first] * (1.0 - disagree[k]), near[two] * (1.0 - disagree[n]))
        kept.append(where(is_any_near, candidates[i] * maximum(near[i], agreeing), candidates[i]))
    return tuple(kept)


def _without_worst(candidates, disagree, memory):
    """Candidates without the one apart from most others; of equals, the one that moved most."""
    a, b, c = candidates
    # Pairs of candidates that disagree.
    first = a * b * disagree[0]
    second = a * c * disagree[1]
    third = b * c * disagree[2]
    # A reference apart from both others is the worst. For a single pair the movement against the
    # velocity decides.
    counts = first + second, first + third, second + third
    scores = [n * (_COUNTS_MORE + hypot(*memory[2 * i : 2 * i + 2])) for i, n in enumerate(counts)]
    worst = maximum(scores[0], maximum(scores[1], scores[2]))
    kept = [
        where((n > 0.5) & (score >= worst), 0.0, candidate)
        for n, score, candidate in zip(counts, scores, candidates, strict=True)
    ]
    return tuple(kept)


def _agreed(state, usable, used, disagree, too_far, dt):
    """How long each reference has agreed with the used ones, else with the prediction."""
    durations = []
    alone = sum(used) < 0.5
    for i, ((k, first), (n, two)) in enumerate(_PAIRS_OF):
        # Against any used reference means no agreement; the time then starts anew.
        against = disagree[k] * used[first] + disagree[n] * used[two]
        off = where(alone, too_far[i], against - 0.5)
        durations.append(where(off <= 0.0, usable[i], 0.0) * (state.agreed[i] + dt))
    return tuple(durations)


def believed_again(
    messages: tuple, before: tuple, passed: tuple, agreed: tuple, *, return_time: float
) -> tuple:
    """Belief in each sensor: it passed the tests, or has agreed for long enough.

    Parameters
    ----------
    messages : tuple of Fix or Heading
        A silent sensor keeps its state until it speaks again. [as their fields]
    before, passed : tuple of floats or (...) arrays
        1 of a sensor that was believed, and that passed the tests now. [1]
    agreed : tuple, as many
        How long each has agreed with what is used. [s]
    return_time : float
        After which a rejected sensor is believed again. [s]

    Returns
    -------
    tuple, as many
        1 or 0. [1]
    """
    sensors = zip(messages, before, passed, agreed, strict=True)
    return tuple(
        [
            where(time >= return_time, 1.0, where(new.valid > 0.5, now, was))
            for new, was, now, time in sensors
        ]
    )
