"""Signs in a column of sides, and longitudes beside latitudes, are read at any place; what they leave open is asked."""

import numpy as np
import pytest
from diagnose.log.files.test_missing import EASY, MOTION, T, log_of, remarks
from diagnose.log.oddities import THRUSTERS, save
from hypothesis import given
from hypothesis import strategies as some

from shipcosim.diagnose.log.degree_size import metres_per_degree
from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.reader import columns_of

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
def test_positions_in_radians_without_a_unit_are_asked(tmp_path, latitude, longitude):
    columns = {"time": [f"{t}" for t in T]}
    for name, place in zip(("Lat", "Lon"), positions(latitude, longitude), strict=True):
        columns[name] = [f"{np.radians(degrees):.12f}" for degrees in place]
    rows = [",".join(columns), *(",".join(row) for row in zip(*columns.values(), strict=True))]
    used = {g.role: g for g in propose(columns_of(save(tmp_path, rows)), THRUSTERS).used}
    assert used["latitude"].is_guess and used["longitude"].is_guess
    assert used["latitude"].channel.unit == used["longitude"].channel.unit == "rad"
