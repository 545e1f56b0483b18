"""The same scenario, seed and version give the same bytes, and a result says what is needed to repeat it."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from shipcosim.cosim import RunOptions, repeat, simulate
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.series import make_table, read_table, write_table
from shipcosim.ssp import with_values

RUN = """
import sys
from pathlib import Path
from shipcosim.cosim import RunOptions, simulate
from shipcosim.scenario import read_scenario
from shipcosim.series import write_table
from shipcosim.ssp import read_system
root, out = map(Path, sys.argv[1:])
scenario = read_scenario(root / "scenarios" / "four_corner_rough.toml").model_copy(update={"stop_time": 6.0})
system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[root / "build" / "fmus"])
table = simulate(system, scenario)
for suffix in (".nc", ".csv"):
    write_table(table, out / f"result{suffix}")
"""


@pytest.fixture(scope="module")
def results(root, tmp_path_factory):
    """Folders of two runs of the DP ship in wind and waves, in processes with other hash seeds."""
    build_stale(root)
    folders = []
    for seed in ("1", "4711"):
        folders.append(tmp_path_factory.mktemp("run"))
        command = [sys.executable, "-c", RUN, str(root), str(folders[-1])]
        subprocess.run(command, check=True, timeout=600, env=os.environ | {"PYTHONHASHSEED": seed})
    return folders


@pytest.mark.parametrize("name", ["result.nc", "result.csv"])
def test_two_runs_leave_the_same_bytes(results, name):
    one, other = ((folder / name).read_bytes() for folder in results)
    assert one == other


def test_a_run_is_repeated_from_its_result_file_alone(results, root, tmp_path):
    """Versions, start values, seeds, events, hashes: no scenario, no parameter set is read, only the system."""
    again = repeat(
        results[0] / "result.nc", root / "ssp" / "gunnerus_dp", fmus=(root / "build" / "fmus",)
    )
    write_table(again, tmp_path / "again.nc")
    assert (tmp_path / "again.nc").read_bytes() == (results[0] / "result.nc").read_bytes()


def test_a_result_names_versions_seeds_and_fmus(results):
    facts = read_table(results[0] / "result.nc").attrs
    assert {"shipcosim_version", "fmpy_version", "numpy_version", "python_version"} <= facts.keys()
    assert json.loads(facts["seeds"]).keys() == {"environment.seed", "sensors.seed"}
    assert all(len(fmu["sha256"]) == 64 for fmu in json.loads(facts["fmus"]).values())


PARTS = {
    "sum": ("integrator", {"y_start": 0.1}),
    "gain": ("gain", {"factor": 3.0}),
    "clock": "clock",
}
LINKS = ["push -> sum.u", "sum.y -> gain.u"]
PUSH = {"push": ("input", "Real", "")}


@pytest.fixture
def run(make_system, make_scenario):
    """A small run with events and a table, its table and system."""
    events = [
        {"time": 0.5, "override": {"gain.y": 2.0}},
        {"time": 1.0, "bias": {"push": 1.0}, "reset": ["gain.y"]},
    ]
    inputs = make_table(np.linspace(0.0, 9.0, 10), [("push", np.arange(10.0), "", "")])
    system, scenario = (
        make_system(PARTS, LINKS, PUSH),
        make_scenario(5.0, output_interval=0.5, events=events),
    )
    table = simulate(
        system, scenario, RunOptions(inputs=inputs, start_time=0.4, order="gauss-seidel", until=4.4)
    )
    return table, system, inputs


def test_events_tables_order_and_times_are_repeated(run, tmp_path):
    table, system, inputs = run
    write_table(table, tmp_path / "result.nc")
    elsewhere = with_values(system, {"sum.y_start": 7.0, "gain.factor": -1.0, "push": 3.0})
    again = repeat(tmp_path / "result.nc", elsewhere, inputs=inputs)
    assert again.identical(table)
    assert repeat(table, elsewhere, inputs=inputs).identical(table)


def test_what_differs_from_the_run_is_said(run, make_system, make_scenario):
    table, system, inputs = run

    def refused(said, of=table, system=system, inputs=inputs):
        with pytest.raises(ShipcosimError, match=said):
            repeat(of, system, inputs=inputs)

    refused("The table is not the one that fed the run", inputs=inputs + 1.0)
    refused("The table is not the one that fed the run", inputs=None)
    refused("does not say how it came about", of=inputs)
    refused("small is not wired as small was", system=make_system(PARTS, LINKS[:1], PUSH))
    swapped = make_system(PARTS | {"clock": "meter"}, LINKS, PUSH)
    refused("clock: clock.fmu is another FMU than in the run", system=swapped)
    stored = []
    simulate(system, make_scenario(5.0), RunOptions(until=1.0, store=stored.append))
    refused(
        "continued from a snapshot at 1 s",
        of=simulate(system, make_scenario(5.0), RunOptions(resume=stored[0])),
        inputs=None,
    )
