"""A label that is wrong in a part of a short log is named with that part, whichever it is."""

import numpy as np
import pytest
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.mislabels import KNOT

VELOCITY = ("surge", "sway")
PLANTED = {
    "heading has the other sign": lambda log: {"heading": np.mod(-log["heading"], 360.0)},
    "heading is counted counter-clockwise from east": lambda log: {
        "heading": np.mod(90.0 - log["heading"], 360.0)
    },
    "surge and sway are in km/h, not m/s": lambda log: {r: 3.6 * log[r] for r in VELOCITY},
    "surge and sway are in kn, not m/s": lambda log: {r: log[r] / KNOT for r in VELOCITY},
    "north has the other sign": lambda log: {"north": -log["north"]},
    "yaw_rate is in rad/s, not deg/s": lambda log: {"yaw_rate": np.radians(log["yaw_rate"])},
}


def agile(minutes):
    """A boat at 10 Hz: ten times as fast as the ship of the other tests, in a tenth of the time."""
    log = measured(minutes=10 * minutes, seed=21)
    log["time"] = log["time"] / 10.0
    return log | {role: 10.0 * log[role] for role in (*VELOCITY, "yaw_rate")}


IN_CI = [note for note in PLANTED if "heading has" in note or "km/h" in note or "rad/s" in note]


@pytest.mark.parametrize("note", IN_CI)
def test_a_wrong_label_in_a_part_of_a_minute_and_a_half_is_named_with_it(note):
    """Parts below 60 s, and headings and km/h in parts, were never named. The others at night."""
    check_part(note)


def check_part(note):
    log = agile(minutes=1.5)
    begins, ends = (0.0, 36.0) if "has" in note else (20.0, 85.0)
    here = (log["time"] >= begins) & (log["time"] <= ends)
    changed = {role: np.where(here, new, log[role]) for role, new in PLANTED[note](log).items()}
    (finding,) = examine(table(log | changed))
    assert finding.note == note
    assert finding.segments[0] == pytest.approx((begins, ends), abs=1.5)


def test_a_boat_whose_labels_are_right_gets_no_finding():
    assert examine(table(agile(minutes=1.5))) == []


def test_what_a_part_of_a_few_seconds_would_show_is_not_named():
    """Its ends are a choice among all rows, and a part below 10 s could be anything."""
    log = agile(minutes=1.5)
    here = (log["time"] >= 40.0) & (log["time"] <= 46.0)
    assert examine(table(log | {"sway": np.where(here, -1.0, 1.0) * log["sway"]})) == []
