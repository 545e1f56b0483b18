"""Drawn worlds: apart from one another, and as far from the nominal model as the distance says."""

import numpy as np
import pytest

pytest.importorskip("torch")

from shipcosim.learn.prediction.worlds import (
    CALIBRATION,
    HELD_OUT,
    KNOWN,
    TOLERATED,
    TRAINING,
    TUNING,
    Record,
    draw,
    sail,
)


@pytest.fixture(scope="module")
def record() -> Record:
    return sail(draw(3))


def test_no_world_is_in_two_sets():
    sets = [set(seeds) for seeds in (TRAINING, CALIBRATION, TUNING, HELD_OUT)]
    assert sum(map(len, sets)) == len(set().union(*sets))
    drawn = [tuple(draw(seed).set.values()) for seeds in sets for seed in sorted(seeds)]
    assert len(set(drawn)) == len(drawn)


def test_same_seed_gives_the_same_world_and_distance_only_its_size():
    assert draw(5) == draw(5)
    near, far, neutral = draw(5, 1.0), draw(5, 2.0), draw(5, 0.0)
    assert near.lost_at == far.lost_at
    for name in TOLERATED:
        twice = 2.0 * (near.set[name] - neutral.set[name])
        assert far.set[name] - neutral.set[name] == pytest.approx(twice, rel=1e-9)


def test_ship_is_held_loses_all_thrust_and_drifts(record):
    after = record.time > record.lost_at + 15.0
    for name in ("tau_X_allocated", "tau_Y_allocated", "tau_N_allocated"):
        assert abs(record.column(name)[~after]).max() > 0.0
        assert abs(record.column(name)[after]).max() < 1.0
    start, end = record.truth[int(record.lost_at)], record.truth[-1]
    assert np.hypot(*(end - start)[:2]) > 5.0
    assert record.time[-1] - record.lost_at >= 150.0


def test_what_she_knows_is_near_what_became_of_her_but_is_not_it(record):
    errors = record.known[60:, :6] - record.truth[60:]
    rms = np.sqrt(np.mean(errors**2, axis=0))
    assert KNOWN[:6] == ("x_hat", "y_hat", "psi_hat", "u_hat", "v_hat", "r_hat")
    assert (rms > 0.0).all()
    assert (rms < [0.3, 0.3, 0.02, 0.05, 0.05, 0.005]).all()


def test_at_distance_0_the_form_is_neutral():
    values = draw(5, 0.0).set
    ones = {"vessel.strip_factors": 2, "vessel.wind_factors": 4}
    for name, width in ones.items():
        rows = [[float(value) for value in row.split()] for row in values[name].split(";")]
        assert all(len(row) == width and set(row[1:]) == {1.0} for row in rows)
    assert (values["vessel.drag_power"], values["vessel.cross_flow_power"]) == (2.0, 2.0)
    assert not any(
        values[f"vessel.{name}"] for name in ("X_u", "Y_v", "N_r", "memory_surge", "memory_sway")
    )
