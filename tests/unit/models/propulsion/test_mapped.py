"""Thrusters by a measured map: the map is what comes out, the lag is one of first order."""

from dataclasses import replace
from math import exp

import pytest

from shipcosim.models.propulsion.mapped import (
    MapParameters,
    commanded,
    mapped_command,
    mapped_loads,
    mapped_step,
    mapped_thrust,
    within_map,
)

BOAT = MapParameters(
    x=-0.4, y=0.3, thrust_table="1100 -28; 1480 -1; 1520 1; 1900 55", speed_loss=0.1
)


@pytest.mark.parametrize(
    ("command", "thrust"), [(1100, -28), (900, -28), (1500, 0), (1710, 28), (2500, 55)]
)
def test_thrust_is_the_maps_and_constant_beyond_it(command, thrust):
    assert mapped_thrust(float(command), thruster=BOAT) == pytest.approx(thrust)


def test_wanted_thrust_is_kept_within_the_map():
    assert [within_map(T, thruster=BOAT) for T in (-99.0, 3.0, 99.0)] == [-28.0, 3.0, 55.0]


def test_lag_is_that_of_first_order_whatever_the_step():
    slow = replace(BOAT, time_constant=2.0)
    once, twice = mapped_step(0.0, 10.0, 1.0, thruster=slow), 0.0
    for _ in range(10):
        twice = mapped_step(twice, 10.0, 0.1, thruster=slow)
    assert once == pytest.approx(10.0 * (1.0 - exp(-0.5))) == pytest.approx(twice)
    assert mapped_step(0.0, 10.0, 0.1, thruster=BOAT) == 10.0


def test_speed_takes_thrust_in_its_own_direction_only():
    ahead, astern = (mapped_loads(T, 1.0, 0.0, 0.0, thruster=BOAT).thrust for T in (10.0, -10.0))
    assert (ahead, astern) == (pytest.approx(9.0), pytest.approx(-11.0))
    assert mapped_loads(10.0, 0.0, 0.0, 0.0, thruster=BOAT).tau_N == pytest.approx(-3.0)


def test_a_map_whose_thrust_falls_is_refused():
    with pytest.raises(ValueError, match="row 3: 1 N after 2 N"):
        mapped_thrust(0.0, thruster=replace(BOAT, thrust_table="0 0; 1 2; 2 1"))


def test_command_changes_no_quicker_than_its_rate():
    """From stop to full ahead at 1.44 deg/s: 28.7 deg take 19.93 s."""
    pitch = MapParameters(
        x=-38.0, y=-6.0, thrust_table="-21.5 -1e5; 0 0; 28.7 3e5", command_rate=1.44
    )
    command, steps = 0.0, 0
    while command < 28.7:
        command, steps = commanded(command, 28.7, 0.05, thruster=pitch), steps + 1
    assert steps == 399 and command == 28.7
    assert commanded(0.0, 28.7, 0.05, thruster=replace(pitch, command_rate=0.0)) == 28.7


@pytest.mark.parametrize("thrust", [-28.0, -20.0, 0.5, 41.0, 55.0])
def test_map_read_backwards_gives_the_command_of_a_thrust(thrust):
    assert mapped_thrust(mapped_command(thrust, thruster=BOAT), thruster=BOAT) == pytest.approx(
        thrust
    )
