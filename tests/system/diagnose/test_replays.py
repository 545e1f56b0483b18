"""Replays of a log, of a run as a log, and of what a diagnosis extended."""

import json

import numpy as np
import pytest
from diagnose import twin

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.log.runs import channels_of_run, other_numbers, run_as_log
from shipcosim.diagnose.replays import replay_log
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.validation.tracks import errors_of
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table, write_table
from shipcosim.ssp import read_system, with_values

ROOT = twin.ROOT


@pytest.fixture(scope="module")
def tanker():
    return read_system(ROOT / "ssp" / "kvlcc2_open", fmus=[twin.build_stale(ROOT)])


@pytest.fixture(scope="module")
def run(tanker):
    """Two minutes of KVLCC2 with her rudder from side to side."""
    time = np.arange(0.0, 121.0, 0.5)
    rudder = 15.0 * np.sign(np.sin(2.0 * np.pi * time / 60.0))
    columns = [
        ("propeller_rpm", np.full(time.size, 610.0), "rpm", ""),
        ("propeller_azimuth", rudder, "deg", ""),
    ]
    begun = with_values(tanker, {"vessel.u_start": 1.0})
    done = sc.simulate(
        begun, stop_time=120.0, step_size=0.1, output_interval=0.5, inputs=make_table(time, columns)
    )
    return done.table


def test_a_run_read_as_a_log_has_the_roles_of_its_signals(run):
    log = run_as_log(run, "vessel", ["propeller"])
    assert {"north", "heading", "surge", "wind_speed", "propeller_rpm", "propeller_azimuth"} <= set(
        log.data_vars
    )
    assert (
        log["heading"].attrs["units"] == "rad" and log["propeller_azimuth"].attrs["units"] == "deg"
    )
    np.testing.assert_array_equal(
        log["north"].values, run["vessel.x"].values + run["vessel.x_wave"].values
    )


def test_predictions_of_a_ship_under_way_start_where_she_is():
    """At 5 m/s a position that is smoothed over seconds is metres off at the first row."""
    sailed = sc.run("steering/circle", stop_time=150.0, strict=False)
    errors = errors_of(sc.replay(sailed, system="gunnerus_open", horizon=20.0).tracks)
    assert float(errors["position"].values.max()) < 0.6
    assert float(errors["position"].values[0, 0]) < 0.3


def test_a_run_of_a_ship_with_a_rudder_has_what_drove_her(tanker):
    circle = sc.run("steering/kvlcc2_circle", stop_time=20.0)
    log = run_as_log(circle.table, "vessel", ["propeller"])
    assert float(log["propeller_rpm"][-1]) == 617.0
    assert np.degrees(log["propeller_azimuth"].values[-1]) == pytest.approx(-35.0)


def test_a_thruster_that_is_told_its_force_is_driven_by_it_and_by_no_speed(run):
    force = run.rename(propeller_rpm="propeller_thrust").drop_vars("propeller_azimuth")
    log = run_as_log(force, "vessel", ["propeller"])
    assert "propeller_thrust" in log and "propeller_rpm" not in log


def test_a_thruster_whose_force_an_allocator_commands_is_driven_by_that():
    """Own runs of a ship with propellers that do not turn were refused: no log had what they follow."""
    system = read_system(ROOT / "ssp" / "osv_dp", fmus=[twin.build_stale(ROOT)])
    ship = ship_model_of(system)
    assert {ship.drives(name) for name in ship.thrusters} == {("thrust",)}
    signals = ["time", "vessel.x", "vessel.y", "vessel.psi", "stern_1.thrust"]
    signals += ship.thrust_signals.values()
    channels = channels_of_run(signals, "vessel", ship.thrusters, ship.thrust_signals)
    assert channels["stern_1_thrust"].column == "allocator.thrust_cmd_3"


def test_the_velocity_is_along_the_heading_that_waves_turn(run):
    waves = run.assign({"vessel.psi_wave": run["vessel.psi_wave"] + np.radians(90.0)})
    log = run_as_log(waves, "vessel", ["propeller"])
    ahead = run["vessel.u"] + run["vessel.u_wave"]
    np.testing.assert_allclose(log["sway"], -ahead, atol=1e-12)


def test_the_folder_of_a_run_stands_for_its_table(run, tmp_path):
    write_table(run, tmp_path / "result.nc")
    log = run_as_log(tmp_path, "vessel", ["propeller"])
    np.testing.assert_array_equal(
        log["heading"], run_as_log(run, "vessel", ["propeller"])["heading"]
    )


def test_a_run_of_a_ship_with_other_thrusters_is_refused(run):
    made_it = run.assign_attrs(system="tanker_dp")
    right = "another ship: her thrusters are propeller.*--system tanker_dp"
    with pytest.raises(ShipcosimError, match=right):
        run_as_log(made_it, "vessel", ["left", "right"])


def test_numbers_that_a_run_had_and_the_ship_has_not_are_named(run):
    mass = json.loads(run.attrs["start_values"])["vessel.mass"]
    assert other_numbers(run, {"vessel.mass": mass, "water.depth": 3.0}) == []
    (remark,) = other_numbers(run, {"vessel.mass": 2.0 * mass})
    assert f"vessel.mass {mass:g} (here {2.0 * mass:g})." in remark


def test_a_log_of_any_other_form_is_left_as_it_is(run):
    log = run_as_log(run, "vessel", [])
    assert run_as_log(log, "vessel", []) is log


def test_a_run_of_another_ship_says_what_is_missing(run):
    with pytest.raises(
        ShipcosimError, match=r"no x, y, psi of 'hull'.*Its components: .*vessel.*--system"
    ):
        run_as_log(run, "hull", [])


def test_a_run_replayed_by_its_own_system_is_the_run(run, tanker):
    """0.5 m of 29 m: she starts from smoothed values, and her rudder jumps within a row, which a log does not tell."""
    tracks = replay_log(run, {"before": tanker}).tracks
    errors = errors_of(tracks)
    assert tracks.horizon > 25.0 and tracks.predicted["before"].sizes["segment"] == 4
    assert float(errors["position"].max()) < 0.5 and float(errors["heading"].max()) < 3.0


def test_a_log_from_a_file_is_replayed_with_another_parameter_set_beside(run, tanker, tmp_path):
    write_table(run, tmp_path / "result.nc")
    weak = with_values(tanker, {"propeller.lift_gradient": 1.4})
    found = errors_of(
        replay_log(tmp_path / "result.nc", {"before": weak, "after": tanker}, horizon=30.0).tracks
    )
    before, after = (
        float(found["heading"].sel(simulation=name).isel(after=-1)) for name in ("before", "after")
    )
    assert after < 3.0 < before


def test_instruments_of_an_extended_system_are_taken_off_its_start_and_put_on_what_it_shows(
    run, tanker, tmp_path
):
    """An antenna 3 m ahead: the plain ship is 3 m off in part of the circle, the extended one is not."""
    log = run_as_log(run, "vessel", ["propeller"])
    psi, r = np.radians(1.0) * 0.0 + run["vessel.psi"].values, run["vessel.r"].values
    moved = log.assign(
        north=log["north"] + 3.0 * np.cos(psi),
        east=log["east"] + 3.0 * np.sin(psi),
        sway=log["sway"] + 3.0 * r,
    )
    for name in ("north", "east", "sway"):
        moved[name].attrs = dict(log[name].attrs)
    arm = {"x": ParameterEstimate(3.0, 0.1, "m"), "y": ParameterEstimate(0.0, 0.1, "m")}
    extended = extend(
        ROOT / "ssp" / "kvlcc2_open", [Finding("lever_arm", parameters=arm)], tmp_path
    )
    after = read_system(str(extended.ssp))
    found = errors_of(replay_log(moved, {"before": tanker, "after": after}, horizon=30.0).tracks)[
        "position"
    ]
    before, after = (
        float(found.sel(simulation=name).isel(after=1)) for name in ("before", "after")
    )
    assert after < 0.3 < before


def test_a_log_without_a_whole_stretch_is_refused(run, tanker):
    with pytest.raises(ShipcosimError, match="no 500 s of the log"):
        replay_log(run, {"before": tanker}, horizon=500.0)


@pytest.mark.parametrize(
    "name", ["result.nc", "result.csv", "none.csv", "broken.nc", "broken.csv.gz"]
)
def test_of_a_file_only_the_names_are_read_before_it_is_known_to_be_a_run(name, tmp_path):
    """A file that cannot be read is left to the reader, which says what is wrong with it."""
    path = tmp_path / name
    if name.startswith("result"):
        signals = "vessel.x", "vessel.u", "barge.x", "barge.y", "barge.psi"
        write_table(
            make_table(np.arange(3.0), [(name, np.arange(3.0), "m", "") for name in signals]), path
        )
        with pytest.raises(ShipcosimError, match="no y, psi of 'vessel'"):
            run_as_log(path, "vessel", [])
    else:
        if "broken" in name:
            path.write_bytes(b"\x1f\x8bnothing")
        assert run_as_log(path, "vessel", []) == path


def misfit(log, system):
    """Remarks of a replay that say that the log is of another ship."""
    found = replay_log(log, {"simulated": system})
    return [remark for remark in found.remarks if "does not fit this ship" in remark]


def dp_run(system, wind, current, towards, seed):
    """A run of a DP system that goes 10 m north and turns by 30 deg, in some weather [m/s, m/s, deg]."""
    weather = {"environment.wind_speed": wind, "environment.current_speed": current}
    weather |= {"environment.current_to": np.radians(towards), "environment.seed": seed}
    weather |= {"reference.x_set": 10.0, "reference.psi_set": np.radians(30.0)}
    there = {name: value for name, value in weather.items() if _has(system, name)}
    return sc.simulate(
        with_values(system, there), stop_time=300.0, step_size=0.1, output_interval=0.5
    ).table


def _has(system, name):
    component, _, variable = name.partition(".")
    return component in system.components and variable in system.components[component].variables


def as_log(run, names):
    """A run by roles, with the thrusters under other names."""
    log = run_as_log(run, "vessel", list(names.values()))
    navigation = ["north", "east", "heading", "surge", "sway", "yaw_rate"]
    columns = {role: log[role] for role in navigation}
    for name, of in names.items():
        for kind in ("rpm", "azimuth"):
            if f"{of}_{kind}" in log:
                columns[f"{name}_{kind}"] = log[f"{of}_{kind}"]
    return log[[]].assign(columns)


@pytest.fixture(scope="module")
def gunnerus_open():
    return read_system(ROOT / "ssp" / "gunnerus_open", fmus=[twin.build_stale(ROOT)])


@pytest.mark.parametrize(
    ("wind", "current", "towards", "seed"),
    [(0.0, 0.0, 0.0, 1), (8.0, 0.5, 90.0, 2), (14.0, 0.3, 200.0, 3)],
)
def test_a_log_of_her_own_fits_a_ship_in_any_weather(gunnerus_open, wind, current, towards, seed):
    """The log does not tell the current, which moves her by up to 18 m in a minute."""
    held = read_system(ROOT / "ssp" / "gunnerus_dp", fmus=[twin.build_stale(ROOT)])
    assert misfit(dp_run(held, wind, current, towards, seed), gunnerus_open) == []


@pytest.mark.parametrize("own", ["kvlcc2_open", "otter_open"])
def test_a_log_of_a_ship_under_way_fits_her(run, tanker, own):
    if own == "kvlcc2_open":
        assert misfit(run, tanker) == []
        return
    boat = read_system(ROOT / "ssp" / own, fmus=[twin.build_stale(ROOT)])
    assert misfit(boat_run(boat), boat) == []


def boat_run(boat):
    """200 s of the Otter with changing speeds of her propellers."""
    time = np.arange(0.0, 200.5, 0.5)
    columns = [
        ("left_rpm", 500.0 + 80.0 * np.sin(time / 20.0), "rpm", ""),
        ("right_rpm", 480.0 + 60.0 * np.cos(time / 15.0), "rpm", ""),
    ]
    driven = make_table(time, columns)
    return sc.simulate(
        boat, stop_time=200.0, step_size=0.1, output_interval=0.5, inputs=driven
    ).table


@pytest.mark.parametrize(
    ("system", "names"),
    [
        ("otter_open", {"port": "left", "starboard": "right"}),
        ("four_azimuths", {"port": "aft_port", "starboard": "aft_starboard"}),
        ("four_azimuths", {"port": "bow_port", "starboard": "bow_starboard"}),
    ],
)
def test_a_log_of_another_ship_is_said_to_be_one_and_by_what(gunnerus_open, system, names):
    other = read_system(ROOT / "ssp" / system, fmus=[twin.build_stale(ROOT)])
    table = boat_run(other) if system == "otter_open" else dp_run(other, 8.0, 0.3, 90.0, 1)
    (said,) = misfit(as_log(table, names), gunnerus_open)
    assert "s after its starts the simulation is off by" in said
    assert "Is it the log of another ship" in said


def test_few_predictions_say_nothing_of_the_ship(gunnerus_open):
    boat = read_system(ROOT / "ssp" / "otter_open", fmus=[twin.build_stale(ROOT)])
    log = as_log(boat_run(boat), {"port": "left", "starboard": "right"})
    found = replay_log(log, {"simulated": gunnerus_open}, horizon=90.0)
    assert not [remark for remark in found.remarks if "does not fit" in remark]
