"""Measured logs: any table, by the roles of its columns, as one table in the units of the roles."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipcosim.diagnose.log.channels import Channel, ChannelFile, read_channels
from shipcosim.diagnose.log.degree_size import local_plane
from shipcosim.diagnose.log.files.bags import is_bag, tables_of_bag
from shipcosim.diagnose.log.files.dataflash import is_dataflash, tables_of_dataflash
from shipcosim.diagnose.log.files.file_layout import FileLayout
from shipcosim.diagnose.log.files.joined_tables import joined, tables_in
from shipcosim.diagnose.log.files.long_format import brought_together, spread
from shipcosim.diagnose.log.files.missing import without_dropouts, without_missing
from shipcosim.diagnose.log.files.nmea2000 import is_messages, tables_of_messages
from shipcosim.diagnose.log.files.table import LogColumns, read_file
from shipcosim.diagnose.log.files.times import epoch_unit
from shipcosim.diagnose.log.names.guesses import Thrusters
from shipcosim.diagnose.log.names.proposal import Proposal, propose
from shipcosim.diagnose.log.names.units import unit_for
from shipcosim.diagnose.log.roles import NAVIGATION, OVER_EARTH, role_of
from shipcosim.diagnose.log.thresholds import LATEST, SHORTEST_STEP
from shipcosim.diagnose.log.values import LARGEST, WrongUnit, values_of
from shipcosim.diagnose.numerics import finite, usual_rise
from shipcosim.errors import (
    Problem,
    ShipcosimError,
    counted,
    error_at,
    raise_errors,
    reading,
    shortened,
)
from shipcosim.series import make_table

if TYPE_CHECKING:
    import xarray


_FARTHEST = {
    "latitude": 90.0,
    "longitude": 540.0,
}  # deg; some loggers count on beyond the date line

MOST_NAMED = 20
"""Largest number of columns that a remark lists."""
LARGEST_NUMBER = 1e100
"""Largest number that a log can hold, in the unit of its role."""


def read_log(
    log: str | os.PathLike | xarray.Dataset,
    channels: str | os.PathLike | ChannelFile | None = None,
    thrusters: Thrusters | None = None,
) -> xarray.Dataset:
    """Read a measured log: every row of the file, in its order, in the units of the roles.

    Parameters
    ----------
    log : path or xarray.Dataset
        Text of any dialect, also compressed (.csv, .txt, .csv.gz, ...), .xlsx, .nc, .parquet or .mat; a
        folder of tables, a bag of ROS 2, messages of NMEA; or such a table, over
        `time`, with the units of its columns as ``units``.
    channels : path or ChannelFile, optional
        Channel file (see `read_channels`); without one columns whose names have one meaning are used.
    thrusters : mapping of str to tuple of str, optional
        Thrusters of the system by name, with what drives each; without, any name of a thruster is one.

    Returns
    -------
    xarray.Dataset
        Over `time` as it stands in the file. Latitude and longitude become `north` and `east` about the first fix,
        which is in the attributes `latitude_origin` and `longitude_origin` [deg]; speed and course, or velocities over
        the earth, become `surge` and `sway` with the heading. Connectors keep the unit that is stated. The attribute
        `unused_columns` lists the columns that have no role, `column_remarks` says how the file was read, which column
        is what, and which is not used and why; `source` and `sha256` of the encoding are name and fingerprint of a
        file.

    Raises
    ------
    ShipcosimError
        With all that is wrong: a column that is missing, not numeric or in a unit of something else, no time.
    """
    # Settings of the channel file; without channels in it, names decide.
    given = read_channels(channels) if isinstance(channels, (str, os.PathLike)) else channels
    form = given.form if given else FileLayout()
    columns, file = _source_of(log, form)
    proposal = None
    if given is not None and given.channels:
        mapping = given.channels
    else:
        proposal = propose(columns, thrusters, form)
        mapping = proposal.channels()
    _check_channels(columns, mapping, proposal)
    # Convert each channel to the unit of its role, and keep what is stated and what is not used.
    signals, remarks = _signals(columns, mapping, form, is_asked=proposal is None)
    stated = {name: _stated(channel, name, columns) for name, channel in mapping.items()}
    used = {name for channel in mapping.values() for name in channel.columns}
    unused = [name for name in columns.values if name not in used and not _is_unnamed(name)]
    attributes = {"unused_columns": unused}
    # Bring rows of one time together, and derive surge, sway and the local position.
    time, _ = signals.pop("time")
    _check_time(columns.source, time)
    time, signals, more = brought_together(time, signals, columns.joined)
    _check_restart(columns.source, time, [values for values, _ in signals.values()])
    remarks += more + without_dropouts(signals) + _over_the_earth(signals)
    if LARGEST.keys() <= signals.keys():
        attributes |= _local_position(columns.source, signals, remarks)
        remarks += without_dropouts(signals)
    remarks += _without_value(columns.source, signals)
    attributes["column_remarks"] = [
        *columns.remarks,
        *remarks,
        *(_proposal_text(proposal) if proposal else _not_named(unused)),
    ]
    table = make_table(
        time, [(n, v, unit, _meaning(n)) for n, (v, unit) in signals.items()], attributes
    )
    table.encoding |= file
    # Units that were stated are kept, as they make a unit mistake less likely.
    for name, unit in stated.items():
        if unit and name in table.variables:
            table[name].attrs["stated_unit"] = unit
    return table


_SEVERAL_TABLES = (
    (is_bag, tables_of_bag),
    (is_messages, tables_of_messages),
    (is_dataflash, tables_of_dataflash),
)
"""Forms of files that hold several tables: how each is recognised and read."""


def columns_of(log: str | os.PathLike, form: FileLayout | None = None) -> LogColumns:
    """Columns of a file, one for each channel also where a file has one value a row.

    Parameters
    ----------
    log : path
        A file, or a folder of tables that are joined by their times.
    form : FileLayout, optional
        What the file states of itself.
    """
    path = Path(log)
    form = form or FileLayout()
    with reading(path):
        # A bag or a folder holds several tables, with a clock in each.
        for is_such, tables_of in _SEVERAL_TABLES:
            if is_such(path):
                tables = tables_of(path)
                return joined(path, tables, dict.fromkeys(tables, Channel(column="time")))
        files = tables_in(path)
        if not files:
            return without_missing(spread(read_file(path, form), form))
        tables = {name: columns_of(file, form) for name, file in files.items()}
        times = {
            name: propose(table, form=form).channels(guessed=True).get("time")
            for name, table in tables.items()
        }
        return joined(path, tables, times)


def _digest(path: Path) -> str:
    """Fingerprint of a file, or of all files in a folder."""
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    total = hashlib.sha256()
    for file in files:
        if file.is_file():
            total.update(file.read_bytes())
    return total.hexdigest()


def _source_of(log, form) -> tuple[LogColumns, dict[str, str]]:
    """A log as columns, and the fingerprint of its file."""
    if isinstance(log, (str, os.PathLike)):
        return columns_of(log, form), {"source": str(log), "sha256": _digest(Path(log))}
    values = {"time": np.asarray(log["time"].values, float)}
    values |= {str(name): np.asarray(v.values) for name, v in log.data_vars.items()}
    units = {name: str(log[name].attrs.get("units", "")) for name in values}
    # A table that was read from a file says from which.
    file = {key: log.encoding[key] for key in ("source", "sha256") if key in log.encoding}
    remarks = tuple(log.attrs.get("run_remarks", ()))
    return LogColumns(file.get("source", "log"), values, units, remarks), file


def _is_unnamed(name):
    return name.startswith("column ") and name.removeprefix("column ").isdigit()


def _stated(channel: Channel, name: str, columns: LogColumns) -> str:
    """The unit that somebody stated of a channel."""
    stated = channel.unit or columns.units.get(channel.column, "")
    role = role_of(name)
    return unit_for(stated, role.unit) if stated and role else stated


def _check_channels(columns: LogColumns, mapping: dict[str, Channel], proposal: Proposal | None):
    """Raise ShipcosimError where channels are not enough for a log, or one of a proposal stands there twice."""
    source = columns.source
    taken = {name for channel in mapping.values() for name in channel.columns}
    problems = [
        Problem(f"{source}, column '{name}'", "is there twice.", _WHICH)
        for name in columns.doubled
        if name in taken and proposal
    ]
    help_ = f"Say in a channel file which column is what: `shipcosim channels {source} --out channels.toml` proposes one."
    # Without a time, or with nothing but a time, there is no log.
    if "time" not in mapping:
        message = f"has no column 'time', only {_shown(columns)}."
        guess = next((g for g in (proposal.used if proposal else ()) if g.role == "time"), None)
        if guess:
            message = f"'{guess.column}' may be the time, but {guess.why}."
        # A column of that name may hold what is no time.
        texts = [cell for cell in columns.values.get("time", ()) if isinstance(cell, str)]
        if texts:
            message = (
                f"column 'time' holds '{texts[0]:.40}', which is not read as a time or a date."
            )
            help_ = "Write it as 2024-03-14T09:26:00, or in seconds."
        problems.append(Problem(source, message, help_))
    elif len(mapping) < 2:
        problems.append(
            Problem(source, f"no column but time has a role: {_shown(columns)}.", help_)
        )
    raise_errors(problems)


_WHICH = 'Rename one, or name it in a channel file; the second is "NAME (2)".'


def _signals(columns, mapping, form, is_asked):
    """Values and unit of each channel, by role or connector, and remarks.

    A column in a wrong unit is an error where somebody asked for it or the navigation needs it; else it is not used.
    """
    problems = []
    signals = {}
    remarks = []
    for name, channel in mapping.items():
        try:
            values, unit, more = values_of(channel, name, columns, form)
            signals[name] = values, unit
            remarks += more
            problems += _beyond(f"{columns.source}, {name}", values)
        except ShipcosimError as error:
            if isinstance(error, WrongUnit) and not is_asked and name not in NAVIGATION:
                remarks.append(f"'{name}' is not used: {error.problems[0].found}")
                continue
            problems += [
                Problem(f"{columns.source}, {name}", p.found, p.remedy) for p in error.problems
            ]
    raise_errors(problems)
    return signals, remarks


def _beyond(where, values):
    """Problem of a number that is too large to be measured and would overflow."""
    # A check of the first such row is enough for a message.
    beyond = np.flatnonzero((np.abs(values) > LARGEST_NUMBER) & np.isfinite(values))
    remedy = "A missing value is an empty field or nan."
    return [Problem(where, f"is {values[row]:g} in row {row + 2}.", remedy) for row in beyond[:1]]


def _check_time(source, time):
    # Counts since 1970 in another unit, or times beyond any date, are errors of the unit.
    times = finite(time)
    if (epoch := epoch_unit(times)) not in (None, "s"):
        message = f"begins at {times[0]:.4g} s: are these {epoch} since 1970?"
        remedy = f'Say the unit in a channel file: time = {{column = "...", unit = "{epoch}"}}.'
        raise error_at(f"{source}, time", message, remedy)
    beyond = np.flatnonzero(np.isfinite(time) & (np.abs(time) > LATEST))
    if len(beyond):
        message = f"is {time[beyond[0]]:g} s in row {beyond[0] + 2}: is the unit right?"
        remedy = f"Times are at most {LATEST:g} s, the year 9999 counted from 1970."
        raise error_at(f"{source}, time", message, remedy)
    # What follows takes as many rows as an even series of this step has, so a wrong unit would fill the memory.
    step = usual_rise(times, np.inf)
    if step < SHORTEST_STEP:
        message = f"its rows are {step:.2g} s apart: is the unit right?"
        remedy = 'Say it in a channel file: time = {column = "...", unit = "s"}.'
        raise error_at(f"{source}, time", message, remedy)


def _check_restart(source, time, signals):
    """Raise where there is one time only, or the clock starts again: sorted, rows of two parts would be mixed."""
    rows = np.flatnonzero(np.isfinite(time))
    times = time[rows]
    if len(np.unique(times)) < 2:
        raise error_at(
            f"{source}, time", "has fewer than two different times.", "A log has many rows."
        )
    back = np.flatnonzero(np.diff(times) < -_RESTART * usual_rise(times, np.inf)) + 1
    if not len(back):
        return
    # Rows of different parts beside each other; the same row twice mixes nothing.
    part = np.searchsorted(back, np.arange(len(times)), side="right")
    order = np.argsort(times, kind="stable")
    is_mixed = np.diff(part[order]) != 0
    is_same = np.diff(times[order]) == 0.0
    for values in signals:
        cells = values[rows][order]
        is_same &= (cells[1:] == cells[:-1]) | ~np.isfinite(cells[1:] + cells[:-1])
    if np.sum(is_mixed & ~is_same) > _MOST_MIXED * (len(back) + 1):
        row = int(rows[back[0]])
        message = f"goes back from {times[back[0] - 1]:g} to {time[row]:g} s in row {row + 2}, over times that were there."
        remedy = "Cut the log there: rows of both parts would be mixed."
        raise error_at(f"{source}, time", message, remedy)


_RESTART = 10.0  # usual steps back that are no disorder of single rows. Assumed.
_MOST_MIXED = 10  # rows of another part beside each other where blocks of rows are only out of order. Assumed.


def _shown(columns):
    return shortened(map(repr, columns.values), 8)


def _meaning(name):
    role = role_of(name)
    return role.meaning if role else f"connector {name}"


def _over_the_earth(signals):
    """Turns speed and course, or velocities over the earth, into surge and sway; says so."""
    # Measured surge and sway have precedence.
    given = {name: signals.pop(name)[0] for name in OVER_EARTH if name in signals}
    if not given or ("surge" in signals and "sway" in signals):
        return []
    if "heading" not in signals:
        return [
            "Velocities over the earth are not used: they become surge and sway by a heading, and there is none."
        ]
    # Velocity as a complex number north + i east, from components or from speed and course.
    if {"north_velocity", "east_velocity"} <= set(given):
        velocity = given["north_velocity"] + 1j * given["east_velocity"]
        of = "velocities north and east"
    elif {"speed_over_ground", "course_over_ground"} <= set(given):
        speed = given["speed_over_ground"]
        velocity = speed * np.exp(1j * np.radians(given["course_over_ground"]))
        # At rest the course may be missing; the velocity is 0.
        velocity = np.where(speed == 0.0, 0.0, velocity)
        of = "speed and course over ground"
    else:
        return []
    # Turn into body axes.
    body = velocity * np.exp(-1j * np.radians(signals["heading"][0]))
    signals["surge"], signals["sway"] = (body.real, "m/s"), (body.imag, "m/s")
    return [f"Surge and sway come from {of} and the heading."]


def _local_position(source, signals, remarks):
    """Turn latitude and longitude into north and east in a plane about the first fix; say where that is."""
    degrees = {name: signals.pop(name)[0] for name in LARGEST}
    # Single impossible fixes are left out, but if most are impossible the unit is wrong.
    for name, values in degrees.items():
        limit = _FARTHEST[name]
        has_value = np.isfinite(values)
        beyond = np.abs(values) > limit
        if not has_value.any():
            raise error_at(
                f"{source}, {name}", "has no value in any row.", "Leave the channel out."
            )
        if beyond.sum() > 0.5 * has_value.sum():
            row = int(np.flatnonzero(beyond)[0])
            message = f"is {values[row]:g} in row {row + 2}, beyond {limit:g} deg, in {int(beyond.sum())} rows."
            remedy = 'A unit can be said: unit = "ddmm.mmmm", "rad" or "1e-7 deg".'
            raise error_at(f"{source}, {name}", message, remedy)
    # A receiver without a fix may report 0, 0. A log that is there throughout is kept.
    lost = np.any([np.abs(v) > _FARTHEST[n] for n, v in degrees.items()], axis=0)
    nowhere = (degrees["latitude"] == 0.0) & (degrees["longitude"] == 0.0)
    if nowhere.all():
        nowhere[:] = False
    for rows, why in (
        (lost, "a position beyond the earth"),
        (nowhere, "the position 0, 0, which is no fix"),
    ):
        if rows.any():
            remarks.append(f"{counted(rows.sum(), 'row')} with {why}: left empty.")
    values = [np.where(lost | nowhere, np.nan, degrees[name]) for name in LARGEST]
    # Local plane about the first fix; east by the length of a degree at its latitude.
    north, east, first = local_plane(*values)
    if not np.isfinite(east[first]):
        raise error_at(f"{source}, latitude", "has no row with a longitude.", "A fix needs both.")
    signals["north"] = north, "m"
    signals["east"] = east, "m"
    return {f"{name}_origin": float(of[first]) for name, of in zip(LARGEST, values, strict=True)}


def _without_value(source, signals):
    """Takes away channels without any value, and says so."""
    empty = [name for name, (values, _) in signals.items() if not np.isfinite(values).any()]
    if empty and len(empty) == len(signals):
        message = f"no row has a value of {shortened(empty, MOST_NAMED)}."
        raise error_at(source, message, "A log has numbers beside its times.")
    for name in empty:
        del signals[name]
    return [f"{name}: no row has a value, so it is not used." for name in empty]


def _proposal_text(proposal):
    """Remarks on columns with other names than their roles, and on unused columns with the reason."""
    used = proposal.channels()
    guesses = [guess for guess in proposal.used if guess.is_guess]
    sure = [guess for guess in proposal.used if not guess.is_guess]
    other = [
        f"{g.role} from '{g.column}'{_guess_text(g, used[g.role].unit)}"
        for g in sure
        if g.column != g.role or g.notes
    ]
    if other:
        yield f"Columns used: {'; '.join(other)}."
    for guess in guesses:
        yield f"Column '{guess.column}' is not used: it may be {guess.role}, but {guess.why}."
    if guesses:
        yield "To use it: `shipcosim channels LOG --out channels.toml`, and --channels channels.toml here."
    reasons = {}
    for guess in proposal.unused:
        if not _is_unnamed(guess.column):
            reasons.setdefault(guess.why, []).append(f"'{guess.column}'")
    for why, names in reasons.items():
        yield f"Column{'s' * (len(names) > 1)} not used: {shortened(names, MOST_NAMED)}: {why}."


def _not_named(unused):
    """Columns that a channel file does not name."""
    if unused:
        shown = shortened(unused, MOST_NAMED)
        yield f"Columns that the channel file does not name are not used: {shown}."


def _guess_text(guess, unit):
    unit = f" [{unit}]" if unit else ""
    return f"{unit}{' (' + '; '.join(guess.notes) + ')' if guess.notes else ''}"
