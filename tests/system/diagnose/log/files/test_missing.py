"""Numbers that stand for no value, rows that a flag calls bad and impossible directions are left out, and that is said."""

import numpy as np
import pytest
from diagnose.log.oddities import save
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from shipcosim.diagnose.log.files.cells import without_fillers
from shipcosim.diagnose.log.files.missing import dropouts
from shipcosim.diagnose.log.reader import read_log
from shipcosim.errors import ShipcosimError

T = np.arange(300.0)
MOTION = {
    "heading": 40.0 + 30.0 * np.sin(T / 40.0),
    "north": 9.0 * np.sin(T / 60.0),
    "east": 0.1 * T,
}
FILLERS = [
    "-9999",
    "-999.9",
    "99999.9",
    "-8888",
    "1e30",
    "-999.25",
    "-3.4028235e38",
    "65535",
    "-32768",
    "2147483647",
]
EASY = settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


def log_of(folder, columns, separator=","):
    texts = {
        name: [v if isinstance(v, str) else f"{v:.5f}" for v in cells]
        for name, cells in columns.items()
    }
    rows = [
        separator.join(texts),
        *(separator.join(row) for row in zip(*texts.values(), strict=True)),
    ]
    return read_log(save(folder, rows))


def remarks(log):
    return " ".join(log.attrs["column_remarks"])


@EASY
@given(
    some.sampled_from(FILLERS),
    some.sampled_from(sorted(MOTION)),
    some.integers(1, 200),
    some.integers(1, 90),
    some.floats(0.1, 3.0),
)
def test_a_number_that_means_no_value_is_left_out(tmp_path, filler, role, first, count, size):
    # Positions stay away from the filler; a heading keeps its size.
    motion = {name: v * (1.0 if name == "heading" else size) for name, v in MOTION.items()}
    cells = [f"{v:.5f}" for v in motion[role]]
    cells[first : first + count] = [filler] * count
    log = log_of(tmp_path, {"time": T} | motion | {role: cells})
    is_lost = np.isnan(log[role].values)
    assert np.flatnonzero(is_lost).tolist() == list(range(first, first + count))
    assert log[role].values[~is_lost] == pytest.approx(motion[role][~is_lost], abs=1e-4)
    assert "means 'no value'" in remarks(log)


@pytest.mark.parametrize("last", [999.0, 88888.0, 65535.0, 1.7e18])
def test_an_end_of_what_was_measured_is_no_missing_value(last):
    values = np.linspace(0.5, 1.0, 200) * last
    assert without_fillers("rpm", np.append(values, [last, last]))[1] == []


@pytest.mark.parametrize("column", [[0.0] * 9 + [99.0] * 9, [0.0, 10.0, 20.0, 999.0]])
def test_a_step_and_a_time_after_a_gap_are_no_missing_values(column):
    assert without_fillers("rpm", np.array(column))[1] == []


SENSORS = {
    "heading": 200.0 + 30.0 * np.sin(T / 40.0),
    "north": 500.0 + 9.0 * np.sin(T / 60.0),
    "east": 300.0 + 0.1 * T,
    "surge": 1.5 + 0.2 * np.sin(T / 25.0),
    "sway": 0.1 * np.cos(T / 25.0) - 0.7,
    "wind_speed": 9.0 + np.sin(T / 9.0),
    "wind_from": 45.0 + 20.0 * np.sin(T / 13.0),
}


@EASY
@given(
    some.sampled_from([0.0, -1.0]),
    some.sampled_from(["heading", "north", "surge", "wind_speed"]),
    some.lists(some.tuples(some.integers(0, 270), some.integers(2, 25)), min_size=1, max_size=4),
)
def test_a_number_that_a_sensor_leaps_to_and_back_is_no_value(tmp_path, filler, role, blocks):
    is_lost = np.zeros(len(T), bool)
    for first, count in blocks:
        is_lost[first : first + count] = True
    lost = {role: np.where(is_lost, filler, SENSORS[role])}
    log = log_of(tmp_path, {"time": T} | SENSORS | lost)
    assert np.isnan(log[role].values).tolist() == is_lost.tolist()
    assert f"{role}: it leaps to {filler:g} and back in {is_lost.sum()} rows" in remarks(log)
    for other in SENSORS.keys() - {role}:
        assert np.isfinite(log[other].values).all()


@EASY
@given(some.integers(2, 60), some.floats(0.02, 0.2))
def test_a_ship_that_stops_and_a_heading_through_north_lose_no_value(tmp_path, pause, noise):
    # A receiver at rest gives exactly 0, and the compass passes 0 with whole degrees.
    speed = np.maximum(np.abs(T - 150.0) - pause, 0.0) * 0.02
    speed = np.where(speed < noise, 0.0, speed + noise * 0.1 * np.sin(9.0 * T))
    heading = np.round(np.mod(20.0 * np.sin(T / 40.0), 360.0))
    columns = (
        {"time": T}
        | SENSORS
        | {"surge": speed, "heading": heading, "port_rpm": 90.0 * (speed > 0.0)}
    )
    log = log_of(tmp_path, columns)
    assert log["surge"].values == pytest.approx(speed, abs=1e-4)
    assert log["heading"].values.tolist() == heading.tolist()
    assert np.isfinite(log["port_rpm"].values).all()


def test_two_numbers_for_no_value_in_one_column_are_both_left_out():
    values, said = without_fillers("east", np.array([1.0, 2.0, -9999.0, 1e30, -9999.0, 3.0]))
    assert np.isnan(values).tolist() == [False, False, True, True, True, False]
    assert len(said) == 2


FLAGGED = {
    "heading quality": ("Good", "Bad", ["heading"]),
    "heading_valid": ("1", "0", ["heading"]),
    "HEADING OK": ("TRUE", "FALSE", ["heading"]),
    "heading.status": ("OK", "Fault", ["heading"]),
    "heading quality code": ("192", "0", []),
    "heading_quality_": ("192", "24", ["heading"]),
    "Position valid": ("true", "false", []),
}


@pytest.mark.parametrize("flag", FLAGGED)
@pytest.mark.parametrize("share", [0.02, 0.3])
def test_rows_that_a_flag_calls_bad_are_left_out(tmp_path, flag, share):
    good, bad, roles = FLAGGED[flag]
    is_bad = np.arange(len(T)) % round(1.0 / share) == 1
    log = log_of(tmp_path, {"time": T} | MOTION | {flag: [bad if b else good for b in is_bad]})
    for role in MOTION:
        assert np.isnan(log[role].values).tolist() == (is_bad & (role in roles)).tolist()
    assert ("bad: left empty" in remarks(log)) == bool(roles)


def test_a_flag_of_a_sensor_is_of_all_its_channels(tmp_path):
    is_bad = T % 10.0 == 3.0
    columns = {
        "time": T,
        "GPS1 North": MOTION["north"],
        "GPS1 East": MOTION["east"],
        "Heading": MOTION["heading"],
    }
    log = log_of(tmp_path, columns | {"GPS1 valid": ["0" if b else "1" for b in is_bad]})
    assert np.isnan(log["north"].values).tolist() == is_bad.tolist()
    assert np.isfinite(log["heading"].values).all()


@pytest.mark.parametrize(("good", "bad"), [("Good", "Bad"), ("1", "0"), ("192", "0")])
def test_values_of_bad_quality_in_a_list_of_values_are_left_out(tmp_path, good, bad):
    name = "Valid" if good == "1" else "Quality"
    rows = [f"Tag,Timestamp,Value,{name}"]
    for i in range(len(T)):
        for role, values in MOTION.items():
            is_bad = i % 20 == 7 and role == "north"
            rows.append(
                f"{role},{T[i]},{0.0 if is_bad else values[i]:.5f},{bad if is_bad else good}"
            )
    log = read_log(save(tmp_path, rows))
    assert np.flatnonzero(np.isnan(log["north"].values)).tolist() == list(range(7, len(T), 20))
    assert "15 values that are called bad left out" in remarks(log)


@EASY
@given(
    some.sampled_from([1e12, -1e12, 5000.0, 5e4, 9e9]), some.integers(1, 280), some.integers(-2, 2)
)
def test_a_heading_that_is_no_direction_is_left_out(tmp_path, wrong, row, turns):
    heading = MOTION["heading"] + 360.0 * turns
    heading[row] = wrong
    log = log_of(tmp_path, {"time": T} | MOTION | {"heading": heading})
    assert np.flatnonzero(np.isnan(log["heading"].values)).tolist() == [row]
    assert "is no direction: left out" in remarks(log)


@EASY
@given(some.floats(0.3, 3.0), some.floats(-900.0, 900.0), some.sampled_from([1.0, -1.0]))
def test_a_heading_that_counts_turns_on_is_read(tmp_path, rate, start, sign):
    heading = start + sign * rate * 10.0 * T
    log = log_of(tmp_path, {"time": T} | MOTION | {"heading": heading})
    assert log["heading"].values == pytest.approx(heading, abs=1e-4)


@pytest.mark.parametrize("around", [0.0, 3.0, 6.0])
def test_headings_in_hundredths_around_north_are_refused(tmp_path, around):
    heading = np.mod(around + 8.0 * np.sin(T / 30.0), 360.0) * 100.0
    with pytest.raises(ShipcosimError, match="is no direction: is the unit right"):
        log_of(tmp_path, {"time": T} | MOTION | {"heading": heading})


@EASY
@given(some.sampled_from([10.0, 100.0]), some.floats(120.0, 355.0), some.floats(0.0, 200.0))
def test_headings_in_parts_of_a_degree_are_refused(tmp_path, parts, start, swing):
    heading = np.mod(start + swing * np.sin(T / 30.0), 360.0) * parts
    with pytest.raises(ShipcosimError, match="is no direction: is the unit right"):
        log_of(tmp_path, {"time": T} | MOTION | {"heading": heading})


@given(some.integers(1, 6), some.integers(10, 280))
@EASY
def test_a_heading_that_sweeps_through_north_twice_has_no_missing_value(between, row):
    """Interpolated the long way round from one side of north to the other and back, with north itself between."""
    heading = np.mod(0.3 * np.sin(T / 40.0), 360.0)
    sweep = np.linspace(360.0, 0.0, between + 2)
    heading[row : row + between + 2] = sweep
    heading[row + between + 1 : row + 2 * between + 3] = sweep[::-1]
    assert not dropouts(heading, "deg").any()
