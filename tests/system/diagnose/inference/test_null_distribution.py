"""Healthy ships keep the log's track in its weather, and what they gain by chance is little."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin
from diagnose.twin import fits, problem

from shipcosim.diagnose.explanation.null_distribution import (
    drawn_within_tolerances,
    healthy_records,
    null_gains,
)
from shipcosim.models.core.motion import Motion

COUNT = 6


@pytest.fixture(scope="module")
def records():
    return healthy_records(problem("mass"), fits("mass")[0].motion, COUNT, np.random.default_rng(0))


def spread(values):
    return np.sqrt(np.mean(values**2))


def test_healthy_ships_keep_the_track(records):
    """To 2 % of its 280 m and 3 deg of its 170; each has other coefficients, all a fifth less mass than what sailed."""
    track = np.stack(fits("mass")[0].motion, axis=-1)
    off = records.measured - track
    assert records.measured.shape == (COUNT, track.shape[0], 6)
    assert spread(off[..., :2]) < 0.02 * np.ptp(track[:, 0])
    assert np.degrees(spread(off[..., 2])) < 3.0
    assert spread(off[..., 3:5]) < 0.1 * np.ptp(track[:, 3])


def test_healthy_ships_are_noisy_as_the_log(records):
    """By third differences, in which motion is lost: each channel to 15 %."""
    third = np.diff(records.measured, 3, axis=1) / np.sqrt(20.0)
    np.testing.assert_allclose(third.std(axis=(0, 1)), problem("mass").noise.white, rtol=0.15)


def test_thrusters_of_healthy_ships_stay_near_the_logged_ones_and_within_limits(records):
    for name, (n, _) in records.units.items():
        most, logged = (
            problem("mass").model.get(f"{name}.rpm_max") / 60.0,
            problem("mass").record.units[name][0],
        )
        assert np.abs(n).max() <= most * (1.0 + 1e-9)
        assert spread(n - logged) < 0.3 * most
        assert np.std(n, axis=0).max() > 0.0  # feedback is at work, and differs from ship to ship


def test_the_same_seed_gives_the_same_ships(records):
    again = healthy_records(
        problem("mass"), fits("mass")[0].motion, COUNT, np.random.default_rng(0)
    )
    np.testing.assert_array_equal(again.measured, records.measured)


def test_gaps_of_the_log_are_in_the_healthy_logs():
    here = problem("mass")
    measured = here.record.measured.copy()
    measured[100:120, 2] = np.nan
    holed = replace(here, record=replace(here.record, measured=measured))
    found = healthy_records(holed, fits("mass")[0].motion, 2, np.random.default_rng(0))
    assert (
        np.isnan(found.measured[:, 100:120, 2]).all() and np.isfinite(found.measured[..., :2]).all()
    )


def test_no_cause_gains_by_chance_on_a_log_that_moves():
    gains = null_gains(
        problem("mass"), fits("mass")[0].motion, problem("mass").hypotheses, count=COUNT
    )
    assert set(gains) == {hypothesis.label for hypothesis in problem("mass").hypotheses}
    assert all(values.shape == (COUNT,) for values in gains.values())
    assert max(values.max() for values in gains.values()) < 5.0
    assert np.mean([values.mean() for values in gains.values()]) < 0.0


def test_stationkeeping_does_not_blame_the_damping():
    """A ship that lies still at constant thrust, with noise: the trap of regressors that are noise."""
    here = problem("healthy")
    n = here.record.time.size
    still = {name: (np.full(n, 1.0), np.full(n, 0.2)) for name in here.model.thrusters}
    wind = tuple(np.full(n, value) for value in (8.0, 0.5))
    calm = replace(here, record=replace(here.record, units=still, wind=wind))
    track = Motion(*np.zeros((6, n)))
    damping = [
        hypothesis for hypothesis in here.hypotheses if hypothesis.cause in ("crossflow", "drag")
    ]
    gains = null_gains(calm, track, damping, count=10)
    assert max(values.max() for values in gains.values()) < 3.0


def test_a_tolerance_that_is_wider_makes_healthy_ships_differ_more():
    here = problem("mass")
    tolerances = here.model.tolerances
    off = []
    for factor in (0.0, 3.0):
        model = replace(
            here.model, tolerances={path: factor * value for path, value in tolerances.items()}
        )
        found = healthy_records(
            replace(here, model=model), fits("mass")[0].motion, COUNT, np.random.default_rng(0)
        ).units["port"][0]
        off.append(np.std(found, axis=0).mean())
    assert off[1] > 1.2 * off[0]
    assert twin.model().tolerances == tolerances


def test_no_drawn_ship_is_driven_by_her_damping_however_wide_its_tolerance():
    ship = twin.model()
    wide = {"vessel.X_u": 1e4, "vessel.N_r": 1e6, "vessel.X_uu": 4e3}
    drawn = drawn_within_tolerances(ship.with_tolerances(wide), (400,), np.random.default_rng(3))
    for path in wide:
        assert np.max(drawn.get(path)) == 0.0 and np.min(drawn.get(path)) < ship.get(path)
