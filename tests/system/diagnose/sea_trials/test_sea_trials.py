"""Sea trials of simulated ships, logged with a bad clock: planted causes are found, and nothing on a healthy ship."""

from collections import Counter

import numpy as np
import pytest
from diagnose import twin
from diagnose.sea_trials import trials

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.sea_trials.clock import own_clock
from shipcosim.diagnose.sea_trials.evidence import ranked, trial_evidence
from shipcosim.diagnose.sea_trials.features import SOUGHT, features_of
from shipcosim.diagnose.sea_trials.sailing import sailed
from shipcosim.diagnose.sea_trials.study import (
    best_of,
    causes_of_trials,
    estimates,
    rivals_of,
    study,
)
from shipcosim.diagnose.sea_trials.windows import as_ordered, sea_trials_of
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.errors import ShipcosimError

PLANTED = {
    "healthy": {},
    "slowed in turns": {"vessel.mmg_X_vv": -0.7, "lag": 2.5},
    "heavy to turn": {"vessel.inertia_yaw": 2.0 * 43e6},
}
DRAG_IN_TURNS = {"drift_drag", "turn_drag", "sway_momentum"}


@pytest.fixture(scope="module")
def logs():
    return trials.logs(PLANTED, seed=3)


def manoeuvres(log):
    """Sea trials of a log of orders."""
    read = checked(ReadLog(log, twin.model(), {}))
    record = as_ordered(record_of(read.repaired, read.ship), read.repaired, read.ship)
    return sea_trials_of(record, read.ship, orders=True)


@pytest.fixture(scope="module")
def ranking(logs):
    """Sets of causes by evidence on all trials, by log."""
    causes = causes_of_trials(twin.model(), read_catalogue(), orders=True)

    def of(log):
        return ranked(trial_evidence(manoeuvres(log), twin.model(), causes))

    return {name: of(log) for name, log in logs.items()}


def test_every_manoeuvre_that_was_sailed_is_found(logs):
    found = manoeuvres(logs["healthy"])
    assert Counter(one.kind for one in found)["turning circle"] == len(trials.LEGS)
    circles = [one for one in found if one.kind == "turning circle"]
    assert [one.side for one in circles] == [-int(np.sign(angle)) for angle, _ in trials.LEGS]
    assert [one.steering for one in circles] == pytest.approx(
        [np.sin(np.radians(abs(a))) for a, _ in trials.LEGS], 0.02
    )
    assert {one.kind for one in found} == set(SOUGHT)


def test_a_motion_tells_the_time_that_a_wrong_clock_does_not():
    """A circle at 5 m/s and 2 deg/s: stamps that are stretched by up to a third, a velocity that reads a tenth low."""
    true = np.cumsum(1.0 - 0.3 * np.sin(np.arange(400.0) / 40.0))
    psi = np.radians(2.0) * true
    radius = 5.0 / np.radians(2.0)
    rates = np.full(400, 4.5), np.zeros(400), np.full(400, np.radians(2.0))
    measured = np.column_stack((radius * np.sin(psi), -radius * np.cos(psi), psi, *rates))
    clock, scale = own_clock(np.arange(400.0), measured, 34.0)
    assert scale == pytest.approx(5.0 / 4.5, rel=0.01)
    np.testing.assert_allclose(clock[20:-20] - clock[20], true[20:-20] - true[20], atol=2.0)


def test_a_straight_run_is_sailed_until_the_speed_has_settled(logs):
    run = next(one for one in manoeuvres(logs["healthy"]) if one.kind == "straight run")
    (motion,) = sailed([run], twin.model(), [{}])
    speed = np.hypot(motion[0, :, 3], motion[0, :, 4])
    assert abs(speed[-1] / speed[-40] - 1.0) < 1e-3
    assert np.exp(features_of(run, motion[0])) == pytest.approx(speed[-1])


def test_nothing_is_named_on_a_healthy_ship(ranking):
    assert best_of(ranking["healthy"]).label == "no cause" and not rivals_of(ranking["healthy"])


def test_drag_in_turns_and_late_orders_are_found_together_however_bad_the_clock(ranking):
    """Circles do not tell drag by drift from drag by rate of turn: the sets that fit alike hold one of them each."""
    best, rivals = best_of(ranking["slowed in turns"]), rivals_of(ranking["slowed in turns"])
    for one in (best, *rivals):
        names = {cause.cause for cause in one.hypotheses}
        assert "late_orders" in names and names & DRAG_IN_TURNS and len(names) == 2
    assert "drift_drag" in {cause.cause for one in (best, *rivals) for cause in one.hypotheses}
    lag = dict(zip((cause.cause for cause in best.hypotheses), estimates(best), strict=True))[
        "late_orders"
    ]
    assert abs(lag.estimate - 2.5) < 3.0 * lag.std and lag.std < 0.8


def test_a_larger_inertia_in_yaw_is_found_with_its_size(ranking):
    best = best_of(ranking["heavy to turn"])
    assert [cause.cause for cause in best.hypotheses] == ["yaw_inertia"]
    (inertia,) = estimates(best)
    assert abs(inertia.estimate - 2.0 * 43e6) < 3.0 * inertia.std


def test_a_log_without_a_circle_is_refused_and_told_what_would_do(logs):
    with pytest.raises(ShipcosimError, match="no turning circle"):
        study(logs["healthy"].isel(time=slice(0, 190)), twin.system(), orders=True)
