"""Calibration of regions: the share of held-out cases that they have inside, and which predictions count."""

import numpy as np
import pytest

pytest.importorskip("torch")

from prediction.regions import Scores, calibrated, scores
from shipcosim.learn.prediction.worlds import KNOWN, Record
from shipcosim.models.prediction.regions import HORIZONS, JUST_LOST


def drawn(rng: np.random.Generator, spread: float = 1.0) -> Scores:
    """Scores of a world whose errors grow with the horizon."""
    growth = np.array([0.5, 2.0, 8.0])
    sizes = np.exp(0.3 * rng.standard_normal((100, 3)))
    later = np.where(np.arange(100.0) < 20.0, 1.0, 0.6)[:, None]
    return Scores(
        np.arange(100.0),
        spread * growth * later * sizes,
        0.1 * growth * later * sizes,
        np.ones((100, 2)),
    )


def inside(found: list[Scores], widths: dict[str, float], kind: str, late: bool) -> list[float]:
    """Share of the cases inside calibrated regions, by horizon."""
    share = widths[f"later_{kind}_share"] if late else 1.0
    scored = np.concatenate([getattr(s, kind)[(s.lost_for >= JUST_LOST) == late] for s in found])
    limits = [share * widths[f"{kind}_half_width_{horizon:.0f}"] for horizon in HORIZONS]
    return list(np.mean(scored <= limits, axis=0))


def test_calibrated_regions_have_nine_cases_in_ten_of_other_worlds_of_the_same_kind():
    rng = np.random.default_rng(1)
    widths = calibrated([drawn(rng) for _ in range(60)])
    assert widths["later_position_share"] == pytest.approx(0.6, rel=0.05)
    for late in (False, True):
        found = [drawn(rng) for _ in range(60)]
        for kind in ("position", "heading"):
            assert all(0.88 <= share <= 0.95 for share in inside(found, widths, kind, late))
    # Errors beyond those of the calibration do show.
    wild = [drawn(rng, spread=2.0) for _ in range(60)]
    assert all(share < 0.5 for share in inside(wild, widths, "position", late=False))


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
