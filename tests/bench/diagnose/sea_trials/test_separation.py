"""At night: what to sail next is computed, and sailing it tells the right causes from those that fitted alike."""

import pytest
from diagnose.sea_trials.test_separation import SHAFTS, found, sets

from shipcosim.diagnose.experiment.design import prescribed
from shipcosim.diagnose.sea_trials.evidence import ranked, trial_evidence
from shipcosim.diagnose.sea_trials.features import SOUGHT
from shipcosim.diagnose.sea_trials.manoeuvres import as_trials, catalogue
from shipcosim.diagnose.sea_trials.separation import separations
from shipcosim.diagnose.sea_trials.study import best_of, rivals_of

PLANTED = {"vessel.mmg_X_vv": -0.7, "instruments.order_lag": 2.5}


@pytest.fixture(scope="module")
def separated(found, sets):
    return separations(found, sets)


def test_what_was_sailed_already_separates_nothing(separated):
    """The trials held circles with 10, 20 and 32 deg: sailing such again tells no more, by whatever is computed."""
    again = [
        one for one in separated if one.manoeuvre == "turning circle with 20 deg at full speed"
    ]
    assert all(max(one.nats.values()) < 3.0 for one in again) and again


def test_sailing_what_is_prescribed_tells_the_planted_drag_from_the_others(found, sets, separated):
    assert len(sets) > 1
    designs = prescribed(separated, sets)
    chosen = [
        one
        for one in catalogue(found.model)
        if one.name in {design.manoeuvre for design in designs}
    ]
    assert chosen and all(one.kind in SOUGHT for one in chosen)
    more = [trial for _, pair in as_trials(chosen, found.model, SHAFTS, PLANTED) for trial in pair]
    ranking = ranked(trial_evidence([*found.trials, *more], found.model, found.hypotheses))
    assert {cause.cause for cause in best_of(ranking).hypotheses} == {"drift_drag", "late_orders"}
    assert not rivals_of(ranking)
