"""What a run keeps: chosen signals and rows, from options, scenarios, and libcosim's LogConfig.xml."""

import json
import time
from pathlib import Path

import pytest

import shipcosim as sc
from shipcosim.ssp import read_log_config

CONFIG = """<?xml version="1.0" encoding="UTF-8"?>
<simulators>
  <simulator name="lag" decimationFactor="{}"><variable name="y"/></simulator>
</simulators>
"""
RECORD = """
[record]
signals = ["lag.y"]
every   = "500 ms"
"""


@pytest.fixture
def full(call, project):
    """The table of a run that keeps all."""
    call("run", "fill", "--out", "full")
    return sc.read_table("full/result.nc")


def kept(folder):
    table = sc.read_table(Path(folder) / "result.nc")
    return list(table.data_vars), table["time"].values[:3].tolist(), table


@pytest.mark.parametrize("engine", ["fmpy", "native", "libcosim"])
def test_chosen_signals_are_kept_with_their_values(call, full, engine):
    done = call("run", "fill", "--record", "level_set", "--engine", engine, "--out", "out")
    if "not installed" in done.err:
        pytest.skip("this engine is not installed")
    assert done.code == 0, done.err
    names, _, table = kept("out")
    # What is expected of is kept as well, so that the page can show it.
    assert names == [name for name in full.data_vars if name in ("level_set", "lag.y")]
    assert table["lag.y"].values.tolist() == pytest.approx(full["lag.y"].values.tolist(), abs=1e-12)


def test_rows_are_kept_at_the_interval_that_is_asked_for(call, full):
    assert call("run", "fill", "--every", "0.5s", "--out", "out").code == 0
    names, times, table = kept("out")
    assert names == list(full.data_vars) and times == [0.0, 0.5, 1.0]
    assert table["lag.y"].values.tolist() == full["lag.y"].values[::5].tolist()


def test_a_scenario_says_what_is_kept_and_the_option_goes_before_it(call, full, project):
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text().replace("[set]", f"{RECORD}\n[set]"))
    assert call("check", "fill").code in (0, 1)
    call("run", "fill", "--out", "out")
    assert kept("out")[:2] == (["lag.y"], [0.0, 0.5, 1.0])
    call("run", "fill", "--record", "*", "--every", "1", "--out", "all")
    assert kept("all")[:2] == (list(full.data_vars), [0.0, 1.0, 2.0])


def test_log_config_of_libcosim_chooses_signals_and_rows(call, full, project):
    Path("LogConfig.xml").write_text(CONFIG.format(10))
    done = call("simulate", "tank", "--stop-time", "3", "--step-size", "0.1", "--out", "out")
    assert done.code == 0
    more = ["--record", "LogConfig.xml", "--out", "chosen"]
    assert call("simulate", "tank", "--stop-time", "3", "--step-size", "0.1", *more).code == 0
    names, times, table = kept("chosen")
    assert names == ["lag.y"] and times == [0.0, 1.0, 2.0]
    assert table["lag.y"].values.tolist() == kept("out")[2]["lag.y"].values[::10].tolist()
    assert "records LogConfig.xml" in json.loads(table.attrs["changed"])


def test_an_input_in_a_log_config_stands_for_its_source(call, full, project):
    """libcosim logs inputs too, and its files name them; here the source has the same values."""
    Path("LogConfig.xml").write_text(CONFIG.format(1).replace('"y"', '"u"'))
    assert call("run", "fill", "--record", "LogConfig.xml", "--out", "out").code == 0
    assert "level_set" in kept("out")[0]


def test_log_config_without_variables_takes_all_of_a_simulator(tmp_path):
    (tmp_path / "c.xml").write_text(
        '<simulators><simulator name="a"/><simulator name="b" '
        'decimationFactor="3"><variable name="x"/></simulator></simulators>'
    )
    assert read_log_config(tmp_path / "c.xml") == (("a.*", "b.x"), 1)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (CONFIG.format("often"), "decimationFactor = 'often'"),
        (CONFIG.format(0), "decimationFactor = '0'"),
        ("<simulator/>", "no LogConfig.xml"),
        (CONFIG.format(1)[:80], "c.xml"),
        (CONFIG.format(1).replace('"y"', '"z"'), "lag.z"),
    ],
)
def test_log_config_that_is_wrong_is_refused_before_the_run(call, project, text, said):
    Path("c.xml").write_text(text)
    failed = call("run", "fill", "--record", "c.xml")
    assert failed.code == 2 and said in failed.err and not Path("results").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--record", "lag.z"], "lag.y"),
        (["--record", "nothing"], "There is no such signal or component."),
        (["--record", "lag.u"], "lag.u"),  # it is connected: its source is what is recorded
        (["--every", "0.25"], "no multiple of the step size"),
        (["--record", "gone.xml"], "gone.xml"),
    ],
)
def test_what_cannot_be_kept_is_refused_before_the_run(call, project, arguments, said):
    failed = call("run", "fill", *arguments)
    assert failed.code == 2 and said in failed.err and not Path("results").exists()


def test_two_intervals_in_one_scenario_are_refused(call, project):
    scenario = project / "scenarios" / "fill.toml"
    text = scenario.read_text().replace("[set]", f"output_interval = 1.0\n{RECORD}\n[set]")
    scenario.write_text(text)
    failed = call("run", "fill")
    assert failed.code == 2 and "two intervals of rows" in failed.err


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        ("lagg", "lagg: There is no such signal or component."),
        ("lag.u", "it is what level_set puts out. Take level_set instead."),
    ],
)
def test_check_finds_what_a_scenario_cannot_keep_at_its_line(call, full, project, signal, said):
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(f'{scenario.read_text()}\n[record]\nsignals = ["{signal}"]\n')
    line = len(scenario.read_text().splitlines())
    for command in ("check", "run"):
        failed = call(command, "scenarios/fill.toml")
        assert failed.code in (1, 2) and said in failed.out + failed.err
        assert f"scenarios/fill.toml, line {line}:" in failed.out + failed.err


def test_command_and_call_keep_the_same(call, project):
    call("run", "fill", "--record", "lag.*", "--every", "500 ms", "--out", "a")
    sc.run("fill", record="lag.*", output_interval=0.5, out="b")
    for name in ("result.nc", "result.csv", "report.html", "verdict.json"):
        assert Path("a", name).read_bytes() == Path("b", name).read_bytes(), name


@pytest.mark.parametrize("engine", ["fmpy", "native"])
def test_a_run_in_real_time_takes_its_time_and_gives_the_same(call, full, engine):
    began = time.monotonic()
    paced = sc.run("fill", engine=engine, realtime=4.0)
    took = time.monotonic() - began
    # The last of 50 steps of 0.1 s begins at 4.9 s.
    assert took >= 4.9 / 4.0
    assert paced["lag.y"].values.tolist() == sc.run("fill", engine=engine)["lag.y"].values.tolist()


@pytest.mark.parametrize("pace", ["0", "-1", "nan"])
def test_a_pace_that_is_none_is_refused(call, project, pace):
    failed = call("run", "fill", "--realtime", pace)
    assert failed.code == 2 and "no pace" in failed.err and not Path("results").exists()


def test_a_pace_is_refused_by_engines_that_do_not_know_it(call, project):
    failed = call("run", "fill", "--realtime", "1", "--engine", "libcosim")
    assert failed.code == 2 and "realtime" in failed.err
