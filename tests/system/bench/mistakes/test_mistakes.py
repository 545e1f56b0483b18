"""A small part of the bench: on craft of the week, ordinary mistakes are named about as often as its table says."""

import pytest

from mistakes.runs import answers
from trial.chance import most
from truth import weekly_seed

WRONG, MISSED = 0.01, 0.15  # share of answers, see the README
BOATS = 3


@pytest.fixture(scope="module")
def week():
    first = weekly_seed()
    return list(answers(["boat"], range(first, first + BOATS), draws=6))


def test_hardly_anything_wrong_is_named(week):
    assert sum(answer.outcome == "wrong" for answer in week) <= most([WRONG] * len(week))


def test_most_mistakes_are_named_or_left_open_between_readings(week):
    drawn = [answer for answer in week if answer.mistakes]
    assert sum(answer.outcome in ("silent", "part") for answer in drawn) <= most([MISSED] * len(drawn))


def test_right_logs_of_agile_craft_give_no_finding(week):
    assert [answer.said for answer in week if not answer.mistakes] == [()] * BOATS
