"""Loads of a form that is not that of the hull's law, against closed forms."""

from math import pi, radians

import pytest
from ships import parameters

from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.ship.hull import HullParameters, cross_flow, quadratic_damping
from shipcosim.models.ship.rough_form import (
    RoughFormParameters,
    form_loads,
    memory_loads,
    rough_wind_loads,
)

HULL, WIND = parameters(HullParameters), parameters(WindParameters)


def test_drag_larger_by_a_third_everywhere_is_a_third_of_the_cross_flow():
    form = RoughFormParameters(strip_factors="-1 1.333; 1 1.333")
    for v, r in ((0.5, 0.0), (0.2, 0.02), (0.0, 0.03)):
        _, Y, N = cross_flow(0.0, v, r, hull=HULL)
        found = form_loads(0.0, v, r, hull=HULL, form=form)
        assert found[1:] == pytest.approx(
            (0.333 * Y, 0.333 * N), rel=0.015
        )  # strips against the integral


def test_more_drag_aft_turns_the_bow_with_the_sway():
    X, Y, N = form_loads(
        0.0, 0.5, 0.0, hull=HULL, form=RoughFormParameters(strip_factors="-1 1.2; 1 0.8")
    )
    half = 0.5 * HULL.length
    _, uniform, _ = cross_flow(0.0, 0.5, 0.0, hull=HULL)
    assert (X, Y) == (0.0, pytest.approx(0.0, abs=1e-6 * abs(uniform)))
    assert pytest.approx(-0.2 * uniform * half / 3.0, rel=0.01) == N
    assert N > 0.0


def test_other_powers_agree_at_their_reference_speeds_and_grow_by_the_power():
    form = RoughFormParameters(drag_power=1.85, cross_flow_power=2.15)
    assert form_loads(1.2, 0.3, 0.0, hull=HULL, form=form) == pytest.approx(
        (0.0, 0.0, 0.0), abs=1e-9
    )
    X, _, _ = form_loads(2.4, 0.0, 0.0, hull=HULL, form=form)
    assert pytest.approx((2.0**-0.15 - 1.0) * quadratic_damping(2.4, 0.0, 0.0, hull=HULL)[0]) == X
    _, Y, _ = form_loads(0.0, 0.6, 0.0, hull=HULL, form=form)
    assert pytest.approx((2.0**0.15 - 1.0) * cross_flow(0.0, 0.6, 0.0, hull=HULL)[1]) == Y


def test_memory_is_an_added_mass_in_slow_motion_and_forgets_after_a_step():
    form, a, h = RoughFormParameters(memory_sway=0.2, memory_time=4.0), 0.01, 0.01
    z = (0.0, 0.0, 0.0)
    for k in range(6000):  # 15 times the memory, at a constant acceleration
        load, z = memory_loads((0.0, a * h * k, 0.0), z, h, hull=HULL, form=form)
    assert load[1] == pytest.approx(-0.2 * HULL.A22 * a, rel=0.01)
    for _ in range(6000):
        load, z = memory_loads((0.0, 0.6, 0.0), z, h, hull=HULL, form=form)
    assert load[1] == pytest.approx(0.0, abs=1e-3)


def test_wind_factors_hold_the_whole_way_round():
    form = RoughFormParameters(wind_factors="0 1 1 1; 90 1.1 0.9 1.2; 270 1 1.3 0.8; 360 1 1 1")
    X, Y, N = wind_loads(8.0, radians(90.0), wind=WIND)
    found = rough_wind_loads(8.0, radians(90.0), wind=WIND, form=form)
    assert found == pytest.approx((1.1 * X, 0.9 * Y, 1.2 * N))
    found = rough_wind_loads(8.0, radians(-90.0), wind=WIND, form=form)
    assert found == pytest.approx((X, -1.3 * Y, -0.8 * N))
    X, Y, N = wind_loads(8.0, radians(-45.0), wind=WIND)
    assert rough_wind_loads(8.0, radians(-45.0), wind=WIND, form=form) == pytest.approx(
        (X, 1.15 * Y, 0.9 * N)
    )


def test_wind_factors_must_go_round():
    with pytest.raises(ValueError, match="0 to 360"):
        rough_wind_loads(
            8.0, pi, wind=WIND, form=RoughFormParameters(wind_factors="0 1 1 1; 180 2 1 1")
        )
