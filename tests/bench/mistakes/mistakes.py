"""The mistakes: what each makes of a log, and what should be said of it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

KNOT = 1852.0 / 3600.0
VELOCITY, POSITION = ("surge", "sway"), ("north", "east")


@dataclass(frozen=True)
class Mistake:
    """A mistake in a log.

    Attributes
    ----------
    make : callable
        From a log, a dict of arrays by role, to the channels with the mistake in them.
    cause : str
        How it is to be named.
    channels : tuple of str
    rate : float or None
        Of a clock: true seconds per logged second.
    said : str
        How a reading that is left open says it.
    """

    make: Callable[[dict], dict]
    cause: str
    channels: tuple[str, ...]
    rate: float | None = None
    said: str = ""

    @property
    def needs_both(self) -> bool:
        """Whether it takes position and heading to tell it from a scale of one sensor: a clock some per cent off."""
        return self.rate is not None and 0.9 < self.rate < 1.1


def _clock(factor, said):
    return Mistake(
        lambda log: {"time": factor * log["time"]}, "clock", ("time",), 1.0 / factor, said
    )


def _unit(channels, factor, unit):
    said = f"{' and '.join(channels)} {'are' if len(channels) > 1 else 'is'} in {unit}"
    return Mistake(
        lambda log: {role: factor * log[role] for role in channels}, "frame", channels, said=said
    )


def _sign(role):
    angle = role in ("heading", "wind_from")

    def make(log):
        return {role: np.mod(-log[role], 360.0) if angle else -log[role]}

    return Mistake(make, "sign", (role,), said=f"{role} has the other sign")


def _frame(make, channels, said):
    return Mistake(make, "frame", channels, said=said)


def _swap(one, other):
    said = f"{one} and {other} are swapped"
    return Mistake(
        lambda log: {one: log[other], other: log[one]}, "channel_swap", (one, other), said=said
    )


def _heading_from_east(log):
    return {"heading": np.mod(90.0 - log["heading"], 360.0)}


def _velocity_over_earth(log):
    velocity = (log["surge"] + 1j * log["sway"]) * np.exp(1j * np.radians(log["heading"]))
    return {"surge": velocity.real, "sway": velocity.imag}


TOWARDS_NORTH = "surge and sway are the velocity towards north and east"


def _degrees(log):
    return {
        "north": log["north"] / 111195.0 + 59.9,
        "east": log["east"] / 111195.0 / np.cos(np.radians(59.9)) + 10.7,
    }


def _turned(log):
    """The grid turned by 10 to 80 degrees, told by the length of the log."""
    angle = np.radians(10.0 + 70.0 * (0.618 * len(log["time"]) % 1.0))
    position = (log["north"] + 1j * log["east"]) * np.exp(1j * angle)
    return {"north": position.real, "east": position.imag}


MISTAKES = {
    "time in ms": _clock(1000.0, "time is in ms"),
    "time in minutes": _clock(1.0 / 60.0, "time is in min"),
    "time in tenths": _clock(10.0, "time is in tenths of a second"),
    "time halved": _clock(0.5, "2 s pass in each logged second"),
    "time doubled": _clock(2.0, "0.5 s pass in each logged second"),
    "clock 6 % fast": _clock(1.06, "the clock runs wrong throughout"),
    "clock 4 % slow": _clock(0.96, "the clock runs wrong throughout"),
    "velocity in kn": _unit(VELOCITY, 1.0 / KNOT, "kn"),
    "velocity in km/h": _unit(VELOCITY, 3.6, "km/h"),
    "velocity in ft/s": _unit(VELOCITY, 1.0 / 0.3048, "ft/s"),
    "heading in rad": _unit(("heading",), np.pi / 180.0, "rad"),
    "rate in rad/s": _unit(("yaw_rate",), np.pi / 180.0, "rad/s"),
    "rate in deg/min": _unit(("yaw_rate",), 60.0, "deg/min"),
    "position in km": _unit(POSITION, 1e-3, "km"),
    "position in ft": _unit(POSITION, 1.0 / 0.3048, "ft"),
    "position in degrees": _frame(
        _degrees, POSITION, "north and east are degrees of latitude and longitude"
    ),
    "sign of surge": _sign("surge"),
    "sign of sway": _sign("sway"),
    "sign of rate": _sign("yaw_rate"),
    "sign of east": _sign("east"),
    "sign of north": _sign("north"),
    "heading counter-clockwise": _sign("heading"),
    "heading from east": _frame(
        _heading_from_east, ("heading",), "heading is counted counter-clockwise from east"
    ),
    "north and east swapped": _swap("north", "east"),
    "surge and sway swapped": _swap("surge", "sway"),
    "velocity over earth": _frame(
        _velocity_over_earth, VELOCITY, "surge and sway are the velocity towards north and east"
    ),
    "grid turned": _frame(
        _turned, POSITION, "north and east are turned against heading and velocities"
    ),
}


def with_mistakes(log, names):
    """The log with some mistakes in it, one after the other; headings are wrapped again where their unit is not."""
    for name in names:
        log = log | MISTAKES[name].make(log)
    return log


def draw_mistakes(rng, count):
    """Names of mistakes that are in different channels, and of which no one needs what another spoils."""
    while True:
        names = [str(name) for name in rng.choice(list(MISTAKES), count, replace=False)]
        channels = [role for name in names for role in MISTAKES[name].channels]
        needs_right = {"velocity over earth": {"heading"}}
        spoilt = [needs_right.get(name, set()) & set(channels) for name in names]
        if len(channels) == len(set(channels)) and not any(spoilt):
            return tuple(names)
