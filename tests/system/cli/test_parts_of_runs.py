"""Runs that start late, stop early, are stored and continued, from the command line."""

import numpy as np
import pytest

from shipcosim.series import read_table

TANK = "build/ssp/tank.ssp"


def level(project, folder):
    return read_table(project / folder / "result.nc")["lag.y"].values


def test_a_stored_scenario_goes_on_as_if_nothing_had_been(call, project):
    """Each part is checked for what is expected within it: only the second holds the window from 4 to 5 s."""
    assert call("run", "fill", "--out", "whole").code == 0
    first = call("run", "fill", "--until", "2", "--store", "at2.state", "--out", "first")
    rest = call("run", "fill", "--from", "at2.state", "--out", "rest")
    assert (first.code, rest.code) == (0, 0) and "pass" not in first.out and "pass" in rest.out
    assert np.array_equal(level(project, "first"), level(project, "whole")[:21])
    assert np.array_equal(level(project, "rest"), level(project, "whole")[20:])


def test_simulate_replays_from_any_time_with_start_values(call, project):
    """Behind a ramp of 1 m/s a lag is late by its time constant."""
    call("build")
    (project / "levels.csv").write_text("time [s],level_set [km]\n50,0\n60,0.01\n")
    options = (
        "--start-time",
        "50",
        "--stop-time",
        "60",
        "--step-size",
        "0.1",
        "--set",
        "lag.time_constant=0.2",
    )
    done = call(
        "simulate",
        TANK,
        "--inputs",
        "levels.csv",
        "--interpolate",
        "level*",
        *options,
        "--out",
        "out",
    )
    assert done.code == 0
    table = read_table(project / "out" / "result.nc")
    assert table["time"].values[[0, -1]].tolist() == [50.0, 60.0]
    assert table["level_set"].values[50] == pytest.approx(5.0)
    assert table["lag.y"].values[-1] == pytest.approx(10.0 - 0.2, abs=1e-6)


@pytest.mark.parametrize(
    "options, said",
    [
        (
            ("--inputs", "gap.csv", "--max-gap", "2"),
            "There is no row between 0 s and 9 s; 2 s are allowed.",
        ),
        (("--inputs", "gap.csv", "--interpolate", "level"), "Did you mean 'level_set'?"),
        (("--interpolate", "*"), "Give one as inputs (--inputs)."),
        (("--from", "gap.csv"), "is no snapshot of a run"),
        (("--until", "7"), "the run would go from 0 s to 7 s."),
        (("--set", "lag.time=1"), "lag has no variable 'time'."),
        (("--store", "absent/at1.state"), "There is no such folder to store the state in."),
    ],
)
def test_what_cannot_be_run_so_is_said(call, project, options, said):
    call("build")
    (project / "gap.csv").write_text("time [s],level_set [m]\n0,0\n9,1\n")
    done = call("simulate", TANK, "--stop-time", "5", "--step-size", "0.1", *options)
    assert done.code == 2 and said in done.err and "Traceback" not in done.err
