"""Third-party thrusters: their surrogates are made by co-simulation, and what is wrong with them is named."""

from dataclasses import replace
from functools import cache
from tempfile import mkdtemp
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from diagnose import boat, twin

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.ship import inputs, ship_of_system
from shipcosim.diagnose.ship.dynamics import loads
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.surrogate_building import fitted_thrust, with_surrogates
from shipcosim.diagnose.ship.third_party_fmu import drives_of
from shipcosim.diagnose.ship.thrusters import dp_thruster_of
from shipcosim.errors import ShipcosimError
from shipcosim.models.core.motion import Motion


@cache
def logged(minutes=6.0, seed=0, **factors):
    return boat.log(minutes, seed, boat.structure(**factors))


@cache
def along(minutes=6.0):
    """The boat with the laws of her propellers along a log: ship model, record, motion."""
    model = ship_model_of(boat.structure().checked())
    return with_laws(model, logged(minutes))


def with_laws(model, log):
    record = record_of(log, model)
    motion = first_motion(record)
    return with_surrogates(model, record, motion), record, motion


def at_rows(model, record, motion):
    """Loads at each row but the last."""
    return loads(Motion(*(value[:-1] for value in motion)), record.inputs(model), model)


def closed_form(side, n, u, r, gain=boat.GAIN):
    """Push of the propeller, and its moment, by the equations of its FMU."""
    aside = boat.SIDES[side]
    speed = 0.8 * (u - aside * r)
    push = gain * (np.where(n > 0.0, 1.0, 0.7) * n * np.abs(n) - np.abs(n) * speed / 1.5)
    return push, -aside * push


def pushes(motion, record, side, off=0.0, **changed):
    n = record.units[side][0][:-1]
    return closed_form(side, n + off, motion.u[:-1], motion.r[:-1], **changed)


@pytest.mark.parametrize("side", boat.SIDES)
def test_along_the_log_the_load_is_that_of_the_fmu(side):
    model, record, motion = along()
    X, Y, N = at_rows(model, record, motion)[side]
    push, moment = pushes(motion, record, side)
    np.testing.assert_allclose(X, push, atol=1e-6 * np.abs(push).max())
    np.testing.assert_allclose(N, moment, atol=1e-6 * np.abs(moment).max())
    assert not Y.any()


def test_loads_that_are_kept_are_those_of_their_times():
    """A surrogate keeps what it has looked up last: after more times than it keeps the first are looked up anew."""
    model, record, motion = along()
    part, surrogate = model.parts["left"], replace(model.third_party["left"].built_surrogate)
    given = motion._asdict() | {"u_r": motion.u, "v_r": motion.v} | drives_of(*record.units["left"])
    early = [surrogate.loads(record.time - shift, given, part) for shift in range(8)]
    again = [replace(surrogate).loads(record.time - shift, given, part) for shift in range(8)]
    np.testing.assert_array_equal(early, again)
    np.testing.assert_array_equal(surrogate.loads(record.time, given, part), early[0])
    assert np.any(np.array(early[0]) != np.array(early[7])) and len(surrogate.met) <= 4


def test_beside_the_log_the_load_changes_as_that_of_the_fmu():
    model, record, motion = along()
    moved = motion._replace(u=motion.u + 0.2, r=motion.r - 0.05)
    change = at_rows(model, record, moved)["left"][0] - at_rows(model, record, motion)["left"][0]
    right = pushes(moved, record, "left")[0] - pushes(motion, record, "left")[0]
    np.testing.assert_allclose(change, right, atol=1e-3 * np.abs(right).max())


def test_its_numbers_change_the_load_as_they_say():
    model, record, motion = along()
    push, _ = pushes(motion, record, "left")

    def found(**values):
        return at_rows(
            model.with_values({f"left.{k}": v for k, v in values.items()}), record, motion
        )["left"][0]

    np.testing.assert_allclose(found(thrust_loss=0.3), 0.7 * push, atol=1e-3)
    np.testing.assert_allclose(
        found(gain=7.0), pushes(motion, record, "left", gain=7.0)[0], atol=1e-3
    )
    late = pushes(motion, record, "left", off=-0.5)[0]
    np.testing.assert_allclose(found(rpm_offset=30.0), late, atol=0.02 * np.abs(push).max())


def test_a_speed_of_the_other_sign_gets_about_the_load_of_the_fmu():
    """Far from what it was linearised about, the quadratic law of thrust holds."""
    model, record, motion = along()
    n, azimuth = record.units["left"]
    inputs = record.inputs(model)._replace(
        units=record.inputs(model).units | {"left": (-n[:-1], azimuth[:-1])}
    )
    X, _, _ = loads(Motion(*(value[:-1] for value in motion)), inputs, model)["left"]
    right, _ = closed_form("left", -n[:-1], motion.u[:-1], motion.r[:-1])
    assert np.sqrt(np.mean((X - right) ** 2)) < 0.3 * np.sqrt(np.mean(right**2))


def test_bollard_law_of_a_unit_that_turns_is_found_with_its_place():
    random = np.random.default_rng(0)
    rpm, azimuth = random.uniform(-200.0, 300.0, 400), random.uniform(-3.0, 3.0, 400)
    thrust = np.where(rpm > 0.0, 2.0, 1.3) * rpm * np.abs(rpm)
    X, Y = thrust * np.cos(azimuth), thrust * np.sin(azimuth)
    assert fitted_thrust(np.stack([X, Y, -7.0 * Y - 1.5 * X]), rpm, azimuth, True) == pytest.approx(
        (2.0, 1.3, 0.0, -7.0, 1.5)
    )
    across = fitted_thrust(np.stack([0.0 * thrust, -thrust, -4.0 * thrust]), rpm, 0.0 * rpm, False)
    assert across == pytest.approx((2.0, 1.3, -0.5 * np.pi, 4.0, 0.0), abs=1e-9)


def test_a_dp_knows_where_it_pushes_and_leaves_alone_what_does_not():
    model, record, motion = along()
    left = dp_thruster_of(model, "left")
    assert (left.x, left.y, left.axis) == pytest.approx((0.0, -0.9, 0.0), abs=1e-9)
    assert left.ahead == pytest.approx(boat.GAIN, rel=0.2)
    still, *_ = with_laws(
        ship_model_of(boat.structure().checked()), logged().assign(left_rpm=0.0 * logged().left_rpm)
    )
    assert dp_thruster_of(still, "left").ahead == 0.0 and dp_thruster_of(still, "right").ahead > 0.0


def test_suspects_and_tolerances_are_those_that_it_has():
    model, *_ = along()
    found = {hypothesis.label: hypothesis for hypothesis in hypotheses_of(read_catalogue(), model)}
    assert {"thrust_loss of left", "rpm_offset of right", "mass"} <= set(found)
    assert not {"azimuth_offset of left", "reverse_loss"} & set(found)
    fastest = np.abs(logged().left_rpm.values).max()
    assert found["rpm_offset of left"].parameters[0].typical == pytest.approx(
        0.06 * fastest, rel=0.02
    )
    assert model.tolerances["left.gain"] == pytest.approx(boat.TOLERANCE)


def test_a_law_is_kept_for_a_part_of_its_log_and_made_anew_for_other_drivers():
    model, *_ = along()
    part = logged().isel(time=slice(100, 300))
    assert (
        with_laws(model, part)[0].third_party["left"].surrogate
        is model.third_party["left"].surrogate
    )
    other = part.assign(left_rpm=part.left_rpm.copy(data=-part.left_rpm.values))
    again = with_laws(model, other)[0].third_party
    assert again["left"].surrogate is not model.third_party["left"].surrogate
    assert again["right"].surrogate is model.third_party["right"].surrogate


@pytest.fixture
def strange_azimuths(monkeypatch):
    """Our azimuth thrusters are taken for somebody else's, once the logs of our ship are made."""
    twin.model(), twin.logs()
    known = ship_of_system._holds
    unmodelled = lambda c, kind: "azimuth_in" not in c.fmu.variables and known(c, kind)  # noqa: E731
    monkeypatch.setattr(ship_of_system, "_holds", unmodelled)


def test_our_azimuth_as_a_black_box_has_the_loads_of_the_array_form(strange_azimuths):
    model, record, motion = with_laws(ship_model_of(twin.system()), twin.logs()["healthy"])
    assert list(model.third_party) == ["port", "starboard"]
    for name in model.third_party:
        most = np.abs(at_rows(twin.model(), record, motion)[name]).max(axis=1)
        assert (missed(model, record, motion, name, 0.0) < 1e-9 * most).all()
        near, far = (missed(model, record, motion, name, by) for by in (0.05, 0.2))
        assert (far < 0.03 * most).all() and (
            near < far / 8.0
        ).all()  # of second order: a sixteenth


def missed(model, record, motion, name, by):
    """How far off the loads of a black box are where the ship is so much faster, root mean square by axis."""
    moved = motion._replace(u=motion.u + by, v=motion.v - 0.5 * by)
    found, right = (np.stack(at_rows(ship, record, moved)[name]) for ship in (model, twin.model()))
    return np.sqrt(np.mean((found - right) ** 2, axis=1))


LOSS = Finding("thrust_loss", "left", parameters={"loss": ParameterEstimate(0.25, 0.02, "1")})
TACHO = Finding("rpm_offset", "right", parameters={"offset": ParameterEstimate(30.0, 2.0, "rpm")})


def test_the_extended_boat_has_it_on_her_connections(tmp_path):
    extension = extend(boat.structure(), [LOSS, TACHO], tmp_path)
    inputs = logged()[["left_rpm", "right_rpm"]]
    plain, extended = (
        sc.simulate(system, stop_time=60.0, step_size=0.1, inputs=inputs)
        for system in (boat.structure(), sc.read(extension.ssp))
    )
    n = (extended["right_rpm"].values[:-1] - 30.0) / 60.0
    push, _ = closed_form(
        "right", n, extended["boat.u_r"].values[:-1], extended["boat.r"].values[:-1]
    )
    np.testing.assert_allclose(extended["right.push"].values[1:], push, rtol=1e-9)
    ends = [end for end in sc.read(extension.ssp).checked().connections if end.source[0] == "left"]
    assert [end.factor for end in ends] == [0.75, 0.75]
    assert np.abs(extended["boat.psi"].values[-1] - plain["boat.psi"].values[-1]) > 0.1
    assert extension.values == {} and extension.remarks == (
        "thrust_loss of left: carried as factor 0.750 on the connections of its loads.",
        "rpm_offset of right: carried as offset of -30 rpm on the connection of its rpm.",
    )


def test_a_line_that_only_the_motion_of_the_ship_drives_is_a_load_and_no_thruster(root):
    ship = sc.read(root / "ssp" / "gunnerus_open", fmus=[twin.build_stale(root)])
    ship.add_component(
        "line", sc.build_fmu(root / "docs" / "examples" / "line", mkdtemp(prefix="shipcosim-"))
    )
    for name in ("x", "y", "psi"):
        ship.connect(f"vessel.{name}", f"line.{name}")
    for axis in "XYN":
        ship.connect(f"line.tau_{axis}", f"vessel.tau_{axis}_4")
    model, record, motion = with_laws(ship_model_of(ship.checked()), twin.logs()["healthy"])
    assert model.thrusters == ["port", "starboard", "tunnel"]
    X, Y, N = at_rows(model, record, motion)["line"]
    north = -117.0 - motion.x + 17.0 * np.cos(motion.psi)
    east = -motion.y + 17.0 * np.sin(motion.psi)
    tension = 5000.0 * np.maximum(np.hypot(north, east) - 99.0, 0.0)
    np.testing.assert_allclose(np.hypot(X, Y), tension[:-1], atol=1e-6 * tension.max())
    np.testing.assert_allclose(N, -17.0 * Y, atol=1e-6 * np.abs(N).max())


def test_a_stranger_that_nothing_of_a_log_feeds_is_refused_with_what_would_be_right():
    ship = boat.structure()
    for target in ("left.shaft", "left.way", "left.swing"):
        ship.disconnect(target)
    with pytest.raises(
        ShipcosimError, match=r"'left' \(screw\) puts a load on 'boat'.*its speed by 'left_rpm'"
    ):
        ship_model_of(ship.checked())


def test_a_log_without_its_speed_is_refused_and_one_with_it_is_said_what_it_rests_on():
    model, record, _ = along()
    assert any("'left' is a third-party FMU (screw)" in remark for remark in record.remarks)
    with pytest.raises(ShipcosimError, match="no channel left_rpm, which drives 'left'"):
        record_of(logged().drop_vars("left_rpm"), model)


def test_what_nobody_logs_keeps_its_start_value_and_that_is_said(strange_azimuths):
    model = ship_model_of(twin.system())
    assert set(model.third_party["port"].idle) == {"neighbour_rpm", "neighbour_azimuth"}
    assert any(
        "neighbour_rpm" in remark for remark in record_of(twin.logs()["healthy"], model).remarks
    )


def test_a_case_of_the_boat_is_prepared_with_her_laws():
    problem = identification_problem(
        logged(), ship_model_of(boat.structure().checked()), read_catalogue()
    )
    assert all(one.surrogate for one in problem.model.third_party.values())
    assert {"left.gain", "left.rpm_offset", "left.thrust_loss"} <= set(problem.model.tolerances)


def with_input(ship, name, unit, target="left.shaft"):
    """The boat whose left shaft is fed by an input of another name."""
    with ship.changes():
        ship.disconnect(target)
        ship.add_connector(name, "input", unit=unit)
        ship.connect(name, target)
    return ship


def test_an_input_of_another_name_is_known_by_its_unit_and_its_factor_followed():
    ship = with_input(boat.structure(), "throttle", "rad/s")
    (link,) = [
        link
        for link in ship_model_of(ship.checked()).third_party["left"].links
        if link.quantity == "rpm"
    ]
    assert (link.variable, link.factor) == ("shaft", pytest.approx(2.0 * np.pi / 60.0))
    ship.disconnect("throttle", "left.shaft")
    ship.connect("throttle", "left.shaft", factor=0.5, offset=3.0)
    (link,) = [
        link
        for link in ship_model_of(ship.checked()).third_party["left"].links
        if link.quantity == "rpm"
    ]
    assert (link.factor, link.offset) == (pytest.approx(np.pi / 60.0), 3.0)


def test_two_inputs_that_could_be_the_speed_are_refused_by_name():
    ship = with_input(with_input(boat.structure(), "engine", "rpm"), "rate", "rad/s", "left.swing")
    with pytest.raises(
        ShipcosimError, match="'left' .*any of shaft, swing could be what drives it"
    ):
        ship_model_of(ship.checked())


POD = """
from math import cos, radians, sin

from shipcosim.fmi import Fmu, Input, Output


class Pod(Fmu):
    \"\"\"Pushes as it is told, where it is told.\"\"\"

    wanted = Input("N", "thrust")
    angle = Input("deg", "direction of the thrust")
    ahead = Output("kN", "force ahead")
    aside = Output("kN", "force to starboard")

    def start(self):
        self.ahead = 0.9e-3 * self.wanted * cos(radians(self.angle))
        self.aside = 0.9e-3 * self.wanted * sin(radians(self.angle))

    def step(self, t, h):
        self.start()
"""


@pytest.fixture
def podded(tmp_path):
    """The boat with a pod at her origin that is told its thrust and its direction."""
    (tmp_path / "pod.py").write_text(POD, encoding="utf-8")
    ship = boat.structure()
    with ship.changes():
        ship.add_component("pod", sc.build_fmu(tmp_path / "pod.py", tmp_path))
        for role, unit, variable in (("thrust", "kN", "wanted"), ("azimuth", "rad", "angle")):
            ship.add_connector(f"pod_{role}", "input", unit=unit)
            ship.connect(f"pod_{role}", f"pod.{variable}")
        ship.connect("pod.ahead", "boat.tau_X_3")
        ship.connect("pod.aside", "boat.tau_Y_3")
    return ship


def test_a_unit_that_is_told_its_thrust_is_followed_by_the_thrust_of_the_log(podded):
    model = ship_model_of(podded.checked())
    assert model.drives("pod") == ("thrust", "azimuth") and not model.has("pod.rpm_offset")
    log = logged().assign(
        pod_thrust=200.0 + logged().left_rpm, pod_azimuth=0.2 * logged().right_rpm
    )
    model, record, motion = with_laws(model, log)
    wanted, azimuth = (series[:-1] for series in record.units["pod"])
    X, Y, N = at_rows(model.with_values({"pod.thrust_loss": 0.5}), record, motion)["pod"]
    np.testing.assert_allclose(X, 0.45 * wanted * np.cos(azimuth), atol=1e-6 * wanted.max())
    np.testing.assert_allclose(Y, 0.45 * wanted * np.sin(azimuth), atol=1e-6 * wanted.max())
    assert wanted.max() > 500.0 and np.ptp(azimuth) > 2.0 and not N.any()
    assert dp_thruster_of(model, "pod").ahead == 0.0


def test_an_offset_of_its_direction_goes_to_the_connection_in_the_units_on_the_way(
    podded, tmp_path
):
    off = Finding(
        "azimuth_offset", "pod", parameters={"offset": ParameterEstimate(8.0, 0.3, "deg")}
    )
    extension = extend(podded, [off], tmp_path)
    run = sc.simulate(
        sc.read(extension.ssp),
        stop_time=0.2,
        step_size=0.1,
        set={"pod_thrust": 1.0, "pod_azimuth": np.radians(20.0)},
    )
    np.testing.assert_allclose(
        run["pod.ahead"].values[-1], 0.9 * np.cos(np.radians(28.0)), rtol=1e-9
    )
    np.testing.assert_allclose(
        run["pod.aside"].values[-1], 0.9 * np.sin(np.radians(28.0)), rtol=1e-9
    )


MINE = """
cause = "worn_blades"
sentence = "Blades have lost their edge"
reference = "-"
for_each = "thruster"

[parameters.gain]
of = ["{thruster}.gain"]
unit = "kg.m"
typical = 0.2
relative_to = "{thruster}.gain"
bounds = [0.3, 1.2]
"""


def test_a_cause_of_ones_own_can_turn_a_parameter_that_has_a_tolerance(tmp_path):
    (tmp_path / "worn_blades.toml").write_text(MINE, encoding="utf-8")
    found = hypotheses_of(read_catalogue(tmp_path), along()[0])
    parameters = {
        hypothesis.component: hypothesis.parameters[0]
        for hypothesis in found
        if hypothesis.cause == "worn_blades"
    }
    assert set(parameters) == set(boat.SIDES)
    assert (parameters["left"].neutral, parameters["left"].tolerance) == (
        boat.GAIN,
        pytest.approx(boat.TOLERANCE),
    )


def test_a_thruster_that_follows_what_no_log_can_tell_is_refused_by_name():
    """As the one by a measured map, whose command can be anything."""
    fmu = SimpleNamespace(model_name="mapped_thruster")
    left = SimpleNamespace(drives=(), idle=("command_in",), component=SimpleNamespace(fmu=fmu))
    log = xarray.Dataset({"surge": ("time", [0.0])}, {"time": [0.0]})
    with pytest.raises(
        ShipcosimError, match="left: mapped_thruster follows command_in.*another kind"
    ):
        inputs._check_third_party(log, SimpleNamespace(third_party={"left": left}))
