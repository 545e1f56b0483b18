"""Dead reckoning against the ship's own simulation."""

import math

import pytest
from ships import parameters

from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.dead_reckoning import predict
from shipcosim.models.prediction.predictor_inputs import Known, air_velocity
from shipcosim.models.prediction.surroundings import Surroundings
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters

HULL, WIND = parameters(HullParameters), parameters(WindParameters)
HORIZONS = (10.0, 30.0, 60.0)


def ahead(
    ship,
    thrusters=(0.0,) * 3,
    rest=(0.0,) * 3,
    air=(0.0, 0.0),
    current=(0.0, 0.0),
    longest_step=1.0,
):
    known, around = (
        Known(ship, (0.0,) * 3, thrusters, 0.0, 0.0),
        Surroundings(*air, *current, *rest, ()),
    )
    return predict(
        known, around, horizons=HORIZONS, longest_step=longest_step, hull=HULL, wind=WIND
    )


def simulated(ship, seconds, thrusters, rest, air, current):
    for _ in range(round(seconds / 0.05)):
        weather = wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, *air), wind=WIND)
        force = (*to_body(ship.psi, *rest[:2]), rest[2])
        tau = (sum(parts) for parts in zip(thrusters, force, weather, strict=True))
        ship = vessel.step(ship, *tau, *current, 0.05, hull=HULL)
    return ship


@pytest.mark.parametrize(("speed", "near"), [(0.3, 0.02), (5.0, 0.2)])
def test_prediction_is_the_simulation_with_loads_held(speed, near):
    ship = Motion(3.0, -2.0, 3.0, speed, 0.2, 0.02)
    loads = (5e3, -6e3, 3e4), (-500.0, 800.0, 2e3), (-6.0, -6.0), (-0.3, 0.1)
    for seconds, found in zip(HORIZONS, ahead(ship, *loads), strict=True):
        expected = simulated(ship, seconds, *loads)
        assert found[:2] == pytest.approx(expected[:2], abs=near)
        assert math.remainder(found.psi - expected.psi, 2.0 * math.pi) == pytest.approx(
            0.0, abs=2e-3
        )


def test_prediction_converges_with_the_step():
    ship, loads = (
        Motion(0.0, 0.0, 0.0, 3.0, 0.2, 0.02),
        ((5e3, -6e3, 3e4), (0.0,) * 3, (-6.0, -6.0), (-0.3, 0.1)),
    )
    best = ahead(ship, *loads, longest_step=0.02)[-1]
    errors = [math.dist(ahead(ship, *loads, longest_step=h)[-1][:2], best[:2]) for h in (2.0, 1.0)]
    assert errors[1] < 0.6 * errors[0]
    assert errors[1] < 0.1


def test_free_ship_at_rest_in_the_water_goes_with_the_current():
    current = (0.4, -0.3)
    air = current  # no wind over the water she drifts with
    u, v = to_body(0.7, *current)
    found = ahead(Motion(1.0, 2.0, 0.7, u, v, 0.0), air=air, current=current)
    for seconds, ship in zip(HORIZONS, found, strict=True):
        assert ship[:3] == pytest.approx((1.0 + 0.4 * seconds, 2.0 - 0.3 * seconds, 0.7), abs=1e-6)


def test_ship_without_any_load_stays():
    assert all(
        ship == pytest.approx((1.0, 2.0, 3.0, 0.0, 0.0, 0.0))
        for ship in ahead(Motion(1.0, 2.0, 3.0, 0, 0, 0))
    )


def test_air_velocity_is_that_of_which_the_apparent_wind_was_made():
    ship, air = Motion(0.0, 0.0, 2.0, 1.5, -0.4, 0.0), (-6.0, 3.0)
    known = Known(ship, (0.0,) * 3, (0.0,) * 3, *apparent_wind(ship.psi, ship.u, ship.v, *air))
    assert air_velocity(known) == pytest.approx(air)
