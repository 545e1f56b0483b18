from dataclasses import replace

import numpy as np
import pytest

from truth import draw, plant
from truth.form import DRAG_ALONG, EXPONENT, HULL_LOSS, SPEEDS, WIND_ROUND, draw_form
from truth.knobs import Knobs
from truth.ship import CROSS_SPEED, DRAG_SPEED, STRIP_X, Coefficients, draw_coefficients
from truth.thrusters import lost_at_hull

KNOBS = Knobs(1)


def ship(seed=3, size=1.0):
    form = draw_form(np.random.default_rng(seed), size)
    plain = draw_coefficients(np.random.default_rng(5), mismatch=1.0)
    formed = draw_coefficients(np.random.default_rng(5), mismatch=1.0, form=form)
    return form, *(Coefficients.stack([one]) for one in (plain, formed))


def loads(coefficients, u=0.0, v=0.0, r=0.0):
    return np.array(
        plant.hull_load(*(np.array([value]) for value in (u, v, r)), coefficients, KNOBS)
    )[:, 0]


def test_a_form_of_no_size_is_the_model_s():
    _, plain, formed = ship(size=0.0)
    names = (
        "drag",
        "drag_power",
        "strips",
        "cross_flow_power",
        "wind",
        "tunnel_fading",
        "rolls",
        "damping",
        "memory",
    )
    for name in (*names, "hull_loss"):
        np.testing.assert_allclose(
            getattr(formed, name), getattr(plain, name), rtol=1e-12, atol=0.0
        )


def test_forms_stay_about_within_what_is_said_of_them():
    forms = [draw_form(np.random.default_rng(seed)) for seed in range(300)]
    along = np.array([form.strips(np.linspace(-1, 1, 5)) for form in forms])
    round_ship = np.array([form.wind for form in forms])
    assert np.abs(along - 1.0).max() <= DRAG_ALONG + 1e-12
    assert along.std() == pytest.approx(DRAG_ALONG / np.sqrt(3.0), rel=0.1)
    assert (
        np.percentile(np.abs(round_ship - 1.0), 99) < 1.1 * WIND_ROUND
    )  # splines swing over in between
    np.testing.assert_allclose(round_ship[..., 0], round_ship[..., -1])
    assert max(abs(form.drag_power - 2.0) for form in forms) <= EXPONENT
    assert max(abs(form.cross_flow_power - 2.0) for form in forms) <= EXPONENT
    lost = np.array([form.hull_loss for form in forms])
    assert np.percentile(np.abs(lost), 99) < 1.1 * HULL_LOSS
    assert lost.mean() == pytest.approx(0.5 * HULL_LOSS * 7 / 8, rel=0.1)


def test_drag_of_another_power_is_the_same_at_one_speed():
    form, plain, formed = ship()
    linear = form.damping[0] * plain.drag[0] * SPEEDS[0]
    assert loads(formed, u=DRAG_SPEED)[0] == pytest.approx(
        loads(plain, u=DRAG_SPEED)[0] - linear * DRAG_SPEED
    )


def test_cross_flow_of_another_power_is_the_same_at_one_speed():
    form, plain, _ = ship()
    other = replace(plain, cross_flow_power=plain.cross_flow_power - 0.1)
    other = replace(other, strips=plain.strips * CROSS_SPEED**0.1)
    assert loads(other, v=CROSS_SPEED)[1] == pytest.approx(loads(plain, v=CROSS_SPEED)[1])
    assert loads(other, v=0.1)[1] < loads(plain, v=0.1)[1] < 0.0  # more drag where it is slower
    assert form.cross_flow_power != 2.0


def test_the_hull_takes_thrust_by_its_direction_and_none_ahead():
    form, _, formed = ship()
    for degrees, thrust in ((90.0, 1e4), (0.0, 1e4), (180.0, -1e4)):
        azimuth = np.radians(np.full((2, 1), degrees))
        lost = lost_at_hull(np.full((2, 1), thrust), azimuth, formed)
        np.testing.assert_allclose(
            lost[:, 0], form.hull_loss[:, 9] if degrees == 90.0 else 0.0, atol=1e-12
        )
    assert form.hull_loss[:, 9].min() > 0.0


def test_linear_damping_is_its_share_of_the_quadratic_one():
    form, plain, formed = ship()
    linear = loads(formed, v=1e-6)[1] / -1e-6
    quadratic = formed.strips.sum() * SPEEDS[1] ** (form.cross_flow_power - 1.0)
    assert linear == pytest.approx(form.damping[1] * quadratic, rel=1e-3)
    assert form.damping[1] > 0.01 and loads(plain, v=1e-6)[1] / -1e-6 < 1.0


def test_drag_that_is_larger_forward_turns_a_ship_that_moves_sideways():
    form, plain, formed = ship()
    wanted = -(STRIP_X * formed.strips[:, 0]).sum() * 0.5**form.cross_flow_power
    assert loads(formed, v=0.5)[2] == pytest.approx(wanted)
    assert abs(loads(plain, v=0.5)[2]) < 1e-9 < abs(wanted)


def test_memory_is_an_added_mass_in_slow_motion_and_a_damping_in_quick():
    form, _, formed = ship()
    h, remembered = 0.25, np.zeros((3, 1))
    for step in range(2000):
        load, remembered = plant.memory_load(
            np.full((3, 1), 0.001 * h * step), remembered, formed, h
        )
    np.testing.assert_allclose(load, -0.001 * formed.memory, rtol=0.05)  # half a step late
    load, _ = plant.memory_load(np.ones((3, 1)), np.zeros((3, 1)), formed, h)
    np.testing.assert_allclose(load, -formed.memory / formed.memory_time)


def test_a_form_changes_neither_weather_nor_plan_of_a_log():
    plain, formed = (
        draw("work", 2, causes=0, minutes=10),
        draw("work", 2, causes=0, minutes=10, form=1.0),
    )
    assert np.abs(plain.log["wind_speed [m/s]"] - formed.log["wind_speed [m/s]"]).median() < 0.1
    target = [case.truth["x"] for case in (plain, formed)]
    assert 0.0 < np.abs(target[0] - target[1]).max() < 3.0
