"""Inputs of another kind than damage: files made anew, well formed, whose types, sizes and nesting are not those meant.

NetCDF by h5py, stored states, OSP's scenarios in JSON, channel files and causes in TOML, references of a ship,
archives of which a member ends early.
"""

import io
import json
import random
import struct
import tempfile
import zipfile
from functools import cache
from pathlib import Path

import h5py
import numpy as np
from conformance.cases import cases, write
from conformance.fmus import build_folder
from fuzz.seeds import EVENTS, HEADER, ROWS, seeds, zipped

import shipcosim as sc

NUMBERS = (0, -1, 1, 2**31, 2**63, -(2**63) - 1, 10**400, 0.5, -0.0, 1e308, 1e-320)
NUMBERS += (float("inf"), float("-inf"), float("nan"))
OTHERS = (
    None,
    True,
    False,
    "",
    "x",
    "nan",
    "1e5",
    "\x00",
    "\ud800",
    "é" * 5000,
    [],
    {},
    [[]],
    [1, 2],
    {"": 0},
    {"x": {}},
)
NAMES = (
    "",
    "time",
    "x",
    "a.b",
    "\x00",
    "\u202e",
    "é" * 300,
    "__proto__",
    "../x",
    "ramp.y",
    "position_x",
    "heading",
)
ROWS_OF_TYPED = 50


def write_typed(number, folder, seed):
    """Write an input into an empty folder; path and how it was made."""
    rng = random.Random(f"{seed} {number}")
    kind = rng.choice(list(MAKERS))
    files, how = MAKERS[kind](rng)
    for name, data in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder / next(iter(files)), f"{kind}: {how}"


def odd(rng, depth=0):
    """A value of any type."""
    how = rng.random()
    if how < 0.45:
        return rng.choice(NUMBERS)
    if how < 0.8 or depth > 3:
        return rng.choice(OTHERS)
    if how < 0.9:
        return [odd(rng, depth + 1) for _ in range(rng.randrange(5))]
    return {rng.choice(NAMES): odd(rng, depth + 1) for _ in range(rng.randrange(4))}


def retyped(rng, value, share=0.1):
    """A structure of dicts, lists and values, some of them others."""
    if rng.random() < share:
        return odd(rng)
    if isinstance(value, dict):
        made = {
            key if rng.random() > share / 3 else rng.choice(NAMES): retyped(rng, v, share)
            for key, v in value.items()
        }
        if rng.random() < share and made:
            made.pop(rng.choice(list(made)))
        return made
    if isinstance(value, list):
        return [retyped(rng, one, share) for one in value] * rng.choice((1, 1, 1, 2, 0))
    return value


def nested(rng):
    """JSON nested deeper than any reader goes, or a very long number."""
    depth = rng.choice((50, 2000, 100_000))
    return rng.choice(
        (
            b"[" * depth,
            b'{"a":' * depth + b"1" + b"}" * depth,
            b"[" * depth + b"]" * depth,
            b"9" * depth,
        )
    )


def _json(rng, value, share=0.1):
    return json.dumps(retyped(rng, value, share)).encode("utf-8", "surrogatepass")


def _scenario(rng):
    name, files = seeds()["osp"][0]
    how, data = (
        ("nested", nested(rng))
        if rng.random() < 0.2
        else ("retyped", _json(rng, json.loads(EVENTS)))
    )
    files = {file: content for file, content in files.items() if file != "events.json"}
    return {"events.json": data, **files}, how


@cache
def running():
    """Path of a small system, of which states are stored; and the files of one state."""
    folder = Path(tempfile.mkdtemp(dir=build_folder()))
    path = write(cases()["connection"], folder)
    sc.simulate(sc.read(path), stop_time=1.0, step_size=0.25, store=folder / "sound.state")
    with zipfile.ZipFile(folder / "sound.state") as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    return path, files


def _snapshot(rng):
    _, files = running()
    files = dict(files)
    facts = json.loads(files["snapshot.json"])
    files["snapshot.json"] = (
        nested(rng) if rng.random() < 0.1 else _json(rng, facts, rng.choice((0.0, 0.02, 0.1)))
    )
    if rng.random() < 0.3:
        files[rng.choice(list(files)[1:])] = rng.choice(
            (b"", b"\x80\x04.", b"x" * 1000, b"{}", b"[]", b'{"x": 1e999}')
        )
    if rng.random() < 0.1:
        files.pop(rng.choice(list(files)))
    data = zipped(files)
    return {"run.state": _cut_member(rng, data) if rng.random() < 0.3 else data}, "stored state"


def _cut_member(rng, data):
    """An archive whose directory is whole and of which the data of members is not."""
    changed = bytearray(data)
    at = changed.find(b"PK\x01\x02")
    for _ in range(rng.choice((1, 5, 50))):
        changed[rng.randrange(30, max(at, 31))] = rng.randrange(256)
    if rng.random() < 0.5:
        struct.pack_into(
            "<I", changed, at + rng.choice((20, 24, 42)), rng.choice((0, 2**31, 2**32 - 1))
        )
    return bytes(changed)


def _archive(rng):
    name, files = rng.choice(seeds()["ssp"])
    return {name: _cut_member(rng, zipped(files))}, "members cut"


TYPES = ("f8", "f4", "i8", "u1", "b1", "S4", "c16", ">f8", "i2", "V8", "U0", "O")


def _netcdf(rng):
    data = io.BytesIO()
    with h5py.File(data, "w") as file:
        for name in ["time", *rng.sample([*NAMES[2:], "north", "east", "surge"], 3)]:
            try:
                _variable(rng, file, name)
            except (ValueError, TypeError, RuntimeError, OSError, KeyError):
                pass  # h5py itself refuses it
    content = data.getvalue()
    if rng.random() < 0.3:
        changed = bytearray(content)
        for _ in range(rng.choice((1, 10, 100))):
            changed[rng.randrange(len(changed))] = rng.randrange(256)
        content = bytes(changed[: rng.choice((len(changed), rng.randrange(len(changed))))])
    return {"result.nc": content}, "NetCDF"


def _variable(rng, file, name):
    """A data set of some type and size; declared sizes need no room."""
    how, n = rng.random(), rng.choice((0, 1, 50, 50, 50))
    if how < 0.15:
        shape = rng.choice(((2**40,), (2**20, 2**20), (2**62,), (2**33, 1)))
        made = file.create_dataset(name, shape, "f8", chunks=tuple(min(size, 64) for size in shape))
    elif how < 0.3:
        made = file.create_dataset(name, data=np.array([b"word"] * n, "S8"))
    elif how < 0.4:
        made = file.create_group(name)
    elif how < 0.5:
        made = file.create_dataset(name, data=odd_numbers(rng, n), maxshape=(None,), chunks=(8,))
    elif how < 0.6:
        text = h5py.string_dtype()
        made = file.create_dataset(
            name, data=np.array(["a", "\u00e9"] * n, dtype=object), dtype=text
        )
    else:
        type_ = rng.choice(TYPES) if rng.random() < 0.4 else "f8"
        values = np.arange(n, dtype="f8") if rng.random() < 0.6 else odd_numbers(rng, n)
        with np.errstate(all="ignore"):
            made = file.create_dataset(
                name, data=values.astype(type_) if type_ not in ("V8", "O") else values
            )
    if rng.random() < 0.6 and isinstance(made, h5py.Dataset):
        made.make_scale(rng.choice((name, "time", "")))
    if (
        isinstance(made, h5py.Dataset)
        and name != "time"
        and rng.random() < 0.7
        and _is_scale(file.get("time"))
    ):
        made.dims[0].attach_scale(file["time"])
    for key in (
        "units",
        "_FillValue",
        "scale_factor",
        "missing_value",
        "_Netcdf4Dimid",
        "coordinates",
    ):
        if rng.random() < 0.15:
            made.attrs[key] = rng.choice(
                (b"\xff", "s", "furlongs", 1e400, 0, np.arange(5), "time", "days since x", [""])
            )


def _is_scale(made):
    """Whether something is a scale of a dimension; h5py dies of attaching anything else."""
    return isinstance(made, h5py.Dataset) and made.is_scale


def odd_numbers(rng, n):
    """(n,) array of times or of what is none."""
    values = np.arange(n, dtype="f8")
    for _ in range(rng.randrange(5)):
        if n:
            values[rng.randrange(n)] = rng.choice(
                (np.nan, np.inf, -np.inf, 1e308, -1e308, 0.0, 5e-324)
            )
    return values


LOG = "\n".join([HEADER, *ROWS[:ROWS_OF_TYPED]]).encode()
CHANNELS = {
    "time": {"column": "time", "unit": "s"},
    "position_north": {"column": "north", "unit": "m"},
    "position_east": {"column": "east", "unit": "m"},
    "heading": {"column": "heading", "unit": "deg"},
    "surge": {"column": "surge", "unit": "m/s", "factor": 1.0, "offset": 0.0},
}


def _toml(value):
    """A value as TOML, or as what is none where TOML has no such thing."""
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{json.dumps(str(key))} = {_toml(one)}" for key, one in value.items())
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value)
    return (
        {None: "none"}.get(value, str(value).lower())
        if not isinstance(value, float)
        else repr(value)
    )


def _channels(rng):
    table = retyped(rng, CHANNELS, 0.15)
    tables = table.items() if isinstance(table, dict) else [("x", table)]
    text = "".join(f"{json.dumps(str(key))} = {_toml(value)}\n" for key, value in tables)
    return {"log.csv": LOG, "channels.toml": text.encode("utf-8", "surrogatepass")}, "channels"


def _log(rng):
    """A table whose cells are numbers of odd sizes, times that stand, turn or leap."""
    rows = [line.split(",") for line in LOG.decode().split("\n")]
    at, how = rng.randrange(len(rows[0])), rng.randrange(6)
    for i, row in enumerate(rows[1:]):
        if how == 0:
            row[at] = repr(rng.choice(NUMBERS))
        elif how == 1:
            row[0] = repr(rng.choice((1e300, -1e300, 0.0)) * i)
        elif how == 2:
            row[at] = "1" * rng.choice((1, 400, 5000))
        elif how == 3 and i > rng.randrange(50):
            row[:] = row[: rng.randrange(len(row) + 1)]
        elif how == 4:
            row[at] = rng.choice(("", "NaN", "-", "1,5", '"', "'", "\x00", "=1+1"))
        else:
            row[0] = "2022-13-45T99:99:99" if i % 7 else "2022-10-27T08:00:00Z"
    return {"log.csv": "\n".join(map(",".join, rows)).encode()}, "cells"


REFERENCE = {
    "schema": "shipcosim-reference/1",
    "shipcosim": "0.1.0",
    "system": "gunnerus_open",
    "system_sha256": "0" * 64,
    "tolerance_scale": 1.0,
    "form_scale": 1.0,
    "logs": [],
    "ordinary_errors": {"heading": 1.0},
    "dispersion": 1.0,
    "numbers": [],
    "correlation": [],
}


def _reference(rng):
    data = (
        nested(rng) if rng.random() < 0.3 else _json(rng, REFERENCE, rng.choice((0.02, 0.1, 0.3)))
    )
    return {"x.reference": data}, "reference"


MAKERS = {
    "netcdf": _netcdf,
    "snapshot": _snapshot,
    "json": _scenario,
    "channels": _channels,
    "log": _log,
    "archive": _archive,
    "reference": _reference,
    "netcdf again": _netcdf,
    "snapshot again": _snapshot,
}
