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
    """

    make: Callable[[dict], dict]
    cause: str
    channels: tuple[str, ...]
    rate: float | None = None


def _clock(factor):
    return Mistake(lambda log: {"time": factor * log["time"]}, "clock", ("time",), 1.0 / factor)


def _unit(channels, factor):
    return Mistake(lambda log: {role: factor * log[role] for role in channels}, "frame", channels)


def _sign(role):
    angle = role in ("heading", "wind_from")
    return Mistake(lambda log: {role: np.mod(-log[role], 360.0) if angle else -log[role]}, "sign", (role,))


def _swap(one, other):
    return Mistake(lambda log: {one: log[other], other: log[one]}, "channel_swap", (one, other))


def _heading_from_east(log):
    return {"heading": np.mod(90.0 - log["heading"], 360.0)}


def _velocity_over_earth(log):
    velocity = (log["surge"] + 1j * log["sway"]) * np.exp(1j * np.radians(log["heading"]))
    return {"surge": velocity.real, "sway": velocity.imag}


def _degrees(log):
    return {"north": log["north"] / 111195.0 + 59.9, "east": log["east"] / 111195.0 / np.cos(np.radians(59.9)) + 10.7}


def _turned(log):
    """The grid turned by 10 to 80 degrees, told by the log itself."""
    angle = np.radians(10.0 + 70.0 * (np.abs(log["north"][-1]) % 1.0))
    position = (log["north"] + 1j * log["east"]) * np.exp(1j * angle)
    return {"north": position.real, "east": position.imag}


MISTAKES = {
    "time in ms": _clock(1000.0),
    "time in minutes": _clock(1.0 / 60.0),
    "time in tenths": _clock(10.0),
    "time halved": _clock(0.5),
    "time doubled": _clock(2.0),
    "clock 6 % fast": _clock(1.06),
    "clock 4 % slow": _clock(0.96),
    "velocity in kn": _unit(VELOCITY, 1.0 / KNOT),
    "velocity in km/h": _unit(VELOCITY, 3.6),
    "velocity in ft/s": _unit(VELOCITY, 1.0 / 0.3048),
    "heading in rad": _unit(("heading",), np.pi / 180.0),
    "rate in rad/s": _unit(("yaw_rate",), np.pi / 180.0),
    "rate in deg/min": _unit(("yaw_rate",), 60.0),
    "position in km": _unit(POSITION, 1e-3),
    "position in ft": _unit(POSITION, 1.0 / 0.3048),
    "position in degrees": Mistake(_degrees, "frame", POSITION),
    "sign of surge": _sign("surge"),
    "sign of sway": _sign("sway"),
    "sign of rate": _sign("yaw_rate"),
    "sign of east": _sign("east"),
    "sign of north": _sign("north"),
    "heading counter-clockwise": _sign("heading"),
    "heading from east": Mistake(_heading_from_east, "frame", ("heading",)),
    "north and east swapped": _swap("north", "east"),
    "surge and sway swapped": _swap("surge", "sway"),
    "velocity over earth": Mistake(_velocity_over_earth, "frame", VELOCITY),
    "grid turned": Mistake(_turned, "frame", POSITION),
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
