"""Whether a cause of the size that is said to be visible is seen, and one of half of it is not said to be."""

from functools import cache

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.experiment.testability import Excitation, visible_sizes
from shipcosim.diagnose.explanation.search import explain, without_causes
from shipcosim.diagnose.explanation.unmodelled import unmodelled_gains
from shipcosim.diagnose.explanation.verdict import judge
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.fitting import Regressor
from shipcosim.diagnose.inference.innovations import inner_products
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.inference.regressors import screening_regressors
from shipcosim.report.diagnosis.testability import visible_rows

MINUTES = 12.0
SEEDS = (2,)  # 0 and 1 set MORE_THAN_NOISE
CAUSES = [
    ("thrust_loss", "port"),
    ("thrust_loss", "tunnel"),
    ("rpm_offset", "starboard"),
    ("azimuth_offset", "port"),
    *((name, None) for name in ("mass", "heading_bias", "wind_scale", "drag")),
]
"""The same at other thrusters, and the wind's direction: at night."""


def problem_of(log):
    return identification_problem(log, twin.model(MINUTES), read_catalogue())


def hypothesis_of(cause, component):
    every = hypotheses_of(read_catalogue(), twin.model(MINUTES))
    return next(one for one in every if (one.cause, one.component) == (cause, component))


@cache
def sizes(seed):
    """What would have shown in a healthy log."""
    problem = problem_of(twin.sailed({"healthy": {}}, MINUTES, seed)["healthy"])
    columns = list(without_causes(explain(problem, most=0)).columns)
    groups = []
    for hypothesis in problem.hypotheses:
        for group in screening_regressors(hypothesis):
            groups.append((hypothesis, list(range(len(columns), len(columns) + len(group)))))
            columns.extend(group)
    products = inner_products(problem.base_of(columns), problem.noise, problem.record).products
    found = visible_sizes(Excitation(products, columns, groups))
    return {(one.cause, one.component): one for one in found}


def shows(seed, causes=CAUSES):
    """Which of some causes, as large as is said to be visible, a diagnosis of the log calls something else than healthy."""
    planted = {}
    for key in causes:
        parameter = hypothesis_of(*key).parameters[0]
        value = parameter.neutral + sizes(seed)[key].size / parameter.factor
        planted[key] = dict.fromkeys(parameter.paths, value)
    found = {}
    for key, log in twin.sailed(planted, MINUTES, seed).items():
        problem = problem_of(log)
        judgement = judge(explain(problem), lambda fit, of=problem: unmodelled_gains(of, fit))
        found[key] = judgement.verdict != "consistent"
    return found


def test_nine_of_ten_causes_of_the_visible_size_show():
    seen = [shown for seed in SEEDS for shown in shows(seed).values()]
    assert np.mean(seen) >= 0.9, seen


@pytest.mark.parametrize("information", [30.0, 300.0, 1e6])
def test_more_information_shows_smaller_sizes_down_to_the_least_that_matters(information):
    mass = hypothesis_of("mass", None)
    columns = [Regressor({"vessel.lift": 1.0}), Regressor({mass.parameters[0].path: 1.0})]

    def size(many):
        products = np.diag([1.0, 5.0, many])
        return visible_sizes(Excitation(products, columns, [(mass, [1])]))[0].size

    least = mass.definition.least * mass.parameters[0].typical * abs(mass.parameters[0].factor)
    assert size(information) > size(10.0 * information) > least


def test_what_a_log_says_nothing_of_shows_at_no_size():
    """A tunnel thruster that never ran would have to lose more than all of its thrust."""
    loss = hypothesis_of("thrust_loss", "tunnel")
    columns = [Regressor({"vessel.lift": 1.0}), Regressor({loss.parameters[0].path: 1.0})]
    excitation = Excitation(np.diag([1.0, 5.0, 0.0]), columns, [(loss, [1])])
    (visible,) = visible_sizes(excitation)
    assert visible.size > visible.largest == pytest.approx(0.95)
    assert visible_rows([visible]) == [("Thrust loss", "tunnel at no size")]


def test_what_the_ship_may_be_off_by_herself_hides_a_cause_of_that_size():
    """A cause of the size that is said to be visible gains enough over her own number, free as another form has it."""
    loss = hypothesis_of("thrust_loss", "port")
    ((path, typical),) = screening_regressors(loss)[0][0].changes.items()
    by_itself = 0.061
    columns = [Regressor({path: by_itself}), Regressor({path: typical})]
    share = by_itself / typical
    slopes = np.array([0.0, share, 1.0])
    excitation = Excitation(1e4 * np.outer(slopes, slopes), columns, [(loss, [1])])
    (visible,) = visible_sizes(excitation)
    # Log-evidence of an estimate as a draw by the cause's prior, over that by her own number's.
    size = visible.size / typical
    variance = np.array([share**2, 1.0]) + 1e-4
    hers, of_cause = -0.5 * (size**2 / variance + np.log(variance))
    assert of_cause - hers > excitation.least
    assert 3.0 * by_itself < visible.size < 0.5
