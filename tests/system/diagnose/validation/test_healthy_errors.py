"""What healthy ships miss on the rows of a log, and that "consistent" holds only where the system misses no more."""

from dataclasses import replace

import pytest
from diagnose import twin

from shipcosim.diagnose.pipeline import find_causes
from shipcosim.diagnose.statement import verified
from shipcosim.diagnose.validation.conditions import with_predictions
from shipcosim.report.diagnosis.words import outcome
from truth import draw

SEED = 709


@pytest.fixture(scope="module")
def agreed(tmp_path_factory):
    return agreed_on("trial", tmp_path_factory)  # a ship that holds her place: at night


def agreed_on(kind, tmp_path_factory):
    """A diagnosis of a healthy log, with its predictions."""
    log = tmp_path_factory.mktemp("log") / "log.csv"
    draw(kind, SEED, causes=0, minutes=15).save(log)
    found = find_causes(str(log), twin.system())
    return found, with_predictions(found.basis, False)


def test_a_healthy_ship_is_predicted_as_well_as_others(agreed):
    found, predicted = agreed
    assert found.verdict == "consistent"
    sure = verified(*agreed)
    assert sure.verdict == "consistent"
    healthy = sure.healthy
    assert healthy.beyond == []
    entry = sure.as_json()["healthy_errors"]
    assert entry["position_error_m"] == healthy.largest["position"]
    assert "healthy ships are off by up to" in outcome(sure).sentence


@pytest.mark.parametrize("channel", ["position", "heading"])
def test_a_system_that_misses_more_is_not_consistent(agreed, channel):
    found, predicted = agreed
    largest = verified(*agreed).healthy.largest[channel]
    errors = predicted.comparison.errors.copy(deep=True)
    errors[channel].loc[{"model": "plain"}] = 1.5 * largest
    worse = replace(predicted, comparison=replace(predicted.comparison, errors=errors))
    doubted = verified(found, worse)
    assert doubted.verdict == "unknown"
    assert f"in {channel} (at most" in doubted.notes[-1]
