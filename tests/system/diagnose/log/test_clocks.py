"""Clocks that start anew, are put back or count something else than seconds are read on, or refused: never silently."""

from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from shipcosim.diagnose.log.reader import read_log
from shipcosim.errors import ShipcosimError

SECONDS = np.arange(0.0, 300.0, 0.5)


@pytest.fixture
def read(tmp_path):
    def of(name, texts, **more):
        columns = {name: texts} | more | {"heading": [f"{t / 10:.3f}" for t in SECONDS]}
        columns |= {"north": [f"{t:.2f}" for t in SECONDS], "east": ["0.0"] * len(SECONDS)}
        rows = [",".join(columns), *(",".join(row) for row in zip(*columns.values(), strict=True))]
        (tmp_path / "log.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        return read_log(tmp_path / "log.csv")

    return of


def passed(log):
    return log["time"].values - log["time"].values[0]


@pytest.mark.parametrize(("period", "name"), [(86400.0, "day"), (604800.0, "week")])
def test_seconds_of_a_day_or_week_go_on_past_its_end(read, period, name):
    log = read("time", [f"{(period - 150.0 + t) % period:.2f}" for t in SECONDS])
    assert passed(log) == pytest.approx(SECONDS, abs=1e-3)
    assert f"Seconds of the {name} pass its end" in " ".join(log.attrs["column_remarks"])


def test_a_recorder_that_was_started_again_is_no_midnight(read):
    with pytest.raises(ShipcosimError, match="goes back from 149.5 to 0 s .*Cut the log"):
        read("time", [f"{t if t < 150.0 else t - 150.0:.2f}" for t in SECONDS])


@pytest.mark.parametrize("shift", [0.0, 0.25, 40.0])
def test_rows_of_two_recordings_are_never_mixed(read, shift):
    times = [*SECONDS[:300], *(SECONDS[:300] + shift)]
    with pytest.raises(ShipcosimError, match="over times that were there"):
        read("time", [f"{t:.2f}" for t in times])


@pytest.mark.parametrize(("first", "last"), [(100, 120), (20, 60), (250, 300)])
def test_a_block_of_rows_out_of_order_is_sorted(read, first, last):
    order = [*range(first), *range(last, 600), *range(first, last)]
    log = read("time", [f"{SECONDS[row]:.2f}" for row in order])
    assert np.sort(log["time"].values) == pytest.approx(SECONDS)


def test_a_clock_that_is_put_back_by_an_hour_goes_on(read):
    moments = [datetime(2022, 10, 30, 2, 57, 30) + timedelta(seconds=float(t)) for t in SECONDS]
    local = [m - timedelta(hours=1) if m.hour >= 3 else m for m in moments]
    log = read("time", [m.strftime("%Y-%m-%d %H:%M:%S.%f") for m in local])
    assert passed(log) == pytest.approx(SECONDS, abs=1e-3)
    assert "put back by an hour" in " ".join(log.attrs["column_remarks"])


def _span(seconds, day, clock):
    whole = timedelta(seconds=float(seconds))
    return f"{day.format(whole.days)}{clock(whole.seconds, whole.microseconds)}"


SPANS = {
    "pandas": ("{} days +", lambda s, us: f"{s // 3600:02}:{s // 60 % 60:02}:{s % 60:02}.{us:06}"),
    "ISO 8601": ("P{}DT", lambda s, us: f"{s // 3600}H{s // 60 % 60}M{s % 60}.{us:06}S"),
}


@pytest.mark.parametrize("form", SPANS)
@pytest.mark.parametrize("start", [0.0, 86250.0, -150.0], ids=["0", "past a day", "before 0"])
def test_spans_of_time_are_seconds(read, form, start):
    log = read("time", [_span(start + t, *SPANS[form]) for t in SECONDS])
    assert log["time"].values == pytest.approx(start + SECONDS)


@pytest.mark.parametrize(
    "start", [738821.9, 0.5, 59879.2], ids=["MATLAB", "fraction of a day", "modified Julian"]
)
def test_days_without_a_unit_are_refused_with_what_to_write(read, start):
    with pytest.raises(ShipcosimError, match='are these days.*0.5 s apart.*unit = "d"'):
        read("time", [f"{start + t / 86400.0:.10f}" for t in SECONDS])


def test_milliseconds_without_a_unit_are_refused_with_what_to_write(read):
    with pytest.raises(ShipcosimError, match='are these milliseconds.*0.5 s apart.*unit = "ms"'):
        read("time", [f"{1000.0 * t:.0f}" for t in SECONDS])


@pytest.mark.parametrize(
    ("stated", "unit", "size"), [("", "ns", 1e9), ("", "us", 1e6), ("d", "s", 1)]
)
def test_rows_far_apart_are_refused_with_the_unit_that_fits(read, stated, unit, size):
    name = f"time [{stated}]" if stated else "time"
    with pytest.raises(ShipcosimError, match=f'0.5 s apart.*unit = "{unit}"'):
        read(name, [f"{size * t:.1f}" for t in SECONDS])


def test_a_stated_unit_is_believed(read):
    assert passed(read("time [ms]", [f"{1000.0 * t:.0f}" for t in SECONDS])) == pytest.approx(
        SECONDS
    )
    assert passed(read("time [d]", [f"{t / 86400.0:.10f}" for t in SECONDS])) == pytest.approx(
        SECONDS, abs=1e-4
    )
    assert passed(read("time [s]", [f"{1000.0 * t:.0f}" for t in SECONDS]))[-1] == pytest.approx(
        299500.0
    )


ZONES = ["Europe/London", "Europe/Oslo", "Atlantic/Azores", "America/St_Johns", "Australia/Sydney"]
CHANGES = ["2024-03-31T00:58:00", "2024-10-27T00:58:00", "2024-10-05T15:58:00"]


@settings(max_examples=25, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(some.sampled_from(ZONES), some.sampled_from(CHANGES), some.booleans(), some.booleans())
def test_no_row_is_lost_where_summer_time_comes_or_goes(read, zone, start, as_z, blank):
    first = datetime.fromisoformat(start).replace(tzinfo=ZoneInfo("UTC"))
    moments = [first + timedelta(seconds=float(t)) for t in SECONDS]
    texts = [m.astimezone(ZoneInfo(zone)).isoformat(timespec="milliseconds") for m in moments]
    texts = [text.replace("+00:00", "Z") if as_z else text for text in texts]
    log = read("time", [text.replace("T", " ") if blank else text for text in texts])
    assert len(log["time"]) == len(SECONDS)
    assert passed(log) == pytest.approx(SECONDS, abs=1e-3)


@settings(max_examples=30, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(some.sampled_from(["ms", "us", "ns"]), some.sampled_from(["s", "min", "h", "d", "week"]))
def test_counts_since_1970_in_a_column_of_a_larger_unit_are_refused(read, counted, stated):
    size = {"ms": 10**3, "us": 10**6, "ns": 10**9}[counted]
    with pytest.raises(ShipcosimError, match=r"is the unit right|since 1970\?"):
        read(f"time [{stated}]", [str(1_700_000_000 * size + int(t * size)) for t in SECONDS])
