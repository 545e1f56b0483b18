"""Side by side gives what one after the other gives, to the last digit and in the same order."""

import threading

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.inference import workers
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.workers import each


@pytest.fixture
def four_cores(monkeypatch):
    monkeypatch.setattr(workers, "cores", lambda: 4)


def test_results_come_in_the_order_of_the_arguments(four_cores):
    assert each(lambda a, b: (a, b), range(20), range(20, 40)) == list(
        zip(range(20), range(20, 40), strict=True)
    )


def test_an_error_is_raised_where_it_was_asked_for(four_cores):
    with pytest.raises(ZeroDivisionError):
        each(lambda a: 1 // a, [1, 0])


def test_inside_there_are_no_further_threads(four_cores):
    names = each(lambda _: set(each(lambda _: threading.current_thread().name, range(4))), range(4))
    assert all(len(one) == 1 for one in names) and threading.main_thread().name not in set().union(
        *names
    )


def test_fits_side_by_side_are_those_one_after_the_other(four_cores):
    problem = twin.problem("healthy")
    causes = [(hypothesis,) for hypothesis in problem.hypotheses[:4]]
    alone = [fitted(problem, one, rounds=2) for one in causes]
    together = each(lambda one: fitted(problem, one, rounds=2), causes)
    for mine, expected in zip(together, alone, strict=True):
        assert mine.score == expected.score and np.array_equal(mine.theta, expected.theta)
        assert np.array_equal(np.stack(mine.motion), np.stack(expected.motion))
