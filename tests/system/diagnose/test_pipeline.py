"""From a file to a diagnosis: planted causes are named at their place with their size, healthy logs left alone."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose import twin

import shipcosim
from shipcosim.diagnose import pipeline
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.errors import ShipcosimError
from shipcosim.series import write_table

PARAMETERS = {  # truth by cause and component, in the contract's units
    "current": {("current", None): {"north": 0.22, "east": -0.12}},
    "thrust_loss": {("thrust_loss", "port"): {"loss": 0.25}},
    "heading_bias": {("heading_bias", None): {"offset": 3.0}},
    "mass": {("mass", None): {"scale": 1.25}},
    "two": {("thrust_loss", "tunnel"): {"loss": 0.3}, ("lever_arm", None): {"x": 5.0, "y": 2.0}},
}


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """Function from the name of a planted log to its diagnosis."""

    @cache
    def of(name):
        path = tmp_path_factory.mktemp("log") / "log.csv"
        write_table(twin.logs()[name], path)
        return find_causes(path, twin.system())

    return of


def test_a_planted_current_is_named_with_its_parameters(diagnosed):
    check_planted("current", diagnosed)


def check_planted(name, diagnosed):
    """Exactly the planted causes are named, with their parameters within three standard deviations."""
    diagnosis = diagnosed(name)
    assert diagnosis.verdict == "named"
    found = {(finding.cause, finding.component): finding for finding in diagnosis.findings}
    assert set(found) == set(PARAMETERS[name])
    for key, parameters in PARAMETERS[name].items():
        assert found[key].probability > 0.9 and found[key].onset is None
        for parameter, truth in parameters.items():
            estimate = found[key].parameters[parameter]
            assert abs(estimate.estimate - truth) < 3.0 * estimate.std, parameter


def test_a_healthy_log_is_consistent_and_progress_is_told_in_words(tmp_path):
    path, said = tmp_path / "log.csv", []
    write_table(twin.logs()["healthy"], path)
    diagnosis = find_causes(path, twin.system(), progress=said.append)
    assert len(said) >= 3 and all(" " in words for words in said)
    assert (diagnosis.verdict, diagnosis.findings, diagnosis.prescription) == (
        "consistent",
        (),
        None,
    )
    assert max(diagnosis.basis.unmodelled.values()) <= 0.0 and diagnosis.basis.fit.hypotheses == ()


def test_what_a_diagnosis_rests_on_comes_with_it(diagnosed):
    diagnosis = diagnosed("current")
    basis, found = diagnosis.basis, diagnosis.basis.explained.identification
    assert basis.fit in basis.fits and basis.fit.label == "current"
    assert found.log.sizes["time"] == found.repaired.sizes["time"] == 361
    kinds = {
        "slow",
        "with the heading",
        "periodic",
        "in a channel",
        "from part to part",
        "beyond tolerances",
    }
    assert set(basis.unmodelled) == kinds
    assert "current" not in diagnosis.not_testable
    gain = basis.fit.score - next(fit.score for fit in basis.fits if not fit.hypotheses)
    assert gain > 100.0 and basis.null_gains == {}


def test_a_thruster_without_a_command_in_the_log_is_said_and_not_blamed():
    problem, fits = twin.explained(twin.logs()["thrust_loss"].drop_vars("tunnel_rpm"))
    assert any("No speed of 'tunnel'" in remark for remark in problem.record.remarks)
    assert not any(hypothesis.label == "thrust_loss of tunnel" for hypothesis in fits[0].hypotheses)


@pytest.mark.parametrize("absent", [["tunnel_rpm"], ["port_rpm", "starboard_azimuth"]])
def test_a_log_that_lacks_what_drives_a_thruster_names_no_cause_and_says_what_would_do(absent):
    """Of such logs of the trial six in sixteen were given a wrong name: other thrusters, a current, a sign, a ratio."""
    diagnosis = find_causes(twin.logs()["current"].drop_vars(absent), twin.system())
    assert (diagnosis.verdict, diagnosis.findings, diagnosis.candidates) == ("unknown", (), ())
    (obstacle,) = diagnosis.obstacles
    assert {"thrust_loss", "current", "drag"} <= set(diagnosis.not_testable)
    assert all(channel in obstacle for channel in absent)
    assert [fit.hypotheses for fit in diagnosis.basis.fits] == [()]


def test_a_parked_ship_can_show_little(tmp_path):
    """Six minutes at rest, by a log that is noise: nothing is named, and most causes are not testable."""
    random, log = np.random.default_rng(0), twin.logs()["healthy"]
    still = {role: 0.0 * log[role] for role in log.data_vars}
    noise = dict(zip(twin.ROLES, twin.WHITE * np.array(twin.TO_LOG), strict=True))
    still |= {
        role: 0.0 * log[role] + std * random.standard_normal(log.sizes["time"])
        for role, std in noise.items()
    }
    path = tmp_path / "log.csv"
    write_table(log.assign(still), path)
    diagnosis = find_causes(path, twin.system())
    assert not [finding for finding in diagnosis.findings if finding.kind == "physics"]
    assert {"mass", "drag", "crossflow", "thrust_loss", "velocity_scale"} <= set(
        diagnosis.not_testable
    )


def test_a_log_that_is_too_short_is_refused(tmp_path):
    path = tmp_path / "log.csv"
    write_table(twin.logs()["healthy"].isel(time=slice(60)), path)
    with pytest.raises(ShipcosimError, match="60 rows"):
        find_causes(path, twin.system())


def test_from_python_one_value_has_findings_extended_system_and_all_that_the_page_shows():
    """Of a table as of a file; the current is put into the system, whose files stay as long as the diagnosis."""
    said = []
    log, system = twin.logs()["current"], twin.system()
    diagnosis = shipcosim.diagnose(log, system, progress=lambda *doing: said.append(doing[0]))
    assert (diagnosis.verdict, [finding.label for finding in diagnosis.findings]) == (
        "named",
        ["current"],
    )
    assert diagnosis.extension.ssp.is_file() and diagnosis.changes
    speed = np.hypot(
        *(diagnosis.findings[0].parameters[name].estimate for name in ("north", "east"))
    )
    assert {change.name: change.after for change in diagnosis.changes}[
        "current_speed"
    ] == pytest.approx(speed)
    assert diagnosis.evidence.sets[0].is_chosen and diagnosis.evidence.gains[0].gain > 100.0
    assert "extending the system" in said and diagnosis.log.measured.sizes["time"] == 361
    assert "diagnose" in dir(shipcosim) and diagnosis.as_json()["verdict"] == "named"


@pytest.mark.parametrize("gain, wins", [(112.0, "course"), (40.0, "labels")])
def test_the_likelier_of_wrong_labels_in_a_part_and_of_a_course_counts(monkeypatch, gain, wins):
    """Labels gain 57 nats, as in a log of the trial (hold, 9602) that named them where a course gains 112."""

    def log(name, score, faults=()):
        return SimpleNamespace(
            name=name,
            identification=SimpleNamespace(faults=faults),
            fits=[SimpleNamespace(score=score)],
        )

    given = log("given", 100.0)
    corrected = log("labels", 157.0, (SimpleNamespace(segments=((0.0, 1320.0),)),))
    with_course = log("course", 100.0)
    with_course.course = SimpleNamespace(gain=gain)
    monkeypatch.setattr(pipeline, "with_right_inputs", lambda *_: corrected)
    monkeypatch.setattr(
        pipeline, "with_course", lambda log, plain: with_course if log is given else log
    )
    assert pipeline._with_labels_or_course(given, None).name == wins
