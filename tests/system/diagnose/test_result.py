"""What a diagnosis says is what diagnosis.json holds by the contract."""

import json

from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.finding import Candidate, Finding, ParameterEstimate
from shipcosim.diagnose.result import Diagnosis

ENTRIES = {
    *("schema", "verdict", "findings", "candidates", "indistinguishable"),
    *(
        "not_testable",
        "smallest_visible",
        "prescription",
        "discrepancies",
        "form",
        "craft",
        "baseline",
        "healthy_errors",
        "gain",
    ),
}
CURRENT = Finding(
    "current",
    probability=0.97,
    parameters={
        "north": ParameterEstimate(0.21, 0.02, "m/s"),
        "east": ParameterEstimate(-0.10, 0.02, "m/s"),
    },
)


def test_a_finding_of_physics_is_the_contracts_example():
    assert json.loads(json.dumps(CURRENT.as_json())) == {
        "cause": "current",
        "component": None,
        "kind": "physics",
        "probability": 0.97,
        "parameters": {
            "north": {"estimate": 0.21, "std": 0.02, "unit": "m/s"},
            "east": {"estimate": -0.10, "std": 0.02, "unit": "m/s"},
        },
    }


def test_a_fault_of_the_data_says_where_and_in_which_channels_even_if_everywhere():
    fault = Finding(
        "sign", kind="data", channels=("tunnel_rpm",), note="tunnel_rpm has the other sign"
    ).as_json()
    assert (fault["segments"], fault["channels"]) == ([], ["tunnel_rpm"])
    assert fault["note"] == "tunnel_rpm has the other sign" and "onset" not in fault
    assert Finding("gap", kind="data", segments=((10.0, 40.0),)).as_json()["segments"] == [
        [10.0, 40.0]
    ]


def test_an_onset_is_there_only_where_a_cause_has_one():
    assert Finding("mass", onset=0.0).as_json()["onset"] == 0.0
    assert "onset" not in CURRENT.as_json() and "segments" not in CURRENT.as_json()


def test_a_diagnosis_has_all_entries_of_the_contract_whatever_is_known():
    for diagnosis in (
        Diagnosis("consistent"),
        Diagnosis("named", (CURRENT,), gain={"horizon_s": 60}),
    ):
        entries = json.loads(json.dumps(diagnosis.as_json()))
        assert set(entries) == ENTRIES and entries["schema"] == "shipcosim-diagnosis/1"
    assert Diagnosis("consistent").as_json()["prescription"] is None


def test_an_ambiguous_diagnosis_names_the_manoeuvre_and_the_pairs_it_separates():
    pair = (Candidate("tow", None, 0.6), Candidate("wave_drift", None, 0.4))
    sail = ExperimentDesign("turn by 90 deg and hold", 6.0, (("tow", "wave_drift"),))
    entries = json.loads(
        json.dumps(Diagnosis("ambiguous", indistinguishable=pair, prescription=sail).as_json())
    )
    assert entries["indistinguishable"][0] == {
        "cause": "tow",
        "component": None,
        "probability": 0.6,
    }
    assert entries["prescription"] == {
        "manoeuvre": "turn by 90 deg and hold",
        "minutes": 6.0,
        "separates": [["tow", "wave_drift"]],
    }


def test_a_reading_that_is_left_open_says_all_of_them_and_that_nothing_was_done():
    finding = Finding(
        "frame", None, "data", 0.4, channels=("north",), note="one", alternatives=("two", "three")
    )
    assert finding.sentence == "one; or two; or three: the log does not tell, nothing is corrected"
    assert finding.as_json()["alternatives"] == ["two", "three"]
    assert "alternatives" not in Finding("frame", kind="data").as_json()
