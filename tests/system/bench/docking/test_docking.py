"""The comparison of docking predictors: its measures against cases that can be told by hand."""

import numpy as np
import pytest

pytest.importorskip("torch")

from docking import measuring, pages
from docking.rivals import PREDICTORS

from shipcosim.learn.docking.records import KNOWN, Record
from shipcosim.models.core.kinematics import to_ned


@pytest.fixture(scope="module")
def model():
    return measuring.ship()


def straight(speed=(0.4, -0.3), psi=0.5, seconds=80, seed=1):
    """A ship that moves straight on, with nothing commanded and no wind."""
    time = np.arange(float(seconds))
    north, east = to_ned(psi, *speed)
    truth = dict(
        zip("x y psi u v r".split(), (north * time, east * time, psi + 0.0 * time), strict=False)
    )
    truth |= {"u": speed[0] + 0.0 * time, "v": speed[1] + 0.0 * time, "r": 0.0 * time}
    known = {name: 0.0 * time for name in KNOWN} | {
        f"{name}_meas": values.copy() for name, values in truth.items()
    }
    wind = np.hypot(*speed), np.arctan2(speed[1], speed[0])  # of her own way through still air
    known |= {"wind_speed_meas": wind[0] + 0.0 * time, "wind_from_meas": wind[1] + 0.0 * time}
    return Record(seed, 1, time, known, truth)


def test_constant_velocity_is_right_where_velocity_is_constant(model):
    found = measuring.measure([straight()], model, ["constant velocity"])["constant velocity"]
    assert found["error"].shape == (1, 30) and found["heading"].shape == (1, 3)
    assert found["error"].max() < 1e-9 and found["heading"].max() < 1e-9


def test_errors_are_of_the_second_foreseen(model):
    record = straight()
    record.truth["x"][60:] += 5.0
    error = measuring.measure([record], model, ["constant velocity"])["constant velocity"]["error"][
        0
    ]
    for seconds in (1, 10, 30):  # starts from 60 - h to the end of what is known are off by 5 m
        assert error[seconds - 1] == pytest.approx(5.0 * 20.0 / (80.0 - seconds))


@pytest.mark.parametrize("name", PREDICTORS)
def test_no_predictor_has_a_ship_stop_at_once_or_go_three_times_as_far(name, model):
    """She goes 15 m in 30 s."""
    found = measuring.measure([straight(seed=seed) for seed in (1, 2)], model, [name])[name]
    assert np.isfinite(found["error"]).all()
    assert found["error"][:, -1].max() < 30.0


def measured(error, inside=0.9):
    return {
        "error": np.full((4, 30), error),
        "heading": np.full((4, 3), 0.1),
        "learned": np.ones(4),
        "inside": np.full((4, 3), inside),
        "inside_heading": np.full((4, 3), inside),
        "radius": np.full((4, 3), 2.0),
    }


def test_the_page_says_what_is_met_and_what_is_missed():
    found = {"familiar": {"kinetic": measured(4.0), "ours": measured(1.0, 0.8)}}
    text = pages.page(
        found, {"familiar": range(4)}, {"familiar": [0, 1, 3]}, {"ours": 6e-3}, "command"
    )
    assert "| ours, familiar harbours, 30 s: -50 % | -75 % (-75 to -75) | met |" in text
    assert (
        "| ours, familiar harbours: 90 % regions have 85 to 95 % | 80, 80, 80 % | **missed** |"
        in text
    )
    assert "| ours: a prediction below 5 ms | 6.0 ms | **missed** |" in text
    assert "3 dockings, seeds 0 to 3 without 2, which do not end in time." in text


def test_a_predictor_that_is_worse_at_one_horizon_is_said_to_be():
    worse = measured(1.0)
    worse["error"][:, 3] = 5.0
    text = pages.reached({"unseen": {"kinetic": measured(4.0), "ours": worse}}, {})
    assert "| ours, unseen harbours: at no horizon worse | +25 % | **missed** |" in text
