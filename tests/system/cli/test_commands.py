"""Commands as users and CI jobs call them: exit codes, files, messages."""

import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from functools import partial

import numpy as np
import pytest

import shipcosim
from shipcosim.series import read_table

RESULTS = ["report.html", "result.csv", "result.nc", "verdict.json"]


def names(folder):
    """Names of everything in a folder."""
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def command(*arguments, **options):
    """The command in a process of its own."""
    # A shell's job in the background ignores Ctrl-C, and so would its children.
    listens = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    start = [sys.executable, "-c", f"{listens}; from shipcosim.cli import main; main()", *arguments]
    return subprocess.Popen(
        start, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
    )


def test_version_is_the_packages(call):
    assert call("--version").out == f"shipcosim {shipcosim.__version__}\n"


def test_console_without_our_characters_is_no_error(project):
    running = command("run", "fill", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    out, err = running.communicate(timeout=300)
    assert running.returncode == 0 and "PASS" in out and err == ""


def test_help_imports_nothing_heavy():
    code = "import sys, shipcosim.cli; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"numpy", "xarray", "pydantic", "rich", "fmpy", "lxml", "pint"} & set(loaded)


@pytest.mark.parametrize("name", ["build", "run", "simulate", "check", "capability"])
def test_help_of_each_command_names_the_exit_codes(call, name):
    help_ = call(name, "--help")
    assert help_.code == 0 and "Exit codes" in help_.out


def test_build_makes_fmus_and_systems(call, project):
    done = call("build")
    assert done.code == 0
    assert names(project / "build" / "fmus") == ["lag.fmu"] and names(
        project / "build" / "ssp"
    ) == ["tank.ssp"]
    assert done.out.split() == [
        os.path.join("build", "fmus", "lag.fmu"),
        os.path.join("build", "ssp", "tank.ssp"),
    ]


def test_build_of_one_name_builds_only_that_into_the_folder_asked_for(call, project):
    assert call("build", "lag", "--out", "elsewhere").code == 0
    assert names(project / "elsewhere") == ["fmus"] and not (project / "build").exists()


def test_a_native_fmu_is_built_and_run_in_place_of_the_one_in_python(call, project, needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')
    done = call("build", "--native")
    assert done.code == 0, done.err
    (path,) = (project / "build" / "native").glob("*.fmu")
    done = call("run", "fill", "--fmus", str(path.parent))
    assert done.code == 0, done.err
    failed = call("run", "fill", "--fmus", str(path.parent), "--set", "lag.pause=0.001")
    assert failed.code != 0 and "compiled for another value of pause" in failed.err


def test_platforms_are_for_native_fmus(call, project):
    done = call("build", "--targets", "linux")
    assert done.code == 2 and "--native" in done.err


def test_build_of_an_unknown_name_suggests_the_nearest(call, project):
    failed = call("build", "lga")
    assert failed.code == 2 and "Did you mean 'lag'?" in failed.err


def test_build_outside_a_project_says_what_a_project_is(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    failed = call("build")
    assert failed.code == 2 and "fmus/" in failed.err


def test_run_leaves_table_and_page_and_says_that_all_holds(call, project):
    done = call("run", "fill")
    assert done.code == 0
    assert names(project / "results" / "fill") == RESULTS
    assert "PASS" in done.out and os.path.join("results", "fill", "report.html") in done.out
    assert "lag.y: 1\u00a0±\u00a00.05\u00a0m" in done.out
    table = read_table(project / "results" / "fill" / "result.nc")
    assert table.attrs["complete"] == 1 and table.sizes["time"] == 51


def test_run_takes_a_path_and_another_folder(call, project):
    assert call("run", "scenarios/fill.toml", "--out", "here").code == 0
    assert names(project / "here") == RESULTS


def test_run_with_a_missed_expectation_ends_with_1_and_keeps_the_results(call, project):
    failed = call("run", "fill", "--set", "lag.time_constant=50")
    assert failed.code == 1 and "FAIL" in failed.out
    assert names(project / "results" / "fill") == RESULTS
    assert "1 of 1 expectations missed" in (project / "results" / "fill" / "report.html").read_text(
        encoding="utf-8"
    )


def test_run_of_a_folder_runs_every_scenario_and_writes_one_table(call, project):
    folder = project / "scenarios" / "both"
    folder.mkdir()
    text = (project / "scenarios" / "fill.toml").read_text(encoding="utf-8")
    (folder / "fill.toml").write_text(text, encoding="utf-8")
    assert call("run", "both").code == 0
    (folder / "slow.toml").write_text(text.replace("= 0.5", "= 50.0"), encoding="utf-8")
    failed = call("run", "scenarios/both")
    assert failed.code == 1 and "1 of 2 scenarios miss something: slow." in failed.out
    results = project / "results" / "both"
    assert {name: names(results / name) for name in ("fill", "slow")} == {
        "fill": RESULTS,
        "slow": RESULTS,
    }
    page = (results / "report.html").read_text(encoding="utf-8")
    assert 'href="fill/report.html"' in page and "✗ FAIL" in page and "✓ pass" in page


def test_csv_and_netcdf_hold_the_same_numbers(call, project):
    call("run", "fill")
    tables = [read_table(project / "results" / "fill" / f"result.{kind}") for kind in ("nc", "csv")]
    np.testing.assert_array_equal(*(table["lag.y"].values for table in tables))


def test_run_builds_anew_what_its_sources_have_outrun(call, project):
    """With the input doubled by a change of the source the level expected is no longer met."""
    assert call("run", "fill").code == 0
    source = project / "fmus" / "lag" / "lag.py"
    source.write_text(source.read_text().replace("(self.u -", "(2.0 * self.u -"))
    later = time.time() + 10
    os.utime(source, (later, later))
    assert call("run", "fill").code == 1


def test_unknown_scenario_suggests_the_nearest(call, project):
    failed = call("run", "fil")
    assert failed.code == 2 and "Did you mean 'fill'?" in failed.err


@pytest.mark.parametrize(
    ("setting", "complaint"),
    [
        ("lag.time_constnt=1", "Did you mean 'time_constant'?"),
        ("lga.time_constant=1", "Did you mean 'lag'?"),
        ("lag.time_constant=fast", "'fast' is no Real"),
        ("lag.time_constant=-1", "0.01"),
        ("lag.time_constant", "component.name=value"),
    ],
)
def test_setting_that_does_not_fit_is_refused_before_the_run(call, project, setting, complaint):
    failed = call("run", "fill", "--set", setting)
    assert failed.code == 2 and complaint in failed.err and "--set" in failed.err
    assert not (project / "results").exists()


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("stop_time = 5.0", "stop_time = ", "line 3"),
        ("stop_time = 5.0", "stoptime = 5.0", "Did you mean 'stop_time'?"),
        ("step_size = 0.1", "step_size = 0.3", "no multiple of"),
        ("step_size = 0.1", "step_size = -0.1", "step_size"),
        ('"lag.y"', '"lag.z"', "no variable 'z'"),
        ('"tank"', '"tnak"', "tnak"),
    ],
)
def test_broken_scenario_says_where_and_what(call, project, old, new, complaint):
    scenario = project / "scenarios" / "fill.toml"
    scenario.write_text(scenario.read_text().replace(old, new))
    failed = call("run", "fill")
    assert failed.code == 2 and complaint in failed.err and "Traceback" not in failed.err
    assert not (project / "results").exists()


def test_exception_in_an_fmu_shows_its_traceback_component_and_time_and_keeps_the_rows(
    call, project
):
    failed = call("run", "fill", "--set", "lag.fails_at=2.0")
    assert failed.code == 1
    assert all(
        text in failed.err
        for text in ("lag", "ValueError: the pump has run dry", "lag.py", "t = 2")
    )
    results = project / "results" / "fill"
    partial = ["result-partial.csv", "result-partial.html", "result-partial.nc", "verdict.json"]
    assert names(results) == partial
    table = read_table(results / "result-partial.nc")
    assert table.attrs["complete"] == 0 and table["time"].values[-1] == pytest.approx(2.0)
    assert "PARTIAL" in (results / "result-partial.html").read_text(encoding="utf-8")


@pytest.mark.skipif(
    sys.platform == "win32", reason="Windows has no signal that Python could send as Ctrl-C"
)
@pytest.mark.parametrize(("send", "pause", "least"), [("kill", 0.1, 2), ("killpg", 2.0, 1)])
def test_ctrl_c_stops_at_once_and_keeps_what_there_is(project, send, pause, least):
    """In a group both the command and its child get it, and the child gets it again from the command."""
    set_ = ["--set", f"lag.pause={pause}", "--set", "lag.time_constant=1.0"]
    running = stepping(project, *set_)
    getattr(os, send)(running.pid, signal.SIGINT)
    out, err = running.communicate(timeout=300)
    assert running.returncode == 130 and "PARTIAL" in err and "Traceback" not in err and out == ""
    table = read_table(project / "results" / "fill" / "result-partial.nc")
    assert table.attrs["complete"] == 0 and least <= table.sizes["time"] < 51
    assert not (project / "results" / "fill" / "result.nc").exists()


def stepping(project, *options):
    """A run in a process of its own that has begun to step."""
    running = command("run", "fill", *options, start_new_session=True)
    deadline = time.monotonic() + 30.0
    while not (project / "stepping").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(0.5)
    return running


@pytest.mark.skipif(sys.platform == "win32", reason="see above")
@pytest.mark.parametrize("pace", ["1e-3", "1e-300"])
def test_ctrl_c_stops_a_run_that_waits_for_the_clock(project, pace):
    """At these paces the second step is due after 100 s, or later than any clock can wait."""
    running = stepping(project, "--set", "lag.pause=0.01", "--realtime", pace)
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=20)
    assert running.returncode == 130 and "PARTIAL" in err and "Traceback" not in err


def test_complete_run_takes_away_the_partial_results_before_it(call, project):
    call("run", "fill", "--set", "lag.fails_at=2.0")
    assert call("run", "fill").code == 0
    assert names(project / "results" / "fill") == RESULTS


def test_results_that_cannot_be_written_leave_the_old_ones_whole(call, project):
    """A limit on the size of files stands for the full disk; it is the page, the last of the three, that hits it."""
    resource = pytest.importorskip("resource")
    call("run", "fill")
    results = project / "results" / "fill"
    before = {path.name: path.read_bytes() for path in results.iterdir()}
    limit = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (400_000, 400_000))
    running = command("run", "fill", "--set", "lag.time_constant=0.4", preexec_fn=limit)
    _, err = running.communicate(timeout=300)
    assert running.returncode == 2 and "cannot be written: File too large" in err
    assert os.path.join("results", "fill", "report.html") in err
    assert {path.name: path.read_bytes() for path in results.iterdir()} == before


def test_folder_of_results_that_is_a_file_is_refused(call, project):
    (project / "taken").write_text("")
    failed = call("run", "fill", "--out", "taken")
    assert failed.code == 2 and "taken" in failed.err and "--out" in failed.err


def test_fault_of_the_program_is_no_traceback_unless_asked_for(call, project, monkeypatch):
    def fault(*_, **__):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("shipcosim.calls.runs.read_scenario", fault)
    plain, debug = call("run", "fill"), call("run", "fill", "--debug")
    assert plain.code == debug.code == 2
    assert (
        "ZeroDivisionError" in plain.err and "Traceback" not in plain.err and "--debug" in plain.err
    )
    assert "Traceback" in debug.err


def test_simulate_runs_any_system_with_its_input_fed_from_a_table(call, project):
    call("build")
    (project / "levels.csv").write_text("time [s],level_set [m]\n0,3\n10,3\n")
    arguments = (
        "--stop-time",
        "10",
        "--step-size",
        "0.1",
        "--inputs",
        "levels.csv",
        "--out",
        "out",
    )
    done = call("simulate", "build/ssp/tank.ssp", *arguments)
    assert done.code == 0 and names(project / "out") == RESULTS
    level = read_table(project / "out" / "result.nc")["lag.y"].values[-1]
    assert level == pytest.approx(3.0 * (1.0 - np.exp(-10.0)), abs=1e-3)  # closed form of the lag


def test_simulate_with_a_parameter_set_uses_its_values(call, project):
    (project / "slow.ssv").write_text(
        '<ssv:ParameterSet name="slow" version="1.0"'
        ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">'
        '<ssv:Parameters><ssv:Parameter name="lag.time_constant"><ssv:Real value="100.0"/></ssv:Parameter>'
        "</ssv:Parameters></ssv:ParameterSet>"
    )
    arguments = (
        "--stop-time",
        "10",
        "--step-size",
        "0.01",
        "--parameters",
        "slow.ssv",
        "--out",
        "out",
    )
    assert call("simulate", "ssp/tank", *arguments).code == 0
    level = read_table(project / "out" / "result.nc")["lag.y"].values[-1]
    assert level == pytest.approx(1.0 - np.exp(-0.1), abs=1e-4)


def test_simulate_without_times_says_which_options_give_them(call, project):
    failed = call("simulate", "ssp/tank")
    assert failed.code == 2 and "--stop-time" in failed.err and "--step-size" in failed.err


def test_simulate_with_an_impossible_step_size_is_refused(call, project):
    failed = call("simulate", "ssp/tank", "--stop-time", "1", "--step-size", "0.3")
    assert failed.code == 2 and "no multiple" in failed.err


def test_unknown_engine_is_refused(call, project):
    failed = call("run", "fill", "--engine", "fmpi")
    assert failed.code == 2 and "fmpy" in failed.err and not (project / "results").exists()


def test_missing_fmu_is_named_with_where_it_was_sought(call, project):
    (project / "fmus" / "lag" / "lag.py").unlink()
    failed = call("run", "fill")
    assert (
        failed.code == 2 and "lag.fmu" in failed.err and os.path.join("build", "fmus") in failed.err
    )


def test_check_before_the_build_says_what_builds(call, project):
    found = call("check", "ssp/tank")
    assert found.code == 1 and "lag.fmu" in found.out and "shipcosim build" in found.out


def test_check_of_sound_files_finds_nothing(call, project):
    call("build")
    done = call(
        "check", "ssp/tank", "build/ssp/tank.ssp", "build/fmus/lag.fmu", "scenarios/fill.toml"
    )
    assert done.code == 0 and done.out.count("nothing wrong") == 4


def test_check_of_every_shipped_system_has_few_lines_before_its_verdict(call, gunnerus):
    found = {}
    for structure in sorted((gunnerus / "ssp").glob("*/SystemStructure.ssd")):
        *remarks, verdict = call("check", structure.parent).out.splitlines()
        assert "nothing wrong" in verdict or "no error" in verdict, structure
        found[structure.parent.name] = len(remarks)
    assert found["gunnerus_dp"] == 0 and len(found) > 8
    assert max(found.values()) <= 3, found


def test_check_of_an_fmu_lists_its_variables_with_unit_and_start(call, project):
    call("build")
    lines = call("check", "build/fmus/lag.fmu").out.splitlines()
    listed = [line.split() for line in lines]
    assert ["time_constant", "parameter", "Real", "s", "1.0", "time", "constant"] in listed
    (told,) = json.loads(call("check", "build/fmus/lag.fmu", "--json").out)
    assert {
        "name": "y",
        "causality": "output",
        "type": "Real",
        "unit": "m",
        "start": "",
        "description": "output",
    } in [*told["variables"]]
    assert ["y", "output", "Real", "m", "output"] in listed
    assert json.loads(call("check", "build/fmus/lag.fmu", "--json").out)[0]["problems"] == []


def test_check_reports_what_is_wrong_in_each_file(call, project):
    call("build")
    ssd = project / "ssp" / "tank" / "SystemStructure.ssd"
    ssd.write_text(ssd.read_text().replace('endConnector="u"', 'endConnector="v"'))
    (project / "log.csv").write_text("time [s],x [m]\n0,1\n2,1\n1,1\n")
    found = call("check", "ssp/tank", "log.csv", "--json")
    assert found.code == 1
    reports = {report["file"]: report["problems"] for report in json.loads(found.out)}
    assert any("'v'" in problem["found"] for problem in reports["ssp/tank"])
    assert [problem["found"] for problem in reports["log.csv"]] == ["1 s follows 2 s."]


def test_check_of_a_table_remarks_gaps_and_missing_values(call, project):
    (project / "log.csv").write_text("time [s],x [m]\n0,1\n1,nan\n2,1\n5,1\n")
    found = call("check", "log.csv")
    assert (
        found.code == 0
        and "3 s without a row after 2 s" in found.out
        and "1 row without a number" in found.out
    )


def test_check_of_a_file_that_is_not_there_ends_with_2(call, project):
    failed = call("check", "nothing.ssp")
    assert failed.code == 2 and "nothing.ssp" in failed.err


SSV = """<?xml version="1.0"?><ssv:ParameterSet version="1.0" name="extended"
xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
<ssv:Parameters>{}</ssv:Parameters></ssv:ParameterSet>"""
REAL = '<ssv:Parameter name="{}"><ssv:Real value="{}"{}/></ssv:Parameter>'


def test_run_takes_of_a_foreign_parameter_set_what_fits_and_says_what_does_not(call, project):
    values = REAL.format("lag.time_constant", 4.0, "") + REAL.format("tow.north", 1.0, "")
    (project / "extended.ssv").write_text(SSV.format(values), encoding="utf-8")
    plain, other = (
        call("run", "fill", "--out", out, *more)
        for out, more in (("a", []), ("b", ["--parameters", "extended.ssv"]))
    )
    assert plain.code == 0 and "tow.north" in other.err and "Left out" in other.err
    slower = [
        float((project / out / "result.csv").read_text().split()[-1].split(",")[-1])
        for out in ("a", "b")
    ]
    assert slower[1] < slower[0]


def test_run_refuses_a_parameter_set_of_which_nothing_fits(call, project):
    (project / "extended.ssv").write_text(
        SSV.format(REAL.format("tow.north", 1.0, "")), encoding="utf-8"
    )
    result = call("run", "fill", "--parameters", "extended.ssv")
    assert result.code == 2 and "Nothing of it fits tank: tow.north." in result.err
