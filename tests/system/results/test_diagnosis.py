"""Diagnoses, replays, comparisons and calibrations as Python gives them back."""

import inspect
import json

import pytest

import shipcosim as sc
import shipcosim.diagnose.pipeline  # a module of the room, imported before the room is called
from shipcosim.diagnose.finding import Candidate, Finding, ParameterEstimate
from shipcosim.diagnose.result import Diagnosis
from shipcosim.results.diagnosis import DiagnosisOfLog
from shipcosim.results.shown import parts_of

LOST = Finding(
    "thrust_loss", "port", probability=0.97, parameters={"loss": ParameterEstimate(0.31, 0.02, "1")}
)


@pytest.fixture
def found():
    """A made-up diagnosis."""
    candidates = (Candidate("thrust_loss", "port", 0.97),)
    return DiagnosisOfLog(
        **parts_of(Diagnosis("named", (LOST,), candidates, not_testable=("wind_scale",)))
    )


def test_a_diagnosis_is_one_with_a_card(found):
    assert isinstance(found, Diagnosis) and found.is_named and found.findings == (LOST,)
    assert (
        repr(found).startswith("<Diagnosis of a log: NAMED. At least one thing is not as modelled")
        and len(repr(found)) < 300
    )
    card = found._repr_html_()
    assert (
        "Thrust loss of port" in card
        and "97 %" in card
        and "0.31 ± 0.02" in card
        and "Wind scale" in card
    )
    assert json.loads(json.dumps(found.as_json()))["verdict"] == "named"


def test_a_diagnosis_without_predictions_has_no_track(found):
    with pytest.raises(sc.ShipcosimError, match="no predictions of this log"):
        found.track()


def test_the_room_can_be_called_and_says_its_form():
    assert list(inspect.signature(sc.diagnose).parameters)[:3] == ["log", "system", "channels"]
    with pytest.raises(sc.ShipcosimError, match="Did you mean 'channels'"):
        sc.diagnose("gunnerus_log", chanels="x.toml")
    with pytest.raises(sc.ShipcosimError, match="There is no such system"):
        sc.diagnose("gunnerus_log", "gunnerus_opn")
    with pytest.raises(sc.ShipcosimError, match="There is: gunnerus_log"):
        sc.diagnose("gunnerus_lgo")


def test_what_was_changed_in_a_structure_goes_into_its_diagnosis(monkeypatch):
    """And is not read again from its file."""
    given = []
    monkeypatch.setattr(
        "shipcosim.diagnose.pipeline.diagnose",
        lambda log, system, *_, **__: given.append(system) or FOUND,
    )
    structure = sc.read("gunnerus_open").copy()
    structure.parameters["vessel.mass"] = 6e5
    sc.diagnose("gunnerus_log", structure)
    assert given[0].parameters["vessel.mass"] == 6e5


FOUND = Diagnosis("consistent")


def test_a_replay_shows_errors_and_track():
    log = sc.read_log("gunnerus_log")
    found = sc.replay(log.table.isel(time=slice(0, 300)), horizon=20.0)
    assert "REPLAYED" in repr(found) and "Errors, root mean square" in found._repr_html_()
    assert "measured" in found.track().svg and "simulated" in found.track().svg
    assert found.page().html.count("gunnerus_open") >= 1
    assert "position" in found.to_pandas().columns


def test_engines_are_compared_by_name():
    found = sc.compare("otter_open", stop_time=0.5, step_size=0.1)
    assert found.agree and "Engines on otter_open" in repr(found)
    assert (
        "half the step" in found.to_pandas().columns
        and "Largest differences" in found._repr_html_()
    )
