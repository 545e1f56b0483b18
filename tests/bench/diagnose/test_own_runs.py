"""At night: runs of new ships of all sizes, without sensors, agree with their own systems."""

import pytest
from own_runs import own_run

import shipcosim as sc
from shipcosim.diagnose.pipeline import find_causes

SIZES = {12: (4.0, 1.2), 35: (9.0, 3.0), 60: (14.0, 4.5), 120: (22.0, 6.0)}  # m


@pytest.mark.parametrize("propulsion", ["azimuths", "screws"])
@pytest.mark.parametrize("length", SIZES)
def test_a_run_of_a_new_ship_agrees_with_her_own_system(length, propulsion, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    breadth, draught = SIZES[length]
    sizes = ["--length", f"{length} m", "--breadth", f"{breadth} m", "--draught", f"{draught} m"]
    own_run(tmp_path, propulsion, sizes)
    assert find_causes("run/result.nc", sc.read("tern_open").checked()).verdict == "consistent"
