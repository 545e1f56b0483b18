"""Vote on two compasses: which one is believed, and their common heading.

If two compasses disagree, the rate gyro decides: the one that turned otherwise than the gyro over the last
minute is at fault. Where no compass is believed the heading is the observer's, carried by the gyro.

References
----------
IMO MSC.1/Circ.1580 and IMCA M 252, which ask for such tests without giving formulae; the formulae are our own.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.control.position_voting import believed_again
from shipcosim.models.core.maths import Arithmetic, exp, minimum, where
from shipcosim.models.core.parameters import quantity
from shipcosim.models.ship.sensor_messages import Heading

_DEGREE = 0.017453292519943295


@dataclass(frozen=True, kw_only=True)
class CompassVotingParameters:
    """Limits of the tests of compasses."""

    compass_freeze_time: float = quantity(
        5.0,
        "s",
        "unchanged for so long while others change, a compass is frozen",
        "assumed: a coarse scale may rest",
    )
    compass_apart_max: float = quantity(
        _DEGREE,
        "rad",
        "filtered difference from which two compasses disagree",
        "seven standard deviations of drift",
    )
    compass_filter: float = quantity(
        2.0, "s", "time constant of that filter", "assumed", minimum=1e-3
    )
    compass_memory: float = quantity(
        60.0,
        "s",
        "how long it is remembered that a compass turned otherwise than the gyro",
        "assumed",
    )
    compass_gyro_max: float = quantity(
        3.0 * _DEGREE,
        "rad",
        "turn otherwise than the gyro from which a compass is not believed",
        "assumed",
    )
    compass_return_time: float = quantity(
        30.0, "s", "a rejected compass is believed again after agreeing for so long", "assumed"
    )
    gyro_drift: float = quantity(
        0.02 * _DEGREE,
        "rad/s",
        "error of the rate gyro: without a compass, the limit against the predicted heading grows with it",
        "assumed, data sheets of fibre-optic gyros give less",
        minimum=0.0,
    )


class CompassVote(NamedTuple):
    """State of the vote on compasses; what is of each compass comes in pairs.

    Parameters
    ----------
    headings : tuple of two Heading
        Latest messages.
    unchanged : tuple of two
        How long each has not changed. [s]
    memory : tuple of two
        Turn of each beyond the gyro's, forgotten slowly. [rad]
    apart : float or (...) array or tensor
        Low-pass filtered difference of the two. [rad]
    believed : tuple of two
        0 from a fault until it is believed again, else 1. [1]
    agreed : tuple of two
        How long each has agreed with what is used. [s]
    used : tuple of two
        1 of each that is part of the voted heading. [1]
    psi : like apart
        Voted heading. [rad]
    age : like apart
        Time since the last trusted heading. [s]
    """

    headings: tuple[Heading, Heading]
    unchanged: tuple
    memory: tuple
    apart: Arithmetic
    believed: tuple
    agreed: tuple
    used: tuple
    psi: Arithmetic
    age: Arithmetic


def start(headings: tuple[Heading, Heading]) -> CompassVote:
    """State of the vote at the start: the mean of the valid compasses.

    Parameters
    ----------
    headings : tuple of two Heading
        First messages.

    Returns
    -------
    CompassVote
        State of the vote.
    """
    zero = 0.0 * headings[0].psi
    one = zero + 1.0
    used = tuple(zero + heading.valid for heading in headings)
    psi = _mean(headings, used, headings[0].psi)
    return CompassVote(
        headings, (zero,) * 2, (zero,) * 2, zero, (one,) * 2, (zero,) * 2, used, psi, zero
    )


def step(
    state: CompassVote,
    headings: tuple[Heading, Heading],
    r: Arithmetic,
    predicted: Arithmetic,
    quiet: Arithmetic,
    dt: Arithmetic,
    *,
    parameters: CompassVotingParameters,
) -> CompassVote:
    """Vote on new messages.

    Parameters
    ----------
    state : CompassVote
        State after the messages before.
    headings : tuple of two Heading
        Messages.
    r : float or (...) array or tensor
        Yaw rate of the gyro. [rad/s]
    predicted : like r
        Heading as the observer has it for the time of the messages, motion in waves included. [rad]
    quiet : like r
        How long no other sensor has changed. [s]
    dt : float
        Time since the last messages. [s]
    parameters : CompassVotingParameters
        Limits.

    Returns
    -------
    CompassVote
        State of the vote; `psi` is the heading to use, the predicted one where no compass is believed.

    Notes
    -----
    Each compass is compared with the gyro: what it turned more, summed with forgetting over
    `compass_memory`. The difference of both is low-pass filtered, so that single wrong samples do
    not count. A frozen compass gives exactly the same value. Without a trusted heading the
    prediction gets worse by the gyro's drift, and its limit grows. A rejected compass is believed
    again after it has agreed for some time, with the other one if that is used, else with the
    prediction; while it is silent its state stays.
    """
    p = parameters
    keep = exp(-dt / p.compass_memory)
    gain = 1.0 - exp(-dt / p.compass_filter)
    off = [wrap(new.psi - predicted) for new in headings]
    moved = [wrap(new.psi - old.psi) for new, old in zip(headings, state.headings, strict=True)]
    # Compass turn minus gyro turn, with forgetting; a new one starts at its deviation.
    first, second = [
        where(old.valid > 0.5, keep * before + turn - dt * r, fresh)
        for old, before, turn, fresh in zip(state.headings, state.memory, moved, off, strict=True)
    ]
    memory = first, second
    # Frozen: unchanged while other sensors change.
    first, second = [
        where(turn == 0.0, time + dt, 0.0 * dt)
        for turn, time in zip(moved, state.unchanged, strict=True)
    ]
    limit = p.compass_freeze_time
    neighbours = zip(headings, (first, second), (second, first), strict=True)
    usable = tuple(
        [
            where((time >= limit) & (minimum(quiet, other) < limit), 0.0, new.valid)
            for new, time, other in neighbours
        ]
    )
    difference = wrap(headings[0].psi - headings[1].psi - state.apart)
    apart = usable[0] * usable[1] * (state.apart + gain * difference)
    passed = _passed(state, usable, memory, abs(apart) > p.compass_apart_max, p)
    # How long each has agreed with the other, if that is used, else with the prediction.
    limit = p.compass_gyro_max + p.gyro_drift * state.age
    between = abs(apart) - p.compass_apart_max
    times = zip(state.agreed, usable, (passed[1], passed[0]), off, strict=True)
    agreed = tuple(
        [
            where(
                where(other > 0.5, between, abs(error) - limit) <= 0.0,
                use * (time + dt),
                0.0 * (time + dt),
            )
            for time, use, other, error in times
        ]
    )
    believed = believed_again(
        headings, state.believed, passed, agreed, return_time=p.compass_return_time
    )
    unchanged = first, second
    psi = _mean(headings, passed, predicted)
    age = where(passed[0] + passed[1] > 0.5, 0.0 * dt, state.age + dt)
    return CompassVote(headings, unchanged, memory, apart, believed, agreed, passed, psi, age)


def _passed(state, usable, memory, disagree, p):
    """1 for each believed compass; of two that disagree, the one that turned with the gyro."""
    first = usable[0] * state.believed[0]
    second = usable[1] * state.believed[1]
    # With two compasses a majority cannot decide. The gyro is the third opinion: the compass
    # farther from it is out.
    apart = disagree & (first * second > 0.5)
    first_turn = abs(memory[0])
    two = abs(memory[1])
    return (
        where((first_turn > p.compass_gyro_max) | (apart & (first_turn >= two)), 0.0, first),
        where((two > p.compass_gyro_max) | (apart & (two > first_turn)), 0.0, second),
    )


def _mean(headings, weights, otherwise):
    """Mean of the headings with weight; another heading if none has weight."""
    (first, second) = headings
    (a, b) = weights
    # The mean of two angles: half way along the shorter arc.
    half = 0.5 * wrap(second.psi - first.psi)
    only = where(a > 0.5, first.psi, where(b > 0.5, second.psi, otherwise))
    return where(a * b > 0.5, wrap(first.psi + half), only)
