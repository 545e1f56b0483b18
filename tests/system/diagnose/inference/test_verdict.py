"""What may be said of sets of causes with given evidence: named, ambiguous, unknown or nothing."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.explanation.verdict import admissible, gained, judge
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.fitting import Regressor
from shipcosim.diagnose.inference.thresholds import APART, ENOUGH, UNMODELLED

EVERYONE = {
    hypothesis.label: hypothesis for hypothesis in hypotheses_of(read_catalogue(), twin.model())
}


@dataclass(frozen=True, eq=False)
class Fitted:
    """What the verdict reads of a `Fit`."""

    hypotheses: tuple
    score: float
    values: Any
    std: Any
    theta: tuple = ()
    columns: tuple = ()


def fit(score, *labels, size=1.0, std=0.05, **values):
    """Causes of `size` typical sizes, known to a twentieth of it; values of single numbers by their last name."""
    named = tuple(EVERYONE[label] for label in labels)
    parameters = [parameter for hypothesis in named for parameter in hypothesis.parameters]
    found = {
        parameter.paths[0]: values.get(
            parameter.paths[0].rpartition(".")[2], parameter.neutral + size * parameter.typical
        )
        for parameter in parameters
    }
    return Fitted(
        named,
        score,
        found,
        {parameter.paths[0]: std * parameter.typical for parameter in parameters},
    )


def quiet(_):
    return {"slow": -5.0, "periodic": 1.0}


def verdict(*fits, unmodelled=quiet, null=None):
    return judge([fit(0.0), *fits], unmodelled, null)


def named(judgement):
    return [(finding.cause, finding.component) for finding in judgement.findings]


def test_a_cause_far_above_the_rest_is_named():
    found = verdict(fit(40.0, "thrust_loss of port"), fit(12.0, "mass"))
    assert found.verdict == "named" and named(found) == [("thrust_loss", "port")]
    assert found.findings[0].probability == 0.99 and found.indistinguishable == ()
    assert found.findings[0].parameters["loss"].estimate == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("off", "says"), [((1.0, -1.5, 0.5), "named"), ((-2.6, -1.2, 2.6), "consistent")]
)
def test_a_cause_of_another_shape_is_another_cause(off, says):
    """In units of the tolerances; the second would be exceeded by one right drift in six hundred."""
    drift = fit(40.0, "wave_drift")
    columns = tuple(Regressor({path: 1.0}) for path in drift.hypotheses[0].definition.shape)
    assert verdict(replace(drift, theta=off, columns=columns)).verdict == says


def test_estimates_are_in_the_units_of_the_contract():
    (finding,) = verdict(fit(40.0, "heading_bias")).findings
    assert finding.parameters["offset"].estimate == pytest.approx(3.0)
    # 0.15 deg by the log; a heading counts as right within 0.1 deg
    assert finding.parameters["offset"].std == pytest.approx(np.hypot(0.15, 0.1))
    assert finding.parameters["offset"].unit == "deg"


def test_causes_within_three_nats_are_ambiguous_and_beyond_are_not():
    near = verdict(fit(40.0, "mass"), fit(40.0 - APART + 0.1, "drag"))
    assert near.verdict == "ambiguous" and near.findings == ()
    assert [c.cause for c in near.indistinguishable] == ["mass", "drag"]
    odds = near.indistinguishable[0].probability / near.indistinguishable[1].probability
    assert np.log(odds) == pytest.approx(APART - 0.1, abs=0.05)
    assert verdict(fit(40.0, "mass"), fit(40.0 - APART - 0.1, "drag")).verdict == "named"


def test_what_all_rivals_share_is_a_finding_and_the_rest_is_indistinguishable():
    sets = (("mass", "current"), 60.0), (("drag", "current"), 58.5), (("current",), 30.0)
    alone = (("mass",), 20.0), (("drag",), 20.0)
    found = verdict(*(fit(score, *labels) for labels, score in sets + alone))
    assert found.verdict == "ambiguous" and named(found) == [("current", None)]
    assert {c.cause for c in found.indistinguishable} == {"mass", "drag", "current"}


def test_a_set_with_one_cause_more_is_no_rival_of_the_set_without():
    fits = fit(40.0, "mass"), fit(10.0, "drag"), fit(39.0, "mass", "drag")
    assert named(verdict(*fits)) == [("mass", None)] and verdict(*fits).verdict == "named"


def test_two_causes_are_named_together_when_each_gains_beside_the_other():
    fits = fit(40.0, "mass"), fit(20.0, "drag"), fit(40.0 + ENOUGH + 1.0, "mass", "drag")
    assert sorted(named(verdict(*fits))) == [("drag", None), ("mass", None)]
    fits = fit(40.0, "mass"), fit(20.0, "drag"), fit(40.0 + ENOUGH - 1.0, "mass", "drag")
    assert named(verdict(*fits)) == [("mass", None)]


@pytest.mark.parametrize(
    ("what", "fitted"),
    [
        ("gains too little", fit(ENOUGH - 0.1, "mass")),
        ("too small to matter", fit(40.0, "mass", size=0.9 * EVERYONE["mass"].definition.least)),
        ("not known to a third of its size", fit(40.0, "mass", std=0.4)),
        ("at its bound", fit(40.0, "mass", mass_scale=2.5)),
    ],
)
def test_what_must_not_be_named(what, fitted):
    found = verdict(fitted)
    assert found.verdict == "consistent" and found.findings == (), what


def test_what_healthy_logs_gain_too_is_not_named():
    fits = fit(12.0, "crossflow")
    assert verdict(fits, null={"crossflow": 5.0}).verdict == "named"
    assert verdict(fits, null={"crossflow": 9.0}).verdict == "consistent"
    assert verdict(fits, null={"crossflow": -9.0}).verdict == "named"


def test_an_error_without_a_name_makes_it_unknown_and_the_causes_candidates():
    found = verdict(
        fit(40.0, "mass"), unmodelled=lambda _: {"slow": -3.0, "periodic": UNMODELLED + 0.5}
    )
    assert found.verdict == "unknown" and found.findings == ()
    assert [c.cause for c in found.candidates] == ["mass"]
    assert verdict(unmodelled=lambda _: {"slow": UNMODELLED + 0.5}).verdict == "unknown"
    assert verdict(unmodelled=lambda _: {"slow": UNMODELLED - 0.5}).verdict == "consistent"


def test_what_a_large_cause_leaves_is_measured_by_its_gain():
    """A law is never exact: of 2000 nats a hundredth may be left without a name."""
    assert verdict(fit(2000.0, "tow"), unmodelled=lambda _: {"slow": 20.0}).verdict == "named"
    assert verdict(fit(2000.0, "tow"), unmodelled=lambda _: {"slow": 60.0}).verdict == "unknown"


def test_a_vectors_size_counts_not_each_of_its_components():
    assert named(verdict(fit(40.0, "current", current_east=0.0))) == [("current", None)]


def test_three_causes_at_once_are_rather_one_that_nobody_knows():
    pairs = (("mass", "drag"), 70.0), (("mass", "tow"), 70.0), (("drag", "tow"), 70.0)
    fits = [fit(score, *labels) for labels, score in pairs]
    assert verdict(*fits, fit(100.0, "mass", "drag", "tow")).verdict == "unknown"


def test_gain_of_a_cause_is_over_the_best_set_without_it():
    fits = [fit(0.0), fit(40.0, "mass"), fit(25.0, "drag"), fit(52.0, "mass", "drag")]
    assert (
        gained(EVERYONE["drag"], fits[3], fits) == 12.0
        and gained(EVERYONE["mass"], fits[3], fits) == 27.0
    )
    assert admissible(fits[3], fits, {}) and not admissible(fits[3], fits, {"drag": 8.0})


def test_a_cause_that_differs_from_part_to_part_gives_way_if_it_gains_little_and_is_unknown_if_much():
    def unmodelled(of):
        return {"slow": -5.0, "from part to part": 2.0 * UNMODELLED if of.hypotheses else 0.0}

    assert verdict(fit(10.0, "mass"), unmodelled=unmodelled).verdict == "consistent"
    assert verdict(fit(40.0, "mass"), unmodelled=unmodelled).verdict == "unknown"


def test_what_a_cause_too_small_to_matter_explains_is_no_unmodelled_error():
    def unmodelled(of):
        return {"slow": 20.0 if not of.hypotheses else -5.0}

    trifle = fit(40.0, "mass", size=0.9 * EVERYONE["mass"].definition.least)
    assert verdict(trifle, unmodelled=unmodelled).verdict == "consistent"
    assert verdict(fit(40.0, "mass", mass_scale=2.5), unmodelled=unmodelled).verdict == "unknown"
    assert verdict(trifle, unmodelled=lambda _: {"slow": 20.0}).verdict == "unknown"


@pytest.mark.parametrize(("growth", "says"), [(0.03, "current"), (0.06, "current_varying")])
def test_a_current_that_hardly_turns_is_a_steady_one(growth, says):
    """0.04 m/s is a fifth of a typical current: what is less could not be found aboard."""
    turning = fit(40.0, "current_varying", east_start=0.2, east_end=0.2 + growth)
    assert named(verdict(turning, fit(34.0, "current"))) == [(says, None)]


def test_what_a_current_that_hardly_turns_explains_is_no_unmodelled_error():
    steady = fit(900.0, "current")
    turning = fit(920.0, "current_varying", east_start=0.2, east_end=0.22)

    def slow(one):
        return {"slow": 30.0 if one is steady else 0.0}

    assert named(verdict(steady, turning, unmodelled=slow)) == [("current", None)]
    assert verdict(steady, unmodelled=slow).verdict == "unknown"
