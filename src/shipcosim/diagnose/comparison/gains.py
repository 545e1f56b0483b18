"""How large the commanded force is beside the measured one: on each axis, of each thruster, and as a common ratio."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.comparison.axes import Axis, AxisFit
from shipcosim.diagnose.comparison.commanded import Commanded
from shipcosim.diagnose.comparison.thresholds import (
    COMMON_SPREAD,
    LEAST_SUPPORT,
    LEAST_WAY,
    OFF,
    RIVAL,
    SURE_OF_GAIN,
    SURE_OF_RATIO,
    THRUSTER_SPREAD,
    TOLD,
)
from shipcosim.diagnose.numerics import root_mean_square


def is_beyond(ratio: float, std: float, least: float, deviations: float) -> bool:
    """Whether a ratio differs from 1 by more than a factor, with a margin in standard deviations."""
    return bool(abs(np.log(ratio)) - deviations * std / ratio > np.log(least))


@dataclass(frozen=True)
class AxisGain:
    """Measured over commanded force on one axis.

    Attributes
    ----------
    axis : Axis
    total : (n,) array
        What all thrusters are commanded. [N or N.m]
    fit : AxisFit
        The measured force explained by that, any sign.
    gain, std : float
        Middle and standard deviation of the gain, by what both ways of explaining it say; of the fit alone where only
        that says something.
    each, each_std : dict of str to float
        By thruster.
    support_of_each : float
        Log-likelihood that the thrusters gain, each with a gain of its own. [nats]
    share_of_each : float
        Of the measured force's mean square that they then explain, with the water.
    ways : tuple of two pairs of floats, or None
        Gains of thrust ahead and astern with their standard deviations; None where the log does not have both.
    support_of_ways : float
        Log-likelihood that the thrusters gain, each way with a gain of its own that is not negative. [nats]
    error : float
        Root mean square of the measured force less all of the model's, over that of the commanded one.
    """

    axis: Axis
    total: np.ndarray
    fit: AxisFit
    gain: float
    std: float
    each: dict[str, float]
    each_std: dict[str, float]
    support_of_each: float
    share_of_each: float
    ways: tuple[tuple[float, float], tuple[float, float]] | None
    support_of_ways: float
    error: float

    @property
    def is_off(self) -> bool:
        """Whether the unchanged model is far from the measured force."""
        return self.error > OFF

    @property
    def is_told(self) -> bool:
        """Whether thrusters and water explain most of the measured force."""
        return self.share_of_each > TOLD

    @property
    def is_known(self) -> bool:
        """Whether the log tells the gain."""
        return (
            self.is_told
            and self.fit.support > LEAST_SUPPORT
            and self.gain > SURE_OF_GAIN * self.std
        )

    @property
    def has_thrusters_apart(self) -> bool:
        """Whether each thruster's gain is reliable: with nearly equal commands gains cannot be separated."""
        return all(v > -SURE_OF_GAIN * self.each_std[name] for name, v in self.each.items())

    @property
    def is_common(self) -> bool:
        """Whether neither way's, nor any thruster's own gain is surely far from that of all."""
        common = float(self.fit.gains[0])
        near = THRUSTER_SPREAD * abs(common)
        return not self.differs_by_way and all(
            abs(v - common) <= SURE_OF_GAIN * self.each_std[name] + near
            for name, v in self.each.items()
        )

    @property
    def is_balanced(self) -> bool:
        """Whether gains of thrust ahead and astern explain as much as a negative gain of their sum."""
        return self.ways is not None and self.support_of_ways > self.fit.support - RIVAL

    @property
    def differs_by_way(self) -> bool:
        """Whether thrust ahead and astern clearly have different gains, one of which is known."""
        if self.ways is None or self.support_of_ways < self.fit.support + LEAST_SUPPORT:
            return False
        # One way is known surely and both are positive; then the difference must exceed its
        # standard error and the usual spread between thrusters.
        (ahead, std), (astern, other) = self.ways
        is_known = (
            max(ahead / max(std, 1e-9), astern / max(other, 1e-9)) > SURE_OF_GAIN
            and min(ahead, astern) > 0.0
        )
        near = THRUSTER_SPREAD * max(ahead, astern)
        return is_known and abs(ahead - astern) > SURE_OF_GAIN * float(np.hypot(std, other)) + near

    def differs(self, least: float) -> bool:
        """Whether the gain differs from 1 by a factor of more than `least` for sure."""
        return self.gain <= 0.0 or is_beyond(self.gain, self.std, least, SURE_OF_GAIN)


def gains_of(
    axes: Sequence[Axis], commanded: Commanded, ahead: Mapping[str, np.ndarray]
) -> list[AxisGain]:
    """The gain on each axis that the thrusters drive.

    Parameters
    ----------
    axes : sequence of Axis
    commanded : Commanded
    ahead : mapping of str to (n,) bool array
        By thruster: where it runs ahead.

    Returns
    -------
    list of AxisGain
    """
    return [_gain(axis, commanded, ahead) for axis in axes if axis.is_driven(commanded)]


def _gain(axis: Axis, commanded: Commanded, ahead: Mapping[str, np.ndarray]) -> AxisGain:
    # One gain for all thrusters, then one for each.
    total = axis.total(commanded)
    names = [name for name, load in commanded.thrusters.items() if np.any(load[axis.number])]
    fit = axis.compared(total[None])
    apart = axis.compared(np.stack([axis.smoothed(commanded.thrusters[name]) for name in names]))
    gain = float(fit.gains[0])
    std = float(fit.std[0])
    # Direct and reverse regression bracket the gain: errors of thrust and damping bias one low, the
    # other high. Take their geometric mean.
    if gain > 0.0:
        most, most_std = axis.most_gain(total)
        if np.isfinite(most):
            middle = float(np.sqrt(gain * max(most, gain)))
            half = (
                0.5 * np.log(max(most / gain, 1.0)) / np.sqrt(3.0)
            )  # evenly likely between the two
            std = float(middle * np.sqrt(half**2 + (std / gain) ** 2 + (most_std / most) ** 2))
            gain = middle
    # Force left for the thrusters by the modelled hull and wind loads.
    other = axis.force - axis.hull - axis.wind
    error = root_mean_square(other - total) / root_mean_square(total)
    each = dict(zip(names, map(float, apart.gains), strict=True))
    each_std = dict(zip(names, map(float, apart.std), strict=True))
    ways, support = _by_way(axis, commanded, ahead)
    shares = apart.support, apart.share
    return AxisGain(axis, total, fit, gain, std, each, each_std, *shares, ways, support, error)


def _by_way(
    axis: Axis, commanded: Commanded, ahead: Mapping[str, np.ndarray]
) -> tuple[tuple | None, float]:
    """Gains of thrust ahead and astern, and what they support that are not negative; None where the log lacks a way."""
    ways = axis.by_way(commanded, ahead)
    # A way that is hardly used has no gain of its own.
    sizes = np.sqrt((ways**2).mean(1))
    if sizes.min() < LEAST_WAY * sizes.max():
        return None, 0.0
    # Gains of any sign, but the support of gains that are not negative.
    apart = axis.compared(ways)
    both = zip(map(float, apart.gains), map(float, apart.std), strict=True)
    return tuple(both), axis.explained(ways).support


@dataclass(frozen=True)
class CommonRatio:
    """A ratio of thrust to inertia, real over modelled, that is common to all thrusters and axes.

    Attributes
    ----------
    ratio, std : float
    axes : tuple of str
        That tell it.
    """

    ratio: float
    std: float
    axes: tuple[str, ...]

    def differs(self, least: float) -> bool:
        """Whether it differs from 1 by a factor of more than `least` for sure."""
        return is_beyond(self.ratio, self.std, least, SURE_OF_RATIO)


def common_ratio(gains: Sequence[AxisGain]) -> CommonRatio | None:
    """The common ratio of the axes; None if axes or thrusters contradict each other, or none shows it.

    Parameters
    ----------
    gains : sequence of AxisGain

    Returns
    -------
    CommonRatio or None
    """
    known_gains = [gain for gain in gains if gain.is_known]
    if not known_gains or not any(gain.is_off for gain in known_gains):
        return None
    # Weighted mean of the logarithms; each axis may differ from the others by COMMON_SPREAD besides
    # its own error.
    logs = np.log([gain.gain for gain in known_gains])
    stds = np.array([gain.std / gain.gain for gain in known_gains])
    weights = 1.0 / (stds**2 + COMMON_SPREAD**2)
    mean = float(weights @ logs / weights.sum())
    # No common ratio where an axis lies surely elsewhere, or its thrusters or ways differ.
    apart = np.abs(logs - mean) > SURE_OF_GAIN * stds + 2.0 * COMMON_SPREAD
    if apart.any() or not all(gain.is_common for gain in known_gains):
        return None
    # Standard error of the mean, not less than the observed spread of the axes.
    spread = float(np.sqrt(weights @ (logs - mean) ** 2 / weights.sum()))
    std = max(1.0 / np.sqrt(weights.sum()), spread)
    return CommonRatio(
        float(np.exp(mean)),
        float(np.exp(mean) * std),
        tuple(gain.axis.name for gain in known_gains),
    )
