"""Prediction of DP: balances that can be told by hand, and limits of the reference and of thrust."""

import math
from dataclasses import replace

import pytest
from ships import parameters

from shipcosim.models.allocation import pseudo_inverse
from shipcosim.models.control import reference
from shipcosim.models.control.observer import DpShip
from shipcosim.models.control.pid import ControlParameters, Desired
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import controlled
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings
from shipcosim.models.ship.hull import HullParameters

HORIZONS, REST = (10.0, 30.0, 60.0), (0.0,) * 6
UNITS, SLOW = parameters(pseudo_inverse.AllocationParameters), parameters(ReferenceParameters)


def ahead(
    ship,
    thrusters,
    goal,
    *,
    force=(0.0,) * 3,
    desired=None,
    units=UNITS,
    longest_step=2.0,
    wave_frequency=2.0,
):
    """Prediction in calm air and water with a force that the bias has found; thrusters as they are told now."""
    desired = Desired(*(desired or goal), *REST)
    known = Known(ship, force, thrusters, 0.0, 0.0, 1.0, desired, goal, wave_frequency)
    loop = controlled.ControlLoop(
        SLOW,
        parameters(DpShip),
        parameters(ControlParameters),
        units,
        pseudo_inverse.design(units),
        parameters(controlled.ObserverAhead),
    )
    around = Surroundings(0.0, 0.0, 0.0, 0.0, *force, ())
    model = {"hull": parameters(HullParameters), "wind": parameters(WindParameters)}
    return controlled.predict(
        known, around, horizons=HORIZONS, longest_step=longest_step, loop=loop, **model
    )


def test_ship_in_balance_stays_where_she_is():
    force = 3e3, -4e3, 2e4
    found = ahead(
        Motion(1.0, 2.0, 0.0, 0.0, 0.0, 0.0),
        tuple(-one for one in force),
        (1.0, 2.0, 0.0),
        force=force,
    )
    assert all(ship == pytest.approx((1.0, 2.0, 0.0, 0.0, 0.0, 0.0), abs=1e-9) for ship in found)


def test_ship_off_her_place_comes_back_with_the_poles_of_the_law():
    """Half a metre off: the double pole of the law, whose filter of the force takes little from it."""
    found = ahead(Motion(0.5, 0.0, 0.0, 0.0, 0.0, 0.0), (10.0, 10.0, 0.0), (0.0, 0.0, 0.0))
    w = parameters(ControlParameters).surge_frequency
    expected = [0.5 * math.exp(-w * t) * (1.0 + w * t) for t in HORIZONS]
    assert [ship.x for ship in found] == pytest.approx(expected, abs=0.05)
    assert [ship.y for ship in found] == pytest.approx([0.0] * 3, abs=1e-3)


def test_ship_follows_her_reference_to_a_new_place():
    """Sway lags while she turns."""
    found = ahead(Motion(*REST), (10.0, 10.0, 0.0), (20.0, -10.0, 0.5), desired=(0.0, 0.0, 0.0))
    state = reference.at_rest(0.0, 0.0, 0.0)
    for seconds, ship in zip((10.0, 20.0, 30.0), found, strict=True):
        state = reference.step(state, (20.0, -10.0, 0.5), seconds, parameters=SLOW)
        assert ship[:2] == pytest.approx(state[:2], abs=1.0)
        assert ship.psi == pytest.approx(state.psi, abs=0.02)


def test_prediction_hardly_changes_with_the_step():
    given = (Motion(*REST), (2e3, -3e3, 1e4), (20.0, -10.0, 0.5)), {"desired": (0.0, 0.0, 0.0)}
    long, short = (ahead(*given[0], longest_step=h, **given[1]) for h in (2.0, 0.1))
    for one, other in zip(long, short, strict=True):
        assert math.dist(one[:2], other[:2]) < 0.05


def test_thrust_ends_at_its_limits():
    """Units of 2 kN cannot hold her against 20 kN: she is driven off, as far as with thrust astern of both."""
    weak = replace(UNITS, azimuth_thrust_min=-2e3, azimuth_thrust_max=2e3, tunnel_thrust_max=2e3)
    held, lost = (
        ahead(Motion(*REST), (-2e3, 0.0, 0.0), (0.0,) * 3, force=(2e4, 0.0, 0.0), units=one)
        for one in (UNITS, weak)
    )
    assert abs(held[-1].x) < 2.0 and lost[-1].x > 20.0


def test_missing_unit_stays_missing():
    """Without the tunnel thruster two azimuths cannot turn her and stay: more of the side force is not met."""
    effect = pseudo_inverse.effect(UNITS)
    two = tuple(2e3 * (effect[0][axis] - effect[1][axis]) for axis in range(3))
    off = Motion(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    whole, without = (
        ahead(off, load, (0.0,) * 3) for load in ((two[0], two[1] + 1.0, two[2]), two)
    )
    assert abs(without[-1].psi) > 5.0 * abs(whole[-1].psi) > 0.0


def test_in_long_waves_dp_is_slower():
    quick, slow = (
        ahead(Motion(1.0, *REST[1:]), (10.0, 10.0, 0.0), (0.0,) * 3, wave_frequency=w)
        for w in (2.0, 0.5)
    )
    assert slow[1].x > quick[1].x + 0.1
