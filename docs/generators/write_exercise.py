"""Writes the training set of paper I's allocators: commands and loads of a run of scenarios/paper_i/exercise.toml.

Run `python docs/generators/write_exercise.py` after the 82.7 m vessel, a thruster or the scenario has changed, and
train again: `shipcosim train allocator --kind paper-i`. A test compares the file with this.
"""

import gzip
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray as xr

from shipcosim.cosim import simulate
from shipcosim.learn.paper_i import RECORD
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario
from shipcosim.series import make_table, write_table
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
THRUSTERS = ("bow_1", "bow_2", "stern_1", "stern_2", "port", "starboard")


def exercise() -> xr.Dataset:
    """Table of the run."""
    scenario = read_scenario(ROOT / "scenarios" / "paper_i" / "exercise.toml")
    return simulate(
        read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(ROOT)]),
        scenario,
    )


def training_set(run: xr.Dataset) -> xr.Dataset:
    """Load of all thrusters together to 0.1 N and N.m, and their commands to 1e-6, of each step."""
    run = run.isel(time=slice(1, None))
    loads = {
        axis: np.sum([run[f"{name}.tau_{axis}"].values for name in THRUSTERS], axis=0)
        for axis in "XYN"
    }
    columns = [
        (
            f"tau_{axis}",
            loads[axis].round(1),
            "N.m" if axis == "N" else "N",
            "load of all thrusters",
        )
        for axis in "XYN"
    ]
    for number, name in enumerate(THRUSTERS, 1):
        columns.append(
            (
                f"command_{number}",
                run[f"{name}.command"].values.round(6),
                "1",
                f"{name}, in rpm or deg of pitch",
            )
        )
    return make_table(run["time"].values, columns)


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        plain = Path(folder) / "exercise.csv"
        write_table(training_set(exercise()), plain)
        RECORD.write_bytes(gzip.compress(plain.read_bytes(), mtime=0))
