"""Nothing is said of labels and ratios of drawn healthy craft; what is named on wrong ones is right or open."""

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
def test_exchanged_thrusters_are_named_although_a_controller_made_the_foresight_lean_the_other_way(seed):
    drawn = draw(seed, fault="exchanged")
    assert score(drawn, answer(drawn))["of labels"] == "right"


def test_labels_that_a_steady_spin_cannot_tell_are_said_not_to_be_judged():
    drawn = draw(203, fault="exchanged")
    labels = answer(drawn).comparison.labels
    assert not labels.is_wrong and not labels.is_judged
    assert answer(draw(201)).comparison.labels.is_judged
