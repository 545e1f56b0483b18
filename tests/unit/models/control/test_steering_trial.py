"""Steering trials: what is read off a circle and a zig-zag, against geometry and a ship of first order."""

from math import cos, pi, radians, sin

import pytest
from hypothesis import given, settings
from hypothesis import strategies as some

from shipcosim.angles import wrap
from shipcosim.models.control.steering_trial import SteeringTrialParameters, TrialState, step

STEP = 0.01  # s


def sailed(motion_at, duration, **ordered):
    """State after a motion that is given at any time, and the helm at each step."""
    trial = SteeringTrialParameters(**ordered)
    x, y, psi = motion_at(0.0)
    state = TrialState(x, y, psi, psi)
    helms = []
    for k in range(round(duration / STEP)):
        state = step(state, k * STEP, motion_at(k * STEP), STEP, parameters=trial)
        helms.append(state.helm)
    return state, helms


@settings(max_examples=20, deadline=None, derandomize=True)
@given(
    heading=some.floats(-pi, 3.1),
    radius=some.floats(20.0, 300.0),
    side=some.sampled_from([1.0, -1.0]),
    begun=some.floats(0.0, 5.0),
)
def test_of_an_exact_circle_the_radius_is_read_off_wherever_it_points(heading, radius, side, begun):
    speed = radius / 10.0

    def motion_at(t):
        """Straight ahead until the order, then a circle; headings wrap."""
        ahead = speed * min(t, begun)
        angle = max(t - begun, 0.0) * speed / radius
        ahead += radius * sin(angle)
        right = side * radius * (1.0 - cos(angle))
        c, s = cos(heading), sin(heading)
        return ahead * c - right * s, ahead * s + right * c, wrap(heading + side * angle)

    state, _ = sailed(motion_at, begun + 40.0, helm=side * 0.6, order_time=begun)
    way = 2.0 * speed * STEP  # of a step, and of the part of one before the order
    assert state.advance == pytest.approx(radius, abs=way)
    assert state.transfer == pytest.approx(radius, abs=way)
    assert state.tactical_diameter == pytest.approx(2.0 * radius, abs=way)
    assert state.turned == pytest.approx(4.0 * side, abs=0.01)


def steered(side, angle, rate=10.0, gain=0.1, lag=8.0):
    """A ship of Nomoto's first order in a zig-zag: trial, and her largest headings between reversals, seen from here."""
    trial = SteeringTrialParameters(helm=side * angle, check=angle, helm_rate=rate)
    psi = r = 0.0
    state = TrialState(0.0, 0.0, 0.0, 0.0)
    swings, reached = [], 0.0
    for k in range(20_000):
        before = state.side
        state = step(state, k * STEP, (0.0, 0.0, wrap(psi)), STEP, parameters=trial)
        if state.side != before:
            swings.append(reached)
            reached = 0.0
        r += STEP * (gain * state.helm - r) / lag
        psi += STEP * r
        # Beyond the angle, to the side that the helm has left.
        reached = max(reached, -state.side * side * psi - angle)
    return state, swings


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("angle", [10.0, 20.0])
def test_overshoots_of_a_zigzag_are_the_ships_own(side, angle):
    state, swings = steered(side, radians(angle))
    assert state.reversals >= 3
    assert state.overshoot_1 == pytest.approx(swings[1], abs=1e-3)
    assert state.overshoot_2 == pytest.approx(swings[2], abs=1e-3)
    assert state.overshoot_2 > state.overshoot_1 > radians(1.0)


def test_the_helm_moves_at_its_rate_and_not_before_the_order():
    _, helms = sailed(lambda t: (t, 0.0, 0.0), 6.0, helm=-0.3, helm_rate=0.1, order_time=2.0)
    assert max(map(abs, helms[: round(2.0 / STEP) - 1])) == 0.0
    assert helms[round(3.0 / STEP)] == pytest.approx(-0.1, abs=0.002)
    assert helms[-1] == pytest.approx(-0.3)
