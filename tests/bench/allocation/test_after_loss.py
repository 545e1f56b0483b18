"""What the operator may choose after a loss, over 12 directions of wind: position, heading, both, a new one.

`python -m tests.bench.allocation.test_after_loss [choice ...]` prints the table of docs/reports/allocation.md, on seeds 7
and 8 of the wind. The choices were made on seed 1.
"""

import sys

import numpy as np
import pytest

from tests.bench.allocation.test_consequences import FAILS, LOSSES, outcomes

WIND = 10.0  # m/s
DIRECTIONS = range(0, 360, 30)  # deg
SEEDS = (7, 8)
REACTION = 30.0  # s from the loss until the operator moves the heading set point (assumed)
ALWAYS = {"allocator.sectors_always": 1.0}
POSITION = {"allocator.dynamic_factor": 100.0}  # no load counts as held
HEADING = {"allocator.yaw_lever_degraded": 14.0}


def into_the_weather(at: float, loss: str) -> list[dict]:
    """The event that moves the set point: bow into the weather where the tunnel runs, else stern."""
    stern = 0.0 if loss in ("port", "starboard") else 180.0
    heading = float(np.radians(at + stern))
    return [{"time": FAILS + REACTION, "override": {"reference.psi_set": heading}}]


CHOICES = {
    "fixed angles": ("allocator", {}, None),
    "extended": ("extended_allocator", {}, None),
    "extended, new heading": ("extended_allocator", {}, into_the_weather),
    "optimal, as shipped": ("optimal_allocator", {}, None),
    "optimal, sectors always": ("optimal_allocator", ALWAYS, None),
    "optimal, position first": ("optimal_allocator", POSITION, None),
    "optimal, heading first": ("optimal_allocator", HEADING, None),
    "optimal, new heading": ("optimal_allocator", {}, into_the_weather),
}
"""Choice: the allocator, its parameters, and the events after the loss."""


def rows_of(choice: str, seeds=SEEDS) -> list[dict]:
    """Outcomes of a choice, of all seeds."""
    allocator, values, more = CHOICES[choice]
    found = []
    for seed in seeds:
        found += outcomes(WIND, DIRECTIONS, allocator, values, seed, more)
    return found


def line(choice: str, loss: str, rows: list[dict]) -> str:
    """Row of the table: cases beyond 5 m, then the largest of all cases, and the largest mean power."""
    rows = [row for row in rows if row["loss"] == loss]
    beyond = sum(row["most_off"] > 5.0 for row in rows)
    most = [max(row[name] for row in rows) for name in ("most_off", "late_off", "late_astray")]
    power = max(row["late_power"] for row in rows) / 1e3
    return (
        f"| {choice} | {loss} | {beyond} of {len(rows)} | {most[0]:.1f} m | {most[1]:.1f} m"
        f" | {most[2]:.0f} deg | {power:.0f} kW |"
    )


@pytest.mark.parametrize(
    "choice", ["optimal, as shipped", "optimal, position first", "optimal, new heading"]
)
def test_position_is_kept_after_every_loss(choice):
    assert max(row["most_off"] for row in rows_of(choice, SEEDS[:1])) < 5.0


def test_a_heading_that_the_balance_holds_is_kept_as_shipped():
    """No heading is lost that was not foretold; the aim of false warnings is below one in twenty."""
    rows = rows_of("optimal, as shipped")
    lost = [row["late_turned"] > 10.0 for row in rows]
    warned = [row["share"] < 1.25 for row in rows]
    pairs = list(zip(lost, warned, strict=True))
    assert sum(lost) >= 30
    assert pairs.count((True, False)) == 0
    assert pairs.count((False, True)) <= 3


def test_a_new_heading_is_held_at_little_power():
    rows = rows_of("optimal, new heading", SEEDS[:1])
    assert max(row["late_astray"] for row in rows) < 20.0
    assert max(row["late_power"] for row in rows) < 30e3


def test_heading_first_holds_both_where_the_tunnel_runs():
    rows = rows_of("optimal, heading first", SEEDS[:1])
    rows = [row for row in rows if row["loss"] in ("port", "starboard")]
    assert max(row["most_off"] for row in rows) < 5.0
    lost = 10.0  # deg, as in test_consequences
    assert max(row["late_astray"] for row in rows) < lost


if __name__ == "__main__":
    for name in sys.argv[1:] or CHOICES:
        found = rows_of(name)
        for lost in LOSSES:
            print(line(name, lost, found), flush=True)
