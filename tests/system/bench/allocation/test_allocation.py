"""The comparison of allocators: measures count what was planted, every law runs, the table says what is missed."""

import numpy as np
import pytest

from allocation import drawn, loops, measures, optimum, table
from allocation.laws import LAWS, RIVALS

STILL = np.zeros((1, 3))


def commanded(thrusts, azimuths, tau=None, available=None):
    """Commands of one seed, 0.1 s apart."""
    thrusts, azimuths = np.array(thrusts, float)[:, None], np.array(azimuths, float)[:, None]
    asked = np.zeros_like(thrusts) if tau is None else np.array(tau, float)[:, None]
    usable = np.ones(thrusts.shape, bool) if available is None else np.array(available)[:, None]
    return loops.Commanded(0.1, asked, thrusts, azimuths, np.zeros(thrusts.shape[:2]), usable)


PLANTED = {
    "nothing": ([[0, 0, 0], [100, -100, 100]], [[0, 0], [0.017, -0.017]], {}),
    "thrust beyond its limit": ([[60001, 0, 0]], [[0, 0]], {"force": 1}),
    "thrust astern beyond its limit": ([[0, -30001, 0]], [[0, 0]], {"force": 1}),
    "tunnel beyond its limit": ([[0, 0, 21700]], [[0, 0]], {"force": 1}),
    "quick thrust": ([[0, 0, 0], [0, 0, 101]], [[0, 0], [0, 0]], {"rate": 1}),
    "quick angle": ([[0, 0, 0], [0, 0, 0]], [[0, 0], [0.018, 0]], {"rate": 1}),
    "angle over the half turn": ([[0, 0, 0], [0, 0, 0]], [[np.pi, 0], [0.017 - np.pi, 0]], {}),
    "pushing in the sector": ([[50, 50, 0]], [[1.6, 0]], {"sector": 1}),
    "pushing in the other sector": ([[9, -50, 0]], [[0, -1.5]], {"sector": 1}),
    "pushing there alone": ([[50, 0, 0]], [[1.6, 0]], {}),
    "turning through the sector": ([[0, 50, 0]], [[1.6, 0]], {}),
    "no number": ([[0, np.nan, 0]], [[0, 0]], {"force": 1}),
    "no angle": ([[0, 0, 0]], [[0, np.nan]], {"angle": 1}),
}


@pytest.mark.parametrize("name", PLANTED)
def test_violation_that_was_planted_is_counted_once_and_as_what_it_is(name):
    thrusts, azimuths, expected = PLANTED[name]
    found = {
        kind: int(count[0])
        for kind, count in measures.violations(commanded(thrusts, azimuths)).items()
    }
    assert found == dict.fromkeys(("force", "angle", "rate", "sector"), 0) | expected


def test_unit_that_drops_out_breaks_no_rate():
    usable = [[True] * 3, [True, True, False]]
    found = measures.violations(
        commanded([[0, 0, 500], [0, 0, 0]], [[0, 0], [0, 0]], available=usable)
    )
    assert found["rate"].tolist() == [0]


def test_power_is_full_at_every_limit():
    assert measures.power(np.array([60e3, -30e3, -21.6e3])) == pytest.approx(2 * 194e3 + 200e3)
    assert measures.power(np.array([15e3, 0.0, 0.0])) == pytest.approx(194e3 / 8)


def test_load_is_that_of_the_full_configuration_matrix():
    X, Y, N = loops.loads(np.array([1e3, 2e3, 3e3]), np.array([np.pi / 2, 0.0]))
    assert (X, Y) == pytest.approx((2e3, 4e3)) and pytest.approx(
        -14.02e3 - 2.0 * 2e3 + 14.48 * 3e3
    ) == N


def test_reversal_is_counted_from_beyond_the_dead_band_to_beyond_it():
    thrust = np.array([500, 100, -100, 100, 500, -500, -100, 300, 0, 400], float)[:, None]
    assert measures.reversals(thrust).tolist() == [2]


def test_optimum_of_a_pull_ahead_is_shared_by_both_azimuths():
    found = optimum.best(np.array([[20e3, 0.0, 0.0]]))
    assert found.thrusts[0] == pytest.approx([10e3, 10e3, 0.0], abs=5.0) and optimum.met(found)[0]
    assert found.power[0] == pytest.approx(measures.power(found.thrusts[0]), rel=1e-3)
    assert not optimum.met(optimum.best(np.array([[200e3, 0.0, 0.0]])))[0]


def test_request_is_within_reach_up_to_the_rates():
    step = [[10e3, 10e3, 0.0]] * 2
    within = commanded(step, [[0, 0]] * 2, [[20e3, 0, 0], [20.15e3, 0, 0]])
    beyond = commanded(step, [[0, 0]] * 2, [[20e3, 0, 0], [20.3e3, 0, 0]])
    assert measures.reachable(within, 1)[1, 0] and not measures.reachable(beyond, 1)[1, 0]
    sector = commanded(step, np.radians([[80.0, 80.0]] * 2), [[0, 0, 0], [10e3, 10e3, 0]])
    assert not measures.reachable(sector, 1)[1, 0]


@pytest.mark.parametrize("law", [law for law in LAWS if law not in RIVALS])
def test_every_law_of_ours_goes_through_random_and_adversarial_requests(law):
    found = loops.replay(law, *drawn.requests(500, 5))
    assert np.isfinite(found.thrusts).all() and np.isfinite(found.azimuths).all()
    if law in table.KEEPING:
        assert {
            kind: int(count[0]) for kind, count in measures.violations(found).items()
        } == dict.fromkeys(("force", "angle", "rate", "sector"), 0)


def test_loop_with_the_allocator_in_its_own_place_is_the_loop_as_it_is():
    plain, _ = loops.run("stationkeeping", [3, 4], until=3.0)
    found, asked = loops.run("stationkeeping", [3, 4], "allocator", until=3.0)
    for name in ("vessel.x", "vessel.psi", "allocator.port_thrust_cmd"):
        np.testing.assert_allclose(found[name], plain[name], rtol=1e-9, atol=1e-9)
    assert asked.tau.shape == (60, 2, 3)


def test_table_says_what_is_not_met():
    one = {"seeds": [1, 2], "seconds": [1e-3, 2e-3]}
    row = table.Row("time, median [us]", table.microseconds(0), {"a law": 60.0})
    laws = {"a law": one, "a rival": one}
    assert table.lines(laws, [row])[-1] == "| time, median [us] | 60 | 1e+03 **not met** | 1e+03 |"
    assert table.not_met(laws, [row]) == ["time, median [us], a law: 1e+03, to reach 60"]
    assert table.not_met({"a law": one | {"seconds": [1e-5, 2e-5]}}, [row]) == []
