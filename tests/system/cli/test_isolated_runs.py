"""--isolate: components in processes of their own."""

import subprocess
import sys

import pytest

from shipcosim.series import read_table

QUIT = "import ctypes; ctypes.CDLL(None).exit(0)"
PARTIAL = ["result-partial.csv", "result-partial.html", "result-partial.nc", "verdict.json"]


def test_results_are_the_same_and_the_exit_code_is_that_of_the_expectations(call, project):
    assert call("run", "fill", "--out", "plain").code == 0
    assert call("run", "fill", "--out", "apart", "--isolate").code == 0
    assert (project / "plain" / "result.csv").read_bytes() == (
        project / "apart" / "result.csv"
    ).read_bytes()


def test_a_component_that_hangs_is_named_and_the_rows_before_it_are_kept(call, project):
    failed = call("run", "fill", "--isolate", "--timeout", "5", "--set", "lag.pause=60.0")
    assert failed.code == 1
    assert (
        "error: lag:\nfailed in the step from t = 0 s. Its process gave no answer to DoStep within 5 s"
        in failed.err
    )
    assert "Traceback" not in failed.err and failed.out == ""
    folder = project / "results" / "fill"
    assert sorted(file.name for file in folder.iterdir()) == PARTIAL
    table = read_table(folder / "result-partial.nc")
    assert table.attrs["complete"] == 0 and table["time"].values.tolist() == [0.0]


def test_an_exception_is_said_as_without_processes(call, project):
    failed = call("run", "fill", "--isolate", "--set", "lag.fails_at=2.0")
    assert failed.code == 1
    assert all(
        text in failed.err
        for text in ("error: lag:", "ValueError: the pump has run dry", "lag.py", "t = 2")
    )
    assert read_table(project / "results" / "fill" / "result-partial.nc")["time"].values[-1] == 2.0


def test_a_state_is_stored_and_continued_in_processes(call, project):
    assert call("run", "fill", "--out", "whole").code == 0
    assert (
        call(
            "run", "fill", "--out", "first", "--until", "2", "--store", "half.state", "--isolate"
        ).code
        == 0
    )
    assert call("run", "fill", "--out", "rest", "--from", "half.state", "--isolate").code == 0
    whole, rest = (read_table(project / name / "result.nc") for name in ("whole", "rest"))
    n = rest.sizes["time"]
    assert 1 < n < whole.sizes["time"]
    assert all(whole[name].values[-n:].tobytes() == rest[name].values.tobytes() for name in whole)


def test_a_time_limit_alone_and_one_that_is_none_are_refused(call, project):
    alone, none = (
        call("run", "fill", "--timeout", "5"),
        call("run", "fill", "--isolate", "--timeout", "0"),
    )
    assert (alone.code, none.code) == (2, 2)
    assert "Without isolate" in alone.err and "0 s is no time limit" in none.err


@pytest.mark.skipif(sys.platform != "linux", reason="the guard uses C's list of Linux")
@pytest.mark.parametrize("command", ["run fill", "simulate tank --stop-time 5 --step-size 0.1"])
@pytest.mark.parametrize("isolate", [[], ["--isolate"]])
def test_an_fmu_that_calls_exit_0_is_no_run_that_went_well(project, command, isolate):
    file = project / "fmus" / "lag" / "lag.py"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace('raise ValueError("the pump has run dry")', QUIT))
    main = [sys.executable, "-c", "from shipcosim.cli import main; main()"]
    started = [*main, *command.split(), "--set", "lag.fails_at=2.0", "--out", "out", *isolate]
    ended = subprocess.run(started, capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert "ended itself in DoStep" in ended.stderr if isolate else "--isolate" in ended.stderr
    assert not list(project.rglob("*.unfinished*"))


@pytest.mark.parametrize("isolate", [[], ["--isolate"]])
@pytest.mark.parametrize("end", [QUIT, "import os; os.abort()", "import os; os._exit(3)"])
def test_an_fmu_that_ends_its_process_at_the_start_has_one_exit_code(project, end, isolate):
    file = project / "fmus" / "lag" / "lag.py"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("self.y = 0.0", end))
    main = [sys.executable, "-c", "from shipcosim.cli import main; main()"]
    ended = subprocess.run(
        [*main, "run", "fill", "--out", "out", *isolate],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 1 and "Traceback" not in ended.stderr
    assert not list(project.rglob("*.unfinished*"))


@pytest.mark.parametrize("isolate", [[], ["--isolate"]])
def test_an_fmu_that_does_not_start_is_unusable_in_a_process_of_its_own_too(call, project, isolate):
    file = project / "fmus" / "lag" / "lag.py"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("self.y = 0.0", "raise ValueError('no licence')"))
    failed = call("run", "fill", "--out", "out", *isolate)
    assert failed.code == 2 and "no licence" in failed.err
