"""Frames against Fossen's rotation matrix and the mechanics of a rigid body."""

import numpy as np
import pytest

from shipcosim.models.core.kinematics import eta_dot, load_at, to_body, to_ned, velocity_at


@pytest.mark.parametrize("psi", [-2.0, 0.0, 0.7, 3.0])
def test_rotation_is_fossens_matrix(psi):
    rotation = [[np.cos(psi), -np.sin(psi), 0.0], [np.sin(psi), np.cos(psi), 0.0], [0.0, 0.0, 1.0]]
    np.testing.assert_allclose(eta_dot(psi, 1.0, -2.0, 0.3), rotation @ np.array([1.0, -2.0, 0.3]))


def test_to_body_undoes_to_ned():
    np.testing.assert_allclose(to_body(0.7, *to_ned(0.7, 3.0, -4.0)), (3.0, -4.0))


def test_power_at_a_point_is_power_about_the_origin():
    """Force times the point's velocity equals load times the ship's velocity."""
    x, y, force, nu = -14.0, 2.0, (1e3, -3e3), (1.0, -0.4, 0.05)
    assert np.dot(force, velocity_at(x, y, *nu)) == pytest.approx(np.dot(load_at(x, y, *force), nu))
