"""What logs have in common: faults, one ratio of thrust to inertia unless they contradict each other, discrepancies."""

from types import SimpleNamespace

import numpy as np
import pytest

from shipcosim.diagnose.comparison.gains import CommonRatio
from shipcosim.diagnose.comparison.label_hypotheses import LabelError
from shipcosim.diagnose.finding import Discrepancy, Finding, ParameterEstimate
from shipcosim.diagnose.log.mislabels import exchanged, finding_of
from shipcosim.diagnose.reference.common_findings import (
    common_discrepancies,
    common_faults,
    leans_to,
    ratio_of_logs,
    together,
    with_right_labels,
)
from shipcosim.series import make_table

SWAP = finding_of(exchanged([("left_thrust", "right_thrust")]), 1.0)


def ratios(*sizes, axes=("surge", "sway", "yaw")):
    """By name of the log: ratios with their standard deviations."""
    return {
        f"log-{k}": CommonRatio(ratio, std, axes) for k, (ratio, std) in enumerate(sizes, start=1)
    }


def test_estimates_of_logs_are_weighed_by_what_they_know():
    found = together(
        [{"lag": ParameterEstimate(0.4, 0.01, "s")}, {"lag": ParameterEstimate(0.5, 0.1, "s")}]
    )["lag"]
    assert found.estimate == pytest.approx(0.401, abs=0.001) and 0.0099 < found.std < 0.0101


def test_estimates_that_disagree_are_as_uncertain_as_they_differ():
    assert together(
        [{"x": ParameterEstimate(0.3, 0.01, "1")}, {"x": ParameterEstimate(0.5, 0.01, "1")}]
    )["x"].std == pytest.approx(0.1)


def test_one_ratio_is_common_to_logs_that_agree_and_better_known_than_by_one():
    found = ratio_of_logs(ratios((0.5, 0.06), (0.52, 0.06), (0.48, 0.06), (0.51, 0.06)))
    assert found.common.ratio == pytest.approx(0.502, abs=0.005) and 0.02 < found.common.std < 0.035
    assert found.contradiction == "" and found.apart == ()


def test_a_ratio_is_never_better_known_than_forms_of_a_hull_allow():
    many = ratio_of_logs(ratios(*[(0.5, 0.05)] * 100, axes=("surge",)))
    assert many.common.std == pytest.approx(0.5 * 0.08)


def test_logs_that_contradict_each_other_have_no_common_ratio_and_say_so():
    found = ratio_of_logs(ratios((0.45, 0.03), (0.9, 0.05)))
    assert found.common is None and "log-1 0.45 ± 0.03, log-2 0.90 ± 0.05" in found.contradiction


def test_a_log_away_from_all_others_is_told_and_makes_the_ratio_less_certain():
    alike = ratios((0.5, 0.05), (0.5, 0.05), (0.5, 0.05), (0.5, 0.05))
    found = ratio_of_logs(alike | {"odd": CommonRatio(0.7, 0.07, ("yaw",))})
    assert found.apart == ("odd",) and found.common.std > ratio_of_logs(alike).common.std
    assert found.without("odd").ratio == pytest.approx(0.5)


def test_no_log_no_ratio():
    assert ratio_of_logs({}).common is None and ratio_of_logs({}).contradiction == ""


def test_a_fault_of_half_of_the_logs_is_common_and_one_of_a_single_log_is_not():
    gap = Finding("gap", kind="data", segments=((3.0, 9.0),))
    found = common_faults({"a": [SWAP, gap], "b": [SWAP], "c": [], "d": [gap]})
    assert [(one.cause, one.logs) for one in found] == [("channel_swap", ("a", "b"))]
    assert common_faults({"a": [SWAP], "b": [], "c": []}) == []


def test_a_fault_is_the_same_whatever_its_size_in_each_log():
    clocks = [
        Finding(
            "clock",
            kind="data",
            note=f"the clock runs {text} too slow",
            parameters={"rate": ParameterEstimate(v, 0.01, "1")},
        )
        for text, v in (("4.1 %", 1.041), ("3.9 %", 1.039))
    ]
    (found,) = common_faults({"a": clocks[:1], "b": clocks[1:]})
    assert found.parameters["rate"].estimate == pytest.approx(1.04)


def test_what_a_log_leaves_open_is_no_common_fault():
    open_ = Finding("frame", kind="data", channels=("north",), note="one", alternatives=("two",))
    assert common_faults({"a": [open_], "b": [open_]}) == []


@pytest.mark.parametrize(
    ("best", "leans"),
    [([LabelError(("left", "right"))], True), ([], False), ([LabelError(("left",))], False)],
)
def test_a_log_that_cannot_tell_leans_to_a_fault_by_its_best_reading(best, leans):
    labels = SimpleNamespace(best=SimpleNamespace(changes=best), rivals=())
    assert leans_to(labels, SWAP) is leans
    assert leans_to(None, SWAP)


def test_labels_are_put_right_in_the_log_as_read():
    one, other = np.array([1.0, 2.0]), np.array([3.0, 4.0])
    log = make_table([0.0, 1.0], [("left_thrust", one, "N", ""), ("right_thrust", other, "N", "")])
    log.encoding["source"] = "x.csv"
    right = with_right_labels(log, [SWAP])
    np.testing.assert_array_equal(right["left_thrust"], other)
    np.testing.assert_array_equal(log["left_thrust"], one)
    assert right["left_thrust"].attrs["units"] == "N" and right.encoding["source"] == "x.csv"


def test_discrepancies_alike_are_one_with_the_range_of_their_sizes_signs_first():
    def weak(size, share=0.8):
        return Discrepancy(
            f"thrust over inertia {size:.2f} of the model's", None, None, size, 0.05, "1", share
        )

    wrong = Discrepancy("yaw moment: wrong sign", None, "yaw", -0.6, 0.05, "1", 0.4)
    alone = Discrepancy("thrust acts 2 s after its command", None, None, 2.0, 0.5, "s", 0.1)
    found = common_discrepancies({"a": [wrong, weak(0.47)], "b": [weak(0.53), alone], "c": [wrong]})
    assert [one.what for one in found] == [
        "yaw moment: wrong sign",
        "thrust over inertia 0.47 to 0.53 of the model's",
    ]
    assert found[1].logs == ("a", "b") and found[1].estimate == pytest.approx(0.5)
    assert found[1].share == pytest.approx(1.6 / 3.0)


def test_what_one_of_two_logs_shows_is_not_common():
    late = Discrepancy("thrust acts 2 s after its command", None, None, 2.0, 0.5, "s", 0.1)
    assert common_discrepancies({"a": [late], "b": []}) == []
