"""Calibration of regions: the share of held-out cases that they have inside, and which predictions count."""

import numpy as np
import pytest

pytest.importorskip("torch")

from prediction.regions import Scores, calibrated, scores
from shipcosim.learn.prediction.worlds import KNOWN, Record
from shipcosim.models.prediction.regions import HORIZONS, JUST_LOST, LONG_LOST

SHARES = np.array([1.3, 1.0, 0.6])
"""Widths just after the loss, in the drift and in a long drift."""


def phases(lost_for: np.ndarray) -> np.ndarray:
    """0 just after the loss, 1 in the drift, 2 in a long drift."""
    return np.digitize(lost_for, (JUST_LOST, LONG_LOST), right=True)


def drawn(rng: np.random.Generator, spread: float = 1.0) -> Scores:
    """Scores of a world whose errors grow with the horizon."""
    time = np.arange(1.0, 121.0)
    growth = np.array([0.5, 2.0, 8.0])
    sizes = growth * SHARES[phases(time)][:, None] * np.exp(0.3 * rng.standard_normal((120, 3)))
    return Scores(time, spread * sizes, 0.1 * sizes, np.ones((120, 2)))


def inside(found: list[Scores], widths: dict[str, float], kind: str) -> list[float]:
    """Share of the cases inside calibrated regions, by phase."""
    shares = widths[f"first_{kind}_share"], 1.0, widths[f"later_{kind}_share"]
    limits = np.array([widths[f"{kind}_half_width_{horizon:.0f}"] for horizon in HORIZONS])
    held = [
        getattr(s, kind) <= limits * np.take(shares, phases(s.lost_for))[:, None] for s in found
    ]
    return [
        float(
            np.mean([h[phases(s.lost_for) == p].mean() for h, s in zip(held, found, strict=True)])
        )
        for p in range(3)
    ]


def test_calibrated_regions_have_nine_cases_in_ten_of_other_worlds_of_the_same_kind():
    rng = np.random.default_rng(1)
    widths = calibrated([drawn(rng) for _ in range(60)])
    assert widths["first_position_share"] == pytest.approx(1.3, rel=0.05)
    assert widths["later_position_share"] == pytest.approx(0.6, rel=0.05)
    found = [drawn(rng) for _ in range(60)]
    for kind in ("position", "heading"):
        assert all(0.88 <= share <= 0.95 for share in inside(found, widths, kind))
    # Errors beyond those of the calibration do show.
    wild = [drawn(rng, spread=2.0) for _ in range(60)]
    assert all(share < 0.5 for share in inside(wild, widths, "position"))


def test_errors_are_those_against_the_truth_and_not_against_what_the_ship_knows():
    """A ship that lies still, while her own estimate is 3 m off."""
    time = np.arange(121.0)
    known = np.zeros((121, len(KNOWN)))
    known[:41, KNOWN.index("tau_X_allocated")] = 500.0
    truth = known[:, :6] + 0.0
    truth[:, 0] = 3.0
    found = scores(Record(0, 40.0, time, known, truth))
    assert found.position[0] == pytest.approx(3.0, rel=0.05)


def test_predictions_count_from_the_loss_of_thrust_and_widen_where_she_was_foreseen_elsewhere():
    """A ship that drifts as told, and one that is told to drift along and jumps."""
    time = np.arange(121.0)
    known = np.zeros((121, len(KNOWN)))
    known[:41, KNOWN.index("tau_X_allocated")] = 500.0
    steady = scores(Record(0, 40.0, time, known, known[:, :6]))
    assert len(steady.lost_for) == pytest.approx(80, abs=1)
    assert np.isfinite(steady.position[0]).all() and np.isnan(steady.position[-1]).all()
    jumping = known.copy()
    jumping[60:, KNOWN.index("x_hat")] = 5.0
    moved = scores(Record(0, 40.0, time, jumping, jumping[:, :6]))
    assert moved.factors[:15] == pytest.approx(steady.factors[:15])
    assert (moved.factors[25:40, 0] > 2.0 * steady.factors[25:40, 0]).all()
