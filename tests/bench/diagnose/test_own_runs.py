"""At night: runs of new ships of all sizes, without sensors, agree with their own systems."""

import pytest
from own_runs import own_run
from typer.testing import CliRunner

import shipcosim as sc
from shipcosim.cli.app import app
from shipcosim.diagnose.pipeline import find_causes

SIZES = {12: (4.0, 1.2), 35: (9.0, 3.0), 60: (14.0, 4.5), 120: (22.0, 6.0)}  # m


def _sizes(length):
    breadth, draught = SIZES[length]
    return ["--length", f"{length} m", "--breadth", f"{breadth} m", "--draught", f"{draught} m"]


@pytest.mark.parametrize("propulsion", ["azimuths", "screws"])
@pytest.mark.parametrize("length", SIZES)
def test_a_run_of_a_new_ship_agrees_with_her_own_system(length, propulsion, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    own_run(tmp_path, propulsion, _sizes(length))
    assert find_causes("run/result.nc", sc.read("tern_open").checked()).verdict == "consistent"


@pytest.mark.parametrize("propulsion", ["azimuths", "rudder"])
@pytest.mark.parametrize("length", [12, 60])
def test_a_turning_circle_of_a_new_ship_agrees_too(length, propulsion, tmp_path, monkeypatch):
    """At her service speed, with units that turn by many degrees from row to row."""
    monkeypatch.chdir(tmp_path)
    asked = ["new", "ship", "tern", *_sizes(length), "--propulsion", propulsion, "--yes"]
    made = CliRunner().invoke(app, asked)
    assert made.exit_code == 0, made.output
    sc.run("tern_circle", out="run")
    assert find_causes("run/result.nc", sc.read("tern_open").checked()).verdict == "consistent"
