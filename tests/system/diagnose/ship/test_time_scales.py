"""The time constants of a ship are those with which she slows down."""

from dataclasses import replace

import numpy as np
import pytest
from diagnose import twin

from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.time_scales import fastest_rate, response_times
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship.hull import HullParameters

STILL = dict.fromkeys(("length", "breadth", "draught"), 2.0)
LINEAR = HullParameters(
    **STILL,
    mass=90.0,
    inertia_yaw=30.0,
    A11=10.0,
    A22=110.0,
    A26=0.0,
    A62=0.0,
    A66=10.0,
    X_u=-50.0,
    Y_v=-400.0,
    N_r=-8.0,
)


@pytest.fixture(scope="module")
def ship():
    """A ship of any make, to give hulls to."""
    return ship_model_of(twin.system())


def moving(u=0.0, v=0.0, r=0.0, rows=3):
    """A motion with constant velocity."""
    return Motion(*(np.full(rows, value) for value in (0.0, 0.0, 0.0, u, v, r)))


def having(ship, hull):
    """The ship with another hull."""
    return replace(ship, parts=ship.parts | {"hull": hull})


def test_linear_damping_gives_mass_with_added_mass_over_damping(ship):
    assert response_times(having(ship, LINEAR), moving()) == pytest.approx(
        (100.0 / 50.0, 200.0 / 400.0, 40.0 / 8.0)
    )


def test_quadratic_damping_slows_a_faster_ship_sooner(ship):
    hull = having(ship, replace(LINEAR, X_u=0.0, X_uu=-25.0))
    slow, fast = response_times(hull, moving(u=0.5)), response_times(hull, moving(u=-2.0))
    assert (slow.surge, fast.surge) == pytest.approx((100.0 / 25.0, 100.0 / 100.0), rel=1e-2)


def test_without_damping_there_is_no_time(ship):
    found = response_times(having(ship, replace(LINEAR, N_r=0.0)), moving(u=1.0))
    assert found.yaw == np.inf == found.slowest
    assert min(found) == found.sway and found.middle == pytest.approx(1.0)


def test_rows_without_a_velocity_do_not_count(ship):
    motion = moving(u=1.0)
    motion.u[0] = np.nan
    assert response_times(having(ship, LINEAR), motion).surge == pytest.approx(2.0)
    motion.u[:] = np.nan
    assert min(response_times(having(ship, LINEAR), motion)) == np.inf


def test_the_fastest_rate_is_the_largest_but_for_a_few_rows(ship):
    hull = having(ship, LINEAR)
    one = fastest_rate(hull, moving())
    assert one == pytest.approx(400.0 / 200.0)
    assert one == pytest.approx(1.0 / min(response_times(hull, moving())))
