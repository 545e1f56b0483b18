"""Scenario files: every mistake is said with its line; expectations are judged as a reader would."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.errors import ShipcosimError
from shipcosim.scenario import Scenario, check_times, judge, read_scenario, step_times, within_run
from shipcosim.series import make_table
from shipcosim.units import whole_steps

GOOD = """\
description = "a test"
system = "small"
parameters = "heavy"
stop_time = 10.0
step_size = 0.1

[set]
"sea.height" = 0.5
"sea.seed" = 3

[[events]]
time = 2.0
override = { "ship.u" = 1, "ship.lost" = true }

[[events]]
time = 4.0
reset = ["ship.u"]

[[expect]]
signal = "ship.x"
near = 0.0
within = 0.5
during = [5.0, 10.0]

[[expect]]
signal = "ship.v"
at_most = 2.0
"""


def written(tmp_path, text):
    (tmp_path / "scenarios").mkdir(exist_ok=True)
    path = tmp_path / "scenarios" / "calm.toml"
    path.write_text(text)
    return path


def test_scenario_holds_what_the_file_says(tmp_path):
    scenario = read_scenario(written(tmp_path, GOOD))
    assert (scenario.name, scenario.stop_time, scenario.parameters) == ("calm", 10.0, ["heavy"])
    assert scenario.set == {"sea.height": 0.5, "sea.seed": 3}
    assert scenario.events[0].override == {"ship.u": 1, "ship.lost": True} and scenario.events[
        1
    ].reset == ["ship.u"]
    assert str(scenario.expect[0]) == "ship.x within 0.5 of 0 during 5 to 10 s"
    assert str(scenario.expect[1]) == "ship.v ≤ 2"


def test_system_and_parameters_are_found_in_the_project(tmp_path):
    (tmp_path / "ssp" / "small" / "resources").mkdir(parents=True)
    (tmp_path / "ssp" / "small" / "resources" / "heavy.ssv").touch()
    scenario = read_scenario(written(tmp_path, GOOD))
    assert scenario.system_path == tmp_path / "ssp" / "small"
    assert scenario.parameter_paths == [tmp_path / "ssp" / "small" / "resources" / "heavy.ssv"]
    beside = read_scenario(written(tmp_path, GOOD.replace('"small"', '"../other/boat.ssp"')))
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "boat.ssp").touch()
    assert beside.system_path.resolve() == tmp_path / "other" / "boat.ssp"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "stop_time = 10.0",
            "stop_tme = 10.0",
            "line 4: unknown key 'stop_tme'.*Did you mean 'stop_time'",
        ),
        ("stop_time = 10.0\n", "", r"calm.toml: 'stop_time' is missing"),
        (
            "step_size = 0.1",
            "step_size = -0.1",
            "line 5: step_size = -0.1. It should be greater than 0",
        ),
        ("step_size = 0.1", "step_size = true", "line 5: step_size = true. It should be a number"),
        ("step_size = 0.1", "step_size = nan", "line 5: step_size = nan"),
        (
            "step_size = 0.1",
            "step_size = 0.3",
            "line 4: stop_time = 10 s is no multiple.*The nearest would be 9.9 s",
        ),
        (
            "step_size = 0.1",
            "step_size = 20.0",
            "line 4: stop_time = 10 s is no multiple.*The nearest would be 20 s",
        ),
        (
            "time = 4.0",
            "time = 4.05",
            r"line 16: time = 4.05 s is no multiple of the step size 0.1 s",
        ),
        ('reset = ["ship.u"]', "", "line 15: The event does nothing"),
        (
            'reset = ["ship.u"]',
            'rest = ["ship.u"]',
            "line 17: unknown key 'rest'.*Did you mean 'reset'",
        ),
        ('"sea.seed" = 3', '"sea.seed" = [3]', r"line 9: \[3\] is no value"),
        ("within = 0.5", "", "line 19: `near` and `within` come together"),
        (
            "within = 0.5",
            "within = 0.5\nat_most = 1.0",
            "line 19: .*either near and within, or at_least",
        ),
        ("near = 0.0", "near = [0.0, 1.0]", "line 19: 1 signals need 1 values"),
        ("during = [5.0, 10.0]", "during = [5.0, 4.0]", "line 19: .*ends before it starts"),
        (
            "at_most = 2.0",
            'at_most = 2.0\nstatistic = "median"',
            "line 28: statistic = \"median\". It should be 'mean'",
        ),
        ("stop_time = 10.0", "stop_time = = 10.0", "line 4: is no TOML"),
    ],
)
def test_mistakes_are_said_with_their_line(tmp_path, old, new, said):
    with pytest.raises(ShipcosimError, match=said):
        read_scenario(written(tmp_path, GOOD.replace(old, new)))


def test_all_mistakes_are_said_at_once_in_the_order_of_the_file(tmp_path):
    text = (
        GOOD.replace("stop_time", "stop_tme")
        .replace("near = 0.0", "naer = 0.0")
        .replace("time = 2.0", 'time = "2"')
    )
    with pytest.raises(ShipcosimError) as error:
        read_scenario(written(tmp_path, text))
    lines = [problem.where.rpartition("line ")[2] for problem in error.value.problems[1:]]
    assert lines == ["4", "12", "21"]


def test_what_lies_after_the_end_is_remarked(tmp_path):
    scenario = read_scenario(written(tmp_path, GOOD)).model_copy(update={"stop_time": 3.0})
    said = [str(problem) for problem in check_times(scenario) if problem.severity == "remark"]
    assert "line 16: the event at 4 s never acts: the run ends at 3 s." in said[0]
    assert "line 23: during = [5.0, 10.0] reaches beyond the end of the run at 3 s." in said[1]


@pytest.mark.parametrize("start", [0.0, 6.0])
def test_a_window_that_begins_before_the_run_is_an_error(tmp_path, start):
    scenario = read_scenario(written(tmp_path, GOOD))
    late = scenario.expect[0].model_copy(update={"during": [start - 0.5, 8.0]})
    late = scenario.model_copy(update={"expect": [late]})
    found = [problem for problem in check_times(late, start) if problem.severity == "error"]
    said = f"during = [{start - 0.5}, 8.0] begins before the run, at {start:g} s."
    assert said in [problem.found for problem in found]


def test_a_scenario_in_a_folder_of_scenarios_finds_the_project(tmp_path):
    (tmp_path / "ssp" / "small").mkdir(parents=True)
    path = tmp_path / "scenarios" / "failures" / "calm.toml"
    path.parent.mkdir(parents=True)
    path.write_text(GOOD)
    scenario = read_scenario(path)
    assert scenario.project == tmp_path and scenario.system_path == tmp_path / "ssp" / "small"


def test_missing_file_is_an_error(tmp_path):
    with pytest.raises(ShipcosimError, match="cannot be read"):
        read_scenario(tmp_path / "none.toml")


def test_scenarios_of_the_project_are_sound(root):
    for path in sorted((root / "scenarios").rglob("*.toml")):
        assert read_scenario(path).expect, path


@pytest.mark.parametrize(
    ("duration", "step", "count"),
    [(1100.0, 0.05, 22000), (0.3, 0.1, 3), (1.0, 1 / 3, 3), (1.0, 0.3, None)],
)
def test_steps_are_counted_whatever_the_rounding(duration, step, count):
    assert whole_steps(duration, step) == count


@pytest.fixture
def verdict():
    """Function: verdict on one expectation of a table with x = t, y = 2 t and psi through the seam, 0 to 10 s."""
    t = np.arange(11.0)
    wrapped = (3.0 + 0.1 * t + np.pi) % (2 * np.pi) - np.pi
    columns = [
        ("x", t, "m", ""),
        ("y", 2 * t, "m", ""),
        ("psi", wrapped, "rad", ""),
        ("bad", t * np.nan, "m", ""),
    ]
    table = make_table(t, columns)

    def judged(**expect):
        (result,) = judge(
            table,
            Scenario.model_validate({"stop_time": 10.0, "step_size": 1.0, "expect": [expect]}),
        )
        return result

    return judged


@pytest.mark.parametrize(
    ("expect", "passed", "worst", "time"),
    [
        ({"signal": "x", "near": 5.0, "within": 5.0}, True, 5.0, 0.0),
        ({"signal": "x", "near": 5.0, "within": 2.0, "during": [3.0, 7.0]}, True, 2.0, 3.0),
        ({"signal": "x", "near": 4.0, "within": 2.0, "during": [3.0, 7.0]}, False, 3.0, 7.0),
        ({"signal": "x", "near": "y", "within": 9.0}, False, 10.0, 10.0),
        (
            {"signal": ["x", "y"], "near": [7.0, 16.0], "within": 5.0, "during": [10.0, 10.0]},
            True,
            5.0,
            10.0,
        ),
        (
            {"signal": ["x", "y"], "near": ["y", "x"], "within": 1.0, "during": [1.0, 1.0]},
            False,
            math.sqrt(2),
            1.0,
        ),
        (
            {"signal": "psi", "near": -3.0, "within": 0.8, "during": [0.0, 8.0]},
            True,
            6.8 - 2 * math.pi,
            8.0,
        ),
        ({"signal": "x", "at_most": 9.0}, False, 10.0, 10.0),
        ({"signal": "x", "at_least": 0.0, "at_most": 10.0}, True, None, None),
        ({"signal": "x", "at_least": 4.0, "during": [3.0, 9.0]}, False, 3.0, 3.0),
        ({"signal": "x", "near": 5.0, "within": 0.1, "statistic": "mean"}, True, 0.0, 10.0),
        ({"signal": "x", "at_most": 9.0, "statistic": "mean"}, True, 5.0, 10.0),
        ({"signal": "x", "at_least": 9.5, "statistic": "final"}, True, 10.0, 10.0),
        ({"signal": "x", "at_least": 10.0, "statistic": "max"}, True, 10.0, 10.0),
        ({"signal": "x", "at_most": 3.0, "statistic": "min", "during": [3.0, 8.0]}, True, 3.0, 3.0),
        ({"signal": "bad", "at_most": 3.0}, False, math.nan, 0.0),
        ({"signal": "x", "at_most": 99.0, "during": [20.0, 30.0]}, False, math.nan, math.nan),
    ],
)
def test_expectations_are_judged(verdict, expect, passed, worst, time):
    found = verdict(**expect)
    assert found.passed is passed
    if worst is not None:
        assert found.worst == pytest.approx(worst, nan_ok=True) and found.time == pytest.approx(
            time, nan_ok=True
        )


def test_signal_that_is_not_in_the_table_is_an_error(verdict):
    with pytest.raises(ShipcosimError, match="no signal 'vessel.x'"):
        verdict(signal="vessel.x", at_most=1.0)


def test_a_part_of_a_run_is_judged_by_what_lies_within_it():
    claims = [
        {"signal": "a.x", "at_most": 1.0},
        {"signal": "a.x", "at_most": 1.0, "during": [0.0, 4.0]},
        {"signal": "a.x", "at_most": 1.0, "during": [0.0, 6.0]},
        {"signal": "a.x", "at_most": 1.0, "statistic": "mean"},
    ]
    scenario = Scenario.model_validate({"step_size": 1.0, "stop_time": 10.0, "expect": claims})
    part, whole = (make_table(np.array([0.0, end]), []) for end in (5.0, 10.0))
    assert within_run(scenario, part) == (scenario.expect[:2], scenario.expect[2:])
    assert within_run(scenario, whole) == (scenario.expect, [])
    assert within_run(scenario, whole, planned=20.0) == (scenario.expect[:3], scenario.expect[3:])
    start = make_table(np.zeros(1), [])
    assert within_run(scenario, start) == ([], scenario.expect)


@given(
    begin=st.floats(0.0, 9.9),
    length=st.sampled_from([0.0, 0.01, 0.05, 0.1, 0.3, 1.0]),
    interval=st.sampled_from([None, 0.1, 0.3, 1.0]),
)
def test_a_window_has_a_row_or_is_an_error(begin, length, interval):
    window = [begin, min(begin + length, 10.0)]
    scenario = Scenario(
        stop_time=10.0,
        step_size=0.1,
        output_interval=interval,
        expect=[{"signal": "a", "at_most": 1.0, "during": window}],
    )
    rows = np.arange(0.0, 10.0 + 1e-6, interval or 0.1)
    has_row = ((rows > window[0] - 1e-6) & (rows < window[1] + 1e-6)).any()
    said = [problem.found for problem in check_times(scenario) if problem.severity == "error"]
    assert has_row or "lies between two rows" in said[0]
    near_a_row = np.abs(rows[:, None] - window).min() < 1e-5
    assert not said or not has_row or near_a_row


@pytest.mark.parametrize(
    ("interval", "found"),
    [
        (0.7, ["2 s are no multiple of 0.7 s: the last row is at 1.4 s."]),
        (3.0, ["2 s are no multiple of 3 s: the last row is at 0 s."]),
        (0.5, []),
        (2.0, []),
    ],
)
def test_an_interval_that_leaves_the_end_without_a_row_is_a_remark(interval, found):
    scenario = Scenario(stop_time=2.0, step_size=0.1, output_interval=interval)
    assert [problem.found for problem in check_times(scenario)] == found


EXTREMES = [5e-324, 1e-320, 1e-300, 1e-13, 1e-9, 0.1, 1.0, 1e9, 1e300, 1.7e308]


@given(
    times=st.lists(st.sampled_from(EXTREMES), min_size=4, max_size=4),
    start=st.sampled_from([0.0, -1.7e308, -1.0, 1.0, 1.7e308]),
)
@settings(max_examples=300, deadline=None)
def test_times_of_any_size_are_complaints_or_steps(times, start):
    stop_time, step_size, output_interval, event = times
    scenario = Scenario(
        stop_time=stop_time,
        step_size=step_size,
        output_interval=output_interval,
        events=[{"time": event, "override": {"a": 1.0}}],
        expect=[{"signal": "a", "at_most": 1.0, "during": [start, event]}] * (start < event),
    )
    wrong = [problem for problem in check_times(scenario, start) if problem.severity == "error"]
    if not wrong and stop_time > start:
        steps = whole_steps(stop_time - start, step_size)
        assert steps and np.diff(step_times(step_size, 0, min(steps, 10), start)).min() > 0.0


@given(
    begin=st.sampled_from([0.0, 3.0, 9.5, 10.0, 11.0]),
    length=st.sampled_from([0.0, 0.5, 5.0, 100.0]),
    stop_time=st.sampled_from([5.0, 10.0]),
)
@settings(max_examples=40, deadline=None)
def test_a_window_is_judged_only_where_all_of_it_ran(begin, length, stop_time):
    window = [begin, begin + length]
    scenario = Scenario(
        stop_time=stop_time,
        step_size=1.0,
        expect=[{"signal": "a", "at_most": 1.0, "during": window}],
    )
    table = make_table(np.arange(stop_time + 1.0), [("a", np.zeros(round(stop_time) + 1), "", "")])
    reached, late = within_run(scenario, table)
    assert bool(reached) == (window[1] <= stop_time) and bool(late) == (window[1] > stop_time)
