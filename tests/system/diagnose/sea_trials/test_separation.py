"""What to sail next is computed, and sailing it tells the right causes from those that fitted alike."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnose import twin
from diagnose.sea_trials import trials

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.experiment.design import Separation, prescribed
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.sea_trials.evidence import SetOfCauses, ranked, trial_evidence
from shipcosim.diagnose.sea_trials.manoeuvres import as_trials, catalogue
from shipcosim.diagnose.sea_trials.study import best_of, causes_of_trials, rivals_of
from shipcosim.diagnose.sea_trials.windows import as_ordered, sea_trials_of
from shipcosim.diagnose.ship.inputs import record_of

SHAFTS = {"port": 170.0 / 60.0, "starboard": 170.0 / 60.0}


@pytest.fixture(scope="module")
def found():
    (log,) = trials.logs(
        {"slowed in turns": {"vessel.mmg_X_vv": -0.7, "lag": 2.5}}, seed=3
    ).values()
    read = checked(ReadLog(log, twin.model(), {}))
    record = as_ordered(record_of(read.repaired, read.ship), read.repaired, read.ship)
    drags = {"drift_drag", "turn_drag", "sway_momentum", "late_orders"}
    causes = [
        one
        for one in causes_of_trials(twin.model(), read_catalogue(), orders=True)
        if one.cause in drags
    ]
    return trial_evidence(sea_trials_of(record, read.ship, orders=True), twin.model(), causes)


@pytest.fixture(scope="module")
def sets(found):
    ranking = ranked(found)
    return [best_of(ranking), *rivals_of(ranking)]


def test_a_ship_sails_every_manoeuvre_of_the_catalogue_to_both_sides():
    model = twin.model()
    sailed = as_trials(catalogue(model), model, SHAFTS, {})
    for one, (starboard, port) in sailed:
        assert (starboard.side, port.side) == (1, -1)
        turned = [trial.measured[-1, 2] - trial.measured[0, 2] for trial in (starboard, port)]
        assert turned[0] == pytest.approx(-turned[1], abs=1e-6), one.name
        if one.kind == "turning circle":
            assert turned[0] > np.radians(540.0)
    swings = next(
        pair[0] for one, pair in sailed if one.name == "zig-zag 20/20 at full speed"
    ).measured[:, 2]
    assert 20.0 < np.degrees(swings.max()) < 45.0 and -45.0 < np.degrees(swings.min()) < -20.0


def test_as_few_manoeuvres_are_prescribed_as_tell_all_pairs_apart():
    def separation(name, minutes, read, *nats):
        pairs = dict(zip(((0, 1), (0, 2), (1, 2)), nats, strict=True))
        return Separation(name, minutes, pairs, read)

    sets = [
        SetOfCauses((SimpleNamespace(label=name),), np.zeros(1), np.zeros(1), 0.0) for name in "abc"
    ]
    half, other = (
        separation("half", 10.0, True, 5.0, 30.0, 40.0),
        separation("other", 8.0, True, 12.0, 3.0, 2.0),
    )
    quick = separation("quick, not read from logs", 4.0, False, 50.0, 0.0, 0.0)
    (first, second) = prescribed([half, other, quick], sets)
    assert first.manoeuvre == "half" and first.separates == (("a", "c"), ("b", "c"))
    assert second.manoeuvre == "other" and second.separates == (("a", "b"),)
    assert prescribed([separation("nothing", 5.0, True, 9.0, 9.0, 9.0)], sets) == ()
