"""Whether thrusters can give a force forward, a force to starboard and a yaw moment, each by itself."""

from collections.abc import Sequence

import numpy as np

from shipcosim.fmi import FmuError

AXES = ("a force forward", "a force to starboard", "a yaw moment")


def check_geometry(effect: Sequence[Sequence[float]], limits: Sequence[float]) -> None:
    """Refuse units that cannot give one of the three loads without another one.

    Parameters
    ----------
    effect : sequence of (X, Y, N)
        Load of one newton of each unit, or of each force component of a unit that turns. [1, 1, m]
    limits : sequence of float
        Largest thrust of each of them; those with none do not count. [N]

    Raises
    ------
    FmuError
        Naming the loads that they cannot give.
    """
    columns = [tuple(unit) for unit, most in zip(effect, limits, strict=True) if most > 0.0]
    if not columns:
        raise FmuError(
            "no unit has any thrust: every largest thrust is 0 N. Give at least two units a limit above 0"
        )
    matrix = np.array(columns).T
    least = np.eye(3) - matrix @ np.linalg.pinv(matrix, rcond=1e-6)
    missing = [
        axis for axis, miss in zip(AXES, np.abs(least).max(axis=0), strict=True) if miss > 1e-6
    ]
    if missing:
        raise FmuError(
            f"the units cannot give {' or '.join(missing)} by itself, by their places and directions. "
            "Right would be units at different places, or in different directions"
        )
