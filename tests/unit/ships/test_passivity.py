"""Still water takes energy out of a hull at speeds of DP, or the check says where it does not."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from ships import FOLDER, SHIPS, parameters

from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.ships import describe
from shipcosim.ships.check import check_ship
from shipcosim.ships.file import ShipFile
from shipcosim.ships.passivity import (
    DP_SPEED,
    driven_by_water,
    energy_gain,
    turning_rate_of_dp,
)

RANDOM = np.random.default_rng(28)
GAINING = ("gunnerus-28m9", "thesis-28m9")
"""Their source's polynomial gains energy where she hardly makes way and turns."""
SCREW = {"name": "screw", "kind": "fixed", "command": "thrust", "x": 0.0, "y": 0.0}


def power(hull, count=4000):
    """Power of the hull load in random states of DP. [W]"""
    reach = np.array([DP_SPEED, DP_SPEED, turning_rate_of_dp(hull)])
    motion = RANDOM.uniform(-1.0, 1.0, (3, count)) * reach[:, None]
    return (motion * np.stack(hull_loads(*motion, hull=hull))).sum(axis=0)


def hull_of(**particulars):
    """Hull of a new ship of which only main particulars are known."""
    said = {"particulars": particulars, "thrusters": [SCREW]}
    entries = describe("new.toml", ShipFile.model_validate(said)).vessel
    names = HullParameters.__dataclass_fields__.keys() & entries.keys()
    return HullParameters(**{name: entries[name].value for name in names})


@pytest.mark.parametrize("name", SHIPS)
def test_a_shipped_hull_gains_no_energy_or_the_check_says_where(name):
    hull = parameters(HullParameters, name, "vessel")
    remarks = [one for one in check_ship(str(FOLDER / name)) if "still water" in one.found]
    assert bool(remarks) == (name in GAINING)
    # What the grid says holds between its states too.
    gain = energy_gain(hull)
    share, most = (0.0, 0.0) if gain is None else (gain.share, gain.power)
    assert np.mean(power(hull) > 0.0) <= 1.5 * share
    assert power(hull).max() <= 1.1 * most


def test_new_ships_of_any_form_gain_no_energy():
    """2 to 330 m, length over breadth 2 to 9, breadth over draught 1.5 to 6, block coefficient 0.35 to 0.9."""
    for _ in range(40):
        length = float(np.exp(RANDOM.uniform(np.log(2.0), np.log(330.0))))
        breadth = length / RANDOM.uniform(2.0, 9.0)
        form = {"draught": breadth / RANDOM.uniform(1.5, 6.0)}
        form["block_coefficient"] = RANDOM.uniform(0.35, 0.9)
        hull = hull_of(length=length, breadth=breadth, **form)
        assert energy_gain(hull) is None, form
        assert power(hull, 500).max() <= 0.0


def test_a_new_ship_near_rest_slows_down_in_seconds_and_keeps_her_resistance_under_way():
    """Time constants of linear damping, and no more than a thousandth of it at Froude number 0.2."""
    hull = hull_of(length=60.0, breadth=14.0, draught=4.5, block_coefficient=0.68)
    without = replace(hull, X_u=0.0, Y_v=0.0, N_r=0.0)
    mass, inertia = hull.rigid_body
    root = np.sqrt(60.0 / 9.81)
    slow = np.array([1e-3, 1e-3, 1e-5])
    for axis, (own, constant) in enumerate(
        [(mass + hull.A11, 30.0), (mass + hull.A22, 18.0), (inertia + hull.A66, 9.4)]
    ):
        motion = np.where(np.arange(3) == axis, slow, 0.0)
        load = hull_loads(*motion, hull=hull)[axis]
        assert -own * motion[axis] / load == pytest.approx(constant * root, rel=0.05)
    fast = 0.2 * np.sqrt(9.81 * 60.0), 0.05, 0.01
    assert hull_loads(*fast, hull=hull) == pytest.approx(hull_loads(*fast, hull=without), rel=1e-3)


def test_linear_damping_that_the_file_gives_is_never_mixed_with_the_estimated_one():
    """It holds at all speeds, where the estimated one fades."""
    form = {"length": 60.0, "breadth": 14.0, "draught": 4.5, "block_coefficient": 0.68}
    for given, kept in (
        ({}, {"X_u", "Y_v", "Y_r", "N_v", "N_r", "linear_damping_speed"}),
        ({"X_u": -5e3}, {"X_u"}),
        ({"N_r": -5e6}, {"N_r"}),
        ({"X_uu": -5e3}, {"Y_v", "Y_r", "N_v", "N_r", "linear_damping_speed"}),
        ({"Y_modvv": -1e5}, {"X_u", "linear_damping_speed"}),
    ):
        said = {"particulars": form, "thrusters": [SCREW], "hull": given}
        entries = describe("new.toml", ShipFile.model_validate(said)).vessel
        linear = {"X_u", "Y_v", "Y_r", "N_v", "N_r", "linear_damping_speed"}
        assert entries.keys() & linear == kept, given


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_load_that_drives_her_is_found_with_its_power(sign):
    hull = replace(parameters(HullParameters), X_rvu=sign * 1e7)
    gain = energy_gain(hull)
    assert gain is not None
    load = hull_loads(gain.u, gain.v, gain.r, hull=hull)
    assert np.dot(load, (gain.u, gain.v, gain.r)) == pytest.approx(gain.power)
    (remark,) = driven_by_water("a.toml", asdict(hull))
    assert remark.severity == "remark" and f"{gain.power:.3g} W" in remark.found


def test_coriolis_loads_of_any_coefficients_do_no_work():
    """Terms of a polynomial that holds C_A(nu) nu: their sum is workless, so it makes no remark."""
    hull = replace(parameters(HullParameters), added_mass_coriolis=0.0)
    held = replace(hull, X_rv=5e5, Y_ur=-2e5, N_uv=-3e5)
    motion = RANDOM.uniform(-1.0, 1.0, (3, 100)) * [[0.5], [0.5], [0.03]]
    work = [(motion * np.stack(hull_loads(*motion, hull=one))).sum(axis=0) for one in (hull, held)]
    np.testing.assert_allclose(*work, atol=1e-9 * np.abs(work[0]).max())
    assert energy_gain(held) is None


def test_of_a_hull_that_is_not_complete_nothing_is_said():
    whole = asdict(parameters(HullParameters, "gunnerus-28m9", "vessel"))
    assert list(driven_by_water("a.toml", whole))
    for name, value in (("mass", 1e30), ("A11", None), ("length", ""), ("length", 0.0)):
        assert not list(driven_by_water("a.toml", whole | {name: value}))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 0.0, -1.0, 1e200, -1e200])
def test_impossible_numbers_are_no_crash(value):
    """Other checks say what is wrong with them."""
    whole = asdict(parameters(HullParameters, "gunnerus-28m9", "vessel"))
    for name in whole:
        list(driven_by_water("a.toml", whole | {name: float(value)}))
