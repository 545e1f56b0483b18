"""How far the form differs is learnt: not at all on a ship of the model's form, beside the cause on another."""

import pytest
import xarray
from diagnose import twin
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.form import learnt, of_scale, scores_by_scale, with_settled_form
from shipcosim.diagnose.inference.search import explain
from shipcosim.diagnose.stages import ExplainedLog, Identification

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
        scores = scores_by_scale(problem, fitted(problem))
        assert max(scores.values()) > scores[0.0] + 20.0
        formed = learnt(problem)
        assert formed.model.form_scale > 0.0
        fits = explain(formed)
        assert not fits[0].hypotheses or fits[0].score < next(f.score for f in fits if not f.hypotheses) + 5.0


def test_a_loss_of_thrust_is_found_beside_another_form(problems):
    with threadpool_limits(1):
        formed = learnt(problems["loss"])
        assert formed.model.form_scale > 0.0
        best = explain(formed)[0]
    assert best.label == "thrust_loss of port"
    assert abs(best.values["port.thrust_loss"] - 0.25) < 3.0 * best.std["port.thrust_loss"]


def test_a_form_that_the_causes_found_do_without_is_given_up_again(problems):
    """Of a ship of the model's form, taken for one of another; the other ship keeps hers."""
    with threadpool_limits(1):
        for problem, expected in ((of_scale(twin.problem("thrust_loss"), 1.0), 0.0), (learnt(problems["loss"]), None)):
            scale = problem.model.form_scale
            found = Identification(xarray.Dataset(), problem.model, {}, (), xarray.Dataset(), problem)
            settled = with_settled_form(ExplainedLog(found, tuple(explain(problem)), False))
            assert settled.identification.problem.model.form_scale == (scale if expected is None else expected)
            assert settled.identification.ship.form_scale == settled.identification.problem.model.form_scale
            assert settled.fits[0].label == "thrust_loss of port"
