"""Each fault does to a log what the contract says."""

import numpy as np
import pytest

from truth import faults
from truth.effects import Answer, Effect
from truth.plant import to_body
from truth.sensors import ROLES

TIMES = np.arange(1201)


@pytest.fixture
def channels():
    """A log of a ship that goes north-east at 1 m/s while it turns slowly, all channels different."""
    channels = {role: 100.0 * i + TIMES * 0.01 for i, role in enumerate(ROLES)}
    heading = np.radians(300.0 + 0.2 * TIMES)
    surge, sway = to_body(heading, np.sqrt(0.5), np.sqrt(0.5))
    return channels | {
        "heading": np.degrees(heading),
        "surge": surge,
        "sway": sway,
        "wind_speed": 5.0 + 0.0 * TIMES,
        "wind_from": 30.0 + 0.0 * TIMES,
    }


def spoilt(channels, cause, segments=(), roles=(), note="", **shape):
    return faults.spoil(
        channels, TIMES, Effect(Answer(cause, None, {}, segments, roles, note=note), shape)
    )


def test_clock_passes_rate_true_seconds_per_logged_second_in_its_segment():
    _, _, true = faults.true_times(TIMES, [Answer("clock", None, {"rate": 1.25}, ((300, 500),))])
    rate = np.diff(true)
    np.testing.assert_allclose(rate[300:500], 1.25)
    np.testing.assert_allclose(np.delete(rate, np.s_[300:500]), 1.0)


def test_lagging_channels_show_what_was():
    navigation, thrusters, air = faults.true_times(
        TIMES, [Answer("navigation_lag", None, {"lag": 2.5})]
    )
    np.testing.assert_allclose(navigation, TIMES - 2.5)
    np.testing.assert_allclose((thrusters, air), (TIMES, TIMES))
    navigation, thrusters, air = faults.true_times(
        TIMES, [Answer("thruster_lag", None, {"lag": 2.5})]
    )
    np.testing.assert_allclose(thrusters, TIMES - 2.5)
    np.testing.assert_allclose((navigation, air), (TIMES, TIMES))


@pytest.mark.parametrize("how", faults.GAPS)
def test_a_gap_is_in_its_segment_only(channels, how):
    out, rows, _ = spoilt(channels, "gap", ((200, 260),), tuple(ROLES), how)
    inside = (TIMES >= 200) & (TIMES <= 260)
    for role in ROLES:
        np.testing.assert_array_equal(out[role][~inside], channels[role][~inside])
    if how == "missing":
        np.testing.assert_array_equal(rows, ~inside)
    else:
        assert rows.all()
        gone = out["surge"][inside]
        assert {
            "empty": np.isnan(gone).all(),
            "held": np.ptp(gone) == 0,
            "interpolated": np.abs(np.diff(gone, 2)).max() < 1e-12,
        }[how]


def test_earth_fixed_velocities_are_north_and_east(channels):
    out, _, _ = spoilt(channels, "frame", (), ("surge", "sway"), "velocity_earth")
    np.testing.assert_allclose((out["surge"], out["sway"]), np.sqrt(0.5))


def test_other_units_and_frames(channels):
    assert spoilt(channels, "frame", note="velocity_knots")[0]["surge"] == pytest.approx(
        channels["surge"] * 1.943844
    )
    assert spoilt(channels, "frame", note="wind_knots")[0]["wind_speed"] == pytest.approx(
        5.0 * 1.943844
    )
    assert spoilt(channels, "frame", note="rate_radians")[0]["yaw_rate"] == pytest.approx(
        channels["yaw_rate"] * np.pi / 180
    )
    north = spoilt(channels, "frame", note="wind_from_north")[0]["wind_from"]
    np.testing.assert_allclose(north, 30.0 + channels["heading"])


def test_wind_over_ground_of_a_calm_is_none(channels):
    ahead, starboard = channels["surge"], channels["sway"]
    channels |= {
        "wind_speed": np.hypot(ahead, starboard),
        "wind_from": np.degrees(np.arctan2(starboard, ahead)),
    }
    np.testing.assert_allclose(
        spoilt(channels, "frame", note="wind_over_ground")[0]["wind_speed"], 0.0, atol=1e-9
    )


def test_swapped_channels_are_each_others_in_their_part(channels):
    out, _, _ = spoilt(channels, "channel_swap", ((100, 400),), faults.SWAPS[0])
    inside = (TIMES >= 100) & (TIMES <= 400)
    for a, b in (("port_rpm", "starboard_rpm"), ("port_azimuth", "starboard_azimuth")):
        np.testing.assert_array_equal(out[a], np.where(inside, channels[b], channels[a]))
        np.testing.assert_array_equal(out[b], np.where(inside, channels[a], channels[b]))


def test_a_sign_turns_its_channel(channels):
    out, _, _ = spoilt(channels, "sign", (), ("sway",))
    np.testing.assert_array_equal(out["sway"], -channels["sway"])
    np.testing.assert_array_equal(out["surge"], channels["surge"])


def test_wrapped_heading_runs_the_long_way_round_and_is_told_where(channels):
    out, _, answer = spoilt(channels, "heading_wrap", (), ("heading",), samples=3)
    right = np.mod(channels["heading"], 360.0)
    wrong = np.flatnonzero(np.abs(np.mod(out["heading"] - right + 180, 360) - 180) > 1.0)
    ((start, end),) = answer.segments
    np.testing.assert_array_equal(TIMES[wrong], np.arange(start, end + 1))
    assert len(wrong) == 3 and np.abs(out["heading"][wrong] - 180).max() < 100


@pytest.mark.parametrize("cause", faults.DRAW)
def test_segments_lie_within_the_log_and_apart(cause):
    for seed in range(100):
        for minutes in (10, 20, 40):
            parts = faults.DRAW[cause](np.random.default_rng(seed), 1.0, minutes).answer.segments
            edges = [t for part in parts for t in part]
            assert edges == sorted(edges) and all(0 <= t <= 60 * minutes for t in edges)
            assert all(b - a >= 59 for (_, a), (b, _) in zip(parts, parts[1:], strict=False))
