"""A diagnosis of several logs: causes by all, sizes judged on the logs that did not give them, file and page."""

import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest
from diagnose import twin
from pydantic import BaseModel, ConfigDict, Field

from shipcosim.cli.diagnosis import print_diagnosis
from shipcosim.diagnose.calibration_pipeline import READING
from shipcosim.diagnose.finding import Candidate, Finding
from shipcosim.diagnose.joint_pipeline import JointDiagnosis, _unusable, diagnose_jointly, steps_of
from shipcosim.diagnose.result import Diagnosis
from shipcosim.errors import ShipcosimError
from shipcosim.report.diagnosis.page import render
from shipcosim.report.diagnosis.words import outcome
from truth import draw

LOST = 0.345
"""Of the starboard thruster's thrust, in the log that is drawn."""


class Strict(BaseModel):
    """What must be there and nothing else."""

    model_config = ConfigDict(extra="forbid")


class Size(Strict):
    estimate: float
    std: float
    unit: str


class JointCandidate(Strict):
    cause: str
    component: str | None
    probability: float
    log: str | None = None


class JointFinding(JointCandidate):
    kind: Literal["data", "physics"]
    parameters: dict[str, Size]
    logs: list[str]
    by_log: dict[str, dict[str, Size]] | None = None
    put_right_in: list[str] | None = None
    segments: list[tuple[float, float]] | None = None
    channels: list[str] | None = None
    onset: float | None = None
    note: str | None = None
    at_reference: dict[str, Size] | None = None


class LogErrors(Strict):
    horizon_s: list[float]
    before_m: list[float]
    after_m: list[float] | None
    before_deg: list[float]
    after_deg: list[float] | None
    fitted_on: list[str]
    own_weather: list[str]


class JointDiscrepancy(Strict):
    what: str
    component: str | None
    axis: str | None
    estimate: float
    std: float
    unit: str
    share: float
    logs: list[str]


class OneLog(Strict):
    name: str
    verdict: Literal["consistent", "named", "ambiguous", "unknown"]
    findings: list[dict]
    discrepancies: list[dict]
    baseline: dict | None
    not_testable: list[str]
    errors: LogErrors | None
    left_out: str | None


class JointBaseline(Strict):
    horizon_s: list[float]
    position_error_m: list[float]
    heading_error_deg: list[float]


class JointGain(Strict):
    horizon_s: float
    before_m: float
    bias_observer_m: None
    after_m: float
    noise_floor_m: float
    share_of_explainable: float | None
    ci95: tuple[float, float] | None
    logs: list[str]


class Schema(Strict):
    """diagnosis.json of several logs, version 1: the entries of one log, and more."""

    version: Literal["shipcosim-diagnosis/1"] = Field(alias="schema")
    verdict: Literal["consistent", "named", "ambiguous", "unknown"]
    findings: list[JointFinding]
    discrepancies: list[JointDiscrepancy]
    candidates: list[JointCandidate]
    indistinguishable: list[JointCandidate]
    not_testable: list[str]
    smallest_visible: list[dict]
    prescription: dict | None
    craft: dict | None
    baseline: JointBaseline | None
    gain: JointGain | None
    remarks: list[str]
    logs: list[OneLog]


def schema_of(found):
    """diagnosis.json as the schema reads it."""
    return Schema.model_validate(json.loads(json.dumps(found.as_json(), allow_nan=False)))


@pytest.fixture(scope="module")
def lost(tmp_path_factory):
    """Two days of a ship of the independent truth that has lost a third of a thruster's thrust; folder, steps told."""
    folder, logs = tmp_path_factory.mktemp("joint"), tmp_path_factory.mktemp("logs")
    for day in (0, 1):
        draw("trial", 3000, among=["thrust_loss"], minutes=10, day=day).save(logs / f"day{day}.csv")
    told = []
    found = diagnose_jointly(
        sorted(logs.iterdir()),
        twin.system(),
        progress=lambda step, *_: told.append(step),
        out=folder,
    )
    return found, folder, list(dict.fromkeys(told))


def test_the_steps_that_are_told_are_those_of_the_plan(lost):
    assert lost[2] == list(steps_of(["day0.csv", "day1.csv"]))


def test_logs_that_cannot_be_used_are_said_together_before_any_work(tmp_path):
    told = []
    for name in ("one", "two"):
        (tmp_path / f"{name}.csv").write_text("time [s],nothing [m]\n0,1\n1,2\n", encoding="utf-8")
    with pytest.raises(ShipcosimError) as raised:
        diagnose_jointly(
            sorted(tmp_path.iterdir()), twin.system(), progress=lambda step, *_: told.append(step)
        )
    assert {"one.csv", "two.csv"} <= {
        problem.where.rpartition("/")[2].split(",")[0] for problem in raised.value.problems
    }
    assert set(told) == {READING}


def test_a_loss_in_both_logs_is_named_once_with_what_each_log_says_of_it(lost):
    found = schema_of(lost[0])
    assert found.verdict == "named" and [(one.cause, one.component) for one in found.findings] == [
        ("thrust_loss", "starboard")
    ]
    (finding,) = found.findings
    assert finding.logs == ["day0", "day1"] and set(finding.by_log) == {"day0", "day1"}
    assert finding.parameters["loss"].estimate == pytest.approx(
        LOST, abs=3.0 * finding.parameters["loss"].std
    )
    assert all(
        size["loss"].std > finding.parameters["loss"].std for size in finding.by_log.values()
    )


def test_each_log_is_predicted_better_by_the_size_that_the_other_says(lost):
    for entry in schema_of(lost[0]).logs:
        assert entry.errors.fitted_on == [name for name in ("day0", "day1") if name != entry.name]
        assert entry.errors.after_m[-1] < 0.9 * entry.errors.before_m[-1]


def test_baseline_and_gain_are_over_both_logs_each_judged_by_the_other(lost):
    found = schema_of(lost[0])
    errors = [one.errors for one in found.logs]
    assert found.baseline.horizon_s == errors[0].horizon_s == errors[1].horizon_s
    assert found.gain.horizon_s == found.baseline.horizon_s[-1] and found.gain.logs == [
        "day0",
        "day1",
    ]
    over_logs = np.sqrt(
        np.mean([np.square([e.before_m[-1], e.after_m[-1]]) for e in errors], axis=0)
    )
    assert (found.baseline.position_error_m[-1], found.gain.after_m) == pytest.approx(
        tuple(over_logs)
    )
    assert found.gain.before_m == pytest.approx(over_logs[0])
    low, high = found.gain.ci95
    assert 0.0 < low < found.gain.share_of_explainable < high < 1.2
    assert found.gain.noise_floor_m <= found.gain.after_m


def test_the_common_cause_and_nothing_else_is_in_the_extended_system(lost):
    found, folder, _ = lost
    assert {path.name for path in folder.iterdir()} == {"extended.ssp", "extended.ssv"}
    assert list(found.extension.values) == ["starboard.thrust_loss"]
    said = found.findings[0].parameters["loss"].estimate
    assert found.extension.values["starboard.thrust_loss"] == pytest.approx(said)


def test_the_page_says_the_cause_its_sizes_and_the_errors_of_each_log(lost, tmp_path, capsys):
    found, *_ = lost
    (tmp_path / "report.html").write_text(render(found), encoding="utf-8")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    for text in (
        "the starboard thruster delivers",
        "day0 alone",
        "Track, day1",
        "Numbers by",
        "starboard",
        "extended.ssv",
    ):
        assert (text in page) is (text != "starboard" or "starboard.thrust_loss" in page)
    print_diagnosis(found, tmp_path)
    said = capsys.readouterr().out
    assert "NAMED" in said and "Errors by log" in said and "report.html" in said


def test_without_a_cause_the_page_still_says_how_far_the_simulation_is_off(lost):
    found = lost[0]
    bare = {
        name: replace(
            one,
            fitted_on=(),
            position={"before": one.position["before"]},
            heading={"before": one.heading["before"]},
        )
        for name, one in found.errors.items()
    }
    plain = replace(
        found,
        verdict="consistent",
        findings=(),
        errors=bare,
        gain=None,
        extension=None,
        changes=(),
    )
    text = render(plain)
    assert schema_of(plain).gain is None and schema_of(plain).baseline == schema_of(found).baseline
    assert (
        "CONSISTENT" in text and "the system stays as it is" in text and "as the system is" in text
    )


def test_weather_has_its_log_in_diagnosis_json_and_a_thruster_her_component():
    findings = (
        Finding("current", "monday", logs=("monday",)),
        Finding("thrust_loss", "port", logs=("friday",)),
    )
    candidates = (Candidate("current", "monday", 0.9),)
    logs = {
        "monday": Diagnosis("consistent"),
        "friday": Diagnosis("named", (Finding("gap", kind="data"),)),
    }
    content = schema_of(JointDiagnosis("named", findings, candidates, (), ("mass",), logs=logs))
    assert [(one.component, one.log) for one in content.findings] == [
        (None, "monday"),
        ("port", None),
    ]
    assert content.candidates[0].log == "monday"
    assert [(one.name, one.verdict) for one in content.logs] == [
        ("monday", "consistent"),
        ("friday", "named"),
    ]
    assert content.logs[1].findings[0]["cause"] == "gap"


def test_a_fault_that_logs_share_is_common_and_another_is_its_logs_own():
    shared = Finding(
        "frame", kind="data", channels=("wind_speed",), note="wind_speed is in kn, not m/s"
    )
    own = Finding("gap", kind="data", segments=((1.0, 9.0),))
    logs = {"a": Diagnosis("named", (shared,)), "b": Diagnosis("named", (shared, own))}
    found = JointDiagnosis("named", (replace(shared, logs=("a", "b")),), logs=logs)
    assert found.own_faults("a") == [] and found.own_faults("b") == [own]
    assert "wind_speed is in kn" in outcome(found).sentence


def test_a_log_that_may_be_misread_or_lacks_a_thruster_says_nothing_of_the_ship():
    open_ = Finding("frame", kind="data", channels=("north",), note="one", alternatives=("two",))
    poor = SimpleNamespace(comparison=SimpleNamespace(obstacles=("No port_rpm in the log.",)))
    basis = SimpleNamespace(explained=SimpleNamespace(identification=poor))
    assert "misread" in _unusable(Diagnosis("ambiguous", (open_,), basis=basis))
    assert _unusable(Diagnosis("unknown", basis=basis)) == "No port_rpm in the log."
    poor.comparison.obstacles = ()
    assert _unusable(Diagnosis("named", basis=basis)) == ""
