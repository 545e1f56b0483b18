"""Thrust that slipstreams take: by distance, by angle, by the ratio of the slipstreams, and not the other way round."""

from math import pi, radians

import numpy as np
import pytest

from shipcosim.models.propulsion.interaction import (
    InteractionParameters,
    kept_share,
    pairs,
    tandem_share,
    thrust_shares,
)

SIDE_BY_SIDE = InteractionParameters(
    x_1=0.0, y_1=-2.0, diameter_1=1.9, x_2=0.0, y_2=2.0, diameter_2=1.9
)
TANDEM = InteractionParameters(x_1=10.0, diameter_1=2.0, x_2=0.0, diameter_2=2.0)


def shares(parameters, azimuths, washes, **more):
    idle = (0.0,) * (6 - len(azimuths))
    return thrust_shares(
        (*azimuths, *idle), (*washes, *idle), unit_pairs=pairs(parameters), **more
    )[: len(azimuths)]


@pytest.mark.parametrize(
    ("distance", "published"), [(1.0, 0.20), (4.0, 0.43), (8.0, 0.59), (16.0, 0.76)]
)
def test_loss_on_the_axis_is_that_of_dang_and_laheij(distance, published):
    """1 - 0.8^((x/D)^(2/3)), worked out by hand."""
    assert tandem_share(distance) == pytest.approx(published, abs=0.005)


def test_front_unit_loses_nothing_and_the_one_behind_what_is_published():
    front, behind = shares(TANDEM, (0.0, 0.0), (5.0, 5.0))
    assert front == pytest.approx(1.0, abs=1e-3)
    assert behind == pytest.approx(1.0 - 0.8 ** (5.0 ** (2.0 / 3.0)))


def test_reversed_thrust_hits_the_unit_on_the_other_side():
    """Astern the front unit throws its water ahead, and the other one throws its own at it."""
    hit, behind = shares(TANDEM, (0.0, 0.0), (-5.0, -5.0))
    assert hit == pytest.approx(1.0 - 0.8 ** (5.0 ** (2.0 / 3.0)))
    assert behind == pytest.approx(1.0, abs=1e-3)


def test_turning_away_leaves_ever_more_thrust():
    angles = np.radians(np.linspace(0.0, 90.0, 91))
    kept = kept_share(angles, 0.3, 1.0)
    assert kept[0] == pytest.approx(0.3)
    assert (np.diff(kept) > 0.0).all()
    assert kept[-1] > 0.98
    np.testing.assert_allclose(kept_share(-angles, 0.3, 1.0), kept)


def test_half_of_the_loss_is_left_where_the_formula_says():
    """phi^3 = 130/t^3: 16.9 deg at t = 0.3."""
    assert kept_share(radians(130.0 ** (1.0 / 3.0) / 0.3), 0.3, 1.0) == pytest.approx(0.65)


def test_port_loss_mirrors_starboard_loss():
    port, starboard = shares(SIDE_BY_SIDE, (1.3, 0.2), (4.0, 6.0))
    assert shares(SIDE_BY_SIDE, (-0.2, -1.3), (6.0, 4.0)) == pytest.approx((starboard, port))
    assert port < 1.0


def test_weak_slipstream_takes_little_and_none_nothing():
    strong, weak, none = (
        shares(SIDE_BY_SIDE, (0.0, pi / 2), (5.0, wash))[0] for wash in (9.0, 1.0, 0.0)
    )
    assert strong < weak < none == 1.0
    assert 1.0 - weak == pytest.approx((1.0 - strong) / 5.0, rel=1e-5)


def test_scale_of_0_means_no_interaction():
    assert shares(TANDEM, (0.0, 0.0), (5.0, 5.0), loss_scale=0.0) == (1.0, 1.0)


def test_two_units_in_one_place_are_refused():
    with pytest.raises(ValueError, match="units 1 and 2 are in the same place"):
        pairs(InteractionParameters(diameter_1=1.0, diameter_2=1.0))
