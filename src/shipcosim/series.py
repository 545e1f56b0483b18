"""Tables: every run and every measurement is one `xarray.Dataset` over `time` in seconds, signals with unit and name.

The only door to pyarrow, which is needed for Parquet alone. xarray and pandas are imported where they are used: they
take most of a second, which a command that only prints its help should not pay.
"""

from __future__ import annotations

import csv
import errno
import gzip
import io
import json
import os
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.util import find_spec
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import quote

import numpy as np

from shipcosim.dialects import (
    cells_in,
    decimal_of,
    header_of,
    is_figure,
    is_text,
    name_in,
    seconds_of_spans,
    separator_of,
    unicode_of,
)
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors, reading, shortened
from shipcosim.temporary import replacement
from shipcosim.units import UnitError, spelled_conversion, spelled_unit

if TYPE_CHECKING:
    import h5py
    import xarray


_NOTHING = {
    "",
    "#n/a",
    "#na",
    "-nan",
    "n/a",
    "na",
    "nan",
    "none",
    "null",
}  # in lower case: cells without a value
LARGEST_TABLE = 8 << 30
"""Most bytes that a table is read with: a file can declare more than any memory holds."""

SMALL = 64 << 20
MOST_PACKED = 100
"""A packed file may unpack to so many bytes, or to so many times its size."""

OWN_NAME = "own_name"
"""Attribute of a variable whose name NetCDF cannot have."""
HEAP = b"GCOL\1\0\0\0"
"""Signature and version of a global heap of HDF5."""

_NO_TEXT = re.compile("[\0\ud800-\udfff]")
"""Signs that neither HDF5 nor UTF-8 can hold."""

_HEADER = re.compile(r"^(?P<name>.*)\s\[(?P<unit>.*)\]\s*$", re.DOTALL)


def make_table(
    time: np.ndarray,
    columns: Iterable[tuple[str, np.ndarray, str, str]],
    attributes: dict | None = None,
) -> xarray.Dataset:
    """One table from its columns.

    Parameters
    ----------
    time : (n,) array
        Times of the rows. [s]
    columns : iterable of (name, (n,) array, unit, long name)
        The signals.
    attributes : dict, optional
        What holds for the table as a whole: versions, parameters, seeds.
    """
    import pandas
    import xarray

    columns = list(columns)
    raise_errors(
        [
            Problem(n, f"has {len(v)} rows, time has {len(time)}.")
            for n, v, *_ in columns
            if len(v) != len(time)
        ]
    )
    variables = {
        name: ("time", values, {"units": unit, "long_name": long_name})
        for name, values, unit, long_name in columns
    }
    # As an index of pandas: to look at an array xarray imports pint, which takes 0.3 s.
    clock = ("time", pandas.Index(time), {"units": "s", "long_name": "time"})
    return xarray.Dataset(variables, {"time": clock}, attributes or {})


def write_table(table: xarray.Dataset, path: str | os.PathLike) -> None:
    """Write a table as NetCDF (.nc) or CSV (.csv), at full precision.

    Equal tables give equal bytes. Either the whole file is there afterwards or none under this name.

    Parameters
    ----------
    table : xarray.Dataset
        With the coordinate `time`.
    path : path
        The file; its ending says the format.

    Raises
    ------
    ShipcosimError
        If the ending is another one, or the file cannot be written (a full disk, no such folder).
    """
    writers = {".nc": _netcdf, ".csv": _csv}
    path = Path(path)
    if path.suffix not in writers:
        raise error_at(
            str(path), f"a table cannot be written as '{path.suffix}'.", "Use .nc or .csv."
        )
    if no_text := [str(name) for name in table.variables if _NO_TEXT.search(str(name))]:
        message = f"no file can hold the name {ascii(no_text[0])}: it has a zero byte or half a character."
        raise error_at(str(path), message, "Rename the signal.")
    write_file(path, writers[path.suffix](table))


def read_table(path: str | os.PathLike) -> xarray.Dataset:
    """Read a table from NetCDF (.nc), CSV (.csv, .csv.gz; header `name [unit]`) or Parquet (.parquet, headers alike).

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    xarray.Dataset
        Over the coordinate `time` in seconds.

    Raises
    ------
    ShipcosimError
        If the file cannot be read, has no `time`, or a column is not numeric.
    """
    readers = {
        ".nc": _read_netcdf,
        ".csv": _read_rows,
        ".csv.gz": _read_rows,
        ".parquet": _read_rows,
    }
    with reading(path):
        table = readers[_suffix(path, readers)](Path(path))
    table.encoding["source"] = str(path)
    return table


class TableColumn(NamedTuple):
    """Values and unit of a column as they stand in a file, and what NetCDF says of it besides its name."""

    values: np.ndarray
    unit: str
    title: str = ""


def read_columns(path: str | os.PathLike) -> dict[str, TableColumn]:
    """Columns of any table of measurements, as they stand in the file.

    Numbers become float64, missing ones NaN, stamps of date and time seconds after the first; a column of texts stays
    one of texts. Nothing is left out and nothing is asked of the names.

    Parameters
    ----------
    path : path
        NetCDF, CSV or Parquet.

    Returns
    -------
    dict of str to TableColumn
        By the column's name.

    Raises
    ------
    ShipcosimError
        If the file cannot be read or has a column twice.
    """
    path = Path(path)
    with reading(path):
        suffix = _suffix(path, (".nc", ".csv", ".csv.gz", ".parquet"))
        if suffix == ".nc":
            columns = _netcdf_columns(_open_netcdf(path))
            return {name: column for name, column in columns.items() if len(column.values)}
        columns = _read_columns(path)
    problems = _repeated(path, [name for name, _, _ in columns])
    raise_errors(problems)
    return {name: TableColumn(values, unit) for name, unit, values in columns}


def ending_of(path: Path) -> str:
    """Ending that suits the content of a file: Parquet is Parquet and text is CSV, whatever they are called."""
    with path.open("rb") as file:
        head = file.read(8)
    if head.startswith(b"PAR1"):
        return ".parquet"
    ending = "".join(re.findall(r"(?:\.csv)?\.\w+$", path.name.lower()))
    return ".csv" if is_text(head) and ending in (".nc", ".parquet") else ending


def _suffix(path: str | os.PathLike, suffixes: Iterable[str]) -> str:
    path = Path(path)
    if path.is_dir():
        raise error_at(str(path), "is a folder, no table.", f"Tables are {', '.join(suffixes)}.")
    suffix = ending_of(path) if path.is_file() else path.suffix
    if suffix not in suffixes:
        raise error_at(
            str(path),
            f"'{path.suffix or path.name}' is no table.",
            f"Tables are {', '.join(suffixes)}.",
        )
    if not path.is_file():
        raise error_at(str(path), "there is no such file.")
    return suffix


def write_file(path: str | os.PathLike, content: bytes) -> None:
    """Write a file completely or not at all.

    Parameters
    ----------
    path : path
        The file; its folder must be there.
    content : bytes
        What it holds.

    Raises
    ------
    ShipcosimError
        If it cannot be written.
    """
    path = Path(path)
    try:
        with replacement(path) as new:
            new.write_bytes(content)
    except OSError as error:
        is_full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
        remedy = f"{len(content) / 1e6:.1f} MB are needed." if is_full else ""
        raise error_at(
            str(path), f"cannot be written: {error.strerror or error}.", remedy
        ) from error


def write_json(content: Mapping[str, Any], path: str | os.PathLike) -> None:
    """Write what was found as JSON, as `write_file` does; a number that JSON does not have is an error."""
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    write_file(path, (text + "\n").encode())


@cache
def conversion(unit_from: str | None, unit_to: str | None) -> tuple[float, float]:
    """Factor and offset that turn a value in one unit into another: ``factor * value + offset``.

    Knows the spellings of FMI ("N.m", "kg.m2", "rad/s"), "rpm", "deg", "kn", "1", and those of pint.

    Parameters
    ----------
    unit_from, unit_to : str or None
        A unit that is not stated (None or empty) is taken to be right.

    Returns
    -------
    tuple of two float

    Raises
    ------
    ShipcosimError
        If a unit is unknown or the two do not measure the same thing.

    Examples
    --------
    >>> conversion("kn", "m/s")
    (0.5144444444444445, 0.0)
    >>> conversion("degC", "K")
    (1.0, 273.15)
    """
    if not unit_from or not unit_to or unit_from == unit_to:
        return 1.0, 0.0
    try:
        return spelled_conversion(unit_from, unit_to)
    except UnitError as error:
        raise error_at("", error.found, error.remedy) from error


def _netcdf(table: xarray.Dataset) -> bytes:
    # By h5py: xarray and h5netcdf take nine times as long for the 270 signals of a DP run.
    import h5py

    content = io.BytesIO()
    with h5py.File(content, "w", track_order=True) as file:
        file.attrs.update(table.attrs)
        # The scale of the dimension that all signals have, as NetCDF 4 keeps it in HDF5.
        clock = table.variables["time"]
        time = _write_variable(file, "time", clock.values, clock.attrs)
        time.make_scale("time")
        for name in table.data_vars:
            signal = table.variables[name]
            attributes = signal.attrs
            dataset_name = str(name)
            # HDF5 separates groups by slashes and takes dots for places; such names stand in an attribute.
            if {"/", "%"} & set(dataset_name) or not dataset_name.strip("."):
                dataset_name = quote(dataset_name, safe="").replace(".", "%2E")
                attributes = {**attributes, OWN_NAME: str(name)}
            _write_variable(file, dataset_name, signal.values, attributes).dims[0].attach_scale(
                time
            )
    return content.getvalue()


def _write_variable(
    file: h5py.File, name: str, values: np.ndarray, attributes: Mapping[Any, Any]
) -> h5py.Dataset:
    """A signal with its attributes as a dataset of HDF5; truth values and texts as xarray writes and reads them."""
    import h5py

    if values.dtype.kind == "b":
        values = values.astype("int8")
        attributes = {**attributes, "dtype": "bool"}
    texts = h5py.string_dtype() if values.dtype.kind in "OU" else None
    written = file.create_dataset(
        name, data=values.astype(object) if texts else values, dtype=texts
    )
    written.attrs.update(attributes)
    return written


def _csv(table: xarray.Dataset) -> bytes:
    names = ["time", *table.data_vars]
    columns = [table.variables[name] for name in names]
    units = (column.attrs.get("units") or "1" for column in columns)
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(map(header_of, map(str, names), units))
    for row in zip(*(_cells_of(column.values) for column in columns), strict=True):
        text.write(",".join(row) + "\n")
    return text.getvalue().encode()


def _cells_of(values: np.ndarray) -> Iterable[str]:
    """Texts of a column."""
    numbers = values.astype("int8") if values.dtype == bool else values
    # Half the signals of a run keep their value: one text serves all rows. Bytes tell 0.0 from -0.0.
    if numbers.tobytes() == numbers[:1].tobytes() * len(numbers):
        return [repr(number).removesuffix(".0") for number in numbers[:1].tolist()] * len(numbers)
    return (repr(number).removesuffix(".0") for number in numbers.tolist())


def _check_heaps(path: Path) -> None:
    """Raise ValueError at an object without a size in a global heap: HDF5 goes round it for ever, in C.

    Reference: HDF5 File Format Specification 3.0, section III.E.
    """
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        start = content.find(HEAP)
        while start >= 0:
            end = start + int.from_bytes(content[start + 8 : start + 16], "little")
            place = start + 16
            while place + 16 <= min(end, len(content)):
                # Number, count of references, size, content up to a multiple of 8; 0 is the free space, head included.
                is_free = content[place : place + 2] == b"\0\0"
                size = int.from_bytes(content[place + 8 : place + 16], "little")
                if size > end - place or (is_free and size == 0):
                    raise ValueError("the heap with its texts and references is damaged")
                place += size if is_free else 16 + -(-size // 8) * 8
            start = content.find(HEAP, place)


def _check_declared(path: Path) -> None:
    """Raise ValueError where a file declares more values than are read; declaring needs no room in the file."""
    import h5py

    with h5py.File(path) as file:
        _check_heaps(path)
        # Where this attribute cannot be read, h5netcdf leaves a half-made file that prints a traceback when it goes.
        file.attrs.get("_nc3_strict")
        declared = sum(part.nbytes for part in file.values() if isinstance(part, h5py.Dataset))
    if declared > LARGEST_TABLE:
        raise ValueError(
            f"it declares {declared / 2**30:.3g} GiB, at most {LARGEST_TABLE >> 30} are read"
        )


def _open_netcdf(path: Path) -> xarray.Dataset:
    import xarray

    with path.open("rb") as file:
        is_classic = file.read(3) == b"CDF"
    # The live page saves NetCDF 3, which xarray reads with scipy. It declares no more than it has.
    if is_classic and find_spec("scipy") is None:
        raise error_at(
            str(path),
            "is NetCDF 3, which is read with scipy.",
            "Install it: pip install 'shipcosim[matlab]'.",
        )
    if not is_classic:
        _check_declared(path)
    engine = "scipy" if is_classic else "h5netcdf"
    with xarray.open_dataset(path, engine=engine, decode_times=False) as table:
        table = table.load()
    # A file may hold texts that are no UTF-8, which no page can show.
    for attributes in (table.attrs, *(variable.attrs for variable in table.variables.values())):
        for key, value in attributes.items():
            if isinstance(value, str):
                attributes[key] = _NO_TEXT.sub("\ufffd", value)
    for variable in table.variables.values():
        if "units" in variable.attrs:
            variable.attrs["units"] = str(variable.attrs["units"])  # a plain 1 is no text
    original_names = {
        name: variable.attrs.pop(OWN_NAME)
        for name, variable in table.variables.items()
        if OWN_NAME in variable.attrs
    }
    return _within_valid_range(table.rename(original_names))


def _within_valid_range(table: xarray.Dataset) -> xarray.Dataset:
    """Values beyond what a variable declares as valid are missing (CF conventions, section 2.5.1)."""
    for name, variable in list(table.data_vars.items()):
        if not {"valid_range", "valid_min", "valid_max"} & set(variable.attrs):
            continue
        limits = np.ravel(variable.attrs.get("valid_range", ()))
        ends = dict(zip(("valid_min", "valid_max"), limits, strict=False))
        low = variable.attrs.get("valid_min", ends.get("valid_min", -np.inf))
        high = variable.attrs.get("valid_max", ends.get("valid_max", np.inf))
        # NetCDF's limits are those of the packed values where these are scaled.
        scale = variable.encoding.get("scale_factor", 1.0)
        offset = variable.encoding.get("add_offset", 0.0)
        low, high = sorted(float(end) * scale + offset for end in (low, high))
        if variable.dtype.kind in "fiu" and ((variable < low) | (variable > high)).any():
            table[name] = variable.where((variable >= low) & (variable <= high))
    return table


def _read_netcdf(path: Path) -> xarray.Dataset:
    table = _open_netcdf(path)
    if "time" not in table.coords:
        raise ShipcosimError(_no_time(path, list(map(str, table.variables))))
    problems = [
        Problem(
            f"{path}, '{name}'",
            f"holds values of the type {variable.dtype}, not numbers.",
            "Leave it out.",
        )
        for name, variable in table.variables.items()
        if variable.dtype.kind not in "fiub"
    ]
    if table["time"].dims != ("time",) or table["time"].size == 0:
        problems.append(
            Problem(
                f"{path}, 'time'", "holds no times of rows.", "Each row is a time and its values."
            )
        )
    raise_errors(problems)
    return table


def _netcdf_columns(table: xarray.Dataset) -> dict[str, TableColumn]:
    """The variables with one dimension. Units like "seconds since 2022-10-27" count seconds."""
    columns = {}
    for name, variable in table.variables.items():
        if variable.ndim != 1:
            continue
        values = variable.values
        if variable.dtype.kind in "fiub":
            values = np.asarray(values, float)
        else:
            # What is no number becomes a text, as in a CSV file.
            plain = [v.decode(errors="replace") if isinstance(v, bytes) else v for v in values]
            values = np.array(list(map(str, plain)), dtype=object)
        unit = str(variable.attrs.get("units", "")).partition(" since ")[0]
        # The standard name of CF goes before a long name.
        title = variable.attrs.get("standard_name", variable.attrs.get("long_name", ""))
        columns[str(name)] = TableColumn(values, unit, str(title))
    return columns


def _read_columns(path: Path) -> list[tuple[str, str, np.ndarray]]:
    """Name, unit and values of each column of a CSV or Parquet file."""
    headers, columns = _read_parquet(path) if ending_of(path) == ".parquet" else _read_csv(path)
    if not len(columns) or not len(columns[0]):
        raise error_at(
            str(path), "has no row below its header.", "Each row is a time and its values."
        )
    of_file = []
    for header, cells in zip(headers, columns, strict=True):
        values, is_stamp = _plain(cells)
        parts = _HEADER.match(header)
        name, unit = (parts["name"], parts["unit"]) if parts else (header, "")
        of_file.append((name_in(name.strip()), "s" if is_stamp else unit, values))
    return of_file


def _read_csv(path: Path) -> tuple[list[str], list[tuple[str, ...]]]:
    """Headers, and cells by column."""
    content = unpacked_bytes(path)
    text = content.decode(unicode_of(content) or "cp1252", errors="replace")
    if "\0" in text:
        raise error_at(str(path), "is no text: it holds zero bytes.", "Write or copy it again.")
    rows, decimal = _cells(path, text.removeprefix("\ufeff"))
    if not rows:
        raise error_at(str(path), "is empty.", "Each row is a time and its values.")
    if decimal == ",":
        # A number with a decimal comma is written with a point; points in it group thousands.
        for row in rows[1:]:
            row[:] = [
                cell.replace(".", "").replace(",", ".") if is_figure(cell) else cell for cell in row
            ]
    width = len(rows[0])
    for number, row in enumerate(rows, start=1):
        if len(row) != width:
            message = f"has {len(row)} cells, and the header has {width}: {','.join(row)}"
            raise error_at(f"{path}, row {number}", message[:100], _AS_CSV)
    rows = _without_row_of_units(rows)
    return rows[0], list(zip(*rows[1:], strict=True))


_AS_CSV = "Columns are separated by commas, numbers have a decimal point."


def _without_row_of_units(rows: list[list[str]]) -> list[list[str]]:
    """The rows, with the units of a row of them below the names in the header."""
    if len(rows) < 2 or not _are_units(rows[1]):
        return rows
    units = [cell.strip("[]() ") for cell in rows[1]]
    header = [
        header if _HEADER.match(header) or unit in ("", "-") else f"{header} [{unit}]"
        for header, unit in zip(rows[0], units, strict=True)
    ]
    return [header, *rows[2:]]


def _are_units(cells: list[str]) -> bool:
    """Whether all cells of a row are units, or empty."""
    units = [cell.strip("[]() ") for cell in cells]
    are_units = [unit in ("", "-") or spelled_unit(unit) is not None for unit in units]
    return any(units) and all(are_units) and not any(map(is_figure, units))


def unpacked_bytes(path: Path) -> bytes:
    """Content of a file, unpacked where it is packed by gzip, whatever it is called.

    Raises
    ------
    ShipcosimError
        If it unpacks to far more than its size: no log does, a bomb would fill the memory.
    """
    with path.open("rb") as file:
        content = file.read()
    if not content.startswith(b"\x1f\x8b"):
        return content
    most = max(SMALL, MOST_PACKED * len(content))
    with gzip.open(io.BytesIO(content)) as packed:
        text = packed.read(most + 1)
    if len(text) > most:
        raise error_at(
            str(path),
            f"unpacks to more than {MOST_PACKED} times its size.",
            "Unpack it, and look at what it holds.",
        )
    return text


def _cells(path: Path, text: str) -> tuple[list[list[str]], str]:
    """Cells by row, and the decimal sign. Commas separate where the header has one; else what fits."""
    text = _without_comments(text)
    lines = text.splitlines()
    separator = "," if not lines or "," in lines[0] else separator_of(lines)
    # Blanks separate where every line has as many cells as the header.
    if separator == " " and len({len(line.split()) for line in lines if line.strip()}) > 1:
        separator = ","
    if separator == ",":
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        try:
            return [row for row in reader if row], "."
        except csv.Error as error:
            most = csv.field_size_limit()
            message = f"has a quotation mark without its other, or a cell of more than {most:,} characters."
            raise error_at(
                f"{path}, line {reader.line_num}", message, "Write or copy it again."
            ) from error
    rows = [cells_in(line, separator) for line in lines if line.strip()]
    with_comma = {cell for row in rows[1:] for cell in row if "," in cell and is_figure(cell)}
    return rows, decimal_of(str(path), sorted(with_comma)) or "."


def _without_comments(text: str) -> str:
    """Text without the comment lines above its header; without a header the last comments give names and units."""
    lines = text.splitlines(keepends=True)
    is_above = [not line.strip() or line.startswith("#") for line in lines]
    if not text.startswith("#") or all(is_above):
        return text
    first = is_above.index(False)
    table = "".join(lines[first:])
    if all(map(is_figure, cells_in(lines[first], separator_of(lines[first:])))):
        above = [line.lstrip("# ") for line in lines[:first] if line.strip()]
        count = 2 if _are_units(cells_in(above[-1], separator_of(above[-1:]))) else 1
        return "".join(above[-count:]) + table
    return table


def _read_parquet(path: Path) -> tuple[list[str], list[np.ndarray]]:
    """Headers and columns."""
    try:
        from pyarrow import Table, timestamp, types
        from pyarrow.parquet import ParquetFile
    except ImportError as error:
        raise error_at(
            str(path),
            "pyarrow, which reads Parquet, is not here.",
            'Install it: pip install "shipcosim[parquet]". Or save the table as CSV.',
        ) from error
    file = ParquetFile(path)
    about = file.metadata
    # What is packed well declares more than its size: bounded as for NetCDF.
    if about.num_rows * about.num_columns * 8 > LARGEST_TABLE:
        size = about.num_rows * about.num_columns * 8 / 2**30
        raise ValueError(f"it declares {size:.3g} GiB, at most {LARGEST_TABLE >> 30} are read")
    content: Table = file.read()
    columns = []
    for column in content.columns:
        # Stamps are UTC inside, whatever their zone is called: some writers name zones that only they know.
        if types.is_timestamp(column.type) and column.type.tz is not None:
            column = column.cast(timestamp(column.type.unit))
        columns.append(column.to_pandas().to_numpy())
    return content.column_names, columns


def _read_rows(path: Path) -> xarray.Dataset:
    columns = _read_columns(path)
    names = [name for name, _, _ in columns]
    problems = []
    for name, _, values in columns:
        if values.dtype == object:
            text = next(str(value) for value in values if value is not None)[:40]
            message = f"holds texts, not numbers, as '{text}'."
            problems.append(Problem(f"{path}, column '{name}'", message))
    if "time" not in names and 2 * sum(map(is_figure, names)) > len(names):
        message = "holds numbers where the names of the columns should be."
        raise error_at(
            f"{path}, first row", message, "Write a row above it, such as: time [s],y [m]."
        )
    problems += _repeated(path, names)
    if "time" not in names:
        problems.append(_no_time(path, names))
    raise_errors(problems)
    signals = {name: (name, values, unit, "") for name, unit, values in columns}
    _, time, unit, _ = signals.pop("time")
    return make_table(time * _seconds_in(unit, path), signals.values())


def _seconds_in(unit: str, path: Path) -> float:
    try:
        return conversion(unit, "s")[0]
    except ShipcosimError as error:
        raise error_at(
            f"{path}, column 'time'", error.problems[0].found, "It should be in s."
        ) from error


def _plain(values: np.ndarray | tuple[str, ...]) -> tuple[np.ndarray, bool]:
    """Values of a column as numbers if possible; and whether they are time stamps, which become seconds."""
    values = np.asarray(values, object) if isinstance(values, tuple) else values
    if values.dtype.kind in "fiub":
        return values.astype(float), False
    if values.dtype.kind == "m":
        return np.where(np.isnat(values), np.nan, values / np.timedelta64(1, "s")), True
    if values.dtype.kind == "M":
        return _seconds_of(values), True
    # Python takes 1_000 for a number; in a table it is a text, as it is in a log.
    if any("_" in str(value) for value in values):
        return values, False
    try:
        return values.astype(float), False
    except (ValueError, TypeError):
        pass
    texts = [None if str(value).strip().lower() in _NOTHING else str(value) for value in values]
    if {str(text).lower() for text in texts} <= {"true", "false", "none"}:
        return np.array([np.nan if t is None else float(t.lower() == "true") for t in texts]), False
    try:
        return np.array([np.nan if text is None else float(text) for text in texts]), False
    except ValueError:
        return _times(np.array(texts, object))


def _times(texts: np.ndarray) -> tuple[np.ndarray, bool]:
    """Spans of time, or stamps of date and time by ISO 8601, as seconds; and whether they are such. None is unknown."""
    import pandas

    cells = pandas.Series(texts, dtype="object").str.strip()
    if (spans := seconds_of_spans(cells)) is not None:
        return spans, True
    try:
        stamps = pandas.to_datetime(cells, format="ISO8601", utc=True).dt.tz_localize(None)
    except (ValueError, TypeError, OverflowError):
        return texts, False
    return _seconds_of(stamps.to_numpy("datetime64[ns]")), True


def _seconds_of(stamps: np.ndarray) -> np.ndarray:
    """Seconds after the first stamp."""
    valid = stamps[~np.isnat(stamps)]
    return (stamps - valid[0] if len(valid) else stamps - stamps) / np.timedelta64(1, "s")


def _repeated(path: Path, names: list[str]) -> list[Problem]:
    counts = Counter(names)
    return [
        Problem(f"{path}, column '{name}'", "is there twice.")
        for name in sorted(counts)
        if counts[name] > 1
    ]


def _no_time(path: Path, names: list[str]) -> Problem:
    return Problem(
        str(path),
        f"has no column 'time', only {shortened(names, 8)}.",
        "It should have 'time [s]'.",
    )
