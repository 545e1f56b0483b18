"""At night: training of our neural allocator repeats itself, and gives the costs of the report."""

from dataclasses import replace

import pytest
from learn.test_neural import FMUS, report_of

from shipcosim.learn import neural


@pytest.mark.parametrize("kind", FMUS)
def test_training_again_gives_the_costs_of_the_report(kind, root):
    """Other processors round otherwise, which training enlarges."""
    report, trained = report_of(kind, root), neural.train(neural.RECIPES[kind], quiet)
    assert trained.epochs[0]["objective"] == pytest.approx(
        report["epochs"][0]["objective"], rel=1e-3
    )
    assert min(e["objective"] for e in trained.epochs) == pytest.approx(
        min(e["objective"] for e in report["epochs"]), rel=0.05
    )


def quiet(done, total):
    """No progress bar."""


def test_same_seed_gives_the_same_weights_and_training_lowers_the_cost():
    recipe = replace(
        neural.RECIPES["neural"], iterations=6, batch=16, steps=8, settling=2, hidden=(8,)
    )
    one, two = (neural.train(recipe, quiet) for _ in range(2))
    assert all((one.arrays[name] == two.arrays[name]).all() for name in one.arrays)
    other = neural.train(replace(recipe, seed=2), quiet)
    assert any((one.arrays[name] != other.arrays[name]).any() for name in one.arrays)
