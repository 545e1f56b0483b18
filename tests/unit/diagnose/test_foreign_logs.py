"""Logs by conventions of other tools open with the right channels, or are asked about; none is wrong in silence."""

import json

import numpy as np
import pytest

from shipcosim.diagnose.log.names.proposal import propose
from shipcosim.diagnose.log.names.vocabulary import meaning_of, words_of
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError

THRUSTERS = {"port": ("rpm", "azimuth"), "starboard": ("rpm", "azimuth"), "tunnel": ("rpm",)}
ROWS = 40
T = np.arange(float(ROWS))
HEADING = 30.0 + 10.0 * np.sin(T / 8.0)


def saved(folder, lines, name="log.csv"):
    path = folder / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def table(folder, columns, above=(), separator=","):
    """File with columns of numbers or texts."""
    rows = [
        [f"{cell:.9g}" if isinstance(cell, float) else str(cell) for cell in cells]
        for cells in columns.values()
    ]
    lines = [separator.join(row) for row in zip(*rows, strict=True)]
    return saved(folder, [separator.join(columns), *above, *lines])


def ranks(path):
    """Whether each role is a guess."""
    return {guess.role: guess.is_guess for guess in propose(columns_of(path), THRUSTERS).used}


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("Gyro true heading", "heading"),
        ("Velocidad del viento aparente", "wind_speed"),
        ("Rumbo sobre el fondo", "course_over_ground"),
        ("Anemometer Relative Direction", "wind_from"),
        ("Taux de giration", "yaw_rate"),
        ("GPS_Speed", "speed_over_ground"),
    ],
)
def test_words_of_a_name_have_no_order(name, role):
    meaning = meaning_of(words_of(name))
    assert (meaning.role, meaning.doubt) == (role, "")
    assert meaning_of(tuple(reversed(words_of(name)))) == meaning


def test_descriptions_below_the_units_are_no_names(tmp_path):
    above = ["s,deg,kn,deg", "GPS time,Gyro,Apparent wind speed,Apparent wind angle"]
    path = table(
        tmp_path, {"TIME": T, "HDT": HEADING, "AWS": 0.0 * T + 10.0, "AWA": HEADING}, above
    )
    log = read_log(path, None, THRUSTERS)
    assert log["wind_speed"].values == pytest.approx(10.0 * 1852.0 / 3600.0)
    assert log["heading"].values == pytest.approx(HEADING)


def test_a_wind_speed_without_a_direction_from_the_bow_is_asked(tmp_path):
    columns = {"time": T, "heading": HEADING, "wind_speed": T + 1.0}
    assert ranks(table(tmp_path, columns))["wind_speed"]
    by_cf = ranks(table(tmp_path, columns | {"wind_from_direction": HEADING}))
    assert by_cf["true_wind_speed"] and by_cf["true_wind_from"] and "wind_speed" not in by_cf
    assert not ranks(table(tmp_path, columns | {"wind_from": HEADING}))["wind_speed"]


def test_speed_and_course_beside_a_heading_may_be_over_ground(tmp_path):
    asked = ranks(
        table(tmp_path, {"time": T, "heading": HEADING, "speed_kmh": T, "course": HEADING})
    )
    assert asked["speed_over_ground"] and asked["course_over_ground"] and "surge" not in asked


@pytest.mark.parametrize(
    ("name", "first"), [("Date/Time", 44861.9), ("data.Time", 738821.9), ("Julian Day", 300.9)]
)
def test_days_are_times(tmp_path, name, first):
    days = [f"{first + t / 86400.0:.9f}" for t in T]
    log = read_log(table(tmp_path, {name: days, "heading": HEADING}), None, THRUSTERS)
    assert np.diff(log["time"].values) == pytest.approx(1.0, abs=1e-3)


def test_tags_of_a_historian_are_channels(tmp_path):
    lines = ["TagName,Timestamp,Value,Quality"]
    for t, heading in zip(T, HEADING, strict=True):
        stamp = f"27-Oct-22 21:57:{t:02.0f}"
        lines += [
            f"GUN:Gyro_Heading.PV,{stamp},{heading:.4f},Good",
            f"GUN:Yaw_Rate_degps.PV,{stamp},1.5,Good",
        ]
        lines += [
            f"GUN:DP_Surge_Speed_mps.PV,{stamp},0.4,Good",
            f"GUN:DP_Sway_Speed_mps.PV,{stamp},0.1,Good",
        ]
    log = read_log(saved(tmp_path, lines), None, THRUSTERS)
    assert {"heading", "yaw_rate", "surge", "sway"} <= set(log.data_vars)
    assert log["heading"].values == pytest.approx(HEADING, abs=1e-3)


def test_the_header_of_labview_is_no_table(tmp_path):
    header = [
        "LabVIEW Measurement\t",
        "Separator\tTab",
        "***End_of_Header***\t",
        "",
        "Channels\t2",
        "Samples\t40\t40",
    ]
    header += [
        "Y_Unit_Label\trad\tdeg/s",
        "X_Dimension\tTime\tTime",
        "Delta_X\t1.0\t1.0",
        "***End_of_Header***\t\t",
    ]
    rows = [
        f"{t:.3f}\t{np.radians(heading):.9f}\t0.5" for t, heading in zip(T, HEADING, strict=True)
    ]
    path = saved(tmp_path, [*header, "X_Value\tHeading\tYaw rate\tComment", *rows], "log.lvm")
    log = read_log(path, None, THRUSTERS)
    assert log["time"].values == pytest.approx(T)
    assert log["heading"].values == pytest.approx(HEADING)


def test_positions_of_instruments_and_of_germans(tmp_path):
    columns = {"Zeit [s]": T, "Kurs rechtweisend": HEADING}
    texts = {"Breite": ["62°19.9982'N"] * ROWS, "Länge": [f"006°{9.0 + 0.01 * t:.4f}'O" for t in T]}
    east = read_log(table(tmp_path, columns | texts), None, THRUSTERS).attrs["longitude_origin"]
    assert east == pytest.approx(6.15)
    numbers = {
        "Lat (DDMM.MMMM)": 6219.9982 + 0.0 * T,
        "N/S": ["N"] * ROWS,
        "Lon (DDDMM.MMMM)": 609.0 + 0.01 * T,
    }
    west = read_log(table(tmp_path, columns | numbers | {"E/W": ["W"] * ROWS}), None, THRUSTERS)
    assert west.attrs["longitude_origin"] == pytest.approx(-6.15)


def test_the_only_tunnel_thruster_is_at_the_bow_and_this_is_said(tmp_path):
    log = read_log(
        table(tmp_path, {"time": T, "heading": HEADING, "Bow thruster rpm": T}), None, THRUSTERS
    )
    assert log["tunnel_rpm"].values == pytest.approx(T)
    assert "assumed to be the one at the bow" in " ".join(log.attrs["column_remarks"])


def test_standard_names_of_netcdf_go_before_names_that_say_nothing(tmp_path):
    import xarray

    names = {
        "HD": "platform_orientation",
        "VSHIP": "platform_speed_wrt_ground",
        "DIR": "wind_from_direction",
    }
    columns = {name: ("time", HEADING, {"standard_name": title}) for name, title in names.items()}
    xarray.Dataset(columns, {"time": T}).to_netcdf(tmp_path / "log.nc", engine="h5netcdf")
    proposal = propose(columns_of(tmp_path / "log.nc"), THRUSTERS)
    roles = {guess.column: guess.role for guess in (*proposal.used, *proposal.unused)}
    assert roles["HD"] == "heading"
    assert roles["DIR"] == "true_wind_from"
    assert next(g for g in proposal.unused if g.column == "VSHIP").why.startswith(
        "it is speed over ground"
    )


@pytest.mark.parametrize(
    ("first", "shift", "is_one"), [(52.0, 0.4, True), (0.0, 0.0, False), (52.0, 20.0, False)]
)
def test_tables_of_one_clock_that_was_on_before_are_joined(tmp_path, first, shift, is_one):
    table(tmp_path, {"time": first + T, "heading": HEADING}).rename(tmp_path / "gyro.csv")
    table(tmp_path, {"time": first + shift + T, "surge": T, "sway": T}).rename(
        tmp_path / "speed.csv"
    )
    if is_one:
        assert {"heading", "surge", "sway"} <= set(read_log(tmp_path).data_vars)
    else:
        with pytest.raises(ShipcosimError, match="may count from different starts"):
            read_log(tmp_path)


def test_deltas_of_signal_k_are_in_radians(tmp_path):
    lines = []
    for t, heading in zip(T, HEADING, strict=True):
        values = {
            "navigation.headingTrue": np.radians(heading),
            "environment.wind.angleApparent": -0.5,
        }
        entries = [{"path": path, "value": float(value)} for path, value in values.items()]
        update = {"timestamp": f"2022-10-27T21:57:{t:02.0f}.000Z", "values": entries}
        lines.append(json.dumps({"context": "vessels.self", "updates": [update]}))
    log = read_log(saved(tmp_path, lines, "deltas.log"), None, THRUSTERS)
    assert log["heading"].values == pytest.approx(HEADING)
    assert log["wind_from"].values == pytest.approx(np.degrees(-0.5))


def test_a_wind_is_a_speed_or_a_direction_by_its_unit(tmp_path):
    sure = ranks(
        table(tmp_path, {"time": T, "heading": HEADING, "Rel wind [kn]": T, "Rel wind °": HEADING})
    )
    assert sure["wind_speed"] is False and sure["wind_from"] is False


def test_columns_of_two_levels_have_the_name_of_their_index(tmp_path):
    above = [",Heading [deg],Speed [rpm],Speed [rpm]", "Time,,,"]
    columns = {"": T, "Gyro": HEADING, "Port thruster": T + 1.0, "Stbd thruster": T + 2.0}
    log = read_log(table(tmp_path, columns, above), None, THRUSTERS)
    assert log["starboard_rpm"].values == pytest.approx(log["port_rpm"].values + 1.0)
    assert log["heading"].values == pytest.approx(HEADING)


def test_values_of_a_german_database_have_their_units(tmp_path):
    lines = ["Kanal;Einheit;Zeitpunkt;Wert"]
    for t in T:
        stamp = f"27.10.2022 21:57:{t:02.0f}"
        lines += [
            f"Heading;°;{stamp};{t:.2f}",
            f"Drehrate;°/min;{stamp};60,0",
            f"Tiefe;m;{stamp};38,2",
        ]
    log = read_log(saved(tmp_path, [line.replace(".00", ",00") for line in lines]), None, THRUSTERS)
    assert log["yaw_rate"].values == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("name", "role"), [("Gyrokurs", "heading"), ("Girrate", "yaw_rate"), ("Langskipsfart", "surge")]
)
def test_words_of_two_words_without_a_blank_are_known(name, role):
    assert meaning_of(words_of(name)).role == role


def test_points_of_a_plant_are_named_by_their_descriptions(tmp_path):
    lines = ["Point,Description,Units,Time,Value"]
    for t, heading in zip(T, HEADING, strict=True):
        stamp = f"27-Oct-2022 21:57:{t:02.0f}"
        lines += [
            f"AI01,Gyro heading,deg,{stamp},{heading:.3f}",
            f"AI02,Rate of turn,deg/min,{stamp},60",
        ]
    log = read_log(saved(tmp_path, lines), None, THRUSTERS)
    assert log["heading"].values == pytest.approx(HEADING, abs=1e-3)
    assert log["yaw_rate"].values == pytest.approx(1.0)


def test_a_number_that_can_be_in_two_units_of_time_is_asked(tmp_path):
    assert ranks(table(tmp_path, {"timestamp": 60000.0 * T, "heading": HEADING}))["time"]


def test_the_true_course_of_other_languages_is_no_course_over_ground(tmp_path):
    columns = {"Czas [s]": T, "Kurs rzeczywisty": HEADING, "Prędkość nad dnem [w]": T}
    assert ranks(table(tmp_path, columns))["heading"]


def test_a_wind_without_a_unit_beside_knots_is_asked(tmp_path):
    columns = {
        "time": T,
        "heading": HEADING,
        "COG": HEADING,
        "RelWindSpd": T,
        "RelWindDir": HEADING,
    }
    assert ranks(table(tmp_path, columns | {"SOG [kn]": T}))["wind_speed"]
    assert not ranks(table(tmp_path, columns | {"SOG [m/s]": T}))["wind_speed"]
