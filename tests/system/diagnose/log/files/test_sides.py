"""Signs in a column of sides, and longitudes beside latitudes, are read at any place; what they leave open is asked."""

import numpy as np
import pytest
from diagnose.log.files.test_missing import EASY, MOTION, T, log_of, remarks
from diagnose.log.oddities import THRUSTERS, save
from hypothesis import given
from hypothesis import strategies as some

from shipcosim.diagnose.log.channels import ChannelFile
from shipcosim.diagnose.log.degree_size import metres_per_degree
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of, read_log

SIDES = {
    "sway": ("Sway [m/s]", [("S", "P"), ("STBD", "PORT"), ("R", "L"), ("sb", "bb")]),
    "yaw_rate": ("ROT [deg/s]", [("S", "P"), ("Right", "Left")]),
    "wind_from": ("AWA [deg]", [("S", "P"), ("STB", "PORT")]),
    "surge": ("Surge [m/s]", [("F", "A"), ("FWD", "AFT"), ("Ahead", "Astern")]),
    "port_rpm": ("Port RPM", [("F", "R"), ("AHEAD", "ASTERN"), ("FWD", "REV")]),
}


@pytest.mark.parametrize(
    ("role", "pair"), [(r, pair) for r, (_, pairs) in SIDES.items() for pair in pairs]
)
@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_a_column_of_sides_gives_the_signs(tmp_path, role, pair, shift):
    values = 20.0 * (np.sin(T / 20.0) + shift)
    name = SIDES[role][0]
    sides = [pair[0] if v >= 0.0 else pair[1] for v in values]
    log = log_of(tmp_path, {"time": T} | MOTION | {name: np.abs(values), f"{name[:3]} side": sides})
    assert log[role].values == pytest.approx(values, abs=1e-4)
    assert "its side stands in" in remarks(log)


@pytest.mark.parametrize("codes", [("1", "0"), ("1", "-1"), ("CW", "CCW")])
@pytest.mark.parametrize(
    "name", ["Port direction", "port_rpm_dir", "Port shaft rotation", "Port reverse"]
)
def test_the_code_of_a_direction_is_asked(tmp_path, codes, name):
    values = 90.0 * np.sin(T / 20.0)
    columns = {"time": T} | MOTION | {"Port RPM": np.abs(values), "power": T}
    columns[name] = [codes[0] if v >= 0.0 else codes[1] for v in values]
    log = log_of(tmp_path, columns)
    assert "port_rpm" not in log
    assert f"it has no sign, and '{name}' may hold it" in remarks(log)
    if codes[0] == "1":
        guess = next(
            g
            for g in propose(columns_of(tmp_path / "log.csv"), THRUSTERS).used
            if g.role == "port_rpm"
        )
        assert guess.channel.hemisphere == name
        lines = (
            "".join(f'{role} = "{role}"\n' for role in ("time", *MOTION))
            + f'port_rpm = {{column = "Port RPM", hemisphere = "{name}", sign = -1}}\n'
        )
        (tmp_path / "channels.toml").write_text(lines)
        log = read_log(tmp_path / "log.csv", tmp_path / "channels.toml")
        assert log["port_rpm"].values == pytest.approx(-values, abs=1e-4)


@pytest.mark.parametrize("name", ["Port running", "Stbd direction", "Alarm"])
def test_the_codes_of_another_column_are_no_direction(tmp_path, name):
    columns = {"time": T} | MOTION | {"Port RPM": 50.0 + T, name: T % 2.0}
    assert log_of(tmp_path, columns)["port_rpm"].values == pytest.approx(50.0 + T, abs=1e-4)


@pytest.mark.parametrize("word", ["A", "R", "V", "on"])
def test_a_status_behind_a_number_is_no_side(tmp_path, word):
    log = log_of(tmp_path, {"time": T} | MOTION | {"Port RPM": 50.0 + T, "Drive": [word] * len(T)})
    assert log["port_rpm"].values == pytest.approx(50.0 + T, abs=1e-4)


def positions(latitude, longitude):
    """A way of some hundred metres from a place. [deg]"""
    meridian, parallel = metres_per_degree(latitude)
    return latitude + MOTION["north"] / meridian, longitude + MOTION["east"] / parallel


def minutes(degrees):
    """ddmm.mmmm of each, with the sign in front."""
    size = np.abs(degrees)
    return [
        f"{np.sign(d) * (np.floor(s) * 100.0 + s % 1.0 * 60.0):.7f}"
        for d, s in zip(degrees, size, strict=True)
    ]


@EASY
@given(
    some.floats(2.0, 80.0),
    some.one_of(some.floats(-179.0, 179.0), some.floats(-3.9, 3.9)),
    some.sampled_from([1.0, -1.0]),
)
def test_a_longitude_is_in_degrees_and_minutes_where_the_latitude_is(
    tmp_path, latitude, longitude, sign
):
    places = positions(sign * latitude, longitude)
    texts = [minutes(place) for place in places]
    log = log_of(
        tmp_path, {"time": T, "heading": MOTION["heading"], "Lat": texts[0], "Lon": texts[1]}
    )
    assert log["north"].values - log["north"].values[0] == pytest.approx(MOTION["north"], abs=0.1)
    assert log["east"].values - log["east"].values[0] == pytest.approx(MOTION["east"], abs=0.1)


@EASY
@given(some.floats(-0.9, 0.9), some.floats(5.0, 170.0))
def test_a_latitude_is_in_degrees_and_minutes_where_the_longitude_is(tmp_path, latitude, longitude):
    texts = [minutes(place) for place in positions(latitude, longitude)]
    columns = {"time": T, "heading": MOTION["heading"], "Lat": texts[0], "Lon": texts[1]}
    log = log_of(tmp_path, columns)
    assert log["north"].values - log["north"].values[0] == pytest.approx(MOTION["north"], abs=0.1)


@EASY
@given(some.floats(2.0, 80.0), some.floats(182.0, 359.0))
def test_a_longitude_counts_on_to_360_where_the_latitude_is_in_degrees(
    tmp_path, latitude, longitude
):
    columns = {"time": T, "heading": MOTION["heading"]}
    for name, place in zip(("Lat", "Lon"), positions(latitude, longitude), strict=True):
        columns[name] = [f"{degrees:.9f}" for degrees in place]
    log = log_of(tmp_path, columns)
    assert log["east"].values - log["east"].values[0] == pytest.approx(MOTION["east"], abs=0.1)


@pytest.mark.parametrize(
    ("latitude", "longitude"), [(63.4, 10.4), (-33.9, 18.4), (1.3, 103.9), (50.0, -125.0)]
)
@pytest.mark.parametrize("names", [("Lat", "Lon"), ("latitude", "longitude")])
def test_positions_in_radians_without_a_unit_are_asked(tmp_path, latitude, longitude, names):
    columns = {"time": [f"{t}" for t in T]}
    for name, place in zip(names, positions(latitude, longitude), strict=True):
        columns[name] = [f"{np.radians(degrees):.12f}" for degrees in place]
    rows = [",".join(columns), *(",".join(row) for row in zip(*columns.values(), strict=True))]
    used = {g.role: g for g in propose(columns_of(save(tmp_path, rows)), THRUSTERS).used}
    assert used["latitude"].is_guess and used["longitude"].is_guess
    assert used["latitude"].channel.unit == used["longitude"].channel.unit == "rad"


@pytest.mark.parametrize("names", [("Lat (deg)", "Lat (min)"), ("Lat deg", "Lat minutes")])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_minutes_in_a_column_of_their_own_are_added_to_whole_degrees(tmp_path, names, sign):
    columns = {"time": T, "Hdg": MOTION["heading"]}
    for name, role in zip(("Lat", "Lon"), ("north", "east"), strict=True):
        degrees = 63.25 + MOTION[role] / 111e3
        whole = (f"{sign * np.floor(d):.0f}" for d in degrees)
        columns[names[0].replace("Lat", name)] = list(whole)
        columns[names[1].replace("Lat", name)] = [f"{60.0 * (d % 1.0):.6f}" for d in degrees]
    log = log_of(tmp_path, columns | {"Side": ["E"] * len(T)})
    size = np.abs(log["north"].values[75] - log["north"].values[0])
    assert size == pytest.approx(np.ptp(MOTION["north"][[0, 75]]), rel=0.01)
    assert "are added to the degrees in" in remarks(log)


@pytest.mark.parametrize("seconds", ["Lat sec", "Lat rest"])
def test_whole_minutes_are_not_added_as_seconds_may_stand_behind(tmp_path, seconds):
    columns = {"time": T, "heading": MOTION["heading"], "Lat deg": ["63"] * len(T)}
    columns |= {"Lat min": [f"{24 + t // 100:.0f}" for t in T], seconds: T % 60.0}
    assert "are added" not in remarks(log_of(tmp_path, columns))


def test_a_latitude_that_never_changes_is_no_position_beside_x_and_y(tmp_path):
    still = {"lat (rad)": np.full(len(T), 1.1), "lon (rad)": np.full(len(T), 0.2)}
    motion = {"x (m)": MOTION["north"], "y (m)": MOTION["east"], "Hdg [deg]": MOTION["heading"]}
    log = log_of(tmp_path, {"time": T} | still | motion)
    assert "north" not in log or np.ptp(log["north"].values) > 1.0
    assert "'lat', 'lon'" in remarks(log)


@pytest.mark.parametrize("name", ["hdg", "Heading"])
def test_hundredths_of_degrees_are_asked(tmp_path, name):
    columns = {"time": T, "north": MOTION["north"], "east": MOTION["east"]}
    columns[name] = [f"{100.0 * v:.0f}" for v in MOTION["heading"]]
    log = log_of(tmp_path, columns)
    assert "heading" not in log
    assert "hundredths of a degree" in remarks(log)
    channels = propose(columns_of(tmp_path / "log.csv")).channels(guessed=True)
    read = read_log(tmp_path / "log.csv", ChannelFile(channels, FileLayout()))
    assert read["heading"].values == pytest.approx(MOTION["heading"], abs=0.01)
