"""The filter that rides through a loss of GNSS, against closed forms, and the region."""

from math import cos, exp, pi, sin

import pytest

from shipcosim.learn.dead_reckoning.recipes import design_of
from shipcosim.models.prediction import motion_filter
from shipcosim.models.prediction.motion_filter import State
from shipcosim.models.prediction.outage import Measured, Region, radius

DESIGN = design_of("kinetic")
CALM = Measured(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, (0.0,) * 6)
STILL = State(*(0.0,) * 10)


def after(state, measured, seconds, design=DESIGN):
    for _ in range(seconds):
        state = motion_filter.step(state, measured, 1.0, design=design)
    return state


def test_without_loads_velocity_dies_away_with_its_time_constant():
    found = after(STILL._replace(u=0.5, v=-0.2), CALM, 60)
    assert found.u == pytest.approx(0.5 * exp(-60.0 / DESIGN.surge_time))
    assert found.v == pytest.approx(-0.2 * exp(-60.0 / DESIGN.sway_time))
    way = 0.5 * DESIGN.surge_time * (1.0 - exp(-60.0 / DESIGN.surge_time))
    assert found.x == pytest.approx(way, rel=1e-3)  # steps of a second by the trapezoidal rule


def test_a_thruster_brings_her_to_the_speed_of_its_load_over_the_damping():
    ahead = CALM._replace(commands=(0.0,) * 4 + (10.0, 10.0))
    found = after(STILL, ahead, 600)
    thrust = 2.0 * 378e3 * (10.0 / 28.7) ** 2
    assert found.u == pytest.approx(thrust / 3.0e5, rel=1e-6) and found.v == 0.0


def test_she_goes_where_she_heads():
    found = after(STILL._replace(u=0.3), CALM._replace(psi=pi / 3.0), 30)
    assert found.y / found.x == pytest.approx(sin(pi / 3.0) / cos(pi / 3.0))


def test_port_mirrors_starboard():
    one = CALM._replace(
        wind_speed=8.0, wind_from=0.7, commands=(50.0, 40.0, -30.0, 20.0, 5.0, -3.0)
    )
    other = one._replace(wind_from=-0.7, commands=(-50.0, -40.0, 30.0, -20.0, 5.0, -3.0))
    a, b = after(STILL, one, 60), after(STILL, other, 60)
    assert (a.x, a.y, a.u, a.v) == pytest.approx((b.x, -b.y, b.u, -b.v))


def test_with_gnss_it_finds_a_load_that_it_does_not_know():
    """A ship held in place against a thruster: the load is what the thruster gives, backwards."""
    held = CALM._replace(valid=1.0, commands=(80.0, 80.0, 0.0, 0.0, 0.0, 0.0))
    found = after(STILL, held, 3000)
    assert found.load_east == pytest.approx(-2.0 * DESIGN.bow * 80.0**2, rel=1e-3)
    assert abs(found.y) < 0.01 and found.lost_for == 0.0


def test_the_load_fades_to_its_mean_while_gnss_is_lost():
    found = after(STILL._replace(load_north=2e-3, mean_north=1e-3), CALM, 50)
    assert found.load_north == pytest.approx(1e-3 + 1e-3 * exp(-50.0 / DESIGN.load_time))
    assert found.mean_north == 1e-3 and found.lost_for == 50.0


def test_a_rough_sea_makes_it_slower_to_believe():
    gone = CALM._replace(valid=1.0, x=1.0)
    calm, rough = (
        motion_filter.step(STILL._replace(sea=sea), gone, 1.0, design=DESIGN) for sea in (0.0, 4.0)
    )
    assert 0.0 < rough.x < calm.x < 1.0


def test_last_position_stays():
    design, moving = (
        design_of("last-position"),
        CALM._replace(valid=1.0, x=3.0, u=0.4, wind_speed=10.0),
    )
    there = after(STILL, moving, 300, design)
    lost = after(there, moving._replace(valid=0.0), 60, design)
    assert there.x == pytest.approx(3.0, abs=0.01) and lost.x == pytest.approx(there.x, abs=0.01)


def test_the_region_grows_with_time_and_sea_and_beyond_what_was_calibrated():
    region = Region((0.0, 30.0, 60.0), (0.5, 1.0, 2.0), 3.0)
    assert [radius(time, 0.0, region=region) for time in (0.0, 15.0, 60.0, 90.0)] == pytest.approx(
        [0.5, 0.75, 2.0, 3.0]
    )
    assert radius(30.0, 0.04, region=region) == pytest.approx(1.6)
