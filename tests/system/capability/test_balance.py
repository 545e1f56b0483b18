"""The balance against closed forms, against brute force, and against what must hold of any."""

import numpy as np
import pytest
from capability.psv import HULL, THRUSTERS, thruster

from shipcosim.capability.balance import MOST, Actuator, largest_share
from shipcosim.capability.conditions import CONDITIONS, DIRECTIONS
from shipcosim.capability.loads import level_1_parts
from shipcosim.capability.sectors import Sector, pieces, sectors
from shipcosim.capability.thrust import ventilation


def actuator(x, y, corners, count=1):
    return Actuator(x, y, [np.array(part, float) for part in corners], np.ones(count))


def disc(thrust, corners=1800):
    angles = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)
    return [thrust * np.stack([np.cos(angles), np.sin(angles)], axis=1)]


def test_one_fixed_propeller_holds_head_wind_up_to_its_thrust_and_nothing_from_the_side():
    propeller = actuator(-20.0, 0.0, [[(100.0, 0.0), (-40.0, 0.0)]], 4)
    loads = [(-50.0, 0.0, 0.0), (80.0, 0.0, 0.0), (0.0, 10.0, 0.0), (-50.0, 10.0, 0.0)]
    assert largest_share([propeller], np.array(loads)) == pytest.approx(
        (2.0, 0.5, 0.0, 0.0), abs=1e-9
    )


def test_two_tunnels_hold_a_side_force_between_them_as_a_beam_on_two_supports():
    """Supports at 30 and -10, force at 0: three quarters of it on the nearer one, which gives 60."""
    tunnels = [actuator(x, 0.0, [[(0.0, 60.0), (0.0, -60.0)]]) for x in (30.0, -10.0)]
    assert largest_share(tunnels, np.array([(0.0, 120.0, 0.0)])) == pytest.approx(60.0 / 90.0)


def test_azimuth_and_tunnel_have_one_way_to_balance_a_load():
    """Three unknowns, three equations: each force follows, and the first at its limit sets the share."""
    rng = np.random.default_rng(3)
    loads = rng.normal(size=(40, 3)) * [50.0, 50.0, 500.0]
    found = largest_share(
        [
            Actuator(-15.0, 2.0, disc(100.0), np.ones(40)),
            Actuator(12.0, 0.0, [np.array([(0.0, 30.0), (0.0, -30.0)])], np.ones(40)),
        ],
        loads,
    )
    forces = np.linalg.solve([[1, 0, 0], [0, 1, 1], [-2.0, -15.0, 12.0]], -loads.T)
    expected = np.minimum(100.0 / np.hypot(*forces[:2]), 30.0 / np.abs(forces[2]))
    assert found == pytest.approx(expected, rel=2e-6)


UNITS, MIDDLES, BOW = ((-15.0, -2.0), (-15.0, 2.0)), (-0.5 * np.pi, 0.5 * np.pi), 15.0


def brute_share(load, bow, half):
    """Largest share of a load that two azimuths of 100 and a tunnel hold, over a fine grid.

    The grid is over surge and sway of the first azimuth; what the tunnel and the second must give follows.
    """
    steps, best = 100.0 * np.linspace(-1.0, 1.0, 241), 0.0
    (x, y1), (_, y2) = UNITS
    fx, fy = (grid.ravel() for grid in np.meshgrid(steps, steps))
    for share in np.linspace(0.02, 3.0, 150):
        X, Y, N = -share * np.asarray(load)
        tunnel = (N - x * Y + y2 * X + (y1 - y2) * fx) / (BOW - x)
        fits = np.abs(tunnel) <= bow
        for (a, b), middle in zip(((fx, fy), (X - fx, Y - tunnel - fy)), MIDDLES, strict=True):
            size, away = (
                np.hypot(a, b),
                np.abs((np.arctan2(b, a) - middle + np.pi) % (2.0 * np.pi) - np.pi),
            )
            fits &= (size <= 100.0) & ((away >= half) | (size < 1e-9))
        best = share if fits.any() else best
    return best


@pytest.mark.parametrize(
    "load, bow, half, narrows",
    [
        ((-20.0, 60.0, 0.0), 30.0, 0.5, False),
        ((60.0, 90.0, 300.0), 30.0, 0.5, False),
        ((0.0, 240.0, 220.0), 200.0, 0.5, True),
        ((0.0, 240.0, 220.0), 200.0, 1.0, True),
        ((-20.0, -140.0, 2000.0), 200.0, 1.0, True),
    ],
)
def test_forbidden_sectors_of_two_azimuths_are_as_brute_force_has_them(load, bow, half, narrows):
    """The grid finds what is there up to its steps of 2 %."""

    def share(half):
        made = [actuator(BOW, 0.0, [[(0.0, bow), (0.0, -bow)]])]
        for (x, y), middle in zip(UNITS, MIDDLES, strict=True):
            unit = thruster("unit", "azimuth", x, y, diameter=1.0, power=1e3, height=0.0, eta_1=1.0)
            parts = pieces(unit, [Sector(middle, half)] if half else ())
            made.append(Actuator(x, y, [100.0 / unit.ahead * part for part in parts], np.ones(1)))
        return largest_share(made, np.array([load]))[0]

    assert 0.97 * share(half) - 0.02 <= brute_share(load, bow, half) <= 1.002 * share(half)
    assert (share(half) < 0.97 * share(0.0)) == narrows


def test_a_sector_cut_out_never_helps_and_its_pieces_together_are_the_disc():
    """Cut at an angle without forbidding anything, the pieces give what the whole disc gives."""
    loads = sum(level_1_parts(HULL, CONDITIONS[3], DIRECTIONS).values())
    left = np.ones(len(DIRECTIONS))

    def share(narrowed):
        whole = [
            Actuator(t.x, t.y, pieces(t, narrowed if t.kind == "azimuth" else ()), left)
            for t in THRUSTERS
        ]
        return largest_share(whole, loads)

    assert share([Sector(0.7, 1e-9, 0.999)]) == pytest.approx(share([]), rel=2e-3)
    assert (share([Sector(0.7, 0.4)]) <= share([]) * (1.0 + 2e-3)).all()


def test_share_of_thrust_used_is_that_of_another_implementation():
    """Published of the supply vessel without its skeg: 0.747 and 1.055 at the beam, 0.995, 1.039; corners of 10 deg."""
    published = {
        (6, 9): 0.747,
        (7, 9): 1.055,
        (7, 10): 0.995,
        (11, 16): 1.039,
        (11, 0): 0.628,
        (11, 18): 0.650,
    }
    for (number, k), expected in published.items():
        condition, angle = CONDITIONS[number - 1], DIRECTIONS[k : k + 1]
        made = [
            Actuator(
                t.x,
                t.y,
                pieces(t, sectors(t, THRUSTERS, ())),
                0.9 * ventilation(t, HULL, condition, angle),
            )
            for t in THRUSTERS
        ]
        (share,) = largest_share(made, 1.25 * sum(level_1_parts(HULL, condition, angle).values()))
        assert 1.0 / share == pytest.approx(expected, abs=2e-3)


def test_nothing_to_push_with_holds_nothing_and_no_load_needs_nothing():
    none = actuator(0.0, 0.0, [np.zeros((2, 2))], 2)
    assert largest_share([none], np.ones((2, 3))) == pytest.approx(0.0)
    assert largest_share([], np.ones((2, 3))) == pytest.approx(0.0)
    behind = actuator(-20.0, 0.0, [[(0.0, 60.0), (0.0, -60.0)]])
    assert not np.signbit(
        largest_share([behind], np.array([(5.0, 5.0, 5.0)]))
    ).any()  # one over it is infinite
    assert largest_share([actuator(0.0, 0.0, disc(1.0, 36))], np.zeros((1, 3))) == pytest.approx(
        MOST
    )
