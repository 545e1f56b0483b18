"""Reference model against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.control.reference import (
    ReferenceParameters,
    at_rest,
    critically_damped,
    resumed,
    step,
)

PARAMETERS = parameters(ReferenceParameters)
W = PARAMETERS.position_frequency


def run(setpoint, duration, h, parameters=PARAMETERS, start=(0.0, 0.0, 0.0)):
    """States at the times k h."""
    states = [at_rest(*start)]
    for _ in range(round(duration / h)):
        states.append(step(states[-1], setpoint, h, parameters=parameters))
    return states


@pytest.mark.parametrize("h", [0.05, 7.0])
def test_step_response_is_the_closed_form_whatever_the_step_size(h):
    states = run((20.0, -20.0, 0.5), 210.0, h)
    wt = W * h * np.arange(len(states))
    expected = 1.0 - np.exp(-wt) * (1.0 + wt + wt**2 / 2.0)
    np.testing.assert_allclose([s.x for s in states], 20.0 * expected, atol=1e-9)
    np.testing.assert_allclose([s.y for s in states], -20.0 * expected, atol=1e-9)
    np.testing.assert_allclose([s.psi for s in states], 0.5 * expected, atol=1e-9)
    np.testing.assert_allclose([s.x_dot for s in states], 10.0 * W * wt**2 * np.exp(-wt), atol=1e-9)
    np.testing.assert_allclose(
        [s.x_ddot for s in states], 10.0 * W**2 * (2.0 * wt - wt**2) * np.exp(-wt), atol=1e-9
    )


def test_free_motion_from_any_state_is_the_matrix_exponential():
    expm = pytest.importorskip("scipy.linalg").expm
    system = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-(W**3), -3.0 * W**2, -3.0 * W]])
    found = critically_damped(13.0, 2.0, -0.3, 0.01, frequency=W)
    np.testing.assert_allclose(found, expm(13.0 * system) @ [2.0, -0.3, 0.01], rtol=1e-12)


def test_heading_goes_the_shortest_way_round():
    headings = [
        s.psi
        for s in run(
            (0.0, 0.0, math.radians(10.0)), 400.0, 0.5, start=(0.0, 0.0, math.radians(350.0))
        )
    ]
    assert math.degrees(headings[-1]) == pytest.approx(370.0, abs=0.01)
    assert np.all(np.diff(headings) >= 0.0)


def test_leg_of_200_s_settles_with_the_default_but_not_with_the_frequency_of_the_thesis():
    thesis = replace(PARAMETERS, position_frequency=2.0 * math.pi / 200.0)
    assert abs(20.0 - run((20.0, 0.0, 0.0), 200.0, 0.5)[-1].x) < 0.05
    assert 20.0 - run((20.0, 0.0, 0.0), 200.0, 0.5, thesis)[-1].x == pytest.approx(1.0, abs=0.3)


def test_limited_speed_is_kept_on_the_straight_line_to_the_setpoint():
    limited = replace(PARAMETERS, speed_max=0.2, yaw_rate_max=0.002)
    states = run((30.0, 40.0, 1.0), 900.0, 0.5, limited)
    assert max(math.hypot(s.x_dot, s.y_dot) for s in states) == pytest.approx(0.2, rel=1e-3)
    assert max(s.r for s in states) == pytest.approx(0.002, rel=1e-3)
    np.testing.assert_allclose([s.y for s in states], [s.x * 4.0 / 3.0 for s in states], atol=1e-9)
    assert (states[-1].x, states[-1].psi) == pytest.approx((30.0, 1.0), abs=1e-3)


def test_limit_that_is_never_reached_changes_nothing_once_the_setpoint_is_there():
    wide = replace(PARAMETERS, speed_max=1e6, yaw_rate_max=1e6)
    assert run((20.0, 5.0, 1.0), 50.0, 0.5, wide)[-1] == pytest.approx(
        run((20.0, 5.0, 1.0), 50.0, 0.5)[-1]
    )


@pytest.mark.parametrize("speed_max", [0.0, 0.2])
def test_reference_goes_on_from_its_motion_as_if_never_interrupted(speed_max):
    """Exactly without a limit of speed; behind one, from where it has come up to that speed."""
    parameters = replace(PARAMETERS, speed_max=speed_max)
    states = run((60.0, -20.0, 0.5), 250.0, 0.5, parameters)
    again = resumed(states[300][:9], parameters=parameters)
    for state in states[301:]:
        again = step(again, (60.0, -20.0, 0.5), 0.5, parameters=parameters)
        assert again[:3] == pytest.approx(state[:3], abs=0.1 if speed_max else 1e-9)
