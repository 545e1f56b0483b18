"""Broken and hostile input: one error with file and place, no control characters, nothing left behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.checks import check_any
from shipcosim.cosim.slaves.unpacked import UnpackedFmus
from shipcosim.errors import Problem, ShipcosimError, printable, reading
from shipcosim.native.compiler import is_intact, keep_digest
from shipcosim.scenario.locations import line_of
from shipcosim.series import make_table, read_table, write_table
from shipcosim.temporary import temporary_folder

HEAD = "time [{unit}],north [m],east [m],heading [deg],surge [m/s],sway [m/s],yaw_rate [deg/s]\n"
# Names as FMI and SSP allow them: any text but those that end in what a header has for a unit.
NAMES = st.text(
    st.characters(min_codepoint=32, max_codepoint=0x2FF, exclude_categories=("Cc", "Cs", "Zs")),
    min_size=1,
    max_size=20,
)


@given(text=st.text(st.characters(exclude_categories=())))
@settings(max_examples=200, deadline=None)
def test_no_control_character_is_left_in_a_problem(text):
    shown = str(Problem(text, text, text))
    assert all(c in "\n\t" or c.isprintable() or ord(c) > 0x9F for c in shown)
    assert (
        shown.encode() is not None
        and "\x1b" not in shown
        and printable(printable(text)) == printable(text)
    )


@given(names=st.lists(NAMES, min_size=1, max_size=4, unique=True))
@settings(max_examples=60, deadline=None)
@pytest.mark.parametrize("ending", [".nc", ".csv"])
def test_every_name_comes_back_from_a_file(tmp_path_factory, ending, names):
    names = [name for name in names if name != "time"]
    times = np.arange(3.0)
    path = tmp_path_factory.mktemp("names") / f"table{ending}"
    columns = [(name, times + k, "m", "") for k, name in enumerate(names)]
    write_table(make_table(times, columns), path)
    back = read_table(path)
    assert {str(name) for name in back.data_vars} == set(names)
    for name, values, *_ in columns:
        assert np.array_equal(back[name], values)


@pytest.mark.parametrize("name", ["a/b", "/", ".", "..", "a.b/c", "%2F", "a//b"])
def test_names_that_netcdf_cannot_have_are_kept(tmp_path, name):
    table = make_table(np.arange(2.0), [(name, np.arange(2.0), "m", "")])
    write_table(table, tmp_path / "table.nc")
    assert list(read_table(tmp_path / "table.nc").data_vars) == [name]


@pytest.mark.parametrize(
    "error", [ValueError("x"), OSError(5, "Input/output error"), KeyError("k")]
)
def test_whatever_a_library_raises_names_the_file(error):
    with pytest.raises(ShipcosimError, match=r"^log\.csv: cannot be read: "), reading("log.csv"):
        raise error


ENDINGS = ["csv", "xlsx", "xls", "parquet", "nc", "json", "mat", "toml", "ssd", "ssv", "ssp", "fmu"]


@pytest.mark.skipif(not Path("/proc/self/mem").exists(), reason="reads a file that Linux refuses")
@pytest.mark.parametrize("ending", ENDINGS)
def test_a_file_on_a_broken_disk_is_named_with_what_the_system_says(tmp_path, ending):
    path = tmp_path / f"broken.{ending}"
    path.symlink_to("/proc/self/mem")
    problems = [str(problem).lower() for problem in check_any(str(path))]
    assert len(problems) == 1 and "cannot be read: input/output error." in problems[0]
    with pytest.raises(ShipcosimError, match=r"^\S*broken"):
        read_table(path)


@given(
    unit=st.sampled_from(["s", "ms", "us", "ns"]),
    step=st.sampled_from([1e-9, 1e-6, 1e-3, 0.1, 1.0]),
    begin=st.sampled_from([0.0, 1.7e9, 1.7e12, 1.7e15, 1.7e18]),
)
@settings(max_examples=40, deadline=None)
def test_a_wrong_unit_of_time_is_said_in_little_memory(call_check, unit, step, begin):
    rows = "".join(f"{begin + step * k!r},{0.1 * k},{0.2 * k},20,0.2,0,0\n" for k in range(60))
    size = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit]
    found = call_check(HEAD.format(unit=unit) + rows)
    if begin / size > 4.2e9 or step / size < 2e-4:
        assert any(problem.severity == "error" for problem in found)
    assert not any("fault of shipcosim" in str(problem) for problem in found)


@pytest.fixture(scope="module")
def call_check(tmp_path_factory):
    """Function: what the check of a log with this text finds."""
    from shipcosim.checks import check_any

    path = tmp_path_factory.mktemp("log") / "log.csv"

    def check(text):
        path.write_text(text, encoding="utf-8")
        try:
            return check_any(str(path))
        except ShipcosimError as error:
            return error.problems

    return check


def test_lines_of_many_keys_are_found_once():
    text = "".join(f"[[events]]\ntime = {k}\n" for k in range(3000))
    began = time.process_time()
    lines = [line_of(text, ("events", k, "time")) for k in range(3000)]
    assert lines == [2 * k + 2 for k in range(3000)]
    assert time.process_time() - began < 5.0


def test_a_damaged_library_of_the_cache_is_seen(tmp_path):
    made = tmp_path / "made.so"
    path = tmp_path / "library.so"
    made.write_bytes(b"\x7fELF" + bytes(1000))
    keep_digest(made, path)
    made.rename(path)
    assert is_intact(path)
    for content in (b"", path.read_bytes()[:300], path.read_bytes() + b"x"):
        path.write_bytes(content)
        assert not is_intact(path)
    beside = path.with_name("library.so.sha256")
    for digest in (b"", b"\xff\xfe\x80", b"0" * 63, bytes(64)):
        beside.write_bytes(digest)
        assert not is_intact(path)


def test_a_damaged_fmu_of_the_cache_is_unpacked_again(call, monkeypatch, tmp_path, project):
    call("build")
    own_fmu = project / "build" / "fmus" / "lag.fmu"
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "cache"))
    with UnpackedFmus() as unpacked:
        folder = unpacked.folder(own_fmu)
    scripts = [path for path in folder.rglob("*.py") if path.stat().st_size]
    content = scripts[0].read_bytes()
    scripts[0].write_bytes(b"")
    with UnpackedFmus() as unpacked:
        assert unpacked.folder(own_fmu) == folder
    assert scripts[0].read_bytes() == content


@pytest.mark.skipif(os.name != "posix", reason="Windows has no such question")
def test_folders_of_dead_processes_are_cleared_away(tmp_path):
    code = (
        "import os, sys, pathlib; from shipcosim.temporary import temporary_folder;"
        "f = temporary_folder(pathlib.Path(sys.argv[1])); os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=True)
    assert len(list(tmp_path.iterdir())) == 1
    with temporary_folder(tmp_path) as own:
        assert [path.name for path in tmp_path.iterdir()] == [Path(own).name]


def end_of(work):
    """Exit code and messages of work that is done in a child process."""
    code = f"import ctypes, os, sys; from shipcosim.cli.exit_guard import run_in_child; run_in_child(lambda: {work})"
    ended = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60
    )
    return ended.returncode, ended.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends children with their parent")
@pytest.mark.parametrize(
    ("call", "how"),
    [
        ("exit(0)", "ended the process"),
        ("_exit(0)", "ended the process"),
        ("_exit(7)", "ended the process"),
        ("quick_exit(0)", "ended the process"),
        ("abort()", "crashed (SIGABRT)"),
        ("strlen(0)", "crashed (SIGSEGV)"),
    ],
)
def test_a_library_that_ends_the_process_is_no_run_that_went_well(call, how):
    code, err = end_of(f"ctypes.CDLL(None).{call}")
    assert code == 1 and how in err and "--isolate" in err and err.count("\n") <= 3


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends children with their parent")
@pytest.mark.parametrize(
    ("work", "code"),
    [("None", 0), ("sys.exit(0)", 0), ("sys.exit(2)", 2), ("os.kill(os.getppid(), 15)", 128 + 15)],
)
def test_a_command_that_ends_by_itself_keeps_its_exit_code(work, code):
    wait = " or __import__('signal').pause()" if code > 128 else ""
    assert end_of(work + wait) == (code, "")


CLEARS_UP = """
import pathlib, signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's job in the background ignores it
from shipcosim.cli.exit_guard import run_in_child
from shipcosim.temporary import temporary_folder

def work():
    with temporary_folder(pathlib.Path(sys.argv[1])):
        try:
            print("at work", flush=True)
            time.sleep(30.0)
        except KeyboardInterrupt:
            time.sleep(0.5)
            sys.exit(130)

run_in_child(work)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has the process between")
@pytest.mark.parametrize("send", [os.kill, os.killpg] if sys.platform == "linux" else [])
def test_an_interrupt_of_the_whole_group_leaves_nothing_behind(tmp_path, send):
    command = [sys.executable, "-c", CLEARS_UP, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True) as process:
        assert process.stdout is not None and process.stdout.readline()
        send(process.pid, signal.SIGINT)
        assert process.wait(timeout=60) == 130
    assert not list(tmp_path.iterdir())


@given(
    limits=st.sampled_from([{"valid_range": [0.0, 10.0]}, {"valid_min": 0.0}, {"valid_max": 10.0}]),
    values=st.lists(st.floats(-100, 100), min_size=2, max_size=8),
)
@settings(max_examples=30, deadline=None)
def test_values_beyond_the_valid_range_are_missing(tmp_path_factory, limits, values):
    values = np.array(values)
    table = make_table(np.arange(float(len(values))), [("a", values, "m", "")])
    table["a"].attrs |= limits
    path = tmp_path_factory.mktemp("valid") / "table.nc"
    write_table(table, path)
    low = limits.get("valid_range", [limits.get("valid_min", -np.inf)])[0]
    high = limits.get("valid_range", [limits.get("valid_max", np.inf)])[-1]
    expected = np.where((values >= low) & (values <= high), values, np.nan)
    assert np.array_equal(read_table(path)["a"], expected, equal_nan=True)


def test_durations_are_seconds(tmp_path):
    pandas = pytest.importorskip("pandas")
    steps = pandas.to_timedelta([0, 1500, 3000], unit="ms")
    pandas.DataFrame({"time": steps, "a [m]": [1.0, 2.0, 3.0]}).to_parquet(tmp_path / "t.parquet")
    assert read_table(tmp_path / "t.parquet")["time"].values.tolist() == [0.0, 1.5, 3.0]
