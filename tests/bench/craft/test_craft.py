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
def test_a_craft_with_another_thrust_and_damping_is_learned_and_predicts_better(seed):
    drawn = draw(seed, change="ratio and damping", rough=0.0)
    found = answer(drawn)
    craft = found.comparison.craft
    assert found.comparison.is_started_with and craft.errors.is_better
    assert craft.errors.after < 0.5 * craft.errors.before
    (finding,) = found.comparison.findings(found.causes)
    assert finding.parameters["ratio"].estimate == pytest.approx(drawn.size, rel=0.2)
    assert found.comparison.given(found.ship).parts["hull"] == drawn.model.parts["hull"]


@pytest.mark.parametrize("seed", [108, 113, 115])
def test_of_a_healthy_craft_nothing_is_learned_before_causes_are_sought(seed):
    found = answer(draw(seed, rough=0.0))
    assert found.comparison.craft is None and found.comparison.findings(found.causes) == ()
