"""A small part of the bench: on drawn craft, ordinary mistakes are named about as often as its table says.

The craft are always the same, or those of the week where SHIPCOSIM_FRESH_SEEDS is set (`make nightly`).
"""

import os

import pytest

from mistakes.runs import answers, log_of
from mistakes.scoring import answered
from trial.chance import most
from truth import bench_seed

WRONG, MISSED = 0.01, 0.15  # share of answers, see the README
BOATS = 3 if os.environ.get("SHIPCOSIM_FRESH_SEEDS") else 1


@pytest.fixture(scope="module")
def drawn():
    first = bench_seed()
    return list(answers(["boat"], range(first, first + BOATS), draws=6))


def test_hardly_anything_wrong_is_named(drawn):
    assert sum(answer.outcome == "wrong" for answer in drawn) <= most([WRONG] * len(drawn))


def test_most_mistakes_are_named_or_left_open_between_readings(drawn):
    mistaken = [answer for answer in drawn if answer.mistakes]
    assert sum(answer.outcome in ("silent", "part") for answer in mistaken) <= most(
        [MISSED] * len(mistaken)
    )


def test_right_logs_of_agile_craft_are_read_and_give_no_finding(drawn):
    right = [answer for answer in drawn if not answer.mistakes]
    assert len(right) == BOATS
    assert not [
        answer
        for answer in right
        if answer.said or any("Say the unit" in text for text in answer.open)
    ]


def test_a_refusal_that_asks_for_the_right_unit_counts_as_left_open():
    answer = answered(log_of("boat", 202651), "boat", 202651, ("time in ms",), declared=False)
    assert answer.outcome == "among" and answer.open == ("time is in ms",)


def test_a_mistake_that_the_question_does_not_ask_for_counts_by_itself():
    names = ("time in ms", "surge and sway swapped")
    answer = answered(log_of("boat", 202651), "boat", 202651, names, declared=False)
    assert answer.outcome == "among" and answer.mistakes == names
    assert "time is in ms" in answer.open and [
        "surge,sway" in finding for finding, *_ in answer.said
    ] == [True]


def test_a_refusal_that_asks_for_a_unit_of_a_right_log_counts_as_beside():
    log = log_of("boat", 202651)
    answer = answered(log | {"time": 1000.0 * log["time"]}, "boat", 202651, (), declared=False)
    assert answer.outcome == "beside" and "Say the unit" in answer.open[0]
