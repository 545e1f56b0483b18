"""From a system and a ship's files to her numbers."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
from capability.psv import HULL, NUMBERS, THRUSTERS, thruster

from shipcosim.capability import (
    as_json,
    capability_of,
    dataset,
    notation,
    numbers_table,
    read_vessel,
)
from shipcosim.capability.compute import level_1_share
from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS, Condition
from shipcosim.capability.loads import level_1_parts
from shipcosim.capability.result import BALANCED, LEVEL_1, SIMULATOR, Capability, Case
from shipcosim.capability.simulator import simulated_parts
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.ships import read_ship
from shipcosim.ssp import read_system, with_values

MIRROR = -np.arange(len(DIRECTIONS)) % len(DIRECTIONS)


def numbers_of(hull, working, failed=()):
    shares = [level_1_share(hull, working, failed, condition) for condition in CONDITIONS]
    return np.cumprod(np.array(shares) >= 1.0 / BALANCED, axis=0).sum(axis=0)


def test_numbers_of_a_supply_vessel_are_those_of_another_implementation():
    found = numbers_of(HULL, THRUSTERS)
    assert tuple(found[:19]) == NUMBERS
    assert (found == found[MIRROR]).all()


def test_two_azimuths_in_line_hold_twice_what_one_holds_and_the_race_on_a_dead_one_costs():
    """Head seas: 1 - 1/(0.02 9 + 0.25 3 + 1.2) = 0.531 three diameters ahead of the dead one, nothing behind it."""
    unit = {
        "diameter": 2.0,
        "power": 1e6,
        "height": -90.0,
        "eta_1": 800.0,
    }  # so deep that it does not ventilate
    fore, aft, near = (thruster(f"at {x}", "azimuth", x, 0.0, **unit) for x in (20.0, -20.0, 14.0))

    def from_ahead(working, failed):
        return level_1_share(HULL, working, failed, CONDITIONS[6])[0]

    alone = from_ahead([fore], [aft])
    assert alone == pytest.approx(
        0.9
        * fore.ahead
        / -(1.25 * sum(level_1_parts(HULL, CONDITIONS[6], DIRECTIONS).values())[0, 0])
    )
    assert from_ahead([fore, aft], []) == pytest.approx(2.0 * alone)
    assert from_ahead([fore], [near]) == pytest.approx(0.531 * alone, rel=1e-3)
    assert from_ahead([near], [fore]) == pytest.approx(alone)


def test_a_ship_with_one_fixed_propeller_holds_weather_from_ahead_and_astern_only():
    propeller = thruster(
        "screw", "fixed", -40.0, 0.0, diameter=3.0, power=2e6, height=1.8, eta_1=800.0
    )
    found = numbers_of(HULL, [propeller])
    assert found[0] > 5 and found[18] > 5
    assert not np.delete(found, [0, 18]).any()


@pytest.fixture(scope="module")
def system(root):
    return read_system(root / "ssp" / "gunnerus_dp", fmus=[build_stale(root)])


@pytest.fixture(scope="module")
def vessel(root, system):
    return read_vessel(system, read_ship(root / "ssp" / "ships" / "gunnerus-33m9"))


@pytest.fixture(scope="module")
def found(vessel):
    return capability_of(vessel, [("port", "starboard")])


def test_thrusters_are_those_of_the_system_with_the_thrust_of_the_parameter_sheet(vessel):
    port, starboard, tunnel = vessel.thrusters
    assert [t.kind for t in vessel.thrusters] == ["azimuth", "azimuth", "tunnel"]
    assert (port.x, port.y, starboard.y, tunnel.x) == (-14.02, -2.0, 2.0, 14.48)
    thrusts = [thrust / 1e3 for thrust in (port.ahead, port.astern, tunnel.ahead, tunnel.astern)]
    assert thrusts == pytest.approx((115.6, 80.9, 29.3, 29.3), abs=0.05)


def test_cases_are_the_intact_ship_each_thruster_each_group_and_each_bus_of_several(found):
    names = [
        "intact",
        "without port",
        "without starboard",
        "without tunnel",
        "without port and starboard",
    ]
    assert [case.name for case in found.cases] == [*names, "without bus A (port and tunnel)"]
    assert found.cases[-1].failed == ("port", "tunnel")


def test_a_system_without_a_switchboard_has_no_buses(system, root):
    components = {name: part for name, part in system.components.items() if name != "allocator"}
    ship = read_ship(root / "ssp" / "ships" / "gunnerus-33m9")
    assert read_vessel(replace(system, components=components), ship).buses == {}


def test_numbers_of_a_symmetric_ship_mirror_and_so_do_her_failures(found):
    for method in (LEVEL_1, SIMULATOR):
        intact, port, starboard, tunnel, *_ = found.numbers(method)
        assert (intact == intact[MIRROR]).all() and (tunnel == tunnel[MIRROR]).all()
        assert (port == starboard[MIRROR]).all()


def test_a_harder_condition_uses_more_thrust_and_a_failure_never_helps_but_by_its_race(found):
    """A unit that stands still may be blown at, with a loss: only there can a failure widen what the other may do."""
    for method in (LEVEL_1, SIMULATOR):
        used = found.used[method]
        assert (used > 0.0).all() and (used[:, 1:] >= used[:, :-1]).all()
        assert (used[3] >= used[0] * (1.0 - 1e-6)).all()
    simulator = found.used[SIMULATOR]
    assert (simulator[1:] >= simulator[0] * (1.0 - 1e-6)).all()


def test_neither_an_azimuth_nor_a_tunnel_alone_can_hold_a_ship(found):
    """It would have to push through the point where the load attacks."""
    for method in (LEVEL_1, SIMULATOR):
        assert not found.numbers(method)[4:].any() and not found.worst(method).any()


def test_elements_are_the_lowest_numbers_near_the_bow_and_all_around(vessel):
    """The standard's own example, as published: the values at 30 deg decide A and C."""
    used = np.full((2, len(CONDITIONS), len(DIRECTIONS)), 0.5)

    def fails_from(case, k, number):
        used[case, number:, k] = 2.0

    fails_from(0, 3, 9)
    fails_from(0, 9, 7)
    fails_from(1, 33, 5)
    fails_from(1, 10, 2)
    made = Capability(
        vessel, (Case("intact", ()), Case("without port", ("port",))), {LEVEL_1: used}
    )
    assert notation(made) == "DP capability-L1(9, 7, 5, 2)"


def test_a_number_counts_only_with_all_easier_conditions(vessel):
    used = np.full((2, len(CONDITIONS), len(DIRECTIONS)), 0.5)
    used[0, 3] = 1.5  # condition 4 fails, 5 to 11 would hold
    assert (Capability(vessel, (Case("intact", ()),) * 2, {LEVEL_1: used}).numbers()[0] == 3).all()


def test_loads_of_the_simulator_are_those_of_its_tables(vessel):
    """Head wind: the first row of the ship's wind table; a current on the beam: rho Cd L T V2 / 2 of the cross flow."""
    ship, weather = vessel.simulated, Condition(0, 10.0, 0.4, 6.0, 0.5)
    parts = simulated_parts(ship, weather, np.radians([0.0, 90.0]))
    X = float(ship.wind.wind_table.split(";")[0].split()[1])
    assert parts["wind"][0] == pytest.approx((100.0 * X, 0.0, 0.0))
    hull = ship.hull
    drag = 0.5 * hull.water_density * hull.cross_flow_drag * hull.length * hull.draught * 0.5**2
    assert parts["current"][1, 1] == pytest.approx(-drag)
    assert parts["waves"][0, 0] < 0.0 and parts["waves"][1, 1] < 0.0


def test_tables_and_json_hold_the_same_numbers(found):
    rows = list(csv.DictReader(io.StringIO(numbers_table(found))))
    table, said = dataset(found), as_json(found)
    assert [float(row["weather_from [deg]"]) for row in rows] == table[
        "weather_from"
    ].values.tolist()
    intact = [int(row["level 1, intact [1]"]) for row in rows]
    assert intact == found.numbers()[0].tolist() == said["numbers"][LEVEL_1]["intact"]
    assert intact == table["number"].sel(basis=LEVEL_1, case="intact").values.tolist()
    worst = [int(row["simulator, worst failure [1]"]) for row in rows]
    assert worst == found.worst(SIMULATOR).tolist() == said["numbers"][SIMULATOR]["worst failure"]
    assert said["notation"] == table.attrs["notation"] == notation(found)
    assert table["thrust_used"].attrs["units"] == "1"


def test_the_page_of_the_docs_says_what_is_computed(found, root):
    page = (root / "docs" / "capability.md").read_text(encoding="utf-8")
    assert f"R/V Gunnerus: {notation(found)}" in page
    rows = [
        line.split("|")
        for line in page.splitlines()
        if line[:5] in ("| A |", "| B |", "| C |", "| D |")
    ]
    assert tuple(int(row[4]) for row in rows) == found.elements()
    assert tuple(int(row[5]) for row in rows[2:]) == found.elements(most_lost=1)[2:]


def problems_of(system, ship):
    with pytest.raises(ShipcosimError) as error:
        read_vessel(system, ship)
    return [str(problem) for problem in error.value.problems]


def test_all_that_is_missing_is_said_at_once(system, tmp_path):
    folder = tmp_path / "boat"
    folder.mkdir()
    (folder / "ship.toml").write_text('description = "a boat"')
    port = '{ value = 1.0, unit = "m", origin = "drawing" }'
    (folder / "capability-port.toml").write_text(f"shaft_height = {port}\ndepth = {port}")
    said = problems_of(system, read_ship(folder))
    assert len(said) == 4 and all(str(folder) in text for text in said)
    assert "wind_area_front [m2]" in said[0] and "bow_angle [rad]" in said[0]
    assert any("depth" in text and "no such parameter" in text for text in said)


def test_words_that_mean_nothing_are_said_with_those_that_do(system, root, tmp_path):
    folder = tmp_path / "gunnerus-33m9"
    folder.mkdir()
    for file in (root / "ssp" / "ships" / "gunnerus-33m9").glob("*"):
        text = (
            file.read_text(encoding="utf-8")
            .replace('"rim-driven"', '"rim"')
            .replace('"broken"', '"sharp"')
        )
        (folder / file.name).write_text(text, encoding="utf-8")
    said = problems_of(system, read_ship(folder))
    assert len(said) == 3 and "transmission: found 'rim'" in said[0] and "rim-driven" in said[0]
    assert "capability-tunnel.toml" in said[2] and "broken" in said[2]


def test_ships_of_all_parameter_sets_have_what_the_capability_needs(system, root):
    for folder in sorted((root / "ssp" / "ships").glob("gunnerus-*")):
        found = read_vessel(system, read_ship(folder))
        said = [one for file in found.particulars.values() for one in file.values()]
        assert len(found.thrusters) == 3 and any("assumed" in one.origin for one in said)


def test_an_azimuth_that_cannot_turn_pushes_where_it_points(system, root):
    fixed = with_values(system, {"port.azimuth_rate": 0.0, "port.azimuth_in": 0.5}, "test")
    port = read_vessel(fixed, read_ship(root / "ssp" / "ships" / "gunnerus-33m9")).thrusters[0]
    assert (port.kind, port.angle) == ("fixed", 0.5)


def test_a_system_without_thrusters_is_refused(root, system):
    alone = replace(system, connections=())
    (said,) = problems_of(alone, read_ship(root / "ssp" / "ships" / "gunnerus-33m9"))
    assert "no vessel found" in said
