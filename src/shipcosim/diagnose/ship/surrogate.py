"""The surrogate of a third-party FMU: its loads over a log, and their derivatives by all inputs and parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from shipcosim.diagnose.numerics import between, places
from shipcosim.models.core.maths import Arithmetic
from shipcosim.models.core.motion import Load

_MET = 4  # sets of times whose loads are kept: a few MB each
_OFFSETS = (("rpm", "rpm_offset", -1.0), ("azimuth", "azimuth_offset", 1.0))
"""Offsets of the inputs: quantity, number of the part, sign."""


@dataclass(frozen=True)
class ThirdPartyPart:
    """Numbers of the part of a third-party FMU; `part_of` gives it its fields."""


class QuadraticThrust(NamedTuple):
    """Thrust that is proportional to the squared speed of a propeller, along an axis, at a place.

    Attributes
    ----------
    ahead, astern : float
        0 where the log does not show it. [N/rpm2]
    axis : float
        Direction of the thrust, added to that of a unit that turns. [rad]
    x, y : float
        [m]
    """

    ahead: float = 0.0
    astern: float = 0.0
    axis: float = 0.0
    x: float = 0.0
    y: float = 0.0

    def loads(self, rpm: Arithmetic, azimuth: Arithmetic) -> tuple[Load, Load, Load]:
        """Loads on the ship [N, N, N.m], and their derivatives by speed [rpm] and direction [rad]."""
        # Unit vectors of the load along the thrust and across it, with their moments x Fy - y Fx.
        c = np.cos(self.axis + azimuth)
        s = np.sin(self.axis + azimuth)
        # Quadratic law T = c n |n|, with the coefficient of
        # the direction of rotation, and its slope 2 c |n|.
        share = np.where(rpm >= 0.0, self.ahead, self.astern)
        along = (c, s, self.x * s - self.y * c)
        across = (-s, c, self.x * c + self.y * s)
        thrust = share * rpm * np.abs(rpm)
        slope = 2.0 * share * np.abs(rpm)
        return _times(thrust, along), _times(slope, along), _times(thrust, across)


def _times(size: Arithmetic, load: Load) -> Load:
    surge, sway, yaw = load
    return size * surge, size * sway, size * yaw


@dataclass(frozen=True, eq=False)
class Surrogate:
    """Loads over a log: a quadratic law of thrust, and the rest linear in all inputs and parameters.

    Attributes
    ----------
    time : (k,) array
        Even; holes of the log are left out. [s]
    about : dict of str to (k,) array
        What the FMU was fed with, by quantity. [rpm, N, rad, m, m/s, rad/s]
    nominal : dict of str to float
        Its parameters that have slopes.
    rest : (1 + q + p, 3, k) array
        Load less that of the quadratic law, then its derivatives by each of `about`, by each of `nominal`.
    thrust : QuadraticThrust
    rpm_max : float
        Largest speed, the FMU's or the log's. [rpm]
    rows : (n,) array
        Times of the log's rows. [s]
    met : dict
        `about` and `rest` at times asked for last: a linearisation asks for the same ones column by column.
    """

    time: np.ndarray
    about: dict[str, np.ndarray]
    nominal: dict[str, float]
    rest: np.ndarray
    thrust: QuadraticThrust
    rpm_max: float
    rows: np.ndarray
    met: dict[bytes, tuple[list[np.ndarray], np.ndarray]] = field(
        default_factory=dict, init=False, repr=False
    )

    def loads(
        self, time: np.ndarray, given: Mapping[str, Arithmetic], part: ThirdPartyPart
    ) -> Load:
        """Loads on the ship.

        Parameters
        ----------
        time : array
            [s]
        given : dict of str to array
            By quantity, at these times.
        part : ThirdPartyPart

        Returns
        -------
        tuple of three arrays
            X, Y, N. [N, N, N.m]
        """
        # Co-simulated loads and slopes at these times.
        about, rest = self._at(time)
        # Offsets are errors of the log: correct the inputs that were given.
        inputs = {
            name: given[name] + sign * getattr(part, off)
            for name, off, sign in _OFFSETS
            if name in given and hasattr(part, off)
        }
        given = {**given, **inputs}
        # Linear expansion about the inputs and parameters of the co-simulation.
        loads = list(rest[0])
        off = [given[name] - value for name, value in zip(self.about, about, strict=True)]
        off += [getattr(part, name) - value for name, value in self.nominal.items()]
        for deviation, slopes in zip(off, rest[1:], strict=True):
            loads = [load + slope * deviation for load, slope in zip(loads, slopes, strict=True)]
        # The quadratic thrust law holds for large changes of speed and direction.
        if "rpm" in self.about:
            ideal = self.thrust.loads(given["rpm"], given["azimuth"])[0]
            loads = [load + more for load, more in zip(loads, ideal, strict=True)]
        # A loss of thrust scales the whole load.
        kept = 1.0 - getattr(part, "thrust_loss", 0.0)
        surge, sway, yaw = loads
        return kept * surge, kept * sway, kept * yaw

    def _at(self, time: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
        """`about` and `rest` at some times."""
        # Interpolate linearly between the times of the
        # co-simulation, and keep the result for the next call.
        key = np.asarray(time, float).tobytes()
        interpolated = self.met.get(key)
        if interpolated is None:
            at = (without_holes(self.rows, time) - self.time[0]) / (self.time[1] - self.time[0])
            at = places(at, self.time.size)
            about = [between(values, *at) for values in self.about.values()]
            interpolated = (about, between(self.rest, *at))
            if len(self.met) >= _MET:
                self.met.clear()
            self.met[key] = interpolated
        return interpolated


def without_holes(rows: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Times of a log as if its stretches followed each other at the even times of their rows."""
    return rows[0] + (rows[1] - rows[0]) * np.interp(time, rows, np.arange(rows.size))
