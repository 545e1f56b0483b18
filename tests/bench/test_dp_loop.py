"""At night: whether the DP loop holds on many seeds, with two units only, and in a storm."""

import math

import numpy as np
import pytest
from dp_runs import MODERATE, NORTH_EAST, ROUGH, SEA, simulate

LEGS = [
    (0.0, {"reference.x_set": 20.0}),
    (250.0, {"reference.y_set": -20.0}),
    (450.0, {"reference.psi_set": -NORTH_EAST}),
    (650.0, {"reference.x_set": 0.0}),
    (850.0, {"reference.y_set": 0.0, "reference.psi_set": 0.0}),
]


CORNERS = [
    (250, 20, 0, 0),
    (450, 20, -20, 0),
    (650, 20, -20, -NORTH_EAST),
    (850, 0, -20, -NORTH_EAST),
    (1100, 0, 0, 0),
]


def worst_at_corners(run):
    """Largest distance along north or east and largest turn in the last 20 s of each leg: (legs, m) each. [m, deg]"""
    places, turns = [], []
    for end, x, y, psi in CORNERS:
        rows = (run["time"] > end - 20.0 - 1e-6) & (run["time"] < end + 1e-6)
        north, east = run["vessel.x"][rows] - x, run["vessel.y"][rows] - y
        places.append(np.maximum(np.abs(north), np.abs(east)).max(axis=0))
        turns.append(np.abs(run["vessel.psi"][rows] - psi).max(axis=0))
    return np.array(places), np.degrees(turns)


def test_a_minute_of_dead_reckoning_ends_within_5_m_on_20_seeds_and_the_thrust_does_not_jump():
    """Seeds that nothing was tuned on."""
    lost, found = (
        {f"sensors.position_{i}_lost": value for i in (1, 2, 3)} for value in (True, False)
    )
    run = simulate(
        range(3001, 3021), MODERATE, [(300.0, lost), (360.0, found)], stop_time=420.0, every=10
    )
    time, distance = run["time"], np.hypot(run["vessel.x"], run["vessel.y"])
    last = distance[np.argmin(np.abs(time - 360.0))]
    print(f"after 60 s: {last.mean():.2f} m in the mean, {last.max():.2f} m at worst")
    assert last.max() < 5.0 and distance[time > 400.0].max() < 1.0
    assert run["controller.dead_reckoning_time"].max(axis=0).min() > 59.0
    before, at_return = (time > 200.0) & (time < 300.0), (time > 358.0) & (time < 380.0)
    for unit in ("port", "starboard", "tunnel"):
        changes = np.abs(np.diff(run[f"{unit}.thrust"], axis=0))
        assert changes[at_return[1:]].max() < 1.5 * changes[before[1:]].max()


@pytest.mark.parametrize(("values", "metres", "degrees"), [(MODERATE, 0.5, 1.0), (ROUGH, 1.0, 2.0)])
def test_four_corners_are_held_on_20_seeds(values, metres, degrees):
    run = simulate(range(1, 21), values, LEGS, stop_time=1100.0, every=10, record="vessel")
    places, turns = worst_at_corners(run)
    held = (places < metres).all(axis=0) & (turns < degrees).all(axis=0)
    assert held.all()


@pytest.mark.parametrize("unit", ["port", "starboard", "tunnel"])
def test_any_two_units_keep_the_place_while_the_heading_goes(unit):
    run = simulate(
        [1, 2, 3], MODERATE, [(100.0, {f"{unit}.failed": True})], stop_time=600.0, every=10
    )
    assert np.hypot(run["vessel.x"], run["vessel.y"]).max() < 8.0
    assert run["allocator.saturated"][-200:].mean() > 0.9


def test_storm_that_is_too_strong_is_said_and_leaves_nothing_wound_up():
    east = {"environment.waves_from": math.pi / 2.0, "environment.wind_from": math.pi / 2.0}
    values = (
        SEA | east | {"environment.significant_wave_height": 0.5, "environment.peak_period": 6.0}
    )
    events = [(100.0, {"environment.wind_speed": 18.0}), (250.0, {"environment.wind_speed": 6.0})]
    run = simulate(
        [1, 2, 3], values | {"environment.wind_speed": 8.0}, events, stop_time=550.0, every=10
    )
    distance, time = np.hypot(run["vessel.x"], run["vessel.y"]), run["time"]
    storm, after = (time > 150.0) & (time < 250.0), time > 450.0
    assert distance[storm].max() > 3.0 and run["allocator.saturated"][storm].mean() > 0.5
    assert distance[after].max() < 1.0 and np.abs(run["vessel.psi"][after]).max() < math.radians(
        2.0
    )
