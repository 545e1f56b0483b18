"""What no cause explains is found as an error without a name; healthy logs and named causes leave none."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose import twin
from diagnose.twin import fits, problem
from scipy.stats import chi2

from shipcosim.diagnose.explanation import unmodelled
from shipcosim.diagnose.explanation.unmodelled import unmodelled_gains
from shipcosim.diagnose.inference.thresholds import UNMODELLED


def beside_the_best(log):
    here, found = twin.explained(log)
    return unmodelled_gains(here, found[0])


@pytest.mark.parametrize("name", ["healthy", "two"])
def test_beside_the_right_cause_nothing_is_left(name):
    check_nothing_left(name)


def check_nothing_left(name):
    assert max(unmodelled_gains(problem(name), fits(name)[0]).values()) < 1.0 < UNMODELLED


@pytest.mark.parametrize("seed", [1, 2])
def test_healthy_logs_stay_below_the_threshold(seed):
    log = twin.sailed({"healthy": {}}, seed=seed)["healthy"]
    assert max(beside_the_best(log).values()) < UNMODELLED


def test_a_force_that_swings_is_found_as_periodic():
    log = twin.sailed({"": {}}, push=lambda t: (0.0, 3000.0 * np.sin(2.0 * np.pi * t / 70.0), 0.0))[
        ""
    ]
    found = beside_the_best(log)
    assert max(found, key=found.get) == "periodic" and found["periodic"] > 2.0 * UNMODELLED


def test_a_force_that_comes_and_goes_slowly_is_found_as_slow():
    log = twin.sailed(
        {"": {}}, push=lambda t: (0.0, 0.0, 120e3 * np.exp(-(((t - 200.0) / 60.0) ** 2)))
    )[""]
    found = beside_the_best(log)
    assert found["slow"] > UNMODELLED


def test_a_scale_of_the_yaw_rate_is_found_in_its_channel():
    log = twin.logs()["healthy"]
    found = beside_the_best(log.assign(yaw_rate=1.15 * log["yaw_rate"]))
    assert max(found, key=found.get) == "in a channel" and found["in a channel"] > 10.0 * UNMODELLED


def test_the_search_over_periods_is_paid_for(monkeypatch):
    """The same sinusoid sought four times scores ln 4 less than once."""
    bases, scores = unmodelled._bases, []
    for times in (1, 4):
        few = lambda *of, times=times: {"periodic": times * bases(*of)["periodic"][:1]}  # noqa: E731
        monkeypatch.setattr(unmodelled, "_bases", few)
        scores.append(unmodelled_gains(problem("healthy"), fits("healthy")[0])["periodic"])
    assert scores[0] - scores[1] == pytest.approx(np.log(4.0))


def fit_of_parts(sizes, known=400.0):
    """A fit of one cause with one number, whose size in each part of the log is given, without noise."""
    sizes = np.array(sizes)
    products = np.zeros((len(sizes), 2, 2))
    products[:, 1, 1], products[:, 0, 1], products[:, 1, 0] = known, known * sizes, known * sizes
    theta = np.array([sizes.mean()])
    hypothesis = SimpleNamespace(parameters=(None,))
    rest = {"products": SimpleNamespace(blocks=products), "theta": theta, "left": theta}
    return SimpleNamespace(hypotheses=(hypothesis,), columns=[None], **rest)


def test_a_cause_that_is_as_large_in_each_part_is_steady():
    assert unmodelled._differs_by_part(fit_of_parts([0.5] * 8)) == 0.0
    assert unmodelled._differs_by_part(fit_of_parts([0.5, 0.53, 0.47, 0.5] * 2)) == 0.0


def test_a_cause_that_comes_and_goes_from_part_to_part_is_not():
    assert unmodelled._differs_by_part(fit_of_parts([0.8, 0.2] * 4)) > UNMODELLED


def test_what_a_p_value_can_say_at_most_is_bounded():
    """Chi-squared of 8 parts at 31.8, p = 1e-4: -log(-e p log p) = 5.99."""
    sizes = 0.5 + np.sqrt(chi2.isf(1e-4, 8) / 8.0 * (1.0 / 400.0 + 0.05**2)) * np.array(
        [1.0, -1.0] * 4
    )
    assert unmodelled._differs_by_part(fit_of_parts(sizes)) == pytest.approx(5.99, abs=0.01)


def fit_of_numbers(theta, covariance):
    """A fit without a cause whose known numbers are off by `theta` tolerances."""
    return SimpleNamespace(
        hypotheses=(),
        columns=[SimpleNamespace(prior=1.0)] * len(theta),
        theta=np.array(theta),
        covariance=covariance,
    )


def test_numbers_off_as_their_tolerances_say_are_no_surprise():
    """Drawn from the prior and seen through measurements of many precisions, one in a thousand is strange at most."""
    random = np.random.default_rng(3)
    seen, turned = random.standard_normal((60, 20)), np.diag(np.geomspace(1e-2, 3.0, 20))
    precision = turned @ seen.T @ seen @ turned / 30.0
    covariance = np.linalg.inv(np.eye(20) + precision)
    beyond = 0
    for _ in range(2000):
        pull = precision @ random.standard_normal(20) + np.linalg.cholesky(
            precision
        ) @ random.standard_normal(20)
        beyond += (
            unmodelled._beyond_tolerances(fit_of_numbers(covariance @ pull, covariance))
            > UNMODELLED
        )
    assert beyond <= 2


def test_numbers_far_beyond_their_tolerances_are_strange():
    assert (
        unmodelled._beyond_tolerances(fit_of_numbers([4.6, -4.5, *[0.9] * 18], 0.1 * np.eye(20)))
        > UNMODELLED
    )
    assert (
        unmodelled._beyond_tolerances(fit_of_numbers([2.0, -2.0, *[0.5] * 18], 0.1 * np.eye(20)))
        < 1.0
    )


def test_what_is_beyond_all_chance_counts_with_a_finite_number():
    assert (
        UNMODELLED
        < unmodelled._beyond_tolerances(fit_of_numbers([300.0] * 20, 0.1 * np.eye(20)))
        < 700.0
    )
