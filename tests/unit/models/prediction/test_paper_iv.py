"""The predictor of paper IV against the equations of motion, and residuals that are known."""

import numpy as np
import pytest
from ships import parameters

from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind
from shipcosim.models.prediction import dead_reckoning, paper_iv
from shipcosim.models.prediction.predictor_inputs import Known
from shipcosim.models.prediction.surroundings import Surroundings
from shipcosim.models.ship.hull import HullParameters

MODEL = {"hull": parameters(HullParameters), "wind": parameters(WindParameters)}
AIR, THRUST = (-5.0, 3.0), (2e3, -4e3, 3e4)


def known_of(ship, thrusters=THRUST):
    return Known(ship, (0.0,) * 3, thrusters, *apparent_wind(ship.psi, ship.u, ship.v, *AIR))


def constant(*residual):
    """Networks that always give one residual."""
    zeros, ones = np.zeros(9), np.ones(9)
    layers = ((np.zeros((5, 9, 3)), np.zeros((5, 1, 3))),)
    return paper_iv.Ensemble(layers, zeros, ones, np.array(residual), np.ones(3))


def test_without_residual_it_is_dead_reckoning():
    ship = Motion(1.0, 2.0, 0.7, 0.2, -0.1, 0.002)
    found = paper_iv.predict(
        paper_iv.begin(known_of(ship)), known_of(ship), constant(0, 0, 0), seconds=60, **MODEL
    )
    around = Surroundings(*AIR, 0.0, 0.0, 0.0, 0.0, 0.0, ())
    expected = dead_reckoning.predict(
        known_of(ship), around, horizons=(10.0, 60.0), longest_step=0.5, **MODEL
    )
    assert found[9][:2] == pytest.approx(expected[0][:2], abs=0.05)
    assert found[59][:2] == pytest.approx(
        expected[1][:2], abs=1.0
    )  # Euler's steps of a second, as taken


def test_networks_add_to_the_acceleration():
    ship = Motion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    past = paper_iv.begin(known_of(ship))
    without, with_ = (
        paper_iv.predict(past, known_of(ship), networks, seconds=1, **MODEL)[0]
        for networks in (constant(0, 0, 0), constant(0.01, -0.02, 1e-4))
    )
    assert np.subtract(with_[3:], without[3:]) == pytest.approx((0.01, -0.02, 1e-4))


def test_the_residual_is_what_the_equations_missed():
    ship = Motion(0.0, 0.0, 0.3, 0.1, 0.0, 0.0)
    past = paper_iv.begin(known_of(ship))
    dot = paper_iv.model_acceleration(0.3, (0.1, 0.0, 0.0), AIR, THRUST, **MODEL)
    later = ship._replace(u=0.1 + dot[0] + 0.01, v=dot[1], r=dot[2])
    assert paper_iv.step(past, known_of(later), **MODEL).residual == pytest.approx((0.01, 0.0, 0.0))


def test_heading_is_averaged_across_south():
    past = paper_iv.begin(known_of(Motion(0.0, 0.0, 3.13, 0.0, 0.0, 0.0), (0.0,) * 3))
    for _ in range(paper_iv.WINDOW):
        past = paper_iv.step(
            past, known_of(Motion(0.0, 0.0, -3.13, 0.0, 0.0, 0.0), (0.0,) * 3), **MODEL
        )
    assert all(state[0] == pytest.approx(2.0 * np.pi - 3.13) for state in past.states)


def test_arrays_give_what_floats_give():
    ships = [Motion(0.0, 0.0, 0.3, 0.1, 0.0, 0.0), Motion(1.0, 5.0, -2.0, -0.1, 0.3, 0.004)]
    rng = np.random.default_rng(1)
    layers = tuple(
        (rng.normal(size=(5, n, m)), rng.normal(size=(5, 1, m))) for n, m in ((9, 4), (4, 3))
    )
    networks = paper_iv.Ensemble(layers, np.zeros(9), np.ones(9), np.zeros(3), np.full(3, 1e-3))

    def end(known):
        past = paper_iv.step(paper_iv.begin(known), known, **MODEL)
        return paper_iv.predict(past, known, networks, seconds=20, **MODEL)[-1]

    many = Motion(*map(np.array, zip(*ships, strict=True)))
    found = end(known_of(many, tuple(np.full(2, one) for one in THRUST)))
    for k, ship in enumerate(ships):
        assert end(known_of(ship)) == pytest.approx([value[k] for value in found], rel=1e-9)


def test_networks_read_their_arrays():
    arrays = {"1.weights": np.ones((5, 9, 3)), "1.bias": np.zeros((5, 1, 3))}
    arrays |= {
        "input_mean": np.zeros(9),
        "input_std": np.full(9, 2.0),
        "output_mean": np.ones(3),
        "output_std": np.ones(3),
    }
    found = paper_iv.outputs(paper_iv.ensemble_of(arrays), np.ones((1, 9)))
    assert found.shape == (5, 1, 3) and found == pytest.approx(np.full((5, 1, 3), 5.5))
