"""Several logs together say what one says, and more: information adds up, weather does not."""

import numpy as np
import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.experiment.testability import not_testable
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.linearisation import Regressor
from shipcosim.diagnose.inference.screening import screened
from shipcosim.diagnose.reference.joint_fit import fitted_jointly, screened_jointly
from shipcosim.diagnose.reference.joint_verdict import joint_excitation, judged_jointly
from shipcosim.diagnose.reference.several_logs import SeveralLogs, is_in_one_log, laid_out


@pytest.fixture(scope="module")
def weak_and_current():
    """Two days of a ship that has lost thrust; on the second there is a current too."""
    return judged_jointly(
        SeveralLogs({"first": ships.problem(3, "lost"), "second": ships.problem(4, "lost")})
    )


def test_one_log_alone_is_what_it_is_without_others():
    problem = twin.problem("thrust_loss")
    alone, joint = fitted(problem), fitted_jointly(SeveralLogs({"a": problem}))
    assert joint.score == pytest.approx(alone.score, abs=1e-6)
    np.testing.assert_allclose(joint.theta, alone.theta, atol=1e-9)
    best, other = (
        screened(problem, alone)[0],
        screened_jointly(SeveralLogs({"a": problem}), joint)[0],
    )
    assert best[1].label == other[1].label and other[0] == pytest.approx(best[0], abs=1e-6)


def test_the_same_log_twice_halves_the_variance_of_what_it_tells_alone():
    problem = twin.problem("thrust_loss")
    loss = next(one for one in problem.hypotheses if one.label == "thrust_loss of port")
    one = fitted_jointly(SeveralLogs({"a": problem}), (loss,), {"port.thrust_loss": 0.25})
    two = fitted_jointly(
        SeveralLogs({"a": problem, "b": problem}), (loss,), {"port.thrust_loss": 0.25}
    )
    information = two.products.products[1:, 1:][-1, -1]
    assert information == pytest.approx(2.0 * one.products.products[-1, -1], rel=0.02)
    assert two.std["port.thrust_loss"] < one.std["port.thrust_loss"]


def test_numbers_of_the_day_have_a_column_for_each_log_and_those_of_the_ship_one():
    known = [Regressor({"vessel.mass": 5310.0}), Regressor({"water.current_north": 0.01})]
    layout = laid_out(
        {"a": known, "b": known},
        [("loss", Regressor({"port.thrust_loss": 0.25}))],
        {"a": ["loss"], "b": []},
    )
    assert [list(column.changes) for column in layout.regressors] == [
        ["vessel.mass"],
        ["water.current_north"],
        ["water.current_north"],
        ["port.thrust_loss"],
    ]
    assert layout.places["a"].tolist() == [0, 1, 3] and layout.places["b"].tolist() == [0, 2]


def test_a_cause_in_the_ship_is_named_once_and_weather_for_its_log():
    logs = SeveralLogs({"calm": ships.problem(3, "lost"), "stream": ships.problem(4, "current")})
    labels = [one.label for one in logs.hypotheses]
    assert labels.count("thrust_loss of port") == 1
    assert {"current of calm", "current of stream"} <= set(labels)
    assert [one.cause for one in logs.hypotheses if is_in_one_log(one)].count("tow") == 2


def test_two_logs_name_a_loss_more_exactly_than_one(weak_and_current):
    judgement = weak_and_current.judgement
    assert judgement.verdict == "named" and [f.label for f in judgement.findings] == [
        "thrust_loss of port"
    ]
    estimate = judgement.findings[0].parameters["loss"]
    assert estimate.estimate == pytest.approx(0.12, abs=2.0 * estimate.std)
    both = weak_and_current.judgement.fit.std["port.thrust_loss"]
    for seed in (3, 4):
        problem = ships.problem(seed, "lost")
        loss = next(one for one in problem.hypotheses if one.label == "thrust_loss of port")
        assert both < fitted(problem, (loss,), {"port.thrust_loss": 0.12}).std["port.thrust_loss"]


def test_a_current_of_one_day_is_found_in_its_log():
    logs = SeveralLogs({"calm": ships.problem(3, "well"), "stream": ships.problem(4, "current")})
    verdict = judged_jointly(logs)
    assert [finding.label for finding in verdict.judgement.findings] == ["current of stream"]
    assert "current" not in not_testable(joint_excitation(verdict))
