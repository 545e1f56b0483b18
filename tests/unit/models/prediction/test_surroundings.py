"""Current and remaining force of a simulated ship, told from what she knows."""

import math
from dataclasses import replace

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.kinematics import to_body, to_ned
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction import surroundings
from shipcosim.models.prediction.dead_reckoning import predict
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import SurroundingsParameters, unknown
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters, hull_loads

HULL, DP_SHIP = parameters(HullParameters), parameters(DpShip)
WIND = parameters(WindParameters)
STILL = replace(WIND, wind_load_scale=0.0)
ASSUMED = parameters(SurroundingsParameters)


def known_of(ship, current, force, thrusters=(0.0, 0.0, 0.0)):
    """What an observer without error knows of a ship: its bias is the load that its linear damping leaves."""
    X, Y, N = hull_loads(
        *vessel.through_water(ship.psi, ship.u, ship.v, *current), ship.r, hull=HULL
    )
    force_X, force_Y = to_body(ship.psi, *force)
    bias = (
        X + force_X + DP_SHIP.damping_surge * ship.u,
        Y + force_Y + DP_SHIP.damping_sway * ship.v,
        N + DP_SHIP.damping_yaw * ship.r,
    )
    return Known(ship, bias, thrusters, math.hypot(ship.u, ship.v), math.atan2(ship.v, ship.u))


def step(state, known, assumed=ASSUMED, wind=STILL):
    return surroundings.step(
        state, known, 1.0, hull=HULL, wind=wind, ship=DP_SHIP, parameters=assumed
    )


def held_then_adrift(current, force, psi=0.4, held=300, adrift=600, assumed=ASSUMED):
    """Surroundings and knowledge of a ship that is held at rest, and then set free, second by second."""
    ship = Motion(0.0, 0.0, psi, 0.0, 0.0, 0.0)
    known = known_of(ship, current, force)
    state = unknown(known, hull=HULL, parameters=assumed)
    for second in range(held + adrift):
        if second >= held:
            ship = vessel.step(ship, *to_body(ship.psi, *force), 0.0, *current, 1.0, hull=HULL)
        known = known_of(ship, current, force)
        state = step(state, known, assumed)
        yield state, known


def test_load_of_a_ship_at_rest_is_explained_whole():
    *_, (state, known) = held_then_adrift((0.3, -0.2), (400.0, -700.0), adrift=0)
    current = state.current_north, state.current_east
    X, Y, N = hull_loads(*vessel.through_water(known.ship.psi, 0.0, 0.0, *current), 0.0, hull=HULL)
    force_X, force_Y = to_body(known.ship.psi, state.force_north, state.force_east)
    assert (X + force_X, Y + force_Y) == pytest.approx(known.bias[:2], abs=300.0)
    assert N + state.moment == pytest.approx(
        known.bias[2], abs=300.0 * ASSUMED.force_lever * HULL.length
    )


@pytest.mark.parametrize("current", [(0.0, 0.4), (0.3, -0.2), (-0.4, 0.0)])
def test_ship_adrift_finds_the_current(current):
    """To 0.1 m/s: a cross flow of that speed loads her with 0.7 kN, half of the force that is assumed besides."""
    *_, (state, _) = held_then_adrift(current, (0.0, 0.0))
    assert state[2:4] == pytest.approx(current, abs=0.1)


@pytest.mark.parametrize("current", [(0.4, 0.3), (-0.4, 0.0), (-0.2, 0.4)])
def test_drift_is_predicted_nearer_with_a_current_than_with_the_bias_as_a_force(current):
    """The ship gathers way, and a force that was found at rest would push her further and further."""
    errors = []
    way = list(held_then_adrift(current, (400.0, -700.0)))
    for second in range(320, 840, 20):
        (state, known), (_, later) = way[second], way[second + 60]
        X, Y, N = known.bias
        held = state._replace(current_north=0.0, current_east=0.0, moment=N)
        held = held._replace(
            **dict(zip(("force_north", "force_east"), to_ned(known.ship.psi, X, Y), strict=True))
        )
        errors.append([math.dist(ahead(known, one)[:2], later.ship[:2]) for one in (state, held)])
    found, held = np.mean(errors, axis=0)
    assert found < 0.25 * held
    assert found < 2.0


def ahead(known, state):
    """The ship in 60 s."""
    return predict(known, state, horizons=(60.0,), longest_step=1.0, hull=HULL, wind=STILL)[0]


def test_estimate_turns_with_the_compass():
    """The same weather, turned together with the ship, gives the same estimates, turned."""
    turn, current, force = 1.7, (0.3, -0.2), (400.0, -700.0)
    *_, (state, _) = held_then_adrift(current, force, psi=0.0, adrift=200)
    *_, (other, _) = held_then_adrift(
        to_ned(turn, *current), to_ned(turn, *force), psi=turn, adrift=200
    )
    assert other[2:4] == pytest.approx(to_ned(turn, *state[2:4]), abs=1e-9)
    assert other[4:6] == pytest.approx(to_ned(turn, *state[4:6]), abs=1e-5)


def test_update_is_the_kalman_filters_in_matrices():
    """One sample against the filter written with matrices, at the slopes of central differences."""
    current = (0.3, -0.2)
    thrusters = 2e3, -3e3, 4e4
    known = known_of(Motion(0.0, 0.0, 0.4, 0.1, -0.2, 0.01), current, (400.0, -700.0), thrusters)
    start = unknown(known, hull=HULL, parameters=ASSUMED)
    start = start._replace(
        current_north=0.1, current_east=0.05, force_north=300.0, force_east=-50.0
    )
    start = start._replace(moment=700.0, thrust_error=(100.0, -300.0, 2e3))
    found = step(start, known)

    motion, c, sn = known.ship, math.cos(0.4), math.sin(0.4)
    to_ship = np.array([[c, sn], [-sn, c]])

    def load(water, force, moment, error):
        """Load in body axes, of the velocity of the water in body axes and of the force in north and east."""
        water_load = hull_loads(motion.u - water[0], motion.v - water[1], motion.r, hull=HULL)
        return np.array(water_load) + np.array([*(to_ship @ force), moment]) + error

    keep, held = math.exp(-1.0 / ASSUMED.force_time), math.exp(-1.0 / ASSUMED.thrust_error_time)
    lever, arm = 0.1 * HULL.length, 0.42 * HULL.length
    transition = np.diag([1.0, 1.0, keep, keep, keep, held, held, held])
    force = ASSUMED.force_std**2 * (1.0 - keep**2) * np.array([1.0, 1.0, lever**2])
    thrust = 2e3**2 + 3e3**2 + (4e4 / arm) ** 2
    error = (1.0 - held**2) * 0.3**2 * thrust * np.array([1.0, 1.0, arm**2])
    mean = transition @ np.array([*start[2:7], *start.thrust_error])
    grown = np.diag([*(ASSUMED.current_drift,) * 2, *force, *error])
    P = transition @ np.array(start.covariance) @ transition + grown
    span, water = np.sqrt(P[0, 0]), to_ship @ mean[:2]
    rest = mean[2:4], mean[4], mean[5:]
    slopes = [
        (load(water + d, *rest) - load(water - d, *rest)) / (2.0 * span) for d in span * np.eye(2)
    ]
    turned = np.vstack([to_ship, np.zeros((1, 2))])
    H = np.column_stack([np.column_stack(slopes) @ to_ship, turned, [0.0, 0.0, 1.0], np.eye(3)])
    damping = (
        DP_SHIP.damping_surge * motion.u,
        DP_SHIP.damping_sway * motion.v,
        DP_SHIP.damping_yaw * motion.r,
    )
    noise = ASSUMED.load_noise * np.diag([1.0, 1.0, lever**2])
    gain = P @ H.T @ np.linalg.inv(H @ P @ H.T + noise)
    innovation = np.array(known.bias) - damping - load(water, *rest)
    np.testing.assert_allclose(
        [*found[2:7], *found.thrust_error], mean + gain @ innovation, rtol=1e-9
    )
    np.testing.assert_allclose(found.covariance, P - gain @ H @ P, rtol=1e-7, atol=1e-4)


def of_thrusters(error, seconds=300, lost=0):
    """Surroundings of a ship held at rest whose thrusters give more than they are told, and what she knows.

    The error is what her observer's bias balances; of the last seconds, thrust is lost and the bias is still the same.
    """
    told = 3e3, -4e3, 6e4
    known = Known(Motion(0.0, 0.0, 0.4, 0.0, 0.0, 0.0), error, told, 0.0, 0.0)
    state = unknown(known, hull=HULL, parameters=ASSUMED)
    for second in range(seconds + lost):
        known = known._replace(thrusters=told if second < seconds else (0.0, 0.0, 0.0))
        state = step(state, known)
    return state, known


def test_errors_of_thrust_are_gone_with_the_thrust():
    """A moment that thrusters give by mistake does not turn a ship that has lost them."""
    error = 0.0, 0.0, 2e4
    state, known = of_thrusters(error)
    assert state.thrust_error[2] > 0.7 * error[2]
    with_thrust, without = (
        ahead(known, state),
        ahead(known._replace(thrusters=(0.0, 0.0, 0.0)), state),
    )
    none = ahead(known, state._replace(thrust_error=(0.0, 0.0, 0.0)))
    assert abs(with_thrust.psi - none.psi) > 0.1
    held = ahead(
        known._replace(thrusters=(0.0, 0.0, 0.0)),
        state._replace(moment=error[2], thrust_error=(0.0,) * 3),
    )
    assert abs(without.psi - 0.4) < 0.3 * abs(held.psi - 0.4)


def test_without_thrust_the_bias_is_the_ships_surroundings():
    state, _ = of_thrusters((0.0, 0.0, 0.0), seconds=0)
    assert state.thrust_error == (0.0, 0.0, 0.0)
    *_, (state, _) = held_then_adrift((0.3, -0.2), (400.0, -700.0))
    assert state.thrust_error == (0.0, 0.0, 0.0)


def test_wind_is_averaged():
    known = known_of(Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0), (0.0, 0.0))
    state = unknown(known, hull=HULL, parameters=ASSUMED)
    blow = known._replace(wind_speed=8.0, wind_from=0.0)
    for _ in range(round(ASSUMED.wind_time)):
        state = step(state, blow)
    assert state[:2] == pytest.approx((-8.0 * (1.0 - math.exp(-1.0)), 0.0))


def test_wind_that_is_not_believed_is_held_and_its_load_found_in_the_bias():
    """The controller feeds no wind forward then, so the bias grows by its load: current and force stay as they were."""
    *_, (state, known) = held_then_adrift((0.3, -0.2), (400.0, -700.0), adrift=0)
    state = state._replace(wind_north=-8.0, wind_east=1.0)
    ship = known.ship
    blown = wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, -8.0, 1.0), wind=WIND)
    bias = tuple(load + more for load, more in zip(known.bias, blown, strict=True))
    lost = known._replace(bias=bias, wind_speed=0.0, wind_believed=0.0)
    found, expected = step(state, lost, wind=WIND), step(state, known)
    assert found[:2] == (-8.0, 1.0)
    assert found[2:7] == pytest.approx(expected[2:7])


def test_what_is_known_well_is_not_learned():
    sure = replace(ASSUMED, current_std=1e-3, current_drift=0.0)
    *_, (state, _) = held_then_adrift((0.3, -0.2), (0.0, 0.0), adrift=0, assumed=sure)
    assert math.hypot(*state[2:4]) < 0.02
