"""Integrators, against closed forms and each other."""

import math

import pytest

from shipcosim.models.core import integrate, kinematics


def test_runge_kutta_is_of_fourth_order():
    """x'' = -x over one second against cos and sin: half the step, a sixteenth of the error."""

    def error(parts):
        state = (1.0, 0.0)
        for _ in range(parts):
            state = integrate.rk4(lambda x, v: (v, -x), state, 1.0 / parts)
        return math.hypot(state[0] - math.cos(1.0), state[1] + math.sin(1.0))

    assert error(10) / error(20) == pytest.approx(16.0, rel=0.05)


def test_runge_kutta_of_a_pair_is_that_of_any_state_with_time_as_part_of_it():
    """x' = -x + t², y' = x y: what is known in advance enters as a third state, t."""

    def rates(x, y, t):
        return -x + t * t, x * y

    wanted = integrate.rk4(lambda x, y, t: (*rates(x, y, t), 1.0), (1.0, 2.0, 0.5), 0.2)
    assert integrate.rk4_pair(rates, 1.0, 2.0, 0.2, (0.5,), (0.6,), (0.7,)) == pytest.approx(
        wanted[:2], abs=1e-15
    )


@pytest.mark.parametrize("h, parts", [(0.05, 1), (0.1, 1), (0.1000001, 2), (0.3, 3), (1.0, 10)])
def test_substeps_are_no_longer_than_allowed_and_as_few_as_that_takes(h, parts):
    assert integrate.substeps(h, 0.1) == parts


def test_runge_kutta_of_a_motion_is_that_of_any_state():
    """Written out for the six states it must not differ by a bit from the general form."""

    def accelerations(u, v, r):
        return 0.1 - 0.02 * u + v * r, -0.3 * v - u * r, 0.01 * u - 0.2 * r

    def rates(x, y, psi, u, v, r):
        return (*kinematics.eta_dot(psi, u, v, r), *accelerations(u, v, r))

    motion = (1.0, -2.0, 0.4, 2.0, -0.3, 0.05)
    assert integrate.rk4_motion(accelerations, *motion, 0.1) == integrate.rk4(rates, motion, 0.1)


def test_the_midpoint_rule_is_an_euler_step_with_the_rates_of_half_a_step():
    def accelerations(u, v, r):
        return 0.1 - 0.02 * u + v * r, -0.3 * v - u * r, 0.01 * u - 0.2 * r

    def rates(x, y, psi, u, v, r):
        x_dot, y_dot, r = kinematics.eta_dot(psi, u, v, r)
        return x_dot + 0.5, y_dot - 0.2, r, *accelerations(u, v, r)

    motion, h = (1.0, -2.0, 0.4, 2.0, -0.3, 0.05), 0.5
    middle = integrate.euler(motion, rates(*motion), 0.5 * h)
    wanted = integrate.euler(motion, rates(*middle), h)
    assert integrate.midpoint_motion(accelerations, *motion, h, 0.5, -0.2) == pytest.approx(
        wanted, abs=1e-15
    )


def test_inputs_of_a_runge_kutta_step_enter_at_start_middle_and_end():
    """x' = t² with the times as inputs: exact, as Simpson's rule is."""
    (x,) = integrate.rk4(lambda x, t: (t * t,), (0.0,), 3.0, ((0.0,), (1.5,), (3.0,)))
    assert x == pytest.approx(9.0)
