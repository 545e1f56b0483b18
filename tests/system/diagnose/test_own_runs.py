"""A run of one's own ship as a log: her own system explains it, and has what drives her."""

import numpy as np
from own_runs import own_run

import shipcosim as sc
from shipcosim.diagnose.pipeline import find_causes, read_measurements

SIZES = ["--length", "60 m", "--breadth", "14 m", "--draught", "4.5 m"]


def test_a_run_without_sensors_agrees_with_the_system_that_made_it(tmp_path, monkeypatch):
    """Nothing in it has noise: what the averages over its rows miss is no fault."""
    monkeypatch.chdir(tmp_path)
    own_run(tmp_path, "azimuths", SIZES)
    assert find_causes("run/result.nc", sc.read("tern_open").checked()).verdict == "consistent"


def test_a_run_of_screws_that_are_commanded_by_force_has_their_speed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    thrust = own_run(tmp_path, "screws", SIZES, minutes=1.0)["port.thrust"]
    log = read_measurements("run/result.nc", sc.read("tern_open").checked()).log
    assert np.corrcoef(np.sign(thrust) * np.sqrt(abs(thrust)), log["port_rpm"])[0, 1] > 0.99
