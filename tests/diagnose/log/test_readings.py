"""Mistakes that hold throughout a log are judged by all relations at once; what cannot be told apart is left open."""

import numpy as np
import pytest
from diagnose.logs import measured, smooth, table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired


def without_wind(log):
    return {role: values for role, values in log.items() if not role.startswith("wind")}


CHANGES = {
    "time is in ms, not s": lambda log: {"time": 1000.0 * log["time"]},
    "time is in min, not s": lambda log: {"time": log["time"] / 60.0},
    "time is in tenths of a second, not s": lambda log: {"time": 10.0 * log["time"]},
    "2 s pass in each logged second": lambda log: {"time": 0.5 * log["time"]},
    "0.5 s pass in each logged second": lambda log: {"time": 2.0 * log["time"]},
    "surge and sway are in km/h, not m/s": lambda log: {role: 3.6 * log[role] for role in ("surge", "sway")},
    "surge and sway are in ft/s, not m/s": lambda log: {role: log[role] / 0.3048 for role in ("surge", "sway")},
    "heading is in rad, not deg": lambda log: {"heading": np.radians(log["heading"])},
    "heading has the other sign": lambda log: {"heading": np.mod(-log["heading"], 360.0)},
    "heading is counted counter-clockwise from east": lambda log: {"heading": np.mod(90.0 - log["heading"], 360.0)},
    "north and east are in km, not m": lambda log: {role: 1e-3 * log[role] for role in ("north", "east")},
    "north and east are in ft, not m": lambda log: {role: log[role] / 0.3048 for role in ("north", "east")},
}


@pytest.mark.parametrize("said", CHANGES)
def test_a_mistake_throughout_is_named_alone_and_put_right(said):
    right = measured(seed=21)
    wrong = right | CHANGES[said](right)
    found = examine(table(wrong))
    assert [(finding.note, finding.segments) for finding in found] == [(said, ())]
    assert 0.95 < found[0].probability < 1.0
    again = repaired(table(wrong), found)
    assert len(again["time"]) == len(right["time"])
    assert again["time"].values == pytest.approx(right["time"], abs=1e-6 * right["time"][-1])
    for role in ("north", "east", "surge", "sway"):
        assert again[role].values == pytest.approx(right[role], abs=1e-6)
    off = np.mod(again["heading"].values - right["heading"] + 180.0, 360.0) - 180.0
    assert np.abs(off).max() < 1e-6
    assert examine(again.drop_vars("logged_time")) == []


def test_a_clock_some_per_cent_fast_is_named_with_its_rate():
    log = measured(seed=22)
    (finding,) = examine(table(log | {"time": 1.06 * log["time"]}))
    assert (finding.cause, finding.segments) == ("clock", ())
    rate = finding.parameters["rate"]
    assert rate.estimate == pytest.approx(1.0 / 1.06, abs=3.0 * rate.std) and rate.std < 0.02


def test_a_velocity_that_is_some_per_cent_off_is_no_mistake_of_units():
    """A scale of a sensor is for the causes of the next step."""
    log = measured(seed=23)
    assert examine(table(log | {role: 1.06 * log[role] for role in ("surge", "sway")})) == []


def test_two_mistakes_are_both_named():
    log = measured(seed=24)
    wrong = log | {"time": 1000.0 * log["time"], "yaw_rate": np.radians(log["yaw_rate"])}
    assert {f.note for f in examine(table(wrong))} == {"time is in ms, not s", "yaw_rate is in rad/s, not deg/s"}


def test_a_grid_that_is_turned_is_left_open_since_the_heading_may_be_off_instead():
    log = measured(seed=25)
    position = (log["north"] + 1j * log["east"]) * np.exp(1j * np.radians(35.0))
    wrong = log | {"north": position.real, "east": position.imag}
    (finding,) = examine(table(wrong))
    assert finding.alternatives == ("the heading is off by that angle", "surge and sway are turned against the ship")
    assert finding.probability < 0.5
    assert repaired(table(wrong), [finding])["north"].values == pytest.approx(wrong["north"])


def mirrored(log):
    """Position to east and north, and heading from east."""
    return log | {"north": log["east"], "east": log["north"], "heading": np.mod(90.0 - log["heading"], 360.0)}


def test_only_the_wind_tells_a_mirrored_earth_from_mirrored_axes_of_the_ship():
    log = measured(seed=26)
    (finding,) = examine(table(without_wind(mirrored(log))))
    assert {"north and east are swapped", "sway has the other sign"} <= set(
        " and ".join([finding.note, *finding.alternatives]).split(" and ")
    ) or len(finding.alternatives) >= 1
    assert repaired(table(mirrored(log)), [finding])["east"].values == pytest.approx(mirrored(log)["east"])


def test_what_a_header_states_is_wrong_less_often_than_what_nobody_stated(tmp_path):
    """Positions and velocities differ by a thousand: the one that has no unit in its header is the likelier mistake."""
    log = measured(seed=27)
    log |= {role: 1e-3 * log[role] for role in ("north", "east")}
    units = {"time": "s", "surge": "m/s", "sway": "m/s", "heading": "deg", "yaw_rate": "deg/s"}
    headers = [f"{role} [{units[role]}]" if role in units else role for role in log]
    np.savetxt(
        tmp_path / "log.csv", np.column_stack(list(log.values())), "%.9g", ",", header=",".join(headers), comments=""
    )
    (finding,) = examine(read_log(tmp_path / "log.csv"))
    assert finding.note == "north and east are in km, not m" and not finding.alternatives


def test_positions_and_headings_alone_are_left_as_they_are():
    log = measured(seed=28)
    few = {role: log[role] for role in ("time", "north", "east", "heading")}
    for factor in (1e3, 1.0 / 60.0, 0.5):
        assert examine(table(few | {"time": factor * few["time"]})) == []


def test_an_ordinary_dropout_is_no_gap_where_rows_are_a_thousand_seconds_apart():
    log = measured(seed=29)
    log["heading"][300:303] = np.nan
    few = {role: log[role] for role in ("north", "east", "heading")}
    assert examine(table({"time": 1000.0 * log["time"]} | few)) == []


def on_station(seed):
    """A ship that hardly moves: at 1 cm/s, seen by 0.2 m, and by a third of a degree."""
    random, time = np.random.default_rng(seed), np.arange(1200.0)
    heading, velocity = (
        30.0 + smooth(time, seed, 0.2),
        smooth(time, seed + 1, 0.006) + 1j * smooth(time, seed + 2, 0.006),
    )
    noise = random.normal(size=(6, len(time)))
    position = np.cumsum(velocity * np.exp(1j * np.radians(heading))) + 0.2 * (noise[0] + 1j * noise[1])
    return {
        "time": time,
        "north": position.real,
        "east": position.imag,
        "heading": heading + 0.1 * noise[2],
        "surge": velocity.real + 0.01 * noise[3],
        "sway": velocity.imag + 0.01 * noise[4],
        "yaw_rate": np.gradient(heading) + 0.02 * noise[5],
    }


@pytest.mark.parametrize(
    ("said", "change"),
    {
        "sway has the other sign": lambda log: {"sway": -log["sway"]},
        "yaw_rate has the other sign": lambda log: {"yaw_rate": -log["yaw_rate"]},
        "time is in ms, not s": lambda log: {"time": 1000.0 * log["time"]},
        "2 s pass in each logged second": lambda log: {"time": 0.5 * log["time"]},
    }.items(),
)
def test_what_is_wrong_shows_on_a_ship_that_keeps_her_station_too(said, change):
    """Motion that is less than the noise of a fix says it over twenty minutes."""
    log = on_station(31)
    assert examine(table(log)) == []
    (finding,) = examine(table(log | change(log)))
    assert said in (finding.note, *finding.alternatives) and not finding.segments
    assert finding.alternatives or finding.probability > 0.95


def test_a_log_of_rest_and_short_manoeuvres_is_judged_by_the_manoeuvres():
    log = measured(seed=32)
    moving = (np.mod(log["time"], 600.0) > 540.0).astype(float)
    velocity = moving * (log["surge"] + 1j * log["sway"])
    position = np.cumsum(velocity * np.exp(1j * np.radians(log["heading"])))
    noise = np.random.default_rng(32).normal(size=(4, len(position)))
    log |= {"surge": velocity.real + 0.02 * noise[0], "sway": velocity.imag + 0.02 * noise[1]}
    log |= {"north": position.imag + 0.2 * noise[2], "east": position.real + 0.2 * noise[3]}
    (finding,) = examine(table(without_wind(log)))
    assert (finding.note, finding.segments) == ("north and east are swapped", ())


def test_two_mistakes_throughout_are_not_said_of_two_parts_of_the_log():
    log = measured(seed=33)
    log |= {"north": -log["north"], "surge": log["sway"], "sway": log["surge"]}
    (finding,) = examine(table(log))
    assert not finding.segments
    assert "north has the other sign and surge and sway are swapped" in (finding.note, *finding.alternatives)
