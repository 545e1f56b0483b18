"""Plain fixed thrusters: the force is where and what it should be."""

from dataclasses import replace
from math import pi

import pytest
from ships import parameters

from shipcosim.models.propulsion.fixed import FixedParameters, fixed_loads, shaft_speed

OTTER = parameters(FixedParameters, "otter")
BLUE = parameters(FixedParameters, "blueboat")
STILL = (0.0, 0.0, 0.0)


def test_the_otters_propellers_give_the_bollard_pull_that_she_is_published_with():
    """24.4 kgf ahead at 993 rpm, 13.6 kgf astern at 971 rpm, both propellers together."""
    for rpm, pull in ((993.0, 24.4), (-971.0, -13.6)):
        thrust = 2.0 * fixed_loads(0.0, rpm * pi / 30.0, *STILL, thruster=OTTER).thrust
        assert thrust == pytest.approx(9.81 * pull, rel=2e-3)


def test_a_force_is_given_as_commanded_with_its_gains_ahead_and_astern():
    unequal = replace(BLUE, gain_ahead=0.9, gain_astern=0.6)
    assert fixed_loads(50.0, 0.0, *STILL, thruster=unequal).thrust == pytest.approx(45.0)
    assert fixed_loads(-50.0, 0.0, *STILL, thruster=unequal).thrust == pytest.approx(-30.0)


@pytest.mark.parametrize("force", [-100.0, -1.0, 0.0, 1.0, 100.0])
@pytest.mark.parametrize("speed", [-40.0, 0.0, 90.0])
def test_the_speed_of_the_shaft_gives_the_same_thrust_as_force_and_speed_together(force, speed):
    turning = shaft_speed(force, speed, thruster=OTTER)
    by_both = fixed_loads(force, speed, *STILL, thruster=OTTER).thrust
    assert fixed_loads(0.0, turning, *STILL, thruster=OTTER).thrust == pytest.approx(by_both)


def test_without_coefficients_the_speed_of_the_shaft_is_the_commanded_one():
    assert shaft_speed(50.0, 7.0, thruster=BLUE) == 7.0


def test_a_thruster_that_points_to_starboard_pushes_to_starboard_at_its_place():
    aside = replace(BLUE, direction=pi / 2, x=2.0, y=0.0)
    loads = fixed_loads(10.0, 0.0, *STILL, thruster=aside)
    assert loads[2:] == pytest.approx((0.0, 10.0, 20.0), abs=1e-12)


def test_way_in_the_direction_of_the_thrust_takes_thrust_and_way_against_it_gives_some():
    slow = replace(BLUE, speed_loss=0.25, x=0.0)
    ahead, astern = (
        fixed_loads(F, 0.0, 1.0, 0.0, 0.0, thruster=slow).thrust for F in (10.0, -10.0)
    )
    assert (ahead, astern) == pytest.approx((7.5, -12.5))
    assert fixed_loads(10.0, 0.0, 9.0, 0.0, 0.0, thruster=slow).thrust == 0.0


def test_the_inner_thruster_of_a_turn_meets_less_water():
    slow = replace(BLUE, speed_loss=0.25, x=0.0, y=0.3)
    assert fixed_loads(10.0, 0.0, 0.0, 0.0, 1.0, thruster=slow).thrust == pytest.approx(10.75)


def test_lost_thrust_is_lost_of_force_and_moment():
    whole, part = (
        fixed_loads(9.0, 0.0, *STILL, thruster=replace(BLUE, thrust_loss=x)) for x in (0.0, 0.5)
    )
    assert part[2:] == pytest.approx([0.5 * load for load in whole[2:]])
