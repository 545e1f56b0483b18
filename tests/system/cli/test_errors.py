"""Everything a user can get wrong on the real DP ship: each is refused in words, with exit code 2, and costs no result.

A refusal says where, what was found and what would be right; it is never a traceback of ours, and never our own fault.
"""

import ctypes
import os
import re
import shutil
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

SHORT = "scenarios/short.toml"
SSD = "ssp/gunnerus_dp/SystemStructure.ssd"
SSV = "ssp/gunnerus_dp/resources/gunnerus-33m9.ssv"
FMU = "build/fmus/tunnel_thruster.fmu"
TUNNEL = "fmus/tunnel_thruster/tunnel_thruster.py"
LEVELS = "time [s],tunnel_rpm [rpm]\n"
OPEN = ("simulate", "ssp/gunnerus_open", "--stop-time", "1", "--step-size", "0.05")
NOISE = bytes(range(256)) * 8
LATIN = "Gunnerus på prøvetur".encode("latin-1")

needs_posix = pytest.mark.skipif(
    sys.platform == "win32", reason="Windows has neither these limits nor these rights"
)


def refused(result, *said, code=2):
    """Assert that a command refused its input in the house style and said all this."""
    for text in said:
        assert text in result.err, result.err
    assert result.code == code
    assert result.err.startswith(("error: ", "Usage: ", "PARTIAL ")), result.err
    assert "fault of shipcosim" not in result.err
    assert not re.search(r'File ".*(?<!fmus)/(cli|cosim|ssp|fmi)/\w+\.py"', result.err), result.err
    return True


def results():
    """Contents of everything in the results of the scenario, by name."""
    return {path.name: path.read_bytes() for path in Path("results").rglob("*") if path.is_file()}


def old_results():
    """Files of an earlier run, which stand for any: the same as `results`."""
    Path("results/short").mkdir(parents=True)
    for name in ("result.nc", "result.csv", "report.html"):
        Path("results/short", name).write_text(f"old {name}", encoding="utf-8")
    return results()


def change(file, old, new):
    """Replace a text that is in the file."""
    path = Path(file)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def no_source(name):
    """Leave only the built FMU, which is not built anew then."""
    shutil.rmtree(f"fmus/{name}")


def not_shipped():
    """Have the system name its tunnel thruster as no FMU is named that is shipped, and leave the built one only."""
    no_source("tunnel_thruster")
    change(SSD, "resources/tunnel_thruster.fmu", "resources/own_thruster.fmu")
    return Path(FMU).rename(Path(FMU).with_name("own_thruster.fmu"))


# what is given on the command line


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["--set", "vessel.x_start=nan"],
            ["set (--set): vessel.x_start:", "nan is not a finite number", "in m."],
        ),
        (
            ["--set", "vessel.mass=inf"],
            ["set (--set): vessel.mass:", "inf is not a finite number", "in kg."],
        ),
        (["--set", "vessel.mas=1"], ["vessel has no variable 'mas'", "Did you mean 'mass'?"]),
        (
            ["--set", "vesel.mass=1"],
            ["There is no component or connector 'vesel'", "Did you mean 'vessel'?"],
        ),
        (
            ["--set", "mass=1"],
            ["There is no component or connector 'mass'", "There is: allocator, "],
        ),
        (
            ["--set", "vessel.tau_X_1=5"],
            ["It is connected: port.tau_X gives its value.", "Set what feeds it"],
        ),
        (["--set", "vessel.x=3"], ["causality output", "Set parameters and inputs."]),
        (
            ["--set", "reference.x_set=far"],
            ["'far' is no Real. Give a number, with a decimal point, in m."],
        ),
        (["--set", "reference.x_set=1,5"], ["'1,5' is no Real", "with a decimal point"]),
        (["--set", "environment.seed=1.5"], ["1.5 is no Integer. Give a whole number."]),
        (["--set", "environment.seed=3000000000"], ["too large for an Integer", "to 2147483647"]),
        (["--set", "port.failed=1"], ["1 is no Boolean. Give true or false."]),
        (["--set", "vessel.mass=-1"], ["mass cannot be -1 kg. Allowed: at least 1 kg."]),
        (
            ["--set", "vessel.mass"],
            ["'vessel.mass' sets nothing. Right would be component.name=value."],
        ),
        (
            ["--set", "vessel.mass=5e5", "--set", "vessel.mass = 6e5"],
            ["--set:", "'vessel.mass' is given twice. Keep one of them."],
        ),
        (["--engine", "fmpi"], ["There is no engine 'fmpi'", "Did you mean 'fmpy'?"]),
        (
            ["--until", "0.52"],
            ["until:", "0.52 s is no whole number of steps of 0.05 s", "0.5 s would be."],
        ),
        (["--until", "7"], ["until:", "from 0 s to 7 s", "not after the stop time, 1 s"]),
        (["--until", "nan"], ["'--until'", "Give seconds, or a text with a unit"]),
        (["--stop", "5"], ["No such option: --stop"]),
        (["--from", "absent.state"], ["absent.state:", "No such file"]),
        (["--from", SHORT], [f"{SHORT}:", "is no snapshot of a run", "--store"]),
        (["--store", "scenarios"], ["scenarios:", "This is a folder.", "--store"]),
        (["--store", "absent/one.state"], ["absent/one.state:", "There is no such folder"]),
        (["--out", SHORT], [f"{SHORT}:", "is a file, not a folder", "--out"]),
        (["--out", f"{SHORT}/deeper"], [f"{SHORT} is a file, not a folder", "--out"]),
    ],
    ids=lambda value: " ".join(value) if value[0].startswith("--") else "",
)
def test_options_of_a_run(call, gunnerus, arguments, said):
    assert refused(call("run", "short", *arguments), *said) and not results()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rnu", "short"], ["Usage: shipcosim", "No such command 'rnu'. Did you mean 'run'?"]),
        (["run"], ["Usage: shipcosim run", "Missing argument 'SCENARIO'"]),
        (["run", "shrot"], ["There is no such scenario file. There is: ", "Did you mean 'short'?"]),
        (
            ["run", "ssp"],
            ["ssp:", "There is no scenario file in this folder.", "Name a .toml file."],
        ),
        (
            ["run", "scenarios", "--store", "end.state"],
            ["scenarios:", "a folder of scenarios", "leave out --store"],
        ),
        (
            ["run", SSD],
            ["This is a system, not a scenario.", f"`shipcosim simulate {SSD}` runs it."],
        ),
        (["run", SSV], [f"{SSV}, line 1:", "is no TOML", "Scenarios are text files in TOML"]),
        (
            ["simulate", "absent.ssp"],
            ["absent.ssp:", "There is no such system. There is: ", "gunnerus_dp"],
        ),
        (["simulate", SHORT], ["This is no system.", f"`shipcosim run {SHORT}`"]),
        (["simulate", "scenarios"], ["scenarios/SystemStructure.ssd:", "No such file"]),
        ([*OPEN[:-1], "0"], ["step_size (--step-size):", "greater than 0"]),
        ([*OPEN[:-1], "-0.05"], ["step_size (--step-size):", "greater than 0"]),
        (
            [*OPEN[:-1], "0.3"],
            ["stop_time = 1 s is no multiple of the step size 0.3 s. The nearest would be 0.9 s."],
        ),
        ([*OPEN[:-1], "1e-12"], ["1e+12 steps", "larger steps"]),
        ([*OPEN, "--start-time", "nan"], ["'--start-time'", "Give seconds, or a text with a unit"]),
        (
            [*OPEN, "--start-time", "5"],
            ["the run would go from 5 s to 1 s.", "Its end must lie after 5 s"],
        ),
        ([*OPEN, "--parameters", "absent.ssv"], ["absent.ssv:", "No such file"]),
        ([*OPEN, "--parameters", SHORT], [f"{SHORT}, line 1:", "Not well-formed XML"]),
        ([*OPEN, "--inputs", "absent.csv"], ["absent.csv:", "no such file"]),
        ([*OPEN, "--inputs", "scenarios"], ["scenarios:", "is a folder, no table.", ".csv"]),
        ([*OPEN, "--inputs", SHORT], ["'.toml' is no table.", ".csv"]),
        (["build", "vesel"], ["There is no such FMU or system.", "Did you mean 'vessel'?"]),
        (["build", "reference", "--out", SHORT], [SHORT, "cannot be written: Not a directory"]),
        (["check", "absent.ssp"], ["absent.ssp:", "There is no such file or folder."]),
    ],
    ids=lambda value: (
        " ".join(value[-2:]) if value[0] in ("rnu", "run", "simulate", "build", "check") else ""
    ),
)
def test_arguments(call, gunnerus, arguments, said):
    assert refused(call(*arguments), *said) and not results()


# what is in the files


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "step_size   = 0.05",
            "step_size = 0",
            ["line 5:", "step_size = 0. It should be greater than 0."],
        ),
        ("step_size   = 0.05", "step_size = -0.05", ["line 5:", "It should be greater than 0."]),
        ("step_size   = 0.05", "step_size = nan", ["line 5:", "It should be a finite number."]),
        (
            "step_size   = 0.05",
            'step_size = "0,05"',
            ["line 5:", 'step_size = "0,05".', "with a decimal point"],
        ),
        (
            "step_size   = 0.05",
            "step_size = 0.3",
            ["line 4:", "no multiple of the step size 0.3 s", "would be 0.9 s"],
        ),
        (
            "step_size   = 0.05",
            "step_size = 1e-30",
            ["line 4:", "1e+30 steps", "take larger steps"],
        ),
        ("stop_time   = 1.0", "stop_time = 1e300", ["line 4:", "2e+301 steps", "stop earlier"]),
        ("stop_time   = 1.0", "stop_time = -1.0", ["line 4:", "It should be greater than 0."]),
        (
            "stop_time ",
            "stoptime ",
            ["line 4:", "unknown key 'stoptime'", "Did you mean 'stop_time'?"],
        ),
        (
            "time     = 0.5",
            "time = 0.52",
            ["line 11:", "no multiple of the step size 0.05 s", "would be 0.5 s"],
        ),
        ("time     = 0.5", "time = -0.5", ["line 11:", "greater than or equal to 0"]),
        ('x_set" = 1.0', 'x_set" = nan', ["line 12:", "nan is not a finite number"]),
        (
            'x_set" = 1.0',
            'xset" = 1.0',
            ["line 12:", "reference has no variable 'xset'", "Did you mean 'x_set'?"],
        ),
        ("override", "overide", ["line 12:", "unknown key 'overide'", "Did you mean 'override'?"]),
        ('wind_speed" = 8.0', 'wind_speed" = nan', ["line 8:", "nan is not a finite number"]),
        (
            'wind_speed"',
            'wind_sped"',
            ["environment has no variable 'wind_sped'", "Did you mean 'wind_speed'?"],
        ),
        (
            '"environment.wind_speed"',
            '"vessel.wind_north"',
            ["It is connected: environment.wind_north gives its value"],
        ),
        ('"vessel.x"', '"vessel.xx"', ["line 15:", "vessel has no variable 'xx'"]),
        ('"vessel.x"', '"vessel.mass"', ["line 15:", "is not recorded: it is a Real parameter"]),
        ("within = 5.0", "within = -5.0", ["line 17:", "greater than 0"]),
        (
            "within = 5.0",
            "within = 5.0\nduring = [0.5]",
            ["line 18:", "during = [0.5].", "more values"],
        ),
        (
            '"gunnerus_dp"',
            '"gunerus_dp"',
            ["line 2:", "there is no system 'gunerus_dp'", "Did you mean 'gunnerus_dp'?"],
        ),
        ('"gunnerus_dp"', "7", ["line 2:", "It should be a text in quotes."]),
        (
            'system      = "gunnerus_dp"',
            "",
            ["names no system. There is: blueboat_open, four_azimuths,"],
        ),
        (
            '"gunnerus-33m9"',
            '"gunnerus-34m"',
            ["line 3:", "no parameter set 'gunnerus-34m'", "gunnerus-28m9"],
        ),
        ("step_size ", "stop_time ", ["line 5:", "is no TOML: Cannot overwrite a value."]),
        ("within = 5.0\n", 'within = "', ["is no TOML: Unterminated string"]),
    ],
)
def test_scenario(call, gunnerus, old, new, said):
    change(SHORT, old, new)
    assert refused(call("run", "short"), SHORT, *said) and not results()
    found = call("check", SHORT)
    assert found.code == 1 and all(text in found.out for text in said)


CONNECTIONS = "<ssd:Connections>"


def wired(start, end):
    """Connections with one more: ``component.connector``."""
    ends = zip(("start", "end"), (start.split("."), end.split(".")), strict=True)
    attributes = " ".join(
        f'{side}Element="{element}" {side}Connector="{name}"' for side, (element, name) in ends
    )
    return f"{CONNECTIONS}<ssd:Connection {attributes}/>"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            CONNECTIONS,
            wired("vessel.x", "sensors.xx"),
            ["sensors has no input 'xx'", "Did you mean 'x'?"],
        ),
        (
            CONNECTIONS,
            wired("vesel.x", "sensors.x"),
            ["There is no element 'vesel'", "Did you mean 'vessel'?"],
        ),
        (
            CONNECTIONS,
            wired("vessel.y", "sensors.x"),
            ["A second connection into sensors.x.", "Remove one of them."],
        ),
        (
            CONNECTIONS,
            wired("vessel.y", "sensors.x_1_meas"),
            ["neither takes one", "Connect an output to an input."],
        ),
        (
            CONNECTIONS,
            wired("vessel.y", "vessel.tau_X_6"),
            ["vessel.y is in m, vessel.tau_X_6 in N; these cannot"],
        ),
        (
            'tau_X_6" kind="input"><ssc:Real unit="N"',
            'tau_X_6" kind="input"><ssc:Real unit="m"',
            ['Write unit="N".'],
        ),
        (
            "resources/sensors.fmu",
            "resources/sensor.fmu",
            ["'resources/sensor.fmu' does not exist", "Did you mean"],
        ),
        (
            "gunnerus-33m9.ssv",
            "gunnerus-33m.ssv",
            ["'resources/gunnerus-33m.ssv' does not exist", "gunnerus-33m9.ssv"],
        ),
        ("<ssd:System ", "<!-- \0 --><ssd:System ", ["Not well-formed XML"]),
        ("</ssd:Elements>", "", ["Not well-formed XML: Opening and ending tag mismatch"]),
        (
            "<ssd:SystemStructureD",
            '<!DOCTYPE x [<!ENTITY a "b">]><ssd:SystemStructureD',
            ["Remove <!DOCTYPE ...>"],
        ),
    ],
)
def test_system(call, gunnerus, old, new, said):
    change(SSD, old, new)
    assert refused(call("run", "short"), SSD, *said) and not results()
    found = call("check", "ssp/gunnerus_dp")
    assert found.code == 1 and all(text in found.out for text in said)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            'value="531000.0"',
            'value="NaN"',
            ["line 4: vessel.mass:", "'NaN' is not a finite number."],
        ),
        ('value="531000.0"', 'value="heavy"', ["line 5:", "'heavy' is not a number."]),
        (
            'value="531000.0"',
            'value="-1"',
            ["vessel.mass cannot be -1 kg. Allowed: at least 1 kg."],
        ),
        (
            'unit="kg"',
            'unit="m"',
            ["the value is in m, vessel.mass in kg; these cannot", "Correct the unit."],
        ),
        (
            "vessel.mass",
            "vessel.masss",
            ["vessel has no parameter 'vessel.masss'", "Did you mean 'vessel.mass'?"],
        ),
        ("vessel.mass", "vesel.mass", ["There is no element 'vesel'", "Did you mean 'vessel'?"]),
        (
            "vessel.mass",
            "vessel.A11",
            ["The set has this parameter already, in line 4.", "Keep one of them."],
        ),
    ],
)
def test_parameter_set(call, gunnerus, old, new, said):
    change(SSV, old, new)
    assert refused(call("run", "short"), SSV, *said) and not results()


@pytest.mark.parametrize(
    ("file", "content", "said"),
    [
        (SHORT, NOISE, ["line 2:", "is not UTF-8 text: byte 0x80", "Save the file in UTF-8."]),
        (SHORT, b"# " + LATIN, ["line 1:", "is not UTF-8 text: byte 0xe5"]),
        (SHORT, b"", ["'stop_time' is missing.", "'step_size' is missing."]),
        (SSD, NOISE, ["The file is not UTF-8.", "save it with this encoding"]),
        (SSD, b"<a>" + LATIN + b"</a>", ["The file is not UTF-8."]),
        (SSD, b"", ["Not well-formed XML: Document is empty."]),
        (
            SSD,
            b"<a/>",
            ["Its outermost element is <a>. Right would be <SystemStructureDescription "],
        ),
        (SSV, NOISE, ["The file is not UTF-8."]),
        (SSV, b"<a/>", ["Its outermost element is <a>. Right would be <ParameterSet "]),
        (FMU, NOISE, ["Damaged or incomplete archive", "Build, copy or export it again."]),
        (FMU, b"", ["Damaged or incomplete archive"]),
        (FMU, b"version https://git-lfs.github.com/spec/v1\n", ["Git LFS", "git lfs pull"]),
        ("build/ssp/garbage.ssp", NOISE, ["Damaged or incomplete archive"]),
        ("build/ssp/garbage.ssp", b"", ["Damaged or incomplete archive"]),
    ],
    ids=lambda value: value.rpartition("/")[2] if isinstance(value, str) else "",
)
def test_file_that_is_something_else(call, gunnerus, file, content, said):
    no_source("tunnel_thruster")
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).unlink(missing_ok=True)  # it may be a link
    Path(file).write_bytes(content)
    command = ("simulate", file) if file.endswith(".ssp") else ("run", "short")
    assert refused(call(*command), file, *said) and not results()
    found = call("check", file)
    assert found.code == 1 and all(text in found.out for text in said)


@pytest.mark.parametrize("file", [SSD, SSV, FMU])
def test_file_cut_short(call, gunnerus, file):
    no_source("tunnel_thruster")
    content = Path(file).read_bytes()
    Path(file).unlink()  # it may be a link
    Path(file).write_bytes(content[: len(content) // 2])
    said = "Damaged or incomplete archive" if file == FMU else "Not well-formed XML"
    assert refused(call("run", "short"), file, said) and not results()


@pytest.mark.parametrize("file", [SSD, SSV, FMU])
def test_folder_in_place_of_a_file(call, gunnerus, file):
    path = not_shipped() if file == FMU else Path(file)
    path.unlink()
    path.mkdir()
    said = "Is a directory" if file == SSD else f"'resources/{path.name}' is a folder, not a file."
    assert refused(call("run", "short"), SSD, said) and not results()


def test_missing_fmu_is_named_with_the_place_that_asks_for_it_and_where_it_was_sought(
    call, gunnerus
):
    not_shipped().unlink()
    said = "In ssp/gunnerus_dp/resources and build/fmus and "
    assert refused(
        call("run", "short"), f"{SSD}, line ", "'resources/own_thruster.fmu' does not exist", said
    )
    assert not results()


def test_values_that_are_not_used_and_events_that_never_act_are_remarked(call, gunnerus):
    change(SSV, "vessel.centre_of_gravity_x", "towed_body.mass")
    change(SHORT, "time     = 0.5", "time = 5.0")
    done = call("run", "short")
    assert done.code == 0
    assert (
        f"remark: {SSV}, line 20: towed_body.mass:\nThere is no element 'towed_body' in this system"
        in done.err
    )
    assert (
        f"remark: {SHORT}, line 11:\nthe event at 5 s never acts: the run ends at 1 s." in done.err
    )


def test_a_parameter_under_another_name_is_remarked_and_missed(call, gunnerus):
    change(SSV, "vessel.mass", "towed_body.mass")
    done = call("run", "short")
    assert done.code == 2
    assert (
        f"remark: {SSV}, line 4: towed_body.mass:\nThere is no element 'towed_body' in this system"
        in done.err
    )
    assert "parameters left out, which have no value of their own: mass [kg]" in done.err


def test_files_of_windows_editors_are_read(call, gunnerus):
    """With the mark that they put before UTF-8, and their ends of lines."""
    text = Path(SHORT).read_text(encoding="utf-8")
    Path(SHORT).write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert call("check", SHORT).code == 0


# what feeds the inputs


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            LEVELS + "0,10\n0.5,nan\n1,10\n",
            ["in.csv: tunnel_rpm:", "is nan at 0.5 s.", "Fill or drop such rows"],
        ),
        (LEVELS + "0,10\n0.5,\n1,10\n", ["in.csv: tunnel_rpm:", "is nan at 0.5 s."]),
        (LEVELS + "0,10\nnan,10\n1,10\n", ["The time of row 2 is nan.", "Drop such rows."]),
        (
            LEVELS + "0,10\n0.7,3\n0.5,10\n1,3\n",
            ["The time of row 3 is 0.5 s, after 0.7 s", "Sort the rows"],
        ),
        (
            LEVELS + "0.5,10\n1,10\n",
            ["The table goes from 0.5 s to 1 s, the run from 0 s to 1 s.", "Start later"],
        ),
        (LEVELS + "0,10\n0.5,10\n", ["The table goes from 0 s to 0.5 s", "stop earlier"]),
        (LEVELS, ["in.csv:", "no row"]),
        ("", ["in.csv:", "is empty."]),
        (
            LEVELS.replace("rpm [rpm]", "rpms [rpm]") + "0,1\n1,1\n",
            ["no input 'tunnel_rpms'", "'tunnel_rpm'?"],
        ),
        (
            LEVELS.replace("[rpm]", "[m]") + "0,1\n1,1\n",
            ["cannot convert 'm' into 'rpm'", "measure different things"],
        ),
        (
            LEVELS.replace("[rpm]", "[umdr]") + "0,1\n1,1\n",
            ["'umdr' is not known.", "Units are written like"],
        ),
        (
            LEVELS.replace("[s]", "[m]") + "0,1\n1,1\n",
            ["column 'time':", "cannot convert 'm' into 's'", "It should be in s."],
        ),
        (
            LEVELS.replace("time", "t") + "0,1\n1,1\n",
            ["has no column 'time'", "It should have 'time [s]'."],
        ),
        (
            LEVELS + "0,10\n0.5,1,2\n1,10\n",
            ["row 3:", "has 3 cells, and the header has 2", "separated by commas"],
        ),
        (
            LEVELS + "0,full\n1,full\n",
            ["column 'tunnel_rpm':", "holds texts, not numbers, as 'full'."],
        ),
        (NOISE, ["in.csv:"]),
        (
            b"time [s],tunnel_rpm [\xb0]\n0,1\n1,1\n",
            ["in.csv: tunnel_rpm:", "cannot convert '°' into 'rpm'"],
        ),
    ],
)
def test_table_of_inputs(call, gunnerus, table, said):
    Path("in.csv").write_bytes(table if isinstance(table, bytes) else table.encode())
    assert refused(call(*OPEN, "--inputs", "in.csv"), *said) and not results()


@pytest.mark.parametrize("name", ["in.nc", "in.csv.gz", "in.parquet"])
def test_table_of_inputs_that_is_garbage(call, gunnerus, name):
    Path(name).write_bytes(NOISE)
    assert refused(call(*OPEN, "--inputs", name), f"{name}:") and not results()


# what goes wrong during a run


def spoil(old, new):
    """Change the tunnel thruster's FMU, so that it is built anew."""
    change(TUNNEL, old, new)
    later = time.time() + 5.0
    os.utime(TUNNEL, (later, later))


def spoil_step(line):
    spoil("    def step(self, t, h):\n", f"    def step(self, t, h):\n        {line}\n")


def test_exception_in_an_fmu_shows_its_traceback_component_and_time(call, gunnerus):
    before = old_results()
    spoil_step("if t > 0.49: raise ValueError('the shaft has broken')")
    failed = call("run", "short")
    assert refused(
        failed,
        "error: tunnel:\n",
        "tunnel at t = 0.5 s: exception",
        "ValueError: the shaft has broken",
        code=1,
    )
    assert (
        re.search(r'File "tunnel_thruster.py", line \d+, in step', failed.err)
        and "PyObject" not in failed.err
    )
    after = results()
    assert {name: after.pop(name) for name in before} == before
    partial = ["result-partial.csv", "result-partial.html", "result-partial.nc", "verdict.json"]
    assert sorted(after) == partial


def test_nan_in_an_fmu_is_named_with_variable_component_and_time(call, gunnerus):
    spoil("    def _write(self):\n", "    def _write(self):\n        self.power = 0.0\n")
    spoil("= powers(state, self.tunnel)", "= (float('nan') if state.torque else 0.0), 0.0")
    failed = call("run", "short")
    assert refused(
        failed,
        "error: tunnel:\n",
        "tunnel at t = ",
        "output 'power' is nan, not a finite number",
        code=1,
    )
    assert "result.nc" not in results()


def test_failure_at_the_start_has_no_rows_to_keep(call, gunnerus):
    spoil("    def start(self):\n", "    def start(self):\n        raise ValueError('no oil')\n")
    assert refused(
        call("run", "short"), "error: tunnel:\nfailed at the start.", "ValueError: no oil"
    )
    assert not results()


def test_table_in_a_parameter_that_makes_no_sense_is_shown(call, gunnerus):
    failed = call("run", "short", "--set", "vessel.wind_table=banana")
    assert refused(
        failed, "error: vessel:\n", "table, row 1: 'banana' is not numbers separated by blanks."
    )
    assert not results()


def test_values_beyond_all_bounds_fail_by_name(call, gunnerus):
    failed = call("run", "short", "--set", "environment.current_speed=1e200")
    assert failed.code == 2 and not results()
    remark, error = failed.err.split("error: vessel:\n")
    assert remark.startswith("remark: environment.current_speed:\n1e+200 m/s is very much")
    assert "is inf, not a finite number" in error


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "    def step(self, t, h):\n",
            "    def step(self, t, h)\n",
            ["is not Python: expected ':'", ", line "],
        ),
        (
            "from shipcosim.fmi",
            "import scipy_\nfrom shipcosim.fmi",
            ["imports scipy_.", "An FMU has Python, NumPy"],
        ),
        ('Input("N"', 'Input("Nn"', ["unit 'Nn'", "is not known"]),
    ],
)
def test_fmu_that_cannot_be_built_leaves_the_old_one(call, gunnerus, old, new, said):
    before = Path(FMU).read_bytes()
    spoil(old, new)
    assert refused(call("run", "short"), TUNNEL, *said) and not results()
    assert (
        refused(call("build", "tunnel_thruster"), TUNNEL, *said)
        and Path(FMU).read_bytes() == before
    )


def test_debug_adds_the_traceback(call, gunnerus):
    failed = call("run", "short", "--set", "vessel.mas=1", "--debug")
    assert (
        failed.code == 2
        and failed.err.startswith("error: ")
        and "Traceback (most recent call last)" in failed.err
    )


# what the machine refuses


def command(*arguments, before="", **options):
    """The command in a process of its own, which runs some Python before; what it said and its exit code."""
    # Where files may not grow it would leave half of a file of compiled code to all that come after.
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    start = [sys.executable, "-c", f"{before}\nfrom shipcosim.cli import main; main()", *arguments]
    done = subprocess.run(
        start, env=environment, capture_output=True, text=True, timeout=600, **options
    )
    assert "Traceback" not in done.stderr and "fault of shipcosim" not in done.stderr, done.stderr
    return done


@pytest.mark.parametrize(
    "arguments",
    [
        ("simulate", "x.fmu", "--out", ""),
        ("simulate", "x.fmu", "--out="),
        ("simulate", "", "--out", "x"),
        ("simulate", "x.fmu", "--junit", "", "-q"),
        ("check", "x.fmu", ""),
    ],
)
def test_an_empty_argument_is_refused_and_leaves_nothing(tmp_path, arguments):
    done = command(*arguments, cwd=tmp_path)
    assert done.returncode == 2 and "is empty" in done.stderr and done.stderr.count("\n") <= 3
    assert not list(tmp_path.iterdir())


def limit_file_size(size):
    """What a full disk does, from the kernel: no file grows beyond this. [bytes]"""
    import resource

    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def give_up_rights():
    """Make root an ordinary owner of files: what it starts may no longer do what file modes forbid."""
    if os.geteuid() == 0:
        for capability in (1, 2):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
            ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


LIMITED_WRITING = """
import resource
import shipcosim.{module} as module
write = module.{function}
def limited(*arguments, **options):
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
    return write(*arguments, **options)
module.{function} = limited
"""


@needs_posix
@pytest.mark.parametrize(
    ("module", "function", "file"),
    [("series", "write_table", "result.nc"), ("results.shown", "write_file", "report.html")],
)
def test_full_disk_costs_no_old_result_and_leaves_no_part_of_a_new_one(
    gunnerus, module, function, file
):
    before = old_results()
    done = command("run", "short", before=LIMITED_WRITING.format(module=module, function=function))
    assert done.returncode == 2
    assert f"error: results/short/{file}:\ncannot be written: File too large." in done.stderr
    assert "MB are needed." in done.stderr
    assert results() == before


@needs_posix
def test_full_disk_for_temporary_files_is_named(gunnerus, tmp_path, monkeypatch):
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(tmp_path / "nothing unpacked yet"))
    done = command("run", "short", preexec_fn=partial(limit_file_size, 20_000))
    assert done.returncode == 2 and not results()
    assert re.search(
        r"error: .*\.fmu:\nCannot be unpacked into .*: File too large\. Make room there",
        done.stderr,
    )


@needs_posix
def test_full_disk_leaves_the_old_fmu(gunnerus):
    before = Path(FMU).read_bytes()
    done = command("build", "tunnel_thruster", preexec_fn=partial(limit_file_size, 20_000))
    assert (
        done.returncode == 2 and f"error: {FMU}:\ncannot be written: File too large." in done.stderr
    )
    assert Path(FMU).read_bytes() == before and not list(Path("build/fmus").glob("*part*"))


@needs_posix
def test_folder_without_permission_is_said_before_the_run(gunnerus):
    before = old_results()
    Path("results/short").chmod(0o555)
    try:
        done = command("run", "short", "--until", "0.1", preexec_fn=give_up_rights)
    finally:
        Path("results/short").chmod(0o755)
    assert done.returncode == 2
    said = "error: results/short:\nThere is no permission to write in results/short. Choose another folder (--out)."
    assert said in done.stderr
    assert results() == before


@needs_posix
def test_files_without_permission_are_named(gunnerus):
    no_source("tunnel_thruster")
    for file in (SHORT, SSV, FMU):
        Path(file).unlink()  # it may be a link
        Path(file).touch(mode=0)
    done = command("check", SHORT, SSV, FMU, preexec_fn=give_up_rights)
    assert done.returncode == 1
    for file in (SHORT, SSV, FMU):
        assert re.search(
            rf"error: {re.escape(file)}:\n[Cc]annot be read: Permission denied\.", done.stdout
        ), done.stdout
