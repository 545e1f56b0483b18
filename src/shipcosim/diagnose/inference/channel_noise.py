"""How noisy the channels can be at most, by what position and velocity agree upon, without any model of the ship."""

import numpy as np

from shipcosim.diagnose.inference.thresholds import NOISE_MARGIN, NOISE_WIDTHS, SOUND
from shipcosim.diagnose.numerics import root_mean_square
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.smoothing import Kernel, is_measured, unsmoothed
from shipcosim.models.core.kinematics import to_body


def most_white(record: Record) -> np.ndarray:
    """Largest white noise of each channel, from the difference of position and velocity, heading and yaw rate.

    Where the two are apart, either may be it: each gets the whole of the difference. A channel whose partner was not
    measured has no limit.

    Parameters
    ----------
    record : Record
        Of one log.

    Returns
    -------
    (6,) array
        Standard deviations. [m, m, rad, m/s, m/s, rad/s]
    """
    # Kernels of several widths: the tightest limit counts, as each is sensitive to another part of
    # the spectrum.
    most = np.full(6, np.inf)
    for rows in NOISE_WIDTHS:
        kernel = Kernel(rows * record.step, record.step)
        # Rows whose kernel reaches over a gap are left out, and so are kernels that leave too few
        # rows.
        motion, bad = unsmoothed(record, kernel)
        use = kernel.clear_of(bad)
        if use.sum() < 20:
            continue
        # Velocity by the derivative of the smoothed position and heading, in body axes like the
        # measured velocity.
        by_place = (
            *to_body(kernel.smooth(motion.psi), kernel.rate(motion.x), kernel.rate(motion.y)),
            kernel.rate(motion.psi),
        )
        for axis, (speed, other) in enumerate(
            zip((motion.u, motion.v, motion.r), by_place, strict=True)
        ):
            if not is_measured(record, 3 + axis):
                continue
            # Root mean square of the difference without its largest values, which may be outliers.
            apart = np.sort(np.abs(kernel.smooth(speed) - other)[use])[: int(SOUND * use.sum())]
            size = root_mean_square(apart) * NOISE_MARGIN
            # A Gaussian kernel of n rows divides the standard deviation of white noise by sqrt(2
            # sqrt(pi) n); its derivative multiplies it by 1 / (h sqrt(4 sqrt(pi) n^3)). Both are
            # inverted here.
            of_speed = size * np.sqrt(2.0 * np.sqrt(np.pi) * rows)
            of_place = size * record.step * np.sqrt(4.0 * np.sqrt(np.pi) * rows**3)
            most[3 + axis], most[axis] = min(most[3 + axis], of_speed), min(most[axis], of_place)
    # North and east, and surge and sway, each share one limit: the heading mixes them.
    most[:2], most[3:5] = most[:2].max(), most[3:5].max()
    return most
