"""What several logs say together: findings in single logs combined, entries of diagnosis.json."""

import json

import pytest

from shipcosim.diagnose.joint_pipeline import JointDiagnosis, combined
from shipcosim.diagnose.result import Candidate, Diagnosis, Estimate, Finding


def ratio(value, std):
    return Finding("lost", None, parameters={"ratio": Estimate(value, std, "1")})


def test_findings_of_single_logs_are_weighed_by_what_they_know():
    (found,) = combined({"a": [ratio(0.4, 0.01)], "b": [ratio(0.5, 0.1)]}, 2)
    assert found.parameters["ratio"].estimate == pytest.approx(0.401, abs=0.001)
    assert 0.0099 < found.parameters["ratio"].std < 0.0101


def test_logs_that_disagree_widen_what_they_say_together():
    (found,) = combined({"a": [ratio(0.3, 0.01)], "b": [ratio(0.5, 0.01)]}, 2)
    assert found.parameters["ratio"].std == pytest.approx(0.1)


def test_what_fewer_than_half_of_the_logs_show_is_not_common():
    assert combined({"a": [ratio(0.4, 0.01)]}, 3) == ()


def test_weather_has_its_log_in_diagnosis_json_and_a_thruster_her_component():
    findings = (Finding("current", "monday"), Finding("thrust_loss", "port"))
    candidates = (Candidate("current", "monday", 0.9),)
    logs = {"monday": Diagnosis("consistent"), "friday": Diagnosis("named", (Finding("gap", kind="data"),))}
    content = json.loads(json.dumps(JointDiagnosis("named", findings, candidates, (), ("mass",), logs).as_json()))
    assert [(one["component"], one.get("log")) for one in content["findings"]] == [(None, "monday"), ("port", None)]
    assert content["candidates"][0]["log"] == "monday"
    assert [(one["name"], one["verdict"]) for one in content["logs"]] == [("monday", "consistent"), ("friday", "named")]
    assert content["logs"][1]["findings"][0]["cause"] == "gap"
