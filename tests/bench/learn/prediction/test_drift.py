"""At night: drift predictors of paper IV learn and repeat bit by bit."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from learn.prediction.test_drift import SHIP, sailed

from prediction import paper_iv_rollouts
from shipcosim.learn import datasets
from shipcosim.learn.prediction import drift, paper_iv, rollouts, training
from shipcosim.models.prediction import paper_iv as law


def test_networks_of_paper_iv_learn_and_repeat_bit_by_bit():
    rng = np.random.default_rng(4)
    inputs = rng.normal(size=(400, 9))
    targets = np.stack([np.tanh(inputs[:, 0]), inputs[:, 1] * 0.5, -inputs[:, 2]], axis=-1)
    recipe = replace(training.PAPER_IV, samples=400, most_epochs=30)
    arrays, epochs = paper_iv.fit(inputs, targets, recipe, lambda done, total: None)
    again, _ = paper_iv.fit(inputs, targets, recipe, lambda done, total: None)
    assert all(arrays[name].tobytes() == again[name].tobytes() for name in arrays)
    assert epochs[-1]["held out"] < 0.2 * epochs[0]["held out"]
    mean = law.outputs(law.ensemble_of(arrays), inputs[:5]).mean(axis=0)
    assert mean == pytest.approx(targets[:5], abs=0.6)


def test_rollouts_of_paper_iv_are_its_predictions_and_learn_bit_by_bit():
    """Over a record in which wind and thrust hold; there recorded and held ones are the same."""
    data = sailed(before=80, after=5)
    data.known[:, :, 9:14] = data.known[20, :, 9:14]
    ship = SHIP._replace(mast=replace(SHIP.mast, mast_x=0.0, mast_y=0.0))
    inputs, targets = paper_iv.samples(data, ship)
    arrays, _ = paper_iv.fit(
        inputs, targets, replace(training.PAPER_IV, members=1, most_epochs=2), lambda done, of: None
    )
    pieces = paper_iv_rollouts.stretches(data, ship, first=20, every=100)
    weights = [
        torch.from_numpy(arrays[f"{k}.{name}"]) for k in (1, 2, 3) for name in ("weights", "bias")
    ]
    found = paper_iv_rollouts.ahead(
        weights, arrays, pieces._replace(air=pieces.air[:1].expand(60, -1, -1)), ship
    )
    everything = rollouts.known_of(data.known, ship)
    past = law.begin(datasets.mapped(lambda array: array[0], everything))
    for row in range(1, 21):
        now = datasets.mapped(lambda array, row=row: array[row], everything)
        past = law.step(past, now, hull=ship.hull, wind=ship.wind)
    expected = law.predict(
        past, now, law.ensemble_of(arrays), seconds=60, hull=ship.hull, wind=ship.wind
    )
    for k, horizon in enumerate(rollouts.HORIZONS):
        np.testing.assert_allclose(
            found[k, 0].numpy().T, expected[int(horizon) - 1][:3], rtol=1e-9, atol=1e-9
        )
    recipe = replace(training.PAPER_IV, members=2, width=4)
    one, history = paper_iv_rollouts.fit(arrays, pieces, ship, recipe, 4, lambda done, total: None)
    other, _ = paper_iv_rollouts.fit(arrays, pieces, ship, recipe, 4, lambda done, total: None)
    assert history[-1] < history[0]
    assert all(one[name].tobytes() == other[name].tobytes() for name in one)


def test_a_few_steps_go_down_and_repeat_bit_by_bit():
    recipe, data = replace(training.OURS, steps=3, learning_rate=0.02), sailed()
    one, history = drift.fit(data, SHIP, recipe, lambda done, total: None)
    other, _ = drift.fit(data, SHIP, recipe, lambda done, total: None)
    assert one.tobytes() == other.tobytes()
    assert history[-1]["all worlds"] < history[0]["all worlds"]
