"""What a ship learns from her own record, against ships whose current and thrusters are known."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ships import parameters

from shipcosim.angles import wrap
from shipcosim.models.control.observer import DpShip
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction import dead_reckoning, drift_off, own_model, own_record
from shipcosim.models.prediction.own_model import COEFFICIENTS, CURRENT, Learned, Thrust
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings, SurroundingsParameters
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters, hull_loads

HULL, WIND, DP_SHIP = parameters(HullParameters), parameters(WindParameters), parameters(DpShip)
ASSUMED = parameters(SurroundingsParameters)
HORIZONS = (10.0, 30.0, 60.0)
MODEL = {"hull": HULL, "wind": WIND}
WEIGHTS = Path(__file__).parents[4] / "fmus" / "drift_predictor" / "weights" / "ours.npz"
TRAINED = drift_off.trained_of(read_arrays(WEIGHTS))
BELIEFS = TRAINED.learned
AIR, WATER = (-5.0, 3.0), (0.25, -0.15)


def known_of(ship, thrusters=(0.0, 0.0, 0.0), bias=(0.0, 0.0, 0.0), air=AIR):
    return Known(ship, bias, thrusters, *apparent_wind(ship.psi, ship.u, ship.v, *air))


def wind_load(ship):
    return wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, *AIR), wind=WIND)


def held_then_adrift(held=120, adrift=60):
    """What a ship of the nominal model knows, held at rest in wind and current, then set free, second by second."""
    ship = Motion(0.0, 0.0, 0.4, 0.0, 0.0, 0.0)
    for second in range(held + adrift):
        water = hull_loads(
            *vessel.through_water(ship.psi, ship.u, ship.v, *WATER), ship.r, hull=HULL
        )
        thrust = (
            tuple(-a - b for a, b in zip(water, wind_load(ship), strict=True))
            if second < held
            else (0.0,) * 3
        )
        yield known_of(ship, thrust)
        if second >= held:
            for _ in range(10):
                ship = vessel.step(ship, *wind_load(ship), *WATER, 0.1, hull=HULL)


def followed(learned=BELIEFS, seconds=180):
    """The record of `held_then_adrift`, and what is known at its end."""
    samples = list(held_then_adrift())[:seconds]
    record = own_record.begin(samples[0], learned=learned, hull=HULL)
    for known in samples[1:]:
        record = own_record.step(record, known, 1.0, learned=learned, **MODEL)
    return record, known


def test_a_drifting_ship_learns_the_current():
    record, _ = followed()
    assert expected(record)[CURRENT] == pytest.approx(WATER, abs=0.07)


def expected(record):
    """Mean of all filters."""
    return own_record.weights(record) @ record.mean


def test_the_filter_that_began_against_the_current_has_the_least_weight():
    toward = np.array(own_record.DIRECTIONS) @ WATER
    share = own_record.weights(followed()[0])
    assert share.sum() == pytest.approx(1.0) and share[np.argmin(toward)] == share.min()


def changed(what, at=200, end=420):
    """What a drifting ship knows, second by second, whose current or hull and wind load change while she runs."""
    ship, current, hull, wind = Motion(0.0, 0.0, 0.4, 0.0, 0.0, 0.0), WATER, HULL, WIND
    for second in range(end):
        if second == at and what == "current":
            current = -0.1, 0.35
        elif second == at:
            hull = replace(HULL, cross_flow_scale=2.0)
            wind = replace(WIND, wind_load_scale=1.6)
        yield known_of(ship)
        for _ in range(5):
            load = wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, *AIR), wind=wind)
            ship = vessel.step(ship, *load, *current, 0.2, hull=hull)


@pytest.mark.parametrize("what", ["current", "ship"])
def test_after_a_change_errors_come_down_while_she_runs(what):
    """It refits itself, without a stop: 30 s ahead, made before the change, just after it, and two minutes later."""
    samples, record, off = list(changed(what)), None, {}
    for second, known in enumerate(samples[:-30]):
        if record is None:
            record = own_record.begin(known, learned=BELIEFS, hull=HULL)
        else:
            record = own_record.step(record, known, 1.0, learned=BELIEFS, **MODEL)
        if second in (165, 205, 360):
            found = own_record.predict(
                record, known, horizons=(30.0,), steps=(10,), learned=BELIEFS, **MODEL
            )
            off[second] = math.dist(
                own_record.mixed(record, found[0])[:2], samples[second + 30].ship[:2]
            )
    assert off[205] > 2.0 * off[165]
    assert off[360] < 0.5 * off[205]


def test_places_are_told_apart_across_a_turn():
    """Heading goes round and round, as estimates are wrapped; so it is no jump of half a turn."""
    ship, record = Motion(0.0, 0.0, 3.1, 0.0, 0.0, 0.02), None
    for second in range(20):
        known = known_of(ship._replace(psi=wrap(3.1 + 0.02 * second)))
        if record is None:
            record = own_record.begin(known, learned=BELIEFS, hull=HULL)
        record = own_record.step(record, known, 1.0, learned=BELIEFS, **MODEL)
    assert expected(record)[5] == pytest.approx(0.02, abs=0.01)


def test_a_filter_gone_astray_begins_anew_and_has_no_say():
    record, known = followed()
    record.mean[2, 3] = 1e9
    with np.errstate(all="raise"):
        record = own_record.step(record, known, 1.0, learned=BELIEFS, **MODEL)
    assert np.isfinite(record.mean).all() and np.isfinite(record.covariance).all()
    assert record.mean[2, 3] == known.ship.u and own_record.weights(record)[2] < 1e-12


def test_what_is_learned_shrinks_the_doubt():
    first = own_record.begin(next(held_then_adrift()), learned=BELIEFS, hull=HULL).covariance
    last = followed()[0].covariance
    first, now = (np.diagonal(one, axis1=-2, axis2=-1)[:, CURRENT] for one in (first, last))
    assert (now < 0.3 * first).all()
    assert (
        np.linalg.eigvalsh(last).min(axis=-1) > -1e-9 * np.trace(last, axis1=-2, axis2=-1)
    ).all()


def test_without_errors_of_the_model_the_prediction_is_dead_reckoning():
    ship = Motion(3.0, -2.0, 1.0, 0.3, -0.2, 0.004)
    exact = BELIEFS._replace(mean=np.zeros(len(COEFFICIENTS)))
    record = own_record.begin(known_of(ship), learned=exact, hull=HULL)
    record.mean[:, CURRENT] = WATER
    around = Surroundings(*AIR, *WATER, 0.0, 0.0, 0.0, ())
    expected = dead_reckoning.predict(
        known_of(ship), around, horizons=HORIZONS, longest_step=0.2, **MODEL
    )
    found = own_record.predict(
        record, known_of(ship), horizons=HORIZONS, steps=(10, 20, 30), learned=exact, **MODEL
    )
    for one, other in zip(
        (own_record.mixed(record, each) for each in found), expected, strict=True
    ):
        assert one[:2] == pytest.approx(other[:2], abs=0.03)
        assert one.psi == pytest.approx(other.psi, abs=2e-3)


def test_thrust_runs_down_alike_in_long_and_short_steps():
    nothing, thrust = Thrust(0.0, 0.0, 0.0), Thrust(8e3, -3e3, 5e3)
    once = own_model.delivered(thrust, nothing, 4.0, learned=BELIEFS)
    for _ in range(40):
        thrust = own_model.delivered(thrust, nothing, 0.1, learned=BELIEFS)
    assert thrust == pytest.approx(once, rel=1e-3)
    assert 0.0 < once.bow < 8e3


def test_thrust_follows_what_it_is_told():
    told, thrust = Thrust(8e3, -3e3, 5e3), Thrust(0.0, 0.0, 0.0)
    for _ in range(60):
        thrust = own_model.delivered(thrust, told, 1.0, learned=BELIEFS)
    assert thrust == pytest.approx(told, rel=1e-3)


def test_told_thrust_gives_the_load():
    X, Y, N = 4e3, -7e3, 9e4
    thrust, arm = own_model.thrust_told((X, Y, N), HULL), own_model.ARM * HULL.length
    assert thrust.stern_X == X
    assert thrust.bow + thrust.stern_Y == pytest.approx(Y)
    assert arm * (thrust.bow - thrust.stern_Y) == pytest.approx(N)


def test_residual_load_damps():
    """Each coefficient of the hull takes energy from a ship that moves in its direction alone."""
    for k, motion in {
        0: (1.0, 0.0, 0.0),
        1: (1.0, 0.0, 0.0),
        2: (0.0, 1.0, 0.0),
        3: (0.0, 1.0, 0.0),
        7: (0, 0, 0.02),
    }.items():
        one = tuple(float(k == number) for number in range(len(COEFFICIENTS)))
        load = own_model.damping_error(one, *map(float, motion), 0.0, HULL)
        assert sum(a * b for a, b in zip(load, motion, strict=True)) < 0.0


def test_port_mirrors_starboard():
    rng = np.random.default_rng(1)
    c, (u, v, r) = tuple(rng.normal(size=len(COEFFICIENTS))), rng.normal(size=3) * (1.0, 1.0, 0.02)
    wind, thrust = rng.normal(size=3) * (1e3, 1e3, 1e4), Thrust(*(rng.normal(size=3) * 1e3))
    mirror = Thrust(-thrust.bow, thrust.stern_X, -thrust.stern_Y)
    for one, other in (
        (
            own_model.wind_and_thrust_error(c, tuple(wind), thrust, HULL),
            own_model.wind_and_thrust_error(c, (wind[0], -wind[1], -wind[2]), mirror, HULL),
        ),
        (
            own_model.damping_error(c, u, v, r, own_model.wash_of(thrust), HULL),
            own_model.damping_error(c, u, -v, -r, own_model.wash_of(mirror), HULL),
        ),
    ):
        assert other == pytest.approx((one[0], -one[1], -one[2]))


def test_tensors_give_what_arrays_give():
    torch = pytest.importorskip("torch")
    samples = list(held_then_adrift(5, 5))
    learned = Learned(*(torch.from_numpy(np.asarray(one)) for one in BELIEFS))

    def end(learned, like):
        record = own_record.begin(like(samples[0]), learned=learned, hull=HULL)
        for known in samples[1:]:
            record = own_record.step(record, like(known), 1.0, learned=learned, **MODEL)
        ahead = own_record.predict(
            record, known, horizons=HORIZONS, steps=(5, 5, 8), learned=learned, **MODEL
        )
        mixed = [own_record.mixed(record, motion) for motion in ahead]
        return np.array([[float(value) for value in motion] for motion in mixed])

    def tensors(known):
        ship = Motion(*(torch.tensor(value, dtype=torch.float64) for value in known.ship))
        return known._replace(ship=ship, wind_believed=torch.tensor(1.0, dtype=torch.float64))

    np.testing.assert_allclose(
        end(learned, tensors), end(BELIEFS, lambda known: known), rtol=1e-9, atol=1e-9
    )


def hybrid(samples):
    state = drift_off.begin(samples[0], trained=TRAINED, hull=HULL, parameters=ASSUMED)
    for known in samples[1:]:
        state = drift_off.step(
            state, known, 1.0, trained=TRAINED, **MODEL, ship=DP_SHIP, parameters=ASSUMED
        )
    return state


def predicted(state, known):
    options = {"horizons": HORIZONS, "longest_step": 2.0, **MODEL}
    found, share = drift_off.predict(state, known, trained=TRAINED, **options)
    return found, share, dead_reckoning.predict(known, state.kinetic, **options)


def test_a_usual_drift_is_predicted_with_what_is_learned():
    samples = list(held_then_adrift())
    found, share, alone = predicted(hybrid(samples), samples[-1])
    assert share == 1.0
    assert math.dist(found[-1][:2], alone[-1][:2]) > 0.01


def test_a_ship_alone_is_predicted_as_among_others():
    """Alone it goes filter by filter in floats; two ships go together in arrays."""
    samples = list(held_then_adrift())
    own, known = hybrid(samples).own, samples[-1]
    options = {"horizons": HORIZONS, "steps": drift_off.STEPS, "learned": BELIEFS, **MODEL}
    twice = own._replace(mean=np.stack([own.mean] * 2, axis=1))
    together = own_record.predict(twice, known, **options)
    for alone, both in zip(own_record.predict(own, known, **options), together, strict=True):
        np.testing.assert_allclose(
            np.array(alone)[..., None], np.array(both)[..., :1], rtol=1e-12, atol=1e-12
        )


def test_dead_reckoning_is_left_out_where_all_is_learned(monkeypatch):
    samples = list(held_then_adrift())
    state = hybrid(samples)
    asked = []
    kinetic = dead_reckoning.predict
    monkeypatch.setattr(
        dead_reckoning,
        "predict",
        lambda *known, **model: asked.append(1) or kinetic(*known, **model),
    )
    options = {"horizons": HORIZONS, "longest_step": 2.0, "trained": TRAINED, **MODEL}
    assert drift_off.predict(state, samples[-1], **options)[1] == 1.0 and not asked
    _, share = drift_off.predict(state, samples[-1]._replace(wind_believed=0.0), **options)
    assert share == 0.0 and asked


@pytest.mark.parametrize("far", ["speed", "wind", "turning", "disbelieved"])
def test_far_from_what_was_learned_it_is_the_kinetic_predictor(far):
    samples = list(held_then_adrift())
    state, known = hybrid(samples), samples[-1]
    if far == "speed":
        known = known_of(known.ship._replace(u=6.0))
    elif far == "turning":
        known = known_of(known.ship._replace(r=0.2))
    elif far == "wind":
        state = state._replace(own=state.own._replace(wind=(np.float64(-40.0), np.float64(0.0))))
    else:
        known = known._replace(wind_believed=0.0)
    found, share, alone = predicted(state, known)
    assert share == 0.0
    assert all(tuple(map(float, a)) == b for a, b in zip(found, alone, strict=True))


def test_an_estimate_that_is_no_number_is_not_used():
    samples = list(held_then_adrift())
    state = hybrid(samples)
    state.own.mean[0, 6] = np.nan
    found, share, alone = predicted(state, samples[-1])
    assert share == 0.0 and tuple(map(float, found[-1])) == alone[-1]


def test_trust_falls_from_the_limits_on():
    limits = np.arange(1.0, 10.0)
    assert drift_off.trust(limits, limits) == 1.0
    assert drift_off.trust(1.25 * limits, limits) == pytest.approx(0.5)
    assert drift_off.trust(2.0 * limits, limits) == 0.0


def test_headings_are_averaged_and_blended_across_south():
    zeros, record = (
        np.zeros(5),
        own_record.begin(next(held_then_adrift()), learned=BELIEFS, hull=HULL),
    )
    record = record._replace(likelihood=np.array([0.0, 0.0, -99.0, -99.0, -99.0]))
    headings = np.array([math.pi - 0.1, -math.pi + 0.3, 0.0, 0.0, 0.0])
    middle = own_record.mixed(record, Motion(zeros, zeros, headings, zeros, zeros, zeros))
    assert float(middle.psi) == pytest.approx(-math.pi + 0.1)
    one, other = Motion(0.0, 0.0, 3.1, 0.0, 0.0, 0.0), Motion(2.0, 0.0, -3.1, 0.0, 0.0, 0.0)
    assert drift_off.blend(one, other, 0.5)[:3] == pytest.approx((1.0, 0.0, -math.pi), abs=1e-9)
