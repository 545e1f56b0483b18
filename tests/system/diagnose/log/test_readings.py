"""Mistakes that hold throughout a log are judged by all relations at once; what cannot be told apart is left open."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from mistakes.runs import log_of
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.readings.reading import CONTRADICTION, IN_PART, misread
from shipcosim.diagnose.log.repair import repaired
from truth import draw

MOTION = (
    "time",
    "north",
    "east",
    "heading",
    "surge",
    "sway",
    "yaw_rate",
    "wind_speed",
    "wind_from",
)


def without_wind(log):
    return {role: values for role, values in log.items() if not role.startswith("wind")}


CHANGES = {
    "time is in ms, not s": lambda log: {"time": 1000.0 * log["time"]},
    "0.5 s pass in each logged second": lambda log: {"time": 2.0 * log["time"]},
    "surge and sway are in km/h, not m/s": lambda log: {
        role: 3.6 * log[role] for role in ("surge", "sway")
    },
    "heading is in rad, not deg": lambda log: {"heading": np.radians(log["heading"])},
    # alone at night: a test further down has it together with the sign of the yaw rate
    "heading has the other sign": lambda log: {"heading": np.mod(-log["heading"], 360.0)},
    "heading is counted counter-clockwise from east": lambda log: {
        "heading": np.mod(90.0 - log["heading"], 360.0)
    },
    "north and east are in km, not m": lambda log: {
        role: 1e-3 * log[role] for role in ("north", "east")
    },
}


@pytest.mark.parametrize("said", [said for said in CHANGES if "other sign" not in said])
def test_a_mistake_throughout_is_named_alone_and_put_right(said):
    check_mistake(said, CHANGES[said])


def check_mistake(said, change):
    right = measured(seed=21)
    wrong = right | change(right)
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
    assert {f.note for f in examine(table(wrong))} == {
        "time is in ms, not s",
        "yaw_rate is in rad/s, not deg/s",
    }


def turned(log, degrees):
    position = (log["north"] + 1j * log["east"]) * np.exp(1j * np.radians(degrees))
    return log | {"north": position.real, "east": position.imag}


def test_a_grid_that_is_turned_further_than_compasses_are_off_is_named_with_its_angle():
    check_turned_grid(-120.0)


def check_turned_grid(degrees):
    log = measured(seed=25)
    wrong = turned(log, degrees)
    (finding,) = examine(table(wrong))
    assert (finding.cause, finding.channels, finding.alternatives) == (
        "frame",
        ("north", "east"),
        (),
    )
    assert "the heading is off by that angle" in finding.note
    angle = finding.parameters["angle"]
    assert angle.estimate == pytest.approx(degrees, abs=4.0 * angle.std) and angle.std < 2.0
    again = repaired(table(wrong), [finding])
    off = again["north"].values - log["north"] + 1j * (again["east"].values - log["east"])
    assert np.abs(off).max() < 0.05 * np.abs(log["north"] + 1j * log["east"]).max()
    assert examine(again.drop_vars("logged_time")) == []


def test_an_angle_that_a_compass_can_be_off_by_is_no_mistake_of_frames():
    assert examine(table(turned(measured(seed=25), 14.0))) == []


def test_positions_of_latitude_and_longitude_are_in_no_turned_grid():
    wrong = table(turned(measured(seed=25), 35.0)).assign_attrs(
        latitude_origin=60.0, longitude_origin=10.0
    )
    (finding,) = examine(wrong)
    assert "the heading is off by that angle" in finding.alternatives


@pytest.mark.parametrize(("degrees", "seed"), [(45.0, 25), (180.0, 1007)])
def test_axes_of_the_velocity_that_are_turned_are_named_with_their_angle(degrees, seed):
    check_turned_axes(degrees, seed)


def check_turned_axes(degrees, seed):
    log = measured(seed=seed)
    along = (log["surge"] + 1j * log["sway"]) * np.exp(-1j * np.radians(degrees))
    wrong = log | {"surge": along.real, "sway": along.imag}
    (finding,) = examine(table(wrong))
    assert (finding.cause, finding.channels, finding.alternatives) == (
        "frame",
        ("surge", "sway"),
        (),
    )
    angle = finding.parameters["angle"]
    off = (angle.estimate - degrees + 180.0) % 360.0 - 180.0
    assert abs(off) < 4.0 * angle.std and angle.std < 2.0
    again = repaired(table(wrong), [finding])
    off = again["surge"].values - log["surge"] + 1j * (again["sway"].values - log["sway"])
    assert np.abs(off).max() < 0.05 * np.abs(along).max()
    assert examine(again.drop_vars("logged_time")) == []


def test_signs_of_heading_and_yaw_rate_that_agree_with_each_other_are_named():
    """The two agree as they are labelled; position against velocity tells that both are wrong."""
    check_signs_that_agree(25)


def check_signs_that_agree(seed):
    log = measured(seed=seed)
    wrong = log | {"heading": np.mod(-log["heading"], 360.0), "yaw_rate": -log["yaw_rate"]}
    assert {f.note for f in examine(table(wrong))} == {
        "heading has the other sign",
        "yaw_rate has the other sign",
    }


MORE_THAN_TWO = [
    (25, "north and east are in km, not m", "heading has the other sign", "yaw_rate"),
    (1005, "time is in ms, not s", "surge and sway are in km/h, not m/s", "east"),
    (1007, "time is in ms, not s", "heading has the other sign", "yaw_rate"),
]


@pytest.mark.parametrize(("seed", "one", "other", "negative"), MORE_THAN_TWO)
def test_more_mistakes_than_are_looked_for_are_a_contradiction(seed, one, other, negative):
    """Neither silence nor a wrong name; and the wind is not judged by velocities and headings that are wrong."""
    log = measured(seed=seed)
    for mistake in (one, other):
        log = log | CHANGES[mistake](log)
    (finding,) = examine(table(log | {negative: -log[negative]}))
    assert CONTRADICTION in finding.note and finding.alternatives
    assert finding.probability > 0.9 and "nothing is corrected" in finding.sentence


def test_a_mistake_that_too_little_motion_shows_in_all_parts_is_left_open():
    """A ship that holds her place moves in some parts only: what these say is said, and nothing is corrected."""
    check_left_open(203, "sway", "sway has the other sign")


def check_left_open(seed, role, said):
    log = log_of("hold", seed)
    (finding,) = examine(table(log | {role: -log[role]}))
    assert said in (finding.note, *finding.alternatives) and IN_PART in finding.alternatives
    assert finding.probability <= 0.5
    assert examine(table(log)) == []


def test_a_right_log_with_rows_far_apart_is_right():
    """Where a part is suspected, its ends are looked for among few rows, of which some cannot be compared."""
    check_rows_far_apart(25)


def check_rows_far_apart(every):
    log = draw("work", 91022, minutes=20, form=1.0).log.iloc[::every]
    roles = {name.partition(" [")[0]: log[name].to_numpy(float) for name in log}
    assert examine(table({role: values for role, values in roles.items() if role in MOTION})) == []


def two_mirrors(log):
    """Sign of surge and of east: but for a turn of the ship by half the same as the signs of north and sway."""
    return log | {"surge": -log["surge"], "east": -log["east"]}


def test_the_wind_tells_which_way_round_the_ship_is():
    log = measured(seed=34)
    log |= {"surge": log["surge"] + 1.5}
    way = np.cumsum((log["surge"] + 1j * log["sway"]) * np.exp(1j * np.radians(log["heading"])))
    log |= {"north": way.real, "east": way.imag}
    apparent = (6.0 * np.exp(2.0j) + np.gradient(way)) * np.exp(-1j * np.radians(log["heading"]))
    log |= {
        "wind_speed": np.abs(apparent),
        "wind_from": np.mod(np.degrees(np.angle(apparent)), 360.0),
    }
    found = examine(table(two_mirrors(log)))
    assert {f.note for f in found} == {"surge has the other sign", "east has the other sign"}


def test_a_craft_that_has_one_course_against_her_bow_goes_ahead():
    log = without_wind(measured(seed=35))
    way = 1.5 * np.exp(1j * np.radians(log["heading"]))
    log |= {"surge": log["surge"] / 5.0 + 1.5}
    way = np.cumsum(
        (log["surge"] + 1j * log["sway"] / 5.0) * np.exp(1j * np.radians(log["heading"]))
    )
    log |= {"north": way.real, "east": way.imag, "sway": log["sway"] / 5.0}
    found = examine(table(two_mirrors(log)))
    assert {f.note for f in found} == {"surge has the other sign", "east has the other sign"}


def test_a_craft_that_goes_both_ways_leaves_open_which_way_round_she_is():
    (finding,) = examine(table(without_wind(two_mirrors(measured(seed=36)))))
    assert {finding.note, *finding.alternatives} >= {
        "north has the other sign and sway has the other sign"
    }
    assert finding.alternatives


def mirrored(log):
    """Position to east and north, and heading from east."""
    return log | {
        "north": log["east"],
        "east": log["north"],
        "heading": np.mod(90.0 - log["heading"], 360.0),
    }


def test_only_the_wind_tells_a_mirrored_earth_from_mirrored_axes_of_the_ship():
    log = measured(seed=26)
    (finding,) = examine(table(without_wind(mirrored(log))))
    assert {"north and east are swapped", "sway has the other sign"} <= set(
        " and ".join([finding.note, *finding.alternatives]).split(" and ")
    ) or len(finding.alternatives) >= 1
    assert repaired(table(mirrored(log)), [finding])["east"].values == pytest.approx(
        mirrored(log)["east"]
    )


def test_what_a_header_states_is_wrong_less_often_than_what_nobody_stated(tmp_path):
    """Positions and velocities differ by a thousand: the one that has no unit in its header is the likelier mistake."""
    log = measured(seed=27)
    log |= {role: 1e-3 * log[role] for role in ("north", "east")}
    units = {"time": "s", "surge": "m/s", "sway": "m/s", "heading": "deg", "yaw_rate": "deg/s"}
    headers = [f"{role} [{units[role]}]" if role in units else role for role in log]
    np.savetxt(
        tmp_path / "log.csv",
        np.column_stack(list(log.values())),
        "%.9g",
        ",",
        header=",".join(headers),
        comments="",
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
    found = examine(table(log))
    assert {(f.note, f.segments) for f in found} == {
        ("north has the other sign", ()),
        ("surge and sway are swapped", ()),
    }


def test_nothing_is_said_where_the_heading_cannot_be_followed():
    """A compass that jumps at random from row to row leaves no relation, whatever the wind is."""
    rng = np.random.default_rng(4)
    time = np.arange(300.0)
    log = {
        "time": time,
        "heading": rng.uniform(0.0, 360.0, time.size),
        "yaw_rate": rng.normal(0.0, 1.0, time.size),
        "north": 2.0 * time,
        "east": 0.0 * time,
        "surge": 2.0 + 0.5 * np.sin(time / 20.0),
        "sway": 0.1 * np.cos(time / 30.0),
        "wind_speed": 8.0 + rng.normal(0.0, 0.3, time.size),
        "wind_from": rng.uniform(0.0, 360.0, time.size),
    }
    assert misread(log, {}).findings == []
