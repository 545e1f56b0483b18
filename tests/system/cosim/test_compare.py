"""The comparison of engines: what it measures, and that it finds in words what was done to a table."""

import json
import re
import shutil

import numpy as np
import pytest
from typer.testing import CliRunner

from shipcosim.cli import app
from shipcosim.cli.comparison import MOST_SHOWN
from shipcosim.cosim import ENGINES, RunError, engines_missing, simulate
from shipcosim.cosim.compare import compare, halved
from shipcosim.cosim.differences import explained
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.series import make_table

LOOP = {"plant": ("integrator", {"y_start": 0.3}), "law": ("gain", {"factor": -0.9})}
CONNECTIONS = ["plant.y -> law.u", "law.y -> plant.u"]
OURS = ENGINES["fmpy"]


@pytest.fixture
def loop(make_system):
    return make_system(LOOP, CONNECTIONS)


def set_engines(monkeypatch, engines):
    """Let these be the only engines."""
    for name in list(ENGINES):
        monkeypatch.delitem(ENGINES, name)
    for name, run in engines.items():
        monkeypatch.setitem(ENGINES, name, run)


def by_name(comparison):
    return {signal.name: signal for signal in comparison.signals}


def altered(name, change):
    """An engine that is ours with one signal changed."""

    def run(system, scenario, options):
        table = OURS(system, scenario, options)
        table[name].values[:] = change(table[name].values)
        return table

    return run


def test_installed_engines_agree(loop, make_scenario):
    comparison = compare(loop, make_scenario(5.0, 0.05))
    assert comparison.agree and set(comparison.seconds) == set(ENGINES) - {"auto", "native"} - set(
        engines_missing()
    )
    assert not any(comparison.remarks.values())


def test_step_size_error_is_that_of_the_closed_form(loop, make_scenario):
    """A delay of the loop by a step h turns exp(-0.9 t) into the solution of y(k+1) = y(k) - 0.9 h y(k-1)."""

    def solution(h):
        y = [0.3, 0.3 * (1.0 - 0.9 * h)]
        while len(y) <= round(2.0 / h):
            y.append(y[-1] - 0.9 * h * y[-2])
        return np.array(y)

    signal = by_name(compare(loop, make_scenario(2.0, 0.1)))["plant.y"]
    distance = np.abs(solution(0.05)[::2] - solution(0.1))
    assert signal.step.largest == pytest.approx(distance.max(), rel=1e-9)
    assert signal.step.time == pytest.approx(0.1 * distance.argmax())
    assert signal.step.relative == pytest.approx(distance.max() / np.ptp(solution(0.1)), rel=1e-9)


def test_half_the_step_has_the_same_rows(loop, make_scenario):
    scenario = make_scenario(1.0, 0.1)
    np.testing.assert_array_equal(
        simulate(*halved(loop, scenario))["time"], simulate(loop, scenario)["time"]
    )


def test_largest_difference_comes_first_with_its_time(loop, make_scenario, monkeypatch):
    def bent(values):
        values[7] += 0.25
        return values

    monkeypatch.setitem(ENGINES, "bent", altered("law.y", bent))
    comparison = compare(loop, make_scenario(1.0, 0.1))
    worst = comparison.signals[0]
    assert worst.name == "law.y" and not comparison.agree
    assert worst.engines["bent"].largest == pytest.approx(0.25)
    assert worst.engines["bent"].relative == pytest.approx(0.25 / worst.range)
    assert worst.engines["bent"].time == pytest.approx(0.7)
    assert "decided otherwise" in " ".join(comparison.remarks["bent"])


def test_engines_that_agree_with_each_other_are_named_together(loop, make_scenario, monkeypatch):
    def scaled(values):
        return 1.1 * values

    runs = {"same": OURS, "one": altered("law.y", scaled), "two": altered("law.y", scaled)}
    set_engines(monkeypatch, {"fmpy": OURS} | runs)
    signals = by_name(compare(loop, make_scenario(1.0, 0.1)))
    assert signals["law.y"].agreeing == [["fmpy", "same"], ["one", "two"]]
    assert signals["plant.y"].agreeing == [["fmpy", "same", "one", "two"]]


def test_difference_of_angles_is_the_shorter_way_round(loop, make_scenario, monkeypatch):
    def turned(system, scenario, options):
        table = OURS(system, scenario, options)
        table["law.y"].values[:] += 2.0 * np.pi
        return table

    def in_radians(run):
        def wrapped(system, scenario, options):
            table = run(system, scenario, options)
            table["law.y"].attrs["units"] = "rad"
            return table

        return wrapped

    set_engines(monkeypatch, {"fmpy": in_radians(OURS), "turned": in_radians(turned)})
    comparison = compare(loop, make_scenario(1.0, 0.1))
    assert by_name(comparison)["law.y"].engines["turned"].largest < 1e-12


def test_no_number_is_a_difference(loop, make_scenario, monkeypatch):
    monkeypatch.setitem(
        ENGINES, "broken", altered("law.y", lambda values: np.where(values < -0.2, np.nan, values))
    )
    comparison = compare(loop, make_scenario(1.0, 0.1))
    assert not comparison.agree and comparison.signals[0].name == "law.y"
    assert "is not a number" in " ".join(comparison.remarks["broken"])


def test_engine_that_refuses_the_system_is_left_out_and_one_that_fails_counts(
    loop, make_scenario, monkeypatch
):
    def refusing(*_, **__):
        raise ShipcosimError(Problem("law", "cannot be."))

    def failing(*_, **__):
        raise RunError(Problem("law", "burst."), None)

    monkeypatch.setitem(ENGINES, "refusing", refusing)
    assert compare(loop, make_scenario()).agree
    monkeypatch.setitem(ENGINES, "failing", failing)
    comparison = compare(loop, make_scenario())
    assert not comparison.agree and comparison.failed == ("failing",)
    assert (
        "cannot be" in comparison.left_out["refusing"] and "burst" in comparison.left_out["failing"]
    )


TIMES = np.arange(2001) * 0.05
WAVE = np.sin(1.3 * TIMES) + 0.3 * np.cos(0.71 * TIMES)


def table(values, other=WAVE):
    return make_table(TIMES, [("a.y", values, "m", ""), ("b.y", other, "m", "")])


@pytest.mark.parametrize(
    "values, words",
    [
        (np.concatenate([WAVE[:1], WAVE[:-1]]), "one row late"),
        (np.concatenate([WAVE[1:], WAVE[-1:]]), "one row early"),
        (1.7 * WAVE + 0.1, "ours times 1.7 plus 0.1"),
        (
            np.sin(1.3 * np.cumsum(np.r_[0.0, np.full(2000, 0.05)])) + 0.3 * np.cos(0.71 * TIMES),
            "a sum of steps, drifts",
        ),
        (WAVE + 0.01 * np.exp(-TIMES), "differs at the start"),
        (WAVE + 0.01 * (TIMES > 50.0), "decided otherwise"),
    ],
    ids=["delay", "early", "transformation", "drift", "start", "sample"],
)
def test_cause_is_found_in_words(values, words):
    said = explained(table(WAVE), table(values), 0.05, tolerance=1e-14)
    assert words in " ".join(said) and "b.y" not in " ".join(said)


def test_only_what_differs_first_is_explained():
    early, late = WAVE + 0.1 * (TIMES > 20.0), WAVE + 0.5 * (TIMES > 30.0)
    said = explained(table(WAVE), table(late, early), 0.05)
    assert said[0] == "2 signals differ, from t = 20.05 s on: b.y."


def test_equal_tables_need_no_explanation():
    assert explained(table(WAVE), table(WAVE.copy()), 0.05) == []


def run_command(*arguments):
    return CliRunner().invoke(app, ["compare", *map(str, arguments)])


@pytest.fixture
def packed(make_system, tmp_path):
    """SSD with its FMUs beside it."""
    for component in make_system(LOOP, CONNECTIONS).components.values():
        shutil.copy(component.fmu.path, tmp_path / "resources")
    return tmp_path / "SystemStructure.ssd"


def test_command_shows_each_signal_and_the_verdict(packed):
    result = run_command(packed, "--stop-time", 1, "--step-size", 0.1)
    assert result.exit_code == 0, result.output
    assert {"plant.y", "law.y"} <= {
        line.split()[0] for line in result.output.splitlines() if line.strip()
    }
    assert "…" not in result.output


def test_command_shows_the_signals_that_differ_most():
    result = run_command("gust", "--stop-time", 0.2)
    shown = [
        line
        for line in result.output.splitlines()
        if line.startswith(tuple("abcdefghijklmnopqrstuvwxyz"))
    ]
    left_out = int(re.search(r"(\d+) signals that differ less: --json has all", result.output)[1])
    told = json.loads(run_command("gust", "--stop-time", 0.2, "--json").stdout)["signals"]
    assert len(told) - left_out == MOST_SHOWN
    assert [line.split()[0] for line in shown if "." in line.split()[0]][:MOST_SHOWN] == [
        signal["name"] for signal in told[:MOST_SHOWN]
    ]


def test_command_fails_where_engines_differ(packed, monkeypatch):
    monkeypatch.setitem(ENGINES, "bent", altered("law.y", lambda values: 1.1 * values))
    result = run_command(packed, "--stop-time", 1, "--step-size", 0.1, "--json")
    assert result.exit_code == 1
    told = json.loads(result.stdout)
    assert not told["agree"] and told["signals"][0]["name"] == "law.y"
    assert "ours times 1.1" in " ".join(told["remarks"]["bent"])


def test_command_refuses_what_is_not_there(tmp_path):
    assert run_command(tmp_path / "none.toml").exit_code == 2
    assert run_command("no_such_scenario").exit_code == 2
