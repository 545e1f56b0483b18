"""Tables: written and read again they are the same; bad files and full disks are said, not half-written."""

import gzip
import math
import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as some

from shipcosim.errors import ShipcosimError
from shipcosim.series import (
    conversion,
    make_table,
    read_columns,
    read_table,
    write_file,
    write_table,
)


@pytest.fixture
def table():
    columns = [
        ("vessel.x", np.array([0.0, 0.1, -1 / 3]), "m", "north"),
        ("port.failed", np.array([False, True, True]), "1", "port has failed"),
        ("weather.seed", np.array([3, 3, 3], dtype=np.int32), "1", "seed"),
    ]
    return make_table(np.arange(3) * 0.05, columns, {"scenario": "a test", "step_size": 0.05})


@pytest.mark.parametrize("suffix", [".nc", ".csv"])
def test_what_is_written_is_read_to_the_last_digit(table, tmp_path, suffix):
    write_table(table, tmp_path / f"t{suffix}")
    again = read_table(tmp_path / f"t{suffix}")
    assert list(again.data_vars) == list(table.data_vars)
    for name, column in table.variables.items():
        assert np.array_equal(again[name].values, column.values), name
        assert again[name].attrs["units"] == column.attrs["units"]


def test_netcdf_keeps_attributes_types_and_long_names(table, tmp_path):
    write_table(table, tmp_path / "t.nc")
    again = read_table(tmp_path / "t.nc")
    assert again.attrs == {"scenario": "a test", "step_size": 0.05}
    assert again["port.failed"].dtype == bool and again["weather.seed"].dtype == np.int32
    assert again["vessel.x"].attrs["long_name"] == "north"


@pytest.mark.parametrize("units", [1, 1.5, np.int8(1), np.array([1.0, 2.0]), True, "", b"m"])
def test_units_that_are_no_texts_are_read_as_texts(table, tmp_path, units):
    write_table(table, tmp_path / "t.nc")
    with h5py.File(tmp_path / "t.nc", "a") as file:
        file["vessel.x"].attrs["units"] = units
    assert type(read_table(tmp_path / "t.nc")["vessel.x"].attrs["units"]) is str


@pytest.mark.parametrize("suffix", [".nc", ".csv"])
@pytest.mark.parametrize("name", ["\0", "x\0", "a\0b", "\ud800", "x\udfff"])
def test_a_name_that_no_file_can_hold_is_refused(tmp_path, name, suffix):
    file = tmp_path / f"t{suffix}"
    with pytest.raises(ShipcosimError, match="no file can hold the name"):
        write_table(make_table(np.arange(3.0), [(name, np.zeros(3), "m", "")]), file)
    assert not file.exists()


NAMES = some.lists(
    some.one_of(
        some.text(min_size=1, max_size=12).filter(lambda text: "\0" not in text),
        some.lists(
            some.sampled_from([*" ,;\"'[]()/.%#\n\t\\", "a", "time", "\u2028", "%2F", "[m]"]),
            min_size=1,
            max_size=6,
        ).map("".join),
    ).filter(
        lambda text: (
            text != "time" and text.isascii() or text.encode("utf-8", "ignore").decode() == text
        )
    ),
    min_size=1,
    max_size=4,
    unique=True,
)
UNITS = some.sampled_from(["m", "1", "kg.m2/s", "kg[dry]", "%", "a(b)"])


@settings(
    max_examples=40,
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@example(names=["a/b", "a%2Fb", ".", "%2E"], unit="m")
@example(names=["x [m]", "x [m", "x", " x", "x ", '"x"'], unit="m")
@given(names=NAMES.filter(lambda names: "time" not in names), unit=UNITS)
def test_names_of_any_kind_are_kept_in_every_format(tmp_path, names, unit):
    columns = [(name, np.array([i, 0.5]), unit, "") for i, name in enumerate(names)]
    table = make_table(np.arange(2.0), columns)
    for suffix in (".nc", ".csv"):
        path = tmp_path / f"names{suffix}"
        write_table(table, path)
        again = read_table(path)
        assert list(again.data_vars) == names
        assert [again[name].attrs["units"] for name in names] == [unit] * len(names)
        assert [again[name].values[0] for name in names] == list(range(len(names)))
        assert set(read_columns(path)) == {"time", *names}


@pytest.mark.parametrize("suffix", [".nc", ".csv"])
def test_equal_tables_give_equal_bytes(table, tmp_path, suffix):
    for name in ("a", "b"):
        write_table(table.copy(deep=True), tmp_path / f"{name}{suffix}")
    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_csv_has_one_header_of_names_and_units(table, tmp_path):
    write_table(table, tmp_path / "t.csv")
    first, second, *_ = (tmp_path / "t.csv").read_text().splitlines()
    assert first == "time [s],vessel.x [m],port.failed [1],weather.seed [1]"
    assert second == "0,0,0,3"


def test_gzipped_csv_is_read(table, tmp_path):
    write_table(table, tmp_path / "t.csv")
    (tmp_path / "t.csv.gz").write_bytes(gzip.compress((tmp_path / "t.csv").read_bytes()))
    assert read_table(tmp_path / "t.csv.gz").sizes["time"] == 3


def test_time_in_another_unit_is_converted_to_seconds(tmp_path):
    (tmp_path / "t.csv").write_text("time [min],x [m]\n0,1\n2,3\n")
    assert list(read_table(tmp_path / "t.csv").time.values) == [0.0, 120.0]


@pytest.mark.parametrize(
    "texts",
    [
        ("0 days 00:00:01", "0 days 00:01:00.250000", "1 days 00:00:00"),
        ("00:00:01.0", "00:01:00.25", "24:00:00.0"),
        ('"0:00:01"', '"0:01:00.250000"', '"1 day, 0:00:00"'),
        ("PT1S", "PT1M0.25S", "P1D"),
    ],
    ids=["pandas", "clock", "Python", "ISO 8601"],
)
@pytest.mark.parametrize("unit", ["", " [s]", " [ms]"])
def test_spans_of_time_become_seconds(tmp_path, texts, unit):
    rows = [f"{text},{i}" for i, text in enumerate(texts)]
    (tmp_path / "t.csv").write_text("\n".join([f"time{unit},x [m]", *rows]) + "\n")
    assert read_table(tmp_path / "t.csv").time.values.tolist() == [1.0, 60.25, 86400.0]


@pytest.mark.parametrize("text", ["00:01", "P1Y", "1 day ago", "0 days 1:00"])
def test_what_is_no_span_of_time_is_refused(tmp_path, text):
    (tmp_path / "t.csv").write_text(f"time [s],x [m]\n{text},0\n{text},1\n")
    with pytest.raises(ShipcosimError, match="not numbers"):
        read_table(tmp_path / "t.csv")


@pytest.mark.parametrize(
    "content",
    ["time [s];u [N]\n0;1,5\n0,5;-2,25\n", "time [s]\tu [N]\n0\t1.5\n0.5\t-2.25\n"],
    ids=["decimal commas", "tabs"],
)
def test_tables_of_spreadsheets_are_read(tmp_path, content):
    (tmp_path / "t.csv").write_text(content)
    table = read_table(tmp_path / "t.csv")
    assert table.time.values.tolist() == [0.0, 0.5] and table.u.values.tolist() == [1.5, -2.25]
    assert table.u.attrs["units"] == "N"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("x [m]\n1.0\n", "no column 'time'"),
        ("time [s],x [m]\n0,left\n", "column 'x'.*not numbers"),
        ("time [s],x [m]\n0,1_000\n1,2_000\n", "column 'x'.*not numbers, as '1_000'"),
        ("time [s],x [m],x [m]\n0,1,2\n", "'x'.*twice"),
        ("time [s],x [m]\n0,1,2\n", "row 2: has 3 cells, and the header has 2"),
    ],
)
def test_unusable_csv_is_refused_with_the_reason(tmp_path, content, said):
    (tmp_path / "t.csv").write_text(content)
    with pytest.raises(ShipcosimError, match=f"t.csv.*{said}"):
        read_table(tmp_path / "t.csv")


def test_other_formats_and_missing_files_are_refused(table, tmp_path):
    with pytest.raises(ShipcosimError, match=r"Use .nc or .csv"):
        write_table(table, tmp_path / "t.xlsx")
    with pytest.raises(ShipcosimError, match="no table"):
        read_table(tmp_path / "t.xlsx")
    with pytest.raises(ShipcosimError, match="no such file"):
        read_table(tmp_path / "t.nc")
    (tmp_path / "t.nc").write_text("not HDF5")
    with pytest.raises(ShipcosimError, match="no row below its header"):
        read_table(tmp_path / "t.nc")


FULL_DISK = """
import resource, sys
import numpy as np
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table, write_table
table = make_table(np.arange(5000.0), [("x", np.random.default_rng(1).normal(size=5000), "m", "")])
resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
try:
    write_table(table, sys.argv[1])
except ShipcosimError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="limits the size of files by POSIX's setrlimit")
@pytest.mark.parametrize("suffix", [".nc", ".csv"])
def test_full_disk_leaves_no_file(tmp_path, suffix):
    path = tmp_path / f"t{suffix}"
    run = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(path)], capture_output=True, text=True, check=True
    )
    assert "cannot be written: File too large" in run.stdout and path.name in run.stdout
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_keeps_the_old_file(tmp_path):
    (tmp_path / "page.html").write_text("old")
    with pytest.raises(TypeError):
        write_file(tmp_path / "page.html", "not bytes")
    assert (tmp_path / "page.html").read_text() == "old" and len(list(tmp_path.iterdir())) == 1
    with pytest.raises(ShipcosimError, match=r"cannot be written: No such file or directory\.$"):
        write_file(tmp_path / "nowhere" / "page.html", b"new")


@pytest.mark.parametrize(
    ("unit_from", "unit_to", "factor"),
    [
        ("deg", "rad", math.pi / 180),
        ("rpm", "rad/s", 2 * math.pi / 60),
        ("kn", "m/s", 1852 / 3600),
        ("kN.m", "N.m", 1000.0),
        ("kg.m2", "g.m2", 1000.0),
        ("kg.m/s2", "N", 1.0),
        ("m/s2", "m.s-2", 1.0),
        ("N*m", "N.m", 1.0),
        ("%", "1", 0.01),
        ("", "m", 1.0),
        ("m", None, 1.0),
    ],
)
def test_units_convert_by_the_textbooks_factor(unit_from, unit_to, factor):
    assert conversion(unit_from, unit_to) == (pytest.approx(factor, rel=1e-15), 0.0)


def test_temperatures_convert_with_an_offset():
    factor, offset = conversion("degF", "degC")
    assert factor * 212.0 + offset == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("unit_from", "unit_to", "said"),
    [
        ("m", "s", "different things"),
        ("furlongz", "m", "furlongz"),
        ("m", "9**9**9**9", "is no unit"),
    ],
)
def test_units_that_do_not_convert_are_an_error(unit_from, unit_to, said):
    with pytest.raises(ShipcosimError, match=said):
        conversion(unit_from, unit_to)


def test_columns_stand_as_in_the_file_whatever_they_are_called(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text(
        "when,x [kn],,note,on\n2022-10-27 08:00:00,1,7,a,true\n2022-10-27 08:00:01.5,,8,,false\n"
    )
    columns = read_columns(path)
    assert {name: column.unit for name, column in columns.items()} == {
        "when": "s",
        "x": "kn",
        "": "",
        "note": "",
        "on": "",
    }
    assert columns["when"][0].tolist() == [0.0, 1.5] and columns["on"][0].tolist() == [1.0, 0.0]
    assert columns["x"][0][0] == 1.0 and math.isnan(columns["x"][0][1])
    assert columns["note"][0].dtype == object and columns["note"][0][0] == "a"


def test_parquet_is_read_like_csv(table, tmp_path):
    import pyarrow.csv
    import pyarrow.parquet

    write_table(table, tmp_path / "t.csv")
    pyarrow.parquet.write_table(pyarrow.csv.read_csv(tmp_path / "t.csv"), tmp_path / "t.parquet")
    assert read_table(tmp_path / "t.parquet").identical(read_table(tmp_path / "t.csv"))
    assert read_columns(tmp_path / "t.parquet").keys() == read_columns(tmp_path / "t.csv").keys()


def test_a_column_that_is_there_twice_is_an_error(tmp_path):
    (tmp_path / "t.csv").write_text("time,x,x\n0,1,2\n")
    with pytest.raises(ShipcosimError, match="column 'x': is there twice"):
        read_columns(tmp_path / "t.csv")


def test_attributes_of_netcdf_that_are_no_utf8_become_texts_that_can_be_written(table, tmp_path):
    write_table(table, tmp_path / "t.nc")
    with h5py.File(tmp_path / "t.nc", "a") as file:
        file.attrs["description"] = b"20 \xb0C"
        file["vessel.x"].attrs["long_name"] = b"\xff"
    again = read_table(tmp_path / "t.nc")
    assert again.attrs["description"] == "20 \ufffdC"
    assert again["vessel.x"].attrs["long_name"] == "\ufffd"


def test_netcdf_whose_texts_are_blotted_out_is_refused_and_not_read_for_ever(table, tmp_path):
    # HDF5 goes round an object of no size in a heap, where neither a signal nor a test's own limit ends it.
    table.attrs["parameters"] = "p" * 5000
    write_table(table, tmp_path / "t.nc")
    whole = (tmp_path / "t.nc").read_bytes()
    heap = whole.index(b"GCOL")
    (tmp_path / "t.nc").write_bytes(whole[: heap + 16] + bytes(64) + whole[heap + 80 :])
    read = "import sys; from shipcosim.series import read_table; read_table(sys.argv[1])"
    command = [sys.executable, "-c", read, tmp_path / "t.nc"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert "t.nc: cannot be read: the heap" in ended.stderr


def test_netcdf_is_what_xarray_writes_and_reads(table, tmp_path):
    """The file is written by h5py for speed; a reader of NetCDF must see no difference."""
    table["logical"] = ("time", table["time"].values > 0.5, {"units": "1", "long_name": "a truth"})
    table["said"] = ("time", np.array(["no"] * table.sizes["time"]), {"units": "", "long_name": ""})
    write_table(table, tmp_path / "ours.nc")
    table.to_netcdf(tmp_path / "theirs.nc", engine="h5netcdf")
    with (
        xarray.open_dataset(tmp_path / "ours.nc", engine="h5netcdf") as ours,
        xarray.open_dataset(tmp_path / "theirs.nc", engine="h5netcdf") as theirs,
    ):
        xarray.testing.assert_identical(ours.load(), theirs.load())
        assert {n: v.dtype for n, v in ours.items()} == {n: v.dtype for n, v in theirs.items()}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
@pytest.mark.parametrize("ending", [".csv", ".csv.gz"])
def test_a_table_in_the_encodings_of_loggers_is_read(tmp_path, encoding, ending):
    content = "time [s],måling [°]\n0.0,1.5\n1.0,2.5\n".encode(encoding)
    path = tmp_path / f"t{ending}"
    path.write_bytes(gzip.compress(content) if ending == ".csv.gz" else content)
    table = read_table(path)
    assert table["måling"].values.tolist() == [1.5, 2.5] and table["måling"].attrs["units"] == "°"


@pytest.mark.parametrize("row", ["ms,deg,-", "[ms],(deg),", "ms;deg;-"])
def test_a_row_of_units_below_the_names_is_that(tmp_path, row):
    separator = ";" if ";" in row else ","
    lines = ["time,psi,flag", row, "0,1.5,0", "500,2.5,1"]
    text = "\n".join(line.replace(",", separator) for line in lines)
    (tmp_path / "t.csv").write_text(text, encoding="utf-8")
    table = read_table(tmp_path / "t.csv")
    assert table["time"].values.tolist() == [0.0, 0.5]
    assert [table[name].attrs["units"] for name in ("psi", "flag")] == ["deg", ""]


@pytest.mark.parametrize(
    ("above", "header"),
    [
        ("# by hand\n", "time [s],x [m]"),
        ("# by hand\n\n#, of May\n", "time [s];x [m]"),
        ("# by hand\n", "# time [s],x [m]"),
        ("#", "time [s],x [m]"),
        ("#1\r\n", "time [s],x [m]"),
    ],
)
def test_lines_with_a_sign_of_comments_above_the_header_are_left_out(tmp_path, above, header):
    rows = "0,1.5\n1,2.5\n".replace(",", ";" if ";" in header else ",")
    (tmp_path / "t.csv").write_text(f"{above}{header}\n{rows}", encoding="utf-8", newline="")
    table = read_table(tmp_path / "t.csv")
    assert table["x"].values.tolist() == [1.5, 2.5] and table["x"].attrs["units"] == "m"


@pytest.mark.parametrize("row", ["s,parsnip", "s,3.0", "s,m s"])
def test_a_row_of_other_texts_is_refused_as_such(tmp_path, row):
    (tmp_path / "t.csv").write_text(f"time,x\n{row}\n0,1\n1,2\n", encoding="utf-8")
    with pytest.raises(ShipcosimError, match="column 'time'.*holds texts"):
        read_table(tmp_path / "t.csv")


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("#YY MM WDIR WSPD\n2023 01 180 MM\n2023 02 182 MM\n", "first row: holds numbers where"),
        ('time,x\n0,1\n1,"2\n', "line 3: has a quotation mark without its other"),
        ('time,x\n0,"1"5\n', "line 2: has a quotation mark without its other"),
        (f"time,{'x' * 200_000}\n0,1\n", "line 1: .* or a cell of more than 131,072 characters"),
    ],
)
def test_a_table_that_cannot_be_told_into_columns_is_refused_in_one_sentence(tmp_path, text, found):
    path = tmp_path / "weather.csv"
    path.write_text(text)
    with pytest.raises(ShipcosimError, match=rf"weather\.csv, {found}") as refused:
        read_table(path)
    assert len(refused.value.problems) == 1


def test_netcdf_3_of_other_programs_is_read_and_a_damaged_one_refused(table, tmp_path):
    file = tmp_path / "t.nc"
    table.to_netcdf(file, format="NETCDF3_64BIT", engine="scipy")
    again = read_table(file)
    for name, column in table.variables.items():
        assert np.array_equal(again[name].values, column.values), name
        assert again[name].attrs["units"] == column.attrs["units"]
    assert list(read_columns(file)) == ["vessel.x", "port.failed", "weather.seed", "time"]
    for length in (4, 40, file.stat().st_size - 9):
        (tmp_path / "short.nc").write_bytes(file.read_bytes()[:length])
        with pytest.raises(ShipcosimError, match="short.nc: cannot be read"):
            read_table(tmp_path / "short.nc")


def test_netcdf_3_without_scipy_says_what_to_install(table, tmp_path, monkeypatch):
    table.to_netcdf(tmp_path / "t.nc", format="NETCDF3_64BIT", engine="scipy")
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(ShipcosimError, match=r"pip install 'shipcosim\[matlab\]'"):
        read_table(tmp_path / "t.nc")
