"""What is planted in the modelled ship herself is found at its place and with its size."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin
from diagnose.twin import fits, problem

from shipcosim.diagnose.explanation.search import _simplify, names
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.regressors import screening_regressors
from shipcosim.diagnose.inference.screening import _one_way, screened

NAMES = {
    "current": {"current"},
    "thrust_loss": {"thrust_loss of port"},
    "heading_bias": {"heading_bias"},
    "mass": {"mass"},
    "tow": {"tow"},
    "azimuth_offset": {"azimuth_offset of starboard"},
    "two": {"thrust_loss of tunnel", "lever_arm"},
}


def score(name, labels=frozenset()):
    return next(
        fit.score
        for fit in fits(name)
        if {hypothesis.label for hypothesis in fit.hypotheses} == set(labels)
    )


IN_CI = ("current", "azimuth_offset", "two")


@pytest.mark.parametrize("name", IN_CI)
def test_a_planted_cause_explains_its_log_best_with_its_size(name):
    check_planted(name)


def check_planted(name):
    best = fits(name)[0]
    assert {hypothesis.label for hypothesis in best.hypotheses} == NAMES[name]
    assert best.score - score(name) > 50.0
    for path, truth in twin.PLANTED[name].items():
        assert abs(best.values[path] - truth) < 3.0 * best.std[path], path
        assert best.std[path] < 0.25 * abs(truth - twin.model().get(path)), path


def test_each_of_two_causes_gains_beside_the_other():
    both = fits("two")[0]
    for label in NAMES["two"]:
        assert both.score - score("two", {label}) > 20.0


def test_a_healthy_log_is_explained_by_nothing():
    assert max(fit.score for fit in fits("healthy")) - score("healthy") < 3.0


def test_a_cause_that_is_fitted_gives_the_ship_that_sailed():
    """Same motion: the smoothed track of the fit is within the noise of what was planted as a line's pull."""
    best = fits("tow")[0]
    assert best.model.get("water.tow_north") == best.values["water.tow_north"]
    north = twin.logs()["tow"]["north"].values
    assert np.std(best.motion.x - north) == pytest.approx(0.2, rel=0.2)


def test_the_same_fit_is_made_once_and_another_problem_makes_its_own():
    here = problem("mass")
    cause = next(one for one in here.hypotheses if one.label == "mass")
    alone, beside = fitted(here), fitted(here, (cause,))
    assert fitted(here) is alone and fitted(here, (cause,)) is beside is not alone
    assert (
        fitted(here, (cause,), {"vessel.mass": 1.1 * here.model.get("vessel.mass")}) is not beside
    )
    noisy = replace(here, noise=replace(here.noise, white=2.0 * here.noise.white))
    assert fitted(noisy) is not alone and fitted(noisy).score != alone.score


def test_weighing_ranks_the_planted_cause_first_and_starts_near_its_value():
    gain, hypothesis, values = screened(problem("mass"), fitted(problem("mass")))[0]
    assert hypothesis.cause == "mass" and gain > 50.0
    assert values["vessel.mass_scale"] == pytest.approx(1.25, abs=0.08)


def test_beside_the_right_cause_no_other_gains():
    best = fits("azimuth_offset")[0]
    assert screened(problem("azimuth_offset"), best)[0][0] < 3.0


def test_a_wrong_cause_explains_less():
    wrong = next(s for s in problem("heading_bias").hypotheses if s.cause == "velocity_scale")
    assert fitted(problem("heading_bias"), (wrong,)).score < fits("heading_bias")[0].score - 100.0


def test_known_numbers_leave_out_what_a_cause_turns_or_speaks_for():
    loss = next(s for s in problem("healthy").hypotheses if s.label == "thrust_loss of port")
    lag = next(s for s in problem("healthy").hypotheses if s.cause == "navigation_lag")

    def turned(hypotheses):
        return {
            path
            for column in problem("healthy").ship_columns(hypotheses)
            for path in column.changes
        }

    assert "port.thrust_loss" in turned(()) and "port.thrust_loss" not in turned((loss,))
    assert "instruments.thruster_lag" in turned(()) and "instruments.thruster_lag" not in turned(
        (lag,)
    )
    assert "water.drift_yaw_arm" not in turned(())


def test_a_vector_is_sought_all_round_and_a_turning_current_by_its_trend():
    groups = {s.cause: screening_regressors(s) for s in problem("healthy").hypotheses}
    sizes = [np.hypot(*column.changes.values()) for (column,) in groups["wave_drift"]]
    np.testing.assert_allclose(sizes, 0.005 * 531e3)
    assert len(sizes) == 12
    ((first, *_), *_) = groups["current_varying"]
    assert first.changes == {"water.current_north": 0.2}


def test_what_is_left_of_a_fit_is_known_numbers_alone():
    best = fits("thrust_loss")[0]
    assert best.left[-1] == pytest.approx(0.0, abs=0.02)
    assert np.abs(best.left[:-1]).max() < 3.5


def test_a_steady_current_is_weighed_beside_the_varying_one_that_contains_it():
    """From the general cause alone the simpler one is reached, and wins: two numbers instead of four."""
    here = problem("current")
    varying = next(s for s in here.hypotheses if s.cause == "current_varying")
    found = {frozenset(): fitted(here), frozenset(["current_varying"]): fitted(here, (varying,))}
    _simplify(here, found)
    best = max(found.values(), key=lambda fit: fit.score)
    assert best.label == "current"
    assert best.values["water.current_north"] == pytest.approx(0.22, abs=0.02)
    assert best.values["water.current_east"] == pytest.approx(-0.12, abs=0.02)


@pytest.mark.parametrize("forwards", [True, False])
def test_a_current_of_next_to_nothing_at_one_end_does_not_turn_about(forwards):
    """From the ends of log work 311, which grows from nothing: begun with the wrong direction, no fit found it."""
    ends = np.array([0.026, 0.048]), np.array([-0.233, 0.166])
    slow, fast = _one_way(*ends) if forwards else reversed(_one_way(*reversed(ends)))
    assert np.array_equal(fast, ends[1])
    assert np.hypot(*slow) == pytest.approx(np.hypot(*ends[0])) and np.dot(slow, fast) > 0.0
    turned = np.array([0.2, 0.0]), np.array([-0.1, 0.2])
    assert all(map(np.array_equal, _one_way(*turned), turned))


def test_late_commands_are_found_beside_a_lost_thrust_though_their_lag_gains_nothing_at_first_sight():
    log = twin.logs()["thrust_loss"]
    late = {role: log[role] for role in log.data_vars if role.endswith(("_rpm", "_azimuth"))}
    late = {
        role: series.copy(data=np.r_[[series.values[0]] * 2, series.values[:-2]])
        for role, series in late.items()
    }
    best = twin.explained(log.assign(late))[1][0]
    assert names(best.hypotheses) == {"thrust_loss of port", "thruster_lag"}
    assert best.values["instruments.thruster_lag"] == pytest.approx(2.0, abs=0.5)


def test_a_fit_starts_within_the_bounds_of_its_numbers():
    """At first sight a number can be far beyond them, where no ship follows the log and the filter ends in NaN."""
    (hypothesis,) = (one for one in problem("healthy").hypotheses if one.cause == "reverse_loss")
    (parameter,) = hypothesis.parameters
    starts = (
        dict.fromkeys(parameter.paths, parameter.bounds[1]),
        dict.fromkeys(parameter.paths, 1000.0 * parameter.bounds[1]),
    )
    bound, beyond = (fitted(problem("healthy"), (hypothesis,), start) for start in starts)
    assert (beyond.score, beyond.values) == (bound.score, bound.values)


def test_a_number_that_is_none_does_not_end_the_search():
    """The smoothed motion of a craft that no ship of the model follows can run away, and every estimate with it."""
    (hypothesis,) = (one for one in problem("healthy").hypotheses if one.cause == "reverse_loss")
    lost = fitted(
        problem("healthy"), (hypothesis,), dict.fromkeys(hypothesis.parameters[0].paths, np.nan)
    )
    assert np.isfinite(lost.score) and all(np.isfinite(value) for value in lost.values.values())
