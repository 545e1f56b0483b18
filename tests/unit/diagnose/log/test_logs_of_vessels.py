"""Logs as boats and their tools write them open with the right channels, or are asked."""

import numpy as np
import pytest

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.names.vocabulary import words_of
from shipcosim.diagnose.log.reader import columns_of, read_log

TIME = np.arange(300.0)
HEADING = 40.0 + 90.0 * np.sin(TIME / 40.0)
SURGE = 2.0 + 0.5 * np.sin(TIME / 25.0)
SWAY = 0.6 * np.cos(TIME / 30.0)
VELOCITY = (SURGE + 1j * SWAY) * np.exp(1j * np.radians(HEADING))
WAY = np.concatenate(([0.0], np.cumsum(0.5 * (VELOCITY[1:] + VELOCITY[:-1]))))
LATITUDE = 63.0 + WAY.real / 111_500.0
LONGITUDE = 10.0 + WAY.imag / 50_700.0


def written(path, header, columns):
    rows = [",".join(f"{value:.9f}" for value in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


@pytest.mark.parametrize(
    "name, words",
    [
        ("stbdrpm", ("starboard", "rpm")),
        ("headingdeg", ("heading", "deg")),
        ("apparentwindspeed", ("apparent", "wind", "speed")),
        ("Asimutvinkel BB", ("azimuth", "angle", "port")),
        ("windward", ("windward",)),
        ("report", ("report",)),
    ],
)
def test_words_written_together_are_those_that_all_their_parts_are(name, words):
    assert words_of(name) == words


def test_positions_say_the_unit_of_the_time_the_axes_and_the_frame_of_the_velocity(tmp_path):
    columns = (5e6 + 1e6 * TIME, WAY.real, WAY.imag, VELOCITY.real, VELOCITY.imag)
    header = "timestamp,x,y,vx,vy,heading"
    path = written(tmp_path / "log.csv", header, (*columns, np.radians(HEADING)))
    log = read_log(path)
    np.testing.assert_allclose(log["time"], 5.0 + TIME, atol=1e-6)
    np.testing.assert_allclose(log["east"], WAY.imag, atol=1e-6)
    np.testing.assert_allclose(log["surge"], SURGE, atol=1e-6)
    np.testing.assert_allclose(log["heading"], HEADING, atol=1e-5)


def test_a_sway_to_port_is_seen_in_the_positions(tmp_path):
    columns = (TIME, WAY.real, WAY.imag, HEADING, SURGE, -SWAY)
    path = written(tmp_path / "log.csv", "time,north,east,heading,linear x,linear y", columns)
    np.testing.assert_allclose(read_log(path)["sway"], SWAY, atol=1e-6)


def test_x_y_and_psi_may_be_seen_in_a_mirror_and_are_asked(tmp_path):
    path = written(tmp_path / "log.csv", "time,x,y,psi", (TIME, WAY.real, -WAY.imag, -HEADING))
    assert not {"north", "east", "heading"} & set(propose(columns_of(path)).channels())


def test_sides_of_one_letter_are_asked_and_are_none_of_units(tmp_path):
    path = written(tmp_path / "log.csv", "t_s,RPM_P,HDG", (TIME, SURGE, HEADING))
    thrusters = {"port": ("rpm",), "starboard": ("rpm",)}
    proposal = propose(columns_of(path), thrusters)
    assert {g.role: g.is_guess for g in proposal.used} == {
        "time": False,
        "port_rpm": True,
        "heading": False,
    }


def test_a_text_log_of_ardupilot_is_read(tmp_path):
    lines = ["FMT, 1, 2, GPS, Q, TimeUS,Lat,Lng,Spd,GCrs,I", "FMT, 1, 2, ATT, Q, TimeUS,Yaw"]
    for k, t in enumerate(TIME):
        course = np.degrees(np.angle(VELOCITY[k])) % 360.0
        place = f"{LATITUDE[k]:.8f}, {LONGITUDE[k]:.8f}"
        lines.append(f"GPS, {5e7 + 1e6 * t:.0f}, {place}, {abs(VELOCITY[k]):.5f}, {course:.4f}, 0")
        lines.append(f"GPS, {5e7 + 1e6 * t:.0f}, 1.0, 2.0, 3.0, 4.0, 1")
        lines.append(f"ATT, {5e7 + 1e6 * t:.0f}, {HEADING[k] % 360.0:.4f}")
    path = tmp_path / "boat.log"
    path.write_text("\n".join(lines) + "\n")
    log = read_log(path)
    np.testing.assert_allclose(log["surge"], SURGE, atol=1e-3)
    np.testing.assert_allclose(log["north"], WAY.real, atol=1.0)


def test_a_log_of_moos_is_read_with_its_sensors_in_rows_of_their_own(tmp_path):
    lines = ["%% LOG FILE: ./LOG.alog", "%% LOGSTART 1684314724.2"]
    for k, t in enumerate(TIME):
        lines += [f"{t + 2.1:.3f} NAV_X pNode {WAY[k].imag:.4f}"]
        lines += [f"{t + 2.2:.3f} NAV_Y pNode {WAY[k].real:.4f}"]
        lines += [f"{t + 2.3:.3f} NAV_HEADING pNode {HEADING[k] % 360.0:.4f}"]
    path = tmp_path / "boat.alog"
    path.write_text("\n".join(lines) + "\n")
    log = read_log(path)
    at = np.interp(log["time"], TIME + 2.1, WAY.imag)
    np.testing.assert_allclose(log["east"], at, atol=1e-3)


@pytest.mark.parametrize(
    "row",
    [
        'ts={stamp} msg="a fix" lat={lat:.8f} lon={lon:.8f} heading_deg={heading:.3f}',
        '<trkpt lat="{lat:.8f}" lon="{lon:.8f}"><time>{stamp}</time><hdg>{heading:.3f}</hdg></trkpt>',
    ],
)
def test_keys_with_values_and_points_of_a_track_are_tables(row, tmp_path):
    lines = []
    for k, t in enumerate(TIME):
        stamp = f"2024-03-14T09:{26 + int(t) // 60:02d}:{int(t) % 60:02d}Z"
        lines.append(
            row.format(stamp=stamp, lat=LATITUDE[k], lon=LONGITUDE[k], heading=HEADING[k] % 360.0)
        )
    if row.startswith("<"):
        lines = ["<?xml version='1.0'?><gpx><trk><trkseg>", *lines, "</trkseg></trk></gpx>"]
    path = tmp_path / "boat.log"
    path.write_text("\n".join(lines) + "\n")
    log = read_log(path)
    np.testing.assert_allclose(log["heading"], HEADING % 360.0, atol=1e-2)
    np.testing.assert_allclose(log["north"], WAY.real, atol=1.0)


def test_names_below_groups_have_the_group_where_some_need_it(tmp_path):
    header = ",Motion,Wind,,Port,Stbd\nTime,Heading,Speed (rel),Dir (rel),RPM,RPM"
    columns = (TIME, HEADING, SURGE, HEADING, SWAY, SWAY)
    log = read_log(written(tmp_path / "log.csv", header, columns))
    assert {"heading", "wind_speed", "wind_from", "port_rpm"} <= set(log)


def test_a_long_name_of_known_words_is_read_at_once():
    # Every way to cut it would be tried, and each word is a call inside the last.
    name = "port" * 4000
    assert words_of(name) == (name,)


def test_a_line_of_pairs_above_a_table_is_its_title(tmp_path):
    columns = TIME, WAY.real, WAY.imag, HEADING
    path = written(tmp_path / "trial.csv", "time [s],north [m],east [m],heading [deg]", columns)
    path.write_text("ship=Tern date=2026-01-01 rate=1Hz\n" + path.read_text())
    assert list(columns_of(path).values) == ["time", "north", "east", "heading"]
