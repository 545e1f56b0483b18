"""Of logs of the independent truth, in which a thruster's channel or the wind is held, how many name that gap.

`pytest tests/bench/diagnose/log_faults/test_held_inputs.py -s` prints the table of docs/reports/measured-data.md.
"""

import numpy as np
import pytest
from diagnose.log_faults.test_held_inputs import gaps

from shipcosim.diagnose.log.reader import read_log
from truth import draw

HELD = (
    ("port_rpm", True),
    ("tunnel_rpm", True),
    ("starboard_rpm", False),
    ("tunnel_rpm", False),
    ("wind_speed", True),
)
"""Channels, and whether they are held at 0 or at their last value, in 30 to 45 % of the log."""
STILL = {"port": 1.2, "starboard": 1.2, "tunnel": 12.0}
"""Speeds below which a thruster stands still: four times the noise of its channel. [rpm]"""
POWER_LOSS = {"legs": [[300, 30, 0, 0.5], [300, 0, 10, 0.5]], "free": [[200, 350]]}
STOPS = {
    "legs": [[300, 5, 0, 0.3], [300, 0, 3, 0.3]],
    "pushes": [["tunnel", 60, 200, 0.0, 0, 0], ["port", 300, 480, 0.0, 0, 0]],
}


def table(log, folder):
    """A log of the truth as `read_log` gives it."""
    log.to_csv(folder / "log.csv", index=False)
    return read_log(folder / "log.csv")


def held(log, role, is_zero):
    """A log with a channel held."""
    values = log[role].values
    row = np.arange(values.size) / values.size
    here = (row >= 0.3) & (row < 0.45)
    value = 0.0 if is_zero else values[here][0]
    return log.assign({role: log[role].copy(data=np.where(here, value, values))})


def stopped(log):
    """A log in which thrusters that stand still for 20 rows and more have no noise."""
    for name, least in STILL.items():
        values = log[f"{name}_rpm"].values.copy()
        ends = np.flatnonzero(np.diff(np.r_[0, np.abs(values) < least, 0])).reshape(-1, 2)
        for first, last in ends[np.diff(ends)[:, 0] >= 20]:
            values[first:last] = 0.0
        log = log.assign({f"{name}_rpm": log[f"{name}_rpm"].copy(data=values)})
    return log


@pytest.mark.parametrize("form", [0.0, 1.0])
@pytest.mark.parametrize("kind", ["trial", "work", "hold"])
def test_held_inputs_are_named(kind, form, tmp_path):
    right = 0
    for seed, (role, is_zero) in enumerate(HELD, 99000):
        log = table(draw(kind, seed, causes=0, minutes=20, form=form).log, tmp_path)
        found = gaps(held(log, role, is_zero))
        print(f"\n{kind}, form {form:g}: {role} {'at 0' if is_zero else 'stuck'}: {found}")
        assert {channels for channels, *_ in found} <= {(role,)}
        right += bool(found)
    assert right >= 3


@pytest.mark.parametrize("after", [POWER_LOSS, STOPS], ids=["power loss", "stops"])
@pytest.mark.parametrize("causes", [0, 1])
@pytest.mark.parametrize("kind", ["trial", "work", "hold"])
def test_thrusters_that_stand_still_are_no_gap(kind, causes, after, tmp_path):
    for seed in (99100, 99101):
        case = draw(kind, seed, causes=causes, minutes=10, after=after, among=["current", "mass"])
        assert gaps(stopped(table(case.log, tmp_path))) == []
