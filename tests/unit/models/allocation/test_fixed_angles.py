"""Allocation to any layout: the load is met where it can be, limits and missing units are kept."""

from dataclasses import replace
from math import hypot

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.allocation import fixed_angles as general
from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.allocation.fixed_angles import FixedAngleParameters, at_rest, design, step
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters

TWIN = FixedAngleParameters(
    **{"x_1": -20.0, "y_1": -3.0, "thrust_min_1": -6e4, "thrust_max_1": 9e4, "thrust_rate_1": 1e9},
    **{"x_2": -20.0, "y_2": 3.0, "thrust_min_2": -6e4, "thrust_max_2": 9e4, "thrust_rate_2": 1e9},
    **{
        "x_3": 22.0,
        "azimuth_3": np.pi / 2,
        "thrust_min_3": -4e4,
        "thrust_max_3": 4e4,
        "thrust_rate_3": 1e9,
    },
    **{
        "x_4": -18.0,
        "azimuth_4": np.pi / 2,
        "thrust_min_4": -3e4,
        "thrust_max_4": 3e4,
        "thrust_rate_4": 1e9,
    },
    yaw_lever=22.0,
)
"""Two screws, a bow and a stern tunnel."""
ALL = (True,) * 6


def allocated(tau, parameters=TWIN, available=ALL, h=1.0):
    return step(
        at_rest(tau, parameters=parameters),
        tau,
        available,
        h,
        parameters=parameters,
        design=design(parameters),
    )


@pytest.mark.parametrize("tau", [(5e4, 3e4, 2e5), (-4e4, 0.0, -5e5), (0.0, -5e4, 0.0)])
def test_a_load_within_reach_is_met(tau):
    found = allocated(tau)
    assert (found.tau_X, found.tau_Y, found.tau_N) == pytest.approx(tau, abs=1e-3)
    assert not found.saturated and found.thrusts[4:] == (0.0, 0.0)


def test_limits_hold_and_are_said():
    found = allocated((0.0, 2e5, 0.0))
    assert found.saturated and found.thrusts[3] == pytest.approx(3e4)
    limits = zip(
        found.thrusts, TWIN.of_units("thrust_min"), TWIN.of_units("thrust_max"), strict=True
    )
    assert all(low <= thrust <= high for thrust, low, high in limits)


def test_a_missing_unit_gives_nothing_and_the_others_take_over():
    found = allocated((3e4, 1e4, 0.0), available=(False, True, True, True, True, True))
    assert found.thrusts[0] == 0.0 and found.tau_X == pytest.approx(3e4, abs=1e-3)
    assert found.tau_N == pytest.approx(0.0, abs=1e-3)


def test_commands_change_no_faster_than_the_rate():
    slow = replace(TWIN, thrust_rate_1=100.0, thrust_rate_2=100.0)
    assert allocated((5e4, 0.0, 0.0), slow, h=2.0).thrusts[:2] == pytest.approx((200.0, 200.0))


def test_for_two_azimuths_and_a_tunnel_it_gives_what_their_own_allocator_gives():
    """That of R/V Gunnerus, with the price of each unit's thrust by its limit."""
    own = parameters(AllocationParameters)
    tunnel = (60e3 / own.tunnel_thrust_max) ** 2
    own = replace(own, tunnel_weight=tunnel, thrust_rate_max=1e9)
    same = {"yaw_lever": own.yaw_lever, "x_3": own.tunnel_x, "azimuth_3": np.pi / 2}
    same |= {
        "thrust_min_3": -own.tunnel_thrust_max,
        "thrust_max_3": own.tunnel_thrust_max,
        "thrust_rate_3": 1e9,
    }
    for i, side in ((1, "port"), (2, "starboard")):
        same |= {f"{name}_{i}": getattr(own, f"{side}_{name}") for name in ("x", "y", "azimuth")}
        same |= {f"thrust_min_{i}": -30e3, f"thrust_max_{i}": 60e3, f"thrust_rate_{i}": 1e9}
    for tau in ((5e3, -4e3, 2e4), (2e4, 1e4, -1e5)):
        at = pseudo_inverse.at_rest(tau, parameters=own)
        theirs = pseudo_inverse.step(
            at, tau, (True,) * 3, 1.0, parameters=own, design=pseudo_inverse.design(own)
        )
        ours = allocated(tau, FixedAngleParameters(**same))
        assert ours.thrusts[:3] == pytest.approx(theirs.thrusts, abs=1e-6)
        assert hypot(*ours.thrusts[:2]) > 0.0 and general.UNITS == 6
