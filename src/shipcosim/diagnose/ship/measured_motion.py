"""What the instruments show of a ship's motion, and the motion of which they show it."""

from typing import Any

import numpy as np

from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.motion import Motion
from shipcosim.models.ship import instruments


def at_rows(motion: Motion, rows: Any) -> Motion:
    """Some rows of a motion, as an index of its arrays gives them."""
    return Motion(*(value[rows] for value in motion))


def readings(motion: Motion, model: ShipModel) -> Motion:
    """What the instruments show of a motion, without noise and lag, heading not wrapped.

    Position and velocity are the antenna's; surge and sway are its velocity over ground resolved with the measured
    heading.

    Parameters
    ----------
    motion : Motion
    model : ShipModel

    Returns
    -------
    Motion
    """
    errors = model.parts["instruments"]
    return Motion(*instruments.readings(*motion, **errors.errors))._replace(
        psi=motion.psi + errors.heading_bias
    )


def true_motion(seen: Motion, model: ShipModel) -> Motion:
    """The motion of which the instruments show this; headings unwrapped as they were.

    Parameters
    ----------
    seen : Motion
    model : ShipModel

    Returns
    -------
    Motion
    """
    errors = model.parts["instruments"]
    return Motion(*instruments.true_motion(*seen, **errors.errors))._replace(
        psi=seen.psi - errors.heading_bias
    )


def wind_over_ground(
    speed: np.ndarray, direction: np.ndarray, motion: Motion
) -> tuple[np.ndarray, np.ndarray]:
    """Velocity over ground to north and east of the wind that meets a moving ship so. [m/s]

    Parameters
    ----------
    speed, direction : array
        Apparent; the direction is where it comes from, against the bow. [m/s, rad]
    motion : Motion
    """
    # The ship's velocity less the relative wind, turned to north and east.
    along = motion.u - speed * np.cos(direction)
    across = motion.v - speed * np.sin(direction)
    return to_ned(motion.psi, along, across)
