"""At night: drawn logs: a DP that holds the ship in anything, and the time that drawing takes."""

import time

import pytest

from truth.cases import KINDS, draw, draw_many, share_held


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "options", [{}, {"rough": True}, {"mismatch": 2.0}, {"causes": 1}, {"causes": 2}], ids=str
)
def test_the_dp_holds_the_ship_in_40_minutes_of_anything(kind, options):
    assert share_held(draw_many(kind, range(600, 664), **{"causes": 0} | options)) >= 0.95


def test_two_hundred_logs_in_ten_minutes_and_one_in_five_seconds():
    start = time.perf_counter()
    draw("work", 1)
    one = time.perf_counter() - start
    draw_many("work", range(200))
    many = time.perf_counter() - start - one
    print(f"\none log and its twin: {one:.1f} s; 200: {many:.0f} s")
    assert one < 5.0 and many < 600.0
