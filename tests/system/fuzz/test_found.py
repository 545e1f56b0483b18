"""What fuzzing has found, each as the smallest file that did it."""

import gc
import json
import random
import shutil
import struct
import sys
import time
import warnings
from contextlib import suppress

import h5py
import numpy as np
import pytest
from fuzz.damage_xml import many
from fuzz.endless import HEAD, TAIL, endless_connections, endless_systems
from fuzz.seeds import seeds, zipped
from fuzz.typed import running

from shipcosim.checks import check_any
from shipcosim.diagnose.log.reader import columns_of, read_log
from shipcosim.diagnose.log.runs import run_as_log
from shipcosim.errors import MOST_SHOWN, Problem, ShipcosimError, reading
from shipcosim.series import read_table
from shipcosim.snapshot import read_snapshot


def checked(folder, files):
    """What is found in the first of some files, and the processor's time that it takes. [s]"""
    for name, data in files.items():
        (folder / name).write_bytes(data)
    start = time.process_time()
    problems = check_any(str(folder / next(iter(files))))
    return "\n".join(map(str, problems)), time.process_time() - start


class Chosen(random.Random):
    """A generator that gives what it was told, in order."""

    def __init__(self, *values):
        super().__init__(0)
        self.values = list(values)

    def choice(self, among):
        return self.values.pop(0)

    def random(self):
        return self.values.pop(0)


@pytest.mark.parametrize(
    ("last", "said"),
    [
        ("SystemStructure.ssd", "contains itself"),
        ("missing.ssd", "more than 10000 systems"),
        (None, "more than 10000 systems"),
    ],
)
def test_thirty_files_that_each_contain_the_next_one_twice(tmp_path, last, said):
    found, took = checked(tmp_path, endless_systems(Chosen(30, last)))
    assert said in found and took < 10.0


@pytest.mark.parametrize("kind", ["parameter", "input", "inout"])
@pytest.mark.parametrize("circle", [0.0, 1.0])
def test_four_hundred_systems_whose_connectors_fork_and_join(tmp_path, kind, circle):
    found, took = checked(tmp_path, endless_connections(Chosen(400, circle, kind)))
    assert found and took < 10.0


def test_a_set_bound_five_thousand_times(tmp_path):
    name, files = next(
        (n, f) for n, f in seeds()["ssp"] if b"ParameterBinding" in f["SystemStructure.ssd"]
    )
    rng = random.Random(3)
    data = max(
        (many(rng, files["SystemStructure.ssd"]) for _ in range(40)),
        key=lambda d: d.count(b"ParameterBinding "),
    )
    assert data.count(b"ParameterBinding ") >= 1000
    _, took = checked(tmp_path, {name: zipped(files | {"SystemStructure.ssd": data})})
    assert took < 10.0


def test_a_mapping_of_enumerations_without_a_source(tmp_path):
    files = next(f for _, f in seeds()["ssp"] if b"EnumerationMapping" in f["SystemStructure.ssd"])
    for version in ("1.0", "2.0"):
        data = files["SystemStructure.ssd"].replace(b'source="off" ', b"")
        data = data.replace(
            b'Description version="1.0"', f'Description version="{version}"'.encode()
        )
        found, _ = checked(tmp_path, {"system.ssp": zipped(files | {"SystemStructure.ssd": data})})
        assert "The attribute 'source' is required but missing. Add it." in found


@pytest.mark.parametrize(("field", "value"), [(42, 0xFFFFFFF0), (24, 0x7FFFFFFF), (20, 0xFFFFFFF0)])
def test_an_archive_whose_directory_states_absurd_places_and_sizes(tmp_path, field, value):
    data = bytearray(seeds()["fmu"][0][1])
    struct.pack_into("<I", data, data.rfind(b"PK\x01\x02") + field, value)
    found, _ = checked(tmp_path, {"ramp.fmu": bytes(data)})
    assert "archive" in found or found == ""


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
def test_a_log_of_few_rows(tmp_path, rows):
    text = "time,north,east,heading\n" + "".join(f"{i},0.0,0.0,{359 - i}\n" for i in range(rows))
    found, _ = checked(tmp_path, {"log.csv": text.encode()})
    assert ("fewer than two" in found or "no row" in found or "empty" in found.lower()) == (
        rows < 2
    ), found


def test_a_log_whose_clock_jumps_to_the_end_of_time(tmp_path):
    text = "time,north,east,heading\n" + "".join(
        f"{t},0.0,0.0,0\n" for t in (0, 1, 2, 3, 1e12, 5, -1e12)
    )
    found, _ = checked(tmp_path, {"log.csv": text.encode()})
    assert "time: is 1e+12 s in row 6: is the unit right? Times are at most 2.6e+11 s" in found


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("deep.toml", "x = " + "[" * 9000, "nested too deep"),
        ("long.toml", "a." * 50_000 + "b = 1", "more than 1000 parts"),
        ("dots.toml", "[" + "a . " * 9000 + "b]", "more than 1000 parts"),
        ("quoted.toml", "x = {" + "'a'.\"b\"." * 9000 + "b = 1}", "more than 1000 parts"),
        ("kilo.toml", ("a" + ".a" * 999 + "\n") * 1000, "Expected '='"),
        ("digits.toml", "stop_time = " + "9" * 5000, "thousands of digits"),
        ("bits.toml", "stop_time = 0x" + "f" * 5000, "more than 64 bits"),
        ("deep.json", '{"events": ' + "[" * 100_000, "recursion"),
        ("deep.yaml", "events: " + "[" * 20_000, "nested deeper than 100"),
        ("large.yaml", "events: " + "b" * 2_000_000, "too large"),
    ],
)
def test_texts_that_a_reader_does_not_come_to_an_end_with(tmp_path, name, text, said):
    found, took = checked(tmp_path, {name: text.encode()})
    assert said in found and took < 10.0


def test_a_table_of_very_many_columns(tmp_path):
    head = "time,north,east," + ",".join(f"c{i}" for i in range(10_000))
    found, took = checked(
        tmp_path, {"log.csv": "\n".join([head, *[",".join(["1"] * 10_003)] * 3]).encode()}
    )
    assert "fewer than two different times" in found and took < 10.0


def test_names_without_end_are_told_in_short(tmp_path):
    element = (
        f'<ssd:Elements><ssd:Component name="{"x" * 1_000_000}" source="y.fmu"/></ssd:Elements>'
    )
    found, took = checked(tmp_path, {"SystemStructure.ssd": (HEAD + element + TAIL).encode()})
    assert "does not exist" in found and len(found) < 20_000 and took < 10.0


def test_of_very_many_problems_the_first_are_told_and_the_number_of_the_others():
    problems = [Problem("x", str(i)) for i in range(10_000)]
    error = ShipcosimError(problems)
    assert len(error.problems) == 10_000
    assert (
        str(error).splitlines()[-1] == f"And {10_000 - MOST_SHOWN} more."
        and str(error).count("\n") == MOST_SHOWN
    )


def test_a_netcdf_file_of_a_few_kilobytes_that_declares_eight_tebibytes(tmp_path):
    with h5py.File(tmp_path / "x.nc", "w") as file:
        file.create_dataset("time", (2**40,), "f8", chunks=(64,)).make_scale("time")
    found, took = checked(tmp_path, {"x.nc": (tmp_path / "x.nc").read_bytes()})
    assert "it declares 8.19e+03 GiB" in found and took < 10.0


def test_a_netcdf_file_whose_fill_value_is_a_text(tmp_path):
    with h5py.File(tmp_path / "x.nc", "w") as file:
        made = file.create_dataset("time", data=[0.0, 1.0])
        made.make_scale("time")
        made.attrs["scale_factor"] = "furlongs"
    found, _ = checked(tmp_path, {"x.nc": (tmp_path / "x.nc").read_bytes()})
    assert "x.nc: cannot be read: " in found


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("outputs", {"ramp.y": {}}, "values that no signal has"),
        ("inputs", {"gain.u": float("inf")}, "values that no signal has"),
        ("outputs", {"ramp.y": 10**400}, "values that no signal has"),
        ("components", ["ramp"], "others than those whose FMUs it names"),
        ("step_size", float("nan"), "its times are none of a run"),
    ],
)
def test_a_stored_state_with_a_value_of_another_kind(name, value, said, tmp_path):
    _, files = running()
    facts = json.loads(files["snapshot.json"]) | {name: value}
    (tmp_path / "x.state").write_bytes(
        zipped(files | {"snapshot.json": json.dumps(facts).encode()})
    )
    with pytest.raises(ShipcosimError, match=said):
        read_snapshot(tmp_path / "x.state")


def test_a_stored_state_nested_a_hundred_thousand_levels_deep(tmp_path):
    _, files = running()
    (tmp_path / "x.state").write_bytes(zipped(files | {"snapshot.json": b"[" * 100_000}))
    with pytest.raises(ShipcosimError, match="is no snapshot of a run"):
        read_snapshot(tmp_path / "x.state")


def test_messages_of_nmea_2000_whose_fields_are_of_any_type_are_left_out(tmp_path):
    message = {"timestamp": "2022-10-27T08:00:00", "pgn": 127250, "src": 1, "fields": {}}
    lines = [{**message, "timestamp": f"2022-10-27T08:00:{k:02d}"} for k in range(60)]
    for k, line in enumerate(lines):
        line["fields"] = {"Heading": float(k), "Reference": "True"}
    lines[7] = {**message, "pgn": {}}
    lines[8] = {**message, "pgn": 129025, "fields": 1.5}
    lines[9] = {**message, "fields": {"Heading": 10**400}}
    lines[10] = {**message, "src": []}
    (tmp_path / "log.jsonl").write_text("\n".join(map(json.dumps, lines)))
    columns = columns_of(tmp_path / "log.jsonl")
    assert columns.remarks[-1].endswith("4 lines that are no message left out.")
    assert len(columns.values["time"]) == 56


def test_sensors_that_each_write_one_row_at_one_time_are_no_log(tmp_path):
    (tmp_path / "x.csv").write_bytes(b"time,north,east,heading\n0,1,,\n0,,2,\n1,,,3\n")
    assert read_log(tmp_path / "x.csv").sizes["time"] == 3
    found, _ = checked(tmp_path, {"x.csv": b"time,north,east,heading\n0,1,,\n0,,2,\n0,,,3\n"})
    assert "fewer than two different times" in found


def test_a_netcdf_file_whose_root_is_damaged_is_refused_without_a_traceback(tmp_path, monkeypatch):
    with h5py.File(tmp_path / "x.nc", "w", track_order=True) as file:
        file.create_dataset("time", data=np.arange(9.0)).make_scale("time")
        file["vessel.psi"] = np.zeros(9)
    ignored = []
    monkeypatch.setattr(sys, "unraisablehook", ignored.append)
    sound = (tmp_path / "x.nc").read_bytes()
    # The first object in the file is the root; every byte of it is damaged in turn.
    start = sound.index(b"OHDR")
    for place in range(start, start + 60):
        damaged = bytearray(sound)
        damaged[place] ^= 0xFF
        (tmp_path / "x.nc").write_bytes(damaged)
        for read in (read_log, read_table, lambda path: run_as_log(path, "vessel", ())):
            with suppress(ShipcosimError):
                read(tmp_path / "x.nc")
    gc.collect()
    assert not ignored


def test_a_log_of_one_complete_row_and_one_without_a_longitude_are_read(tmp_path):
    header = b"time,north,east,heading,surge,sway,yaw_rate\n"
    found, _ = checked(tmp_path, {"x.csv": header + b"0,1,1,1,1,1,1\n1,,,,2,,\n2,,3,,,,\n"})
    assert "x.csv" in found and "cannot be read" not in found
    # A longitude in a unit of something else is not used.
    header = b"time [s],latitude [deg],longitude [kg],heading [deg]\n"
    found, _ = checked(tmp_path, {"y.csv": header + b"0,63,10,1\n1,63,10,2\n2,63,10,3\n"})
    assert "'longitude' is not used" in found


def test_what_a_library_warns_of_while_it_reads_is_not_shown(tmp_path):
    with warnings.catch_warnings(record=True) as caught, reading(tmp_path / "x.nc"):
        warnings.warn("phony dimensions", UserWarning, stacklevel=1)
    assert not caught


TABLE = "time [s],north [m],east [m],heading [deg],surge [m/s]\n0,0,0,0,1\n1,1,0,0,1\n2,2,0,0,1\n"


@pytest.mark.parametrize(
    "encoding", [f"utf-{bits}-{order}" for bits in (16, 32) for order in ("le", "be")]
)
def test_unicode_without_a_byte_order_mark_is_read(tmp_path, encoding):
    found, _ = checked(tmp_path, {"x.csv": TABLE.encode(encoding)})
    assert f"Read as {encoding}" in found and "cannot" not in found
    assert read_table(tmp_path / "x.csv").sizes["time"] == 3


@pytest.mark.parametrize("name", ["x.json", "x.yaml"])
def test_a_table_under_the_name_of_a_scenario_of_osp_is_a_log(tmp_path, name):
    assert checked(tmp_path, {name: TABLE.encode()})[0] == ""
    found, _ = checked(tmp_path, {name: b'{"events": '})
    assert "cannot be read as" in found


def test_a_ship_with_a_negative_mass_is_refused(root, tmp_path):
    shutil.copytree(root / "ssp/ships/kvlcc2", tmp_path / "ship")
    file = tmp_path / "ship/ship.toml"
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("{ value = 2486.0", "{ value = -1e10"), encoding="utf-8")
    assert "the mass matrix is not positive" in "\n".join(map(str, check_any(str(file))))
