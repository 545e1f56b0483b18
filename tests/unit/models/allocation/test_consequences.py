"""The consequence analysis against closed forms and against a linear program over drawn ships and loads."""

from math import cos, pi, sin

import numpy as np
import pytest
from scipy.optimize import linprog

from shipcosim.models.allocation.consequences import (
    MOST_SHARE,
    Averaged,
    ConsequenceParameters,
    averaged,
    failures_of,
    held_share,
    units_of,
)

ALL = (1.0,) * 6
AFT = {"x_1": -10.0, "y_1": -2.0, "x_2": -10.0, "y_2": 2.0}
TWO = AFT | {f"azimuth_rate_{i}": 0.2 for i in (1, 2)} | {f"thrust_max_{i}": 50e3 for i in (1, 2)}
TUNNEL = {"x_3": 12.0, "azimuth_3": 0.5 * pi, "thrust_min_3": -20e3, "thrust_max_3": 20e3}
SHIP = ConsequenceParameters(**TWO, **TUNNEL, group_1=1.0, group_2=2.0, group_3=1.0)


def share(load, usable=ALL, heading=1.0, ship=SHIP):
    return held_share(load, usable, units=units_of(ship), heading=heading)


def test_two_azimuths_side_by_side_push_ahead_with_both():
    assert share((40e3, 0.0, 0.0)) == pytest.approx(2.5, rel=1e-3)
    assert share((40e3, 0.0, 0.0), (1.0, 0.0, 1.0, 0.0, 0.0, 0.0), heading=0.0) == pytest.approx(
        1.25, rel=1e-3
    )


def test_one_azimuth_alone_holds_the_force_and_not_the_moment():
    left = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    assert share((-20e3, 0.0, 0.0), left) == pytest.approx(0.0, abs=1e-3)
    assert share((-20e3, 0.0, 0.0), left, heading=0.0) == pytest.approx(2.5, rel=1e-3)
    # The moment that comes with its own force is no further load.
    force = -15e3, 20e3
    assert share((*force, -10.0 * force[1] + 2.0 * force[0]), left) == pytest.approx(2.0, rel=1e-3)


def test_a_tunnel_gives_its_force_to_either_side():
    left = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    for side in (1.0, -1.0):
        assert share((0.0, side * 10e3, side * 120e3), left) == pytest.approx(2.0, rel=1e-3)


def test_no_load_is_held_even_without_units():
    assert share((0.0, 0.0, 0.0)) == share((0.0, 0.0, 0.0), (0.0,) * 6) == MOST_SHARE
    assert share((1.0, 2.0, 3.0)) == MOST_SHARE
    assert share((1e3, 0.0, 0.0), (0.0,) * 6) == pytest.approx(0.0, abs=1e-3)


def test_failures_are_units_that_are_there_and_groups_that_have_some():
    units, groups = failures_of(SHIP)[:6], failures_of(SHIP)[6:]
    assert [bool(left) for left in units] == [True, True, True, False, False, False]
    assert units[1] == (1.0, 0.0, 1.0, 1.0, 1.0, 1.0)
    assert groups == ((0.0, 1.0, 0.0, 1.0, 1.0, 1.0), (1.0, 0.0, 1.0, 1.0, 1.0, 1.0), ())


def test_the_average_is_of_what_has_come():
    state = Averaged((0.0, 0.0, 0.0), 0.0)
    for _ in range(10):
        state = averaged(state, (1e3, -2e3, 5e3), 0.5, parameters=SHIP)
    assert np.divide(state.load, state.weight) == pytest.approx([1e3, -2e3, 5e3])
    for _ in range(1200):
        state = averaged(state, (4e3, 0.0, 0.0), 0.5, parameters=SHIP)
    assert np.divide(state.load, state.weight) == pytest.approx([4e3, 0.0, 0.0], abs=1.0)


def drawn(rng):
    """A ship of two to six units, a load and what is left of the units."""
    number = int(rng.integers(2, 7))
    values = {}
    for i in range(1, number + 1):
        most = rng.uniform(5e3, 100e3)
        values |= {f"x_{i}": rng.uniform(-40.0, 40.0), f"y_{i}": rng.uniform(-8.0, 8.0)}
        values |= {f"thrust_max_{i}": most, f"azimuth_{i}": rng.uniform(-pi, pi)}
        if rng.random() < 0.6:
            values[f"azimuth_rate_{i}"] = 0.2
            if rng.random() < 0.5:
                first = rng.uniform(-pi, pi)
                values |= {
                    f"azimuth_first_{i}": first,
                    f"azimuth_last_{i}": first + rng.uniform(0.2, 3.1),
                }
        else:
            values[f"thrust_min_{i}"] = -rng.uniform(0.0, 1.0) * most
    load = rng.normal(size=3) * (20e3, 20e3, 400e3) * (rng.random(3) < 0.8)
    usable = tuple(float(rng.random() < 0.8) for _ in range(6))
    return ConsequenceParameters(**values), tuple(load.tolist()), usable


def by_linear_program(ship, load, usable, heading):
    """The same share; the disc of an azimuth has 720 corners."""
    columns, owners = [], []
    for i in range(6):
        number = i + 1
        most = getattr(ship, f"thrust_max_{number}")
        first, last = (
            getattr(ship, f"azimuth_first_{number}"),
            getattr(ship, f"azimuth_last_{number}"),
        )
        angle = getattr(ship, f"azimuth_{number}")
        thrusts = [(most, angle), (getattr(ship, f"thrust_min_{number}"), angle)]
        if getattr(ship, f"azimuth_rate_{number}") > 0.0:
            ends = (first, last) if last > first else (0.0, 2.0 * pi)
            thrusts = [(most, a) for a in np.linspace(*ends, 721)]
        for thrust, a in thrusts:
            X, Y = usable[i] * thrust * cos(a), usable[i] * thrust * sin(a)
            x, y = getattr(ship, f"x_{number}"), getattr(ship, f"y_{number}")
            columns.append((X, Y, heading * (x * Y - y * X)))
            owners.append(i)
    scale = 1e5, 1e5, 1e6
    effect = np.column_stack([np.transpose(columns), -np.array(load) * (1.0, 1.0, heading)])
    effect /= np.reshape(scale, (3, 1))
    once = np.zeros((6, len(columns) + 1))
    once[owners, range(len(columns))] = 1.0
    price = np.zeros(len(columns) + 1)
    price[-1] = -1.0
    bounds = [(0.0, None)] * len(columns) + [(0.0, MOST_SHARE)]
    found = linprog(price, once, np.ones(6), effect, np.zeros(3), bounds)
    assert found.status == 0
    return -found.fun


@pytest.mark.parametrize("seed", range(40))
def test_the_share_is_that_of_a_linear_program(seed):
    ship, load, usable = drawn(np.random.default_rng(seed))
    if not any(load[:2]):
        return
    for heading in (1.0, 0.0):
        right = by_linear_program(ship, load, usable, heading)
        assert share(load, usable, heading, ship) == pytest.approx(right, rel=3e-3, abs=6e-3)


@pytest.mark.parametrize("seed", range(20))
def test_it_falls_with_the_load_and_with_every_loss(seed):
    ship, load, usable = drawn(np.random.default_rng(1000 + seed))
    held = share(load, usable, ship=ship)
    if held < MOST_SHARE:
        doubled = share(tuple(2.0 * part for part in load), usable, ship=ship)
        assert doubled == pytest.approx(0.5 * held, rel=1e-9)
    assert share(load, usable, 0.0, ship) >= held * (1.0 - 2e-3)
    for lost in range(6):
        left = tuple(0.0 if i == lost else one for i, one in enumerate(usable))
        assert share(load, left, ship=ship) <= held * (1.0 + 2e-3) + 6e-3


@pytest.mark.parametrize("seed", range(10))
def test_a_mirrored_ship_holds_the_mirrored_load(seed):
    ship, load, usable = drawn(np.random.default_rng(2000 + seed))
    values = {}
    for i in range(1, 7):
        first, last = getattr(ship, f"azimuth_first_{i}"), getattr(ship, f"azimuth_last_{i}")
        values |= {
            name: getattr(ship, name) for name in (f"x_{i}", f"azimuth_rate_{i}", f"thrust_min_{i}")
        }
        values |= {f"thrust_max_{i}": getattr(ship, f"thrust_max_{i}")}
        values |= {
            f"y_{i}": -getattr(ship, f"y_{i}"),
            f"azimuth_{i}": -getattr(ship, f"azimuth_{i}"),
        }
        values |= {f"azimuth_first_{i}": -last, f"azimuth_last_{i}": -first}
    mirrored = ConsequenceParameters(**values)
    X, Y, N = load
    assert share((X, -Y, -N), usable, ship=mirrored) == pytest.approx(
        share(load, usable, ship=ship), rel=2e-3, abs=2e-3
    )
