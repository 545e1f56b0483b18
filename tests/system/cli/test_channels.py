"""`shipcosim channels` lists every column of a log, and the file that it proposes reads the log."""

import numpy as np
import pytest

from shipcosim.cli.channel_files import proposed
from shipcosim.diagnose.log.reader import read_log

T = np.arange(0.0, 120.0, 0.5)
HEADER = "Time (s);Northing;Easting;Yaw;u (kn);v (kn);stbd RPM;shaft RPM;thr_port_pwm;Comment"


@pytest.fixture
def log(tmp_path):
    rows = [
        f"{t:.1f};{2 * t:.2f};0,5;{0.01 * t:.3f};4,1;0,1;60;61;1500;fine".replace(".", ",")
        for t in T
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join([HEADER, *rows]), encoding="latin-1")
    return path


def test_every_column_is_listed_and_the_proposed_file_reads_the_log(call, gunnerus, log):
    done = call("channels", log, "--out", "channels.toml")
    assert done.code == 0, done.err
    for said in (
        "stbd RPM",
        "starboard_rpm",
        "guess",
        "not used",
        "map = ",
        "decimal comma",
        "channels.toml",
    ):
        assert said in done.out
    assert all(name.partition(" (")[0] in done.out for name in HEADER.split(";"))
    read = read_log(log, "channels.toml")
    assert read["surge"].values[0] == pytest.approx(4.1 * 1852 / 3600) and "starboard_rpm" in read
    again = call("channels", log, "--out", "channels.toml")
    assert again.code == 2 and "--force" in again.err
    assert call("channels", log, "--out", "channels.toml", "--force").code == 0


def test_a_log_that_is_none_ends_in_one_error(call, gunnerus, tmp_path):
    (tmp_path / "log.csv").write_text("nothing to see\n")
    done = call("channels", tmp_path / "log.csv")
    assert done.code == 2 and "has no row below its header" in done.err


def test_the_table_of_a_run_has_a_channel_file(gunnerus, tmp_path):
    names = [
        "time [s]",
        "vessel.x [m]",
        "vessel.y [m]",
        "vessel.psi [rad]",
        "vessel.u [m/s]",
        "port.rpm [rpm]",
    ]
    rows = np.column_stack([T, T, 0 * T, 0.1 * T, 0 * T + 1, 0 * T + 60])
    np.savetxt(tmp_path / "result.csv", rows, delimiter=",", header=",".join(names), comments="")
    found = proposed(tmp_path / "result.csv")
    (tmp_path / "channels.toml").write_text(found.text)
    log = read_log(tmp_path / "result.csv", tmp_path / "channels.toml")
    assert (
        log["heading"].values[10] == pytest.approx(np.degrees(0.5))
        and log["port_rpm"].values[0] == 60.0
    )


def test_names_say_centimetres_and_which_side_is_positive(tmp_path):
    rows = np.column_stack([T, 100.0 * T, 0 * T, 0 * T, 0 * T + 2.0])
    header = "time [s],north_cm,east_cm,heading,rot_port_deg_s"
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=header, comments="")
    (tmp_path / "channels.toml").write_text(proposed(tmp_path / "log.csv").text)
    log = read_log(tmp_path / "log.csv", tmp_path / "channels.toml")
    assert log["north"].values[10] == pytest.approx(T[10]) and log["yaw_rate"].values[0] == -2.0
