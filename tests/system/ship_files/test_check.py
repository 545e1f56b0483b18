"""`check` finds each planted mistake of a ship file, and says where, what, and what would be right."""

import pytest
from ships_at_hand import BOAT, COASTER, FILES, SUPPLY

import shipcosim as sc
from shipcosim.ships.check import check_ship
from shipcosim.ssp import parameter, write_ssv

PLANTED = {
    "no length": (
        SUPPLY,
        [('length = "60 m"\n', "")],
        "particulars",
        "nothing says length",
        "28.9 m",
    ),
    "no mass": (
        SUPPLY,
        [('displacement = "2650 t"\n', "")],
        "mass",
        "how heavy",
        "block_coefficient",
    ),
    "no thrusters": (SUPPLY[: SUPPLY.index("[[thr")], [], "thrusters", "she has none", "azimuth"),
    "a mass of 1 kg": (SUPPLY, [('"2650 t"', '"1 kg"')], "mass", "1 kg do not fit", "t to"),
    "a mass in the wrong unit": (
        SUPPLY,
        [('"2650 t"', "2650")],
        "mass",
        "do not fit 60 m x 14 m x 4.5 m",
        "t to",
    ),
    "two masses": (
        SUPPLY,
        [("[wind]", '[mass]\nmass = "2000 t"\n[wind]')],
        "mass",
        "the displacement",
        "one of them",
    ),
    "block and mass": (
        SUPPLY,
        [("service_speed", "block_coefficient = 0.5\nservice_speed")],
        "mass",
        "do not fit 60 m",
        "0.684",
    ),
    "length in feet for metres": (
        SUPPLY,
        [('"60 m"', "600")],
        "particulars",
        "length over breadth is 42.9",
        "unit",
    ),
    "a length that is a mass": (
        SUPPLY,
        [('"60 m"', '"60 t"')],
        "particulars.length",
        "is in t, where m is wanted",
        "number in m",
    ),
    "an unknown unit": (
        SUPPLY,
        [('"60 m"', '"60 parsnip"')],
        "particulars.length",
        "'parsnip' is not known",
        "kn",
    ),
    "a text": (SUPPLY, [('"60 m"', '"long"')], "particulars.length", "'long'", "a number in m"),
    "a negative draught": (
        SUPPLY,
        [('"4.5 m"', "-4.5")],
        "particulars.draught",
        "found -4.5",
        "greater than 0 m",
    ),
    "not finite": (SUPPLY, [('"4.5 m"', "inf")], "particulars.draught", "found inf", "finite"),
    "an unknown key": (
        SUPPLY,
        [("draught =", "draft =")],
        "particulars",
        "unknown key 'draft'",
        "'draught'",
    ),
    "an unknown section": (
        SUPPLY,
        [("[wind]", "[winds]")],
        "ship.toml",
        "unknown key 'winds'",
        "'wind'",
    ),
    "a mass matrix that is not positive": (
        SUPPLY,
        [("[wind]", "[mass]\nadded_sway_yaw = 9e7\n[wind]")],
        "mass",
        "the mass matrix is not positive",
        "at most",
    ),
    "negative added mass": (
        SUPPLY,
        [("[wind]", '[mass]\nadded_surge = "-3000 t"\n[wind]')],
        "mass",
        "the mass matrix is not positive: surge -3.5e+05",
        "",
    ),
    "an inertia of another ship": (
        SUPPLY,
        [("[wind]", "[mass]\ninertia_yaw = 6.1e6\n[wind]")],
        "mass",
        "gyration radius of 0.025 lengths",
        "0.15 to 0.4",
    ),
    "a centre of gravity outside": (
        SUPPLY,
        [("[wind]", '[mass]\ncentre_of_gravity_x = "29 m"\n[wind]')],
        "mass",
        "centre of gravity lies 29 m",
        "a tenth",
    ),
    "damping that drives": (
        SUPPLY,
        [("[wind]", "[hull]\nX_uu = 2900\n[wind]")],
        "hull",
        "X_uu is 2900",
        "negative",
    ),
    "a thruster before the bow": (
        SUPPLY,
        [('x = "25 m"', 'x = "52 m"')],
        "thruster bow",
        "x is 52 m",
        "-30 to 30",
    ),
    "a thruster beside the ship": (
        SUPPLY,
        [('y = "3.5 m"', "y = 35")],
        "thruster starboard",
        "y is 35 m",
        "-7 to 7",
    ),
    "a thruster without a place": (
        SUPPLY,
        [('y = "3.5 m"\n', "")],
        "thruster starboard",
        "nothing says y",
        "starboard",
    ),
    "a thruster of no kind": (
        SUPPLY,
        [('kind = "tunnel"', 'kind = "tunel"')],
        "thruster bow",
        "'tunel'",
        "'tunnel'",
    ),
    "a thruster without its kind": (
        SUPPLY,
        [('kind = "tunnel"\n', "")],
        "thruster bow",
        "its kind",
        "azimuth",
    ),
    "an unknown key of a thruster": (
        SUPPLY,
        [('x = "25 m"', "xx = 25")],
        "thruster bow",
        "'xx'",
        "There is",
    ),
    "a thruster without power": (
        SUPPLY,
        [('power = "500 kW"', "")],
        "thruster bow",
        "power or thrust",
        "500 kW",
    ),
    "two of a name": (SUPPLY, [('"starboard"', '"port"')], "thrusters", "'port' is taken", "own"),
    "more thrust than the power gives": (
        SUPPLY,
        [('power = "500 kW"', 'power = "500 kW"\nthrust = "500 kN"')],
        "thruster bow",
        "500 kN of 500 kW",
        "No tunnel propeller",
    ),
    "more thrust than the speed gives": (
        SUPPLY,
        [('power = "500 kW"', 'power = "500 kW"\nthrust = "80 kN"\nrpm = 60')],
        "thruster bow",
        "thrust coefficient of 9.3",
        "at most 1.2",
    ),
    "a propeller larger than the ship": (
        SUPPLY,
        [('diameter = "1.7 m"', "diameter = 17")],
        "thruster bow",
        "does not fit under",
        "unit",
    ),
    "a map whose thrust falls": (
        BOAT,
        [("[100, 9000]", "[100, -9000]")],
        "thruster stern",
        "-9000 N after 0 N",
        "increas",
    ),
    "a map of three columns": (
        BOAT,
        [("[100, 9000]", "[100, 9000, 3]")],
        "thruster stern",
        "two numbers",
        "[[",
    ),
    "a coefficient that is none": (
        BOAT,
        [('kind = "map"', 'kind = "map"\ncoefficients = { gain = 2.0 }')],
        "thruster bow.gain",
        "no such number",
        "thrust_loss",
    ),
    "a table that is not there": (
        SUPPLY,
        [("[wind]", '[wind]\ntable = "w.csv"')],
        "hull",
        "there is no file",
        "",
    ),
    "a kind of ship that is none": (
        SUPPLY,
        [('"offshore supply vessel"', '"offshore supply vesel"')],
        "wind.kind",
        "offshore supply vesel",
        "'offshore supply vessel'",
    ),
    "no diameter of a screw": (
        COASTER,
        [('diameter = "3 m"', "")],
        "thruster propeller",
        "diameter",
        "5.8 m",
    ),
    "no TOML": (SUPPLY, [("[wind]", "[wind")], "line", "is no TOML", "texts in quotes"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_each_planted_mistake_is_found_where_it_is(name, written):
    text, changes, where, found, remedy = PLANTED[name]
    errors = [
        problem
        for problem in check_ship(str(written(text, *changes)))
        if problem.severity == "error"
    ]
    said = [
        e
        for e in errors
        if where in e.where and found in e.found and remedy in f"{e.found} {e.remedy}"
    ]
    assert said, "\n".join(map(str, errors)) or "no error at all"


@pytest.mark.parametrize("name", FILES)
def test_nothing_is_wrong_with_a_ship_as_it_should_be(name, written):
    assert not [
        problem for problem in check_ship(str(written(FILES[name]))) if problem.severity == "error"
    ]


def test_a_flat_ferry_is_possible_with_a_remark_and_a_draught_in_centimetres_is_not(written):
    """milliAmpere, 5.0 m x 2.8 m x 0.15 m."""
    ferry = ('"60 m"', '"5 m"'), ('"14 m"', '"2.8 m"'), ('"2650 t"', '"1667 kg"')
    at = ('"4.5 m"', '"0.15 m"')
    places = [(f'"{x} m"', f'"{x / 15:g} m"') for x in (-27, -3.5, 3.5, 25)]
    sizes = ('"2.4 m"', '"0.15 m"'), ('"1200 kW"', '"1 kW"'), ('"1.7 m"', '"0.15 m"')
    small = *ferry, *places, *sizes, ('"500 kW"', '"1 kW"'), ('"12 kn"', '"3 kn"')
    changes = [one for one in small for _ in range(SUPPLY.count(one[0]))]
    found = check_ship(str(written(SUPPLY, *changes, at)))
    (flat,) = [one for one in found if "breadth over draught is 18.7" in one.found]
    assert flat.severity == "remark" and "guess" in flat.remedy
    assert not [one for one in found if one.severity == "error"], found
    wrong = check_ship(str(written(SUPPLY, *changes, ('"4.5 m"', '"0.015 m"'))))
    assert any("is a unit missing" in one.remedy for one in wrong)


def test_all_mistakes_are_said_at_once(written):
    path = written(
        SUPPLY, ('"60 m"', '"60 t"'), ("draught =", "draft ="), ('x = "25 m"', "xx = 25")
    )
    assert len(check_ship(str(path))) == 3


def test_a_ship_too_weak_for_her_speed_and_one_without_a_dp_earn_remarks(written):
    weak = check_ship(
        str(written(SUPPLY, ('"12 kn"', '"19 kn"'), ("1200 kW", "20 kW"), ("1200 kW", "20 kW")))
    )
    assert any("does not reach her service speed" in problem.remedy for problem in weak)
    (remark,) = [p for p in check_ship(str(written(COASTER))) if "no DP system" in p.found]
    assert remark.severity == "remark"


def test_a_ship_that_still_water_drives_earns_a_remark_in_any_file(written, root, tmp_path):
    """In her file, in a system whose set calibrated or extended her, in a scenario with that set."""

    def remarks(file):
        found = [one for one in sc.check(file).problems if "still water" in one.found]
        return [one.where for one in found if one.severity == "remark"]

    assert remarks(written(SUPPLY)) == []
    file = written(SUPPLY, ("[wind]", "[hull]\nY_v = -1e3\nN_v = 2e6\n[wind]"))
    assert remarks(file) == [f"{file}: hull"]
    assert remarks("gunnerus_open") == []
    values = tmp_path / "calibrated.ssv"
    write_ssv(values, "calibrated", [parameter("vessel.X_u", 3e3, "N.s/m", "calibrated")])
    system = sc.read("gunnerus_open").copy()
    system.bind(values)
    system.write(tmp_path / "extended.ssp")
    assert remarks(tmp_path / "extended.ssp") == [f"{tmp_path / 'extended.ssp'}: vessel"]
    scenario = tmp_path / "run.toml"
    head = f'system = "{root / "ssp" / "gunnerus_open"}"\nparameters = ["calibrated.ssv"]\n'
    scenario.write_text(head + "stop_time = 1.0\nstep_size = 0.05\n")
    assert remarks(scenario) == [f"{scenario}: vessel"]
