"""A run of one's own ship as a log: her own system explains it, and has what drives her."""

import numpy as np
import pytest
from own_runs import own_run

import shipcosim as sc
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.screening import screened
from shipcosim.diagnose.pipeline import find_causes, problem_of, read_measurements
from shipcosim.errors import ShipcosimError

SIZES = ["--length", "60 m", "--breadth", "14 m", "--draught", "4.5 m"]


def test_a_run_without_sensors_agrees_with_the_system_that_made_it(tmp_path, monkeypatch):
    """Nothing in it has noise: what the averages over its rows miss is no fault."""
    monkeypatch.chdir(tmp_path)
    own_run(tmp_path, "azimuths", SIZES)
    assert find_causes("run/result.nc", sc.read("tern_open").checked()).verdict == "consistent"


def test_what_waves_do_on_a_turn_is_noise_and_no_cause(tmp_path):
    """The noise to start from is too small for it, and a scale of the velocity looked 3,000 nats likelier than none."""
    sc.run("allocation/heading_change_optimal", until=250.0, out=tmp_path)
    read = read_measurements(tmp_path / "result.nc", sc.read("gunnerus_open").checked())
    problem = problem_of(read).problem
    gains = {cause.label: gain for gain, cause, _ in screened(problem, fitted(problem))}
    assert gains["velocity_scale"] < 10.0


def test_gusts_are_no_wrong_label_of_the_wind(tmp_path):
    """Gusts at both ends of a part looked like another label, and it was named at 0.99."""
    sc.run("prediction/drift_prediction", out=tmp_path)
    found = find_causes(tmp_path / "result.nc", sc.read("gunnerus_open").checked())
    assert [finding.cause for finding in found.findings] == ["current"]
    current = found.findings[0].parameters
    assert current["north"].estimate == pytest.approx(0.3 * np.cos(np.radians(200.0)), abs=0.03)
    assert current["east"].estimate == pytest.approx(0.3 * np.sin(np.radians(200.0)), abs=0.03)


def test_a_run_of_screws_that_are_commanded_by_force_has_their_speed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    thrust = own_run(tmp_path, "screws", SIZES, minutes=1.0)["port.thrust"]
    log = read_measurements("run/result.nc", sc.read("tern_open").checked()).log
    assert np.corrcoef(np.sign(thrust) * np.sqrt(abs(thrust)), log["port_rpm"])[0, 1] > 0.99


def test_a_turning_circle_that_was_simulated_is_a_sea_trial_of_the_same_ship(tmp_path):
    run = sc.run("steering/circle", out=tmp_path / "run")
    trials = sc.sea_trials(tmp_path / "run" / "result.nc")
    assert [trial.kind for trial in trials.trials] == ["turning circle"]
    assert trials.verdict == "consistent" and run.passed


def test_an_error_in_the_log_of_a_run_names_its_file(tmp_path):
    sc.run("steering/zig_zag", out=tmp_path / "run")
    with pytest.raises(ShipcosimError, match=r"result.nc.*among 1 manoeuvres: zig-zag"):
        sc.sea_trials(tmp_path / "run" / "result.nc")
