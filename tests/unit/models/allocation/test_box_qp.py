"""The quadratic program of the allocators against scipy's bounded least squares, and floats against arrays."""

from fractions import Fraction

import numpy as np
import pytest

from shipcosim.models.allocation.box_qp import Command, multipliers_of, solve

SLACK = (1e-4, 2e-4, 5e-3)


def programs(number, size, seed=1):
    """Random programs; in some a command has no room, or 0 is not within its bounds."""
    draw = np.random.default_rng(seed)
    for _ in range(number):
        effects, ease = (
            draw.normal(size=(size, 3)) * [1.0, 1.0, 10.0],
            np.exp(draw.normal(size=size)),
        )
        ends = np.sort(draw.normal(size=(size, 2)), axis=1)
        still = draw.random(size) < 0.1
        ends[still, 0] = ends[still, 1]
        rows = zip(
            effects.tolist(),
            ease.tolist(),
            draw.normal(size=size).tolist(),
            ends.tolist(),
            strict=True,
        )
        commands = [Command(*effect, e, wanted, *bounds) for effect, e, wanted, bounds in rows]
        yield (
            tuple((draw.normal(size=3) * [1.0, 1.0, 10.0] * 10.0 ** draw.uniform(-1, 1)).tolist()),
            commands,
        )


def price(x, request, commands):
    X, Y, N, ease, wanted, _, _ = np.array(commands).T
    missed = np.array(request) - np.array([X @ x, Y @ x, N @ x])
    return ((x - wanted) ** 2 / ease).sum() + (missed**2 / SLACK).sum()


@pytest.mark.parametrize("size", [3, 5, 12])
def test_the_price_is_that_of_scipy_and_the_bounds_are_kept(size):
    lsq_linear = pytest.importorskip("scipy.optimize").lsq_linear
    for request, commands in programs(60, size):
        x = np.array(solve(request, commands, SLACK)[0])
        X, Y, N, ease, wanted, low, high = np.array(commands).T
        assert ((low <= x) & (x <= high)).all()
        matrix = np.vstack([np.diag(ease**-0.5), (np.array([X, Y, N]).T / np.sqrt(SLACK)).T])
        goal = np.concatenate([wanted * ease**-0.5, np.array(request) / np.sqrt(SLACK)])
        best = lsq_linear(matrix, goal, (low - 1e-12, high + 1e-12), tol=1e-14, method="bvls")
        assert price(x, request, commands) <= price(best.x, request, commands) * (1.0 + 1e-7)


def test_many_at_once_get_to_the_digit_what_each_gets():
    # In half of the programs two commands are the same, so that choices tie.
    each = [
        (request, commands if number % 2 else [commands[0], *commands[:-1]])
        for number, (request, commands) in enumerate(programs(400, 5))
    ]
    together = solve(
        tuple(np.array([request for request, _ in each]).T),
        [Command(*np.array([commands[i] for _, commands in each]).T) for i in range(5)],
        SLACK,
    )
    alone = [solve(request, commands, SLACK) for request, commands in each]
    np.testing.assert_array_equal(np.array(together[0]).T, [x for x, _ in alone])
    np.testing.assert_array_equal(np.array(together[1]).T, [m for _, m in alone])


@pytest.mark.parametrize("number", range(20))
def test_rounding_grows_by_the_condition_and_not_by_its_square(number):
    """One free command for three loads, as beside idle units and one at its limit. Fractions are exact."""
    draw = np.random.default_rng(number)
    slack = (1e-7, 1e-7, 1e-5)
    request = tuple(draw.normal(size=3).tolist())
    rows = [(*draw.normal(size=3).tolist(), 0.0, 1.0)]
    found = multipliers_of(request, slack, rows)
    exact = multipliers_of(
        *[tuple(map(Fraction, one)) for one in (request, slack)],
        [tuple(map(Fraction, row)) for row in rows],
    )
    largest = max(map(abs, exact))
    assert all(abs(Fraction(a) - b) < 1e-6 * largest for a, b in zip(found, exact, strict=True))
