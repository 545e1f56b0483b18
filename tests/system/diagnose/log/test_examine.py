"""Each fault put into a made-up log is named, with its place and channels; a log that is right gives none."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.checks import examine as examining
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.checks.wind import leaps
from shipcosim.diagnose.log.checks.wind_jumps import jumping_wind
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired


def only(log):
    """The one finding of a log."""
    found = examine(table(log))
    assert len(found) == 1, [(f.cause, f.channels, f.segments, f.note) for f in found]
    assert found[0].kind == "data" and 0.5 < found[0].probability <= 1.0
    return found[0]


def near(segments, *expected, within=12.0):
    assert len(segments) == len(expected)
    for found, right in zip(segments, expected, strict=True):
        assert found == pytest.approx(right, abs=within)


def inside(log, first, last):
    return (log["time"] >= first) & (log["time"] <= last)


def test_a_right_log_gives_no_finding():
    assert examine(table(measured(seed=1))) == []


def test_a_ship_at_rest_gives_no_finding():
    log = measured(seed=3)
    random = np.random.default_rng(3)
    quiet = {
        "north": 0.2,
        "east": 0.2,
        "surge": 0.02,
        "sway": 0.02,
        "yaw_rate": 0.05,
        "heading": 0.1,
    }
    log |= {role: spread * random.normal(size=len(log["time"])) for role, spread in quiet.items()}
    log["heading"] = np.mod(log["heading"] + 40.0, 360.0)
    assert examine(table(log)) == []


@pytest.mark.parametrize("kind", ["missing", "empty", "held", "interpolated"])
def test_lost_rows_are_a_gap_however_they_are_filled(kind):
    log = measured(seed=4)
    here = inside(log, 500, 540)
    if kind == "missing":
        log = {role: values[~here] for role, values in log.items()}
    for role in () if kind == "missing" else set(log) - {"time"}:
        first, last = log[role][499], log[role][541]
        filled = {
            "empty": np.nan,
            "held": first,
            "interpolated": np.linspace(first, last, 43)[1:-1],
        }
        log[role] = np.where(here, 0.0, log[role])
        log[role][here] = filled[kind]
    finding = only(log)
    near(finding.segments, (500.0, 540.0), within=2.0)
    assert finding.cause == "gap" and set(finding.channels) == set(log) - {"time"}
    assert np.isnan(repaired(table(log), [finding])["surge"].values[505:535]).all()


def test_samples_between_both_sides_of_north_are_a_heading_wrap():
    log = measured(seed=5)
    raw = np.round(log["heading"], 1)
    rows = np.flatnonzero(np.abs(np.diff(raw)) > 180.0)
    rows = rows[np.diff(rows, prepend=-9) > 4]
    rows = rows[(rows > 2) & (rows < len(raw) - 5)]
    for row in rows:
        raw[row + 1] = round(0.5 * (raw[row] + raw[row + 2]), 1)
    crossing = [row for row in rows if abs(raw[row + 2] - raw[row]) > 180.0]
    finding = only(log | {"heading": raw})
    assert finding.cause == "heading_wrap" and len(crossing) > 2
    assert {segment[0] for segment in finding.segments} >= {float(row + 1) for row in crossing}
    again = repaired(table(log | {"heading": raw}), [finding])["heading"].values
    assert np.isnan(again[[row + 1 for row in crossing]]).all()


def test_a_heading_wrap_is_found_where_a_sample_beside_it_is_missing():
    log = measured(seed=5)
    row = int(np.argmax(np.abs(np.diff(np.round(log["heading"], 1))) > 180.0))
    raw = log["heading"].copy()
    for k in range(1, 4):
        raw[row + k] = raw[row] + (raw[row + 4] - raw[row]) * k / 4.0
    raw[row + 4 : row + 6] = np.nan
    found = [
        finding
        for finding in examine(table(log | {"heading": raw}))
        if finding.cause == "heading_wrap"
    ]
    assert [finding.segments for finding in found] == [((float(row + 1), float(row + 3)),)]


def test_samples_of_a_heading_wrap_that_lie_near_north_are_cut_out_with_it():
    log = measured(seed=5)
    row = int(np.argmax(np.abs(np.diff(np.round(log["heading"], 1))) > 180.0))
    raw = log["heading"].copy()
    raw[row + 1 : row + 3] = raw[row] + (raw[row + 3] - raw[row]) * np.array([0.08, 0.6])
    found = [
        finding
        for finding in examine(table(log | {"heading": raw}))
        if finding.cause == "heading_wrap"
    ]
    assert [finding.segments for finding in found] == [((float(row + 1), float(row + 2)),)]


@pytest.mark.parametrize("lost", ["value", "row"])
def test_a_heading_wrap_is_found_where_a_sample_of_it_is_missing(lost):
    log = measured(seed=5)
    row = int(np.argmax(np.abs(np.diff(np.round(log["heading"], 1))) > 180.0))
    raw = log["heading"].copy()
    for k in range(1, 4):
        raw[row + k] = raw[row] + (raw[row + 4] - raw[row]) * k / 4.0
    if lost == "value":
        raw[row + 2] = np.nan
        log = log | {"heading": raw}
    else:
        log = {
            role: np.delete(values, row + 2) for role, values in (log | {"heading": raw}).items()
        }
    assert abs(raw[row + 4] - raw[row]) > 180.0
    found = [finding for finding in examine(table(log)) if finding.cause == "heading_wrap"]
    assert [finding.segments for finding in found] == [((float(row + 1), float(row + 3)),)]


@pytest.mark.parametrize("rate", [0.8, 1.2])
def test_a_clock_that_runs_wrong_for_a_while_is_named_with_its_rate_and_undone(rate):
    log = measured(seed=6, rate=rate)
    finding = only(log)
    assert finding.cause == "clock" and finding.channels == ("time",)
    near(finding.segments, (400.0, 600.0), within=15.0)
    estimate = finding.parameters["rate"]
    assert estimate.estimate == pytest.approx(rate, abs=0.04) and estimate.std < 0.03
    again = repaired(table(log), [finding])
    assert again["time"].values[-1] == pytest.approx(1199.0 + 200.0 * (rate - 1.0), abs=10.0)
    assert examine(again.drop_vars("logged_time")) == []


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("every", [5, 10])
def test_a_wrong_clock_is_found_in_slow_rows_too(every):
    """One end of the segment lies among the places where the other is sought: segments of no rows are none."""
    log = {role: values[::every] for role, values in measured(seed=6, rate=1.2).items()}
    finding = only(log)
    assert finding.cause == "clock"
    near(finding.segments, (400.0, 600.0), within=3.0 * every)


def test_a_clock_that_is_wrong_for_headings_alone_is_no_clock():
    log = measured(seed=7)
    log["yaw_rate"] = np.where(inside(log, 400, 600), 0.8, 1.0) * log["yaw_rate"]
    assert examine(table(log)) == []


PART = (300.0, 800.0)
LABELS = {
    "surge": ("sign", ("surge",), lambda log: {"surge": -log["surge"]}),
    "sway": ("sign", ("sway",), lambda log: {"sway": -log["sway"]}),
    "east": ("sign", ("east",), lambda log: {"east": -log["east"]}),
    "yaw_rate": ("sign", ("yaw_rate",), lambda log: {"yaw_rate": -log["yaw_rate"]}),
    "wind_from": (
        "sign",
        ("wind_from",),
        lambda log: {"wind_from": np.mod(-log["wind_from"], 360.0)},
    ),
    "body": (
        "channel_swap",
        ("surge", "sway"),
        lambda log: {"surge": log["sway"], "sway": log["surge"]},
    ),
    "earth": (
        "channel_swap",
        ("north", "east"),
        lambda log: {"north": log["east"], "east": log["north"]},
    ),
    "knots": (
        "frame",
        ("surge", "sway"),
        lambda log: {r: log[r] * 3600 / 1852 for r in ("surge", "sway")},
    ),
    "radians": ("frame", ("yaw_rate",), lambda log: {"yaw_rate": np.radians(log["yaw_rate"])}),
    "from north": (
        "frame",
        ("wind_from",),
        lambda log: {"wind_from": np.mod(log["wind_from"] + log["heading"], 360.0)},
    ),
    "earth-fixed": (
        "frame",
        ("surge", "sway"),
        lambda log: {
            "surge": log["surge"] * np.cos(np.radians(log["heading"]))
            - log["sway"] * np.sin(np.radians(log["heading"])),
            "sway": log["surge"] * np.sin(np.radians(log["heading"]))
            + log["sway"] * np.cos(np.radians(log["heading"])),
        },
    ),
}


IN_A_PART = ("sway", "yaw_rate", "wind_from", "earth", "knots", "earth-fixed")
THROUGHOUT = ("surge", "yaw_rate", "body", "radians", "from north")
"""At least one of each cause, of body and earth, and of the wind; the others at night."""


@pytest.mark.parametrize("fault", THROUGHOUT)
def test_a_channel_mislabelled_throughout_is_named_and_put_right(fault):
    check_label(fault)


@pytest.mark.parametrize("fault", IN_A_PART)
def test_a_channel_mislabelled_in_a_part_is_named_and_put_right(fault):
    check_label(fault, PART)


def check_label(fault, segment=None):
    cause, channels, change = LABELS[fault]
    right = measured(seed=8)
    here = inside(right, *segment) if segment else np.ones(len(right["time"]), bool)
    wrong = right | {
        role: np.where(here, values, right[role]) for role, values in change(right).items()
    }
    finding = only(wrong)
    assert (finding.cause, finding.channels) == (cause, channels)
    near(finding.segments, *([segment] if segment else []), within=15.0)
    again = repaired(table(wrong), [finding])
    for role in channels:
        off = again[role].values[350:750] - right[role][350:750]
        off = np.mod(off + 180.0, 360.0) - 180.0 if role == "wind_from" else off
        assert np.nanmax(np.abs(off)) < 1e-6


def test_a_segment_ends_at_the_leap_though_the_ship_has_lain_still_there_for_minutes():
    log, random = measured(seed=9), np.random.default_rng(1)
    still = np.flatnonzero(log["time"] > 700.0)
    for role, noise in {"north": 0.2, "east": 0.2, "heading": 0.1}.items():
        log[role][still] = log[role][still[0]] + noise * random.normal(size=len(still))
    for role, noise in {"surge": 0.02, "sway": 0.02, "yaw_rate": 0.05}.items():
        log[role][still] = noise * random.normal(size=len(still))
    log["east"][inside(log, 300.0, 850.0)] *= -1.0
    found = [finding for finding in examine(table(log)) if finding.channels == ("east",)]
    assert [(finding.cause, finding.segments) for finding in found] == [("sign", ((300.0, 850.0),))]


def test_rows_lost_between_even_times_are_a_gap():
    """As in a real log: the stamps go on evenly while the ship is minutes further three rows later."""
    log = measured(seed=9)
    for role in ("north", "east"):
        log[role][600:] += 80.0
        log[role][598:601] = np.interp(
            [598, 599, 600], [597, 601], [log[role][597], log[role][601]]
        )
    finding = next(f for f in examine(table(log)) if f.cause == "gap")
    near(finding.segments, (597.0, 601.0), within=2.0)


def moved(log, **changes):
    return examine(table(log | changes))


@pytest.fixture(scope="module")
def faulty():
    """A log with held rows and a wrong sign in a part, and what is found in it."""
    log = measured(seed=10)
    log["sway"] = np.where(inside(log, 300, 800), -1.0, 1.0) * log["sway"]
    for role in set(log) - {"time"}:
        log[role][900:930] = log[role][899]
    return log, examine(table(log))


def causes(found):
    return sorted((f.cause, f.channels) for f in found)


def test_turning_the_earth_frame_changes_nothing(faulty):
    log, found = faulty
    turn = np.exp(1j * np.radians(70.0))
    position = (log["north"] + 1j * log["east"]) * turn
    heading = np.mod(log["heading"] + 70.0, 360.0)
    again = moved(log, north=position.real, east=position.imag, heading=heading)
    assert causes(again) == causes(found)
    assert [f.cause for f in found] == ["gap", "sign"]
    for one, other in zip(again, found, strict=True):
        near(one.segments, *other.segments, within=8.0)


def test_a_ship_in_the_mirror_gives_the_same_faults(faulty):
    log, found = faulty
    mirrored = {role: -log[role] for role in ("east", "sway", "yaw_rate")}
    angles = {role: np.mod(-log[role], 360.0) for role in ("heading", "wind_from")}
    assert causes(moved(log, **mirrored, **angles)) == causes(found)


def test_a_later_start_moves_the_segments_along(faulty):
    log, found = faulty
    again = moved(log, time=log["time"] + 5000.0)
    for one, other in zip(again, found, strict=True):
        near(one.segments, *[(a + 5000.0, b + 5000.0) for a, b in other.segments], within=0.01)


def test_other_units_in_the_file_change_nothing(faulty, tmp_path):
    log, found = faulty
    units = {
        "surge": ("kn", 3600 / 1852),
        "sway": ("kn", 3600 / 1852),
        "heading": ("rad", np.pi / 180),
    }
    units |= {
        "yaw_rate": ("deg/min", 60.0),
        "north": ("km", 1e-3),
        "east": ("km", 1e-3),
        "time": ("min", 1 / 60),
    }
    headers = [f"{role} [{units[role][0]}]" if role in units else role for role in log]
    columns = np.column_stack(
        [units.get(role, ("", 1.0))[1] * values for role, values in log.items()]
    )
    np.savetxt(
        tmp_path / "log.csv",
        columns,
        delimiter=",",
        header=",".join(headers),
        comments="",
        fmt="%.9f",
    )
    again = examine(read_log(tmp_path / "log.csv"))
    assert causes(again) == causes(found)
    for one, other in zip(again, found, strict=True):
        near(one.segments, *other.segments, within=1.0)


def still(seed):
    """A log of a ship that hardly moves: a tenth of a degree to and fro, and a few centimetres."""
    log, calm = measured(seed=seed), measured(seed=seed, noise=0.0)
    turned = 0.01 * (np.mod(calm["heading"] + 180.0, 360.0) - 180.0)
    velocity = 0.01 * (calm["surge"] + 1j * calm["sway"]) * np.exp(1j * np.radians(120.0 + turned))
    position = np.cumsum(velocity)
    return log | {
        "north": log["north"] - calm["north"] + position.real,
        "east": log["east"] - calm["east"] + position.imag,
        "heading": np.mod(120.0 + log["heading"] - calm["heading"] + turned, 360.0),
        "surge": log["surge"] - 0.99 * calm["surge"],
        "sway": log["sway"] - 0.99 * calm["sway"],
        "yaw_rate": log["yaw_rate"] - 0.99 * calm["yaw_rate"],
        "wind_from": np.mod(
            80.0 + 4.0 * np.random.default_rng(seed).normal(size=len(log["time"])), 360.0
        ),
    }


WINDS = {
    "knots": ("wind_speed", lambda log: log["wind_speed"] * 3600 / 1852),
    "mirrored": ("wind_from", lambda log: np.mod(-log["wind_from"], 360.0)),
    "from north": ("wind_from", lambda log: np.mod(log["wind_from"] + log["heading"], 360.0)),
}


def test_a_ship_that_keeps_still_gives_no_finding():
    assert examine(table(still(seed=11))) == []


@pytest.mark.parametrize("fault", WINDS)
def test_the_wind_of_a_ship_that_keeps_still_jumps_where_its_label_is_wrong(fault):
    role, change = WINDS[fault]
    log = still(seed=11)
    finding = only(log | {role: np.where(inside(log, 300, 800), change(log), log[role])})
    assert role in finding.channels and finding.kind == "data"
    near(finding.segments, (300.0, 800.0), within=3.0)


@pytest.mark.parametrize(("gusts", "count"), [((), 1), ((700, 900), 0)])
def test_jumps_of_the_wind_are_larger_than_any_gust(gusts, count):
    """She drifts; where the wind changes by her velocity, it could be wind over ground from there on: or a gust."""
    time, random = np.arange(1200.0), np.random.default_rng(1)
    drift = np.full(time.size, 0.6)
    wind = 8.0 + 0.05 * random.normal(size=time.size)
    for edge in (300, 600, *gusts):
        wind[edge:] -= 0.6 if edge in (300, 700) else -0.6
    still = np.zeros(time.size)
    arrays = {"time": time, "heading": still, "wind_speed": wind + drift, "wind_from": still}
    assert len(jumping_wind(arrays | {"surge": drift, "sway": still})) == count


@pytest.mark.parametrize("segment", [(300.0, 700.0), (0.0, 500.0), None])
def test_another_unit_of_the_wind_leaps_at_its_ends_and_a_lee_does_not(segment):
    time, random = np.arange(1200.0), np.random.default_rng(2)
    speed = 9.0 + np.cumsum(0.03 * random.normal(size=len(time)))
    here = (time >= segment[0]) & (time <= segment[1]) if segment else np.ones(len(time), bool)
    assert leaps(time, np.where(here, 3600.0 / 1852.0, 1.0) * speed, segment, 3600.0 / 1852.0)
    assert leaps(time, speed, segment, 3600.0 / 1852.0) == (segment is None)


def test_a_rate_that_is_rounded_away_is_told_by_the_signs_of_its_zeros():
    log = measured(seed=12)
    rate = np.round(np.radians(0.04 * log["yaw_rate"]), 2)
    turned = np.mod(log["heading"] + 180.0, 360.0) - 180.0
    log = log | {"heading": np.mod(0.04 * turned, 360.0), "yaw_rate": rate}
    assert np.mean(rate == 0.0) > 0.9
    finding = only(log)
    assert (finding.cause, finding.channels, finding.segments) == ("frame", ("yaw_rate",), ())
    assert np.isnan(repaired(table(log), [finding])["yaw_rate"].values).all()
    assert "frame" not in [f.cause for f in examine(table(log | {"yaw_rate": np.abs(rate)}))]


def test_a_rate_that_is_rounded_away_in_a_part_is_named_with_it():
    """No rate is left in the part once it is put right: its ends stay where they were found first."""
    log = measured(seed=21)
    turned = np.mod(log["heading"] + 180.0, 360.0) - 180.0
    rate = 0.3 * log["yaw_rate"]
    rate = np.round(np.where(inside(log, 300, 800), np.radians(rate), rate), 2)
    finding = only(log | {"heading": np.mod(0.3 * turned, 360.0), "yaw_rate": rate})
    assert (finding.cause, finding.channels) == ("frame", ("yaw_rate",))
    near(finding.segments, (300.0, 800.0))


@pytest.mark.parametrize("step", [0.5, 1.0, 2.0])
def test_a_craft_that_spins_goes_the_long_way_round_and_that_is_no_heading_wrap(step):
    time, random = np.arange(0.0, 300.0, step), np.random.default_rng(3)
    heading = np.mod(np.degrees(1.0) * time + 0.5 * random.normal(size=len(time)), 360.0)
    position = 0.3 * np.exp(1j * time) + 0.02 * (
        random.normal(size=len(time)) + 1j * random.normal(size=len(time))
    )
    log = {"time": time, "north": position.real, "east": position.imag, "heading": heading}
    assert examine(table(log)) == []


def test_a_ship_that_keeps_north_wraps_again_and_again_and_each_is_found():
    log, random = measured(seed=16), np.random.default_rng(7)
    heading = np.mod(
        0.5 * np.sin(log["time"] / 20.0) + 0.3 * random.normal(size=len(log["time"])), 360.0
    )
    few = {"time": log["time"], "heading": heading}
    crossing = np.flatnonzero(np.abs(np.diff(heading)) > 180.0)[::3]
    crossing = crossing[(np.diff(crossing, append=9999) > 4) & (crossing < len(heading) - 4)]
    found = []
    for row in crossing:
        if abs(heading[row + 3] - heading[row]) > 180.0:
            heading[row : row + 4] = np.linspace(heading[row], heading[row + 3], 4)
            found.append(row)
    (finding,) = [f for f in examine(table(few)) if f.cause == "heading_wrap"]
    assert len(found) > 20 and {first for first, _ in finding.segments} >= {
        float(row + 1) for row in found
    }


def test_a_small_craft_that_swings_across_north_is_no_heading_wrap():
    time, random = np.arange(300.0), np.random.default_rng(4)
    heading = np.where(time % 40 < 3, 50.0, -20.0) + random.normal(size=len(time))
    assert examine(table({"time": time, "heading": np.mod(heading, 360.0)})) == []


@pytest.mark.parametrize("grain", [0.1, 1.1])
@pytest.mark.parametrize("noise", [0.02, 0.5])
@pytest.mark.parametrize("swing", [0.0, 20.0])
@pytest.mark.parametrize("speed", [0.1, 2.0])
def test_positions_of_five_decimals_of_a_degree_are_no_gap(grain, noise, speed, swing):
    """At 1 Hz a slow craft stays on one such step for seconds, and goes on by one: no line, nothing held."""
    time, random = np.arange(600.0), np.random.default_rng(5)
    course = np.radians(40.0 + swing * np.sin(time / 60.0))
    position = np.cumsum(speed * np.exp(1j * course))
    log = {"time": time}
    for role, values in (("north", position.real), ("east", position.imag)):
        log[role] = grain * np.round((values + noise * random.normal(size=len(time))) / grain)
    assert examine(table(log)) == []


@pytest.mark.parametrize("dead", [("surge", "sway"), ("sway",), ("yaw_rate",)])
@pytest.mark.parametrize("value", [0.0, 1.7])
def test_a_channel_that_never_changes_is_said_and_not_used(dead, value):
    log = measured(seed=14)
    log |= {role: np.full(len(log["time"]), value) for role in dead}
    found = examine(table(log))
    assert [(finding.cause, finding.channels) for finding in found] == [("gap", dead)]
    again = repaired(table(log), found)
    assert (
        all(np.isnan(again[role].values).all() for role in dead)
        and np.isfinite(again["north"].values).any()
    )


def test_a_ship_moored_with_a_channel_at_zero_gives_no_finding():
    log, random = measured(seed=15), np.random.default_rng(6)
    log |= {role: 0.2 * random.normal(size=len(log["time"])) for role in ("north", "east")}
    log["heading"] = np.mod(40.0 + 0.1 * random.normal(size=len(log["time"])), 360.0)
    log |= {role: np.zeros(len(log["time"])) for role in ("surge", "sway", "yaw_rate")}
    log = {role: values for role, values in log.items() if not role.startswith("wind")}
    assert examine(table(log)) == []


def test_segments_of_a_wrong_clock_that_lie_in_each_other_contradict_and_none_is_named():
    def clock(*segments):
        return [
            Finding("clock", kind="data", segments=(segment,), channels=("time",))
            for segment in segments
        ]

    assert examining._agreeing(clock((89.0, 166.0), (111.0, 144.0))) == []
    beside = clock((0.0, 100.0), (98.0, 200.0))
    assert examining._agreeing(beside) == beside
