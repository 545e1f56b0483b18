"""What is left of a log in the sets of poor ones, and of its answer."""

import numpy as np
import pandas as pd
import pytest

from trial.poor import poorer
from truth import Case
from truth.effects import Answer

COLUMNS = (
    "time [s]",
    "north [m]",
    "east [m]",
    "heading [deg]",
    "surge [m/s]",
    "sway [m/s]",
    "yaw_rate [deg/s]",
)
GAP = Answer("gap", None, {}, ((100.0, 130.0),), ("north", "east"))
SWAP = Answer("channel_swap", None, {}, (), ("surge", "sway"))
MASS = Answer("mass", None, {"scale": 1.2})


def case(*answer):
    log = pd.DataFrame(
        {name: np.arange(600.0) for name in (*COLUMNS, "wind_speed [m/s]", "port_rpm [rpm]")}
    )
    return Case("trial", 3, log, list(answer), log, np.zeros(600), np.zeros(600))


def test_slow_rows_are_every_so_many():
    kept = poorer(case(MASS), every=10)
    assert (
        len(kept.log) == 60
        and set(np.diff(kept.log["time [s]"])) == {10.0}
        and kept.answer == [MASS]
    )


def test_of_a_brief_log_seconds_are_left_and_the_faults_in_them():
    kept = poorer(case(GAP, MASS), seconds=45)
    time = kept.log["time [s]"]
    assert 44.0 <= np.ptp(time) <= 45.0
    assert (GAP in kept.answer) == (
        time.min() <= 130.0 and time.max() >= 100.0
    ) and MASS in kept.answer


@pytest.mark.parametrize(
    "which, columns", [("position", 4), ("no_velocity", 6), ("no_velocity_no_wind", 5)]
)
def test_faults_of_channels_that_nobody_logged_are_no_longer_hidden(which, columns):
    kept = poorer(case(GAP, SWAP), channels=which)
    assert kept.log.shape[1] == columns and kept.answer == [GAP]


def test_half_of_the_channels_is_the_same_half_again():
    one, again = poorer(case(), channels="half"), poorer(case(), channels="half")
    assert list(one.log) == list(again.log) and one.log.shape[1] == 4 + 3
