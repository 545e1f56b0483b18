"""A repaired log is evenly spaced, keeps every value that there is, and invents none."""

import numpy as np
import pytest

from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.log.mislabels import finding_of, negative
from shipcosim.diagnose.log.repair import repaired
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table


def log_of(time, **channels):
    units = {"heading": "deg", "surge": "m/s", "north": "m"}
    columns = [
        (name, np.asarray(values, float), units[name], name) for name, values in channels.items()
    ]
    return make_table(np.asarray(time, float), columns)


def test_an_even_log_stays_as_it_is():
    time = 3.0 + 0.1 * np.arange(500)
    log = log_of(time, surge=np.sin(time), heading=np.mod(40.0 * time, 360.0))
    again = repaired(log)
    assert np.array_equal(again["surge"].values, log["surge"].values)
    assert np.array_equal(again["heading"].values, log["heading"].values)
    assert (
        again["time"].values == pytest.approx(time, abs=1e-9)
        and np.ptp(np.diff(again["time"].values)) < 1e-12
    )


def test_unordered_repeated_and_timeless_rows_are_put_in_order():
    log = log_of([0, 2, 1, 1, np.nan, 3], surge=[10, 12, 11, 99, 98, 13])
    assert repaired(log)["surge"].values.tolist() == [10.0, 11.0, 12.0, 13.0]


def test_missing_rows_become_rows_without_a_number():
    again = repaired(log_of([0, 1, 2, 5, 6], surge=[0, 1, 2, 5, 6]))
    assert again["time"].values.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert np.isnan(again["surge"].values).tolist() == [
        False,
        False,
        False,
        True,
        True,
        False,
        False,
    ]


def test_rows_that_keep_to_no_clock_leave_no_holes_between_them_and_lost_ones_do():
    """As logged by an Otter: a tenth of a second at the median, more than 0.15 s after a third of the rows."""
    spans = np.random.default_rng(1).choice(
        [0.07, 0.1, 0.13, 0.22], 400
    ) + 0.003 * np.random.default_rng(2).random(400)
    spans[200] = 3.0
    time = np.r_[0.0, np.cumsum(spans)]
    again = repaired(log_of(time, north=2.0 * time))
    empty = np.isnan(again["north"].values)
    inside = (again["time"].values > time[200]) & (again["time"].values < time[201])
    assert (empty == inside).all()


def test_an_uneven_log_is_interpolated_and_headings_the_short_way_round():
    time = np.array([0.0, 0.9, 2.1, 3.0])
    again = repaired(log_of(time, north=2.0 * time, heading=np.mod(350.0 + 10.0 * time, 360.0)))
    assert again["time"].values == pytest.approx([0.0, 0.9, 1.8, 2.7])
    assert again["north"].values == pytest.approx(2.0 * again["time"].values)
    assert again["heading"].values == pytest.approx(
        np.mod(350.0 + 10.0 * again["time"].values, 360.0)
    )


def test_headings_are_between_0_and_360():
    assert repaired(log_of([0, 1, 2], heading=[-10, 360, 725]))["heading"].values.tolist() == [
        350.0,
        0.0,
        5.0,
    ]


def test_a_stamp_years_away_is_refused_instead_of_filled_up_to():
    with pytest.raises(ShipcosimError, match="2 s is followed by 1.6e\\+09 s"):
        repaired(log_of([0, 1, 2, 1.6e9], surge=[1, 2, 3, 4]))


def test_findings_are_undone_in_their_segments_only():
    time = np.arange(100.0)
    sign = finding_of(negative("surge"), 1.0, (20.0, 40.0))
    gap = Finding("gap", None, "data", 1.0, {}, ((60.0, 70.0),), ("surge",))
    surge = repaired(log_of(time, surge=time + 1.0), [sign, gap])["surge"].values
    assert surge[19:42].tolist() == [20.0, *(-(time[20:41] + 1.0)), 42.0]
    assert np.isnan(surge).nonzero()[0].tolist() == list(range(60, 71))


def test_a_clock_is_undone_and_says_where_in_the_log_a_row_was():
    time = np.arange(100.0)
    rate = {"rate": ParameterEstimate(0.5, 0.01, "1")}
    clock = Finding("clock", None, "data", 1.0, rate, ((20.0, 40.0),), ("time",))
    again = repaired(log_of(time, north=time), [clock])
    assert again["time"].values[-1] == 89.0
    assert again["north"].values[[20, 25, 30, 31]].tolist() == [20.0, 30.0, 40.0, 41.0]
    assert again["logged_time"].values[[20, 25, 30, 31]].tolist() == [20.0, 30.0, 40.0, 41.0]
