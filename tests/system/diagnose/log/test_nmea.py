"""Raw sentences of NMEA 0183: what a voyage is written as is read back, and what is damaged is left out and said."""

import functools
import json
import operator

import numpy as np
import pytest

from shipcosim.diagnose.log.files.nmea import holds_sentences
from shipcosim.diagnose.log.reader import read_log
from shipcosim.errors import ShipcosimError

SECONDS = np.arange(0.0, 60.0)
LATITUDE, LONGITUDE = 63.44, 10.35  # deg, of the first fix
START = 23 * 3600 + 59 * 60 + 40  # s after midnight: 20 s before the next day
DATE = 27  # of October 2022


def sentence(*fields, wrong=False):
    body = ",".join(map(str, fields))
    total = functools.reduce(operator.xor, body.encode()) ^ wrong
    return f"${body}*{total:02X}"


def stamp(t, start=START):
    day, seconds = divmod(start + t, 86400.0)
    clock = f"{int(seconds // 3600):02d}{int(seconds % 3600 // 60):02d}{seconds % 60:05.2f}"
    return clock, f"{DATE + int(day):02d}1022"


def minutes(degrees, width):
    whole, rest = divmod(abs(degrees), 1.0)
    return f"{int(whole):0{width}d}{60.0 * rest:08.5f}"


def truth(t):
    """Eastwards at 2 m/s, turning slowly through north."""
    heading = (355.0 + 0.2 * t) % 360.0
    return {"longitude": LONGITUDE + 2.0 * t / 49850.0, "heading": heading, "wind": 30.0 + t / 10.0}


def gga(t, talker="GP", quality=1, latitude=LATITUDE, sides="NE", start=START):
    position = minutes(latitude, 2), sides[0], minutes(truth(t)["longitude"], 3), sides[1]
    return sentence(
        f"{talker}GGA", stamp(t, start)[0], *position, quality, 9, 0.8, 12.0, "M", 40.0, "M", "", ""
    )


def rmc(t, status="A", start=START):
    clock, date = stamp(t, start)
    position = minutes(LATITUDE, 2), "N", minutes(truth(t)["longitude"], 3), "E"
    return sentence(
        "GPRMC", clock, status, *position, f"{2.0 * 3600 / 1852:.4f}", "90.0", date, "", "", "A"
    )


def others(t):
    now = truth(t)
    yield sentence("HEHDT", f"{now['heading']:.2f}", "T")
    yield sentence("TIROT", f"{12.0:.1f}", "A")
    yield sentence("WIMWV", f"{now['wind']:.1f}", "R", "10.0", "N", "A")
    yield sentence("WIMWV", "211.0", "T", "9.0", "N", "A")


def voyage(fix=lambda t: [gga(t), rmc(t)]):
    return [line for t in SECONDS for line in (*fix(t), *others(t))]


@pytest.fixture
def read(tmp_path):
    def of(lines, name="bridge.nmea"):
        path = tmp_path / name
        path.write_text("\r\n".join(lines) + "\r\n", encoding="latin-1")
        return read_log(path)

    return of


def said(log):
    return " ".join(log.attrs["column_remarks"])


def test_a_voyage_past_midnight_is_read_back(read):
    log = read(voyage())
    time = log["time"].values
    assert len(time) >= len(SECONDS) - 1 and np.ptp(time) == pytest.approx(59.0, abs=1.0)
    t = time - START
    assert np.abs((log["heading"].values - truth(t)["heading"] + 180.0) % 360.0 - 180.0).max() < 0.3
    assert np.diff(log["east"].values) / np.diff(time) == pytest.approx(2.0, rel=0.02)
    assert log["yaw_rate"].values[5] == pytest.approx(0.2) and log["wind_speed"].values[
        5
    ] == pytest.approx(5.144, rel=1e-3)
    assert log["wind_from"].values == pytest.approx(truth(t)["wind"], abs=0.2)
    surge, sway = log["surge"].values[5], log["sway"].values[5]  # heading about 356, course 90
    assert (surge, sway) == pytest.approx((-0.14, 2.0), abs=0.05)
    assert "Clock times pass midnight 1 time" in said(log) and "heading from HEHDT" in said(log)
    assert "60 MWV without a valid wind relative to the ship left out" in said(log)


def test_damaged_sentences_are_left_out_and_counted(read):
    lines = voyage()
    lines[30] = (
        lines[30].replace(",T*", ",9T*")
        if "HDT" in lines[30]
        else lines[30][:12] + "9" + lines[30][13:]
    )
    lines[48] = sentence("HEHDT", "123.4", "T", wrong=True)
    log = read(lines)
    assert "2 sentences with a wrong checksum or form, the first in line 31" in said(log)
    assert not (np.abs(log["heading"].values - 123.4) < 1.0).any()


def test_a_file_of_damaged_sentences_is_refused(read):
    lines = [line if k % 3 else line[:-2] + "00" for k, line in enumerate(voyage())]
    with pytest.raises(ShipcosimError, match="do not fit their checksum"):
        read(lines)


def test_sentences_without_a_checksum_are_read(read):
    assert read([line.partition("*")[0] for line in voyage()]).sizes["time"] > 50


def test_the_fuller_of_two_receivers_is_read_and_that_is_said(read):
    far = lambda t: [gga(t, "GN", latitude=10.0)] if t % 2 == 0 else []  # noqa: E731
    log = read(voyage(lambda t: [gga(t), *far(t)]))
    assert log.attrs["latitude_origin"] == pytest.approx(LATITUDE, abs=1e-4)
    assert "latitude, longitude from GPGGA (not GNGGA)" in said(log)


@pytest.mark.parametrize("talker", ["GN", "II", "IN", "GL"])
def test_any_talker_is_read(read, talker):
    assert f"from {talker}GGA" in said(read(voyage(lambda t: [gga(t, talker)])))


def test_southern_and_western_positions_are_negative(read):
    log = read(voyage(lambda t: [gga(t, latitude=33.5, sides="SW")]))
    assert log.attrs["latitude_origin"] == pytest.approx(-33.5, abs=1e-5)
    assert log.attrs["longitude_origin"] == pytest.approx(-LONGITUDE, abs=1e-3)


def test_a_position_without_a_fix_is_none(read):
    lost = lambda t: [gga(t, quality=0 if 20 <= t < 40 else 1)]  # noqa: E731
    east = read(voyage(lost))["east"].values
    assert 15 <= np.isnan(east).sum() <= 25
    lost = lambda t: [rmc(t, status="V" if 20 <= t < 40 else "A")]  # noqa: E731
    assert 15 <= np.isnan(read(voyage(lost))["east"].values).sum() <= 25


def test_a_receiver_that_has_no_time_yet_is_no_damage(read):
    cold = [
        sentence("GPGGA", *[""] * 5, 0, *[""] * 8),
        sentence("GPRMC", "", "V", *[""] * 7, "", "", "N"),
    ]
    log = read([*cold, *cold, *voyage()])
    assert "not fit checksum" not in said(log) and log.sizes["time"] > 50


def test_dates_tell_of_days_without_a_sentence(read):
    morning = 9 * 3600.0
    lines = [
        line
        for t in SECONDS[:20]
        for line in (gga(t, start=morning), rmc(t, start=morning), *others(t))
    ]
    later = morning + 2 * 86400.0 - 1800.0  # two days on, half an hour earlier
    lines += [
        line
        for t in SECONDS[:20]
        for line in (gga(t, start=later), rmc(t, start=later), *others(t))
    ]
    log = read(lines)
    assert np.ptp(log["time"].values) == pytest.approx(2 * 86400.0 - 1800.0 + 19.0, abs=2.0)
    assert (np.diff(log["time"].values) > 0.0).all() and "2 whole days more" in said(log)


@pytest.mark.parametrize("form", ["{:.3f} ", "2022-10-27T12:{m:02d}:{s:06.3f}Z,", "{:.3f};"])
def test_a_time_before_each_sentence_is_its_time(read, form):
    lines = [
        form.format(1000.0 + t, m=int(t // 60), s=t % 60) + line
        for t in SECONDS
        for line in (gga(t), *others(t))
    ]
    log = read(lines)
    assert np.ptp(log["time"].values) == pytest.approx(
        59.0
    ) and "stand before the sentences" in said(log)
    assert log["heading"].values[0] == pytest.approx(355.0)


SINCE_1970 = 1666914000  # s, of the first sentence
WRAPPED = {
    "lines of JSON": lambda t, line: json.dumps({"at": iso(t), "channel": "eth1", "raw": line}),
    "interface": lambda t, line: f"{iso(t)} [eth1] {line}",
    "TAG block": lambda t, line: f"\\s:GP0001,c:{SINCE_1970 + t:.0f}*5A\\{line}",
    "milliseconds": lambda t, line: f"{1000 * (SINCE_1970 + t):.0f} {line}",
}
"""How recorders wrap a sentence that was received at a time."""


def iso(t):
    return (np.datetime64(SINCE_1970, "s") + np.timedelta64(int(t), "s")).item().isoformat() + "Z"


@pytest.mark.parametrize("form", WRAPPED)
def test_sentences_in_the_records_of_a_recorder_have_its_times(read, form):
    received = [(t, line) for t in SECONDS for line in (gga(t), rmc(t), *others(t))]
    log = read([WRAPPED[form](t, line) for t, line in received], "bridge.log")
    assert "Times are those that stand before the sentences." in said(log)
    time = log["time"].values
    assert np.diff(time) == pytest.approx(1.0) and len(time) == len(SECONDS)
    t = time - time[0]
    assert np.abs((log["heading"].values - truth(t)["heading"] + 180.0) % 360.0 - 180.0).max() < 0.1


def test_a_list_of_records_may_have_the_time_behind_the_sentence(read):
    received = [(t, line) for t in SECONDS for line in (rmc(t), *others(t))]
    log = read([json.dumps([{"raw": line, "meta": {"at": iso(t)}} for t, line in received])])
    assert "Times are those that stand before" in said(log) and log.sizes["time"] == len(SECONDS)


def test_reports_of_gpsd_give_speed_and_course_over_ground(read):
    """Position and heading come in reports of their own."""
    lines = [json.dumps({"class": "VERSION", "release": "3.25"})]
    for t in SECONDS:
        now = truth(t)
        fix = {"lat": LATITUDE, "lon": now["longitude"], "track": 90.0, "speed": 2.0}
        lines.append(json.dumps({"class": "TPV", "mode": 3, "time": iso(t)} | fix))
        lines.append(json.dumps({"class": "SKY", "time": iso(t), "hdop": 0.9}))
        heading = {"heading": now["heading"]}
        lines.append(json.dumps({"class": "ATT", "time": iso(t)} | heading))
    log = read(lines, "gpsd.json")
    surge, sway = log["surge"].values[5], log["sway"].values[5]  # heading about 356, course 90
    assert (surge, sway) == pytest.approx((-0.14, 2.0), abs=0.05)
    assert np.isfinite(log["surge"].values).all() and log.sizes["time"] == len(SECONDS)


def test_units_of_wind_are_those_of_the_sentence(read):
    for unit, size in (("K", 10.0 / 3.6), ("M", 10.0), ("S", 4.4704)):
        wind = lambda t, unit=unit: [gga(t), sentence("WIMWV", "30.0", "R", "10.0", unit, "A")]  # noqa: E731
        lines = [line for t in SECONDS for line in (*wind(t), sentence("HEHDT", "10.0", "T"))]
        assert read(lines)["wind_speed"].values[3] == pytest.approx(size)


def test_speed_and_course_of_vtg_are_of_the_fix_before_it(read):
    def fix(t):
        yield gga(t)
        yield sentence("GPVTG", "90.0", "T", "", "M", f"{t / 10.0:.2f}", "N", "", "K", "A")

    log = read(voyage(fix))
    t = log["time"].values - START
    assert log["sway"].values[5:50] == pytest.approx(t[5:50] / 10.0 * 1852 / 3600, abs=0.03)


def test_what_is_not_read_is_counted(read):
    lines = [
        *voyage(),
        sentence("GPGSV", 1, 1, "00"),
        sentence("PSIMSNS", "1"),
        "!AIVDM,1,1,,A,15M,0",
        "-- stop --",
    ]
    log = read(lines)
    assert "Sentences not read: AIVDM (1), GPGSV (1), PSIMSNS (1)" in said(log)
    assert "1 line without a sentence, the first in line 364: left out." in said(log)


def test_sentences_without_any_time_are_refused_with_what_would_do(read):
    with pytest.raises(ShipcosimError, match="says the time.*time of reception"):
        read([sentence("HEHDT", f"{t:.1f}", "T") for t in range(30)])


def test_sentences_that_give_no_channel_are_refused(read):
    with pytest.raises(ShipcosimError, match="none gives a channel"):
        read([sentence("GPZDA", stamp(t)[0], "27", "10", "2022", "00", "00") for t in range(30)])


def test_a_table_is_no_file_of_sentences():
    assert not holds_sentences(["time [s],heading [deg]", "0,1", "1,2"])
    assert not holds_sentences([])
