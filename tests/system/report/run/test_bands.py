"""Limits of expectations as they are drawn."""

import numpy as np
import pytest

from shipcosim.report.run.bands import bands_of
from shipcosim.report.run.derived import FROM_EXPECTED, add_derived
from shipcosim.report.run.roles import find_roles
from shipcosim.report.theme.display import display_table
from shipcosim.scenario import Expectation, Scenario, judge


@pytest.fixture
def draw(four_corner):
    """Function from an expectation to the shown table and its verdicts."""

    def draw(**expect):
        table = four_corner(1.0)
        scenario = Scenario(stop_time=1100.0, step_size=1.0, expect=[Expectation(**expect)])
        verdicts, roles = judge(table, scenario), find_roles(table.data_vars)
        return add_derived(
            display_table(table, roles.signal(roles.ship, "psi")), table, roles, verdicts
        ), verdicts

    return draw


def test_band_lies_around_the_expected_value_in_its_window_in_degrees(draw):
    shown, verdicts = draw(
        signal=["vessel.psi"], near=[-np.pi / 4], within=np.pi / 180, during=[630.0, 650.0]
    )
    (band,) = bands_of(shown, "vessel.psi", verdicts)
    assert band.time == [630.0, 650.0] and band.passed
    assert band.lower == pytest.approx([-46.0, -46.0]) and band.upper == pytest.approx(
        [-44.0, -44.0]
    )


def test_band_of_an_angle_lies_beside_the_angle_drawn(draw):
    """7/4 pi is the same heading as -pi/4, which is where the ship is drawn."""
    shown, verdicts = draw(
        signal=["vessel.psi"], near=[1.75 * np.pi], within=0.1, during=[630.0, 650.0]
    )
    (band,) = bands_of(shown, "vessel.psi", verdicts)
    assert verdicts[0].passed and band.upper[0] == pytest.approx(-45.0 + np.degrees(0.1), abs=1e-5)


def test_band_of_an_error_is_seen_from_the_reference(draw):
    shown, verdicts = draw(signal=["vessel.x"], near=[20.0], within=0.5, during=[230.0, 250.0])
    (band,) = bands_of(shown, "vessel.x", verdicts, minus="reference.x_d")
    reference = shown["reference.x_d"].sel(time=slice(230.0, 250.0)).values
    np.testing.assert_allclose(band.lower, 19.5 - reference, atol=1e-5)


def test_band_around_another_signal_follows_it(draw):
    shown, verdicts = draw(signal=["vessel.x"], near=["reference.x_d"], within=0.5)
    (band,) = bands_of(shown, "vessel.x", verdicts)
    np.testing.assert_allclose(band.upper, shown["reference.x_d"] + 0.5, atol=1e-5)
    assert band.passed == verdicts[0].passed


def test_one_sided_limit_is_open_as_far_as_the_signal_goes(draw):
    shown, verdicts = draw(signal=["port.power"], at_most=100.0)
    (band,) = bands_of(shown, "port.power", verdicts)
    assert band.upper[0] == pytest.approx(0.1) and band.lower[0] <= float(shown["port.power"].min())
    assert not band.passed


def test_distance_that_is_drawn_is_the_one_that_was_judged(draw):
    shown, verdicts = draw(
        signal=["vessel.x", "vessel.y"], near=[20.0, 0.0], within=0.5, during=[230.0, 250.0]
    )
    drawn = shown[FROM_EXPECTED]
    assert float(drawn.max()) == pytest.approx(verdicts[0].worst, abs=1e-12)
    assert drawn.notnull().sum() == 21
