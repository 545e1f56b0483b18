"""What docking predictors are trained on and how: dockings apart, repeatable, and the FMU says the same."""

import importlib.util
import json
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

from ships import equipped, parameters

from shipcosim.angles import wrap
from shipcosim.learn.docking import (
    distance_ensemble,
    dockings,
    inputs,
    paper_iii,
    predictions,
    regions,
    training,
)
from shipcosim.learn.docking.records import KNOWN, Record
from shipcosim.learn.results import markdown
from shipcosim.models.core.networks import read_arrays
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import docking, helm
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters

NAME = "gunnerus-28m9"
MODEL = inputs.ShipModel(
    parameters(HullParameters, NAME, "docking_predictor"),
    parameters(WindParameters, NAME, "docking_predictor"),
    parameters(helm.HelmParameters, NAME),
    parameters(MastParameters, NAME, "docking_predictor"),
)
WEIGHTS = Path("fmus/docking_predictor/weights")


def record(seed=1, seconds=90, turned=0.0, mirrored=False):
    """A ship that slows down and turns towards the berth, with levers that wander; true and measured are alike."""
    rng, time = np.random.default_rng(seed), np.arange(float(seconds))
    side = -1.0 if mirrored else 1.0
    u, r = 4.0 * np.exp(-time / 60.0), side * 0.01 * np.sin(time / 15.0)
    psi = side * 0.4 + np.cumsum(r)
    x, y = (np.cumsum(u * f(psi)) for f in (np.cos, np.sin))
    x, y = x - x[-1], y - y[-1]
    c, s = np.cos(turned), np.sin(turned)
    truth = {
        "x": c * x - s * y,
        "y": s * x + c * y,
        "psi": wrap(psi + turned),
        "u": u,
        "v": 0.0 * u,
        "r": r,
    }
    walk = [5e3 * np.sin(time / (8.0 + k) + rng.uniform(0.0, 3.0)) for k in range(3)]
    known = {f"{name}_meas": values for name, values in truth.items()}
    known |= {
        "wind_speed_meas": 5.0 + np.sin(time / 9.0),
        "wind_from_meas": wrap(side * (0.5 + 0.1 * np.cos(time))),
    }
    near, far = ("port", "starboard")[:: 1 if side > 0.0 else -1]
    for unit, thrust, angle in ((near, walk[0], 0.3), (far, walk[1], 0.5)):
        azimuth = side * angle * np.sin(time / 11.0)
        known |= {
            f"{unit}_thrust_cmd": thrust,
            f"{unit}_azimuth_cmd": azimuth,
            f"{unit}_azimuth": 0.9 * azimuth,
        }
        known[f"{unit}_rpm"] = thrust / 100.0
    known |= {"tunnel_thrust_cmd": side * walk[2], "tunnel_rpm": side * walk[2] / 10.0}
    return Record(seed, 1, time, {name: known[name] for name in KNOWN}, truth)


@pytest.fixture(scope="module")
def replayed():
    return inputs.replay([record(seed) for seed in range(1, 5)], MODEL)


def few(recipe, **others):
    return replace(recipe, members=2, epochs=2, batch=2, **others)


def learned(kind, replay):
    """Arrays and losses of a training of a few steps."""
    if kind == "ours":
        pair = distance_ensemble.features(replay, MODEL.hull), distance_ensemble.targets(replay)
        return distance_ensemble.fit(
            pair, pair, few(training.OURS, width=6), lambda done, total: None
        )
    pair = paper_iii.inputs_of(replay), paper_iii.targets(replay)
    recipe = few(training.PAPER_III, trials=2, trial_epochs=1, most_nodes=12)
    return paper_iii.fit(pair, pair, recipe, lambda done, total: None)[:2]


def test_dockings_to_learn_from_are_never_those_of_the_test():
    chosen = [seed for some in training.SETS.values() for seed in some]
    assert len(set(chosen)) == len(chosen)
    assert not {*dockings.HELD_OUT, *dockings.HELD_OUT_UNSEEN} & set(chosen)
    assert set(training.SETS["training"]) == set(dockings.TRAINING)
    assert set(training.SETS["choices"]) <= set(dockings.CHOICES)
    assert set(training.SETS["calibration"]) <= set(dockings.CALIBRATION)


def test_inputs_of_the_predictor_are_those_of_the_record():
    assert set(helm.KNOWN) == set(KNOWN)


def test_features_and_targets_are_those_of_a_harbour_turned_by_any_angle(replayed):
    turned = inputs.replay([record(seed, turned=2.0) for seed in range(1, 5)], MODEL)
    np.testing.assert_allclose(
        distance_ensemble.features(turned, MODEL.hull),
        distance_ensemble.features(replayed, MODEL.hull),
        atol=1e-6,
    )
    np.testing.assert_allclose(
        distance_ensemble.targets(turned), distance_ensemble.targets(replayed), atol=1e-6
    )


def test_mirror_of_features_is_the_docking_in_a_mirror():
    """But for what the hull's own law has of her two sides, which is not alike: those parts are left out."""
    one, other = (inputs.replay([record(2, mirrored=side)], MODEL) for side in (False, True))
    found, expected = (
        distance_ensemble.features(other, MODEL.hull),
        distance_ensemble.features(one, MODEL.hull) * distance_ensemble.MIRROR_SIGNS,
    )
    alike = [0, 1, 2, *range(16, 30)]
    np.testing.assert_allclose(
        found[..., alike], expected[..., distance_ensemble.MIRROR_ORDER][..., alike], atol=0.05
    )


def test_truth_is_what_came_and_nothing_where_the_record_ends(replayed):
    rows = replayed.truth["x"]
    assert rows.shape == (helm.LONGEST + 1, 4, 90)
    np.testing.assert_array_equal(rows[30, 1, :60], rows[0, 1, 30:])
    assert np.isnan(rows[30, :, 60:]).all() and np.isfinite(rows[29, :, 60]).all()


def test_torch_and_numpy_give_the_same_distance(replayed):
    """The loss in training is the distance that is left with the correction of the law."""
    arrays, _ = learned("ours", replayed)
    trained, found = docking.trained_of(arrays), distance_ensemble.features(replayed, MODEL.hull)
    given = distance_ensemble.given_by(trained, found)
    places = docking.corrected(replayed.own.ship, replayed.ours, given)
    off = [
        np.hypot(replayed.later["x"][h] - x, replayed.later["y"][h] - y)
        for h, (x, y, _) in enumerate(places, 1)
    ]
    turn = [abs(wrap(replayed.later["psi"][h] - psi)) for h, (_, _, psi) in enumerate(places, 1)]
    expected = np.nanmean(
        np.sqrt(np.stack(off) ** 2 + 1e-2) + distance_ensemble.HEADING * np.stack(turn)
    )
    loss = distance_ensemble.distance(
        distance_ensemble.tensor(given.mean(axis=0)),
        distance_ensemble.tensor(distance_ensemble.targets(replayed)),
        distance_ensemble.tensor(docking.basis()),
    )
    assert float(loss) == pytest.approx(expected, rel=1e-4)


def test_share_is_one_in_training_and_none_far_outside(replayed):
    arrays, _ = learned("ours", replayed)
    inside = predictions.by_ours(replayed, arrays, MODEL.hull)
    assert inside.share.min() == 1.0
    far = record(1)
    far.known["wind_speed_meas"] = 60.0 + far.known["wind_speed_meas"]
    outside = inputs.replay([far], MODEL)
    found = predictions.by_ours(outside, arrays, MODEL.hull)
    assert found.share.max() == 0.0
    for place, motion in zip(found.places, outside.kinetic, strict=True):
        assert all((a == b).all() for a, b in zip(place, motion[:3], strict=True))


def test_regions_have_their_share_of_the_calibration(replayed):
    predicted = predictions.kinetic(replayed)
    widths = regions.calibrated(predicted, replayed)
    radii, _ = docking.regions(widths, predictions.own_record(predicted.places, replayed))
    missed, _ = regions.misses(predicted.places, regions.measured_later(replayed))
    for one, radius in zip(missed, radii, strict=True):
        there = np.isfinite(one)
        assert 0.9 <= np.mean(one[there] <= radius[there] + 1e-9) <= 1.0


def fmu_of(root, variant):
    spec = importlib.util.spec_from_file_location(
        "tested", root / "fmus/docking_predictor/docking_predictor.py"
    )
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    fmu = equipped(module.DockingPredictor(), "docking_predictor", NAME)
    fmu.variant = variant
    return fmu


@pytest.mark.parametrize("variant", ["kinetic", "paper-iii", "ours"])
def test_fmu_says_what_is_said_over_whole_records(root, variant, replayed):
    fmu, given = fmu_of(root, variant), record(1)
    weights = read_arrays(
        root / WEIGHTS / ("paper-iii.npz" if variant == "paper-iii" else "ours.npz")
    )
    says = {
        "kinetic": lambda: predictions.kinetic(replayed),
        "paper-iii": lambda: predictions.by_paper_iii(replayed, weights),
        "ours": lambda: predictions.by_ours(replayed, weights, MODEL.hull),
    }
    expected = says[variant]()
    widths = weights["kinetic_widths" if variant == "kinetic" else "widths"]
    radii, _ = docking.regions(widths, predictions.own_record(expected.places, replayed))
    for k in range(40):
        for name, values in given.known.items():
            setattr(fmu, name, float(values[k]))
        fmu.start() if k == 0 else fmu.step(float(k), 1.0)
        assert fmu.predicted_at == k
        for horizon in (10, 20, 30):
            said = [getattr(fmu, f"{axis}_{horizon}") for axis in ("x", "y", "psi")]
            assert said == pytest.approx(
                [one[0, k] for one in expected.places[horizon - 1]], abs=1e-8
            )
        assert fmu.position_region_30 == pytest.approx(radii[2][0, k])
        assert fmu.learned == pytest.approx(expected.share[0, k])


def test_an_unknown_variant_is_answered_by_those_there_are(root):
    with pytest.raises(ValueError, match="kinetic, paper-iii, ours"):
        fmu_of(root, "paper-iv").start()


@pytest.mark.parametrize("kind", ["ours", "paper-iii"])
def test_report_in_the_repository_is_of_its_weights(root, kind):
    report = json.loads((root / WEIGHTS / f"{kind}.json").read_text(encoding="utf-8"))
    arrays = read_arrays(root / WEIGHTS / f"{kind}.npz")
    assert report["weights"] == sum(array.size for array in arrays.values())
    assert (root / WEIGHTS / f"{kind}.md").read_text(encoding="utf-8") == markdown(report)
    recipe = training.OURS if kind == "ours" else training.PAPER_III
    assert report["settings"]["members"] == recipe.members and report["seed"] == recipe.seed
    assert all(np.isfinite(array).all() for array in arrays.values())


def test_model_of_training_is_that_of_the_system():
    model = training.ship()
    for one in fields(model):
        assert getattr(model, one.name) == getattr(MODEL, one.name)
