"""Any file that is a log as columns: their names, values and units as they stand there, and remarks."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim.diagnose.log.files.cells import numbers_of, with_unit
from shipcosim.diagnose.log.files.excel import is_workbook, text_of_sheet
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.layout import Layout, layout_of, without_labview_header
from shipcosim.diagnose.log.files.matlab import columns_of_matlab, is_matlab
from shipcosim.diagnose.log.files.nmea import columns_of_sentences, holds_sentences
from shipcosim.diagnose.log.files.positions import with_minutes
from shipcosim.diagnose.log.files.records import holds_records, text_of_records, unit_of_path
from shipcosim.diagnose.log.files.refused_formats import refuse_foreign
from shipcosim.diagnose.log.files.text import text_of
from shipcosim.diagnose.log.files.times import seconds_of_parts
from shipcosim.diagnose.log.names.units import is_unit, name_and_unit
from shipcosim.dialects import NOTHING, cells_in, decimal_of, is_comment
from shipcosim.errors import Problem, ShipcosimError, counted, error_at
from shipcosim.series import ending_of, read_columns

_FEW = (
    0.01  # share of rows of another length that are left out; more make the file no table. Assumed.
)


@dataclass(frozen=True)
class LogColumns:
    """Columns of a log as they stand in its file.

    Attributes
    ----------
    source : str
        The file, for messages.
    values : dict of str to (n,) array
        By name: float64 with NaN where there is nothing, or objects: texts, None where there is nothing. A name that
        stands there again has its count: ``"speed (2)"``.
    units : dict of str to str
        As stated; empty where none is.
    remarks : tuple of str
        How the file was read, where that is not plain, and what of it was left out.
    doubled : tuple of str
        Names that several columns have.
    joined : bool
        Whether rows of several tables stand below each other, each with the columns of its own.
    titles : mapping of str to str
        What a file of NetCDF says of a column besides its name, or its name behind that of its group.
    """

    source: str
    values: dict[str, np.ndarray]
    units: dict[str, str]
    remarks: tuple[str, ...] = ()
    doubled: tuple[str, ...] = field(default=())
    joined: bool = False
    titles: Mapping[str, str] = field(default_factory=dict)


def read_file(path: Path, form: FileLayout) -> LogColumns:
    """Columns of a file.

    Parameters
    ----------
    path : Path
        Text of any dialect or sentences of NMEA, also compressed by gzip; .xlsx; .nc; .parquet; .mat.
    form : FileLayout
        What a channel file says of the form of the log.

    Raises
    ------
    ShipcosimError
        If there is no such file, it is no table, or could be read in two ways.
    """
    if path.is_dir():
        raise error_at(str(path), "is a folder without tables.", "Name the file of a log.")
    if not path.is_file():
        raise error_at(str(path), "there is no such file.")
    if ending_of(path) in (".nc", ".parquet"):
        columns = read_columns(path)
        return LogColumns(
            str(path),
            {name: values for name, (values, _, _) in columns.items()},
            {name: unit for name, (_, unit, _) in columns.items()},
            titles={name: title for name, (_, _, title) in columns.items()},
        )
    if is_matlab(path):
        return LogColumns(str(path), *columns_of_matlab(path))
    refuse_foreign(path)
    has_records = holds_records(path)
    if is_workbook(path):
        text, remarks = text_of_sheet(path, form.sheet)
        form = form.model_copy(update={"separator": "\t"})
    elif has_records:
        text, remarks = text_of_records(path)
        form = form.model_copy(update={"separator": "\t"})
    else:
        text, remarks = text_of(path, form.encoding)
    # Records and sheets may hold raw sentences too, behind the times at which they were received.
    lines = text.splitlines()[1 if has_records else 0 :]
    if holds_sentences(lines):
        values, units, more = columns_of_sentences(str(path), lines)
        return LogColumns(str(path), values, units, (*remarks, *more))
    read = _of_text(str(path), text, form)
    return replace(read, remarks=(*remarks, *read.remarks))


def _of_text(source: str, text: str, form: FileLayout) -> LogColumns:
    # Layout first, then the rows of the right length, then the decimal sign, then each column.
    lines = without_labview_header(text.splitlines())
    layout = layout_of(source, lines, form, is_unit)
    rows, remarks = _rows(source, lines, layout)
    width = len(layout.header)
    frame = _checked_frame(source, rows, layout.separator, width)
    decimal, frame = _with_decimal_sign(source, frame, rows, layout.separator, form)
    names, units, doubled = _names(layout)
    values = {}
    for i, name in enumerate(names):
        if frame[i].dtype.kind in "fiub":
            values[name] = frame[i].to_numpy(float)
            continue
        values[name], more = numbers_of(name, frame[i], decimal)
        remarks += more
        if (
            values[name].dtype.kind == "O"
            and not units[name]
            and (parsed := with_unit(values[name], decimal))
        ):
            values[name], units[name] = parsed
    if decimal == ",":
        remarks.append("Numbers are read with a decimal comma.")
    if "time" not in values and (parsed := seconds_of_parts(values)):
        parts, values["time"] = parsed
        units["time"] = "s"
        values = {name: cells for name, cells in values.items() if name not in parts}
        remarks.append(f"Time is made of {', '.join(parts)}.")
    remarks += with_minutes(values, units)
    doubled = tuple(name for name in doubled if f"{name} (2)" in values)
    titles = dict(zip(names, layout.titles, strict=False))
    return LogColumns(source, values, units, (*layout.remarks, *remarks), doubled, titles=titles)


def _names(layout: Layout) -> tuple[list[str], dict[str, str], tuple[str, ...]]:
    """Unique names, their units, and the names that occur more than once."""
    names = []
    units = {}
    seen = Counter()
    for i, header in enumerate(layout.header):
        name, unit = name_and_unit(header)
        name = name or f"column {i + 1}"
        seen[name] += 1
        name = name if seen[name] == 1 else f"{name} ({seen[name]})"
        below = layout.units[i] if i < len(layout.units) else ""
        names.append(name)
        units[name] = unit or below or unit_of_path(name)
    return names, units, tuple(name for name, count in seen.items() if count > 1)


def _rows(source: str, lines: list[str], layout: Layout) -> tuple[list[str], list[str]]:
    """Lines of values of the right length, and what was left out."""
    rest = lines[layout.first :]
    separator = layout.separator
    width = len(layout.header)
    rows = [line for line in rest if line.strip() and not (line[0] in "#%/! " and is_comment(line))]
    remarks = []
    comments = sum(1 for line in rest if line.strip()) - len(rows)
    if comments:
        remarks.append(f"{counted(comments, 'comment line')} between rows left out.")
    # Many short rows have empty cells at their end; a few
    # odd rows are left out; anything else is no table.
    rows, counts = _without_last_separator(rows, separator, width)
    bad = counts != width
    if (counts < width).mean() > _FEW and bad.sum() > 1 and not (counts > width).any():
        remarks.append(
            f"{counted(bad.sum(), 'row')} with fewer cells than the header: what they lack is left empty."
        )
        return rows, remarks
    if bad.mean() > max(_FEW, 1.5 / len(rows)):
        raise ShipcosimError(_ragged(source, lines, layout, rows, counts, width))
    if bad.any():
        shown = rows[int(np.flatnonzero(bad)[0])][:40]
        remarks.append(
            f"{counted(bad.sum(), 'row')} without {width} cells left out, the first '{shown}'."
        )
        rows = [line for line, wrong in zip(rows, bad, strict=True) if not wrong]
    # Loggers that are started again write the header again.
    header = list(layout.header)
    again = {
        i
        for i, line in enumerate(rows)
        if header[-1] in line and cells_in(line, separator) == header
    }
    if again:
        remarks.append(f"The header is repeated in {counted(len(again), 'row')}: left out.")
        rows = [line for i, line in enumerate(rows) if i not in again]
    return rows, remarks


def _without_last_separator(rows, separator, width):
    """Rows without the separator that each ends with, where that makes one cell too many, and their lengths."""
    counts = np.fromiter((_width(line, separator) for line in rows), int, len(rows))
    if (counts == width + 1).mean() > 0.5 and all(
        line.rstrip(" ").endswith(separator) for line in rows[:50]
    ):
        rows = [line.rstrip(" ").removesuffix(separator) for line in rows]
        counts = np.fromiter((_width(line, separator) for line in rows), int, len(rows))
    return rows, counts


def _ragged(source, lines, layout, rows, counts, width):
    """What is wrong where many rows have another length than the header."""
    usual = Counter(counts.tolist()).most_common(1)[0][0]
    row = int(np.flatnonzero(counts != width)[0])
    line = next(i for i in range(layout.first, len(lines)) if lines[i].startswith(rows[row]))
    message = f"has {counts[row]} cells, and the header has {width}."
    remedy = "Each row needs one for each name."
    if layout.separator == "," and width < usual <= 2 * width:
        remedy = "Are these decimal commas between commas? Separate the columns by semicolons."
    return Problem(f"{source}, line {line + 1}", message, remedy)


def _width(line: str, separator: str) -> int:
    if separator == " " or '"' in line:
        return len(cells_in(line, separator))
    return line.count(separator) + 1


def _checked_frame(source: str, rows: list[str], separator: str, width: int) -> Any:
    """The rows as a table; ShipcosimError where a quotation mark takes several for one."""
    from pandas.errors import ParserError

    try:
        frame = _frame(rows, separator, width)
        why = ""
    except ParserError as error:
        frame = None
        why = f" ({error})"
    if frame is None or len(frame) != len(rows):
        row = next((row for row in rows if row.count('"') % 2), rows[0])
        message = f"a quotation mark is opened in a row and not closed in it: '{row[:60]}'{why}."
        raise error_at(source, message, "Close it, or leave it out.")
    return frame


def _frame(rows: list[str], separator: str, width: int, texts: Any = None) -> Any:
    import pandas

    splits: dict[str, Any] = (
        {"sep": r"\s+"} if separator == " " else {"sep": separator, "skipinitialspace": True}
    )
    words = sorted(
        {w for word in NOTHING for w in (word, word.upper(), word.capitalize())}
        | {"NaN", "NaT", "N/a"}
    )
    return pandas.read_csv(
        io.StringIO("\n".join(rows)),
        header=None,
        names=range(width),
        index_col=False,
        na_values=words,
        keep_default_na=False,
        low_memory=False,
        dtype=texts,
        **splits,
    )


def _with_decimal_sign(source, frame, rows, separator, form):
    """Decimal sign of a file, and its table once more where a point may group thousands."""
    # Columns of texts show whether the decimal sign is a comma.
    texts = [i for i in frame if frame[i].dtype.kind not in "fiub"]
    if form.decimal is not None:
        decimal = form.decimal
    else:
        decimal = decimal_of(source, _with_comma(frame[i] for i in texts)) or "."
    if decimal == ".":
        return decimal, frame
    # With a decimal comma, numbers with a point were
    # read wrongly: read these columns again as texts.
    points = {i: "str" for i in frame if frame[i].dtype.kind == "f"}
    anew = _frame(rows, separator, frame.shape[1], points)
    for i in points:
        cells = anew[i].dropna()
        dotted = cells[cells.str.contains(".", regex=False)]
        if len(dotted) and not dotted.str.fullmatch(r"\s*[+-]?\d{1,3}(\.\d{3})+\s*").all():
            continue  # a point that cannot group thousands is a decimal point
        if len(dotted) and form.decimal is None:
            cell = dotted.iloc[0].strip()
            message = f"'{cell}' can be {cell} or {cell.replace('.', '')}, as other numbers have a decimal comma."
            remedy = (
                'Say which in a channel file: file = {decimal = ","} groups thousands by points.'
            )
            raise error_at(source, message, remedy)
        frame[i] = anew[i]
    return decimal, frame


def _with_comma(columns):
    """Cells that are figures with a comma, each once, of columns that are mostly such."""
    cells = []
    for column in columns:
        text = column.dropna().astype("str").str.strip()
        text = text[~text.str.lower().isin(NOTHING)]
        numbers = text[text.str.fullmatch(r"[+-]?[\d.,]+(?:[eE][+-]?\d+)?")]
        if len(numbers) > 0.9 * len(text):
            cells += numbers[numbers.str.contains(",", regex=False)].unique().tolist()
    return cells
