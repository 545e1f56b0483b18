"""Our neural allocator is trained on seeds of its own, for the ships as they are, and its weights are what came out."""

import json
import re
from dataclasses import fields, replace

import numpy as np
import pytest
import torch
from ships import parameters, ship

from shipcosim.learn import neural
from shipcosim.learn.requests import recorded_requests
from shipcosim.learn.training import repeatable
from shipcosim.models.allocation.neural_allocator import (
    NeuralParameters,
    NeuralUnitsParameters,
    units_of,
)
from shipcosim.models.core.networks import read_arrays

FMUS = {
    "neural": "neural_allocator",
    "neural-slipstreams": "neural_allocator",
    "neural-four-azimuths": "neural_units_allocator",
}
REPORTED = (*range(1, 9), *range(7200, 7208))
"""Seeds that tables of results are made with."""


def report_of(kind, root):
    return json.loads(
        (root / "fmus" / FMUS[kind] / "weights" / f"{kind}.json").read_text(encoding="utf-8")
    )


def weights_of(kind, root):
    arrays = read_arrays(root / "fmus" / FMUS[kind] / "weights" / f"{kind}.npz")
    return tuple(
        (torch.tensor(arrays[f"{k}.weights"]).double(), torch.tensor(arrays[f"{k}.bias"]).double())
        for k in range(1, len(arrays) // 2 + 1)
    )


def test_no_seed_of_training_is_one_that_results_are_reported_for(root):
    runs, seeds, _ = recorded_requests()
    assert len(set(seeds)) == sum(map(len, runs)) == 48
    given = {
        int(n)
        for file in root.glob("scenarios/**/*.toml")
        for n in re.findall(r"seed\"?\s*=\s*(\d+)", file.read_text())
    }
    assert given and not set(seeds.tolist()) & (given | set(REPORTED))


def test_runs_that_choose_the_weights_are_not_trained_on():
    recipe = neural.RECIPES["neural"]
    trained, held_out = (neural.Sequences(recipe, held_out=held).runs for held in (False, True))
    for (ours, _), (theirs, _) in zip(trained, held_out, strict=True):
        assert len(ours) == 18 and len(theirs) == neural.HELD_OUT == 6
        assert not any((run == other).all() for run in ours for other in theirs)


@pytest.mark.parametrize(("kind", "diameter"), [("neural", 0.0), ("neural-slipstreams", 1.9)])
def test_recipe_has_the_units_of_the_ship(kind, diameter):
    made = replace(parameters(NeuralParameters, component="allocator"), azimuth_diameter=diameter)
    same(neural.RECIPES[kind].units, units_of(made, neural.POWER)[0])


def test_recipe_of_four_azimuths_has_her_units():
    said = ship("four-azimuths").entries["allocator"]
    made = NeuralUnitsParameters(
        **{f.name: said[f.name].value for f in fields(NeuralUnitsParameters) if f.name in said},
        **{f"diameter_{k}": neural.DIAMETER for k in range(1, 5)},
    )
    same(
        neural.RECIPES["neural-four-azimuths"].units,
        units_of(made, (neural.POWER[0],) * 6)[0],
        "azimuth",
    )


def same(one, other, but=""):
    for name, a, b in zip(one._fields, one, other, strict=True):
        if name != but and a is not None:
            np.testing.assert_allclose(a, b, rtol=1e-12, err_msg=name)


@pytest.mark.parametrize("kind", FMUS)
def test_weights_cost_what_their_report_says_and_no_more_than_untrained_ones(kind, root):
    report, recipe = report_of(kind, root), neural.RECIPES[kind]
    checked = neural.Sequences(replace(recipe, batch=256), held_out=True)
    units = neural.tensors(recipe.units)
    with torch.no_grad():
        found = neural.cost(recipe, units, weights_of(kind, root), checked.draw(), checked.interval)
    objective, costs = float(found["objective"]), [epoch["objective"] for epoch in report["epochs"]]
    assert objective == pytest.approx(min(costs), abs=1e-3)
    assert (
        min(abs(objective - cost) for cost in costs) < 1e-6
    )  # in double precision on any processor
    assert min(costs) <= costs[0]
    assert report["settings"]["iterations"] == recipe.iterations and report["seed"] == recipe.seed
    assert report["time_s"] < 1200.0


def test_price_of_power_goes_back_to_the_weights():
    recipe = replace(
        neural.RECIPES["neural-slipstreams"], batch=16, steps=8, settling=2, hidden=(8,)
    )
    with repeatable(1):
        weights, drawn = neural.first_weights(recipe), neural.Sequences(recipe, held_out=False)
        parts = neural.cost(
            recipe,
            neural.tensors(recipe.units),
            neural.paired(weights),
            drawn.draw(),
            drawn.interval,
        )
        parts["power"].backward()
    assert all(
        torch.isfinite(weight.grad).all() and weight.grad.abs().max() > 0.0 for weight in weights
    )
