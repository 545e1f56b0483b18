"""The oracle of the bench is an oracle: only the future is unknown to it."""

import numpy as np
import pytest

from prediction import measuring, oracle

SEED = 300  # of the worlds to choose by
STARTS = (1, 5, 20)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("oracle")


def test_oracle_with_the_future_known_misses_nothing(folder):
    """A wrong ship, memory or thrust would miss by decimetres here: 0.1 m and 0.2 deg are the integration's."""
    sea = oracle.sailed(SEED, folder)
    missed = np.abs(oracle.errors(SEED, sea, future=True, starts=STARTS))
    assert missed[..., :2].max() < 0.1
    assert np.degrees(missed[..., 2]).max() < 0.2


def test_oracle_misses_less_than_any_rival_and_knows_no_future(folder):
    sea = oracle.sailed(SEED, folder)
    missed = _places(oracle.errors(SEED, sea, starts=STARTS))
    # What comes after the start changes nothing: 60 s ahead of the last start all is other weather.
    lost = int(np.flatnonzero(sea["time"] == sea["lost_at"])[0])
    changed = {name: value.copy() for name, value in sea.items()}
    for name in oracle.SURROUNDINGS:
        if "thrusters" not in name:
            changed[name][lost + max(STARTS) + 1 :] += 1.0
    assert _places(oracle.errors(SEED, changed, starts=STARTS)) == missed
    for name in ("kinetic", "kinetic of the thesis", "ours"):
        record = measuring.recorded(SEED, 1.0, folder)
        assert missed < _places(measuring.measure(name, record, STARTS)["errors"])


def _places(errors):
    """Mean distance off, 60 s ahead. [m]"""
    return np.hypot(errors[:, -1, 0], errors[:, -1, 1]).mean()
