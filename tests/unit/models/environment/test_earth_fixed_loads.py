"""Loads fixed to the earth: closed forms, and the drift law against the ship's own table of drift coefficients."""

from functools import partial
from math import pi, radians

import numpy as np
import pytest
from scipy.optimize import curve_fit
from ships import parameters

from shipcosim.models.environment import earth_fixed_loads, wave_loads, waves
from shipcosim.models.environment.earth_fixed_loads import earth_force, onset
from shipcosim.models.ship.vessel import DriftParameters

DRIFT_33M9 = parameters(DriftParameters).drift_table
drift_force = partial(earth_fixed_loads.drift_force, yaw_arm=-1.5)
AROUND = np.radians(np.arange(0.0, 360.0, 10.0))


@pytest.mark.parametrize(
    ("psi", "north", "east", "load"),
    [
        (0.0, 1000.0, 0.0, (1000.0, 0.0, 0.0)),
        (0.0, 0.0, 1000.0, (0.0, 1000.0, -17_000.0)),
        (90.0, 1000.0, 0.0, (0.0, -1000.0, 17_000.0)),
        (180.0, 1000.0, 0.0, (-1000.0, 0.0, 0.0)),
    ],
)
def test_a_line_at_the_stern_turns_the_ship_until_it_pulls_from_astern(psi, north, east, load):
    assert earth_force(radians(psi), north, east, x=-17.0) == pytest.approx(load, abs=1e-9)


def test_a_line_that_pulls_ahead_at_the_side_turns_away_from_it():
    """Made fast to starboard, pulling ahead: the bow goes to port."""
    assert earth_force(0.0, 1000.0, 0.0, x=0.0, y=2.0) == pytest.approx((1000.0, 0.0, -2000.0))


@pytest.mark.parametrize(
    ("travel", "X", "Y", "N"),
    [
        (0.0, 1 / 3, 0.0, 0.0),
        (90.0, 0.0, 1.0, 0.0),
        (180.0, -1 / 3, 0.0, 0.0),
        (45.0, 1 / (3 * 2**0.5), 0.5, -1.5),
    ],
)
def test_drift_is_its_law_at_the_angles_where_it_is_simple(travel, X, Y, N):
    """Travel direction from the bow; the heading is 30 deg and the waves turn with it."""
    A, to = 2400.0, radians(30.0 + travel)
    found = drift_force(radians(30.0), A * np.cos(to), A * np.sin(to))
    assert found == pytest.approx((X * A, Y * A, N * A), abs=1e-6)


def test_drift_on_port_mirrors_drift_on_starboard_and_doubles_with_the_force():
    X, Y, N = np.array(drift_force(-AROUND, 1000.0, 0.0))
    np.testing.assert_allclose(drift_force(AROUND, 1000.0, 0.0), (X, -Y, -N), atol=1e-9)
    np.testing.assert_allclose(drift_force(-AROUND, 2000.0, 0.0), (2.0 * X, 2.0 * Y, 2.0 * N))


def test_a_sway_power_of_one_is_the_component_across():
    X, Y, N = np.array(drift_force(-AROUND, 1000.0, 0.0, sway_power=1.0))
    np.testing.assert_allclose(Y, 1000.0 * np.sin(AROUND), atol=1e-9)
    np.testing.assert_allclose((X, N), np.array(drift_force(-AROUND, 1000.0, 0.0))[[0, 2]])


def test_no_waves_no_drift():
    assert drift_force(0.4, 0.0, 0.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("period", [4.5, 5.0, 5.5, 6.0, 7.0])
def test_drift_law_is_that_of_the_ships_table_in_seas_of_any_direction(period):
    """Waves that travel north; worst over all headings, of the force on the beam: 11, 12 % and 0.36 m."""
    sea = waves.components(0.5, period, pi, 3.3, 1)
    table = np.array(wave_loads.mean_drift(AROUND, sea, wave_loads.drift_table(DRIFT_33M9)))
    A = wave_loads.mean_drift(-0.5 * pi, sea, wave_loads.drift_table(DRIFT_33M9))[1]
    off = np.abs(np.array(drift_force(AROUND, A, 0.0)) - table).max(axis=1) / A
    assert np.all(off < (0.11, 0.12, 0.36)), off


def test_a_fitted_sway_power_of_the_ships_table_is_a_little_less_than_that_of_short_waves():
    """For each peak period, with the factor that goes with it."""
    table, powers = wave_loads.drift_table(DRIFT_33M9), []
    for period in (4.0, 4.5, 5.0, 5.5, 6.0, 7.0):
        sea = waves.components(0.5, period, pi, 3.3, 1)
        Y = (
            np.array(wave_loads.mean_drift(AROUND, sea, table))[1]
            / wave_loads.mean_drift(-0.5 * pi, sea, table)[1]
        )
        law = curve_fit(
            lambda psi, A, p: A * drift_force(psi, 1.0, 0.0, sway_power=p)[1],
            AROUND,
            Y,
            p0=(1.0, 2.0),
        )[0]
        powers.append(law[1])
    assert (min(powers), max(powers)) == pytest.approx((1.67, 1.75), abs=0.01)


def test_an_effect_grows_from_its_onset_over_its_ramp():
    times = np.array([0.0, 99.9, 100.0, 110.0, 120.0, 500.0])
    np.testing.assert_allclose(
        onset(times, onset_time=100.0, ramp_time=20.0), (0, 0, 0, 0.5, 1, 1), atol=1e-6
    )
    np.testing.assert_allclose(onset(times, onset_time=100.0, ramp_time=0.0), (0, 0, 1, 1, 1, 1))
    assert onset(0.0, onset_time=0.0, ramp_time=0.0) == 1.0
