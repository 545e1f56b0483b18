"""Named causes in an extended system: each shows with the size of its closed form, in our engine and in libcosim."""

from math import atan2, cos, degrees, hypot, pi, radians, sin

import numpy as np
import pytest
from ships import parameters

from shipcosim.cosim import RunOptions, simulate
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.cause import Cause, CauseParameter
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.environment.wind_loads import WindParameters, wind_loads
from shipcosim.models.ship.instruments import true_motion
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import check_file, new, read, read_system, with_values

SHIP = ("x", "y", "psi", "u", "v", "r")
START = dict(psi_start=0.7, u_start=1.5, v_start=-0.2, r_start=0.02)
LOG = {"source": "/somewhere/log.csv", "sha256": "5e1f", "span": (0.0, 20.0)}


def found(cause, component=None, onset=None, **parameters):
    """A finding with a tenth of each value as its standard deviation."""
    estimates = {
        name: ParameterEstimate(value, abs(0.1 * value), unit)
        for name, (value, unit) in parameters.items()
    }
    return Finding(cause, component, parameters=estimates, probability=0.97, onset=onset)


def vector(cause, north, east, unit, **options):
    return found(cause, north=(north, unit), east=(east, unit), **options)


AROUND = [
    vector("current", 0.3, -0.2, "m/s"),
    vector("wave_drift", 2000.0, 1000.0, "N"),
    vector("tow", -1500.0, 2500.0, "N", onset=5.0),
    found("heading_bias", offset=(3.0, "deg")),
    found("lever_arm", x=(5.0, "m"), y=(-2.0, "m")),
    found("velocity_scale", scale=(1.1, "1")),
    found("navigation_lag", lag=(1.5, "s")),
]
ABOARD = [
    found("wind_scale", scale=(1.3, "1")),
    found("wind_direction", offset=(12.0, "deg")),
    found("thrust_loss", "port", loss=(0.2, "1")),
    found("azimuth_offset", "starboard", offset=(7.0, "deg")),
    found("rpm_offset", "tunnel", offset=(60.0, "rpm")),
    found("thrust_loss", "tunnel", loss=(0.3, "1")),
    found("mass", scale=(1.15, "1")),
    found("drag", scale=(2.0, "1")),
    found("crossflow", scale=(1.4, "1")),
]
ASTERN = [found("reverse_loss", loss=(0.4, "1")), found("thruster_interaction", loss=(0.3, "1"))]
TURNED = {
    "north_start": 0.3,
    "east_start": 0.0,
    "north_end": 0.3 * cos(0.06),
    "east_end": 0.3 * sin(0.06),
}
TURNING = [found("current_varying", **{name: (value, "m/s") for name, value in TURNED.items()})]
GROUPS = {"around": AROUND, "aboard": ABOARD, "astern": ASTERN, "turning": TURNING}
INPUTS = {
    "port_rpm": (100.0, "rpm"),
    "starboard_rpm": (80.0, "rpm"),
    "tunnel_rpm": (700.0, "rpm"),
    "port_azimuth": (10.0, "deg"),
    "starboard_azimuth": (-20.0, "deg"),
    "true_wind_speed": (9.0, "m/s"),
    "true_wind_from": (100.0, "deg"),
}


@pytest.fixture(scope="module")
def fmus(root):
    return build_stale(root)


@pytest.fixture(scope="module")
def system(root, fmus):
    return root / "ssp" / "gunnerus_open"


@pytest.fixture(scope="module")
def extended(system, tmp_path_factory):
    """By group of findings: the extension."""
    made = {}

    def make(group):
        if group not in made:
            made[group] = extend(
                system, GROUPS[group], tmp_path_factory.mktemp(group), log_attributes=LOG
            )
        return made[group]

    return make


def run(ssp, fmus, *, stop=10.0, engine="fmpy", values=(), inputs=INPUTS, gusts=0.0):
    """Table of a run with steady inputs, from the state `START`."""
    time = np.array([0.0, stop])
    table = make_table(
        time, [(name, np.full(2, value), unit, "") for name, (value, unit) in inputs.items()]
    )
    start = {f"vessel.{name}": value for name, value in START.items()} | {
        "environment.gust_scale": gusts
    }
    ready = with_values(read_system(ssp, fmus=[fmus]), start | dict(values))
    return simulate(
        ready, Scenario(stop_time=stop, step_size=0.05), RunOptions(inputs=table, engine=engine)
    )


@pytest.fixture(scope="module")
def healthy(system, fmus):
    return run(system, fmus)


@pytest.fixture(scope="module")
def runs(extended, fmus):
    made = {}

    def make(group, **options):
        key = group, str(options)
        if key not in made:
            made[key] = run(extended(group).ssp, fmus, **options)
        return made[key]

    return make


@pytest.mark.parametrize("group", GROUPS)
def test_extended_system_is_sound_and_the_same_in_libcosim(group, extended, runs, needs):
    pytest.importorskip("libcosimpy")
    errors = [
        p
        for file in (extended(group).ssp, extended(group).ssv)
        for p in check_file(file)
        if p.severity == "error"
    ]
    assert errors == []
    ours, theirs = runs(group), runs(group, engine="libcosim")
    shown = [f"vessel.{name}" for name in SHIP] + list(extended(group).signals.values())
    for name in shown:
        np.testing.assert_allclose(theirs[name], ours[name], rtol=1e-9, atol=1e-9, err_msg=name)


def test_set_holds_what_was_named_with_its_spread_and_origin_and_nothing_else(extended, system):
    text = extended("aboard").ssv.read_text(encoding="utf-8")
    assert sorted(extended("aboard").values) == sorted(
        [
            "vessel.wind_load_scale",
            "vessel.apparent_wind_offset",
            "vessel.mass_scale",
            "vessel.drag_scale",
        ]
        + ["vessel.cross_flow_scale", "port.thrust_loss", "starboard.azimuth_offset"]
        + ["tunnel.rpm_offset", "tunnel.thrust_loss"]
    )
    assert "SHA-256 5e1f" in text and "log.csv" in text and "/somewhere" not in text
    again = read_system(extended("aboard").ssp)
    assert again.components["starboard"].start["azimuth_offset"] == pytest.approx(radians(7.0))
    assert again.components["starboard"].tolerances["azimuth_offset"] == pytest.approx(radians(0.7))
    assert set(again.components) == set(read(system).components)


def test_a_ship_that_moves_with_the_named_current_goes_where_it_goes(extended, fmus):
    """No thrust, no wind, at the current's velocity from the start: 20 s of a straight line over the ground."""
    ssp = extended("around").ssp
    quiet = {name: (0.0, unit) for name, (_, unit) in INPUTS.items()}
    nothing = {
        f"{name}.{axis}": 0.0 for name in ("tow", "wave_drift") for axis in ("north", "east")
    }
    u, v = to_body(0.7, 0.3, -0.2)
    start = {"vessel.u_start": u, "vessel.v_start": v, "vessel.r_start": 0.0} | nothing
    # the air moves with the water, or its drag would show
    wind = {
        "true_wind_speed": (hypot(0.3, 0.2), "m/s"),
        "true_wind_from": (degrees(atan2(0.2, -0.3)), "deg"),
    }
    drift = run(ssp, fmus, stop=20.0, values=start, inputs=quiet | wind)
    np.testing.assert_allclose(drift["vessel.x"], 0.3 * drift["time"], atol=1e-6)
    np.testing.assert_allclose(drift["vessel.y"], -0.2 * drift["time"], atol=1e-6)


def test_drift_and_line_load_the_ship_by_their_laws(runs):
    """In sum; the line from its onset on, growing over 30 s. Loads are of the heading a step before."""
    table = runs("around")
    psi, t = table["vessel.psi"].values[:-1], table["time"].values[1:]
    A, gamma = hypot(2000.0, 1000.0), atan2(1000.0, 2000.0) - psi
    drift = (
        A * np.cos(gamma) / 3.0,
        A * np.sin(gamma) * np.abs(np.sin(gamma)),
        -1.5 * A * np.sin(2.0 * gamma),
    )
    share = np.clip((t - 5.0) / 30.0, 0.0, 1.0)
    X, Y = (
        share * (-1500.0 * np.cos(psi) + 2500.0 * np.sin(psi)),
        share * (2500.0 * np.cos(psi) + 1500.0 * np.sin(psi)),
    )
    for axis, wave, line in zip("XYN", drift, (X, Y, -17.0 * Y), strict=True):
        found = table[f"wave_drift.tau_{axis}"].values[1:] + table[f"tow.tau_{axis}"].values[1:]
        np.testing.assert_allclose(found, wave + line, atol=0.02)
    thrusters = sum(
        table[f"{name}.tau_Y"].values
        for name in ("port", "starboard", "tunnel", "wave_drift", "tow")
    )
    np.testing.assert_allclose(
        table["vessel.tau_thrusters_Y"].values[2:], thrusters[1:-1], atol=1e-6
    )


def test_log_of_the_extended_system_is_that_of_wrong_instruments(extended, runs):
    """Antenna 5 m ahead and 2 m to port, compass 3 deg too much, velocity 10 % too much, all 1.5 s late."""
    table, extension = runs("around"), extended("around")
    log = {role: table[signal].values[40:] for role, signal in extension.signals.items()}
    x, y, psi, u, v, r = (table[f"vessel.{name}"].values[10:-30] for name in SHIP)
    np.testing.assert_allclose(log["heading"], psi + radians(3.0), atol=1e-9)
    np.testing.assert_allclose(log["north"], x + 5.0 * np.cos(psi) + 2.0 * np.sin(psi), atol=1e-9)
    np.testing.assert_allclose(log["east"], y + 5.0 * np.sin(psi) - 2.0 * np.cos(psi), atol=1e-9)
    c, s = 1.1 * cos(radians(3.0)), 1.1 * sin(radians(3.0))
    np.testing.assert_allclose(log["surge"], c * (u + 2.0 * r) + s * (v + 5.0 * r), atol=1e-9)
    np.testing.assert_allclose(log["sway"], c * (v + 5.0 * r) - s * (u + 2.0 * r), atol=1e-9)
    np.testing.assert_allclose(log["yaw_rate"], r, atol=1e-9)
    assert extension.lag == 1.5
    again = true_motion(*(log[role] for role in extension.signals), **extension.errors)
    np.testing.assert_allclose(again, (x, y, psi, u, v, r), atol=1e-9)


def test_thrusters_of_the_extended_system_give_what_was_named(healthy, runs):
    table = runs("aboard")
    assert table["port.thrust"][0] / healthy["port.thrust"][0] == pytest.approx(0.8)
    assert table["port.torque"][0] == healthy["port.torque"][0]
    given = healthy["tunnel.thrust"][0] * ((700.0 - 60.0) / 700.0) ** 2
    assert table["tunnel.rpm"][0] == pytest.approx(640.0)
    assert table["tunnel.thrust"][0] == pytest.approx(0.7 * given)


def test_named_azimuth_offset_turns_thrust_and_side_force(runs):
    table = runs("aboard")
    X, Y, T, F = (
        float(table[f"starboard.{name}"][0]) for name in ("tau_X", "tau_Y", "thrust", "side_force")
    )
    turned = atan2(Y, X) - atan2(F, T)
    assert degrees(turned) == pytest.approx(-20.0 + 7.0)
    assert degrees(float(table["starboard.azimuth"][0])) == pytest.approx(-20.0)


def test_named_wind_and_hull_of_the_extended_system(healthy, runs):
    table = runs("aboard")
    speed, angle = (float(table[f"vessel.apparent_wind_{name}"][0]) for name in ("speed", "from"))
    expected = np.array(wind_loads(speed, angle - radians(12.0), wind=parameters(WindParameters)))
    loads = [float(table[f"vessel.tau_wind_{axis}"][0]) for axis in "XYN"]
    np.testing.assert_allclose(loads, 1.3 * expected)
    hull = {
        name: float(run[f"vessel.tau_hull_{axis}"][0]) for name, run, axis in _hull(healthy, table)
    }
    drag = -1645.0 * 1.5**2
    assert hull["X"] - hull["X healthy"] == pytest.approx(drag)
    assert hull["Y"] - hull["Y healthy"] == pytest.approx(0.4 * _strips(-0.2, 0.02), rel=1e-6)


def _hull(healthy, table):
    return [
        (f"{axis}{label}", run, axis)
        for label, run in (("", table), (" healthy", healthy))
        for axis in "XY"
    ]


def _strips(v, r):
    x = (np.arange(20_000) + 0.5) / 20_000 * 33.9 - 16.95
    return np.sum(-0.5 * 1025.0 * 1.5 * 2.786 * np.abs(v + x * r) * (v + x * r)) * (33.9 / len(x))


def test_named_mass_is_that_of_the_accelerations(runs):
    """Surge at the start: (1.15 m + A11) u_dot = loads + 1.15 m v r, with the added mass in tau_hull."""
    table = runs("aboard")
    X = sum(
        float(table[f"vessel.tau_{name}_X"][0]) for name in ("thrusters", "wind", "drift", "hull")
    )
    expected = (X + 1.15 * 531e3 * 0.02 * -0.2) / (1.15 * 531e3 + 26_550.0)
    assert float(table["vessel.u_dot"][0]) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("starboard", "kept"), [(90.0, 0.7), (-90.0, 1.0), (110.0, 1.0 - 0.3 / np.e)]
)
def test_slipstream_of_starboard_takes_thrust_from_port(starboard, kept, extended, system, fmus):
    inputs = INPUTS | {"starboard_azimuth": (starboard, "deg")}
    whole, hit = (
        run(ssp, fmus, stop=0.1, inputs=inputs) for ssp in (system, extended("astern").ssp)
    )
    assert float(hit["port.thrust"][0] / whole["port.thrust"][0]) == pytest.approx(kept)


def test_astern_both_units_lose_what_was_named(extended, system, fmus):
    ahead = {
        "port_azimuth": (0.0, "deg"),
        "starboard_azimuth": (0.0, "deg"),
    }  # off each other's slipstream
    inputs = INPUTS | ahead | {"port_rpm": (-60.0, "rpm"), "starboard_rpm": (-70.0, "rpm")}
    whole, less = (
        run(ssp, fmus, stop=0.1, inputs=inputs) for ssp in (system, extended("astern").ssp)
    )
    for name in ("port", "starboard"):
        assert float(less[f"{name}.thrust"][0] / whole[f"{name}.thrust"][0]) == pytest.approx(0.6)


def test_varying_current_turns_through_the_span_of_the_log(runs):
    """From north, 3.4 deg in 20 s at 0.3 m/s, so within the environment's rate; a step later it is there."""
    table = runs("turning", stop=20.0)
    to = np.arctan2(table["environment.current_east"], table["environment.current_north"])
    np.testing.assert_allclose(
        np.hypot(table["environment.current_north"], table["environment.current_east"]), 0.3
    )
    np.testing.assert_allclose(to[1:], 0.06 * table["time"].values[:-1] / 20.0, atol=1e-9)


def test_a_current_with_an_onset_is_not_there_before(system, fmus, tmp_path):
    late = extend(system, [vector("current", 0.1, 0.0, "m/s", onset=6.0)], tmp_path)
    assert late.remarks == () and late.components == ("varying_current",)
    current = run(late.ssp, fmus, stop=50.0)["environment.current_north"]
    assert np.all(current.sel(time=slice(0.0, 6.0)) == 0.0)
    assert float(current[-1]) == pytest.approx(0.1)


def test_what_cannot_be_carried_is_said(system, tmp_path):
    findings = [
        found("thrust_loss", "port", onset=100.0, loss=(0.2, "1")),
        found("thrust_loss", "bow", loss=(0.2, "1")),
        found("thruster_lag", lag=(2.0, "s")),
        Finding("heading_wrap", kind="data"),
        *(vector("current", 0.1 * k, 0.0, "m/s") for k in (1, 2)),
        *(vector("tow", 100.0 * k, 0.0, "N") for k in range(1, 5)),
    ]
    extension = extend(system, findings, tmp_path)
    assert list(extension.components) == ["tow", "tow_2", "tow_3"]
    said = "\n".join(extension.remarks)
    assert (
        "when it begins, at 100 s" in said
        and "no component 'bow'" in said
        and "shift the channels" in said
    )
    assert (
        "no free load input" in said
        and "moves already" in said
        and extension.values["current_speed"] == 0.1
    )


def test_a_system_whose_parts_have_other_names_and_no_neighbours_yet(system, fmus, tmp_path):
    """Renamed, without connections between the azimuths, in no current: what is missing is put there."""
    other = read(system)
    for old, name in (
        ("vessel", "hull"),
        ("port", "left"),
        ("starboard", "right"),
        ("environment", "weather"),
    ):
        other.rename(old, name)
    for unit in ("left", "right"):
        for name in ("azimuth", "rpm"):
            other.disconnect(f"{unit}.neighbour_{name}")
    for axis in ("north", "east"):
        other.disconnect(f"hull.current_{axis}")
    findings = [ASTERN[1], found("mass", scale=(1.2, "1")), vector("current", 0.1, 0.2, "m/s")]
    extension = extend(other, findings, tmp_path / "steady")
    again = read(extension.ssp)
    assert {
        ("right.rpm", "left.neighbour_rpm"),
        ("left.azimuth", "right.neighbour_azimuth"),
    } <= set(again.connections)
    assert again.parameters["hull.mass_scale"] == 1.2
    assert (again.parameters["hull.current_north"], again.parameters["hull.current_east"]) == (
        0.1,
        0.2,
    )
    turning = extend(other, TURNING, tmp_path / "turning", log_attributes=LOG)
    assert turning.components == ("water", "varying_current")
    assert ("water.current_north", "hull.current_north") in read(turning.ssp).connections


def test_a_current_in_the_opposite_direction_is_entered_in_the_units_of_the_systems_input(extended):
    values = extended("around").values
    assert values["current_speed"] == pytest.approx(hypot(0.3, 0.2))
    assert radians(values["current_to"]) == pytest.approx(atan2(-0.2, 0.3))
    assert abs(values["current_to"]) < degrees(pi)


def test_the_closed_loop_can_be_extended_too(root, fmus, tmp_path):
    extension = extend(root / "ssp" / "gunnerus_dp", [*AROUND, *ABOARD, *ASTERN], tmp_path)
    assert extension.values["environment.current_speed"] == pytest.approx(hypot(0.3, 0.2))
    table = simulate(read_system(extension.ssp), Scenario(stop_time=1.0, step_size=0.05))
    assert np.isfinite(table["instruments.x_meas"]).all()


def test_a_cause_of_the_users_own_is_carried_by_what_its_file_turns(system, tmp_path):
    """A drift with a yaw arm and a lost motor, in one cause; what the ship does not have is said."""
    numbers = {
        "east": "water.drift_east",
        "arm": "water.drift_yaw_arm",
        "motor": "{thruster}.power_max",
        "keel": "keel.x",
    }
    parameters = {
        name: CauseParameter(of=[path], typical=1.0, bounds=(0.0, 1.0))
        for name, path in numbers.items()
    }
    own = Cause(cause="own", sentence="", reference="", parameters=parameters)
    finding = found(
        "own", "port", east=(3.0, "kN"), arm=(-2.0, "m"), motor=(250.0, "kW"), keel=(1.0, "m")
    )
    extension = extend(system, [finding], tmp_path, catalogue={"own": own})
    assert extension.values == {
        "own.north": 0.0, "own.east": 3000.0, "own.yaw_arm": -2.0, "port.power_max": 250e3
    }  # fmt: skip
    assert len(extension.remarks) == 1 and "no component 'keel'" in extension.remarks[0]


def test_an_extended_system_can_be_extended(extended, tmp_path):
    again = extend(extended("around").ssp, [*ABOARD, vector("tow", 1.0, 2.0, "N")], tmp_path)
    values = read_system(again.ssp).components
    assert values["tow"].start["north"] == -1500.0 and values["tow_2"].start["north"] == 1.0
    assert (
        values["instruments"].start["lever_x"] == 5.0
        and values["vessel"].start["mass_scale"] == 1.15
    )


def test_a_system_without_a_ship_is_refused(tmp_path):
    with pytest.raises(ShipcosimError, match="needs one vessel"):
        extend(new("empty"), AROUND, tmp_path)
