"""Loads of Level 1 against numbers worked out by hand by others, and against what the formulae must do."""

from dataclasses import replace

import numpy as np
import pytest
from capability.psv import HULL

from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS, Condition
from shipcosim.capability.loads import current, level_1_parts, waves, wind

SIDES = np.radians([0.0, 90.0, 180.0])


def total_loads(hull, condition, weather_from):
    """Sum of the mean loads of wind, current and waves, (n, 3)."""
    return sum(level_1_parts(hull, condition, weather_from).values())


def test_loads_of_condition_6_are_those_of_another_implementation():
    """Published to 0.1 kN and 0.1 kN.m, y to port: the sway force and the moment change their sign."""
    published = {
        "wind": [(-22.9, 0.0, 0.0), (0.0, 73.5, 882.6), (22.9, 0.0, 0.0)],
        "current": [(-2.2, 0.0, 0.0), (0.0, 84.8, -127.3), (2.2, 0.0, 0.0)],
        "waves": [(-24.6, 0.0, 0.0), (-4.4, 128.0, -348.1), (26.1, 0.0, 0.0)],
    }
    for name, found in level_1_parts(HULL, CONDITIONS[5], SIDES).items():
        assert found / 1e3 == pytest.approx(np.array(published[name]) * [1, -1, -1], abs=0.051), (
            name
        )
    total = 1.25 * total_loads(HULL, CONDITIONS[5], SIDES) / 1e3
    published = [(-62.1, 0, 0), (-5.5, -358.0, -509.0), (64.0, 0, 0)]
    assert total == pytest.approx(np.array(published), abs=0.051)


@pytest.mark.parametrize(
    "height, period, angle, expected",
    [
        (2.0, 3.5, 0.0, (-18752.4833, 0.0, 0.0)),
        (2.0, 3.5, 90.0, (-3424.5931, -155807.1288, 423795.3903)),
        (2.0, 3.5, 135.0, (13367.2678, -110172.2773, 631287.1491)),
        (2.0, 3.5, 270.0, (-3424.5931, 155807.1288, -423795.3903)),
        (4.0, 10.0, 0.0, (-27034.2779, 0.0, 0.0)),
    ],
)
def test_wave_drift_is_that_worked_out_by_hand_elsewhere(height, period, angle, expected):
    hull, sea = replace(HULL, bow_angle=0.4), Condition(0, 0.0, height, period, 0.0)
    assert waves(hull, sea, np.radians([angle]))[0] == pytest.approx(expected, abs=0.01)


def test_wind_from_ahead_and_abeam_are_drag_of_the_areas():
    """Half rho V2 is 61.3 N/m2 at 10 m/s; coefficients 0.7 and 0.9; at the beam the centre of the area is the lever."""
    found = wind(HULL, 10.0, SIDES)
    assert found[0] == pytest.approx((-0.7 * 61.3 * 280.0, 0.0, 0.0))
    assert found[1] == pytest.approx((0.0, -0.9 * 61.3 * 700.0, -0.9 * 61.3 * 700.0 * 12.0))


def test_current_pushes_at_a_quarter_of_the_length_at_most():
    """From 10 deg the lever is 0.4 (1 - 2/18) = 0.356 Lpp by the straight line, but never more than 0.25 Lpp."""
    X, Y, N = current(HULL, 0.75, np.radians([10.0]))[0]
    assert N / Y == pytest.approx(-1.5 + 0.25 * 80.0)
    assert X < 0.0


@pytest.mark.parametrize("condition", CONDITIONS, ids=lambda condition: condition.number)
def test_weather_from_port_mirrors_weather_from_starboard(condition):
    found = total_loads(HULL, condition, DIRECTIONS)
    mirrored = total_loads(HULL, condition, -DIRECTIONS)
    assert mirrored == pytest.approx(found * [1.0, -1.0, -1.0], abs=1e-6)


def test_every_condition_is_harder_than_the_one_before():
    sizes = np.array(
        [np.abs(total_loads(HULL, c, DIRECTIONS)[:, :2]).sum(axis=1) for c in CONDITIONS]
    )
    assert (np.diff(sizes, axis=0) > 0.0).all()


def test_moments_are_about_the_ships_origin():
    """The same loads about a point 3 m behind midship: the moment grows by 3 m times the sway force."""
    about_midship = total_loads(HULL, CONDITIONS[4], DIRECTIONS)
    about_origin = total_loads(replace(HULL, midship_x=3.0), CONDITIONS[4], DIRECTIONS)
    assert about_origin[:, :2] == pytest.approx(about_midship[:, :2])
    assert about_origin[:, 2] == pytest.approx(about_midship[:, 2] + 3.0 * about_midship[:, 1])
