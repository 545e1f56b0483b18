"""Every allocator by its interface: bad input is one clear error, and what it cannot give is not piled up."""

import importlib.util
from math import hypot

import pytest
from ships import equipped

import shipcosim
from shipcosim.errors import ShipcosimError
from shipcosim.fmi import FmuError
from shipcosim.interfaces import NamedAllocator, NumberedAllocator
from shipcosim.interfaces.geometry import check_geometry

NAMED = ("allocator", "extended_allocator", "optimal_allocator")
NUMBERED = ("fixed_angle_allocator", "optimal_units_allocator")
FOUR = (
    ("x", (-14.02, -14.02, 11.0, 11.0)),
    ("y", (-2.0, 2.0, -1.5, 1.5)),
    ("azimuth", (-0.785, 0.785, -0.785, 0.785)),
)


@pytest.fixture
def allocator(root):
    """Function from the name of an FMU to its object, with the parameters of R/V Gunnerus where it is a named one."""

    def make(name):
        spec = importlib.util.spec_from_file_location(
            f"under_test_{name}", root / "fmus" / name / f"{name}.py"
        )
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        bases = (NamedAllocator, NumberedAllocator)
        kind = next(
            c
            for c in vars(module).values()
            if isinstance(c, type) and issubclass(c, bases) and c not in bases
        )
        return (
            equipped(kind(), "allocator")
            if issubclass(kind, NamedAllocator)
            else with_four_units(kind())
        )

    return make


def with_four_units(fmu):
    """Four azimuths as those of the system four_azimuths, for a law that turns units and for one that does not."""
    for k in range(4):
        values = {name: places[k] for name, places in FOUR}
        values |= {
            "thrust_min": -30e3,
            "thrust_max": 60e3,
            "thrust_rate": 1000.0,
            "azimuth_rate": 0.17,
        }
        values |= {"thrust_least": 1000.0}
        for name, value in values.items():
            if hasattr(fmu, f"{name}_{k + 1}"):
                setattr(fmu, f"{name}_{k + 1}", value)
    fmu.yaw_lever = 14.0
    return fmu


@pytest.mark.parametrize("name", NAMED)
def test_slack_is_what_is_asked_and_not_given(name, allocator):
    fmu = allocator(name)
    fmu.start()
    fmu.tau_X_cmd, fmu.tau_Y_cmd, fmu.tau_N_cmd = 5e3, -4e3, 1e5
    for i in range(400):
        fmu.step(0.05 * i, 0.05)
        given = fmu.tau_X + fmu.slack_X, fmu.tau_Y + fmu.slack_Y, fmu.tau_N + fmu.slack_N
        assert given == pytest.approx((5e3, -4e3, 1e5), abs=1e-5)
    assert (fmu.slack_X, fmu.slack_Y, fmu.slack_N) == pytest.approx((0.0, 0.0, 0.0), abs=50.0)
    assert fmu.thruster_power > 0.0 and fmu.solve_time == 0.0 and not fmu.saturated


@pytest.mark.parametrize("name", NAMED)
def test_the_time_of_the_law_is_measured_where_it_is_asked_for(name, allocator):
    fmu = allocator(name)
    fmu.measure_solve_time = True
    fmu.start()
    fmu.step(0.0, 0.05)
    assert 0.0 < fmu.solve_time < 1.0


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_request_that_is_no_number_is_refused_by_its_name(value, allocator):
    fmu = allocator("allocator")
    number = [variable.name for variable in fmu.variables].index("tau_Y_cmd")
    with pytest.raises(Exception, match="tau_Y_cmd") as error:
        fmu.set_real((number,), (value,))
    assert "finite" in str(error.value)


@pytest.mark.parametrize("value", [2, 0.5, "maybe"])
def test_availability_is_true_or_false(value):
    event = {"time": 0.0, "override": {"allocator.port_available": value}}
    with pytest.raises(
        ShipcosimError, match="'allocator.port_available' with .* Override it with true or false"
    ):
        shipcosim.run("stationkeeping", events=[event], stop_time=0.1)


@pytest.mark.parametrize("name", [*NAMED, "paper_v_allocator"])
def test_a_geometry_that_controls_no_axis_ends_a_run_with_one_sentence(name):
    """Where, what and what would be right, without a traceback: nobody has to read our code."""
    values = dict.fromkeys(("port_x", "port_y", "starboard_x", "starboard_y", "tunnel_x"), 0.0)
    given = {f"allocator.{one}": value for one, value in values.items()}
    with pytest.raises(ShipcosimError) as error:
        shipcosim.run("stationkeeping", components={"allocator": name}, set=given, stop_time=0.1)
    (problem,) = error.value.problems
    assert problem.where == "allocator" and "cannot give a yaw moment by itself" in problem.found
    assert (
        "Right would be units at different places" in problem.found
        and "Traceback" not in problem.found
    )


@pytest.mark.parametrize("name", NAMED)
def test_units_without_thrust_are_refused(name, allocator):
    fmu = allocator(name)
    fmu.azimuth_thrust_min = fmu.azimuth_thrust_max = fmu.tunnel_thrust_max = 0.0
    with pytest.raises(FmuError, match="no unit has any thrust: every largest thrust is 0 N"):
        fmu.start()


@pytest.mark.parametrize("name", NAMED)
def test_units_at_one_place_are_refused_with_the_loads_that_they_cannot_give(name, allocator):
    fmu = allocator(name)
    fmu.port_x = fmu.starboard_x = fmu.tunnel_x = -10.0
    fmu.port_y = fmu.starboard_y = 0.0
    with pytest.raises(
        FmuError, match="cannot give a force to starboard or a yaw moment by itself"
    ):
        fmu.start()


def test_numbered_units_are_checked_too(allocator):
    fmu = allocator("fixed_angle_allocator")
    for k in range(1, 5):
        setattr(fmu, f"thrust_min_{k}", 0.0)
        setattr(fmu, f"thrust_max_{k}", 0.0)
    with pytest.raises(FmuError, match="no unit has any thrust"):
        fmu.start()
    fmu.thrust_max_1, fmu.y_1, fmu.thrust_max_2, fmu.y_2 = 50.0, -0.3, 50.0, 0.3
    fmu.azimuth_1 = fmu.azimuth_2 = 0.0
    with pytest.raises(FmuError, match="cannot give a force to starboard by itself"):
        fmu.start()


def test_a_ship_with_all_three_loads_passes():
    check_geometry(
        [(1.0, 0.0, 2.0), (1.0, 0.0, -2.0), (0.0, 1.0, 10.0), (0.0, 1.0, 0.0)], [1.0, 1.0, 1.0, 0.0]
    )


@pytest.mark.parametrize("name", NAMED)
def test_the_loss_of_a_request_beyond_reach_is_shared_as_the_lever_says(name, allocator):
    missed = {}
    for lever in (1.0, 300.0):
        fmu = allocator(name)
        fmu.yaw_lever = lever
        fmu.start()
        fmu.tau_X_cmd, fmu.tau_Y_cmd, fmu.tau_N_cmd = 0.0, 90e3, 1.5e6
        for i in range(1500):
            fmu.step(0.1 * i, 0.1)
        missed[lever] = hypot(fmu.slack_X, fmu.slack_Y), abs(fmu.slack_N)
        assert fmu.saturated
    assert missed[1.0][1] < 0.8 * missed[300.0][1]  # heading first
    assert missed[300.0][0] < 0.8 * missed[1.0][0]  # position first


@pytest.mark.parametrize("name", NAMED)
def test_the_controllers_integral_does_not_run_away_while_thrust_is_at_its_limits(name):
    """20 m/s on the beam, more than the thrusters hold at first: the bias load sinks although much is missed."""
    calm = {
        "environment.wind_speed": 20.0,
        "environment.significant_wave_height": 0.0,
        "environment.gust_scale": 0.0,
    }
    run = shipcosim.run("stationkeeping", components={"allocator": name}, set=calm, stop_time=90.0)
    early, late = run.sel(time=40.0), run.sel(time=90.0)
    assert float(abs(early["allocator.slack_Y"])) > 5e3
    for axis in "YN":
        assert abs(late[f"controller.tau_{axis}_bias"]) < 0.6 * abs(
            early[f"controller.tau_{axis}_bias"]
        )


def test_the_controllers_integral_does_not_run_away_with_numbered_units():
    """The same: 17 kN and 150 kNm are missed after 20 s, and the bias load is gone at 60 s."""
    calm = {
        "environment.wind_speed": 20.0,
        "environment.significant_wave_height": 0.0,
        "environment.gust_scale": 0.0,
    }
    run = shipcosim.run("allocation/four_azimuths", set=calm, stop_time=60.0)
    early, late = run.sel(time=20.0), run.sel(time=60.0)
    assert float(abs(early["allocator.slack_Y"])) > 5e3
    for axis in "YN":
        assert abs(late[f"controller.tau_{axis}_bias"]) < 0.6 * abs(
            early[f"controller.tau_{axis}_bias"]
        )


@pytest.mark.parametrize("name", NUMBERED)
def test_numbered_units_share_the_loss_as_the_lever_says(name, allocator):
    missed = {}
    for lever in (1.0, 300.0):
        fmu = allocator(name)
        fmu.yaw_lever = lever
        fmu.start()
        asked(fmu, 0.0, 250e3, 1.5e6, steps=1000)
        missed[lever] = hypot(fmu.slack_X, fmu.slack_Y), abs(fmu.slack_N)
        assert fmu.saturated
    assert missed[1.0][1] < 0.8 * missed[300.0][1]  # heading first
    assert missed[300.0][0] < 0.8 * missed[1.0][0]  # position first


@pytest.mark.parametrize("name", (*NUMBERED, *NAMED))
def test_a_request_beyond_reach_leaves_nothing_behind(name, allocator):
    """No law has an integral of its own: after what nobody can give, thrusts come back as quickly as they may."""
    fmu = allocator(name)
    fmu.start()
    asked(fmu, 0.0, 400e3, 4e6, steps=1500)
    assert hypot(fmu.slack_X, fmu.slack_Y) > 50e3
    asked(fmu, 3e3, 4e3, 2e4, steps=1000)  # 100 s, and 60 s from end to end at 1000 N/s
    assert (fmu.slack_X, fmu.slack_Y, fmu.slack_N) == pytest.approx((0.0, 0.0, 0.0), abs=50.0)


def test_the_network_of_paper_v_shares_no_loss_but_says_what_it_misses(allocator):
    """No weight reaches it: the same commands with both levers, and the controller is told what they give."""
    given = []
    for lever in (1.0, 300.0):
        fmu = allocator("paper_v_allocator")
        fmu.yaw_lever = lever
        fmu.start()
        asked(fmu, 0.0, 90e3, 1.5e6, steps=100)
        assert (fmu.tau_Y + fmu.slack_Y, fmu.tau_N + fmu.slack_N) == pytest.approx((90e3, 1.5e6))
        assert fmu.slack_Y > 50e3
        given.append((fmu.tau_X, fmu.tau_Y, fmu.tau_N))
    assert given[0] == given[1]


def asked(fmu, X, Y, N, steps):
    """A request, held for some tenths of a second."""
    fmu.tau_X_cmd, fmu.tau_Y_cmd, fmu.tau_N_cmd = X, Y, N
    for i in range(steps):
        fmu.step(0.1 * i, 0.1)
