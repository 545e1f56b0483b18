"""The bench itself: its loop is the co-simulation, its rivals do what they say."""

import numpy as np
import pytest

from dead_reckoning import measuring, pages, rivals
from dead_reckoning.loop import Loop
from shipcosim.learn.dead_reckoning import worlds
from shipcosim.models.prediction.outage import Measured

CALM = Measured(0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, (0.0,) * 6)


def test_the_loop_is_the_co_simulation():
    """In two worlds, GNSS lost for a while, the kinetic filter in the loop."""
    given, losses = [worlds.drawn(300), worlds.drawn(301)], ((12.0, 20.0),)
    wanted = worlds.recorded(given, 24.0, lambda done, total: None, losses)
    found = Loop(given, {"kinetic": measuring.laws()["kinetic"]}, "kinetic").run(0, 24, losses)
    for name in worlds.MEASURED:
        np.testing.assert_allclose(
            found.measured[name], wanted.measured[name], rtol=1e-6, atol=1e-6, err_msg=name
        )
    for name in ("x_hat", "y_hat", "lost_for"):
        np.testing.assert_allclose(
            found.reckoned[name], wanted.reckoned[name], rtol=1e-6, atol=1e-6, err_msg=name
        )
    np.testing.assert_allclose(found.x, wanted.x, rtol=1e-6, atol=1e-6)
    assert wanted.reckoned["lost_for"].max() >= 6.0


def test_constant_velocity_goes_on_as_she_went():
    law = rivals.ConstantVelocity()
    state = law.start(CALM)
    for second in range(1, 41):
        fix = CALM._replace(x=0.2 * second, u=0.2, valid=1.0 * (second <= 20))
        state = law.step(state, fix, 1.0)
    assert state.x == pytest.approx(0.2 * 40) and state.lost_for == 20.0


def test_the_kalman_filter_finds_a_ship_that_stays_and_keeps_her():
    law, there = rivals.Kalman(), CALM._replace(x=5.0, y=-3.0, psi=0.6)
    state = law.start(there)
    for _ in range(2000):
        state = law.step(state, there, 1.0)
    for _ in range(60):
        state = law.step(state, there._replace(valid=0.0), 1.0)
    assert (float(state.x), float(state.y)) == pytest.approx((5.0, -3.0), abs=0.05)


def test_the_kalman_filter_knows_the_load_that_it_was_told():
    """A bow tunnel pushes while GNSS is lost: she goes to starboard, at the speed of the printed damping in the end."""
    law = rivals.Kalman()
    state, lost = law.start(CALM), CALM._replace(valid=0.0, commands=(0.0,) * 4 + (5.0, 5.0))
    for _ in range(400):
        state = law.step(state, lost, 1.0)
    assert float(state.u) == pytest.approx(2.0 * 5.0 * law.slopes[4] / 3e5, rel=1e-3)


def test_the_page_has_a_row_for_every_law():
    n = len(pages.NAMES)
    one = {name: [1.0, 2.0, 3.0, 4.0] for name in measuring.laws()}
    found = {
        "seeds": [1, 2, 3, 4],
        "sea_state": [0, 1, 2, 3],
        "rides": one,
        "held": one,
        "biased": {},
    }
    found["regions"] = {"motion-filter": {"10": [0.9, 1.0], "all": [0.9, 1.5]}}
    text = pages.page(found)
    assert (
        set(measuring.laws()) == set(pages.NAMES) and text.count("| 1.00 (1.00 to 1.00) |") == 2 * n
    )
