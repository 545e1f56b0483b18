"""How far observer and filters keep the motion in waves out of the requested load."""

import numpy as np

from shipcosim.models.control.margins import OpenLoop, responses
from shipcosim.models.control.pid import ControlParameters


def wave_suppression(
    loop: OpenLoop, axis: int, frequencies: np.ndarray, law: ControlParameters
) -> np.ndarray:
    """Response of the requested load to wave motion, over that of the same law without observer and filters.

    Parameters
    ----------
    loop : OpenLoop
        The open loop; here it is closed.
    axis : int
        0 surge, 1 sway, 2 yaw. [1]
    frequencies : (n,) array
        Frequencies of the wave motion. [rad/s]
    law : ControlParameters
        Of the control law.

    Returns
    -------
    (n,) array
        Ratio of the two responses; below 1 the waves are suppressed. [1]
    """
    # Here all three axes are closed: the waves disturb the controlled ship.
    closed = [a + loop.push @ loop.thrust for a in loop.transitions]
    w0 = (law.surge_frequency, law.sway_frequency, law.yaw_frequency)[axis]
    w = np.asarray(frequencies)
    # A sinusoidal motion has position and rate: x and j ω x.
    motion = loop.waves[:, [axis]] + 1j * w[:, None, None] * loop.waves[:, [axis + 3]]
    asked = responses(closed, motion, loop.request, w, loop.sample)[:, :, 0]
    # The same law without observer: |ω0² + 2 j ζ ω0 ω| is its gain from motion to acceleration.
    plain = np.abs(w0 * w0 + 2j * law.damping_ratio * w0 * w)
    return np.abs(loop.per_mass[axis] @ asked.T) / plain
