"""Control law against closed forms of the loop it makes with an ideal ship, and with the observer around it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.control import observer
from shipcosim.models.control import pid as control
from shipcosim.models.control.observer import DpShip, Measurement, ObserverParameters, StateEstimate
from shipcosim.models.control.pid import ControlParameters, Desired, at_rest
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion

FREE = replace(parameters(DpShip), damping_surge=0.0, damping_sway=0.0, damping_yaw=0.0)
PARAMETERS = replace(parameters(ControlParameters), force_filter_time=1e-3, moment_filter_time=1e-3)
AT_ONCE = replace(
    parameters(ObserverParameters),
    position_period=0.1,
    heading_period=0.1,
    position_delay=0.0,
    heading_delay=0.0,
)
MASS = np.array(
    [
        [FREE.mass_surge, 0.0, 0.0],
        [0.0, FREE.mass_sway, FREE.mass_sway_yaw],
        [0.0, FREE.mass_sway_yaw, FREE.mass_yaw],
    ]
)
CALM = (0.0, 0.0, 0.0)
STAY = Desired(*(0.0,) * 9)


def ask(estimate, desired=STAY, state=None, wind=CALM, parameters=PARAMETERS):
    state = state or at_rest(wind)
    return control.step(state, estimate, desired, wind, 0.1, ship=FREE, parameters=parameters)


def known(position, velocity, _):
    """Estimate that knows position and velocity, and no bias."""
    return StateEstimate(*position, *velocity)


def observed():
    """Estimates of the observer, from measurements without noise, in time and at each sample."""
    made, estimates = observer.design(FREE, AT_ONCE), []

    def estimate(position, velocity, given):
        motion = Motion(*position, *velocity)
        last = estimates[-1] if estimates else observer.at_rest(motion, parameters=AT_ONCE)
        measured = Measurement(motion)
        estimates.append(
            observer.step(last, measured, given, ship=FREE, parameters=AT_ONCE, design=made)
        )
        return estimates[-1]

    return estimate


def sail(
    start,
    seconds,
    estimate=known,
    *,
    force=CALM,
    most=math.inf,
    parameters=PARAMETERS,
    desired=STAY,
    told="given",
):
    """Position and heading, every 0.1 s, of a ship of known mass that gets what is asked for, up to a limit of force.

    `force` is a load in body axes, constant or a function of time. The estimate is told the load that was given, or
    the one that was asked for.
    """
    position, velocity, state, rows = np.array(start, float), np.zeros(3), at_rest(CALM), []
    given = np.zeros(3)
    for k in range(round(10 * seconds)):
        pushed = np.array(force(0.1 * k) if callable(force) else force)
        seen = estimate(position, velocity, tuple(given) if told == "given" else state[-3:])
        state = control.step(state, seen, desired, CALM, 0.1, ship=FREE, parameters=parameters)
        given = np.clip(state[-3:], [-most, -most, -14.0 * most], [most, most, 14.0 * most])
        for _ in range(10):
            u, v, r = velocity
            c, s = math.cos(position[2]), math.sin(position[2])
            velocity = velocity + 0.01 * (
                np.linalg.solve(MASS, given + pushed) + [r * v, -r * u, 0.0]
            )
            position = position + 0.01 * np.array([c * u - s * v, s * u + c * v, r])
        rows.append(position)
    return np.array(rows)


def test_ship_at_rest_on_her_place_is_left_alone():
    assert ask(StateEstimate(0.0, 0.0, 0.0))[-3:] == (0.0, 0.0, 0.0)


def test_wind_is_met_by_its_opposite():
    assert ask(StateEstimate(0.0, 0.0, 0.0), wind=(-1e3, 2e3, 3e4))[-3:] == pytest.approx(
        (1e3, -2e3, -3e4)
    )


def test_bias_is_met_by_its_opposite_at_any_heading():
    north, east = 3e3, -4e3
    for heading in (0.0, 2.0, -1.3):
        estimate = StateEstimate(0.0, 0.0, heading, bias_north=north, bias_east=east, bias_N=5e4)
        X, Y = to_body(heading, north, east)
        assert ask(estimate, STAY._replace(psi=heading))[-3:] == pytest.approx((-X, -Y, -5e4))


def test_loop_is_critically_damped_at_its_frequencies():
    parameters = replace(PARAMETERS, damping_ratio=1.0)
    t = 0.1 * np.arange(1, 501)
    rows = sail((2.0, 0.0, 0.0), 50.0, parameters=parameters)
    w = parameters.surge_frequency
    np.testing.assert_allclose(
        rows[:, 0], 2.0 * (1.0 + w * t) * np.exp(-w * t), atol=0.03
    )  # sampled, so not exact
    rows = sail((0.0, 0.0, 0.1), 50.0, parameters=parameters)
    w = parameters.yaw_frequency
    np.testing.assert_allclose(rows[:, 2], 0.1 * (1.0 + w * t) * np.exp(-w * t), atol=0.0025)
    assert (
        np.abs(rows[:, 1]).max() < 0.01
    )  # the coupling of sway and yaw in the mass is accounted for


def test_reference_is_followed_without_error_by_a_ship_of_known_mass():
    t = 7.0
    desired = Desired(0.5, -0.2, 0.3, 0.1, -0.05, 0.01, 0.004, 0.003, 0.001)
    u, v = to_body(0.3, 0.1, -0.05)
    X, Y, N = ask(StateEstimate(0.5, -0.2, 0.3, u, v, 0.01), desired)[-3:]
    u_dot, v_dot = to_body(0.3, 0.004, 0.003)
    assert (X, Y, N) == pytest.approx(tuple(MASS @ [u_dot, v_dot, 0.001])), t


@pytest.mark.parametrize("heading", [0.7, -2.5])
def test_turning_everything_turns_no_load(heading):
    c, s = math.cos(heading), math.sin(heading)
    straight = ask(StateEstimate(1.0, 2.0, 0.0, 0.1, 0.2, 0.01))
    turned = ask(
        StateEstimate(c - 2.0 * s, s + 2.0 * c, heading, 0.1, 0.2, 0.01), STAY._replace(psi=heading)
    )
    assert turned[-3:] == pytest.approx(straight[-3:])


def test_constant_force_is_taken_up_at_any_heading():
    for heading in (0.0, 2.0):
        stay = STAY._replace(psi=heading)
        rows = sail((0.0, 0.0, heading), 800.0, observed(), force=(5e3, -8e3, 4e4), desired=stay)
        assert np.abs(rows[-1] - [0.0, 0.0, heading]).max() < 1e-3


def test_far_away_the_ship_is_pulled_no_harder_than_at_the_limit():
    near, far = (
        ask(StateEstimate(distance, 0.0, 0.0), state=at_rest(CALM)) for distance in (2.5, 800.0)
    )
    assert far.tau_X == pytest.approx(near.tau_X)
    assert abs(near.tau_X) > abs(ask(StateEstimate(2.4, 0.0, 0.0)).tau_X)


def test_overload_does_not_carry_the_ship_past_her_place():
    def storm(t):
        return (25e3, 0.0, 0.0) if t < 100.0 else CALM

    wound_up = sail((0.0, 0.0, 0.0), 1500.0, observed(), force=storm, most=20e3, told="asked")
    rows = sail((0.0, 0.0, 0.0), 1500.0, observed(), force=storm, most=20e3)
    assert wound_up[1000:, 0].min() < -10.0
    assert rows[999, 0] > 20.0
    assert rows[1000:, 0].min() > -2.0
    assert np.abs(rows[-1]).max() < 0.05


def test_errors_are_distance_and_shortest_turn():
    distance, turn = control.errors(StateEstimate(3.0, 4.0, 3.1), STAY._replace(psi=-3.1))
    assert distance == 5.0
    assert turn == pytest.approx(6.2 - 2.0 * math.pi)


def test_step_of_the_estimate_reaches_the_request_over_its_filters_time():
    slow = replace(PARAMETERS, force_filter_time=2.0, moment_filter_time=1.0)
    state, asked = at_rest(CALM), []
    for _ in range(100):
        state = ask(StateEstimate(-0.1, 0.0, -0.01), state=state, parameters=slow)
        asked.append((state.tau_X, state.tau_N))
    X, N = np.transpose(asked)
    assert X[19] / X[-1] == pytest.approx(1.0 - math.exp(-1.0), rel=0.01)
    assert N[9] / N[-1] == pytest.approx(1.0 - math.exp(-1.0), rel=0.01)
