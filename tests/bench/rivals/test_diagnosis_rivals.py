"""The diagnosis beside its rivals on the same logs: who names more, who cries wolf, whose predictions are better.

``SHIPCOSIM_TRIAL_MINUTES`` (default 30) bounds the time; results are kept beside those of the trial.
"""

import os

import numpy as np
import pytest

from trial import comparison, runs, tables
from trial.__main__ import FIRST_SEED
from trial.scoring import score

SEEDS = range(FIRST_SEED, FIRST_SEED + 24)
SETS = ["one", "healthy", "unknown"]
MINUTES = float(os.environ.get("SHIPCOSIM_TRIAL_MINUTES", "30"))
RIVALS = {
    "bic": "rivals.regressions:inverse_dynamics",
    "sindy": "rivals.regressions:sparse_regression",
}


@pytest.fixture(scope="module")
def results(root):
    """Results by tool, of the logs that all have diagnosed."""
    pytest.importorskip("pysindy")
    share = {"minutes": MINUTES / (1 + len(RIVALS)), "jobs": 2}
    found = {"ours": runs.run(runs.KINDS, SETS, SEEDS, root / "results" / "trial.jsonl", **share)}
    for name, tool in RIVALS.items():
        found[name] = runs.run(
            runs.KINDS, SETS, SEEDS, root / "results" / f"{name}.jsonl", tool=tool, **share
        )
    print(f"\n{comparison.comparison([result for some in found.values() for result in some])}")
    common = set.intersection(*({runs.key(result) for result in some} for some in found.values()))
    return {
        name: [result for result in some if runs.key(result) in common]
        for name, some in found.items()
    }


def right(results):
    """Share of right answers over all sets."""
    return np.mean(
        [score(r["answer"], r["diagnosis"] or tables.UNJUDGED, r["span"]).right for r in results]
    )


@pytest.mark.parametrize("rival", RIVALS)
def test_more_answers_are_right_than_the_rivals(results, rival):
    assert right(results["ours"]) > right(results[rival])


def test_named_causes_predict_better_than_a_network(tmp_path):
    from rivals.network import gains
    from truth import draw_many

    found = []
    for case in draw_many(
        "trial", SEEDS[:6], among=["tow", "crossflow", "thrust_loss", "wind_scale"]
    ):
        case.save(tmp_path / "log.csv")
        found.append(gains(tmp_path / "log.csv"))
        print(f"\n{case.seed}: {found[-1]}")
    ratios = [gain["after_m"] / gain["network_m"] for gain in filter(None, found)]
    assert np.median(ratios) < 1.0
