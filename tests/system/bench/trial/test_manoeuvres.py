"""What is prescribed is sailed by the same ship, once, and what is told to her is what the library says."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from trial import manoeuvres, runs
from truth.orders import Orders, leg_speeds

AMBIGUOUS = {
    "verdict": "ambiguous",
    "findings": [],
    "prescription": {"manoeuvre": "turn by 90 deg and hold"},
}
LENGTHS = []


def result(seed=7, name="one", diagnosis=AMBIGUOUS):
    options = {"minutes": 10, "among": ["tow"]}
    return {"kind": "hold", "set": name, "seed": seed, "options": options, "diagnosis": diagnosis}


def measured(path):
    """A tool that only looks how long the log is."""
    LENGTHS.append(len(Path(path).read_text().splitlines()))
    return SimpleNamespace(as_json=lambda: {"verdict": "consistent", "findings": []})


def test_orders_last_as_long_as_the_manoeuvre_of_the_library_and_turn_as_far():
    told = {name: Orders(**after) for name, after in manoeuvres.orders().items()}
    assert len(told) >= 9
    for name, one in told.items():
        assert 60.0 < one.seconds <= 900.0, name
        assert leg_speeds(one.legs).max() < 1.1
        assert all(end <= one.seconds for _, _, end, *_ in one.pushes)
    assert told["turn by 90 deg and hold"].legs[-1][3] == pytest.approx(np.pi / 2)
    assert {push[0] for push in told["pulses of one thruster after the other"].pushes} == {
        "port",
        "starboard",
        "tunnel",
    }
    assert all(push[3] < 0.0 for push in told["reversal of each azimuth thruster"].pushes)
    assert told["free drift with idle thrusters"].free


def test_only_what_was_prescribed_and_not_yet_sailed_is_sailed():
    nothing = AMBIGUOUS | {"prescription": None}
    named = {"verdict": "named", "findings": [], "prescription": None}
    found = [
        result(1),
        result(2, diagnosis=nothing),
        result(3, diagnosis=named),
        result(4, diagnosis=None),
    ]
    found += [result(5), result(5, manoeuvres.AFTER.format("one")), result(6, "two")]
    assert [r["seed"] for r in manoeuvres.unsailed(found, ["hold"], ["one"])] == [1]
    assert [r["seed"] for r in manoeuvres.unsailed(found, ["hold", "work"], ["one", "two"])] == [
        1,
        6,
    ]
    assert manoeuvres.unsailed(found, ["work"], ["one"]) == []


def test_a_manoeuvre_is_sailed_once_and_its_log_is_longer(tmp_path):
    into, tool = tmp_path / "results.jsonl", f"{__name__}:measured"
    runs.add(result(), into)
    LENGTHS.clear()
    for _ in range(2):
        manoeuvres.sail(["hold"], ["one"], into, tool=tool, progress=lambda *_: None)
    _, sailed = runs.read_results(into)
    assert (sailed["set"], sailed["seed"], sailed["error"]) == ("one sailed", 7, None)
    assert sailed["answer"][0]["cause"] == "tow"
    assert (
        LENGTHS == [pytest.approx(sailed["span"][1], abs=10)] and sailed["span"][1] > 600.0 + 240.0
    )
