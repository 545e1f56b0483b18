"""Causes that begin, grow, or come and go, in logs of the independent truth: by name, course and size over time."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.explanation.course import RAMP, SPELL, STEP, SWITCHING, Course
from shipcosim.diagnose.explanation.course_search import _tries, _Whitened
from shipcosim.diagnose.explanation.summary import evidence_of
from shipcosim.diagnose.inference.evidence import evidence
from shipcosim.diagnose.inference.fitting import fitted
from shipcosim.diagnose.inference.parts import beside
from shipcosim.diagnose.inference.regressors import regressors_of
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.report.diagnosis.cause_section import cause_section
from shipcosim.report.diagnosis.words import finding_text
from truth import draw

SEED = 702
JUMP = 200.0
"""When a compass jumps, between two blocks of the search. [s]"""
DRAWN = {STEP: True, RAMP: "ramp", SWITCHING: "switching"}
"""A single spell is tried at night: it is found as several are."""
MINUTES = {STEP: 20, RAMP: 14, SWITCHING: 24}
"""What comes and goes takes a longer log to be told from a fault of the log."""


@pytest.fixture(scope="module", params=DRAWN)
def answered(request, tmp_path_factory):
    """The kind of course, what is hidden in a log, and what a diagnosis says of it."""
    return answer_of(request.param, DRAWN[request.param], tmp_path_factory)


def answer_of(kind, drawn, tmp_path_factory):
    options = {"onset": drawn, "minutes": MINUTES.get(kind, 20)}
    case = draw("trial", SEED, among=["thrust_loss"], size=2.0, **options)
    log = tmp_path_factory.mktemp("log") / "log.csv"
    case.save(log)
    system = twin.system()
    return kind, case.answer[0], find_causes(str(log), system)


def share_of(answer, time):
    """How much of a hidden effect is there at some times, (n,) array."""
    if answer.course == "ramp":
        ((start, end),) = answer.spells
        return np.clip((time - start) / (end - start), 0.0, 1.0)
    if answer.course:
        return np.any([(time > a) & (time < b) for a, b in answer.spells], axis=0) * 1.0
    return (time > answer.onset) * 1.0


def test_the_cause_is_named_with_its_course(answered):
    kind, answer, found = answered
    (finding,) = found.findings
    assert found.verdict == "named" and finding.label == f"{answer.cause} of {answer.component}"
    assert finding.course == kind
    assert finding.parameters["loss"].estimate == pytest.approx(answer.parameters["loss"], rel=0.2)
    entry = finding.as_json()
    assert entry["course"] == kind and entry["onset"] == entry["segments"][0][0]


def test_the_size_over_time_has_the_truth_within_its_band(answered):
    _, answer, found = answered
    course = found.basis.explained.course
    (sizes,) = course.sizes
    half = 0.5 * (sizes.time[1] - sizes.time[0])
    inside = [
        share_of(answer, np.linspace(t - half, t + half, 200)).mean() * answer.parameters["loss"]
        for t in sizes.time
    ]
    assert np.mean(np.abs(sizes.size - inside) < 3.0 * sizes.std + 0.03) >= 0.8


def test_page_and_words_say_when_it_is_there(answered):
    kind, _, found = answered
    said = finding_text(found.findings[0])
    words = {
        STEP: " s on",
        RAMP: "growing from ",
        SPELL: ", from ",
        SWITCHING: "coming and going, ",
    }
    assert words[kind] in said
    complete = replace(found, evidence=evidence_of(found.basis))
    section = cause_section(complete, complete.evidence)
    assert words[kind].strip(", ") in section.course
    (figure,) = section.sizes
    assert figure.unit == "%" and len(figure.traces) == 2


def test_a_compass_that_jumps_within_a_block_is_a_step_from_its_row_on():
    log = twin.sailed({"healthy": {}}, 6.0, 0)["healthy"]
    jump = np.radians(4.0)
    after = log["time"].values >= JUMP
    surge, sway = log["surge"].values.copy(), log["sway"].values.copy()
    log["heading"][after] += np.degrees(jump)
    log["surge"][after] = (np.cos(jump) * surge + np.sin(jump) * sway)[after]
    log["sway"][after] = (np.cos(jump) * sway - np.sin(jump) * surge)[after]
    problem = twin.ready(log)
    base = fitted(problem)
    best = max(_tries(_Whitened(problem, base)), key=lambda attempt: attempt.score)
    assert best.hypothesis.cause == "heading_bias" and best.course.kind == STEP
    assert best.course.start == pytest.approx(JUMP, abs=1.0)
    (offset,) = best.values.values()
    assert offset == pytest.approx(jump, rel=0.1)


def test_columns_filtered_beside_a_fit_weigh_as_filtered_with_it():
    problem = twin.ready(twin.sailed({"healthy": {}}, 6.0, 0)["healthy"])
    base = fitted(problem)
    group = regressors_of(problem.hypotheses[:1])
    throughout = [(place, np.ones(problem.record.time.size)) for place in problem.places(group)]
    weighed = _Whitened(problem, base).weighed(problem.linear, [throughout, throughout])
    products = problem.gram(beside(base.linear, problem.base_of(group))).products
    priors = np.array([column.prior for column in base.columns] + [1.0] * len(group))
    score, theta, _ = evidence(products, priors, np.append(base.centre, np.zeros(len(group))))
    for found_score, found_theta, _ in weighed:
        assert found_score == pytest.approx(score, abs=1e-6)
        assert found_theta == pytest.approx(theta[-len(group) :], rel=1e-6, abs=1e-9)


def test_each_edge_of_a_course_moves_but_for_the_end_of_the_log():
    moved = Course(SWITCHING, ((10.0, 20.0), (30.0, 40.0))).moved(5.0, 40.0)
    assert [course.spells for course in moved] == [
        ((15.0, 20.0), (30.0, 40.0)),
        ((10.0, 25.0), (30.0, 40.0)),
        ((10.0, 20.0), (35.0, 40.0)),
    ]
    assert Course(SPELL, ((10.0, 20.0),)).moved(-10.0, 40.0) == [Course(SPELL, ((0.0, 20.0),))]


def test_a_course_is_there_in_its_spells_alone():
    time = np.array([0.0, 10.0, 20.0, 30.0, 40.0])
    assert Course(SWITCHING, ((10.0, 20.0), (30.0, 40.0))).at(time).tolist() == [0, 1, 0, 1, 0]
    assert Course(RAMP, ((20.0, 40.0),)).at(time).tolist() == [0, 0, 0, 0.5, 1]
    assert Course(STEP, ((30.0, 41.0),)).start == 30.0
