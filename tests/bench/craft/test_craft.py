"""Nothing is said of labels and ratios of drawn healthy craft; what is named on wrong ones is right or open."""

import numpy as np
import pytest

from craft import draw
from craft.scoring import answer, score


@pytest.mark.parametrize("seed", [103, 108])  # a spin and a zig-zag that looked like wrong labels
@pytest.mark.parametrize("fault", ["none", "exchanged"])
def test_no_wrong_name_of_sides_and_signs(seed, fault):
    drawn = draw(seed, fault=fault)
    row = score(drawn, answer(drawn))
    assert row["of labels"] != "wrong" and row["of ratio"] == "right"


def test_a_reversed_thruster_of_a_drawn_craft_is_named():
    drawn = draw(104, fault="one reversed")
    assert score(drawn, answer(drawn))["of labels"] == "right"


@pytest.mark.parametrize("seed", [209, 214])
def test_exchanged_thrusters_are_named_although_a_controller_made_the_foresight_lean_the_other_way(
    seed,
):
    drawn = draw(seed, fault="exchanged")
    assert score(drawn, answer(drawn))["of labels"] == "right"


def test_labels_that_a_steady_spin_cannot_tell_are_said_not_to_be_judged():
    drawn = draw(203, fault="exchanged")
    labels = answer(drawn).comparison.labels
    assert not labels.is_wrong and not labels.is_judged
    assert answer(draw(201)).comparison.labels.is_judged


def test_of_thrusters_told_nearly_alike_none_is_said_to_push_many_times_as_much():
    drawn = draw(205, change="one weak")
    said = answer(drawn).comparison.discrepancies
    assert not [one.what for one in said if one.component is not None and one.estimate > 2.0]


@pytest.mark.parametrize(
    "seed", [108, 115]
)  # thrust twice and damping thrice the model's; a half and a quarter
def test_thrust_and_damping_over_inertia_are_found_together_and_predict_better(seed):
    drawn = draw(seed, change="ratio and damping", rough=0.0)
    found = answer(drawn)
    crude = found.comparison.crude
    assert (
        found.comparison.is_started_with
        and crude.errors.is_better
        and crude.errors.after < 0.5 * crude.errors.before
    )
    size = {one.axis: one.estimate for one in crude.numbers}
    hidden = {axis: drawn.damping if axis else drawn.size for axis in size}
    assert {"", "yaw"} <= set(size)
    assert {a: size[a] for a in ("", "yaw")} == pytest.approx(
        {a: hidden[a] for a in ("", "yaw")}, rel=0.15
    )
    for one in crude.numbers:
        assert abs(np.log(one.estimate / hidden[one.axis])) < 2.0 * one.std / one.estimate
    damping = f"{drawn.model.vessel}.N_r"
    assert found.ship.get(damping) == pytest.approx(size["yaw"] * drawn.model.get(damping))
    assert found.comparison.given(found.ship).get(damping) == pytest.approx(
        drawn.model.get(damping)
    )


@pytest.mark.parametrize("seed", [108, 113, 115])
def test_of_a_healthy_craft_there_is_no_crude_model(seed):
    comparison = answer(draw(seed, rough=0.0)).comparison
    assert comparison.crude is None and comparison.findings == () == comparison.remarks
