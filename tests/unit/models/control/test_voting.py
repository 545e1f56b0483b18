"""Voting on position references, compasses and anemometer: each failure alone, and two at once."""

import math

import numpy as np
import pytest

from shipcosim.models.control import voting
from shipcosim.models.control.observer import StateEstimate
from shipcosim.models.control.voting import VotingParameters
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.ship.mast import MastParameters
from shipcosim.models.ship.sensor_messages import Fix, Heading, Telegrams, Wind

LIMITS = VotingParameters()
NO_WIND = dict(
    mast=MastParameters(mast_x=0.0, mast_y=0.0, mast_height=10.0),
    wind=WindParameters(wind_table="0 0 0 0; 180 0 0 0"),
)
DEGREE = math.pi / 180.0


def telegrams(t, rng, positions=(), compasses=(), r=0.0, wind=None):
    """What healthy sensors of a ship at rest in the origin give out at t, with noise; and what is given instead."""
    noise = [
        Fix(
            *(0.2 * rng.standard_normal(2)).tolist(), *(0.02 * rng.standard_normal(2)).tolist(), 1.0
        )
        for _ in "123"
    ]
    headings = [Heading(0.1 * DEGREE * float(rng.standard_normal()), 1.0) for _ in "12"]
    fixes = tuple(
        change(fix) for change, fix in zip((*positions, same, same, same), noise, strict=False)
    )
    psi = tuple(
        change(heading) for change, heading in zip((*compasses, same, same), headings, strict=False)
    )
    air = wind or Wind(8.0 + float(rng.standard_normal()), 0.3, 1.0)
    return Telegrams(
        fixes,
        psi,
        r + 0.05 * DEGREE * float(rng.standard_normal()),
        air,
        math.floor(t + 1e-9),
        t,
        math.floor(t + 1e-9),
    )


def same(telegram):
    return telegram


def moved(north=0.0, east=0.0):
    return lambda fix: fix._replace(x=fix.x + north, y=fix.y + east)


def turned(angle):
    return lambda heading: heading._replace(psi=heading.psi + angle)


def lost(telegram):
    return telegram._replace(valid=0.0)


def frozen(telegram):
    return type(telegram)(*(0.1 for _ in telegram[:-1]), 1.0)


def voted(changes, seconds, dt=0.1, seed=1):
    """State after each 0.1 s; `changes` gives what is wrong at a time, by the names of `telegrams`.

    The observer is one that stays where it is told the ship is: the origin, but for the shift after dead reckoning.
    """
    rng, estimate = np.random.default_rng(seed), StateEstimate(0.0, 0.0, 0.0)
    states = [voting.start(0.0, telegrams(0.0, rng, **changes(0.0)), **NO_WIND)]
    for k in range(1, round(seconds / dt)):
        given = telegrams(k * dt, rng, **changes(k * dt))
        state, estimate = voting.step(
            k * dt, states[-1], given, estimate, parameters=LIMITS, **NO_WIND
        )
        states.append(state)
    return states


def used(state):
    return [round(float(value)) for value in state.positions.used]


def reckoned(states):
    return [
        voting.dead_reckoning_time(0.1 * k, state, parameters=LIMITS)
        for k, state in enumerate(states)
    ]


def from_30_s(**failed):
    return lambda t: failed if t > 29.95 else {}


def test_healthy_references_are_all_used_and_their_mean_is_better_than_one():
    states = voted(lambda t: {}, 600.0)
    assert all(used(state) == [1, 1, 1] and sum(state.compasses.used) == 2 for state in states)
    error = [state.positions.fix.x for state in states[::10]]
    assert np.std(error) == pytest.approx(0.2 / math.sqrt(3.0), rel=0.15)
    assert not any(reckoned(states))


@pytest.mark.parametrize("i", range(3))
@pytest.mark.parametrize(
    ("change", "within"), [(moved(north=8.0), 1.1), (moved(east=-3.0), 1.1), (frozen, 4.1)]
)
def test_a_reference_that_jumps_or_freezes_is_rejected_and_the_others_are_kept(i, change, within):
    changes = [same, same, same]
    changes[i] = change
    states = voted(from_30_s(positions=changes), 120.0)
    expected = [1, 1, 1]
    expected[i] = 0
    assert all(used(state) == expected for state in states[round(10 * (30.0 + within)) :])


def test_a_slow_drift_is_found_before_it_is_3_m():
    states = voted(lambda t: dict(positions=[moved(north=0.05 * max(0.0, t - 30.0))]), 120.0)
    first = next(k for k, state in enumerate(states) if used(state) == [0, 1, 1])
    assert 0.05 * (0.1 * first - 30.0) < 3.0
    assert (
        max(abs(state.positions.fix.x) for state in states) < 1.5
    )  # 0.9 m of a third of the drift, and noise


def test_of_two_that_disagree_the_one_that_moved_otherwise_than_measured_is_rejected():
    """Also where the observer has followed both of them half the way: the vote has no third."""
    states = voted(
        lambda t: dict(positions=[same, moved(east=0.05 * max(0.0, t - 30.0)), lost]), 120.0
    )
    assert used(states[-1]) == [1, 0, 0]


def test_two_that_jump_together_do_not_outvote_the_third():
    states = voted(from_30_s(positions=[moved(8.0), moved(8.1)]), 200.0)
    assert all(used(state) == [0, 0, 1] for state in states[311:])


def test_a_jump_of_all_is_not_believed_at_first_nor_forever():
    states = voted(from_30_s(positions=[moved(8.0)] * 3), 150.0)
    assert used(states[600]) == [0, 0, 0] and used(states[-1]) == [1, 1, 1]
    limit = math.sqrt(2.0 * (8.0 - LIMITS.position_innovation_max) / LIMITS.position_model_error)
    assert max(reckoned(states)) == pytest.approx(limit, abs=3.0)


def test_after_dead_reckoning_the_voted_position_starts_at_the_estimate_and_goes_to_the_references():
    def changes(t):
        return (
            dict(positions=[lost] * 3)
            if 30.0 < t + 0.05 < 80.0
            else dict(positions=[moved(3.0)] * 3 if t > 50 else [])
        )

    states = voted(changes, 200.0)
    back = next(k for k in range(700, 1000) if used(states[k]) == [1, 1, 1])
    assert states[back].positions.fix.x == pytest.approx(0.0, abs=1e-9)
    assert states[-1].positions.north_shift == pytest.approx(0.0, abs=0.02)
    steps = np.abs(np.diff([state.positions.north_shift for state in states[back + 1 :]]))
    assert steps.max() < 3.0 / LIMITS.realignment_time * 1.2


def test_a_rejected_reference_is_believed_again_after_agreeing_for_30_s():
    """The filtered distance falls from 2 m at most below 0.8 m within 20 s, then 30 s of agreement."""
    states = voted(lambda t: dict(positions=[moved(8.0)] if 30.0 < t + 0.05 < 60.0 else []), 150.0)
    again = next(k for k in range(600, 1500) if used(states[k]) == [1, 1, 1])
    assert 89.0 <= 0.1 * again <= 115.0


def test_references_that_never_change_are_trusted_where_nothing_else_does():
    """A simulation without noise and weather: the ship rests."""
    still, fixes = StateEstimate(0.0, 0.0, 0.0), (Fix(0.0, 0.0, 0.0, 0.0, 1.0),) * 3
    healthy = Telegrams(fixes, (Heading(0.0, 1.0),) * 2, 0.0, Wind(0.0, 0.0, 1.0), 0, 0, 0)
    state = voting.start(0.0, healthy, **NO_WIND)
    for k in range(1, 600):
        told = healthy._replace(position_time=float(k // 10), heading_time=0.1 * k)
        state, still = voting.step(0.1 * k, state, told, still, parameters=LIMITS, **NO_WIND)
    assert (
        used(state) == [1, 1, 1] and sum(state.compasses.used) == 2 and state.wind.wind.valid == 1.0
    )


@pytest.mark.parametrize("rate", [0.02 * DEGREE, 0.1 * DEGREE, -0.1 * DEGREE])
@pytest.mark.parametrize("i", [0, 1])
def test_the_compass_that_runs_off_is_told_by_the_gyro(i, rate):
    def changes(t):
        both = [same, same]
        both[i] = turned(rate * max(0.0, t - 30.0))
        return dict(compasses=both)

    states = voted(changes, 150.0)
    assert [float(value) for value in states[-1].compasses.used] == [float(i == 1), float(i == 0)]


def test_the_last_compass_is_not_believed_where_it_jumps_and_the_heading_is_the_predicted_one():
    states = voted(from_30_s(compasses=[lost, turned(10.0 * DEGREE)]), 60.0)
    assert sum(states[-1].compasses.used) == 0.0 and abs(states[-1].compasses.psi) < 0.01


def test_a_stuck_anemometer_fades_out_and_a_changing_one_comes_back():
    stuck = Wind(8.0, 0.3, 1.0)
    states = voted(lambda t: dict(wind=stuck) if 30.0 < t < 130.0 else {}, 300.0)
    valid, share = (
        np.array([value(state.wind) for state in states])
        for value in (lambda w: w.wind.valid, lambda w: w.share)
    )
    assert valid[380] == 1.0 and valid[420] == 0.0 and valid[1320] == 1.0
    assert (
        share[1290] == pytest.approx(math.exp(-(129.0 - 40.0) / 60.0), abs=0.02) and share[-1] > 0.9
    )
