"""What the model lacks on an axis, in words: its sense, its size, and whether it is steady."""

from dataclasses import replace

import pytest

from shipcosim.diagnose.comparison.missing_loads import MissingLoad

LACKS = MissingLoad("yaw", 10.0, 30.0, 28.0, 1.0, 0.6, 30.0, 0.1, 2.0, 1.2)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, "yaw moment: the model gives more than the motion needs (30 against 10 N.m rms)"),
        ({"correlation": -0.8}, "the model gives the opposite of what the motion needs"),
        ({"correlation": 0.1}, "does not go with what the motion needs"),
        ({"steady": -25.0}, "the model lacks a steady 25 N.m to port"),
        ({"steady": 25e3, "missing": 28e3}, "the model lacks a steady 25 kN.m to starboard"),
        ({"given": 5.0}, "the model gives less than the motion needs"),
        ({"given": 10.0}, "as much as the motion needs, but not when it does"),
    ],
)
def test_what_is_missing_is_said_with_its_sense(changed, said):
    assert said in replace(LACKS, **changed).discrepancy.what


def test_it_is_large_beside_what_is_needed_beside_the_models_loads_and_beside_noise():
    assert LACKS.is_large and LACKS.discrepancy.estimate == 28.0 and LACKS.discrepancy.axis == "yaw"
    for small in ({"needed": 50.0}, {"parts": 1000.0}, {"noise": 20.0}, {"predicted": 0.3}):
        assert not replace(LACKS, **small).is_large
