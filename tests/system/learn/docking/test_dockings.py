"""Dockings: apart from one another, at harbours of their kind, and ended at the berth."""

import numpy as np
import pytest

pytest.importorskip("torch")

from shipcosim.learn.docking import dockings
from shipcosim.learn.docking.harbours import FAMILIAR, UNSEEN, harbour
from shipcosim.learn.docking.records import KNOWN, TRUTH

FAMILIAR_SEEDS = dockings.TRAINING, dockings.CALIBRATION, dockings.CHOICES, dockings.HELD_OUT


@pytest.fixture(scope="module")
def docking():
    return dockings.draw(5)


@pytest.fixture(scope="module")
def record(docking):
    return dockings.sail(docking)


def test_no_docking_is_in_two_sets_and_unseen_harbours_are_never_trained_at():
    seeds = [seed for group in (*FAMILIAR_SEEDS, dockings.HELD_OUT_UNSEEN) for seed in group]
    assert len(set(seeds)) == len(seeds)
    drawn = {seed: dockings.draw(seed) for seed in seeds}
    assert len({tuple(one.set.values()) for one in drawn.values()}) == len(seeds)
    for group in FAMILIAR_SEEDS:
        assert {drawn[seed].harbour for seed in group} <= set(FAMILIAR)
    assert {drawn[seed].harbour for seed in dockings.TRAINING} == set(FAMILIAR)
    assert {drawn[seed].harbour for seed in dockings.HELD_OUT_UNSEEN} == set(UNSEEN)
    assert not set(FAMILIAR) & set(UNSEEN)


def test_way_ends_off_the_quay_on_the_side_of_the_water():
    for number in (*FAMILIAR, *UNSEEN):
        port = harbour(number)
        x, y = port.waypoints(12.0, 2000.0)[-1]
        beside = y * np.cos(port.berth_heading) - x * np.sin(
            port.berth_heading
        )  # to starboard of the berth
        assert np.hypot(x, y) == pytest.approx(12.0)
        assert beside == pytest.approx(-12.0 * port.berth_side)


def test_way_is_as_long_as_asked():
    points = np.array(harbour(3).waypoints(10.0, 2345.0))
    assert np.hypot(*np.diff(points, axis=0).T).sum() == pytest.approx(2345.0)


def test_true_ship_is_her_model_at_distance_0_and_the_same_at_every_docking():
    nominal = {name: value for name, value, _ in dockings._tolerated()}
    near = dockings.true_ship(0.0)
    assert {name: near[name] for name in nominal} == pytest.approx(nominal)
    differs = dockings.true_ship(1.0).items() - near.items()
    assert len(differs) > 50
    assert (
        dockings.true_ship(1.0).items()
        <= dockings.draw(7).set.items() & dockings.draw(8).set.items()
    )


def test_record_ends_with_the_ship_at_the_berth(record, docking):
    assert set(record.known) == set(KNOWN) and set(record.truth) == set(TRUTH)
    assert all(
        len(one) == dockings.SAMPLES for one in (*record.known.values(), *record.truth.values())
    )
    x, y, psi, u, v, _ = (record.truth[name][-1] for name in TRUTH)
    assert np.hypot(x, y) < 3.0 and np.hypot(u, v) < 0.1
    assert abs(np.sin(psi - docking.set["helmsman.berth_heading"])) < 0.1
    assert (
        record.truth["u"][0] > 3.0 and np.hypot(record.truth["x"][0], record.truth["y"][0]) > 1000.0
    )


def test_what_is_measured_is_near_the_truth_but_is_not_it(record):
    for name in TRUTH[:2]:
        error = record.known[f"{name}_meas"] - record.truth[name]
        assert 0.0 < np.std(error[-200:]) < 1.0
