"""Logs are read by roles or by a channel file, units converted, no row lost; an unusable file is refused in words."""

import gzip

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest

from shipcosim.diagnose.log.reader import read_log
from shipcosim.errors import ShipcosimError
from shipcosim.series import read_table, write_table


def written(folder, text, name="log.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


PLAIN = "time [s],surge [kn],heading [deg],bow_rpm,note\n0,1,359,60,a\n0.5,2,1,,b\n1,3,3,62,c\n"


def test_columns_named_by_roles_are_read_in_the_units_of_the_roles(tmp_path):
    log = read_log(written(tmp_path, PLAIN))
    assert log["surge"].values == pytest.approx(np.array([1.0, 2.0, 3.0]) * 1852 / 3600, rel=1e-12)
    assert log["surge"].attrs["units"] == "m/s" and log["bow_rpm"].attrs["units"] == "rpm"
    assert log["time"].values.tolist() == [0.0, 0.5, 1.0] and log["heading"].values.tolist() == [
        359.0,
        1.0,
        3.0,
    ]
    assert np.isnan(log["bow_rpm"].values).tolist() == [False, True, False]
    assert log.attrs["unused_columns"] == ["note"]


@pytest.mark.parametrize("suffix", [".csv.gz", ".parquet", ".nc"])
def test_every_format_gives_the_same_log(tmp_path, suffix):
    plain = written(
        tmp_path,
        PLAIN.replace(",note", "").replace(",a\n", "\n").replace(",b\n", "\n").replace(",c", ""),
    )
    path = tmp_path / f"other{suffix}"
    if suffix == ".csv.gz":
        path.write_bytes(gzip.compress(plain.read_bytes()))
    elif suffix == ".parquet":
        pyarrow.parquet.write_table(pyarrow.csv.read_csv(plain), path)
    else:
        write_table(read_table(plain), path)
    assert read_log(path).identical(read_log(plain))


def test_rows_stay_as_they_are_in_the_file_however_the_times_are(tmp_path):
    log = read_log(written(tmp_path, "time,surge\n2,1\n1,2\n1,3\n,4\n5,5\n"))
    assert log["time"].values.tolist()[:3] == [2.0, 1.0, 1.0] and np.isnan(log["time"].values[3])
    assert log["surge"].values.tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]


CHANNELS = """
time = {column = "t", unit = "ms"}
surge = {column = "u", unit = "kn"}
sway = {column = "v", sign = -1}
heading = {column = "psi", offset = -0.1}
bow_rpm = "n"
"thruster.n" = {column = "n", unit = "rad/s"}
"""


def test_a_channel_file_gives_roles_units_signs_and_offsets(tmp_path):
    path = written(tmp_path, "t,u,v [kn],psi [rad],n\n0,1,1,0.1,5\n500,2,2,3.2415926535897932,6\n")
    log = read_log(path, written(tmp_path, CHANNELS, "channels.toml"))
    assert log["time"].values.tolist() == [0.0, 0.5]
    assert log["surge"].values == pytest.approx([1852 / 3600, 3704 / 3600], rel=1e-12)
    assert log["sway"].values == pytest.approx([-1852 / 3600, -3704 / 3600], rel=1e-12)
    assert log["heading"].values == pytest.approx([0.0, 180.0], abs=1e-9)
    assert log["thruster.n"].attrs["units"] == "rad/s" and log["thruster.n"].values.tolist() == [
        5.0,
        6.0,
    ]
    assert log["bow_rpm"].values.tolist() == [5.0, 6.0] and log.attrs["unused_columns"] == []


def test_a_degree_of_latitude_is_as_long_as_surveyors_say(tmp_path):
    """At 60 degrees: 111.412 km and 55.800 km, tables of the WGS 84 ellipsoid."""
    path = written(
        tmp_path, "time,latitude,longitude\n0,,\n1,60,10\n2,60.001,10\n3,60,10.001\n4,60,370.001\n"
    )
    log = read_log(path)
    assert log["north"].values[1:] == pytest.approx([0.0, 111.412, 0.0, 0.0], abs=2e-3)
    assert log["east"].values[1:] == pytest.approx([0.0, 0.0, 55.800, 55.800], abs=2e-3)
    assert (log.attrs["latitude_origin"], log.attrs["longitude_origin"]) == pytest.approx(
        (60.0, 10.0)
    )


def test_stamps_of_date_and_time_become_seconds(tmp_path):
    path = written(tmp_path, "time,surge\n2022-10-27 08:00:01,1\n2022-10-27 08:01:00,2\n")
    assert read_log(path)["time"].values.tolist() == [0.0, 59.0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("moment,surge\n0,1\n1,2\n", "has no column 'time', only 'moment', 'surge'"),
        (
            "time,surge\n2024/075/10:14:00,1\n2024/075/10:15:00,2\n",
            "column 'time' holds '2024/075/10:14:00', which is not read",
        ),
        ("time,u\n0,1\n1,2\n", "no column but time has a role: 'time', 'u'"),
        ("time,surge [deg]\n0,1\n1,2\n", "its unit 'deg' is none that converts to m/s"),
        ("time,surge\n0,1\n1,fast\n", "holds 'fast' in row 3, not only numbers"),
        ("time,surge\n0,1\n", "fewer than two different times"),
        ("time,surge,surge\n0,1,1\n", "column 'surge': is there twice"),
        ("time,surge\n", "has no row below its header"),
    ],
)
def test_an_unusable_file_is_refused_with_what_is_wrong(tmp_path, text, said):
    with pytest.raises(ShipcosimError, match=said):
        read_log(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('surge = "u"', "says no column for time"),
        ('time = "t"\nsurge = "uu"', "there is no column 'uu'. There is: t, u. Did you mean 'u'?"),
        ('time = "t"\nsurg = "u"', "is no role. .* Did you mean 'surge'"),
        ('time = "t"\nnorth = "u"', "has north without east"),
        ('time = "t"\nsurge = {column = "u", sign = 2}', "surge.sign"),
        ('time = "t"\nsurge = {column = "u", scale = 2}', "surge.scale"),
        ('time = "t"\nsurge = 3', "surge: is 3. It should be a table"),
        (
            'time = "t"\nsurge = {column = "u", offset = "a"}',
            'offset = "a". It should be a number, wi',
        ),
        ('time = "t"\nsurge = {}', r"surge: it should name a column, .* quaternion\.$"),
        (
            'time = "t"\nsurge = {column = "u", unit = "deg"}',
            "its unit 'deg' is none that converts to m/s",
        ),
        ("time = ", "is no TOML: .*Channel files are text files in TOML"),
    ],
)
def test_a_bad_channel_file_is_refused_with_what_is_wrong(tmp_path, text, said):
    with pytest.raises(ShipcosimError, match=said):
        read_log(written(tmp_path, "t,u\n0,1\n1,2\n"), written(tmp_path, text, "channels.toml"))


def test_a_zero_keeps_its_sign(tmp_path):
    values = read_log(written(tmp_path, "time,yaw_rate [deg/s]\n0,-0.0\n1,0.0\n"))[
        "yaw_rate"
    ].values
    assert np.signbit(values).tolist() == [True, False]


def test_numbers_by_which_ais_says_that_there_is_none_are_left_out(tmp_path):
    rows = ["BaseDateTime,LAT,LON,SOG,COG,Heading"]
    rows += [f"2024-05-03T10:00:{s:02d},{62 + s * 1e-5:.5f},6.0,2.2,0.0,120" for s in range(30)]
    rows[5] = "2024-05-03T10:00:04,91.0,181.0,102.3,0.0,511"
    log = read_log(written(tmp_path, "\n".join(rows) + "\n"))
    for role in ("north", "heading", "surge"):
        assert np.flatnonzero(np.isnan(log[role].values)).tolist() == [4]
    assert float(np.nanmax(log["heading"])) == 120.0
    said = " ".join(log.attrs["column_remarks"])
    assert "'Heading' is 511 in 1 of its rows" in said and "'SOG' is 102.3" in said


IN_METRES_PER_SECOND = {
    "nm/h": 1852 / 3600,
    "nm/hr": 1852 / 3600,
    "nmph": 1852 / 3600,
    "nautical miles per hour": 1852 / 3600,
    "nmi/h": 1852 / 3600,
    "knots": 1852 / 3600,
    "KTS": 1852 / 3600,
    "cm/s": 0.01,
    "mm/s": 0.001,
}


@pytest.mark.parametrize("unit", IN_METRES_PER_SECOND)
def test_a_speed_is_read_in_the_unit_as_ships_write_it(tmp_path, unit):
    log = read_log(written(tmp_path, f"time [s],surge [{unit}],heading [deg]\n0,1,5\n1,2,6\n"))
    wanted = IN_METRES_PER_SECOND[unit] * np.array([1.0, 2.0])
    assert log["surge"].values == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize(("unit", "metres"), [("nm", 1852.0), ("NM", 1852.0), ("mm", 1e-3)])
def test_a_nautical_mile_is_no_nanometre(tmp_path, unit, metres):
    log = read_log(written(tmp_path, f"time [s],north [{unit}],east [{unit}]\n0,1,0\n1,2,0\n"))
    assert log["north"].values == pytest.approx([metres, 2 * metres])


@pytest.mark.parametrize(
    ("unit", "degrees"), [("gon", 9.0), ("gradian", 9.0), ("Grad", 10.0), ("deg", 10.0)]
)
def test_a_gon_is_no_degree(tmp_path, unit, degrees):
    path = tmp_path / "log.csv"
    path.write_text(f"time [s],heading [{unit}]\n0,10\n1,10\n")
    assert read_log(path)["heading"].values == pytest.approx([degrees, degrees])


def test_a_unit_that_can_be_a_gon_or_a_degree_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time [s],heading [grad]\n0,10\n1,10\n")
    with pytest.raises(ShipcosimError, match="grad.*deg"):
        read_log(path)


@pytest.mark.parametrize("unit", ["1/s", "s-1", "s^-1"])
def test_per_second_is_radians_of_a_turn_and_revolutions_of_a_shaft(tmp_path, unit):
    log = read_log(
        written(tmp_path, f"time [s],yaw_rate [{unit}],bow_rpm [{unit}]\n0,1,1\n1,2,2\n")
    )
    assert log["yaw_rate"].values == pytest.approx(np.degrees([1.0, 2.0]))
    assert log["bow_rpm"].values == pytest.approx([60.0, 120.0])


@pytest.mark.parametrize("count", [1, 2, 7])
def test_a_log_without_any_value_is_refused(tmp_path, count):
    names = ["north [m]", "east [m]", "heading [deg]", "surge [m/s]", "sway [m/s]", "u", "v"][
        :count
    ]
    rows = [",".join([str(t), *["nan"] * count]) for t in range(5)]
    text = "\n".join([",".join(["time [s]", *names]), *rows])
    with pytest.raises(ShipcosimError, match="no row has a value of|no column but time"):
        read_log(written(tmp_path, text))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_of_one_row_is_refused_for_its_one_row(tmp_path, separator):
    text = "time [s],north [m],east [m]\n0,1.5,2.5\n".replace(",", separator)
    with pytest.raises(ShipcosimError, match="fewer than two different times"):
        read_log(written(tmp_path, text))


def test_a_remark_does_not_list_thousands_of_columns(tmp_path):
    names = ["time [s]", "north [m]", "east [m]", *(f"c{i}" for i in range(3000))]
    rows = [",".join([str(t)] * len(names)) for t in range(3)]
    log = read_log(written(tmp_path, "\n".join([",".join(names), *rows])))
    assert all(len(remark) < 500 for remark in log.attrs["column_remarks"])
    assert "and 2980 more" in " ".join(log.attrs["column_remarks"])


def test_a_column_that_is_only_guessed_comes_with_how_to_confirm_it(tmp_path):
    rows = [f"{t},{0.1 * t},0.0,{t},{t % 7}" for t in range(30)]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["time [s],north [m],east [m],heading [deg],yaw rate", *rows]) + "\n")
    said = read_log(path).attrs["column_remarks"]
    guessed = [k for k, text in enumerate(said) if "is not used: it may be" in text]
    assert guessed and "shipcosim channels LOG --out" in said[guessed[-1] + 1]
