"""Baseline and gain over several logs, by hand."""

import numpy as np
import pytest

from shipcosim.diagnose.reference.joint_gain import joint_baseline, joint_gain
from shipcosim.diagnose.reference.log_errors import LogErrors


def errors(before, after, floor, fitted_on=("other",)):
    """Errors of a log whose predictions all miss by the same, at 60 s."""
    position = {
        "before": (before / 6.0, before / 2.0, before),
        "after": (after / 6.0, after / 2.0, after),
    }
    misses = np.repeat([[before], [after], [floor]], 5, axis=1)
    return LogErrors((10.0, 30.0, 60.0), position, position, fitted_on, None, misses=misses)


def test_a_log_of_many_predictions_counts_as_much_as_another():
    long, short = errors(10.0, 6.0, 2.0), errors(2.0, 2.0, 2.0)
    object.__setattr__(long, "misses", np.repeat(long.misses, 9, axis=1))
    found = joint_gain({"long": long, "short": short})
    assert found["before_m"] == pytest.approx(np.sqrt((100 + 4) / 2)) and found["logs"] == [
        "long",
        "short",
    ]
    assert found["after_m"] == pytest.approx(np.sqrt((36 + 4) / 2)) and found[
        "noise_floor_m"
    ] == pytest.approx(2.0)
    assert joint_baseline({"long": long, "short": short})["position_error_m"][-1] == pytest.approx(
        found["before_m"]
    )


def test_the_share_is_that_of_what_is_above_the_noise_floor():
    found = joint_gain({"a": errors(10.0, 4.0, 2.0), "b": errors(10.0, 4.0, 2.0)})
    assert found["share_of_explainable"] == pytest.approx(0.75) and found["ci95"] == pytest.approx(
        [0.75, 0.75]
    )


def test_a_cause_that_makes_it_worse_has_a_share_below_none():
    assert joint_gain({"a": errors(5.0, 8.0, 1.0)})["share_of_explainable"] < 0.0


def test_predictions_at_whose_end_the_log_has_no_position_do_not_count():
    one = errors(10.0, 4.0, 2.0)
    one.misses[:, 2] = np.nan
    assert joint_gain({"a": one})["before_m"] == pytest.approx(10.0)


def test_a_log_that_sizes_its_own_causes_is_no_judge():
    assert joint_gain({"a": errors(10.0, 4.0, 2.0, fitted_on=())}) is None
    assert joint_baseline({}) is None and joint_gain({}) is None
