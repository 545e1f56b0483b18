"""A clean run that is rounded and thinned gives no finding but the hole that was put in; lost rows of it still show."""

from itertools import product

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.checks.samples import NO_ROWS, gaps
from shipcosim.diagnose.log.mislabels import KNOT

METRES = 111195.0  # of a degree of latitude
FINE = 20  # rows a second of the run before it is logged at 1 Hz
WAYS = list(product((4, 5, 6), (0.01, 0.1, 1.0), (0.1, 1.0), (1, 5, 10), (False, True)))
"""Decimals of a degree, knots, degrees, every so many rows, and whether there is a hole."""


def calm_ship(seed):
    """A ship without noise that goes from place to place, and waits there; 20 minutes."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 1200.0, 1.0 / FINE)
    north, east, heading = (
        sum(
            size * rng.normal() * 0.5 * (1.0 + np.tanh((time - at) / lasts))
            for at, lasts in zip(rng.uniform(30, 1170, 6), rng.uniform(10, 80, 6), strict=True)
        )
        for size in (40.0, 40.0, 60.0)
    )
    way = np.gradient(north + 1j * east, 1.0 / FINE) * np.exp(-1j * np.radians(heading))
    log = {"time": time, "north": north, "east": east, "heading": np.mod(heading, 360.0)}
    log |= {"surge": way.real, "sway": way.imag, "yaw_rate": np.gradient(heading, 1.0 / FINE)}
    return {role: values[::FINE] for role, values in log.items()}


def rounded(log, decimals, knots, degrees, every, has_hole):
    steps = dict.fromkeys(("north", "east"), METRES * 10.0**-decimals)
    steps |= dict.fromkeys(("surge", "sway"), knots * KNOT)
    steps |= {"heading": degrees, "yaw_rate": degrees / 10.0}
    coarse = {
        role: np.round(values / steps[role]) * steps[role] if role in steps else values
        for role, values in log.items()
    }
    keep = np.ones(len(log["time"]), bool)
    keep[400:460] = not has_hole
    return {role: values[keep][::every] for role, values in coarse.items()}


@pytest.mark.parametrize("seed", [1, 6, 12])
def test_no_way_to_round_and_thin_a_run_makes_held_or_interpolated_values(seed):
    """By the rule before, 19 to 39 of the 108 ways of each run did."""
    log = calm_ship(seed)
    found = {way: [f.note for f in gaps(rounded(log, *way))] for way in WAYS}
    assert {way: notes for way, notes in found.items() if set(notes) - {NO_ROWS}} == {}


@pytest.mark.parametrize("way", WAYS[::22])
def test_a_rounded_run_has_no_wrong_label(way):
    check_labels(way)  # as many other ways at night


def check_labels(way):
    for log in (calm_ship(1), measured(seed=2)):
        found = [finding.note for finding in examine(table(rounded(log, *way)))]
        assert set(found) <= {NO_ROWS}


def test_lost_rows_of_a_rounded_log_show_where_its_noise_does():
    log = measured(seed=4)
    for role in set(log) - {"time"}:
        log[role][500:541] = log[role][499]
    (finding,) = examine(table(rounded(log, 6, 0.01, 0.1, 1, False)))
    assert finding.cause == "gap" and finding.segments[0] == pytest.approx((500.0, 540.0), abs=2.0)
