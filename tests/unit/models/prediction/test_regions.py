"""Regions widen by the predictor's own record, and there are none while thrusters act."""

from math import exp, pi

import pytest

from shipcosim.models.core.motion import Motion
from shipcosim.models.prediction.regions import RegionParameters, own_errors, widening

REGIONS = RegionParameters(
    first_position_share=1.2,
    first_heading_share=1.3,
    later_position_share=0.6,
    later_heading_share=0.5,
)


def test_own_errors_are_an_exponential_mean_of_the_distance_to_where_she_was_foreseen():
    errors, ship, foreseen = (
        (0.0, 0.0),
        Motion(3.0, 4.0, pi - 0.1, 0, 0, 0),
        Motion(0.0, 0.0, 0.1 - pi, 0, 0, 0),
    )
    for _ in range(20):
        errors = own_errors(errors, ship, foreseen, 1.0, regions=REGIONS)
    reached = 1.0 - exp(-1.0)
    assert errors == pytest.approx((5.0 * reached, 0.2 * reached))


def test_no_region_while_thrusters_act_and_others_just_after_the_loss_and_in_a_long_drift():
    assert widening((1.0, 0.1), -1.0, regions=REGIONS) == (0.0, 0.0)
    for first in (0.0, 1.0, 5.0):
        assert widening((0.0, 0.0), first, regions=REGIONS) == (1.2, 1.3)
    for drifting in (6.0, 60.0):
        assert widening((0.0, 0.0), drifting, regions=REGIONS) == (1.0, 1.0)
    assert widening((0.0, 0.0), 61.0, regions=REGIONS) == (0.6, 0.5)


def test_large_own_errors_widen_in_proportion():
    once, twice = (widening((size, 0.0), 5.0, regions=REGIONS)[0] for size in (30.0, 60.0))
    assert twice == pytest.approx(2.0 * once, rel=1e-3)
