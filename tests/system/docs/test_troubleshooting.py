"""Each message of the page of troubleshooting that a command can provoke is what that command prints."""

import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from shipcosim.cli import app

SCENARIO = (
    'system = "gunnerus_dp"\nparameters = "gunnerus-33m9"\nstop_time = 10.0\nstep_size = 0.05\n'
)
EVENT = '[[events]]\ntime = 1.02\noverride = { "port.failed" = true }\n'
THRUSTER = '[[thrusters]]\nname = "port"\nkind = "azimuth"\nx = "-27 m"\ny = "3 m"\ndiameter = "2 m"\npower = "1 MW"\n'
SSD = """<ssd:SystemStructureDescription name="s" version="1.0"
 xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"><ssd:System name="s"><ssd:Elements>
<ssd:Component name="a" source="resources/gone.fmu"/></ssd:Elements></ssd:System></ssd:SystemStructureDescription>"""
FMU = """from shipcosim.fmi import Fmu, Output


class Bad(Fmu):
    y = Output("m", "depth")

    def step(self, t, h):
        raise ValueError("negative depth")
"""
FILES = {
    "key.toml": SCENARIO.replace("step_size", "stepsize"),
    "event.toml": SCENARIO + EVENT,
    "notime.csv": "a,b\n1,2\n",
    "short.csv": "time,north,east,heading\n0,0,0,0\n1,0,0,0\n2,0,0,0\n",
    "guess.csv": "time,x,y,yaw\n0,1,2,3\n1,1,2,3\n",
    "channels.toml": 'time = "time"\nsurg = "u"\n',
    "ship.toml": '[particulars]\nlength = "60 m"\nbreadth = "14 m"\ndraught = "4.5 m"\ndisplacement = "9000 t"\n'
    + THRUSTER,
    "ssp/s/SystemStructure.ssd": SSD,
    "fmus/bad/bad.py": FMU,
}
PROVOKED = {
    "There is no such scenario": ["run", "nosuch"],
    "There is no such system": ["replay", "short.csv", "--system", "nosuch"],
    "vessel has no variable 'mas'": ["run", "gust", "--until", "1", "--set", "vessel.mas=5"],
    "'10 rad' is in rad, where m/s is wanted": [
        "run",
        "gust",
        "--set",
        "environment.wind_speed=10 rad",
    ],
    "There is no engine": ["simulate", "gunnerus_dp", "--engine", "foo"],
    "cannot take the place of": ["run", "gust", "--component", "allocator=vessel"],
    "unknown key": ["check", "key.toml"],
    "is no multiple of the step size": ["run", "event.toml"],
    "does not exist. In": ["check", "ssp/s"],
    "parameters left out": ["simulate", "vessel", "--stop-time", "1", "--step-size", "0.1"],
    "failed in the step from": ["simulate", "bad", "--stop-time", "1", "--step-size", "0.1"],
    "has no column 'time'": ["check", "notime.csv"],
    "has a role": ["diagnose", "guess.csv"],
    "is no role": ["check", "short.csv", "--channels", "channels.toml"],
    "of a ship that hardly moves": ["diagnose", "short.csv"],
    "do not fit": ["check", "ship.toml"],
    "there is no DP system": ["check", "ship.toml"],
    "nothing says": ["capability", "otter_open"],
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "1000")
    return tmp_path


@pytest.mark.parametrize("message", PROVOKED)
def test_a_message_of_the_page_is_what_the_command_prints(message, folder, root):
    page = Path(root / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    assert f"| `{message}` |" in page
    done = CliRunner().invoke(app, PROVOKED[message])
    assert done.exit_code in (1, 2)
    assert message in " ".join((done.stdout + done.stderr).split())


def test_the_page_has_the_twenty_likeliest_errors(root):
    page = Path(root / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    rows = [line for line in re.findall(r"(?m)^\| (.*)$", page) if not line.startswith("you see")]
    assert len(rows) >= 20
