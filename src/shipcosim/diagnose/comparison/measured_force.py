"""The motion and the acceleration that a log shows, smoothed without any model of the ship."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.thresholds import KERNEL, SHORTEST_KERNEL
from shipcosim.diagnose.ship.inputs import Record, averaged
from shipcosim.diagnose.ship.smoothing import Kernel, froude_time, is_measured, unsmoothed, way_of
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.motion import Motion


@dataclass(frozen=True)
class MeasuredForce:
    """The motion and the acceleration that a log shows.

    Attributes
    ----------
    motion : Motion
        Rows but gaps filled, unsmoothed, (n,) arrays.
    rates : (3, n) array
        Rates of surge, sway and yaw rate, by the kernel. [m/s2, m/s2, rad/s2]
    usable : (n,) bool array
        Rows that no gap reaches.
    kernel : Kernel
    """

    motion: Motion
    rates: np.ndarray
    usable: np.ndarray
    kernel: Kernel

    @property
    def smooth_motion(self) -> Motion:
        """The motion, averaged by the kernel; its places keep to the way that its velocity goes."""
        smooth = Motion(*(self.kernel.smooth(np.asarray(value, float)) for value in self.motion))
        way = way_of(smooth, self.kernel.step).T
        x, y, psi = way + self.kernel.smooth(np.stack(self.motion[:3]) - way)
        return smooth._replace(x=x, y=y, psi=psi)

    @property
    def velocity(self) -> np.ndarray:
        """Surge, sway and yaw rate, (3, n) array."""
        return np.stack([self.motion.u, self.motion.v, self.motion.r])


def measured_force_of(record: Record, length: float) -> MeasuredForce:
    """The acceleration that a log shows.

    Rates of the measured velocities; where those are not measured, of the positions, turned by the heading.

    Parameters
    ----------
    record : Record
        Of one log.
    length : float
        Of the ship. [m]

    Returns
    -------
    MeasuredForce
    """
    # Kernel in proportion to the ship's time scale, but of some rows at least.
    kernel = Kernel(max(KERNEL * froude_time(length), SHORTEST_KERNEL * record.step), record.step)
    motion, bad = unsmoothed(record, kernel)
    motion = Motion(*(averaged(series) for series in motion))  # as what drives her is
    # Derivative of the smoothed velocities.
    rates = kernel.rate(np.stack([motion.u, motion.v, motion.r]))
    # Without velocities: second derivative of positions in body axes, and the acceleration of the
    # rotating frame.
    if not is_measured(record, 3) or not is_measured(record, 4):
        psi = kernel.smooth(motion.psi)
        r = kernel.smooth(motion.r)
        along, across = to_body(psi, *(kernel.rate(series, 2) for series in (motion.x, motion.y)))
        rates[0], rates[1] = (
            along + r * kernel.smooth(motion.v),
            across - r * kernel.smooth(motion.u),
        )
    # Without yaw rate: second derivative of the heading.
    if not is_measured(record, 5):
        rates[2] = kernel.rate(motion.psi, 2)
    return MeasuredForce(motion, rates, kernel.clear_of(bad | ~record.usable), kernel)
