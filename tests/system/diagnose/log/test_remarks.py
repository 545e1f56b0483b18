"""What is left out or sorted in a log is said."""

import numpy as np

from shipcosim.diagnose.log.remarks import remarks
from shipcosim.series import make_table


def log_of(time, values):
    return make_table(np.asarray(time, float), [("north", np.asarray(values, float), "m", "north")])


def test_a_log_in_order_needs_no_remark():
    assert remarks(log_of(np.arange(50), np.arange(50) % 7)) == []


def test_everything_that_is_sorted_or_left_out_is_said():
    time = np.arange(60.0)
    time[[10, 11]] = time[[11, 10]]
    time[20], time[30] = np.nan, 29.0
    values = np.sin(np.arange(60.0))
    values[40], values[50] = np.nan, 1000.0
    said = remarks(log_of(time, values))
    assert [text.split(":")[0] for text in said] == [
        "1 row without a time",
        "1 row earlier than the one before, the first at 10 s",
        "1 row with a time that was there, the first at 29 s",
        "2 rows of the usual step 1 s not there, the first after 19 s",
        "north",
        "north",
    ]
    assert "without a number" in said[4] and "far off both neighbours" in said[5]


def test_uneven_steps_are_said():
    time = np.cumsum(np.random.default_rng(1).uniform(0.8, 1.2, 100))
    assert any("give or take" in text for text in remarks(log_of(time, np.sin(time))))
