"""A cause is named only where the ship with it predicts rows that were kept from the fit better than the plain ship."""

from dataclasses import replace

import pytest
from diagnose import twin

from shipcosim.diagnose.pipeline import find_causes
from shipcosim.diagnose.statement import named_if_better
from shipcosim.diagnose.validation.conditions import with_predictions
from truth import draw

SEED = 711


@pytest.fixture(scope="module")
def named(tmp_path_factory):
    """A diagnosis that names a cause, with its predictions."""
    log = tmp_path_factory.mktemp("log") / "log.csv"
    draw("trial", SEED, among=["thrust_loss"], causes=1, minutes=15).save(log)
    found = find_causes(str(log), twin.system())
    return found, with_predictions(found.basis, True)


def judged(named, **shares):
    """The diagnosis by errors with the cause that are so many times those without."""
    found, predicted = named
    errors = predicted.comparison.errors.copy(deep=True)
    for channel in ("position", "heading"):
        without = errors[channel].sel(model="plain").values
        errors[channel].loc[{"model": "extended"}] = shares.get(channel, 1.0) * without
    comparison = replace(predicted.comparison, errors=errors)
    return named_if_better(found, replace(predicted, comparison=comparison))[0]


def test_a_right_cause_is_named(named):
    found, predicted = named
    assert found.is_named and [finding.cause for finding in found.physics] == ["thrust_loss"]
    assert named_if_better(found, predicted)[0] is found


@pytest.mark.parametrize("channel", ["position", "heading"])
def test_a_gain_in_one_channel_is_enough(named, channel):
    assert judged(named, **{channel: 0.9}) is named[0]


@pytest.mark.parametrize(
    "shares", [{}, {"position": 0.97, "heading": 0.99}, {"position": 1.1, "heading": 0.5}]
)
def test_a_cause_without_a_gain_becomes_a_candidate(named, shares):
    doubted = judged(named, **shares)
    assert doubted.verdict == "unknown" and not doubted.physics
    assert doubted.candidates[0].cause == "thrust_loss"
    assert "not named. On rows that it was not fitted on" in doubted.remarks[-1]
