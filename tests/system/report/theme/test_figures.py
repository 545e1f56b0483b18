"""Curves with few enough points to draw."""

import numpy as np

from shipcosim.report.theme.figures import line, thinned_curve


def test_a_thinned_track_keeps_its_extremes_both_ways_its_ends_and_its_order():
    angle = np.linspace(0.0, 40.0, 50_000)
    east, north = angle * np.cos(angle), angle * np.sin(angle)
    x, y = thinned_curve(east, north, 2000)
    assert len(x) <= 2000
    for thin, full in ((x, east), (y, north)):
        assert (thin.min(), thin.max(), thin[0], thin[-1]) == (
            full.min(),
            full.max(),
            full[0],
            full[-1],
        )
    assert (np.diff(np.hypot(x, y)) > 0).all()


def test_a_thinned_curve_is_interrupted_wherever_it_was():
    time, values = np.arange(30_000.0), np.sin(np.arange(30_000) / 100.0)
    holes = np.arange(500, 30_000, 1000)
    values[holes] = np.nan
    x, y = thinned_curve(time, values, 600)
    assert np.isnan(x).sum() == len(holes)
    for before, hole in zip(np.flatnonzero(np.isnan(x)), holes, strict=True):
        assert x[before - 1] < hole < x[before + 1]


def test_times_of_a_long_log_stay_apart():
    time = 1.7e9 + np.arange(100.0)
    assert line("", time, np.zeros(100), "@blue")["x"] == time.tolist()


def test_nothing_known_draws_nothing():
    assert line("", [np.nan] * 5000, [1.0] * 5000, "@blue")["x"] == []
