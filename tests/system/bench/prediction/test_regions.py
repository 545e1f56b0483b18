"""Calibration of regions: the share of held-out cases that they have inside, and which predictions count."""

import numpy as np
import pytest

pytest.importorskip("torch")

from prediction.regions import (
    KINDS,
    UNCALIBRATED,
    Scores,
    calibrated,
    phases,
    scores,
    shares_held,
    within,
)
from shipcosim.learn.prediction.worlds import KNOWN, Record

SHARES = np.array([1.3, 1.0, 0.6])
"""Widths just after the loss, in the drift and in a long drift."""


def drawn(rng: np.random.Generator, spread: float = 1.0) -> Scores:
    """Scores of a world whose errors grow with the horizon."""
    time = np.arange(1.0, 121.0)
    growth = np.array([0.5, 2.0, 8.0])
    sizes = growth * SHARES[phases(time)][:, None] * np.exp(0.3 * rng.standard_normal((120, 3)))
    return Scores(time, spread * sizes, 0.1 * sizes, np.ones((120, 2)))


def inside(found: list[Scores], widths: dict[str, float], kind: str, phase: int) -> list[float]:
    """Share of the cases inside calibrated regions, by horizon."""
    held = [within(one, widths, kind)[phases(one.lost_for) == phase] for one in found]
    return list(np.concatenate(held).mean(axis=0))


def test_calibrated_regions_have_nine_cases_in_ten_of_other_worlds_of_the_same_kind():
    rng = np.random.default_rng(1)
    widths = calibrated([drawn(rng) for _ in range(60)])
    assert widths["first_position_share"] == pytest.approx(1.3, rel=0.05)
    assert widths["later_position_share"] == pytest.approx(0.6, rel=0.05)
    for phase in range(3):
        found = [drawn(rng) for _ in range(60)]
        for kind in KINDS:
            assert all(0.88 <= share <= 0.95 for share in inside(found, widths, kind, phase))
    # Errors beyond those of the calibration do show.
    wild = [drawn(rng, spread=2.0) for _ in range(60)]
    assert all(share < 0.5 for share in inside(wild, widths, "position", 1))


def test_the_table_says_what_regions_hold_of_the_starts_of_a_stretch():
    """Five starts just after the loss; the last two have no truth 60 s ahead, one place is outside."""
    widths = dict.fromkeys(UNCALIBRATED, 1.0)
    position, heading = np.full((6, 3), 0.5), np.full((6, 3), 0.5)
    position[0, 0], position[3:5, 2], position[5] = 2.0, np.nan, 9.0
    one = Scores(np.arange(1.0, 7.0), position, heading, np.ones((6, 2)))
    cells = [cell.split(" (")[0] for cell in shares_held([one, one], widths, 1, 5)]
    assert cells == ["80 %", *["100 %"] * 5]


@pytest.fixture
def known():
    """What a ship knows that drifts along in place from 40 s on."""
    values = np.zeros((121, len(KNOWN)))
    values[:41, KNOWN.index("tau_X_allocated")] = 500.0
    return values


def test_errors_are_those_against_the_truth_and_not_against_what_the_ship_knows(known):
    truth = known[:, :6] + np.array([3.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    found = scores(Record(0, 40.0, np.arange(121.0), known, truth))
    assert found.position[0] == pytest.approx(3.0, rel=0.05)


def test_predictions_count_from_the_loss_of_thrust_and_widen_where_she_was_foreseen_elsewhere(
    known,
):
    """A ship that drifts as told, and one that is told to drift along and jumps."""
    time = np.arange(121.0)
    steady = scores(Record(0, 40.0, time, known, known[:, :6]))
    assert len(steady.lost_for) == pytest.approx(80, abs=1)
    assert np.isfinite(steady.position[0]).all() and np.isnan(steady.position[-1]).all()
    jumping = known.copy()
    jumping[60:, KNOWN.index("x_hat")] = 5.0
    moved = scores(Record(0, 40.0, time, jumping, jumping[:, :6]))
    assert moved.factors[:15] == pytest.approx(steady.factors[:15])
    assert (moved.factors[25:40, 0] > 2.0 * steady.factors[25:40, 0]).all()
