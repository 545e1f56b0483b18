"""What commanded against measured force says of small craft with gross faults, and that it says nothing of healthy ones."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from diagnose import twin, usv

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.compared_log import compared
from shipcosim.diagnose.comparison.errors import horizons_of
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.models.core.motion import Motion
from truth import draw

EXCHANGED = {"left_rpm": ("right_rpm", 1.0), "right_rpm": ("left_rpm", 1.0)}
LEFT_REVERSED = {"left_rpm": ("left_rpm", -1.0)}
WEAK = {"left.thrust_loss": 0.6, "right.thrust_loss": 0.6}


@cache
def ship():
    return ship_model_of(usv.structure().checked())


@cache
def sailed(seed, left=0.0, right=0.0):
    return usv.log(
        8.0, seed, usv.structure("weak", **{"left.thrust_loss": left, "right.thrust_loss": right})
    )


def held(log, labels=None):
    """A log, with other labels, after the comparison."""
    log = log.assign({role: sign * log[of].copy() for role, (of, sign) in (labels or {}).items()})
    return compared(checked(ReadLog(read_log(log), ship(), read_catalogue())))


@cache
def healthy(seed):
    """A log of the craft as she is, after the comparison."""
    return held(sailed(seed))


def test_nothing_is_said_of_a_healthy_craft():
    check_healthy(11)


def check_healthy(seed):
    found = healthy(seed)
    assert (
        found.comparison.discrepancies
        == ()
        == found.comparison.findings(found.causes)
        == found.faults
    )
    assert found.ship is not None and found.ship.parts == ship().parts


def test_exchanged_thrusters_are_a_fault_of_the_log_and_exchanged_back():
    found, right = held(sailed(11), EXCHANGED), healthy(11)
    (fault,) = found.faults
    assert (fault.cause, fault.channels) == ("channel_swap", ("left_rpm", "right_rpm"))
    np.testing.assert_allclose(found.repaired["left_rpm"], right.repaired["left_rpm"])
    assert "left and right exchanged" in found.comparison.discrepancies[0].what


def test_one_reversed_thruster_is_told_from_exchanged_ones():
    found = held(sailed(12), LEFT_REVERSED)
    (fault,) = found.faults
    assert (fault.cause, fault.channels) == ("sign", ("left_rpm",))
    assert "left running the other way" in found.comparison.discrepancies[0].what


def test_a_common_ratio_of_thrust_to_inertia_is_found_with_its_size():
    found = held(sailed(13, 0.6, 0.6))
    (finding,) = found.comparison.findings(found.causes)
    ratio = finding.parameters["ratio"]
    assert abs(ratio.estimate - 0.4) < 0.04 and "only their ratio" in finding.note
    assert found.comparison.discrepancies[0].what.startswith("thrust over inertia 0.")
    assert found.ship.get("left.thrust_loss") == pytest.approx(1.0 - ratio.estimate)


def test_one_weak_thruster_is_no_common_ratio_but_named_by_itself():
    found = held(sailed(14, 0.6, 0.0))
    assert found.comparison.findings(found.causes) == () == found.faults
    first = found.comparison.discrepancies[0]
    assert first.component == "left" and abs(first.estimate - 0.4) < 0.05


def test_thrust_astern_that_is_weaker_than_ahead_is_said_and_no_common_ratio():
    weak = usv.structure("weak", **{"left.reverse_loss": 0.6, "right.reverse_loss": 0.6})
    comparison = held(usv.log(8.0, 13, weak)).comparison
    (said,) = [
        one for one in comparison.discrepancies if "astern" in one.what and one.axis == "surge"
    ]
    assert (
        abs(said.estimate - 0.4) < 0.05
        and said.what.endswith("ahead 0.98")
        and comparison.ratio is None
    )
    right = healthy(13).comparison
    assert not any(gain.differs_by_way for gain in right.gains) and not right.discrepancies


def test_unequal_thrust_ahead_and_astern_is_no_wrong_sign_of_their_sum():
    """In a spin one thruster runs ahead and one astern: if that is the weaker, their sum as modelled looks reversed."""
    comparison = healthy(13).comparison
    (surge,) = [one for one in comparison.gains if one.axis.name == "surge"]
    reversed_sum = replace(surge.fit, gains=-surge.fit.gains)
    assert replace(surge, fit=reversed_sum).is_balanced
    assert not replace(
        surge, fit=reversed_sum, support_of_ways=surge.fit.support - 10.0
    ).is_balanced


@pytest.mark.parametrize("seed", [11, 13])
def test_there_are_always_figures_of_the_error(seed):
    errors = healthy(seed).comparison.errors
    assert (
        sorted(errors["horizon_s"]) == errors["horizon_s"] and len(errors["position_error_m"]) == 3
    )
    assert all(np.isfinite(value) and value > 0.0 for values in errors.values() for value in values)


def test_horizons_follow_the_size_of_the_craft():
    still = Motion(*np.zeros((6, 3)))
    small = replace(ship().parts["hull"], length=1.25)
    ours = horizons_of(ship(), still._replace(u=np.full(3, 1.0)), 1e4, 0.01)
    less = horizons_of(replace(ship(), parts=ship().parts | {"hull": small}), still, 10.0, 0.01)
    assert ours[-1] > less[-1] and less[-1] <= 3.0


def test_rows_too_far_apart_for_the_craft_are_said_to_be():
    log = sailed(11).isel(time=slice(None, None, 4))
    (obstacle,) = held(log).comparison.obstacles
    assert "no cause is named" in obstacle


def test_without_what_drives_a_thruster_nothing_is_said_of_sides_signs_and_sizes():
    """A thruster that the log lacks was taken to stand still: the other one then seemed to push twice as much."""
    found = held(sailed(13, 0.6, 0.6).drop_vars("left_rpm"))
    (obstacle,) = found.comparison.obstacles
    assert "left_rpm" in obstacle and "zeros" in obstacle
    assert (
        not found.comparison.findings(found.causes)
        and not found.faults
        and found.comparison.ratio is None
    )
    assert found.comparison.errors["position_error_m"][-1] > 0.0
    assert (
        held(sailed(13).assign(left_rpm=lambda log: 0.0 * log["right_rpm"])).comparison.obstacles
        == ()
    )


def test_a_load_is_missing_only_where_no_thruster_that_the_log_lacks_can_give_it():
    """Of a healthy log the whole moment of the other thruster was said to be an error of the model."""
    log = sailed(13).drop_vars("left_rpm")
    assert held(log).comparison.missing == ()
    weak = replace(ship().parts["left"], rpm_max=0.1 * ship().parts["left"].rpm_max)
    weaker = replace(ship(), parts=ship().parts | {"left": weak})
    missing = compared(checked(ReadLog(read_log(log), weaker, read_catalogue()))).comparison.missing
    assert "yaw" in {load.axis for load in missing}


def test_thrusters_that_answer_weather_which_nobody_knows_are_not_said_to_run_the_wrong_way(
    tmp_path,
):
    check_unknown_weather(705, tmp_path, minutes=20)


def check_unknown_weather(seed, tmp_path, minutes=40):
    """In stationkeeping commands oppose the measured force, most of which is not the thrusters'."""
    draw("hold", seed, causes="unknown", minutes=minutes).save(tmp_path / "log.csv")
    ship = ship_model_of(twin.system())
    found = compared(checked(ReadLog(read_log(tmp_path / "log.csv"), ship, read_catalogue())))
    assert found.comparison.labels.best.changes and not found.comparison.labels.is_wrong
    assert not found.faults
    assert not [one for one in found.comparison.discrepancies if "its command" in one.what]


def test_a_large_error_is_said_with_axis_size_and_sense_whatever_its_cause():
    """A steady moment that nobody logged: no thruster, no damping and no label explains it."""
    log = sailed(11)
    time = log["time"].values
    drawn = (
        np.asarray(log["yaw_rate"]) + 0.4 * time % 20.0
    )  # deg/s: she is driven round, step by step
    found = held(log.assign(yaw_rate=("time", drawn, log["yaw_rate"].attrs)))
    assert any(one.axis == "yaw" for one in found.comparison.discrepancies)


def test_where_nobody_knows_what_is_wrong_the_largest_error_is_said_in_any_case():
    comparison = healthy(11).comparison
    (largest,) = comparison.for_verdict("unknown")
    assert comparison.for_verdict("consistent") == () and largest.axis == comparison.missing[0].axis
    assert largest.unit in ("N", "N.m") and largest.estimate > largest.std > 0.0
    large = replace(comparison, discrepancies=(largest,))
    assert large.for_verdict("consistent") == () and large.for_verdict("named") == (largest,)
