"""Times as people and machines write them, as seconds: dates in many orders, clock times past midnight, epochs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import datetime
from functools import cache
from itertools import product, takewhile
from typing import Any

import numpy as np

from shipcosim.diagnose.numerics import finite
from shipcosim.dialects import seconds_of_spans
from shipcosim.errors import counted, error_at

EPOCHS = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_SINCE = 3e8  # s after 1970 that a log can be from: 1979 to 2103
_UNTIL = 4.2e9
DAY = 86400.0
_DATES = {
    "ymd": "%Y-%m-%d|%Y/%m/%d|%Y.%m.%d|%Y%m%d|%Y:%m:%d|%y-%m-%d|%y/%m/%d|%y%m%d|%Y %m %d",
    "dmy": "%d/%m/%Y|%d-%m-%Y|%d.%m.%Y|%d/%m/%y|%d-%m-%y|%d.%m.%y|%d-%b-%Y|%d %b %Y|%d-%b-%y|%d/%b/%Y|%d %B %Y|"
    "%d. %b %Y|%a %d %b %Y|%d%m%Y|%d%m%y",
    "mdy": "%m/%d/%Y|%m-%d-%Y|%m/%d/%y|%m-%d-%y|%b %d %Y|%b %d, %Y|%B %d, %Y|%a %b %d %Y",
}
_CLOCKS = "%H:%M:%S.%f|%H:%M:%S|%H:%M|%I:%M:%S.%f %p|%I:%M:%S %p|%I:%M %p|%H%M%S.%f|%H%M%S".split(
    "|"
)
_BETWEEN = (" ", "T", "_", ", ", ",", "-", "  ")
_ZONE = re.compile(r"\s*(?:Z|UTC|GMT|[+-]00:?00)$", re.IGNORECASE)
_HOURS = (
    "WET+00 WEST+01 BST+01 CET+01 CEST+02 MEZ+01 MESZ+02 EET+02 EEST+03 JST+09 AEST+10 AEDT+11 EST-05 EDT-04 CDT-05 "
    "MDT-06 PST-08 PDT-07"
)
_ZONES = {zone[:-3]: f"{zone[-3:]}:00" for zone in _HOURS.split()}
"""Zones with one meaning; CST, MST and IST have several."""
_NAMED_ZONE = re.compile(rf"(?<=:\d\d)(?P<fraction>[.,]\d+)?\s*(?P<zone>{'|'.join(_ZONES)})$")
_OTHER_ZONE = re.compile(r"(?<=:\d\d)(?P<fraction>\.\d+)?\s*(?P<zone>[+-]\d\d:?\d\d)$")
_ONE_COLON = re.compile(r"^(?P<minutes>\d{1,3}):(?P<seconds>[0-5]?\d)(?P<fraction>\.\d+)?$")
_COLON_FRACTION = re.compile(r"^(?P<clock>.*\d\d:\d\d:\d\d):(?P<fraction>\d{1,9})$")
_DOTS = re.compile(r"^([^:]*\d[ T])?([012]?\d)\.([0-5]\d)\.([0-5]\d)(?=$|[.,]\d+$)")
_WORD = re.compile(r"[A-Za-z0-9]+")
_NAMES = {"dmy": "day/month/year", "mdy": "month/day/year", "ymd": "year/month/day"}


def epoch_unit(values: np.ndarray) -> str | None:
    """Unit of numbers that can only be a time since 1970; None for others.

    Examples
    --------
    >>> epoch_unit(np.array([1.7110e18, 1.7111e18])), epoch_unit(np.array([1711107166.2])), epoch_unit(np.arange(9.0))
    ('ns', 's', None)
    """
    numbers = finite(values)
    if not len(numbers):
        return None
    # Quantiles rather than extremes, as single stamps may be damaged.
    first, last = np.quantile(numbers, [0.02, 0.98])
    return next(
        (unit for unit, size in EPOCHS.items() if _SINCE < first / size and last / size < _UNTIL),
        None,
    )


def seconds_of(
    texts: np.ndarray, order: str | None = None, unit: str = ""
) -> tuple[np.ndarray, list[str]] | None:
    """Stamps of date and time, of time alone, or spans of time, as seconds; None where the texts are others.

    Parameters
    ----------
    texts : (n,) array of str or None
        The stamps.
    order : str, optional
        ``"dmy"``, ``"mdy"`` or ``"ymd"``.
    unit : str, optional
        ``"hh:mm"`` or ``"mm:ss"`` of stamps with one colon.

    Returns
    -------
    (n,) array and list of str
        Seconds, and remarks for the user. Dates count from the first; clock times that pass midnight go on; NaN where
        there is no stamp.

    Raises
    ------
    ShipcosimError
        If day and month can be exchanged, and that makes a difference.
    """
    import pandas

    # Bring all stamps to one form, without their time zone.
    cells, zone = _uniform(pandas.Series(texts, dtype="object"))
    stamps = cells.dropna()
    if not len(stamps):
        return None
    if zone is not None:
        cells = cells.astype("object")
    if (short := _minutes_and_seconds(cells, unit)) is not None:
        return short
    # Clock times without a date.
    for clock in _CLOCKS:
        if _fits(stamps, clock):
            parsed = pandas.to_datetime(
                "2000-01-01 " + cells, format=f"%Y-%m-%d {clock}", errors="coerce"
            )
            if _whole(parsed, cells):
                return seconds_of_clock(_since_first(parsed, "2000-01-01"))
    if (spans := seconds_of_spans(cells)) is not None:
        return spans, []
    # Try every form of date and clock; day and month can give two readings.
    readings = {}
    for key, dates in _DATES.items():
        for date, (between, clock) in product(dates.split("|"), product(_BETWEEN, _CLOCKS)):
            form = f"{date}{between}{clock}"
            if key not in readings and (order or key) == key and _fits(stamps, form):
                parsed = pandas.to_datetime(cells, format=form, errors="coerce")
                if _whole(parsed, cells):
                    readings[key] = _since_first(parsed)
    if not readings and order is None:
        return _other_stamps(cells)
    if not readings:
        return None
    # Decide between the readings, then subtract the zones.
    times, remarks = _decided(readings, str(stamps.iloc[0]))
    if zone is not None:
        times = times - zone
        times = times - finite(times)[0]
    return times, remarks


def is_clock_number(numbers: np.ndarray) -> bool:
    """Whether numbers can be hhmmss and not seconds, because minutes and seconds stay below 60.

    Fractions of days run slower than any clock: their steps are below a millisecond.
    """
    whole = np.floor(numbers)
    inside = numbers.min() >= 0.0 and numbers.max() < 240000.0
    return bool(
        inside
        and (whole % 100 < 60).all()
        and (whole // 100 % 100 < 60).all()
        and numbers.max() > 100.0
        and float(np.ptp(numbers)) >= 1e-3 * (len(numbers) - 1)
    )


def seconds_of_parts(columns: Mapping[str, np.ndarray]) -> tuple[list[str], np.ndarray] | None:
    """Times of which year, month, day, hour, and perhaps minute and second stand in columns beside each other.

    Parameters
    ----------
    columns : mapping of str to (n,) array
        In their order.

    Returns
    -------
    list of str and (n,) array, or None
        The columns, and seconds since 1970.
    """
    import pandas

    names = list(columns)
    for start in range(len(names)):
        neighbours = zip(names[start:], _PARTS.items(), strict=False)
        parts = dict(
            takewhile(
                lambda pair: pair[0].lower().removesuffix(" (2)") in pair[1][1].split(), neighbours
            )
        )
        if len(parts) < 4 or any(columns[name].dtype.kind != "f" for name in parts):
            continue
        numbers = {part: columns[name] for name, (part, _) in parts.items()}
        numbers["year"] = numbers["year"] + np.where(numbers["year"] < 100.0, 2000.0, 0.0)
        stamps = pandas.to_datetime(pandas.DataFrame(numbers), errors="coerce")
        seconds = (stamps - pandas.Timestamp(1970, 1, 1)).dt.total_seconds()
        if seconds.notna().any():
            return list(parts), seconds.to_numpy(float)
    return None


_PARTS = {
    "year": "yy yyyy yr year år jahr",
    "month": "mm mo month måned monat",
    "day": "dd dy day dag tag",
    "hour": "hh hr hour stunde",
    "minute": "mm mn mi min minute minutt",
    "second": "ss sc sec second sekund sekunde",
}
"""Names of columns that hold parts of a time, in their order."""


@cache
def _marks_of(form: str) -> str:
    """Separators between letters and digits of time stamps of one form."""
    return _WORD.sub("", datetime(2022, 10, 27, 23, 57, 30).strftime(form))


def _fits(stamps, form):
    """Whether the first and the last of the stamps have this form."""
    if _WORD.sub("", stamps.iloc[0]) != _marks_of(form):
        # Compare the separators first, which is fast, then parse the first and last stamp.
        return False
    try:
        for cell in (stamps.iloc[0], stamps.iloc[-1]):
            datetime.strptime(re.sub(r"(\.\d{6})\d+", r"\1", cell), form)
    except (ValueError, TypeError):
        return False
    return True


def _whole(parsed, cells):
    """Whether nearly all cells were read."""
    return int(parsed.notna().sum()) >= 0.99 * int(cells.notna().sum())


def _uniform(cells) -> tuple[Any, np.ndarray | None]:
    """Stamps without their zone, with a point before the fraction everywhere or nowhere; what zones are ahead. [s]"""
    texts = cells.where(cells.notna(), None).astype("str").str.strip().where(cells.notna())
    texts = texts.str.replace(
        _NAMED_ZONE, lambda match: (match["fraction"] or "") + _ZONES[match["zone"]], regex=True
    )
    texts = texts.str.replace(_DOTS, r"\1\2:\3:\4", regex=True)
    is_utc = texts.str.contains(_ZONE, na=False)
    texts = texts.str.replace(_ZONE, "", regex=True)
    ahead = None
    # Offset of the time zone, east positive. Summer time may come and go: stamps of UTC stand beside others.
    zones = texts.str.extract(_OTHER_ZONE)["zone"].str.replace(":", "")
    if zones.notna().any():
        sign = np.where(zones.str.startswith("-", na=False), -1.0, 1.0)
        seconds = zones.str[1:3].astype(float) * 3600 + zones.str[3:5].astype(float) * 60
        ahead = (sign * seconds).mask(is_utc, 0.0).to_numpy(float)
        texts = texts.str.replace(_OTHER_ZONE, lambda match: match["fraction"] or "", regex=True)
    first = texts.dropna().iloc[0] if texts.notna().any() else ""
    if _COLON_FRACTION.match(first):
        texts = _with_point(texts)
    # Point as decimal sign, and a fraction in all stamps if any has one.
    texts = texts.str.replace(r"(:\d\d),(\d+)", r"\1.\2", regex=True)
    has_point = texts.str.contains(r":\d\d\.\d+|\d{6}\.\d+", regex=True, na=False)
    if has_point.any() and not has_point.all():
        bare = ~has_point & texts.notna()
        texts = texts.where(
            ~bare,
            texts.str.replace(r"(:\d\d)(?!:|\d)", r"\1.0", n=1, regex=True)
            if first.count(":")
            else texts + ".0",
        )
        texts = texts.str.replace(r"(:\d\d)\.0(:\d\d)", r"\1\2.0", regex=True)
    texts = texts.str.replace(
        r"\s*([AaPp])\.?[Mm]\.?$", lambda match: f" {match[1].upper()}M", regex=True
    )
    return texts, ahead


def _with_point(texts):
    """Stamps with a colon before the fraction. Fractions of many lengths are whole micro- or milliseconds."""
    parts = texts.str.extract(_COLON_FRACTION)
    lengths = parts["fraction"].str.len()
    longest = int(lengths.max())
    if (
        lengths.nunique() > 1
        and longest in (3, 6)
        and not parts["fraction"].str.match(r"0\d+").any()
    ):
        parts["fraction"] = parts["fraction"].str.zfill(longest)
    return (parts["clock"] + "." + parts["fraction"]).where(parts["clock"].notna(), texts)


def _minutes_and_seconds(cells, unit):
    """Stamps such as 59:59.5 as seconds, going on past the hour; None for others."""
    parts = cells.str.extract(_ONE_COLON)
    # All stamps must have exactly one colon.
    if parts["minutes"].isna().any() and (parts["minutes"].isna() & cells.notna()).any():
        return None
    has_fraction = parts["fraction"].notna().any()
    minutes = parts["minutes"].astype(float)
    seconds = parts["seconds"].astype(float)
    if unit == "hh:mm" or not minutes.notna().any():
        return None
    # Below 24 without a fraction it may be hours and minutes: ask.
    if not has_fraction and unit != "mm:ss" and minutes.max() < 24:
        message = f"'{cells.dropna().iloc[0]}' can be hours and minutes or minutes and seconds."
        remedy = 'Say which as its unit in a channel file: time = {column = "...", unit = "mm:ss"}, or "hh:mm".'
        raise error_at("", message, remedy)
    fraction = ("0" + parts["fraction"].fillna("")).astype(float)
    return seconds_of_clock((60.0 * minutes + seconds + fraction).to_numpy(float), 3600.0)


def _since_first(parsed, start=None):
    """Seconds of parsed stamps after a date, or after the first of them."""
    import pandas

    stamps = parsed.to_numpy().astype("datetime64[ns]")
    valid = stamps[~np.isnat(stamps)]
    base = np.datetime64(start, "ns") if start else valid[0]
    seconds = (stamps - base) / np.timedelta64(1, "s")
    return np.where(pandas.isna(parsed), np.nan, seconds)


def _other_stamps(cells):
    """What pandas knows as ISO 8601."""
    import pandas

    parsed = pandas.to_datetime(cells, format="ISO8601", errors="coerce", utc=True)
    if not _whole(parsed, cells):
        return None
    return _since_first(parsed.dt.tz_localize(None)), []


def _decided(readings: dict[str, np.ndarray], shown: str) -> tuple[np.ndarray, list[str]]:
    """The reading of dates that holds: the only one, one of several that are alike, or the one without leaps."""
    orders = list(readings)
    first = readings[orders[0]]
    if all(np.allclose(readings[order], first, equal_nan=True) for order in orders[1:]):
        names = " or ".join(_NAMES[order] for order in orders)
        message = f"Dates such as '{shown}' can be {names}: the same for times within the log."
        return first, [message] if len(orders) > 1 else []
    # With the wrong order of day and month the log leaps by weeks.
    leaps = {order: _largest_step(values) for order, values in readings.items()}
    smooth = [order for order, leap in leaps.items() if leap < 20 * DAY]
    if len(smooth) == 1 and len(orders) > 1:
        return readings[smooth[0]], [
            f"Dates such as '{shown}' are {_NAMES[smooth[0]]}, else the log would leap."
        ]
    if len(orders) == 1:
        return first, []
    both = " or ".join(
        f"{_NAMES[order]} (lasting {np.nanmax(v) - np.nanmin(v):g} s)"
        for order, v in readings.items()
    )
    remedy = f'Say which in a channel file: file = {{dates = "{orders[0]}"}}.'
    raise error_at("", f"dates such as '{shown}' can be {both}.", remedy)


def _largest_step(values):
    numbers = finite(values)
    return float(np.abs(np.diff(numbers)).max()) if len(numbers) > 1 else 0.0


def seconds_of_clock(seconds: np.ndarray, period: float = DAY) -> tuple[np.ndarray, list[str]]:
    """Times of day that go on past midnight, and remarks.

    Parameters
    ----------
    seconds : (n,) array
        After midnight, or after the full hour. [s]
    period : float
        A day or an hour. [s]

    Examples
    --------
    >>> seconds_of_clock(np.array([86398.0, 86399.0, 0.0, 1.0]))[0].tolist()
    [86398.0, 86399.0, 86400.0, 86401.0]
    """
    # A fall by more than half a period is a passage of its end, a rise as large a row out of order.
    valid = np.flatnonzero(np.isfinite(seconds))
    steps = np.diff(seconds[valid])
    days = np.cumsum((steps < -0.5 * period).astype(float) - (steps > 0.5 * period))
    times = seconds.copy()
    times[valid[1:]] += period * days
    passed = int(days[-1]) if len(days) else 0
    turn = "midnight" if period == DAY else "the hour"
    return times, [
        f"Clock times pass {turn} {counted(passed, 'time')}: they go on."
    ] if passed else []
