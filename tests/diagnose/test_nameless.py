"""What no cause explains is found as an error without a name; healthy logs and named causes leave none."""

import numpy as np
import pytest
from diagnose import twin
from diagnose.twin import case, fits

from shipcosim.diagnose import nameless
from shipcosim.diagnose.nameless import unexplained
from shipcosim.diagnose.verdict import STRANGE


def beside_the_best(log):
    here, found = twin.explained(log)
    return unexplained(here, found[0])


@pytest.mark.parametrize("name", ["healthy", "mass", "tow", "two", "heading_bias"])
def test_beside_the_right_cause_nothing_is_left(name):
    assert max(unexplained(case(name), fits(name)[0]).values()) < 0.0 < STRANGE


@pytest.mark.parametrize("seed", [1, 2])
def test_healthy_logs_stay_below_the_threshold(seed):
    log = twin.sailed({"healthy": {}}, seed=seed)["healthy"]
    assert max(beside_the_best(log).values()) < STRANGE


def test_a_force_that_swings_is_found_as_periodic():
    log = twin.sailed({"": {}}, push=lambda t: (0.0, 3000.0 * np.sin(2.0 * np.pi * t / 70.0), 0.0))[""]
    found = beside_the_best(log)
    assert max(found, key=found.get) == "periodic" and found["periodic"] > 2.0 * STRANGE


def test_a_force_that_comes_and_goes_slowly_is_found_as_slow():
    log = twin.sailed({"": {}}, push=lambda t: (0.0, 0.0, 120e3 * np.exp(-(((t - 200.0) / 60.0) ** 2))))[""]
    found = beside_the_best(log)
    assert found["slow"] > STRANGE


def test_a_scale_of_the_yaw_rate_is_found_in_its_channel():
    log = twin.logs()["healthy"]
    found = beside_the_best(log.assign(yaw_rate=1.15 * log["yaw_rate"]))
    assert max(found, key=found.get) == "in a channel" and found["in a channel"] > 10.0 * STRANGE


def test_the_search_over_periods_is_paid_for(monkeypatch):
    """The same sinusoid sought four times scores ln 4 less than once."""
    once = nameless._bases(case("healthy"), fits("healthy")[0])["periodic"][:1]
    scores = []
    for times in (1, 4):
        monkeypatch.setattr(nameless, "_bases", lambda *_, times=times: {"periodic": times * once})
        scores.append(unexplained(case("healthy"), fits("healthy")[0])["periodic"])
    assert scores[0] - scores[1] == pytest.approx(np.log(4.0))
