"""`shipcosim export osp` leaves what libcosim runs by itself, with the digits of our run."""

import json
import re
import shutil

import pytest
from osp_execution import assert_same, rows_of

import shipcosim as sc
from shipcosim.cosim import simulate
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system


@pytest.fixture(autouse=True)
def libcosim():
    """Skips where it is not installed."""
    pytest.importorskip("libcosimpy.CosimExecution", reason="needs libcosim")


HAPPENING = """description = "Twenty seconds of stationkeeping"
system      = "gunnerus_dp"
parameters  = "gunnerus-33m9"
stop_time   = 20.0
step_size   = 0.05

[set]
"environment.wind_speed" = 8.0

[[events]]
time     = 4.0
override = { "reference.x_set" = 1.0, "tunnel.failed" = true }

[[events]]
time  = 6.0
bias  = { "vessel.u" = 0.05, "controller.y_1_meas" = 0.5, "environment.wind_speed" = 1.5 }

[[events]]
time     = 9.0
reset    = ["vessel.u", "controller.y_1_meas", "environment.wind_speed"]
override = { "port.azimuth_cmd" = 0.3 }

[[events]]
time  = 14.0
reset = ["port.azimuth_cmd", "tunnel.failed"]
"""


def test_the_dp_ship_runs_in_libcosim_from_its_own_files_with_our_digits(gunnerus, call):
    (gunnerus / "scenarios" / "happening.toml").write_text(HAPPENING)
    result = call("export", "osp", "happening", "--out", "out")
    assert (
        result.code == 0
        and "out/OspSystemStructure.xml" in result.out
        and "out/scenario.json" in result.out
    )
    scenario = read_scenario("scenarios/happening.toml")
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=["build/fmus"])
    table = simulate(system, scenario)
    rows = rows_of("out", system, 400, "out/scenario.json")
    assert len(rows) > 60
    assert_same(table, rows)
    quiet = simulate(system, scenario.model_copy(update={"events": []}))
    assert abs(table["vessel.x"] - quiet["vessel.x"]).max() > 0.05


def test_what_was_exported_runs_here_again_with_its_scenario(gunnerus, call):
    assert call("export", "osp", "short", "--out", "out").code == 0
    assert call("run", "short", "--out", "ours").code == 0
    again = call(
        "simulate",
        "out/OspSystemStructure.xml",
        "--scenario",
        "out/scenario.json",
        "--out",
        "again",
    )
    assert again.code == 0, again.err
    assert (gunnerus / "ours" / "result.csv").read_text() == (
        gunnerus / "again" / "result.csv"
    ).read_text()


def test_check_takes_an_exported_structure_and_names_its_faults(gunnerus, call):
    assert (
        call(
            "export",
            "osp",
            "ssp/gunnerus_dp",
            "--stop-time",
            "1",
            "--step-size",
            "0.1",
            "--out",
            "out",
        ).code
        == 0
    )
    assert not (gunnerus / "out" / "scenario.json").exists()
    assert call("check", "out").code == 0
    file = gunnerus / "out" / "OspSystemStructure.xml"
    file.write_text(file.read_text().replace('name="psi"', 'name="pso"'))
    result = call("check", "out/OspSystemStructure.xml")
    assert result.code == 1
    assert "line " in result.out and "vessel has no variable 'pso'." in result.out


def test_a_faulty_scenario_of_osp_leaves_nothing(gunnerus, call):
    (gunnerus / "events.json").write_text(json.dumps({"events": [{"time": 1.0}]}))
    result = call(
        "simulate",
        "ssp/gunnerus_dp",
        "--stop-time",
        "1",
        "--step-size",
        "0.1",
        "--scenario",
        "events.json",
    )
    assert result.code == 2 and "event 1:\nIt has no model" in result.err
    assert not (gunnerus / "results").exists()


def test_check_for_a_tool_names_what_it_would_leave_out_and_how_to_mend_it(gunnerus, call):
    result = call("check", "ssp/gunnerus_dp", "--for", "libcosim")
    assert result.code == 1
    assert (
        "line 9: ParameterBinding" in result.out
        and "bound to a system: libcosim goes on without it" in result.out
    )
    system = sc.read("ssp/gunnerus_dp")
    system.bind_to_components()
    system.write("mended.ssp")
    assert call("check", "mended.ssp", "--for", "libcosim", "--for", "ecos").code == 0
    assert call("check", "scenarios/short.toml", "--for", "libcosim").code == 1
    assert call("check", "ssp/gunnerus_dp", "--for", "vico").code == 2


def test_check_holds_a_scenario_of_osp_against_the_structure_beside_it(gunnerus, call):
    assert call("export", "osp", "short", "--out", "out").code == 0
    file = gunnerus / "out" / "scenario.json"
    assert call("check", "out/scenario.json").code == 0
    file.write_text(file.read_text().replace('"x_set"', '"x_sett"'))
    result = call("check", "out/scenario.json")
    assert (
        result.code == 1
        and "reference has no variable 'x_sett'" in result.out
        and "scenario.json" in result.out
    )
    (gunnerus / "alone.yaml").write_text("events: [{time: 1, model: a, variable: b, action: rest}]")
    assert "Did you mean 'reset'?" in call("check", "alone.yaml").out


def test_a_scenario_of_ours_runs_an_osp_structure(gunnerus, call):
    assert call("export", "osp", "short", "--out", "out").code == 0
    (gunnerus / "scenarios" / "theirs.toml").write_text(
        'system = "out/OspSystemStructure.xml"\nstop_time = 1.0\nstep_size = 0.05\n'
        '[[events]]\ntime = 0.5\noverride = { "reference.x_set" = 1.0 }\n'
    )
    for name in ("short", "theirs"):
        assert call("run", name, "--out", name).code == 0
    assert (gunnerus / "short" / "result.csv").read_text() == (
        gunnerus / "theirs" / "result.csv"
    ).read_text()


def test_commands_of_the_page_run(root, gunnerus, call):
    shutil.copy(root / "scenarios" / "gust.toml", "scenarios")
    page = (root / "docs" / "osp.md").read_text(encoding="utf-8")
    lines = re.findall(r"^shipcosim (.*)$", page, re.MULTILINE)
    codes = {line: call(*line.split()).code for line in lines}
    assert set(codes.values()) == {0, 1}
    differing = ("check gunnerus_dp --for", "compare gunnerus_dp")
    assert [line for line, code in codes.items() if code] == [
        line for line in lines if line.startswith(differing)
    ]


def test_an_earlier_export_stays_where_none_can_be_made_and_is_kept_beside_a_new_one(
    gunnerus, call
):
    assert call("export", "osp", "short", "--out", "out").code == 0
    before = sorted(path.name for path in (gunnerus / "out").iterdir())
    sixths = ["--stop-time", "1", "--step-size", str(1 / 6)]
    refused = call("export", "osp", "short", "--out", "out", *sixths)
    assert refused.code == 2 and "no whole number of nanoseconds" in refused.err
    assert sorted(path.name for path in (gunnerus / "out").iterdir()) == before
    assert "kept in out-1" in call("export", "osp", "short", "--out", "out").err
    assert sorted(path.name for path in (gunnerus / "out-1").iterdir()) == before
