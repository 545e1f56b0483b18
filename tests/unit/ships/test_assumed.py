"""A ship file from a length alone can be described, at any length, and her water takes energy out."""

from pathlib import Path

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ships import describe
from shipcosim.ships.assumed import LoggedThruster, assumed_ship_text
from shipcosim.ships.check import check_described
from shipcosim.ships.described import file_from

UNITS = {
    "port": {"rpm", "azimuth"},
    "starboard_pod": {"rpm", "azimuth"},
    "left": {"thrust"},
    "right_screw": {"rpm"},
    "bow_tunnel": {"rpm"},
    "aft": {"thrust"},
}


def described(length, units):
    thrusters = [LoggedThruster(name, frozenset(has), 300.0) for name, has in units.items()]
    path = Path("craft.toml")
    return describe(path, file_from(assumed_ship_text(length, thrusters), path))


@pytest.mark.parametrize("length", [1.2, 5.0, 34.0, 120.0, 400.0])
def test_any_length_gives_a_ship_that_her_water_brakes(length):
    ship = described(length, UNITS)
    assert [unit.name for unit in ship.units] == list(UNITS)
    found = [problem for problem in check_described(ship) if problem.severity != "remark"]
    assert not found and not any("energy" in one.found for one in check_described(ship))


def test_words_of_a_name_say_where_a_thruster_is():
    port, starboard, left, right, bow, aft = described(10.0, UNITS).units
    assert port.y == left.y < 0.0 < starboard.y == right.y and aft.y == 0.0
    assert bow.x > 0.0 > aft.x and bow.direction == pytest.approx(1.5708, abs=1e-4)


def test_channels_that_no_thruster_takes_are_refused():
    with pytest.raises(ShipcosimError, match="azimuth and thrust"):
        described(10.0, {"pod": {"thrust", "azimuth"}})
