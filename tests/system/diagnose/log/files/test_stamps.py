"""Clock times as numbers, fractions in a column of their own and summer time are read; UTC goes before local time."""

from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from diagnose.log.files.test_missing import EASY, MOTION, T, log_of, remarks
from hypothesis import given
from hypothesis import strategies as some

from shipcosim.errors import ShipcosimError


def passed(log):
    return log["time"].values - log["time"].values[0]


@EASY
@given(
    some.integers(0, 86399),
    some.sampled_from([0.5, 1.0, 2.0, 5.0]),
    some.sampled_from(["time", "Time", "Zeit", "TIME"]),
    some.sampled_from(["", ".00"]),
)
def test_clock_times_as_numbers_are_no_seconds(tmp_path, start, step, name, end):
    moments = [(start + step * i) % 86400.0 for i in range(len(T))]
    if step < 1.0 or end:
        texts = [f"{int(m // 3600):02d}{int(m // 60 % 60):02d}{m % 60:05.2f}" for m in moments]
    else:
        texts = [str(int(m // 3600 * 10000 + m // 60 % 60 * 100 + m % 60)) for m in moments]
    log = log_of(tmp_path, {name: texts} | MOTION)
    if max(float(text) for text in texts) - min(float(text) for text in texts) > 200.0:
        assert passed(log) == pytest.approx(step * T, abs=0.011)
        assert "are clock times: 123519 is 12:35:19" in remarks(log)


@EASY
@given(some.floats(0.0, 90000.0), some.sampled_from([0.1, 0.5, 1.0, 2.5, 10.0, 30.0]))
def test_seconds_are_no_clock_times(tmp_path, start, step):
    log = log_of(tmp_path, {"Time": [f"{start + step * t:.3f}" for t in T]} | MOTION)
    assert passed(log) == pytest.approx(step * T, abs=0.01)


@EASY
@given(
    some.sampled_from(["ms", "Msec", "Millisecond", "milliseconds"]),
    some.sampled_from(["%d.%m.%Y %H:%M:%S", "%H:%M:%S", "%Y-%m-%dT%H:%M:%S"]),
    some.sampled_from([0.1, 0.25, 0.5]),
    some.integers(0, 999),
)
def test_fractions_of_a_second_in_a_column_of_their_own_are_read(
    tmp_path, name, form, step, offset
):
    moments = [
        datetime(2024, 5, 31, 9, 59) + timedelta(milliseconds=offset + 1000 * step * t) for t in T
    ]
    columns = {"Date": ["31.05.2024"] * len(T)} if form == "%H:%M:%S" else {}
    columns |= {"Clock": [m.strftime(form) for m in moments]}
    log = log_of(tmp_path, columns | {name: [str(m.microsecond // 1000) for m in moments]} | MOTION)
    assert passed(log) == pytest.approx(step * T, abs=2e-3)


SUMMER = [
    ("Europe/Oslo", datetime(2024, 3, 31, 1)),
    ("Europe/London", datetime(2025, 3, 30, 1)),
    ("America/New_York", datetime(2024, 3, 10, 7)),
    ("Australia/Sydney", datetime(2024, 10, 5, 16)),
]
FORMS = ["%Y-%m-%d %H:%M:%S", "%d.%m.%Y %H:%M:%S", "%Y-%m-%dT%H:%M:%S.%f", "%d/%m/%Y %H:%M:%S"]


def local(zone, at, before, form, step=1.0):
    """Stamps of a clock that is put on `before` seconds after they begin, and of UTC."""
    start = at.replace(tzinfo=UTC) - timedelta(seconds=before)
    moments = [start + timedelta(seconds=step * t) for t in T]
    return [m.astimezone(ZoneInfo(zone)).strftime(form) for m in moments], [
        m.strftime(form) for m in moments
    ]


@pytest.mark.parametrize(("zone", "at"), SUMMER)
@pytest.mark.parametrize("form", FORMS)
def test_the_hour_that_summer_time_leaves_out_is_no_gap(tmp_path, zone, at, form):
    stamps, utc = local(zone, at, 100, form)
    log = log_of(tmp_path, {"Local Time": stamps} | MOTION)
    assert passed(log) == pytest.approx(T)
    assert "put on by an hour" in remarks(log)
    both = log_of(tmp_path, {"Local Time": stamps, "UTC": utc} | MOTION)
    assert passed(both) == pytest.approx(T)
    assert "time from 'UTC'" in remarks(both)


@pytest.mark.parametrize(
    ("day", "hour", "zone"),
    [
        ("2024-04-01", 1, ""),
        ("2024-03-31", 9, ""),
        ("2024-03-31", 1, "Z"),
        ("2024-03-31", 1, "+02:00"),
    ],
)
def test_any_other_hour_that_is_missing_is_one(tmp_path, day, hour, zone):
    seconds = np.where(T < 100.0, T, T + 3600.0)
    start = datetime.fromisoformat(f"{day} {hour:02d}:58:20")
    stamps = [(start + timedelta(seconds=s)).isoformat() + zone for s in seconds]
    assert passed(log_of(tmp_path, {"time": stamps} | MOTION)) == pytest.approx(seconds)


@pytest.mark.parametrize("has_date", [True, False])
@pytest.mark.parametrize("start", [datetime(2024, 5, 31, 23, 57, 30), datetime(2024, 5, 3, 4, 5)])
def test_clock_times_with_dots_are_read(tmp_path, start, has_date):
    moments = [start + timedelta(seconds=t) for t in T]
    columns = {"Dato": [m.strftime("%d.%m.%y") for m in moments]} if has_date else {}
    columns |= {"Kl": [m.strftime("%H.%M.%S") for m in moments]}
    assert passed(log_of(tmp_path, columns | MOTION)) == pytest.approx(T)


def test_a_date_with_dots_is_no_clock_time(tmp_path):
    days = [f"{10 + int(t // 100):02d}.11.12" for t in T]
    with pytest.raises(ShipcosimError, match="time"):
        log_of(tmp_path, {"Dato": days} | MOTION)
