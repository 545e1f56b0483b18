"""A long log, of which only a part is in memory at a time, is answered as one that is there as a whole."""

from functools import cache

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.inference import parts
from shipcosim.diagnose.inference.innovations import Noise, inner_products, innovations, smoothed
from shipcosim.diagnose.inference.linearisation import Linear, Regressor, linearise
from shipcosim.diagnose.inference.parts import (
    InParts,
    beside,
    explained,
    in_parts,
    linearised_by_parts,
    with_columns,
)
from shipcosim.diagnose.ship.inputs import first_motion, record_of

NOISE = Noise(twin.WHITE, twin.JOLT, np.array([1e-5, 1e-5, 1e-6]), 2.0 * twin.WHITE[3:], 1.1)
CHANGES = {"port.thrust_loss": 0.2}, {"instruments.thruster_lag": 0.5}, {"instruments.lever_y": 4.0}
REGRESSORS = [Regressor(changes) for changes in CHANGES]


@cache
def log():
    """Record and motion of 361 rows, one step of which is not known."""
    record = record_of(twin.logs()["healthy"], twin.model())
    record.usable[90] = False
    return record, first_motion(record)


def whole():
    record, motion = log()
    return linearise(motion, record, twin.model(), REGRESSORS)


def by_parts():
    record, motion = log()
    return linearised_by_parts(motion, record, twin.model(), REGRESSORS)


@pytest.fixture(params=[90, 91, 400])
def part(request, monkeypatch):
    """Rows of a part; of four parts, of three and a row, of the whole log."""
    monkeypatch.setattr(parts, "PART", request.param)
    return request.param


def test_parts_have_the_rows_of_the_whole_and_the_steps_between_them(part):
    joined = by_parts().whole()
    assert len(list(by_parts().slices())) == -(-361 // part)
    for mine, expected in zip(joined, whole(), strict=True):
        np.testing.assert_allclose(
            mine, expected, rtol=1e-9, atol=1e-9
        )  # slopes are differences over 1e-5


def test_innovations_are_the_same(part):
    record, _ = log()
    for mine, expected in zip(
        innovations(by_parts(), NOISE, record), innovations(whole(), NOISE, record), strict=True
    ):
        np.testing.assert_allclose(mine, expected, rtol=1e-9, atol=1e-9)


def test_inner_products_are_those_of_the_innovations(part):
    record, _ = log()
    found, white = (
        inner_products(by_parts(), NOISE, record),
        innovations(whole(), NOISE, record).white,
    )
    flat = white.reshape(-1, white.shape[-1])
    np.testing.assert_allclose(found.products, flat.T @ flat, rtol=1e-9, atol=1e-9)
    assert len(found.blocks) == 8


def test_smoothed_motion_is_the_same(part):
    record, motion = log()
    found, expected = (
        smoothed(linear, NOISE, record, motion) for linear in (by_parts(), in_parts(whole()))
    )
    np.testing.assert_allclose(np.stack(found[0]), np.stack(expected[0]), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-9, atol=1e-9)


def test_columns_beside_chosen_and_taken_out_are_the_same(part):
    full, theta = whole(), np.array([0.5, -1.0, 2.0])
    both = beside(by_parts(), by_parts().chosen([3])).whole()
    np.testing.assert_allclose(both.seen[..., [4]], full.seen[..., [3]], atol=1e-12)
    ones = with_columns(by_parts(), 1, lambda rows: ones_of(full, rows))
    assert ones.columns == 4 and (ones.whole().driven[..., 4] == 1.0).all()
    left = explained(by_parts(), theta).whole()
    np.testing.assert_allclose(left.driven[..., 0], full.driven @ [1.0, *-theta], atol=1e-12)


def ones_of(linear: Linear, rows):
    return np.ones_like(linear.driven[rows, :, :1]), np.ones_like(linear.seen[rows, :, :1])


def test_the_more_columns_the_fewer_rows_a_part_has():
    few, many = (InParts(20_000, columns, whole) for columns in (10, 400))
    assert next(few.slices()).stop == parts.PART
    assert parts._LEAST <= next(many.slices()).stop < parts.PART
