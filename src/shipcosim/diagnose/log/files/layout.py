"""Layout of a text that is a table: separator, lines before the header, header, row of units, first row of values."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.dialects import cells_in, is_comment, is_figure, is_nothing, separator_of
from shipcosim.errors import counted, error_at

_DATE = re.compile(r"\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}")
_CLOCK = re.compile(r"\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?")


@dataclass(frozen=True)
class Layout:
    """Layout of a text file as a table.

    Attributes
    ----------
    separator : str
        A blank stands for any number of blanks.
    header : tuple of str
        Names as they stand there.
    units : tuple of str
        From a row of units below the names; empty without one.
    first : int
        Index of the first line of values.
    remarks : tuple of str
        Remarks on the layout.
    titles : tuple of str
        Names behind those of their groups; empty where there are none.
    """

    separator: str
    header: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    remarks: tuple[str, ...]
    titles: tuple[str, ...] = ()


def layout_of(
    source: str, lines: list[str], form: FileLayout, is_unit: Callable[[str], bool]
) -> Layout:
    """Layout of the lines of a file.

    Parameters
    ----------
    source : str
        The file, for messages.
    lines : list of str
        Its lines.
    form : FileLayout
        What a channel file says of the form of the log.
    is_unit : callable
        Whether a text is the spelling of a unit.

    Raises
    ------
    ShipcosimError
        If it is no table, or has no names.
    """
    # Find the first row of values, and above it the names and units.
    separator = form.separator or separator_of(lines)
    first, width = _first_row(source, lines, separator)
    above = [
        i for i in range(first) if lines[i].strip() and not lines[i].lower().startswith("sep=")
    ]
    if form.names is not None:
        return Layout(separator, form.names, (), first, _skipped(above))
    at, units, header, titles = _header(lines, above, separator, width, is_unit)
    # A log of MOOS names its variables in its rows.
    if header is None and any(lines[i].startswith("%% LOG FILE") for i in above):
        header = ["time", "name", "process", "value"]
    if header is None:
        names = ", ".join(f'"column {i + 1}"' for i in range(min(width, 3)))
        message = f"no names of columns stand above the first row of numbers, line {first + 1}, which has {width}."
        raise error_at(
            source, message, f"Name them in a channel file: file = {{names = [{names}, ...]}}."
        )
    # An index column of data frames has values, but no name; a date and a clock may share one.
    if separator != "," and len(header) == width - 1:
        cells = cells_in(lines[first], separator)
        if cells[0] in ("0", "1"):
            header = ("", *header)
        elif _DATE.fullmatch(cells[0]) and _CLOCK.fullmatch(cells[1]):
            header = ("date", "time", *header[1:])
    rest = [i for i in above if i < at]
    between = [i for i in above if i > at and not is_comment(lines[i])]
    first = next((i for i in between if is_figure(cells_in(lines[i], separator)[0])), first)
    return Layout(separator, tuple(header), tuple(units), first, _skipped(rest), tuple(titles))


def without_labview_header(lines: list[str]) -> list[str]:
    """The names, units and values of LabVIEW's text (.lvm) on the lines where they stand; other texts unchanged."""
    ends = [i for i, line in enumerate(lines[:200]) if line.startswith("***End_of_Header***")]
    if not ends or ends[-1] + 2 > len(lines):
        return lines
    header = {line.partition("\t")[0]: line for line in lines[: ends[-1]]}
    names = lines[ends[-1] + 1]
    if header.get("X_Dimension", "").startswith("X_Dimension\tTime"):
        names = names.replace("X_Value", "Time (s)", 1)
    units = header.get("Y_Unit_Label", "").removeprefix("Y_Unit_Label")
    return ["" for _ in lines[: ends[-1]]] + [names, units, *lines[ends[-1] + 2 :]]


def _skipped(above: list[int]) -> tuple[str, ...]:
    return (f"{counted(len(above), 'line')} above the header left out.",) if above else ()


def _first_row(source: str, lines: list[str], separator: str) -> tuple[int, int]:
    """Index of the first line of values, and the number of its cells."""
    # The width of the table is the most frequent number of cells, from a sample of the lines.
    rows = [i for i, line in enumerate(lines) if line.strip() and not is_comment(line)]
    picked = rows[:: max(len(rows) // 2000, 1)]
    widths = Counter(len(cells_in(lines[i], separator)) for i in picked)
    width = widths.most_common(1)[0][0] if widths else 0
    # First line of this width that holds mostly figures, or begins with one as messages do.
    for i in rows:
        cells = cells_in(lines[i], separator)
        filled = [cell for cell in cells if not is_nothing(cell)]
        figures = sum(map(is_figure, filled))
        is_message = figures > 1 and is_figure(cells[0])
        if (
            width > 1
            and len(cells) == width
            and figures
            and (is_message or figures >= 0.4 * len(filled))
        ):
            return i, width
    if rows and width > 1:
        raise error_at(source, "has no row below its header.", "Each row is a time and its values.")
    remedy = "It should be a table: a line of names, then rows of as many cells."
    raise error_at(source, "no table is found in it: no rows of several numbers.", remedy)


def _header(lines, above, separator, width, is_unit):
    """Line of the names, the units of a row of units, and the names; None without names."""
    units = ()
    below = None
    index = ""
    # Go upwards from the values: perhaps a row of units, then the row of names.
    for k, i in reversed(list(enumerate(above))):
        text = lines[i].lstrip(" ")
        if is_comment(text):
            text = text.lstrip("#%/! \t")
        row = _header_cells(text, separator, width)
        if row is None:
            # A row of values of another length is judged with the others.
            if any(map(is_figure, cells_in(text, separator)[:1])) and not is_comment(lines[i]):
                below = i
            elif below is None or i < below - 1:
                break
            continue
        filled = [cell for cell in row if cell]
        # Below names of several levels pandas writes the name of the index, alone.
        if len(filled) == 1 < width and row[0] and not index:
            index = row[0]
            below = i
            continue
        if not units and filled and _is_row_of_units(row, is_unit):
            units = [cell.strip("[]() ") for cell in row]
            below = i
            continue
        # A row of units above this one belongs to the names above it; then this one describes the columns.
        upper = [_header_cells(lines[j], separator, width) for j in above[max(k - 2, 0) : k]]
        if not units and len(upper) == 2 and all(upper) and _is_row_of_units(upper[1], is_unit):
            below = i
            continue
        if sum(map(is_figure, filled)) < 0.5 * len(filled):
            names, titles = _with_groups(row, lines[i - 1] if i else "", separator)
            return i, units, [names[0] or index, *names[1:]], titles
        break
    return 0, (), None, ()


def _with_groups(row, above, separator):
    """Names, with their group in the row above where they stand there twice or not at all; and all with their groups."""
    groups = cells_in(above, separator)
    groups += [""] * (len(row) - len(groups))
    is_clear = len(set(row)) == len(row) and "" not in row
    if len(groups) != len(row) or separator == " " or is_clear or is_comment(above):
        return row, ()
    # A group stands over its first column, and over those after it that have none.
    for i in range(1, len(groups)):
        groups[i] = groups[i] or groups[i - 1]
    titles = [f"{group} {name}".strip() for group, name in zip(groups, row, strict=True)]
    names = [
        title if row.count(name) > 1 or not name else name
        for title, name in zip(titles, row, strict=True)
    ]
    return (names, titles) if len(set(names)) == len(names) else (row, ())


def _is_row_of_units(row, is_unit):
    # Most cells must be spellings of units; in brackets half of them are enough.
    filled = [cell.strip("[]() ") for cell in row if cell.strip("[]() ")]
    marked = sum(cell[:1] in "([" and cell[-1:] in ")]" for cell in row if cell)
    units = sum(map(is_unit, filled))
    return bool(filled) and (
        units >= 0.75 * len(filled) or (marked == len(filled) and units >= 0.5 * len(filled))
    )


def _header_cells(text, separator, width):
    """Cells of a possible header with a given number of columns; None if it is no header."""
    # Columns with a separator may end in empty cells.
    if separator != " ":
        row = cells_in(text, separator)
        while len(row) > width and row[-1].lower() in ("", "comment"):
            row.pop()
        return row if width - 1 <= len(row) <= width else None
    # With blanks as separators a unit belongs to its name: try several ways to split.
    glued = re.sub(r"\s+(?=[\[(])", "", text)
    for row in (
        text.split(),
        glued.split(),
        re.split(r"\s{2,}|\t", text.strip()),
        cells_in(text, ","),
    ):
        if len(row) == width:
            return row
    return text.split() if len(text.split()) == width - 1 else None
