"""The log of the 2022 trials, examined: what it holds, what is wrong with it, and the windows taken from it."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

STEP = 0.5  # s, of the log
CIRCLE_ORDER, CIRCLE_TIME = 8.0, 100.0  # deg, s: a larger order held for longer is a turning circle
JUMP = 20.0  # m from one row to the next: rows are lost
WRAPPING = 8.0  # deg from one row to the next: interpolated across 0/360

STRAIGHT = {  # rpm: two legs in opposite directions [s]; constant orders, speed settled, azimuth within 1 deg
    110: ((5400.0, 5500.0), (6300.0, 6500.0)),
    170: ((350.0, 480.0), (1100.0, 1200.0)),
    205: ((8550.0, 8690.0), (7850.0, 7950.0)),
}
ZIG_ZAGS = {  # name: (order, heading of the helm change in deg, from, to in s)
    "10/10 at 171 rpm": (10.0, 10.0, 4390.0, 4543.0),
    "10/20 at 170 rpm": (10.0, 20.0, 1940.0, 2187.0),
    "10/20 at 110 rpm": (10.0, 20.0, 3350.0, 3642.0),
    "20/20 at 171 rpm": (20.0, 20.0, 4158.0, 4212.5),
}


@dataclass(frozen=True)
class Log:
    """Columns of the log, SI and rad, headings unwrapped.

    Parameters
    ----------
    time, north, east, psi, u, v, r, azimuth : (n,) arrays
        As logged; u and v over ground, not rescaled.
    rpm : (n,) array
        Order. [rpm]
    """

    time: np.ndarray
    north: np.ndarray
    east: np.ndarray
    psi: np.ndarray
    u: np.ndarray
    v: np.ndarray
    r: np.ndarray
    azimuth: np.ndarray
    rpm: np.ndarray

    def part(self, start, end):
        """Rows of a window in s, both ends included."""
        first = float(self.time[0])
        rows = slice(round((start - first) / STEP), round((end - first) / STEP) + 1)
        return Log(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def read(shared):
    """The log, its heading without the samples interpolated across 0/360."""
    path = shared / "measured/gunnerus_trials_2022/trials.csv"
    run = {name: column.to_numpy() for name, column in pd.read_csv(path).items()}
    time, psi = run["tvec"], run["psi"]
    fast = np.abs(np.diff(psi)) > WRAPPING
    good = np.ones(len(psi), bool)
    good[1:-1] = ~(fast[:-1] & fast[1:])
    psi = np.interp(time, time[good], np.unwrap(np.radians(psi[good])))
    r, azimuth = np.radians(run["r"]), np.radians(run["Azi"])
    return Log(time, run["N"], run["E"], psi, run["u"], run["v"], r, azimuth, run["RPM"])


def lost(log):
    """Where the position jumps: first and last time of each run of jumps. [s]"""
    times = log.time[:-1][np.hypot(np.diff(log.north), np.diff(log.east)) > JUMP]
    groups = np.split(times, np.flatnonzero(np.diff(times) > 5.0) + 1)
    return [(group[0], group[-1] + STEP) for group in groups]


def speed_ratio(log):
    """Speed from positions over logged speed: the median, since positions come in uneven steps. [1]"""
    way = np.hypot(np.diff(log.north), np.diff(log.east))
    speed = np.hypot(log.u, log.v)
    return float(np.median(way / (0.5 * STEP * (speed[1:] + speed[:-1]))))


def clock_ratio(log):
    """Heading turned, to and fro, over the integral of the logged yaw rate: 1 where rows are 0.5 s apart. [1]"""
    turning = np.abs(log.r) > np.radians(0.3)
    return float(
        np.sum(np.abs(np.diff(log.psi))[turning[1:]]) / (STEP * np.sum(np.abs(log.r)[turning]))
    )


def circles(log):
    """Windows of the turning circles: (start of the order, end) in s."""
    large = np.abs(log.azimuth) > np.radians(CIRCLE_ORDER)
    edges = np.flatnonzero(np.diff(np.concatenate(([0], large.astype(int), [0]))))
    return [
        (_start_of_order(log, first), log.time[last - 1])
        for first, last in zip(edges[::2], edges[1::2], strict=True)
        if (last - first) * STEP >= CIRCLE_TIME
    ]


def _start_of_order(log, row):
    """Time at which the order that is large at a row began to move."""
    rest = np.median(log.azimuth[row - 60 : row - 20])
    while abs(log.azimuth[row - 1] - rest) > np.radians(2.0):
        row -= 1
    return float(log.time[row - 1])
