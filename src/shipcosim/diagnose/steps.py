"""What the motion of a log leaves unexplained, step by step: position less integrated velocity, heading less rate.

    e_p = Δp - ∫ R(ψ) (u, v) dt,     e_ψ = Δψ - ∫ r dt

No model of a ship is needed: of a right log only sensor noise is left. Beside the residual stand the columns of the
small errors that every sensor has (nuisances, with the size up to which they are normal), and the integrated motion
itself, out of which suspects are made.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d

from shipcosim.diagnose.slope import FAST_SPANS, SLOW_SPANS, noise_share

__all__ = ["AXES", "Steps", "steps_of"]

AXES = ("north", "east", "heading")
STEP = 1.0  # [s] shortest step; faster logs are averaged
SLOW = 4.0  # [s] smoothing that separates the ship's own moves from the motion in waves
LONGEST = 2.1  # [s] between two rows that are integrated over, unless rows are farther apart throughout
COARSE = 1.3  # [s] between rows, beyond which waves are not resolved and only slow motion is told

# What is normal, as standard deviations. Slow: over tens of seconds; fast: in waves, where sensor filters and the
# sampling of the log act. The gains are wider where the motion is not much more than noise.
POSITION_NUISANCES = {
    "gain": 0.004,
    "fast gain": 0.15,
    "lag": 0.3,  # [s]
    "fast lag": 0.4,  # [s]
    "turn": 0.01,  # [rad] of the velocity's axes against the heading
    "surge bias": 0.01,  # [m/s]
    "sway bias": 0.01,  # [m/s]
}
HEADING_NUISANCES = {
    "rate gain": 0.004,
    "fast rate gain": 0.15,
    "rate lag": 0.3,  # [s]
    "fast rate lag": 0.4,  # [s]
    "rate bias": 3e-4,  # [rad/s]
}


@dataclass(frozen=True)
class Steps:
    """The log in steps of about a second; axes north, east, heading.

    Parameters
    ----------
    time : (n,) array
        End of each step. [s]
    residual : (n, 3) array
        Residual of the step. [m, m, rad]
    motion : (n, 3) array
        The motion that velocity and rate say; without waves where the rows are too far apart for them. [m, m, rad]
    nuisances : (n, 3, m) array
        Change of the residual by each nuisance of unit size.
    spikes : (m,) array
        Normal size of each nuisance.
    known : (n, 3) array of bool
        Whether the step has data on the axis.
    """

    time: np.ndarray
    residual: np.ndarray
    motion: np.ndarray
    nuisances: np.ndarray
    spikes: np.ndarray
    known: np.ndarray


def steps_of(log: dict[str, np.ndarray], lag: dict[str, float] | None = None) -> Steps:
    """Residual and motion of a log.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time`, increasing, and navigation roles in SI units and rad; NaN where a sample is not to be used.
    lag : dict, optional
        By how much `position`, `velocity` or `heading` is taken to be late. [s]
    """
    lag = lag or {}
    log = _undelayed(log, lag)
    spacing = np.median(np.diff(log["time"]))
    index = np.floor((log["time"] - log["time"][0]) / max(STEP, spacing) * (1 + 1e-9)).astype(int)
    occupied, index = np.unique(index, return_inverse=True)
    blocks = _Blocks(index, len(occupied), spacing)
    parts = [_position(log, blocks), _heading(log, blocks)]
    count = sum(part.shape[2] - 2 for part, _ in parts)
    stacked = np.zeros((len(occupied) - 1, 3, count + 2))
    stacked[:, :2, : parts[0][0].shape[2]] = parts[0][0]
    stacked[:, 2:, :2] = parts[1][0][:, :, :2]
    stacked[:, 2:, parts[0][0].shape[2] :] = parts[1][0][:, :, 2:]
    known = np.column_stack([parts[0][1], parts[0][1], parts[1][1]])
    residual, motion, nuisances = stacked[:, :, 0], stacked[:, :, 1], stacked[:, :, 2:]
    spikes = {**POSITION_NUISANCES, **HEADING_NUISANCES}
    for axes, prefix in ((slice(0, 2), ""), (slice(2, 3), "rate ")):
        seen, used = (residual + motion)[:, axes], motion[:, axes]
        for name, spans in ((f"{prefix}gain", SLOW_SPANS), (f"fast {prefix}gain", FAST_SPANS)):
            spikes[name] = float(np.hypot(spikes[name], 0.7 * noise_share(seen, used, known[:, axes], spans)))
    return Steps(blocks.mean(log["time"])[1:], residual, motion, nuisances, np.array([*spikes.values()]), known)


@dataclass(frozen=True)
class _Blocks:
    """Rows gathered into steps."""

    index: np.ndarray
    count: int
    spacing: float

    def mean(self, values, rows=slice(None)):
        """Mean over the rows of each block, NaN where it has none; first axis is the row."""
        index = self.index[rows]
        sums = np.zeros((self.count, *values.shape[1:]))
        np.add.at(sums, index, values)
        members = np.bincount(index, minlength=self.count).reshape(-1, *[1] * (values.ndim - 1))
        with np.errstate(invalid="ignore", divide="ignore"):
            return sums / members

    def steps(self, time, rows, sums):
        """Differences of block means of running sums (k, axes, columns), without those over holes; what is known."""
        changes = np.diff(sums, axis=0)
        changes[np.diff(time) > max(LONGEST, 1.5 * self.spacing)] = 0.0
        means = self.mean(np.concatenate([np.zeros_like(sums[:1]), np.cumsum(changes, axis=0)]), rows)
        filled = np.isfinite(means[:, 0, 0])
        steps = np.zeros((self.count - 1, *sums.shape[1:]))
        here = np.flatnonzero(filled)
        steps[here[1:] - 1] = np.diff(means[here], axis=0)
        known = np.zeros(self.count - 1, bool)
        known[here[1:] - 1] = True
        return steps, known


def _usable(log, roles):
    if not all(role in log for role in roles):
        return np.zeros(0, int)
    rows = np.flatnonzero(np.all([np.isfinite(log[role]) for role in roles], axis=0))
    return rows if len(rows) > 30 else np.zeros(0, int)


def _position(log, blocks):
    rows = _usable(log, ("north", "east", "heading", "surge", "sway"))
    if not len(rows):
        return np.zeros((blocks.count - 1, 2, 2 + len(POSITION_NUISANCES))), np.zeros(blocks.count - 1, bool)
    time, heading = log["time"][rows], log["heading"][rows]
    cosine, sine = np.cos(heading), np.sin(heading)
    surge, sway = log["surge"][rows], log["sway"][rows]
    velocity = np.column_stack([cosine * surge - sine * sway, sine * surge + cosine * sway])
    slow = _slow(velocity, time)
    way, slow_way = _integral(time, velocity), _integral(time, slow)
    ahead = _integral(time, np.column_stack([cosine, sine]))
    aside = _integral(time, np.column_stack([-sine, cosine]))
    turned = np.column_stack([-slow_way[:, 1], slow_way[:, 0]])
    fixed = np.column_stack([log["north"][rows], log["east"][rows]])
    told = slow_way if blocks.spacing > COARSE else way
    columns = [fixed - way, told, slow_way, way - slow_way, -slow, slow - velocity, turned, ahead, aside]
    return blocks.steps(time, rows, np.stack(columns, axis=2))


def _heading(log, blocks):
    rows = _usable(log, ("heading", "yaw_rate"))
    if not len(rows):
        return np.zeros((blocks.count - 1, 1, 2 + len(HEADING_NUISANCES))), np.zeros(blocks.count - 1, bool)
    time, rate = log["time"][rows], log["yaw_rate"][rows]
    slow = _slow(rate, time)
    turn, slow_turn = _integral(time, rate), _integral(time, slow)
    told = slow_turn if blocks.spacing > COARSE else turn
    columns = [np.unwrap(log["heading"][rows]) - turn, told, slow_turn, turn - slow_turn, -slow, slow - rate, time]
    return blocks.steps(time, rows, np.stack(columns, axis=1)[:, None, :])


def _slow(values, time):
    return gaussian_filter1d(values, SLOW / np.median(np.diff(time)), axis=0)


def _integral(time, values):
    """Running integral; a spline, since the trapezium loses a tenth of a wave of 6 s at 1 Hz."""
    return CubicSpline(time, values).antiderivative()(time)


def _undelayed(log, lag):
    """The log with the late channels put back in time."""
    groups = {"position": ("north", "east"), "velocity": ("surge", "sway"), "heading": ("heading",)}
    log = dict(log)
    for group, late in lag.items():
        for role in groups[group]:
            values = np.unwrap(np.nan_to_num(log[role])) if role == "heading" else log[role]
            moved = np.interp(log["time"] + late, log["time"], values, right=np.nan, left=np.nan)
            log[role] = np.where(np.isfinite(log[role]), moved, np.nan)
    return log
