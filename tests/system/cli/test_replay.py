"""The command `replay`: what it compares, what it leaves, what it refuses."""

import subprocess
import sys

import pytest

import shipcosim as sc
from shipcosim.series import read_table, write_table
from shipcosim.ssp import read_system, with_values

SSV = """<?xml version="1.0"?><ssv:ParameterSet version="1.0" name="extended"
xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"><ssv:Parameters>
<ssv:Parameter name="left.thrust_loss"><ssv:Real value="0.5"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>"""


@pytest.fixture
def log(gunnerus):
    """Table of a run of the Otter, whose left propeller has lost half of its thrust."""
    ship = read_system(gunnerus / "ssp" / "otter_open", fmus=[gunnerus / "build" / "fmus"])
    driven = {"left.thrust_loss": 0.5, "left_rpm": 500.0, "right_rpm": 450.0}
    write_table(
        sc.simulate(with_values(ship, driven), stop_time=130.0, step_size=0.1),
        gunnerus / "result.nc",
    )
    (gunnerus / "extended.ssv").write_text(SSV, encoding="utf-8")
    return "result.nc"


def test_replay_draws_the_log_before_and_after_and_leaves_page_and_tables(call, gunnerus, log):
    done = call(
        "replay", log, "--system", "otter_open", "--parameters", "extended.ssv", "--out", "out"
    )
    assert done.code == 0 and "before" in done.out and "after" in done.out
    assert sorted(path.name for path in (gunnerus / "out").iterdir()) == [
        "errors.csv",
        "replay.nc",
        "report.html",
    ]
    rows = [line.split(",") for line in (gunnerus / "out" / "errors.csv").read_text().splitlines()]
    where = rows[0].index("position")
    last = {row[0]: float(row[where]) for row in rows[1:]}
    assert last["after"] < 0.2 < last["before"]
    assert "Measured and simulated" in (gunnerus / "out" / "report.html").read_text(
        encoding="utf-8"
    )


def test_replay_of_one_system_has_no_before(call, gunnerus, log):
    done = call("replay", log, "--system", "otter_open", "--horizon", "20", "--out", "out")
    assert done.code == 0 and "simulated" in done.out and "before" not in done.out


@pytest.mark.parametrize("horizon", ["0", "-5", "0.05", "1e-9"])
def test_a_prediction_shorter_than_a_step_is_refused(call, gunnerus, log, horizon):
    refused = call("replay", log, "--system", "otter_open", f"--horizon={horizon}", "--out", "out")
    assert refused.code == 2 and refused.err.count("error:") == 1
    assert "is shorter than a step of 0.2 s. Ask for longer predictions." in refused.err
    assert not (gunnerus / "out").exists()


def test_what_is_handled_in_a_log_stands_on_the_terminal_as_on_the_page(call, gunnerus, log):
    whole = read_table(log)
    write_table(whole.drop_isel(time=range(300, 500)), gunnerus / "gap.nc")
    done = call("replay", "gap.nc", "--system", "otter_open", "--horizon", "20", "--out", "out")
    page = (gunnerus / "out" / "report.html").read_text(encoding="utf-8")
    assert done.code == 0
    for text in (done.out, page):
        assert "gap: there are no rows" in text
        assert "200 rows of the usual step 0.1 s not there" in text


LIMITED = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))"


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files by POSIX's setrlimit")
def test_a_full_disk_is_one_error_and_leaves_nothing(gunnerus, log):
    code = f"{LIMITED}; from shipcosim.cli import main; main()"
    words = ["replay", log, "--system", "otter_open", "--horizon", "20", "--out", "out"]
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2 and done.stderr.count("error:") == 1
    assert "out/replay.nc:\ncannot be written: File too large." in done.stderr
    assert not (gunnerus / "out").exists()


def test_replay_refuses_what_is_not_there(call, gunnerus):
    assert (
        "There is no such file of measured data"
        in call("replay", "none.csv", "--system", "otter_open").err
    )
