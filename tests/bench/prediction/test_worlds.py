"""At night: all predictors in worlds to choose by."""

from prediction import measuring, pages
from prediction.rivals import PREDICTORS, there
from shipcosim.learn.prediction.worlds import HELD_OUT

WORLDS = range(300, 308)


def test_all_predictors_in_worlds_to_choose_by(capsys):
    """Printed for the reader; held are a few things of which the page could not be true otherwise."""
    assert not set(WORLDS) & set(HELD_OUT)
    found = {
        name: {1.0: [measuring.measured(name, seed, 1.0) for seed in WORLDS]} for name in there()
    }
    with capsys.disabled():
        print(pages.page(found, WORLDS, "make nightly"))
    position = {name: pages.by_world(found[name][1.0], 20)[:, -1, 3].mean() for name in found}
    assert position["kinetic"] < position["constant velocity"]
    assert set(PREDICTORS) >= set(position)
