"""Whether commands come before what they do: velocities predicted from their past, with and without past commands.

Where a controller commands the thrusters by the motion, or unknown weather drives the ship, commands and measured
force correlate whichever causes the other. But only what a thruster does comes after its command: given the past of the
motion, past commands say more of the next velocity if they are those that the ship obeys.
"""

from collections.abc import Sequence

import numpy as np

from shipcosim.diagnose.comparison.commanded import Commanded
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.thresholds import (
    CAUSAL_ORDER,
    CAUSAL_STEP,
    COMMANDS_BEFORE,
    HUBER,
)
from shipcosim.diagnose.numerics import least_squares, normal_size, running_sums


def causal_support(
    measured: MeasuredForce, commanded: Sequence[Commanded], unit: float
) -> np.ndarray:
    """Log-likelihood that each of several readings of the commands gains by predicting the velocities, over none.

    Velocities, averaged over blocks of rows, are regressed on their own past, on what couples and damps them, and on
    the commanded loads of the blocks before, whose coefficients must not be negative. As the residuals are what nobody
    could know before, they do not go with commands that answer the past (the prediction error method: Ljung, System
    Identification, 2nd ed., Prentice Hall, 1999, ch. 13.4).

    Parameters
    ----------
    measured : MeasuredForce
    commanded : sequence of Commanded
    unit : float
        Root of the ship's length over gravity. [s]

    Returns
    -------
    (k,) array
        Summed over the axes; 0 where the log has too few blocks. [nats]
    """
    # Blocks of a share of the time that the ship needs to respond, so that a command's effect shows
    # in the next one.
    count = max(1, round(CAUSAL_STEP * unit / measured.kernel.step))
    motion = measured.motion
    speeds = blocks(np.stack([motion.u, motion.v, motion.r]), count)
    heading = blocks(motion.psi, count)
    # A block counts if all of its rows are usable.
    usable = blocks(measured.usable.astype(float), count) > 1.0 - 1e-9
    # Blocks with a complete past of all lags.
    rows = with_past(usable, CAUSAL_ORDER + 1)
    support = np.zeros(len(commanded))
    # Total commanded load of each interpretation, averaged as the velocities are.
    loads = [
        blocks(sum(reading.thrusters.values(), np.zeros_like(reading.hull)), count)
        for reading in commanded
    ]
    for axis in range(3):
        past = _past(axis, speeds, heading, rows)
        # Too few blocks for that many coefficients.
        if rows.size < 3 * past.shape[1]:
            continue
        # Remove the past from velocity and commands by an orthonormal basis (Frisch-Waugh): what is
        # left is the innovation.
        basis = np.linalg.qr(past)[0]
        left = _without(basis, speeds[axis][rows])
        for number, load in enumerate(loads):
            # Commands of the blocks before only, never of the same block.
            before = np.stack(
                [load[axis][rows - 1 - lag] for lag in range(COMMANDS_BEFORE)], axis=1
            )
            support[number] += _gained(left, _without(basis, before))
    return support


def blocks(series: np.ndarray, count: int) -> np.ndarray:
    """Averages over blocks of `count` rows, along the last axis."""
    whole = series.shape[-1] // count
    return series[..., : whole * count].reshape(*series.shape[:-1], whole, count).mean(-1)


def with_past(usable: np.ndarray, count: int) -> np.ndarray:
    """Usable blocks that follow a given number of usable blocks."""
    # Cumulative count of bad blocks: equal at both ends where the past is complete.
    bad = running_sums(~usable)
    rows = np.arange(count, usable.size)
    return rows[bad[rows + 1] == bad[rows - count]]


def _past(axis: int, speeds: np.ndarray, heading: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Past motion as scaled columns, to predict a velocity."""
    u, v, r = speeds
    speed = speeds[axis]
    # Past velocities, more lags of the axis itself.
    columns = [
        speeds[of_axis][rows - 1 - lag]
        for of_axis in range(3)
        for lag in range(CAUSAL_ORDER if of_axis == axis else 2)
    ]
    # Products at the last block: Coriolis coupling, quadratic damping, and forward speed.
    products = (u * v, u * r, v * r, u * u, r * r, speed * np.abs(speed), np.abs(u) * speed)
    columns += [product[rows - 1] for product in products]
    # A steady force in the ship's frame or the earth's.
    columns += [np.ones(rows.size), np.cos(heading[rows - 1]), np.sin(heading[rows - 1])]
    past = np.stack(columns, axis=1)
    # Unit root mean square, so that the basis is well conditioned.
    return past / (np.sqrt((past**2).mean(0)) + 1e-12)


def _without(basis: np.ndarray, columns: np.ndarray) -> np.ndarray:
    return columns - basis @ (basis.T @ columns)


def _gained(left: np.ndarray, columns: np.ndarray) -> float:
    """Log-likelihood that columns with coefficients that must not be negative gain on residuals."""
    # Commands that the past predicts entirely say nothing.
    size = np.sqrt((columns**2).sum(0))
    if not np.any(size > 0.0) or not np.any(left):
        return 0.0
    unit = columns / np.maximum(size, 1e-300)
    # Residuals of the least-squares fit with coefficients that are not negative.
    after = left - unit @ least_squares(unit, left)
    bound = HUBER * normal_size(after) + 1e-300  # so that single jumps of a channel do not decide

    def loss(series):
        far = np.abs(series)
        return np.where(far < bound, far**2, 2.0 * bound * far - bound**2).sum()

    # Log-likelihood ratio with Huber's loss in place of the sum of squares.
    return float(0.5 * left.size * np.log(loss(left) / loss(after)))
