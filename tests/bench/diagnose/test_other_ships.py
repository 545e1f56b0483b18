"""At night: planted causes of a ferry with four azimuths and of a USV are named."""

import numpy as np
import pytest
from diagnose import ferry, usv
from diagnose.test_other_ships import along, short_ferry

from shipcosim.diagnose.explanation.null_distribution import healthy_records
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.noise import first_noise
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.series import write_table

HIDDEN = {
    "thrust_loss of fore_starboard": ({"fore_starboard.thrust_loss": 0.3}, {}, {"loss": 0.3}),
    "azimuth_offset of aft_port": ({"aft_port.azimuth_offset": np.radians(8.0)}, {}, {"offset": 8.0}),
    "current": (
        {"environment.current_speed": 0.25, "environment.current_to": -0.64},
        {},
        {"north": 0.2005, "east": -0.1493},
    ),
    "mass": ({"ship.mass_scale": 1.2}, {}, {"scale": 1.2}),
    "wind_scale": ({"ship.wind_load_scale": 1.35}, {}, {"scale": 1.35}),
    "lever_arm": ({}, {"errors": {"lever_x": 15.0, "lever_y": 3.0}}, {"x": 15.0, "y": 3.0}),
    "tow": ({}, {"push": (-12e3, 8e3, -48.0)}, {"north": -12e3, "east": 8e3}),
}


def found_in(log, ship, tmp_path):
    write_table(log, tmp_path / "log.csv")
    return find_causes(tmp_path / "log.csv", ship().checked())


@pytest.mark.parametrize("label", HIDDEN)
def test_what_is_wrong_with_the_ferry_is_named(label, tmp_path):
    wrong, around, truth = HIDDEN[label]
    diagnosis = found_in(ferry.log(ferry=ferry.structure(**wrong), seed=10, **around), ferry.structure, tmp_path)
    assert (diagnosis.verdict, [finding.label for finding in diagnosis.findings]) == ("named", [label])
    _holds(diagnosis.findings[0], truth)


def _holds(finding, truth):
    for name, value in truth.items():
        estimate = finding.parameters[name]
        assert abs(estimate.estimate - value) < 3.0 * estimate.std


@pytest.mark.parametrize("kind", ferry.LEGS)
def test_the_healthy_ferry_is_consistent(kind, tmp_path):
    assert found_in(ferry.log(kind, seed=21), ferry.structure, tmp_path).verdict == "consistent"


def test_swapped_channels_of_two_of_four_units_are_a_fault_of_the_log(tmp_path):
    log, swap = ferry.log(seed=10), {}
    for kind in ("rpm", "azimuth"):
        one, other = f"fore_port_{kind}", f"aft_starboard_{kind}"
        swap |= {one: log[other], other: log[one]}
    (finding,) = found_in(log.assign(swap), ferry.structure, tmp_path).findings
    assert finding.cause == "channel_swap" and set(finding.channels) == set(swap)


def test_the_wrong_lever_in_the_ferrys_model_is_a_connection_to_put_right(tmp_path):
    wrong = ferry.structure()
    wrong.disconnect("aft_port.tau_N", "ship.tau_N_3")
    wrong.connect("aft_port.tau_N", "ship.tau_N_3", factor=-1.0)
    diagnosis = found_in(ferry.log(seed=10), lambda: wrong, tmp_path)
    assert [finding.label for finding in diagnosis.findings] == ["connection of aft_port"]


ABOARD = {
    "thrust_loss of right": ({"right.thrust_loss": 0.4}, {}, {"loss": 0.4}),
    "thrust_loss of left": ({"left.thrust_loss": 0.25}, {}, {"loss": 0.25}),
    "reverse_loss": ({"left.reverse_loss": 0.35, "right.reverse_loss": 0.35}, {}, {"loss": 0.35}),
    "drag": ({"hull.drag_scale": 2.0}, {}, {"scale": 2.0}),
    "current": ({}, {"current": (0.25, -0.2)}, {"north": 0.25, "east": -0.2}),
    "heading_bias": ({}, {"errors": {"heading_bias": np.radians(4.0)}}, {"offset": 4.0}),
}


def open_fault(why):
    """Marks what the diagnosis does not get right yet."""
    return pytest.mark.xfail(reason=why, strict=True)


@pytest.mark.parametrize("label", ABOARD)
def test_what_is_wrong_with_the_usv_is_named(label, tmp_path):
    wrong, around, truth = ABOARD[label]
    diagnosis = found_in(usv.log(usv=usv.structure(**wrong), seed=30, **around), usv.structure, tmp_path)
    assert (diagnosis.verdict, [finding.label for finding in diagnosis.findings]) == ("named", [label])
    _holds(diagnosis.findings[0], truth)


@pytest.mark.parametrize(
    "rate", [1.0, pytest.param(0.2, marks=open_fault("yaw inertia and lags lie beyond their tolerances: unknown"))]
)
def test_the_healthy_usv_is_consistent(rate, tmp_path):
    assert found_in(usv.log(seed=30, rate=rate), usv.structure, tmp_path).verdict == "consistent"


def test_healthy_ferries_drawn_with_places_of_their_thrusters_keep_to_the_track():
    model, record, motion = along(ferry.structure, short_ferry)
    problem = IdentificationProblem(record, model, (), first_noise(record, 96.0), motion)
    healthy = healthy_records(problem, motion, 4, np.random.default_rng(0))
    off = np.hypot(healthy.measured[..., 0] - motion.x, healthy.measured[..., 1] - motion.y)
    assert off.shape == (4, record.time.size) and off.max() < 10.0
