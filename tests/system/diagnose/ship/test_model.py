"""The ship in array form is the ship of the system: same forces, same motion; her instruments show what they should."""

from dataclasses import replace
from math import cos, degrees, hypot, pi, radians, sin

import numpy as np
import pytest
from diagnose import twin
from ships import lend, parameters, unit_on_centreline

from shipcosim.cosim import RunOptions, simulate
from shipcosim.diagnose.ship.dynamics import current_at, loads, motion_rates
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.errors import ShipcosimError
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.propulsion.azimuth import AzimuthParameters
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import new, read, read_system, with_values

WRONG = {
    "port.thrust_loss": 0.2,
    "starboard.reverse_loss": 0.3,
    "port.interaction_loss": 0.4,
    "starboard.azimuth_offset": 0.15,
    "tunnel.rpm_offset": 40.0,
    "tunnel.thrust_loss": 0.1,
    "vessel.mass_scale": 1.2,
    "vessel.cross_flow_scale": 1.5,
    "vessel.drag_scale": 2.0,
    "vessel.wind_load_scale": 1.3,
    "vessel.apparent_wind_offset": 0.2,
}
CURRENT = {"water.current_north": 0.3, "water.current_east": -0.2}
INPUTS = {
    "port_rpm": (100.0, "rpm"),
    "starboard_rpm": (-80.0, "rpm"),
    "tunnel_rpm": (700.0, "rpm"),
    "port_azimuth": (80.0, "deg"),
    "starboard_azimuth": (-20.0, "deg"),
    "true_wind_speed": (9.0, "m/s"),
    "true_wind_from": (100.0, "deg"),
    "current_speed": (hypot(0.3, 0.2), "m/s"),
    "current_to": (degrees(np.arctan2(-0.2, 0.3)), "deg"),
}
START = {"x": 5.0, "y": -3.0, "psi": 0.7, "u": 1.5, "v": -0.4, "r": 0.03}


@pytest.fixture(scope="module", params=[{}, WRONG], ids=["as she is", "with causes"])
def sailed(request):
    """Twenty seconds of the FMUs, and the ship in array form with the same numbers."""
    ready = with_values(
        twin.system(),
        request.param | {f"vessel.{name}_start": start for name, start in START.items()},
    )
    ready = with_values(ready, {"environment.gust_scale": 0.0})
    inputs = make_table(
        np.array([0.0, 20.0]),
        [(n, np.full(2, value), unit, "") for n, (value, unit) in INPUTS.items()],
    )
    table = simulate(ready, Scenario(stop_time=20.0, step_size=0.05), RunOptions(inputs=inputs))
    return table, twin.model().with_values(request.param | CURRENT)


def motion(table, rows=slice(None)):
    return Motion(*(table[f"vessel.{name}"].values[rows] for name in START))


def inputs(table, rows=slice(None)):
    time = table["time"].values[rows]
    units = {
        "port": (INPUTS["port_rpm"][0] / 60.0, radians(INPUTS["port_azimuth"][0])),
        "starboard": (INPUTS["starboard_rpm"][0] / 60.0, radians(INPUTS["starboard_azimuth"][0])),
        "tunnel": (INPUTS["tunnel_rpm"][0] / 60.0, 0.0),
    }
    wind = (table[f"vessel.apparent_wind_{name}"].values[rows] for name in ("speed", "from"))
    return Inputs(
        time, {name: (n + 0.0 * time, a + 0.0 * time) for name, (n, a) in units.items()}, *wind
    )


def test_forces_are_those_of_the_fmus(sailed):
    """Thrusters put out a step later what the ship's motion makes of them, the neighbour's channel another later."""
    table, model = sailed
    found = loads(motion(table), inputs(table), model)
    for name in model.thrusters:
        for axis, load in zip("XYN", found[name], strict=True):
            np.testing.assert_allclose(
                load[1:-1], table[f"{name}.tau_{axis}"].values[2:], rtol=1e-9, atol=1e-6
            )
    for axis, load in zip("XYN", found["wind"], strict=True):
        np.testing.assert_allclose(
            load, table[f"vessel.tau_wind_{axis}"].values, rtol=1e-9, atol=1e-6
        )


def test_motion_integrated_in_array_form_is_that_of_the_fmus(sailed):
    """Euler's steps of 0.05 s against the FMUs' Runge-Kutta with loads held: both of first order in the step."""
    table, model = sailed
    table_drivers, ship, h = (
        inputs(table),
        Motion(*(np.array(value) for value in START.values())),
        0.05,
    )
    wind = "true_wind_speed", "true_wind_from"
    model = replace(model, wind_is_true=True)
    for k in range(table.sizes["time"] - 1):
        units = {name: (n[k], azimuth[k]) for name, (n, azimuth) in table_drivers.units.items()}
        rates = motion_rates(
            ship, Inputs(k * h, units, INPUTS[wind[0]][0], radians(INPUTS[wind[1]][0])), model
        )
        ship = Motion(*(value + h * rate for value, rate in zip(ship, rates, strict=True)))
    last = motion(table, -1)
    assert hypot(ship.x - last.x, ship.y - last.y) < 0.1  # of some 30 m
    assert abs(degrees(ship.psi - last.psi)) < 0.5
    assert hypot(last.x - START["x"], last.y - START["y"]) > 10.0


def test_a_ship_that_moves_with_the_water_feels_nothing():
    model = twin.model().with_values(CURRENT)
    psi = np.array([0.0, 1.0, 2.5])
    u, v = to_body(psi, 0.3, -0.2)
    still = {name: (np.zeros(3), np.zeros(3)) for name in model.thrusters}
    rates = motion_rates(
        Motion(0.0, 0.0, psi, u, v, np.zeros(3)), Inputs(0.0, still, None, None), model
    )
    np.testing.assert_allclose((rates.x, rates.y), ([0.3] * 3, [-0.2] * 3), atol=1e-12)
    np.testing.assert_allclose((rates.u, rates.v, rates.r), np.zeros((3, 3)), atol=1e-12)


def test_a_varying_current_turns_the_shorter_way_at_constant_speed():
    ends = {"north_start": 0.4, "east_start": 0.0, "north_end": 0.0, "east_end": 0.4}
    model = replace(
        twin.model().with_values({f"water.{name}": v for name, v in ends.items()}),
        span=(100.0, 300.0),
    )
    times = np.array([0.0, 100.0, 200.0, 300.0, 400.0])
    angle = np.radians([0.0, 0.0, 45.0, 90.0, 90.0])
    np.testing.assert_allclose(
        current_at(times, model), (0.4 * np.cos(angle), 0.4 * np.sin(angle)), atol=1e-12
    )


def test_a_trend_grows_from_the_first_to_the_last_row():
    values = {"water.current_north": 0.1, "water.trend_north": 0.2, "water.trend_east": -0.4}
    model = replace(twin.model().with_values(values), span=(100.0, 300.0))
    north, east = current_at(np.array([100.0, 150.0, 300.0]), model)
    np.testing.assert_allclose((north, east), ([0.1, 0.15, 0.3], [0.0, -0.1, -0.4]), atol=1e-12)


def test_line_and_waves_load_the_ship_by_their_closed_forms():
    psi = np.linspace(-3.0, 3.0, 13)
    tow, drift = (-2000.0, 1500.0), (2000.0, 1000.0)
    values = {"water.tow_north": tow[0], "water.tow_east": tow[1]}
    values |= {"water.drift_north": drift[0], "water.drift_east": drift[1]}
    ship = Motion(0.0, 0.0, psi, 0.0 * psi, 0.0 * psi, 0.0 * psi)
    still = {name: (0.0 * psi, 0.0 * psi) for name in twin.model().thrusters}
    found = loads(ship, Inputs(0.0 * psi, still, None, None), twin.model().with_values(values))
    Y = -tow[0] * np.sin(psi) + tow[1] * np.cos(psi)
    np.testing.assert_allclose(
        found["earth_force"], (tow[0] * np.cos(psi) + tow[1] * np.sin(psi), Y, -17.0 * Y), atol=1e-9
    )
    A, gamma = hypot(*drift), np.arctan2(drift[1], drift[0]) - psi
    expected = (
        A * np.cos(gamma) / 3.0,
        A * np.sin(gamma) * np.abs(np.sin(gamma)),
        -1.5 * A * np.sin(2.0 * gamma),
    )
    np.testing.assert_allclose(found["drift_force"], expected, atol=1e-9)


def test_drift_swells_about_its_place_in_the_log_and_nowhere_else():
    """Eight places in 700 s are 100 s apart."""
    time = np.arange(0.0, 701.0, 50.0)
    still = {name: (np.zeros_like(time), np.zeros_like(time)) for name in twin.model().thrusters}
    ship = replace(twin.model().with_values({"water.drift_north": 2000.0}), span=(0.0, 700.0))
    where, at = (
        Motion(*[np.full_like(time, 0.4)] + [np.zeros_like(time)] * 5),
        Inputs(time, still, None, None),
    )
    plain = np.array(loads(where, at, ship)["drift_force"])
    swollen = np.array(
        loads(where, at, ship.with_values({"water.drift_swell_4": 0.2}))["drift_force"]
    )
    share = 1.0 + 0.2 * np.interp(time, [200.0, 300.0, 400.0], [0.0, 1.0, 0.0])
    np.testing.assert_allclose(swollen, share * plain, atol=1e-9)


def test_true_wind_and_apparent_wind_of_a_moving_ship_load_her_alike():
    model, ship = twin.model(), Motion(0.0, 0.0, 0.6, 2.0, -0.5, 0.01)
    still = {name: (0.0, 0.0) for name in model.thrusters}
    north, east = (
        -10.0 * cos(2.0) - 2.0 * cos(0.6) - 0.5 * sin(0.6),
        -10.0 * sin(2.0) - 2.0 * sin(0.6) + 0.5 * cos(0.6),
    )
    apparent = (
        hypot(north, east),
        np.arctan2(-east, -north) - 0.6,
    )  # air seen from the ship, and where it comes from
    given = loads(ship, Inputs(0.0, still, *apparent), model)["wind"]
    true = loads(ship, Inputs(0.0, still, 10.0, 2.0), replace(model, wind_is_true=True))["wind"]
    np.testing.assert_allclose(true, given, rtol=1e-9)


def test_a_vane_turned_to_starboard_makes_the_ship_feel_the_wind_further_to_port():
    model, ship = twin.model(), Motion(*np.zeros(6))
    still = {name: (0.0, 0.0) for name in model.thrusters}
    wrong = model.with_values({"vessel.apparent_wind_offset": 0.3})
    given = loads(ship, Inputs(0.0, still, 8.0, 1.0), wrong)["wind"]
    np.testing.assert_allclose(
        given, loads(ship, Inputs(0.0, still, 8.0, 0.7), model)["wind"], rtol=1e-12
    )


def test_a_heading_measured_too_large_turns_the_velocity_to_port():
    """3 deg too much, 1 m/s ahead to the east: logged heading 93 deg, velocity over ground still east."""
    model = twin.model().with_values({"instruments.heading_bias": radians(3.0)})
    seen = readings(Motion(0.0, 0.0, pi / 2, 1.0, 0.0, 0.0), model)
    assert degrees(seen.psi) == pytest.approx(93.0)
    assert (seen.u, seen.v) == pytest.approx((cos(radians(3.0)), -sin(radians(3.0))))
    over_ground = seen.u * np.exp(1j * seen.psi) + seen.v * 1j * np.exp(1j * seen.psi)
    assert over_ground == pytest.approx(1j)


def test_position_and_velocity_are_both_of_the_antenna():
    """The rate of the antenna's position, by differences along a motion, is the logged velocity over ground."""
    model = twin.model().with_values({"instruments.lever_x": 5.0, "instruments.lever_y": -2.0})
    t = np.linspace(0.0, 60.0, 60001)
    psi = 0.5 + 0.3 * np.sin(0.1 * t)
    r = 0.03 * np.cos(0.1 * t)
    ship = Motion(0.8 * t, 0.2 * t, psi, *to_body(psi, 0.8, 0.2), r)
    seen = readings(ship, model)
    rate = np.gradient(seen.x + 1j * seen.y, t)[1:-1]
    np.testing.assert_allclose(
        rate, ((seen.u + 1j * seen.v) * np.exp(1j * seen.psi))[1:-1], atol=1e-7
    )
    ahead = readings(Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), model)
    assert (ahead.x, ahead.y) == (
        5.0,
        -2.0,
    )  # heading north: forward is north, to starboard is east


def test_velocity_is_logged_over_true():
    seen = readings(
        Motion(0.0, 0.0, 0.3, 2.0, -1.0, 0.1),
        twin.model().with_values({"instruments.velocity_scale": 1.1}),
    )
    assert (seen.u, seen.v, seen.r) == pytest.approx((2.2, -1.1, 0.1))


def test_numbers_are_read_and_changed_by_their_names():
    model = twin.model()
    other = model.with_values(
        {"vessel.mass_scale": 1.2, "vessel.wind_load_scale": 0.9, "port.x": -13.0}
    )
    assert (
        other.get("vessel.mass_scale"),
        other.get("vessel.wind_load_scale"),
        other.get("port.x"),
    ) == (1.2, 0.9, -13)
    assert model.get("vessel.mass_scale") == 1.0 and other.get("starboard.x") == model.get(
        "starboard.x"
    )
    assert (
        model.has("water.tow_x") and not model.has("water.nothing") and not model.has("crane.mass")
    )
    assert model.about("tunnel.rpm_offset")["unit"] == "rpm"
    with pytest.raises(KeyError, match=r"vessel\.nothing"):
        model.with_values({"vessel.nothing": 1.0})


def test_tolerances_of_the_nominal_model_are_in_the_plant():
    tolerances = twin.model().tolerances
    assert tolerances["port.thrust_loss"] == 0.01
    assert tolerances["port.azimuth_offset"] == pytest.approx(radians(0.2))
    assert tolerances["tunnel.rpm_offset"] == 1.0
    assert tolerances["vessel.wind_load_scale"] == pytest.approx(0.03)
    assert tolerances["vessel.mass"] == pytest.approx(0.01 * 531e3)
    assert "port.interaction_loss" not in tolerances


@pytest.fixture(scope="module")
def yard(root):
    """Function from places of azimuths [m] and tunnels [m] to a ship with them, of our FMUs."""

    def build(azimuths=(), tunnels=()):
        ship, fmus = new("other"), twin.build_stale(root)
        ship.add_component("hull", fmus / "vessel.fmu", kinds=())
        lend(ship, "hull", HullParameters, WindParameters)
        units = [("azimuth_thruster", place) for place in azimuths] + [
            ("tunnel_thruster", (x,)) for x in tunnels
        ]
        for number, (fmu, place) in enumerate(units, start=1):
            name = f"{fmu[:3]}{number}"
            ship.add_component(name, fmus / f"{fmu}.fmu", kinds=())
            lend(ship, name, AzimuthParameters if fmu == "azimuth_thruster" else TunnelParameters)
            for axis in "XYN":
                ship.connect(f"{name}.tau_{axis}", f"hull.tau_{axis}_{number}")
            for coordinate, value in zip("xy", place, strict=False):
                ship.set(f"{name}.{coordinate}", float(value))
        return ship

    return build


def test_a_ship_with_four_azimuths_is_read(yard):
    places = [(15.0, 3.0), (15.0, -3.0), (-14.0, 2.0), (-14.0, -2.0)]
    ship = ship_model_of(yard(places).checked())
    assert ship.vessel == "hull" and ship.azimuths == ship.thrusters == [
        "azi1",
        "azi2",
        "azi3",
        "azi4",
    ]
    assert ship.get("hull.length") == parameters(HullParameters).length
    assert [(ship.get(f"{n}.x"), ship.get(f"{n}.y")) for n in ship.azimuths] == places
    neighbours = [
        (ship.get(f"{n}.neighbour_x"), ship.get(f"{n}.neighbour_y")) for n in ship.azimuths
    ]
    assert neighbours == [places[1], places[0], places[3], places[2]]


def test_yaw_moments_of_other_ships_are_those_of_their_levers(yard):
    ship = ship_model_of(yard([(-10.0, 4.0), (-10.0, -4.0)], [8.0]).checked())
    turning = {"azi1": (1.0, 0.0), "azi2": (0.0, 0.0), "tun3": (5.0, 0.0)}
    found = loads(Motion(*np.zeros(6)), Inputs(0.0, turning, None, None), ship)
    X, Y, N = found["azi1"]
    assert X > 0.0 and pytest.approx(-4.0 * X) == N and abs(Y) < 1e-9
    assert found["tun3"][2] == pytest.approx(8.0 * found["tun3"][1]) and found["tun3"][1] > 0.0
    assert found["azi2"][0] == pytest.approx(0.0)


def test_a_larger_ship_has_tolerances_in_proportion_and_a_line_at_her_stern(yard):
    ship = yard([(-30.0, 0.0)])
    ship.set("hull.mass", 5310e3)
    ship.set("hull.length", 80.0)
    model = ship_model_of(ship.checked())
    assert model.tolerances["hull.mass"] == pytest.approx(53.1e3)
    assert model.get("water.tow_x") == -40.0


def test_tolerances_that_the_system_states_are_taken(yard):
    ship = yard([(-30.0, 0.0)])
    ship.set("hull.mass", 531e3, tolerance=7e3)
    assert ship_model_of(ship.checked()).tolerances["hull.mass"] == 7e3


def test_a_system_without_a_vessel_is_refused_by_what_it_has(root):
    ship = new("none")
    ship.add_component("propeller", twin.build_stale(root) / "azimuth_thruster.fmu", kinds=())
    with pytest.raises(
        ShipcosimError, match=r"0 components with .* propeller .*exactly one vessel\.fmu"
    ):
        ship_model_of(ship.checked())


def test_a_load_that_is_not_of_our_thrusters_is_refused_by_its_name():
    ship = read(twin.ROOT / "ssp" / "gunnerus_open", fmus=[twin.build_stale(twin.ROOT)])
    ship.add_component("line", twin.build_stale(twin.ROOT) / "earth_force.fmu")
    ship.connect("line.tau_X", "vessel.tau_X_4")
    with pytest.raises(ShipcosimError, match="'line' .*puts a load on 'vessel'"):
        ship_model_of(ship.checked())


def test_defaults_of_a_unit_are_neutral():
    """A cause that is neither given nor found changes no force."""
    ship, unit = Motion(0.0, 0.0, 0.3, 1.0, 0.2, 0.01), unit_on_centreline()
    working = {"port": (1.5, 0.4), "starboard": (-1.0, 2.0), "tunnel": (8.0, 0.0)}
    plain = loads(ship, Inputs(0.0, working, 8.0, 1.0), twin.model())
    neutral = {
        f"port.{n}": getattr(unit, n)
        for n in ("thrust_loss", "reverse_loss", "azimuth_offset", "rpm_offset")
    }
    again = loads(ship, Inputs(0.0, working, 8.0, 1.0), twin.model().with_values(neutral))
    assert again == plain


def test_what_a_ship_leaves_out_is_refused_all_of_it_and_is_no_other_ships(yard):
    ship = yard([(-30.0, 0.0)])
    for name in ("hull.mass", "hull.wind_table", "azi1.rpm_max"):
        del ship.parameters[name]
    with pytest.raises(ShipcosimError) as error:
        ship_model_of(ship.checked())
    text = str(error.value)
    assert "hull: parameters left out" in text and "mass, wind_table." in text
    assert "azi1: parameters left out" in text and "rpm_max." in text


def test_a_thruster_of_an_earlier_version_is_learnt_and_a_neutral_number_that_it_lacks_changes_nothing():
    """Its propeller's curve was in its code; ours would be a guess."""
    whole = read(twin.ROOT / "ssp" / "gunnerus_open", fmus=[twin.build_stale(twin.ROOT)]).checked()
    old = replace(whole, components=dict(whole.components))
    for component, lacking in {"port": ["thrust_polynomial"], "tunnel": ["speed_loss"]}.items():
        fmu = whole.components[component].fmu
        known = {name: variable for name, variable in fmu.variables.items() if name not in lacking}
        old.components[component] = replace(
            whole.components[component], fmu=replace(fmu, variables=known)
        )
    model = ship_model_of(old)
    assert list(model.third_party) == ["port"]
    assert model.get("tunnel.speed_loss") == 0.0 and model.get("tunnel.x") == 14.48


@pytest.mark.parametrize(
    "file",
    sorted((twin.ROOT / "ssp").glob("*/SystemStructure.ssd")),
    ids=lambda file: file.parent.name,
)
def test_every_system_has_one_ship(file):
    """A predictor has the parameters of a hull too, and inputs of loads that others know of."""
    system = read_system(file.parent, fmus=[twin.build_stale(twin.ROOT)])
    assert ship_model_of(system).vessel == "vessel"


@pytest.mark.parametrize("ships", [0, 2])
def test_a_system_without_a_ship_or_with_two_is_refused(ships):
    components = dict(twin.system().components)
    vessel = components.pop("vessel")
    components |= {f"ship {k}": replace(vessel, name=f"ship {k}") for k in range(ships)}
    with pytest.raises(ShipcosimError, match=f"{ships} components with.*exactly one vessel"):
        ship_model_of(replace(twin.system(), components=components))
