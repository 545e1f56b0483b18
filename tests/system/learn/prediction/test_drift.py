"""What drift predictors are trained on and how: repeatable, and through the same physics in torch and NumPy."""

import json

import numpy as np
import pytest
import torch
from ships import parameters

from shipcosim.learn.prediction import drift, paper_iv, rollouts, training, worlds
from shipcosim.learn.results import markdown
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction import paper_iv as law
from shipcosim.models.prediction.own_model import Learned
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters, hull_loads
from shipcosim.models.ship.mast import MastParameters, wind_at_mast

SHIP = rollouts.Ship(
    parameters(HullParameters), parameters(WindParameters), parameters(MastParameters)
)
WEIGHTS = "fmus/drift_predictor/weights"


def sailed(before=12, after=81):
    """Two ships of the nominal hull, held against wind and current by thrust that wavers, then adrift."""
    rng, (x, y, psi, u, v, r), rows = np.random.default_rng(1), np.zeros((6, 2)), []
    air, current = (
        (np.array([-5.0, 2.0]), np.array([3.0, 6.0])),
        (np.array([0.2, 0.0]), np.array([-0.1, 0.3])),
    )
    ship = vessel.Motion(x, y, psi + [0.3, -2.0], u, v, r)
    for second in range(before + after + 1):
        wind = apparent_wind(ship.psi, ship.u, ship.v, *air)
        loads = wind_loads(*wind, wind=SHIP.wind)
        water = hull_loads(
            *vessel.through_water(ship.psi, ship.u, ship.v, *current), ship.r, hull=SHIP.hull
        )
        told = [
            (second <= before) * (rng.normal(1.0, 0.1) * -(a + b))
            for a, b in zip(loads, water, strict=True)
        ]
        measured = wind_at_mast(*wind, ship.u, ship.v, ship.r, mast=SHIP.mast)
        columns = [
            *ship,
            *np.zeros((3, 2)),
            *told,
            np.hypot(*measured),
            np.arctan2(measured[1], measured[0]),
            0.0 * x,
        ]
        rows.append(np.stack(columns, axis=-1))
        for _ in range(5):
            ship = vessel.step(
                ship,
                *(a + b for a, b in zip(told, loads, strict=True)),
                *current,
                0.2,
                hull=SHIP.hull,
            )
    return rollouts.Sailed(np.array(rows), before)


def test_worlds_to_train_on_are_those_and_no_others():
    for recipe in (training.OURS, training.PAPER_IV):
        assert set(recipe.seeds) <= set(worlds.TRAINING)
        assert not set(recipe.seeds) & {*worlds.CALIBRATION, *worlds.TUNING, *worlds.HELD_OUT}
    with pytest.raises(ValueError, match="8700"):
        training.sail([1, 8700], lambda done, total: None)


def test_torch_and_numpy_follow_and_predict_alike():
    numbers, data = 0.3 * np.random.default_rng(2).normal(size=drift.SIZE), sailed()
    found = []
    for given, library in ((numbers, np), (torch.from_numpy(numbers), torch)):
        learned = drift.learned_of(given, library)
        record = rollouts.followed(learned, data, (1, 5), SHIP, library, grid=2)
        motions = rollouts.ahead(learned, *record, SHIP)
        found.append(np.array([[np.asarray(value) for value in motion] for motion in motions]))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9, atol=1e-9)


def test_the_gradient_is_that_of_differences():
    data, at = sailed(), 0.1 * np.random.default_rng(3).normal(size=drift.SIZE)
    numbers = torch.from_numpy(at.copy()).requires_grad_()
    drift.loss(numbers, data, SHIP, training.OURS).backward()
    for k in (16, 49, 59):
        step = 1e-4 * np.eye(drift.SIZE)[k]
        ends = [
            float(drift.loss(torch.from_numpy(at + d), data, SHIP, training.OURS))
            for d in (step, -step)
        ]
        assert float(numbers.grad[k]) == pytest.approx(
            (ends[0] - ends[1]) / 2e-4, rel=1e-3, abs=1e-7
        )


def test_samples_of_a_nominal_ship_have_no_residual_but_the_current():
    inputs, targets = paper_iv.samples(sailed(), SHIP, first=2)
    assert inputs.shape[1] == 9 and len(inputs) == len(targets) == 2 * 10
    assert abs(targets[1:, 2]).max() < 1e-2


def test_records_are_aligned_at_the_loss():
    time = np.arange(300.0)
    records = [
        worlds.Record(1, lost, time, np.tile((time - lost)[:, None], 15), None)
        for lost in (180.0, 200.0)
    ]
    found = training.aligned(records, 170)
    assert found.lost == 170 and found.known.shape == (252, 2, 15)
    assert (found.known[170] == 0.0).all() and (found.known[0] == -170.0).all()


@pytest.mark.parametrize("kind", ["ours", "paper-iv"])
def test_weights_in_the_repository_are_of_their_recipe(root, kind):
    report = json.loads((root / WEIGHTS / f"{kind}.json").read_text(encoding="utf-8"))
    recipe = {"ours": training.OURS, "paper-iv": training.PAPER_IV}[kind]
    assert report["seed"] == recipe.seed and report["description"] == recipe.description
    assert report["data"]["worlds"].startswith(f"seeds {min(recipe.seeds)} to {max(recipe.seeds)},")
    assert (root / WEIGHTS / f"{kind}.md").read_text(encoding="utf-8") == markdown(report)
    arrays = read_arrays(root / WEIGHTS / f"{kind}.npz")
    if kind == "ours":
        assert set(arrays) == {*Learned._fields, "limits"}
        assert arrays["mean"].shape == (18,) and (arrays["std"] > 0.0).all()
    else:
        assert law.ensemble_of(arrays).layers[0][0].shape == (recipe.members, 9, recipe.width)
