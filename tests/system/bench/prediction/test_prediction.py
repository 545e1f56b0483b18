"""The comparison of predictors: its measures against cases that can be told by hand, and every predictor in a world."""

import numpy as np
import pytest

from prediction import learned, measuring, pages
from prediction.rivals import there
from shipcosim.learn.prediction.worlds import KNOWN, Record
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.prediction import own_model


def straight(seconds=90, lost_at=4.0, speed=(0.4, -0.3), psi=0.5):
    """Record of a ship that moves straight on in calm water without any load known."""
    time = np.arange(float(seconds))
    north, east = to_ned(psi, *speed)
    known = np.zeros((seconds, len(KNOWN)))
    known[:, 0], known[:, 1], known[:, 2], known[:, 3], known[:, 4] = (
        north * time,
        east * time,
        psi,
        *speed,
    )
    truth = known[:, :6].copy()
    return Record(1, lost_at, time, known, truth)


def test_constant_velocity_is_right_where_velocity_is_constant():
    found = measuring.measure("constant velocity", straight())
    assert found["errors"].shape == (20, 3, 3) and found["regions"].shape == (20, 3, 2)
    assert np.abs(found["errors"]).max() < 1e-9


def test_errors_are_those_of_the_time_predicted():
    record = straight()
    record.truth[4 + 1 + 10, 0] -= 2.0  # where the first prediction, made at 5 s, is 10 s ahead
    record.truth[4 + 20 + 60, 1] -= 3.0  # and the last one 60 s ahead
    errors = measuring.measure("constant velocity", record)["errors"]
    assert errors[0, 0, 0] == pytest.approx(2.0) and errors[19, 2, 1] == pytest.approx(3.0)
    assert np.sum(np.abs(errors) > 1e-6) == 2


@pytest.mark.parametrize("name", there())
def test_no_predictor_has_a_ship_stop_at_once_or_go_twice_as_far(name):
    """She goes 30 m in the minute, without any load that is known."""
    found = measuring.measure(name, straight())
    assert np.isfinite(found["errors"]).all()
    assert np.hypot(*found["errors"][0, 2, :2]) < 30.0


def of(errors, size=0.0):
    """Measures of a world whose predictions are all off by the same."""
    shape = (20, 3)
    return {
        "errors": np.broadcast_to(errors, (*shape, 3)),
        "regions": np.full((*shape, 2), size),
        "learned": np.zeros(20),
        "seconds": np.full(20, 1e-3),
    }


def test_means_are_of_sizes_and_in_degrees():
    found = pages.by_world([of([3.0, -4.0, -np.pi / 180.0])], 5)
    assert found[0, 2] == pytest.approx([3.0, 4.0, 1.0, 5.0])


def test_intervals_draw_whole_worlds_in_pairs():
    """Where every world is half as bad, so is every draw; and the interval of a mean is that of its worlds."""
    kinetic = np.array([1.0, 2.0, 9.0, 4.0])[:, None]
    assert [float(one[0]) for one in pages.interval(0.5 * kinetic, kinetic)] == pytest.approx(
        [0.5, 0.5, 0.5]
    )
    mean, low, high = (float(one[0]) for one in pages.interval(kinetic))
    assert mean == 4.0 and 1.0 < low < 3.0 and 5.0 < high < 9.0


def test_the_page_says_what_is_met_and_what_is_missed():
    worlds = {name: {0.0: [of([off, off, off], 1.0)] * 3, 1.0: [of([off, off, off], 1.0)] * 3}
              for name, off in (("kinetic", 1.0), ("ours", 0.4))}  # fmt: skip
    text = pages.page(worlds, range(3), "command")
    assert "north -60 %, east -60 %, yaw -60 % | **missed** |" in text.partition("first 20")[0]
    assert "-50 % in north, east and yaw | north -60 %, east -60 %, yaw -60 % | met |" in text
    assert "| ours: 90 % regions have 85 to 95 % | 100 to 100 % | **missed** |" in text
    assert "distance 0, 3 worlds | distance 1, 3 worlds" in text and "No predictor" not in text


def test_measures_are_kept_and_not_redone(tmp_path, monkeypatch):
    monkeypatch.setattr(measuring, "sail", lambda world: straight())
    first = measuring.measured("kinetic", 300, 1.0, tmp_path)
    monkeypatch.setattr(measuring, "sail", None)
    again = measuring.measured("kinetic", 300, 1.0, tmp_path)
    assert all((first[key] == again[key]).all() for key in first)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "kinetic-300-1.npz",
        "record-300-1.npz",
    ]


def test_a_learned_force_is_what_its_coefficients_say(tmp_path):
    share = np.zeros(len(own_model.COEFFICIENTS))
    share[own_model.COEFFICIENTS.index("wind_Y")] = 0.4
    run = learned.sailed(
        learned.plan(301, {}), learned.force_of({"coefficients": share}, tmp_path), until=5.0
    )
    wind, force = run.table["vessel.tau_wind_Y"].values, run.table["learned.tau_Y"].values
    np.testing.assert_allclose(force[1:], 0.4 * wind[1:], rtol=0.05)
    assert np.abs(run.table["learned.tau_X"]).max() == 0.0
