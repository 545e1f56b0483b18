"""A ship from her file alone runs: open, and in a DP loop where her thrusters allow one."""

import numpy as np
import pytest
from ships_at_hand import BOAT, COASTER, SUPPLY

import shipcosim as sc
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.ships import describe, make_systems, read_ship
from shipcosim.ships.control import why_no_dp
from shipcosim.ssp import read_system

CRAFT = ("blueboat", "kvlcc2", "otter")


@pytest.fixture(scope="module")
def fmus(root):
    return [build_stale(root)]


def settled(folder, fmus):
    """Late part of a run in which the DP holds the ship in wind and current."""
    weather = {
        "environment.wind_speed": 8.0,
        "environment.wind_from": 0.785,
        "environment.current_speed": 0.2,
    }
    system = read_system(folder, fmus=fmus)
    run = sc.simulate(system, stop_time=150.0, step_size=0.1, output_interval=1.0, set=weather)
    return run.sel(time=slice(110.0, None))


def test_a_ship_with_azimuths_and_a_tunnel_holds_her_place(written, fmus, tmp_path):
    made = make_systems(written(SUPPLY), tmp_path / "ssp", fmus)
    assert [folder.name for folder in made] == ["tern_open", "tern_dp", "tern_trials"]
    assert (
        sc.read(made[1], fmus=fmus).description == "supply ship: in a closed DP loop, gains by rule"
    )
    late = settled(made[1], fmus)
    assert np.hypot(late["vessel.x"], late["vessel.y"]).max() < 2.0
    assert np.abs(np.degrees(late["vessel.psi"])).max() < 2.0
    # The law meets the request to rounding; thrust is asked for in tens of kN.
    assert np.abs(late["allocator.slack_Y"]).max() < 10.0
    assert np.abs(late["bow.thrust"]).min() > 1e3
    assert float(late["port.azimuth"].std()) > 1e-3  # it turns


def test_two_screws_and_two_mapped_tunnels_hold_a_boat(written, fmus, tmp_path):
    late = settled(make_systems(written(BOAT), tmp_path / "ssp", fmus)[1], fmus)
    assert np.hypot(late["vessel.x"], late["vessel.y"]).max() < 3.0
    assert np.abs(np.degrees(late["vessel.psi"])).max() < 5.0


def test_a_ship_with_a_rudder_has_an_open_system_that_turns_to_the_rudder(written, fmus, tmp_path):
    folder = make_systems(written(COASTER), tmp_path / "ssp", fmus)[0]
    inputs = {"propeller_rpm": 120.0, "propeller_azimuth": 20.0, "vessel.u_start": 5.0}
    run = sc.simulate(read_system(folder, fmus=fmus), stop_time=60.0, step_size=0.1, set=inputs)
    assert (
        np.degrees(run["vessel.psi"].values[-1]) < -5.0 and 2.0 < run["vessel.u"].values[-1] < 7.0
    )


@pytest.mark.parametrize("craft", [SUPPLY, COASTER])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_steering_trials_turn_to_the_side_of_the_helm(craft, side, written, fmus, tmp_path):
    """By rudder and by azimuths; a ship that is alike on both sides does the same to either."""
    system = read_system(make_systems(written(craft), tmp_path / "ssp", fmus)[-1], fmus=fmus)
    length = system.components["vessel"].start_value("length")
    begun = round(system.components["trial"].start_value("order_time"))
    helm = {"trial.helm": side * np.radians(35.0), "trial.order_time": float(begun)}
    run = sc.simulate(system, stop_time=begun + 250.0, step_size=0.1, set=helm)
    late = run.isel(time=-1)
    assert 1.0 * length < late["trial.advance_90"] < 6.0 * length
    # She sailed north until the order: what is read off stands in her track where she has turned so far.
    turned = side * run["trial.turned"].values
    quarter, half = (int(np.argmax(turned >= angle)) for angle in (0.5 * np.pi, np.pi))
    ordered = run.sel(time=begun)
    way = run["vessel.x"].values[quarter] - float(ordered["vessel.x"])
    assert late["trial.advance_90"] == pytest.approx(way, abs=1.0)
    assert late["trial.tactical_diameter"] == pytest.approx(
        side * run["vessel.y"].values[half], abs=1.0
    )


def test_open_systems_follow_what_they_are_given(written, fmus, tmp_path):
    boat = make_systems(written(BOAT), tmp_path / "ssp", fmus)[0]
    inputs = {"left_rpm": 300.0, "right_rpm": 300.0, "bow_command": 50.0}
    run = sc.simulate(read_system(boat, fmus=fmus), stop_time=20.0, step_size=0.1, set=inputs)
    assert run["vessel.u"].values[-1] > 0.5 and run["vessel.r"].values[-1] > 0.0
    assert run["bow.tau_Y"].values[-1] == pytest.approx(6000.0)


@pytest.mark.parametrize("name", CRAFT)
def test_the_system_of_a_craft_is_what_her_file_makes(name, root, fmus, tmp_path):
    """Components, wires and numbers of ssp/NAME_open; its numbers are made of the same file."""
    folder = make_systems(root / "ssp" / "ships" / name, tmp_path, fmus)[0]
    made, committed = (sc.read(path, fmus=fmus) for path in (folder, root / "ssp" / f"{name}_open"))
    assert set(made.connections) == set(committed.connections)
    for system in (made, committed):
        assert system.step_size == 0.05 and system.stop_time == 600.0
    ours, theirs = dict(made.parameters.items()), dict(committed.parameters.items())
    assert ours == theirs


def test_why_there_is_no_dp_is_said(written):
    assert "no thruster takes a thrust command" in why_no_dp(describe(written(COASTER)))
    alone = BOAT[: BOAT.index('[[thrusters]]\nname = "bow"')]
    assert why_no_dp(describe(written(alone))) == "her thrusters give no force in sway alone"


def test_what_the_file_gives_comes_before_any_formula_with_its_tolerance_and_origin(written):
    known = '[mass]\nadded_sway = { value = "900 t", tolerance = "50 t", origin = "strip theory" }\n[wind]'
    vessel = read_ship(written(SUPPLY, ("[wind]", known)).parent).entries["vessel"]
    assert vessel["A22"][:4] == (900e3, "kg", 50e3, "strip theory")
    assert vessel["mass"][3] == "general arrangement" and vessel["A11"][3].startswith("estimated: ")
    assert vessel["A66"].tolerance > 0.0


def test_a_ship_is_based_on_one_with_a_ship_file(written, tmp_path):
    written(SUPPLY)
    twin = tmp_path / "twin"
    twin.mkdir()
    (twin / "ship.toml").write_text('based_on = "tern"', encoding="utf-8")
    (twin / "vessel.toml").write_text(
        'mass = { value = 3e6, unit = "kg", origin = "loaded" }', encoding="utf-8"
    )
    vessel = read_ship(twin).entries["vessel"]
    assert vessel["mass"].value == 3e6 and vessel["length"].value == 60.0


def test_nothing_is_made_of_a_ship_that_lacks_something(written, fmus, tmp_path):
    with pytest.raises(ShipcosimError, match="nothing says length"):
        make_systems(written(SUPPLY, ('length = "60 m"\n', "")), tmp_path / "ssp", fmus)
    assert not (tmp_path / "ssp").exists()


def test_a_tolerance_of_a_table_in_a_parameter_set_is_no_fault_of_ours(root, fmus):
    """It was a TypeError."""
    system = sc.read(root / "ssp" / "otter_open", fmus=fmus).copy()
    system.set("vessel.wind_table", "0 0 0 0; 180 0 0 0", tolerance=0.1)
    assert system.checked().components
