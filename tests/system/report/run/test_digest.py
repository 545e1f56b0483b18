"""What a run comes to."""

import json

import numpy as np
import pytest

from shipcosim.report import digest


@pytest.fixture
def calm(four_corner):
    """The made-up run with nothing at its limit."""
    table = four_corner(1.0)
    for unit in ("port", "starboard", "tunnel"):
        table[f"{unit}.saturated"][:] = False
    return table


def test_run_that_holds_has_nothing_to_remark(calm):
    assert digest(calm)[1] == []


def test_ship_that_is_driven_off_at_full_thrust_is_said_to_lose_her_place(calm):
    time = calm["time"].values
    calm["vessel.x"][:] = calm["vessel.x"].values - 0.1 * np.maximum(time - 700.0, 0.0)
    calm["tunnel.saturated"][:] = time >= 690.0
    (remark,) = digest(calm)[1]
    assert "cannot hold: from 690 s on" in remark and "(tunnel)" in remark
    assert "40." in remark or "39." in remark  # 0.1 m/s for 400 s


def test_ship_that_comes_back_is_said_to_have_been_driven_off(calm):
    time = calm["time"].values
    calm["vessel.y"][:] = calm["vessel.y"].values + 5.0 * np.exp(-(((time - 600.0) / 60.0) ** 2))
    calm["tunnel.saturated"][:] = (time >= 500.0) & (time < 600.0)
    (remark,) = digest(calm)[1]
    assert "driven off for a while" in remark and "cannot hold" not in remark


def test_thrust_at_its_limit_alone_is_no_loss_of_position(calm):
    calm["tunnel.saturated"][:] = True
    calm["vessel.x"][:] = calm["reference.x_d"].values
    calm["vessel.y"][:] = calm["reference.y_d"].values
    assert digest(calm)[1] == []


def test_failure_is_said_with_its_time(calm):
    calm["tunnel.failed"] = ("time", calm["time"].values >= 300.0)
    assert digest(calm)[1] == ["Failed from 300 s on: tunnel."]


def test_rejected_sensors_and_dead_reckoning_are_said_with_their_times(calm):
    time = calm["time"].values
    calm["controller.position_2_rejected"] = ("time", (time >= 200.0) & (time < 310.0))
    calm["controller.dead_reckoning_time"] = (
        "time",
        np.where((time > 400.0) & (time <= 460.0), time - 400.0, 0.0),
    )
    rejected, reckoned = digest(calm)[1]
    assert rejected == "controller rejects position 2 from 200 s on, in 10 % of the run."
    assert reckoned == "controller has no trusted position for up to 60 s, until 460 s."


def test_signals_that_are_not_finite_are_named(calm):
    calm["port.power"][500:] = np.nan
    assert digest(calm)[1] == ["Not finite from 500 s on: port.power."]


def test_warnings_of_fmus_are_passed_on(calm):
    calm.attrs["remarks"] = json.dumps(["tunnel: runs hot"])
    assert digest(calm)[1] == ["tunnel: runs hot"]


@pytest.mark.parametrize("complete", [0, "False", False])
def test_run_that_ended_early_is_partial_whatever_else_holds(calm, complete):
    calm.attrs["complete"] = complete
    assert digest(calm)[0].kind == "partial"
