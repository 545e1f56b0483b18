"""Measured motions smoothed without a model of the ship: a Gaussian kernel, and rates by its derivative."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.numerics import gaussian_filter, runs, trapezium
from shipcosim.diagnose.ship.inputs import Record
from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.kinematics import eta_dot, to_body
from shipcosim.models.core.motion import Motion

_REACH = 2.5  # widths that a gap in the log reaches
_ENOUGH = 0.2  # share of the rows that a channel must be measured in


def froude_time(length: float) -> float:
    """Root of the length over gravity: the time in which ships of all sizes do alike. [s]"""
    return float(np.sqrt(length / GRAVITY))


@dataclass(frozen=True)
class Kernel:
    """A Gaussian kernel over rows; its derivative gives rates, so that both are of equal bandwidth.

    Attributes
    ----------
    width : float
        Standard deviation. [s]
    step : float
        Time from row to row. [s]
    """

    width: float
    step: float

    def smooth(self, series: np.ndarray) -> np.ndarray:
        """The series, averaged along its last axis."""
        return gaussian_filter(series, self.width / self.step, ends="held")

    def rate(self, series: np.ndarray, order: int = 1) -> np.ndarray:
        """Its derivative of an order, averaged alike. [per s]"""
        return (
            gaussian_filter(series, self.width / self.step, order=order, ends="held")
            / self.step**order
        )

    def clear_of(self, bad: np.ndarray) -> np.ndarray:
        """Rows as far from bad ones, and from both ends, as the kernel reaches."""
        # Rows outside the log count as bad; a row is clear if no bad row is within reach.
        ends = np.pad(bad, self.reach, constant_values=True)
        return np.convolve(ends, np.ones(2 * self.reach + 1), "valid") < 0.5

    @property
    def reach(self) -> int:
        """Rows to either side on which a value counts."""
        return int(np.ceil(_REACH * self.width / self.step))


def unsmoothed(record: Record, kernel: Kernel) -> tuple[Motion, np.ndarray]:
    """The measured motion with gaps filled, and rows without a measurement; velocities from positions where missing.

    Parameters
    ----------
    record : Record
    kernel : Kernel
        For what has to be derived.

    Returns
    -------
    tuple of Motion, (n,) bool array
    """
    # Fill short gaps by interpolation, and mark long ones.
    rows = np.arange(record.time.size)
    columns = []
    bad = np.zeros(record.time.size, bool)
    for channel in range(6):
        series = record.measured[:, channel]
        whole = np.isfinite(series)
        if is_measured(record, channel):
            # Rows of gaps that are longer than what the kernel averages over anyway.
            for first, last in runs(~whole):
                bad[first:last] |= (last - first) * kernel.step > kernel.width
            series = np.interp(rows, rows[whole], series[whole])
        columns.append(series)
    # At the ends of stretches the kernel mixes rows that do not follow each other.
    for part in record.stretches[:-1]:
        bad[max(part.stop - 2 * kernel.reach, 0) : part.stop + 2 * kernel.reach] = True
    x, y, psi, u, v, r = columns
    # Velocities that were not measured, from smoothed positions and heading.
    if not is_measured(record, 3) or not is_measured(record, 4):
        u, v = to_body(kernel.smooth(psi), kernel.rate(x), kernel.rate(y))
    if not is_measured(record, 5):
        r = kernel.rate(psi)
    return Motion(x, y, psi, u, v, r), bad


def way_of(motion: Motion, step: float) -> np.ndarray:
    """Place and heading that the velocities of a motion reach from zero, row by row, (n, 3) array. [m, m, rad]

    Smoothed places lie inside the turns that a ship sails, and short of both ends of a log. So smooth only that by
    which measured places differ from this way.
    """
    rates = np.stack(eta_dot(motion.psi, motion.u, motion.v, motion.r), axis=-1)
    return trapezium(rates, step)


def is_measured(record: Record, channel: int) -> bool:
    """Whether a channel has values in a good part of the rows."""
    return bool(np.isfinite(record.measured[:, channel]).mean() > _ENOUGH)
