"""Logs in several tables or in messages are joined by time: folders, bags of ROS 2, NMEA 2000; and files of MATLAB."""

import builtins
import json
import struct

import numpy as np
import pytest
from diagnose.log.exports import SHIP, motion, table
from diagnose.log.test_nmea import gga, sentence

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError

TRUTH = motion()
COUNT = len(TRUTH["time"])
POSITION = [("lat", "latitude"), ("lon", "longitude")]


def off(log, role):
    """Largest difference from the motion, about the first value of a position."""
    wanted = TRUTH[role][: log.sizes["time"]]
    found = log[role].values
    if role in ("north", "east"):
        wanted, found = wanted - wanted[0], found - found[0]
    return np.nanmax(np.abs((found - wanted + 180.0) % 360.0 - 180.0))


def folder_of(path, clock, *more):
    path.mkdir()
    (path / "gps.csv").write_text(table([("%time", clock), *POSITION]))
    (path / "gyro.csv").write_text(table([("%time", clock), ("heading", "heading"), *more]))
    return path


@pytest.mark.parametrize("clock", ["ns", "iso", "secs"])
def test_topics_in_several_files_are_joined_by_time(clock, tmp_path):
    log = read_log(folder_of(tmp_path / "run", clock))
    assert max(off(log, role) for role in ("heading", "north", "east")) < 0.01
    assert "Tables joined by time: gps, gyro" in " ".join(log.attrs["column_remarks"])


@pytest.mark.parametrize("names", [("run.gps.csv", "run.gyro.csv"), ("run.csv", "run.txt")])
def test_tables_whose_names_begin_alike_are_all_read(names, tmp_path):
    folder = folder_of(tmp_path / "run", "ns")
    for old, new in zip(("gps.csv", "gyro.csv"), names, strict=True):
        (folder / old).rename(folder / new)
    assert {"heading", "north", "east"} <= set(read_log(folder))


def test_tables_that_may_start_at_different_times_are_refused(tmp_path):
    with pytest.raises(ShipcosimError, match="may count from different starts"):
        read_log(folder_of(tmp_path / "run", "time"))


def test_a_table_without_any_time_is_refused_in_a_sentence(tmp_path):
    (tmp_path / "a.csv").write_text("time,heading\n100,1\n101,2\n102,3\n")
    (tmp_path / "b.csv").write_text("time,north\n,1\n,2\n,3\n")
    with pytest.raises(ShipcosimError, match="may count from different starts"):
        read_log(tmp_path)


def test_times_of_two_kinds_are_refused(tmp_path):
    folder = folder_of(tmp_path / "run", "iso")
    (folder / "dvl.csv").write_text(table([("%time", "ns"), ("surge", "surge"), ("sway", "sway")]))
    with pytest.raises(ShipcosimError, match="written in different ways"):
        read_log(folder)


def test_a_table_of_set_points_is_no_measurement(tmp_path):
    folder = folder_of(tmp_path / "run", "ns")
    velocities = [("surge", "yaw_rate"), ("sway", "heading")]
    (folder / "cmd_vel.csv").write_text(table([("%time", "ns"), *velocities]))
    assert not {"surge", "sway"} & set(read_log(folder))


def test_a_folder_without_tables_is_refused(tmp_path):
    with pytest.raises(ShipcosimError, match="a folder without tables"):
        read_log(tmp_path)


def raw(pgn, t, content, source=3):
    stamp = f"2024-03-14-09:{26 + t // 60:02d}:{t % 60:02d}.000"
    return f"{stamp},2,{pgn},{source},255,8," + ",".join(f"{byte:02x}" for byte in content)


def can_lines(source=3):
    now = {role: values for role, values in TRUTH.items()}
    angle = lambda role, t: int(round(np.radians(now[role][t]) * 1e4))  # noqa: E731
    for t in range(COUNT):
        place = [int(round(now[role][t] * 1e7)) for role in ("latitude", "longitude")]
        speed, wind = (int(round(now[r][t] * 100)) for r in ("speed_over_ground", "wind_speed"))
        rate = int(np.radians(now["yaw_rate"][t]) * 32e6)
        yield raw(127250, t, struct.pack("<BHhhB", 1, angle("heading", t), 0, 0, 0xFC), source)
        yield raw(127251, t, struct.pack("<Bi3x", 1, rate), source)
        yield raw(129025, t, struct.pack("<ii", *place), source)
        course = angle("course_over_ground", t)
        yield raw(129026, t, struct.pack("<BBHH2x", 1, 0xFC, course, speed), source)
        yield raw(130306, t, struct.pack("<BHHB2x", 1, wind, angle("wind_from", t), 0xFA), source)
        yield raw(130310, t, bytes(8), source)


CAN_ROLES = ("heading", "yaw_rate", "north", "east", "surge", "sway", "wind_speed", "wind_from")


def test_raw_messages_of_nmea_2000_are_read(tmp_path):
    path = tmp_path / "boat.csv"
    path.write_text("\n".join(["# a comment", *can_lines()]) + "\n")
    log = read_log(path)
    assert {role: off(log, role) < 0.02 for role in CAN_ROLES} == dict.fromkeys(CAN_ROLES, True)
    assert "Messages not read: 130310 (240)" in " ".join(log.attrs["column_remarks"])


def test_a_magnetic_heading_and_a_wind_through_water_are_none_of_their_roles(tmp_path):
    lines = []
    for line in can_lines():
        pgn = line.split(",")[2]
        line = line[:-2] + "fd" if pgn == "127250" else line
        lines.append(line.replace(",fa,00,00", ",fc,00,00") if pgn == "130306" else line)
    path = tmp_path / "boat.csv"
    path.write_text("\n".join(lines) + "\n")
    assert not {"heading", "wind_speed", "wind_from"} & set(propose(columns_of(path)).channels())


def messages(units):
    size = {"si": np.pi / 180.0}.get(units, 1.0)
    yield json.dumps({"version": "4.12.0", "units": units, "showLookupValues": False})
    for t in range(COUNT):
        stamp = f"2024-03-14T09:{26 + t // 60:02d}:{t % 60:02d}.000Z"
        heading = {"Heading": size * TRUTH["heading"][t], "Reference": "True"}
        place = {"Latitude": TRUTH["latitude"][t], "Longitude": TRUTH["longitude"][t]}
        for pgn, fields in ((127250, heading), (129025, place)):
            yield json.dumps({"timestamp": stamp, "src": 1, "pgn": pgn, "fields": fields})


@pytest.mark.parametrize("units", ["si", "std"])
def test_messages_in_json_are_read_in_their_units(units, tmp_path):
    path = tmp_path / "boat.json"
    path.write_text("\n".join(messages(units)) + "\n")
    log = read_log(path)
    assert max(off(log, role) for role in ("heading", "north", "east")) < 0.01


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_the_text_of_an_analyzer_is_read(unit, tmp_path):
    size = np.pi / 180.0 if unit == "rad" else 1.0
    lines = []
    for t in range(COUNT):
        head = f"2024-03-14-09:{26 + t // 60:02d}:{t % 60:02d}.000 2   3 255"
        told = f"SID = 1; Heading = {size * TRUTH['heading'][t]:.6f} {unit}; Reference = True"
        lines.append(f"{head} 127250 Vessel Heading:  {told}")
        told = f"SID = 1; Rate = {size * TRUTH['yaw_rate'][t]:.7f} {unit}/s"
        lines.append(f"{head} 127251 Rate of Turn:  {told}")
        place = [f"{TRUTH[role][t]:.7f}" for role in ("latitude", "longitude")]
        told = f"Latitude = {place[0]} deg; Longitude = {place[1]} deg"
        lines.append(f"{head} 129025 Position, Rapid Update:  {told}")
    path = tmp_path / "boat.txt"
    path.write_text("\n".join(lines) + "\n")
    log = read_log(path)
    assert max(off(log, role) for role in ("heading", "yaw_rate", "north", "east")) < 0.02


def test_the_course_says_the_unit_of_angles_of_messages_and_without_positions_they_are_asked(
    tmp_path,
):
    path = tmp_path / "boat.json"
    lines = list(messages("si"))[1:]
    path.write_text("\n".join(lines) + "\n")
    assert off(read_log(path), "heading") < 0.01
    path.write_text("\n".join(line for line in lines if "127250" in line) + "\n")
    assert "heading" not in propose(columns_of(path)).channels()


def bag(path):
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    number = store.types["std_msgs/msg/Float64"]
    with rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as writer:
        for topic, role in (("/gyro/heading", "heading"), ("/dvl/surge", "surge")):
            topic = writer.add_connection(topic, number.__msgtype__, typestore=store)
            for t, value in enumerate(TRUTH[role]):
                content = store.serialize_cdr(number(float(value)), number.__msgtype__)
                writer.write(topic, 1710408360000000000 + t * 1000000000, content)
    return path


def test_a_bag_is_read_as_a_folder_and_as_a_file(tmp_path):
    folder = bag(tmp_path / "run")
    for path in (folder, folder / "run.mcap"):
        log = read_log(path)
        assert max(off(log, role) for role in ("heading", "surge")) < 1e-6


def test_a_file_of_matlab_is_read_with_its_structs(tmp_path):
    scipy = pytest.importorskip("scipy.io")
    path = tmp_path / "log.mat"
    nav = {role: TRUTH[role] for role in ("heading", "surge", "sway")}
    gains = np.array([1.0, 2.0, 3.0])
    scipy.savemat(path, {"t": TRUTH["time"][:, None], "nav": nav, "gains": gains})
    log = read_log(path)
    assert max(off(log, role) for role in nav) < 1e-9
    assert "Series of other lengths left out: gains" in " ".join(log.attrs["column_remarks"])


@pytest.mark.parametrize("place, byte", [(177, 4), (176, 73), (160, 255)])
def test_a_damaged_file_of_matlab_is_refused_by_name(tmp_path, place, byte):
    """Sizes and types of elements that are wrong crash the library that reads them."""
    scipy = pytest.importorskip("scipy.io")
    path = tmp_path / "log.mat"
    nav = {"north": TRUTH["time"], "source": "x"}
    scipy.savemat(path, {"t": TRUTH["time"][:, None], "nav": nav})
    content = bytearray(path.read_bytes())
    content[place] = byte
    path.write_bytes(content)
    with pytest.raises(ShipcosimError, match=r"log\.mat: cannot be read: its content is damaged"):
        read_log(path)


@pytest.mark.parametrize(
    "name, content, package, extra",
    [
        ("log.mat", b"MATLAB 5.0 MAT-file" + bytes(200), "scipy", "matlab"),
        ("log.mcap", b"\x89MCAP0\r\n", "rosbags", "ros"),
    ],
)
def test_a_missing_extra_is_named(name, content, package, extra, tmp_path, monkeypatch):
    ordinary = builtins.__import__

    def without(module, *rest, **more):
        if module.split(".")[0] == package:
            raise ImportError(module)
        return ordinary(module, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ShipcosimError, match=rf"need {package}.*shipcosim\[{extra}\]"):
        read_log(tmp_path / name)


@pytest.mark.parametrize("name", ["log.mat", "log.mcap", "log.db3"])
def test_a_damaged_file_is_refused_in_a_sentence(name, tmp_path):
    content = b"MATLAB 5.0 MAT-file" + bytes(200) if name == "log.mat" else bytes(200)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ShipcosimError, match="cannot be read|no series"):
        read_log(tmp_path / name)


def test_shafts_and_rudders_of_sentences_are_read(tmp_path):
    lines = []
    for t in range(30):
        lines += [gga(float(t)), sentence("HEHDT", "10.0", "T")]
        lines += [sentence("IIRPM", "S", n, 100.0 + n, "100.0", "A") for n in (1, 2, 3)]
        lines += [sentence("IIRPM", "E", 1, 700.0, "100.0", "A")]
        lines += [
            sentence("IIRSA", "5.0", "A", "4.0", "A"),
            sentence("IIRPM", "S", 1, 9.0, "", "V"),
        ]
    path = tmp_path / "bridge.nmea"
    path.write_text("\n".join(lines) + "\n")
    log = read_log(path, None, SHIP)
    assert np.unique(log["starboard_rpm"].values) == [101.0]
    assert np.unique(log["port_rpm"].values) == [102.0]
    # The number of an engine, a third shaft and a rudder's angle are no thruster of this ship.
    assert not {"bow1_rpm", "bow2_rpm", "port_azimuth", "starboard_azimuth"} & set(log)
