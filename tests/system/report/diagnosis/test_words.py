"""What a diagnosis says in words: numbers with fitting digits, causes, verdicts, what to do next."""

from dataclasses import replace

import pytest

from shipcosim.diagnose.experiment.design import ExperimentDesign
from shipcosim.diagnose.explanation.summary import LoadForm
from shipcosim.diagnose.finding import Candidate, Discrepancy, Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.estimates import plus_minus, vector
from shipcosim.report.diagnosis.words import (
    estimate_rows,
    finding_text,
    next_steps,
    outcome,
    title,
    where,
)
from shipcosim.report.theme.numbers import plain

LOSS = Finding("thrust_loss", "port", parameters={"loss": ParameterEstimate(0.337, 0.0121, "1")})
GAP = Finding(
    "gap", kind="data", segments=((463.0, 499.0), (912.0, 1001.0)), channels=("north", "east")
)


def pair(cause, north, east, unit, std=0.01):
    return Finding(
        cause,
        parameters={
            "north": ParameterEstimate(north, std, unit),
            "east": ParameterEstimate(east, std, unit),
        },
    )


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (ParameterEstimate(0.33729, 0.0121, "1"), "0.337 ± 0.012"),
        (ParameterEstimate(-4.43, 0.15, "deg"), "−4.43 ± 0.15°"),
        (ParameterEstimate(-4.43, 0.4, "deg"), "−4.4 ± 0.4°"),
        (ParameterEstimate(4122.8, 80.4, "N"), "4.12 ± 0.08 kN"),
        (ParameterEstimate(400.0, 80.4, "N"), "400 ± 80 N"),
        (ParameterEstimate(2.0, 0.0, "s"), "2.00 ± 0.00 s"),
    ],
)
def test_number_has_the_digits_that_its_uncertainty_is_worth(estimate, text):
    assert plus_minus(estimate) == text


def test_parts_of_a_vector_share_one_unit():
    rows = estimate_rows(pair("tow", 4122.0, 87.0, "N", std=80.0))
    assert [unit for _, _, _, unit in rows] == ["kN", "kN"]


@pytest.mark.parametrize(
    ("north", "east", "direction"),
    [
        (1.0, 0.0, "000°"),
        (0.0, 1.0, "090°"),
        (-1.0, 0.0, "180°"),
        (0.0, -1.0, "270°"),
        (1.0, -1e-4, "000°"),
    ],
)
def test_direction_of_a_vector_is_clockwise_from_north(north, east, direction):
    assert vector(
        ParameterEstimate(north, 0.1, "m/s"), ParameterEstimate(east, 0.1, "m/s")
    ).endswith(direction)


def test_what_is_not_known_is_a_dash():
    assert plain(None) == plain(float("nan")) == "–"


@pytest.mark.parametrize(
    ("finding", "said"),
    [
        (LOSS, "the port thruster delivers 34 ± 1 % less thrust"),
        (pair("current", 0.0, -0.2, "m/s"), "a current of 0.200 ± 0.010 m/s towards 270°"),
        (
            Finding("mass", parameters={"scale": ParameterEstimate(0.9, 0.02, "1")}),
            "10 ± 2 % lighter",
        ),
        (
            Finding("drag", parameters={"scale": ParameterEstimate(2.2, 0.1, "1")}),
            "120 ± 10 % larger",
        ),
        (
            Finding("heading_bias", parameters={"offset": ParameterEstimate(-3.0, 0.2, "deg")}),
            "shows 3.0 ± 0.2° too little",
        ),
        (
            Finding(
                "azimuth_offset", "port", parameters={"offset": ParameterEstimate(5.0, 0.2, "deg")}
            ),
            "points 5.0 ± 0.2° clockwise of what its feedback says",
        ),
        (
            Finding(
                "rpm_offset", "port", parameters={"offset": ParameterEstimate(8.0, 0.3, "rpm")}
            ),
            "logged 8.0 ± 0.3 rpm too high",
        ),
        (
            Finding(
                "lever_arm",
                parameters={
                    "x": ParameterEstimate(-4.0, 0.3, "m"),
                    "y": ParameterEstimate(2.0, 0.3, "m"),
                },
            ),
            "4.0 ± 0.3 m aft and 2.0 ± 0.3 m to starboard",
        ),
        (GAP, "data was lost or filled in for 125 s in 2 stretches"),
        (Finding("sign", kind="data", channels=("sway",)), "wrong sign (sway)"),
    ],
    ids=lambda value: value.cause if isinstance(value, Finding) else "",
)
def test_sense_and_size_of_a_cause_are_told(finding, said):
    assert said in finding_text(finding)


def test_onset_is_told():
    finding = Finding("mass", parameters={"scale": ParameterEstimate(1.1, 0.02, "1")}, onset=612.0)
    assert finding_text(finding).endswith(", from 612 s on")


def test_cause_of_ones_own_speaks_by_its_own_sentence():
    effect = read_catalogue()["drag"].model_copy(
        update={"cause": "ice", "sentence": "Ice is on the hull", "statement": ""}
    )
    ice = Finding("ice", parameters={"thickness": ParameterEstimate(0.2, 0.05, "m")})
    assert finding_text(ice, {"ice": effect}) == "ice is on the hull: thickness 0.20 ± 0.05 m"


def test_every_cause_of_the_catalogue_has_advice():
    assert all(cause.next_step and cause.statement for cause in read_catalogue().values())


@pytest.mark.parametrize(
    ("diagnosis", "word", "said"),
    [
        (Diagnosis("consistent"), "CONSISTENT", ["agree, within noise"]),
        (
            Diagnosis("named", (LOSS,)),
            "NAMED",
            ["At least one thing is not as modelled", "port thruster"],
        ),
        (
            Diagnosis("named", (LOSS, pair("tow", 1.0, 2.0, "N"))),
            "NAMED",
            ["2 things are", " and a pull of"],
        ),
        (
            Diagnosis("named", (GAP,)),
            "NAMED",
            ["The log is faulty", "Apart from that, simulation and log agree"],
        ),
        (
            Diagnosis("named", (GAP, LOSS)),
            "NAMED",
            ["port thruster", "The log itself is faulty: data was lost"],
        ),
        (
            Diagnosis("unknown", (GAP,)),
            "UNKNOWN",
            ["none of the known causes explains", "The log itself is faulty"],
        ),
        (
            Diagnosis("unknown", (GAP,), obstacles=("Rows 5 s apart do not show it.",)),
            "UNKNOWN",
            ["No cause was tried. Rows 5 s apart do not show it.", "The log itself is faulty"],
        ),
        (
            Diagnosis(
                "ambiguous",
                indistinguishable=(Candidate("mass", None, 0.6), Candidate("drag", None, 0.4)),
            ),
            "AMBIGUOUS",
            ["cannot tell which: mass or drag"],
        ),
    ],
    ids=["consistent", "one", "two", "data", "both", "unknown", "not tried", "ambiguous"],
)
def test_verdict_is_one_sentence_on_model_and_log(diagnosis, word, said):
    found = outcome(diagnosis)
    assert found.word == word and all(text in found.sentence for text in said)


def test_a_difference_is_no_fault_where_the_log_lacks_what_could_explain_it():
    """Without a thruster's channels the force that is missing may be the thruster's."""
    difference = Discrepancy("side force: 3 kN are missing", None, "sway", 3e3, 500.0, "N", 1.0)
    lacking = ("No port_rpm in the log.",)
    said = outcome(Diagnosis("unknown", (), obstacles=lacking, discrepancies=(difference,)))
    assert "differ most in this: side force" in said.sentence and "wrong" not in said.sentence
    said = outcome(Diagnosis("unknown", (), discrepancies=(difference,)))
    assert "wrong, first of all: side force" in said.sentence


def test_next_steps_name_what_to_inspect_what_to_run_and_what_stays_open():
    steps = next_steps(
        Diagnosis("named", (GAP, LOSS), not_testable=("drag", "mass")), "out/extended.ssp"
    )
    text = "\n".join(steps)
    assert "Inspect the port thruster" in text and "shipcosim simulate out/extended.ssp" in text
    assert "Correct the logging" in text and "says nothing about drag or mass" in text


def test_ambiguous_log_asks_for_the_prescribed_manoeuvre():
    manoeuvre = ExperimentDesign("heading_turn", 8.0, (("wind_scale", "current"),))
    (step, *_) = next_steps(Diagnosis("ambiguous", prescription=manoeuvre))
    assert "heading turn, 8 minutes" in step and "wind scale from current" in step


def test_log_that_may_be_misread_asks_for_its_channel_file():
    finding = Finding(
        "frame", None, "data", 0.4, channels=("north",), note="one", alternatives=("two",)
    )
    diagnosis = Diagnosis("ambiguous", (finding,))
    assert "one; or two" in outcome(diagnosis).sentence
    (step,) = next_steps(diagnosis)
    assert "channel file" in step


def test_consistent_log_asks_for_nothing():
    assert next_steps(Diagnosis("consistent")) == ["Nothing needs to be done."]
    lacking = Diagnosis("unknown", not_testable=("drag",), obstacles=("No tunnel_rpm in the log.",))
    assert next_steps(lacking) == [
        "Confirm columns or log more, as the remarks ask, and diagnose again: without it no cause can be named."
    ]
    assert lacking.obstacles[0] in lacking.notes


def test_place_in_the_log_and_title():
    assert where(GAP) == "463–499 s, 912–1001 s" and where(LOSS) == "the whole log"
    assert title("rpm_offset", "tunnel") == "Rpm offset of tunnel"


def test_a_better_predictor_than_the_extended_model_is_named():
    gain = {"horizon_s": 60, "before_m": 3.0, "bias_observer_m": 0.78, "after_m": 1.5}
    said = outcome(Diagnosis("named", (LOSS,), gain=gain)).sentence
    assert (
        "with a bias observer predicts better than with the cause in it: 0.78 m against 1.5 m"
        in said
    )
    assert (
        "predicts better"
        not in outcome(Diagnosis("named", (LOSS,), gain=gain | {"after_m": 0.5})).sentence
    )


def test_another_form_is_an_answer_with_what_it_explains_and_hides():
    form = LoadForm(1.0, {"drag across the hull": 0.3, "wind load": 0.1}, hides=("crossflow",))
    form = replace(form, horizon_s=60.0, before_m=3.1, after_m=1.2)
    said = outcome(Diagnosis("form", form=form))
    assert said.word == "FORM" and said.kind == "form"
    for text in (
        "drag across the hull, by 30 %",
        "3.1 m off the log, with that form 1.2 m",
        "crossflow",
    ):
        assert text in said.sentence


def test_an_unknown_cause_is_told_with_the_known_ones_that_explain_most():
    likely = (Candidate("thrust_loss", "port", 0.49), Candidate("drag", None, 0.01))
    said = outcome(Diagnosis("unknown", candidates=likely)).sentence
    assert "Of the known ones thrust loss of port explains most." in said
    assert "drag" not in said
