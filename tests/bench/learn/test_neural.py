"""At night: our neural allocator, trained again, costs what its report says."""

import pytest
from learn.test_neural import FMUS, quiet, report_of

from shipcosim.learn import neural


@pytest.mark.parametrize("kind", FMUS)
def test_training_again_gives_the_costs_of_the_report(kind, root):
    """Other processors round otherwise, which training enlarges."""
    report, trained = report_of(kind, root), neural.train(neural.RECIPES[kind], quiet)
    assert trained.epochs[0]["objective"] == pytest.approx(report["epochs"][0]["objective"], rel=1e-3)
    assert min(e["objective"] for e in trained.epochs) == pytest.approx(
        min(e["objective"] for e in report["epochs"]), rel=0.05
    )
