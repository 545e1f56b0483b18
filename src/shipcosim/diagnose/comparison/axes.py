"""Commanded against measured force on each axis: how much of the measured force the thrusters explain, with which gain.

The measured force is inertia times acceleration, less what turning asks of the rigid body. Beside the thrusters it is
explained by whatever else may act: the model's load of the water with any size, further damping of any size, coupling
of the axes, wind, and a steady force. Damping takes energy away, in whatever model: its coefficients have one sign.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from shipcosim.diagnose.comparison.commanded import Commanded, moving_mass
from shipcosim.diagnose.comparison.measured_force import MeasuredForce
from shipcosim.diagnose.comparison.regression import Regression, regressed
from shipcosim.diagnose.comparison.thresholds import (
    BLOCK_WIDTHS,
    LEAST_COMMANDED,
    MOST_BLOCKS,
    STEADY_SHARE,
    TURNED_ROUND,
    WEAKER_WAY,
)
from shipcosim.diagnose.numerics import root_mean_square
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.models.core.motion import Motion

AXES = ("surge", "sway", "yaw")
_OF_HULL = 3  # columns of the water's load: the model's, and linear and quadratic damping


@dataclass(frozen=True)
class AxisFit:
    """The measured force on one axis explained by commanded loads and all else that may act.

    Attributes
    ----------
    gains, std : (k,) array
        Of the commanded loads, and their standard deviations.
    support : float
        Log-likelihood that the commanded loads gain. [nats]
    squares : float
        Mean square of what is left. [N2 or N2.m2]
    share : float
        Of the measured force's mean square that is explained.
    damping, damping_std : float
        The water's load as fitted over that of the model, along the log.
    """

    gains: np.ndarray
    std: np.ndarray
    support: float
    squares: float
    share: float
    damping: float
    damping_std: float


@dataclass(frozen=True)
class Axis:
    """One axis of the ship over a log, smoothed, usable rows only.

    Attributes
    ----------
    number : int
        Of `AXES`.
    force : (n,) array
        Measured force. [N or N.m]
    hull, wind : (n,) array
        Loads by the model; no wind is 0.
    rest : (n, q) array
        Columns of all but the thrusters, those of the water first.
    positive : (q,) bool array
        Which have a coefficient that must not be negative.
    size : float
        What the thrusters are commanded, root mean square: other forces that no model knows are of its order.
    rows : (m,) bool array
        The usable rows of the log.
    measured : MeasuredForce
    block : int
        Rows of a block.
    """

    number: int
    force: np.ndarray
    hull: np.ndarray
    wind: np.ndarray
    rest: np.ndarray
    positive: np.ndarray
    size: float
    rows: np.ndarray
    measured: MeasuredForce
    block: int

    @property
    def name(self) -> str:
        """``"surge"``, ``"sway"`` or ``"yaw"``."""
        return AXES[self.number]

    def smoothed(self, loads: np.ndarray) -> np.ndarray:
        """Loads on all rows, (3, m) array, as this axis has them: (n,)."""
        return self.measured.kernel.smooth(loads[self.number])[self.rows]

    def total(self, commanded: Commanded) -> np.ndarray:
        """Commanded force of all thrusters, (n,) array."""
        return sum(
            (self.smoothed(load) for load in commanded.thrusters.values()),
            np.zeros(self.force.size),
        )

    def by_way(self, commanded: Commanded, ahead: Mapping[str, np.ndarray]) -> np.ndarray:
        """Force of all thrusters where they push ahead, and where they push astern, (2, n) array."""
        # Each thruster's load counts where its propeller turns that way; those of one way add up.
        loads = commanded.thrusters.items()
        return np.stack(
            [
                sum((self.smoothed(load * (ahead[name] == way)) for name, load in loads), 0.0)
                for way in (True, False)
            ]
        )

    def is_changed(self, commanded: Commanded, other: Commanded) -> bool:
        """Whether two readings of the commands differ here by more than a tenth of the usual force."""
        apart = np.abs(self.total(other) - self.total(commanded)).max()
        return bool(apart > 0.1 * self.size)

    def is_driven(self, commanded: Commanded) -> bool:
        """Whether the commanded force on this axis is large enough against the measured force."""
        total = self.total(commanded)
        return bool(total.std() > LEAST_COMMANDED * max(self.force.std(), 1e-9))

    def explained(self, columns: np.ndarray) -> AxisFit:
        """The measured force explained by some commanded loads, whose gains must not be negative.

        Parameters
        ----------
        columns : (k, n) array

        Returns
        -------
        AxisFit
        """
        return self._fit(columns, True)

    def compared(self, columns: np.ndarray) -> AxisFit:
        """Fit of the measured force by commanded loads, with gains of any sign."""
        return self._fit(columns, False)

    def most_gain(self, total: np.ndarray) -> tuple[float, float]:
        """Largest gain that a commanded load may have, with its standard deviation: the measured force explains it in turn.

        Where thrust and damping balance, what is left over is small, and any error of either makes the gain look small.
        Explained the other way round, the same errors make it look large: the truth is between.

        Parameters
        ----------
        total : (n,) array

        Returns
        -------
        tuple of float, float
            Infinite where the measured force does not correlate with it.
        """
        # Reverse regression: commanded load on measured force and all other loads, whose signs
        # turn.
        unit = self.unit_of_force
        columns = np.concatenate([self.force[:, None] / unit, -self.rest], axis=1)
        regression = regressed(total, columns, np.r_[True, self.positive], self.block)
        # The slope is the inverse of the gain; the delta method carries its standard deviation
        # over.
        slope = regression.coefficients[0] / unit
        if slope <= 0.0:
            return np.inf, np.inf
        return 1.0 / slope, float(regression.std[0] / unit / slope**2)

    def unexplained(self, given: np.ndarray) -> float:
        """Mean square of the measured force that is left beside a given load, (n,) array, and all but the thrusters."""
        return self._with_rest(given).squares

    @property
    def unit_of_force(self) -> float:
        """Root mean square of the measured force."""
        return root_mean_square(self.force) + 1e-30

    def both_ways(self, ahead: np.ndarray, astern: np.ndarray) -> AxisFit:
        """Fit of the measured force by loads ahead and astern, neither much weaker than the other.

        Parameters
        ----------
        ahead, astern : (n,) array
            Loads of thrusters that run ahead, and of those that run astern.
        """
        return self.explained(np.stack([ahead + WEAKER_WAY * astern, astern + WEAKER_WAY * ahead]))

    def _fit(self, columns: np.ndarray, one_sign: bool) -> AxisFit:
        k = len(columns)
        # Thrusters' columns without a prior, then all else with the prior of unmodelled forces.
        every = np.concatenate([columns.T, self.rest], axis=1)
        positive = np.r_[np.full(k, one_sign), self.positive]
        regression = regressed(
            self.force, every, positive, self.block, np.r_[np.full(k, np.inf), self._prior]
        )
        # Log-likelihood ratio of Gaussian residuals, n/2 log(s0/s1), with n the independent
        # residuals: rows are autocorrelated.
        without = self._without
        support = (
            0.5
            * min(regression.independent, without.independent)
            * np.log(without.squares / regression.squares)
        )
        damping, std = self._water(regression, k)
        gains = regression.coefficients[:k]
        deviations = regression.std[:k]
        # Coefficient of determination about zero.
        share = 1.0 - regression.squares / self.unit_of_force**2
        return AxisFit(gains, deviations, float(support), regression.squares, share, damping, std)

    @cached_property
    def _prior(self) -> np.ndarray:
        return prior_of(self.rest, self.positive, self.size)

    @cached_property
    def _without(self) -> Regression:
        """The measured force explained by all but the thrusters."""
        return self._with_rest(np.zeros(self.force.size))

    def _with_rest(self, given: np.ndarray) -> Regression:
        """The measured force less a given load explained by all but the thrusters."""
        return regressed(self.force - given, self.rest, self.positive, self.block, self._prior)

    def _water(self, regression: Regression, k: int) -> tuple[float, float]:
        """Size of the water's load as fitted, along the model's, with its standard deviation."""
        of_hull = slice(k, k + _OF_HULL)
        columns = self.rest[:, :_OF_HULL]
        # Project the fitted water load onto the model's: a weighted sum of the coefficients, whose
        # variance follows from their covariance.
        along = columns.T @ self.hull / max(float(self.hull @ self.hull), 1e-30)
        variance = float(along @ regression.covariance[of_hull, of_hull] @ along)
        return float(along @ regression.coefficients[of_hull]), float(np.sqrt(variance))


def prior_of(rest: np.ndarray, positive: np.ndarray, size: float) -> np.ndarray:
    """Standard deviations of the coefficients of unmodelled forces.

    Parameters
    ----------
    rest, positive, size
        As of an `Axis`.

    Returns
    -------
    (q,) array
    """
    # Damping and model loads are free except for their sign; coupling and steady forces have a
    # standard deviation of a share of the commanded force.
    share = STEADY_SHARE * size / np.sqrt((rest**2).mean(0) + 1e-30)
    return np.where(positive, np.inf, share)


def axes_of(measured: MeasuredForce, commanded: Commanded, model: ShipModel) -> list[Axis]:
    """The axes of a ship over a log.

    Parameters
    ----------
    measured : MeasuredForce
    commanded : Commanded
        Its thrusters do not matter here.
    model : ShipModel

    Returns
    -------
    list of three Axis
    """
    kernel = measured.kernel
    motion = measured.motion
    rows = measured.usable
    # Force that the motion needs: M nu_dot + C_RB(nu) nu, smoothed as all other loads are.
    force = model.mass_matrix @ measured.rates + kernel.smooth(moving_mass(motion, model))
    # Blocks longer than the kernel, as smoothing correlates the errors within it, and at most
    # MOST_BLOCKS of them.
    block = max(int(BLOCK_WIDTHS * kernel.width / kernel.step), int(rows.sum() / MOST_BLOCKS), 1)
    thrust = commanded.thrust
    axes = []
    wind = np.zeros_like(commanded.hull) if commanded.wind is None else commanded.wind
    for i, (listed, sign) in enumerate(rest_of(motion, commanded)):
        # The same kernel on both sides of the equation biases neither.
        rest = kernel.smooth(listed)[:, rows].T
        size = root_mean_square(kernel.smooth(thrust[i])[rows]) + 1e-9
        hull, air = (kernel.smooth(load[i])[rows] for load in (commanded.hull, wind))
        axes.append(Axis(i, force[i][rows], hull, air, rest, sign, size, rows, measured, block))
    return axes


def rest_of(motion: Motion, commanded: Commanded) -> list[tuple[np.ndarray, np.ndarray]]:
    """What may act beside the thrusters, by axis: unsmoothed columns, and which coefficients must not be negative.

    Parameters
    ----------
    motion : Motion
    commanded : Commanded
        Loads of the hull and of the wind.

    Returns
    -------
    list of three pairs, (q, n) array and (q,) bool array
    """
    # Loads whose coefficient has a known sign: the hull's own, linear and quadratic damping, wind.
    speeds = np.stack([motion.u, motion.v, motion.r])
    columns = []
    wind = commanded.wind
    for i, groups in enumerate(_other_columns(speeds, motion.psi)):
        drag = [commanded.hull[i], -speeds[i], -speeds[i] * np.abs(speeds[i])]
        positive = [
            *drag,
            *([wind[i]] if wind is not None and np.any(wind) else []),
            *groups["damping"],
        ]
        # Coupling and steady force may have any sign.
        listed = [*positive, *groups["coupling"], *groups["steady"]]
        columns.append(
            (np.stack(np.broadcast_arrays(*listed)), np.arange(len(listed)) < len(positive))
        )
    return columns


def _other_columns(speeds: np.ndarray, psi: np.ndarray) -> list[Mapping[str, list[np.ndarray]]]:
    """Further loads by axis: damping, coupling to other axes, and a steady load."""
    u, v, r = speeds
    # A steady force lies in the earth's frame where the ship turned enough to tell it from one in
    # her own.
    once = [np.ones_like(u)]
    earth = [np.cos(psi), np.sin(psi)] if np.ptp(psi) > TURNED_ROUND else once
    # Products of velocities that couple the axes, and damping by the forward speed.
    return [
        {"damping": [], "coupling": [v * r, r * r], "steady": earth},
        {"damping": [-np.abs(u) * v], "coupling": [u * r], "steady": earth},
        {"damping": [-np.abs(u) * r], "coupling": [u * v], "steady": once},
    ]
