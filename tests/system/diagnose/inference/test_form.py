"""How far the form differs is learnt: not at all on a ship of the model's form, beside the cause on another."""

from dataclasses import replace

import numpy as np
import pytest
import xarray
from diagnose import twin
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.testability import (
    excitation_of,
    hidden_by_form,
    untestable_causes,
)
from shipcosim.diagnose.explanation.form import learnt, of_scale, scores_by_scale, with_settled_form
from shipcosim.diagnose.explanation.identification import Identification
from shipcosim.diagnose.explanation.search import ExplainedLog, explain
from shipcosim.diagnose.explanation.summary import load_form
from shipcosim.diagnose.explanation.verdict import JudgedLog, Judgement
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.form_section import form_section
from shipcosim.report.diagnosis.words import outcome

FORM = {
    "hull_form.cross_flow_1": 0.35,
    "hull_form.cross_flow_2": 0.3,
    "vessel.Y_v": -8000.0,
    "vessel.X_u": -900.0,
    "wind_form.N_cos_1": 0.2,
    "wind_form.Y_mean": -0.12,
}
LOSS = {"port.thrust_loss": 0.25}


@pytest.fixture(scope="module")
def problems():
    logs = twin.sailed({"healthy": FORM, "loss": FORM | LOSS}, minutes=8.0, seed=3)
    return {name: twin.ready(log) for name, log in logs.items()}


def test_a_ship_of_the_model_s_form_keeps_it():
    for name in ("healthy", "thrust_loss"):
        assert learnt(twin.problem(name)) is twin.problem(name)


def test_a_ship_of_another_form_is_healthy_once_her_form_may_differ(problems):
    with threadpool_limits(1):
        problem = problems["healthy"]
        scores = scores_by_scale(problem)
        assert max(scores.values()) > scores[0.0] + 20.0
        formed = learnt(problem)
        assert formed.model.form_scale > 0.0
        fits = explain(formed)
        assert (
            not fits[0].hypotheses
            or fits[0].score < next(f.score for f in fits if not f.hypotheses) + 5.0
        )


@pytest.fixture(scope="module")
def explained(problems):
    with threadpool_limits(1):
        formed = learnt(problems["loss"])
        return ExplainedLog(identification_of(formed), tuple(explain(formed)), False)


def identification_of(problem):
    return Identification(xarray.Dataset(), problem.model, {}, (), xarray.Dataset(), problem)


def test_a_loss_of_thrust_is_found_beside_another_form(explained):
    assert explained.identification.problem.model.form_scale > 0.0
    best = explained.fits[0]
    assert best.label == "thrust_loss of port"
    assert abs(best.values["port.thrust_loss"] - 0.25) < 3.0 * best.std["port.thrust_loss"]


def test_how_far_the_form_differs_is_said_and_what_it_hides(explained):
    """Mean square of what was planted along the hull: 0.35²/3 + 0.3²/5; the largest numbers are among those moved."""
    best = explained.fits[0]
    log = JudgedLog(explained, Judgement("named", best, (), (), ()), {}, {})
    form = load_form(log)
    planted = np.sqrt(
        FORM["hull_form.cross_flow_1"] ** 2 / 3.0 + FORM["hull_form.cross_flow_2"] ** 2 / 5.0
    )
    assert form.differs["drag across the hull, along her length"] == pytest.approx(
        planted, rel=0.35
    )
    moved = {one.number: one for one in form.numbers}
    assert moved and set(moved) <= set(log.problem.model.uncertainties)
    assert all(abs(one.estimate - one.model) >= 2.0 * one.std for one in moved.values())
    assert all(
        abs(moved[path].estimate - size) < 4.0 * moved[path].std
        for path, size in FORM.items()
        if path in moved
    )
    excitation = excitation_of(log)
    assert set(hidden_by_form(log, excitation)) <= set(untestable_causes(log, excitation))


def test_a_form_that_the_causes_found_do_without_is_given_up_again(explained):
    """Of a ship of the model's form, taken for one of another; the other ship keeps hers."""
    with threadpool_limits(1):
        plain = of_scale(twin.problem("thrust_loss"), 1.0)
        plain = ExplainedLog(identification_of(plain), tuple(explain(plain)), False)
        for log, expected in (
            (plain, 0.0),
            (explained, explained.identification.problem.model.form_scale),
        ):
            settled = with_settled_form(log)
            assert settled.identification.problem.model.form_scale == expected
            assert (
                settled.identification.ship.form_scale
                == settled.identification.problem.model.form_scale
            )
            assert settled.fits[0].label == "thrust_loss of port"


@pytest.mark.parametrize("off", [3.5, -4.5])
def test_a_number_far_beyond_its_tolerance_is_said_on_a_ship_of_the_models_form(off):
    """One chi-square over all numbers forgives a single one that stands for a cause outside the catalogue."""
    problem = twin.problem("healthy")
    fit = fitted(problem)
    place = [column.changes for column in fit.columns].index(
        {"tunnel.thrust_coefficient": problem.model.tolerances["tunnel.thrust_coefficient"]}
    )
    theta = fit.theta.copy()
    theta[place] = off
    judgement = Judgement("consistent", replace(fit, theta=theta), (), (), ())
    log = JudgedLog(ExplainedLog(identification_of(problem), (fit,), True), judgement, {}, {})
    form = load_form(log)
    if abs(off) < 4.0:
        assert form is None
    else:
        assert [one.number for one in form.numbers] == ["tunnel.thrust_coefficient"]
        assert form.differs == {} and form.numbers[0].estimate < form.numbers[0].model
        said = outcome(Diagnosis("form", form=form))
        assert "tunnel.thrust_coefficient is" in said.sentence
        assert form_section(form).numbers.rows
