"""Propeller and rudder by the MMG standard method, against the formulas as they are published."""

from dataclasses import replace
from math import atan2, cos, exp, hypot, pi, sin, sqrt

import pytest
from ships import parameters

from shipcosim.models.propulsion.rudder import (
    PropellerRudderParameters,
    propeller_in_wake,
    propeller_rudder_loads,
    rudder_normal_force,
)

STERN = parameters(PropellerRudderParameters, "kvlcc2")
RHO, L = 1000.0, 7.0


def published(n, delta, u, v, r):
    """Loads of the paper's formulas, written with J, KT and beta as there. KVLCC2's numbers."""
    U, beta, rate = hypot(u, v), atan2(-v, u), r * L / hypot(u, v)
    beta_P, beta_R = beta + 3.386 / L * rate, beta + 0.710 * rate
    C2 = 1.6 if beta_P > 0.0 else 1.1
    w = 1.0 - (1.0 - 0.40) * (1.0 + (1.0 - exp(-2.0 * abs(beta_P))) * (C2 - 1.0))
    J = u * (1.0 - w) / (n * 0.2157)
    KT = 0.2931 - 0.2753 * J - 0.1385 * J**2
    T = RHO * n**2 * 0.2157**4 * KT
    eta = 0.625
    u_R = (
        1.09
        * u
        * (1.0 - w)
        * sqrt(eta * (1.0 + 0.5 * (sqrt(1.0 + 8.0 * KT / (pi * J**2)) - 1.0)) ** 2 + 1.0 - eta)
    )
    v_R = U * (0.640 if beta_R > 0.0 else 0.395) * beta_R
    F = 0.5 * RHO * 0.0539 * (u_R**2 + v_R**2) * 2.747 * sin(delta - atan2(v_R, u_R))
    X = (1.0 - 0.22) * T - (1.0 - 0.387) * F * sin(delta)
    return X, -(1.0 + 0.312) * F * cos(delta), -(-3.5 + 0.312 * -3.248) * F * cos(delta)


@pytest.mark.parametrize(
    ("n", "delta", "u", "v", "r"),
    [
        (10.4, 0.0, 1.179, 0.0, 0.0),
        (10.4, 0.35, 1.1, -0.1, 0.02),
        (10.4, -0.35, 1.1, 0.1, -0.02),
        (9.0, 0.2, 0.9, 0.05, 0.01),
    ],
)
def test_loads_are_those_of_the_published_formulas(n, delta, u, v, r):
    """To 2 % of the largest; -v stands for U beta, and the angle of the velocity at the propeller for beta_P."""
    _, _, *found = propeller_rudder_loads(n, -delta, u, v, r, unit=STERN)
    expected = published(n, delta, u, v, r)
    assert found[:2] == pytest.approx(expected[:2], abs=0.02 * max(map(abs, expected[:2])))
    assert found[2] == pytest.approx(expected[2], abs=0.02 * max(abs(expected[2]), 20.0))


def test_thrust_is_that_of_the_polynomial_over_the_advance_ratio():
    thrust, u_p = propeller_in_wake(10.0, 1.0, 0.0, 0.0, unit=STERN)
    J = u_p / (10.0 * 0.2157)
    assert u_p == pytest.approx(0.6)
    assert thrust == pytest.approx(RHO * 100.0 * 0.2157**4 * (0.2931 - 0.2753 * J - 0.1385 * J * J))


def test_positive_azimuth_pushes_the_stern_to_starboard_and_turns_her_to_port():
    loads = propeller_rudder_loads(10.0, 0.3, 1.0, 0.0, 0.0, unit=STERN)
    assert loads.tau_Y > 0.0 and loads.tau_N < 0.0 and loads.tau_X < loads.thrust


def test_port_mirrors_starboard_where_both_sides_have_the_same_numbers():
    even = replace(STERN, wake_change_port=1.6, straightening_port=0.640)
    one = propeller_rudder_loads(10.0, 0.3, 1.0, 0.1, 0.02, unit=even)
    other = propeller_rudder_loads(10.0, -0.3, 1.0, -0.1, -0.02, unit=even)
    assert other[2:] == pytest.approx((one.tau_X, -one.tau_Y, -one.tau_N))


def test_the_rudder_works_in_the_race_of_a_ship_at_rest_and_not_without_a_race():
    race = rudder_normal_force(0.3, 40.0, 0.0, 0.0, 0.0, unit=STERN)
    assert race > 1.0
    assert abs(rudder_normal_force(0.3, 0.0, 0.0, 0.0, 0.0, unit=STERN)) < 1e-6


def test_astern_the_thrust_turns_round_and_is_weaker():
    ahead, astern = (propeller_in_wake(n, 0.0, 0.0, 0.0, unit=STERN)[0] for n in (10.0, -10.0))
    assert astern == pytest.approx(-0.5 * ahead)
