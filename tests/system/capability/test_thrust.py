"""Nominal thrust, ventilation, and the sectors in which a thruster must not push or loses."""

from dataclasses import replace

import numpy as np
import pytest
from capability.psv import HULL, THRUSTERS

from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS
from shipcosim.capability.sectors import Sector, pieces, sectors
from shipcosim.capability.thrust import ETA_2_ASTERN, nominal_thrust, ventilation

BEAM = np.array([0.5 * np.pi])


@pytest.mark.parametrize(
    "given, kilonewtons",
    [
        ((1.9, 500e3, 1200.0, 1.0, 0.995), 115.6),
        ((1.9, 500e3, 1200.0, ETA_2_ASTERN["fixed", True], 0.995), 80.9),
        ((1.0, 200e3, 900.0, 1.0, 0.93), 29.3),
        ((3.0, 2e6, 1200.0, 1.0, 0.93), 377.52),
        ((2.0, 0.9e6, 900.0, 1.07, 0.93), 135.77),
        ((1.8, 0.8e6, 800.0, 0.9, 0.93), 87.48),
    ],
)
def test_nominal_thrust_is_that_published_for_such_thrusters(given, kilonewtons):
    assert nominal_thrust(*given) / 1e3 == pytest.approx(kilonewtons, abs=0.05)


@pytest.mark.parametrize(
    "number, published", [(6, (0.985, 0.999, 0.999)), (11, (0.725, 0.861, 0.883))]
)
def test_ventilation_in_beam_seas_is_that_of_another_implementation(number, published):
    found = [ventilation(t, HULL, CONDITIONS[number - 1], BEAM)[0] for t in THRUSTERS[1:]]
    assert found == pytest.approx(published, abs=5e-4)


def test_deep_propellers_do_not_ventilate_and_shallow_ones_do():
    deep, shallow = (replace(THRUSTERS[0], submergence=d) for d in (30.0, 0.5))
    assert ventilation(deep, HULL, CONDITIONS[-1], DIRECTIONS) == pytest.approx(1.0)
    assert (ventilation(shallow, HULL, CONDITIONS[-1], DIRECTIONS) < 0.1).all()


def test_azimuths_side_by_side_must_not_push_away_from_each_other():
    """Thrust goes opposite to the race: the port unit's race hits starboard when it pushes to port."""
    port, starboard, *tunnels = THRUSTERS
    (found,) = sectors(port, THRUSTERS, ())
    assert np.degrees((found.middle, found.half)) == pytest.approx((-90.0, 20.44), abs=0.005)
    (found,) = sectors(starboard, THRUSTERS, ())
    assert np.degrees((found.middle, found.half)) == pytest.approx((90.0, 20.44), abs=0.005)
    assert not any(sectors(tunnel, THRUSTERS, ()) for tunnel in tunnels)


def test_a_thruster_that_stands_still_costs_thrust_in_a_narrow_sector_only():
    """s/D = 3.667, ducted: 1 - 1/2.386 = 0.581 in the middle, half-width atan(0.35/3.667) = 5.45 deg."""
    port, starboard = THRUSTERS[:2]
    (found,) = sectors(starboard, THRUSTERS[1:], [port])
    assert (found.share, np.degrees(found.half)) == pytest.approx((0.581, 5.45), abs=0.005)
    far = replace(port, y=-7.0)  # 12.5 m, more than four diameters
    assert sectors(starboard, [starboard], [far]) == []


def reach(parts, angle):
    """Largest thrust of an azimuth in a direction, by the corners of its pieces; the largest gap is 0.1 %."""
    ray, across = (
        np.array([np.cos(angle), np.sin(angle)]),
        np.array([-np.sin(angle), np.cos(angle)]),
    )
    best = 0.0
    for corners in parts:
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            sides = a @ across, b @ across
            if sides[0] * sides[1] <= 0.0 and sides[0] != sides[1]:
                best = max(best, float((a + sides[0] / (sides[0] - sides[1]) * (b - a)) @ ray))
    return best


def test_thrust_in_each_direction_is_the_circle_less_its_sectors():
    forbidden, narrowed = Sector(1.0, 0.3), Sector(-2.0, 0.2, 0.5)
    parts = pieces(replace(THRUSTERS[0], ahead=1.0), [forbidden, narrowed])
    for angle in np.linspace(-3.1, 3.1, 400):
        away = min(abs(angle - 1.0), 2 * np.pi - abs(angle - 1.0))
        if away < 0.299:
            assert reach(parts, angle) == 0.0
        elif abs(angle + 2.0) >= 0.2 and away > 0.301:
            assert reach(parts, angle) == pytest.approx(1.0, abs=1.1e-3)
    assert reach(parts, -2.0 + 1e-6) == pytest.approx(0.5, abs=1e-4)


def test_a_notch_is_straight_in_the_plane_of_forces():
    """Published: from 0.661 ahead to the circle at 6.843 deg the middle of the line is 0.829 at 4.120 deg."""
    notch = Sector(0.0, np.arctan(0.12), 1.0 - 1.0 / 2.95)
    parts = pieces(replace(THRUSTERS[0], ahead=1.0), [notch])
    assert reach(parts, np.radians(4.120)) == pytest.approx(0.829, abs=5e-4)


def test_every_piece_is_convex_and_no_wider_than_half_a_turn():
    port, starboard = THRUSTERS[:2]
    found = pieces(port, [*sectors(port, THRUSTERS, ()), Sector(2.0, 0.4, 0.3)])
    for corners in found:
        around = np.vstack([np.zeros((1, 2)), corners])
        edges = np.roll(around, -1, axis=0) - around
        after = np.roll(edges, -1, axis=0)
        turn = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
        assert (turn > -1e-6 * starboard.ahead**2).all()


def test_a_tunnel_pushes_both_ways_and_not_into_a_forbidden_sector():
    tunnel = THRUSTERS[2]
    (both,) = pieces(tunnel)
    assert both == pytest.approx(np.array([[0.0, 1.0], [0.0, -1.0]]) * tunnel.ahead, abs=1e-9)
    (one,) = pieces(tunnel, [Sector(0.5 * np.pi, 0.2)])
    assert one == pytest.approx(np.array([[0.0, 0.0], [0.0, -1.0]]) * tunnel.ahead, abs=1e-9)
