"""Wrong labels planted in logs of real craft are named, in all rows, in every fifth and in a part; right ones never.

The log of a spin here in all rows, that of a straight way in every fifth with some labels; `tests/bench` has all.
"""

from pathlib import Path

import numpy as np
import pandas
import pytest
from measured.logs import CHANNELS, FOLDERS, as_table

from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log

MEASURED = Path(__file__).resolve().parents[4] / "shared" / "measured"
KNOT = 1852.0 / 3600.0
LABELS = ("sign", "channel_swap", "frame", "clock")
# A spin, positions that leap, and a straight way.
LOGS = [
    ("blueboat", "run_216.csv.gz"),
    ("blueboat", "run_223.csv.gz"),
    ("otter", "2024-04-23_12-22-102.csv.gz"),
]


def _earth(log):
    way = (log["surge"] + 1j * log["sway"]) * np.exp(1j * np.radians(log["heading"]))
    return {"surge": way.real, "sway": way.imag}


def _negative(role):
    return lambda log: {role: -log[role]}


PLANTED = {
    ("sign", "surge"): _negative("surge"),
    ("sign", "sway"): _negative("sway"),
    ("sign", "yaw_rate"): _negative("yaw_rate"),
    ("sign", "east"): _negative("east"),
    ("sign", "heading"): lambda log: {"heading": np.mod(-log["heading"], 360.0)},
    ("channel_swap", "east", "north"): lambda log: {"north": log["east"], "east": log["north"]},
    ("channel_swap", "surge", "sway"): lambda log: {"surge": log["sway"], "sway": log["surge"]},
    ("frame", "surge", "sway"): lambda log: {role: log[role] / KNOT for role in ("surge", "sway")},
    ("frame", "sway", "surge"): _earth,
    ("frame", "heading"): lambda log: {"heading": np.mod(90.0 - log["heading"], 360.0)},
}


SOME = [
    ("sign", "surge"),
    ("channel_swap", "east", "north"),
    ("frame", "surge", "sway"),
    ("frame", "heading"),
]


@pytest.mark.parametrize(
    ("craft", "name", "stride", "labels"), [(*LOGS[0], 1, list(PLANTED)), (*LOGS[2], 5, SOME)]
)
def test_planted_labels_are_named_and_nothing_else(craft, name, stride, labels, tmp_path):
    check_planted(craft, name, stride, tmp_path, labels)


def check_planted(craft, name, stride, folder, labels=tuple(PLANTED)):
    path = MEASURED / FOLDERS[craft] / name
    if not path.is_file():
        pytest.skip("needs the logs in ../shared/measured, which are not here")
    thinned = folder / "log.csv"
    pandas.read_csv(as_table(path, folder)).iloc[::stride].to_csv(thinned, index=False)
    log = read_log(thinned, channels=CHANNELS / f"{craft}.toml")
    assert not _labels(log)
    found = {}
    for planted in labels:
        wrong = log.copy(deep=True)
        for role, values in PLANTED[planted](
            {str(n): v.values for n, v in log.data_vars.items()}
        ).items():
            wrong[role] = (log[role].dims, values, log[role].attrs)
        found[planted] = _labels(wrong)
    others = {key: one for key, one in found.items() if one - {(key[0], frozenset(key[1:]), False)}}
    assert not others
    # One may be silent: little sway, or a boat that hardly turns.
    assert sum(bool(one) for one in found.values()) >= len(found) - 1


@pytest.mark.parametrize(
    "planted", [("sign", "sway"), ("channel_swap", "east", "north"), ("frame", "sway", "surge")]
)
def test_a_label_planted_in_a_part_is_named_with_it(planted):
    """The middle 40 s of a log of a minute and a half: parts below 60 s were silent."""
    path = MEASURED / FOLDERS["blueboat"] / "run_223.csv.gz"
    if not path.is_file():
        pytest.skip("needs the logs in ../shared/measured, which are not here")
    log = read_log(path, channels=CHANNELS / "blueboat.toml")
    arrays = {str(n): v.values.copy() for n, v in log.data_vars.items()}
    for role, values in PLANTED[planted](arrays).items():
        log[role].values[300:700] = values[300:700]
    (finding,) = (f for f in examine(log) if f.cause in LABELS)
    assert (finding.cause, set(finding.channels)) == (planted[0], set(planted[1:]))
    begun = log["time"].values[[300, 699]]
    assert finding.segments[0] == pytest.approx(tuple(begun), abs=5.0)


def _labels(log):
    """Findings on labels: cause, channels, and whether in a part of the log only."""
    return {
        (one.cause, frozenset(one.channels), bool(one.segments))
        for one in examine(log)
        if one.cause in LABELS
    }
