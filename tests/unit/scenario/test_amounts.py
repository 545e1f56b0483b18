"""Units in what people write: amounts in scenarios become numbers in the unit of what they are for, or one error."""

import math

import numpy as np
import pytest

import shipcosim as sc
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.scenario import (
    Scenario,
    check_scenario,
    judge,
    odd_values,
    read_scenario,
    units_of,
    with_numbers,
)
from shipcosim.series import make_table
from shipcosim.ssp import read_system, with_values

TIMES = {"stop_time": 10.0, "step_size": 1.0}


@pytest.fixture(scope="module")
def fmus(root):
    """FMUs of the project, built where they are out of date."""
    return build_stale(root)


@pytest.fixture(scope="module")
def dp(root, fmus):
    """The positioned Gunnerus."""
    return read_system(root / "ssp" / "gunnerus_dp", fmus=[fmus])


def problems(dp, **keys):
    """What a check says of a scenario of these keys, as texts."""
    scenario = Scenario.model_validate(TIMES | keys)
    return [str(problem) for problem in check_scenario(scenario, with_values(dp, scenario.set))]


def test_start_values_take_units(dp):
    given = {
        "environment.wind_from": "45 deg",
        "environment.wind_speed": "10 kn",
        "vessel.mass": "550 t",
    }
    system = with_values(dp, given)
    assert system.components["environment"].start["wind_from"] == pytest.approx(math.pi / 4)
    assert system.components["environment"].start["wind_speed"] == pytest.approx(5.14444, abs=1e-5)
    assert system.components["vessel"].start["mass"] == 550e3


def test_start_values_of_another_kind_are_refused_together(dp):
    given = {"environment.wind_from": "10 kn", "vessel.mass": "5 m", "environment.seed": "4 s"}
    with pytest.raises(ShipcosimError) as error:
        with_values(dp, given, "--set")
    assert [str(problem).split(" Write")[0] for problem in error.value.problems] == [
        "--set: environment.wind_from: '10 kn' is in kn, where rad is wanted: they measure different things.",
        "--set: vessel.mass: '5 m' is in m, where kg is wanted: they measure different things.",
        "--set: environment.seed: '4 s' is no Integer. Give a whole number.",
    ]


def test_a_run_with_units_is_the_run_with_numbers(dp):
    one, other = (
        sc.simulate(
            dp, stop_time=10.0, step_size=0.5, set={"environment.wind_speed": speed}, events=[event]
        )
        for speed, event in (
            (10 * 1852 / 3600, {"time": 5.0, "override": {"environment.wind_from": math.pi / 2}}),
            ("10 kn", {"time": "5000 ms", "override": {"environment.wind_from": "90 deg"}}),
        )
    )
    assert one.sizes["time"] == 21
    for name in one.data_vars:
        np.testing.assert_allclose(
            other[name].values, one[name].values, rtol=1e-12, atol=1e-12, err_msg=str(name)
        )


def test_times_take_units_and_are_said_in_seconds(tmp_path):
    path = tmp_path / "one.toml"
    path.write_text(
        'stop_time = "10 min"\nstep_size = "50 ms"\noutput_interval = "0.5 s"\n[[events]]\ntime = "2 min"\n'
        'reset = ["a.b"]\n[[expect]]\nsignal = "a.b"\nat_most = 1\nduring = ["5 min", "10 min"]\n'
    )
    scenario = read_scenario(path)
    assert (scenario.stop_time, scenario.step_size, scenario.output_interval) == (600.0, 0.05, 0.5)
    assert scenario.events[0].time == 120.0 and scenario.expect[0].during == [300.0, 600.0]
    path.write_text('stop_time = "10 m"\nstep_size = "soon"\n')
    with pytest.raises(ShipcosimError) as error:
        read_scenario(path)
    first, second = error.value.problems
    assert first.where.endswith("line 1") and "'10 m' is in m, where s is wanted" in first.found
    assert second.where.endswith("line 2") and second.found == 'step_size = "soon".'


def test_events_take_units(dp):
    event = {
        "time": 1.0,
        "override": {"environment.wind_from": "90 deg"},
        "bias": {"environment.wind_speed": "1 kn"},
    }
    scenario = with_numbers(Scenario.model_validate(TIMES | {"events": [event]}), units_of(dp))
    assert scenario.events[0].override == {"environment.wind_from": pytest.approx(math.pi / 2)}
    assert scenario.events[0].bias == {"environment.wind_speed": pytest.approx(1852 / 3600)}
    assert problems(dp, events=[event]) == []


def test_an_event_of_another_kind_is_one_error(dp):
    event = {"time": 1.0, "override": {"environment.wind_from": "10 kn"}}
    (said,) = problems(dp, events=[event])
    assert "override of 'environment.wind_from': '10 kn' is in kn, where rad is wanted" in said


@pytest.fixture
def table():
    """x = t in m, far = t/1000 in km, psi from 179 to 189 deg in rad and in deg, wrapped, over 0 to 10 s."""
    t = np.arange(11.0)
    degrees = (179.0 + t + 180.0) % 360.0 - 180.0
    columns = [
        ("a.x", t, "m", ""),
        ("a.y", t, "m", ""),
        ("far.x", t / 1e3, "km", ""),
        ("speed", t, "m/s", ""),
    ]
    columns += [
        ("a.psi", np.radians(degrees), "rad", ""),
        ("a.course", degrees, "deg", ""),
        ("plain", t, "", ""),
    ]
    return make_table(t, columns)


@pytest.mark.parametrize(
    ("expect", "passed", "worst"),
    [
        ({"signal": "a.x", "near": "0.005 km", "within": "500 cm"}, True, 5.0),
        ({"signal": "a.x", "near": "0.005 km", "within": "499 cm"}, False, 5.0),
        ({"signal": "a.psi", "near": "-175 deg", "within": "6.01 deg"}, True, math.radians(6.0)),
        ({"signal": "a.psi", "near": "-175 deg", "within": "5.99 deg"}, False, math.radians(6.0)),
        ({"signal": "a.course", "near": -175.0, "within": 6.01}, True, 6.0),
        ({"signal": "a.psi", "near": "a.course", "within": "1e-6 deg"}, True, 0.0),
        ({"signal": "speed", "at_most": "36.01 km/h"}, True, None),
        ({"signal": "speed", "at_most": "35.9 km/h"}, False, 10.0),
        ({"signal": "a.x", "near": "far.x", "within": "1 mm"}, True, 0.0),
        (
            {
                "signal": ["a.x", "far.x"],
                "near": [10.0, "10 m"],
                "within": 0.1,
                "statistic": "final",
            },
            True,
            0.0,
        ),
        (
            {"signal": ["a.x", "far.x"], "near": [0.0, 0.0], "within": "15 m"},
            True,
            math.hypot(10, 10),
        ),
    ],
)
def test_expectations_take_units(table, expect, passed, worst):
    (verdict,) = judge(table, Scenario.model_validate(TIMES | {"expect": [expect]}))
    assert verdict.passed is passed
    assert worst is None or verdict.worst == pytest.approx(worst, abs=1e-9)


@pytest.mark.parametrize(
    ("expect", "said"),
    [
        (
            {"signal": ["a.x", "a.psi"], "near": [0.0, 0.0], "within": 1.0},
            "a.x is in m and a.psi is in rad: no distance",
        ),
        (
            {"signal": "a.x", "near": "a.psi", "within": 1.0},
            "a.x is in m and a.psi is in rad: they measure different",
        ),
        (
            {"signal": "a.x", "near": 0.0, "within": "1 deg"},
            "within of a.x: '1 deg' is in deg, where m is wanted",
        ),
        (
            {"signal": "a.psi", "at_most": "1 m"},
            "at_most of a.psi: '1 m' is in m, where rad is wanted",
        ),
        ({"signal": "plain", "at_most": "1 m"}, "where no unit is wanted"),
        ({"signal": "a.x", "at_least": 5.0, "at_most": 1.0}, "at_least = 5.0 lies above at_most"),
        ({"signal": "a.x", "at_least": "1 km", "at_most": 2.0}, "at_least = 1 km lies above"),
    ],
)
def test_what_cannot_be_compared_is_refused(table, expect, said):
    scenario = Scenario.model_validate(TIMES | {"expect": [expect]})
    with pytest.raises(ShipcosimError, match=said) as error:
        judge(table, scenario)
    assert len(error.value.problems) == 1 and error.value.problems[0].remedy


def test_signals_without_a_unit_are_compared_with_anything(table):
    expect = {"signal": ["a.x", "plain"], "near": [0.0, 0.0], "within": 15.0}
    assert judge(table, Scenario.model_validate(TIMES | {"expect": [expect]}))[0].passed


def test_a_check_says_where_units_are_mixed(dp, tmp_path):
    path = tmp_path / "mixed.toml"
    path.write_text(
        "stop_time = 10.0\nstep_size = 1.0\n[[expect]]\n"
        'signal = ["vessel.x", "vessel.psi"]\nnear = [0.0, 0.0]\nwithin = 1.0\n'
    )
    (problem,) = check_scenario(read_scenario(path), dp)
    assert problem.where == f"{path}, line 4"
    assert problem.found == "vessel.x is in m and vessel.psi is in rad: no distance spans the two."
    assert problem.remedy == "Write an expectation for each."


@pytest.mark.parametrize(
    ("set_", "said"),
    [
        (
            {"environment.wind_from": 45.0},
            "environment.wind_from: 45 rad is more than a whole turn. If degrees are",
        ),
        (
            {"environment.wind_from": -10},
            "environment.wind_from: -10 rad is more than a whole turn",
        ),
        ({"vessel.mass": 1.0}, "vessel.mass: 1 kg is very little"),
        ({"vessel.mass": "1 kg"}, None),
        ({"vessel.mass": 6e9}, "vessel.mass: 6e+09 kg is very much"),
        ({"environment.wind_speed": 100.0}, "environment.wind_speed: 100 m/s is very much"),
        ({"environment.wind_from": 6.28}, None),
        ({"environment.wind_from": "400 deg"}, None),
        ({"environment.wind_speed": 30.0, "vessel.mass": 15.0}, None),
    ],
)
def test_values_that_are_hardly_meant_earn_a_remark(dp, set_, said):
    found = problems(dp, set=set_)
    assert len(found) == (said is not None) and (said is None or said in found[0])


def test_a_bare_angle_in_an_event_earns_a_remark_and_degrees_none(dp):
    bare, with_unit = (
        {"time": 1.0, "override": {"environment.wind_from": value}} for value in (45, "45 deg")
    )
    (said,) = problems(dp, events=[bare])
    assert (
        'environment.wind_from: 45 rad is more than a whole turn. If degrees are meant, write "45 deg".'
        in said
    )
    assert problems(dp, events=[with_unit]) == []


def test_a_negative_wind_speed_of_an_event_earns_a_remark(dp):
    (said,) = problems(dp, events=[{"time": 1.0, "override": {"environment.wind_speed": -5.0}}])
    assert "environment.wind_speed: -5 m/s is negative." in said


WIND = {"environment.wind_speed": 5.0}


@pytest.mark.parametrize(
    ("events", "replaced"),
    [
        ([(1.0, "override"), (1.0, "override")], ["the override of environment.wind_speed at 1 s"]),
        ([(2.0, "bias"), (1.0, "override"), (2.0, "override")], ["the bias of"]),
        ([(1.0, "override"), (2.0, "override"), (3.0, "bias")], []),
    ],
)
def test_a_change_in_whose_place_another_comes_at_the_same_time_is_named(dp, events, replaced):
    found = problems(dp, events=[{"time": time, verb: WIND} for time, verb in events])
    assert [any(text in one for one in found) for text in replaced] == [True] * len(found)


def test_a_bias_beside_an_override_in_one_event_is_named(dp):
    (said,) = problems(dp, events=[{"time": 1.0, "override": WIND, "bias": WIND}])
    assert "the override of environment.wind_speed at 1 s has no effect" in said
    assert "A later bias at the same time takes its place" in said


def test_nothing_of_what_is_shipped_is_odd(root, fmus):
    """The bounds hold for four craft of 15 kg to 300 000 t."""
    for structure in sorted((root / "ssp").glob("*/SystemStructure.ssd")):
        system = read_system(structure.parent, fmus=[fmus])
        assert list(odd_values(Scenario.model_validate(TIMES), system)) == [], system.name
