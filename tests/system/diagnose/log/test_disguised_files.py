"""A log is read by its content, whatever its file is called, in whichever encoding it is, and whatever is damaged in it."""

import gzip
import io
import json

import numpy as np
import openpyxl
import pandas
import pytest

from shipcosim.diagnose.log.files.positions import degrees_of_texts
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.errors import ShipcosimError
from shipcosim.series import read_table

HEAD = ["time [s]", "heading [deg]", "north [m]", "east [m]"]
ROWS = [[0.5 * k, 10.0 + 0.1 * k, 0.9 * k, 0.2 * k] for k in range(120)]
TEXT = "\n".join([",".join(HEAD), *(",".join(f"{cell:.4f}" for cell in row) for row in ROWS)])
RECORDS = [dict(zip(["time", "heading", "north", "east"], row, strict=True)) for row in ROWS]


def workbook():
    book = openpyxl.Workbook()
    for row in [HEAD, *ROWS]:
        book.active.append(row)
    written = io.BytesIO()
    book.save(written)
    return written.getvalue()


def parquet():
    written = io.BytesIO()
    pandas.DataFrame(ROWS, columns=HEAD).to_parquet(written)
    return written.getvalue()


CONTENTS = {
    "text": TEXT.encode(),
    "gzip": gzip.compress(TEXT.encode()),
    "workbook": workbook(),
    "parquet": parquet(),
    "records": json.dumps(RECORDS).encode(),
    "lines of JSON": "\n".join(map(json.dumps, RECORDS)).encode(),
    "columns of JSON": pandas.DataFrame(RECORDS).to_json().encode(),
    "UTF-8 with mark": TEXT.encode("utf-8-sig"),
    "UTF-16": TEXT.encode("utf-16"),
    "UTF-16 without mark": TEXT.encode("utf-16-le"),
    "UTF-16, the other order": TEXT.encode("utf-16-be"),
    "UTF-32": TEXT.encode("utf-32"),
    "zero bytes before": bytes(600) + TEXT.encode(),
    "zero bytes behind": TEXT.encode() + bytes(600),
}
NAMES = ["log.csv", "log.txt", "LOG.CSV", "log.dat", "log.json", "log.xlsx", "log.xls", "log.nc"]


@pytest.mark.parametrize("name", [*NAMES, "log.parquet", "log.mat", "log"])
@pytest.mark.parametrize("kind", CONTENTS)
def test_the_content_says_what_a_file_is(tmp_path, kind, name):
    (tmp_path / name).write_bytes(CONTENTS[kind])
    try:
        log = read_log(tmp_path / name)
    except ShipcosimError:
        # A name of another program is believed where the content is no plain text.
        assert name.endswith((".xlsx", ".xls", ".nc", ".mat", ".parquet"))
        assert kind not in ("text", "parquet", "records", "lines of JSON")
        return
    assert log["time"].values == pytest.approx([row[0] for row in ROWS])
    assert log["heading"].values == pytest.approx([row[1] for row in ROWS])


@pytest.mark.parametrize("kind", ["text", "gzip", "parquet", "UTF-16", "UTF-16 without mark"])
@pytest.mark.parametrize("name", ["in.csv", "IN.CSV"])
def test_tables_of_inputs_are_read_by_their_content_too(tmp_path, kind, name):
    (tmp_path / name).write_bytes(CONTENTS[kind])
    assert read_table(tmp_path / name)["heading"].values[-1] == pytest.approx(ROWS[-1][1])


@pytest.mark.parametrize("head", ["# time,u\n# s,deg\n", "# made by hand\n# time,u\n# [s],[deg]\n"])
def test_units_below_the_names_are_read_behind_hash_signs_too(tmp_path, head):
    (tmp_path / "in.csv").write_text(head + "0,1\n1,2\n", encoding="utf-8")
    assert read_table(tmp_path / "in.csv")["u"].attrs["units"] == "deg"


def test_blanks_separate_a_table_of_inputs(tmp_path):
    (tmp_path / "in.csv").write_text("time  u\n0.0  1\n1.0  2.5\n", encoding="utf-8")
    assert read_table(tmp_path / "in.csv")["u"].values.tolist() == [1.0, 2.5]


@pytest.mark.parametrize("row", [1, 2, 60, 119])
@pytest.mark.parametrize("cells", [2, 6])
def test_a_row_of_another_length_is_left_out_or_refused_wherever_it_stands(tmp_path, row, cells):
    lines = TEXT.splitlines()
    lines[row] = ",".join(["1.5"] * cells)
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    log = read_log(tmp_path / "log.csv")
    assert len(log["time"]) == len(ROWS) - 1
    assert "1 row without 4 cells left out" in " ".join(log.attrs["column_remarks"])


@pytest.mark.parametrize(
    ("side", "sign"), [("E", 1), ("Ø", 1), ("Ö", 1), ("W", -1), ("V", -1), ("w", -1)]
)
def test_sides_of_longitudes_in_other_languages(side, sign):
    cells = np.array([f"10°24,0015'{side}"], object)
    found = degrees_of_texts(cells, 180.0)
    assert found is not None and found[0] == pytest.approx(sign * (10.0 + 24.0015 / 60.0))


def test_a_side_that_is_east_in_one_language_and_west_in_another_is_none():
    assert degrees_of_texts(np.array(["10°24,0015'O"], object), 180.0) is None


NDBC = "#YY  MM DD hh mm WDIR WSPD ATMP\n#yr  mo dy hr mn degT m/s  degC\n"


@pytest.mark.parametrize(
    "head",
    [
        NDBC,
        NDBC.replace("#", ""),
        NDBC.replace("#YY", "#yyyy"),
        NDBC.replace("MM DD hh mm", "mm dd hh mm"),
    ],
)
def test_times_in_columns_for_year_to_minute_and_units_below_them(tmp_path, head):
    rows = [f"2024 02 29 {23 - 23 * (k > 5)} {10 * (k % 6)} 200 8.{k} 7.0" for k in range(6)]
    rows += [f"2024 03 01 00 {10 * k} 201 7.{k} 7.5" for k in range(6)]
    (tmp_path / "log.txt").write_text(head + "\n".join(rows), encoding="utf-8")
    columns = columns_of(tmp_path / "log.txt")
    assert np.diff(columns.values["time"]) == pytest.approx(600.0)
    assert columns.values["time"][0] == pytest.approx(1709247600.0)
    assert (columns.units["WDIR"], columns.units["WSPD"]) == ("degT", "m/s")


@pytest.mark.parametrize(
    ("before", "after", "hours"),
    [("CEST", "CET", 1), ("+02:00", "+01:00", 1), ("BST", "UTC", 1), ("JST", "JST", 0)],
)
def test_zones_may_change_within_a_log_by_name_or_number(tmp_path, before, after, hours):
    clock = [3600 + 30 * k - (3600 * hours if k >= 60 else 0) for k in range(120)]
    stamps = [
        f"2024-10-27T{s // 3600:02}:{s // 60 % 60:02}:{s % 60:02} {before if k < 60 else after}"
        for k, s in enumerate(clock)
    ]
    rows = [f"{stamp},{k / 10},0,{k}" for k, stamp in enumerate(stamps)]
    text = "\n".join(["time,heading [deg],north [m],east [m]", *rows])
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    time = read_log(tmp_path / "log.csv")["time"].values
    assert time - time[0] == pytest.approx(30.0 * np.arange(120))


def test_a_far_cell_of_a_workbook_costs_no_memory(tmp_path):
    book = openpyxl.load_workbook(io.BytesIO(CONTENTS["workbook"]))
    book.active.cell(1_048_576, 16_384).value = 1
    book.save(tmp_path / "log.xlsx")
    times = read_log(tmp_path / "log.xlsx")["time"].values
    assert (
        times[: len(ROWS)] == pytest.approx([row[0] for row in ROWS])
        and len(times) <= len(ROWS) + 1
    )


def test_a_stamp_that_stands_for_no_time_is_not_wrapped_into_another_century(tmp_path):
    table = pandas.DataFrame(ROWS, columns=HEAD).drop(columns="time [s]")
    stamps = np.datetime64("2024-03-30", "us") + np.arange(len(ROWS)).astype("timedelta64[s]")
    stamps[40] = np.datetime64("9999-12-31", "us")
    pandas.concat([pandas.Series(stamps, name="time"), table], axis=1).to_parquet(
        tmp_path / "log.parquet"
    )
    times = read_table(tmp_path / "log.parquet")["time"].values
    assert times[40] > 2e11 and times[41] == pytest.approx(41.0)
