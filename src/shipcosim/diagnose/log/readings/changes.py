"""Ways in which channels can be other than labelled, each with its effect on the relations and with a cost.

A cost is minus the logarithm of how often logs have such a mistake: 5 is one log in 150. The costs are assumed, from
what is ordinary: knots, radians and milliseconds are mistaken more often than feet or hours. What a header states is
wrong less often than what nobody stated.
"""

import cmath
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

from shipcosim.diagnose.log.mislabels import (
    AXES_TURNED,
    CHANNEL_UNITS,
    HEADING_FROM_EAST,
    POSITION_IN_DEGREES,
    TURNED,
    Mislabel,
    mislabel_of_unit,
    negative,
    swap_of,
    velocity_frame,
)
from shipcosim.diagnose.log.roles import POSITION, VELOCITY


@dataclass(frozen=True)
class LogInterpretation:
    """How the channels of a log are read, as factors of complex numbers; `mirrored`: the conjugate is taken first.

    Attributes
    ----------
    position, heading, velocity : complex
        Factors of the position, of exp(i heading), and of the velocity.
    mirrored : frozenset of str
        Those of the three of which the conjugate is taken.
    earth : bool
        Whether surge and sway are velocities over an earth-fixed frame.
    degrees : bool
        Whether positions are degrees of latitude and longitude.
    heading_unit, rate, time : float
        Factors of the heading's unit, of the yaw rate with its sign, of the time.
    free : frozenset of str
        ``"angle"`` where the angle of frames may have any value; with ``"axes"`` it is one of surge and sway.
    """

    position: complex = 1.0
    heading: complex = 1.0
    velocity: complex = 1.0
    mirrored: frozenset[str] = frozenset()
    earth: bool = False
    degrees: bool = False
    heading_unit: float = 1.0
    rate: float = 1.0
    time: float = 1.0
    free: frozenset[str] = frozenset()

    @cached_property
    def form(self) -> tuple[str, str]:
        """The form of the velocity in which it is proportional to the change of position."""
        # Mirroring the position is the same as mirroring velocity and heading
        # instead, so only the difference between them and the position counts.
        flipped = "position" in self.mirrored
        taken = "mirrored" if ("velocity" in self.mirrored) != flipped else "as is"
        turned = "mirrored" if ("heading" in self.mirrored) != flipped else "body"
        return taken, "earth" if self.earth else turned

    @cached_property
    def factor(self) -> complex:
        """Logarithm of the factor between the change of position and that form."""
        # The change of position is p_dot = w E for velocity w and
        # E = exp(i heading); over the earth no heading turns it.
        turning = 1.0 if self.earth else self.heading
        factor = self.time * self.velocity * turning / self.position
        # A mirrored position conjugates the whole equation, and with it the factor.
        factor = complex(factor).conjugate() if "position" in self.mirrored else complex(factor)
        return complex(math.log(abs(factor)), math.atan2(factor.imag, factor.real))

    def course(self, courses: dict[tuple[bool, bool], complex], angle: float) -> complex:
        """Mean direction in which the craft goes against her bow, as a complex number of length 1 at most.

        Parameters
        ----------
        courses : dict of (bool, bool) to complex
            As logged: whether surge and sway are over the earth, and whether the heading is mirrored then.
        angle : float
            By how much the change of position is turned against this reading. [rad]
        """
        # Bring the logged mean course into the axes of
        # this interpretation: mirror it, then turn it.
        flipped = "velocity" in self.mirrored
        mirrored = "heading" in self.mirrored
        course = courses[self.earth, self.earth and (mirrored != flipped)]
        course = course.conjugate() if flipped else course
        turn = complex(self.velocity) * (complex(self.heading).conjugate() if self.earth else 1.0)
        # Only the angle counts. A free angle of the axes
        # is set to the angle that the positions show.
        return course * turn / abs(turn) * (cmath.exp(1j * angle) if "axes" in self.free else 1.0)

    @property
    def rate_factor(self) -> float:
        """The factor between the change of heading and the integral of the yaw rate."""
        return self.time * self.rate * (-1.0 if "heading" in self.mirrored else 1.0)


@dataclass(frozen=True)
class Slab:
    """Prior standard deviation of the logarithm of a factor that may have any value."""

    of: str
    std: float


@dataclass(frozen=True)
class LogMistake:
    """One mistake.

    Attributes
    ----------
    slot : str
        What it is about; a log has one mistake of a slot at most.
    cost : float
        [nats]
    apply : callable
        From a reading to the one with it.
    mislabel : Mislabel or None
        What it is in the log; None of the time base, and where it cannot be corrected.
    sentence : str
    slab : Slab or None
        Where its factor may have any value.
    or_else : tuple of str
        What explains the same and cannot be told apart by any log; then neither is named (but see COMPASS_OFF).
    """

    slot: str
    cost: float
    apply: Callable[[LogInterpretation], LogInterpretation] = field(compare=False)
    mislabel: Mislabel | None
    sentence: str
    slab: Slab | None = None
    or_else: tuple[str, ...] = ()

    @property
    def channels(self) -> tuple[str, ...]:
        """Roles of the channels that it is in."""
        if self.mislabel is not None:
            return self.mislabel.channels
        return ("time",) if self.slot == "time" else SLOT_CHANNELS[self.slot]

    @property
    def cause(self) -> str:
        """What it is called."""
        return (
            self.mislabel.cause
            if self.mislabel is not None
            else "clock"
            if self.slot == "time"
            else "frame"
        )


FACTOR_OF = {
    VELOCITY: "velocity",
    POSITION: "position",
    ("heading",): "heading_unit",
    ("yaw_rate",): "rate",
}
SLOT_CHANNELS = {"unit of velocity": VELOCITY, "unit of rate": ("yaw_rate",), "turned": POSITION}
SLOT_CHANNELS |= {"axes turned": VELOCITY}
CLOCK = "the clock runs wrong throughout"
STATED = 2.0  # more, where a header or a channel file states the unit [nats]; assumed
UNIT_COSTS = {"kn": 5.0, "km/h": 5.0, "m/s": 5.0, "ft/s": 6.5, "mph": 7.0, "cm/s": 6.5, "mm/s": 7.0}
UNIT_COSTS |= {"m": 6.0, "km": 6.0, "ft": 6.5, "nmi": 7.0, "cm": 7.0, "mm": 7.0}
UNIT_COSTS |= {"deg": 5.0, "rad": 5.0, "deg/s": 5.0, "rad/s": 4.5, "deg/min": 6.0, "rpm": 7.5}
TIME_COSTS = {
    "ms": (1e-3, 5.5),
    "s": (1.0, 5.5),
    "min": (60.0, 6.5),
    "h": (3600.0, 8.0),
    "us": (1e-6, 7.0),
}
TIME_COSTS |= {
    "ns": (1e-9, 8.0),
    "tenths of a second": (0.1, 7.0),
    "hundredths of a second": (0.01, 8.0),
}
FACTORS = {2.0: 6.5, 0.5: 6.5, 10.0: 8.0}  # of true over logged time
ODD_FACTORS = {2.0: 8.0, 0.5: 8.0, 10.0: 8.0, 0.1: 8.0}  # of a velocity or a rate
ODD_UNITS = (
    ("velocity", "surge and sway", "are", "north and east are in another unit, or badly scaled"),
    ("rate", "yaw_rate", "is", "heading is in another unit, or badly scaled"),
)
"""What may be in an odd unit, its channels in words, and what looks the same."""


def _factor_of(name, factor):
    return lambda reading: replace(reading, **{name: getattr(reading, name) * factor})


def _mirrored(name: str, factor: complex = 1.0):
    def apply(reading):
        return replace(reading, **{name: factor}, mirrored=reading.mirrored | {name})

    return apply


def _label(slot, cost, apply, mislabel):
    return LogMistake(slot, cost, apply, mislabel, mislabel.sentence)


def changes(stated: dict[str, str]) -> list[LogMistake]:
    """All changes, for a log of which some units are stated, by role; the role's unit elsewhere."""
    return [*_time(stated.get("time")), *_units(stated), *_frames(), *_odd(stated)]


def _time(stated):
    # Factors are relative to the unit that is stated,
    # or to seconds. A stated unit is less often wrong.
    stated_factor = TIME_COSTS.get(stated or "s", (1.0, 0.0))[0]
    extra = STATED * bool(stated)
    for unit, (factor, cost) in TIME_COSTS.items():
        if factor != stated_factor:
            sentence = f"time is in {unit}, not {stated or 's'}"
            yield LogMistake(
                "time", cost + extra, _factor_of("time", factor / stated_factor), None, sentence
            )
    # Clocks that run at a usual wrong rate, such as twice too fast.
    for factor, cost in FACTORS.items():
        message = f"{factor:g} s pass in each logged second"
        yield LogMistake("time", cost, _factor_of("time", factor), None, message)
    # A clock of any rate: a narrow prior for small errors, and a wide one that costs more.
    for std, cost in ((0.05, 5.5), (1.5, 8.0)):
        yield LogMistake("time", cost, lambda reading: reading, None, CLOCK, Slab("time", std))


def _units(stated) -> Iterator[LogMistake]:
    for channels, units in CHANNEL_UNITS.items():
        # Without a stated unit the first one listed, the unit of the role, is assumed.
        given = stated.get(channels[0])
        stated_unit = given if given in units else next(iter(units))
        extra = STATED * bool(given)
        for unit in units:
            if unit != stated_unit:
                label = mislabel_of_unit(channels, unit, stated_unit)
                name = FACTOR_OF[channels]
                yield _label(
                    f"unit of {name}",
                    UNIT_COSTS[unit] + extra,
                    _factor_of(name, label.scale),
                    label,
                )


def _frames() -> Iterator[LogMistake]:
    to_degrees = lambda reading: replace(reading, degrees=True)  # noqa: E731
    yield _label("unit of position", 6.0, to_degrees, POSITION_IN_DEGREES)
    yield _label("position", 5.0, _mirrored("position", 1j), swap_of(*POSITION))
    yield _label("position", 5.5, _mirrored("position", -1.0), negative("north"))
    yield _label("position", 5.0, _mirrored("position"), negative("east"))
    yield _label("heading", 5.5, _mirrored("heading"), negative("heading"))
    yield _label("heading", 5.5, _mirrored("heading", 1j), HEADING_FROM_EAST)
    yield _label("velocity", 5.5, _mirrored("velocity", 1j), swap_of(*VELOCITY))
    yield _label("velocity", 5.0, _mirrored("velocity", -1.0), negative("surge"))
    yield _label("velocity", 5.0, _mirrored("velocity"), negative("sway"))
    yield _label(
        "axes", 5.0, lambda reading: replace(reading, earth=True), velocity_frame("north", "east")
    )
    east_north = lambda reading: _mirrored("velocity", 1j)(replace(reading, earth=True))  # noqa: E731
    yield _label("velocity", 6.0, east_north, velocity_frame("east", "north"))
    yield _label("sign of rate", 4.5, _factor_of("rate", -1.0), negative("yaw_rate"))


def _freed(reading, what):
    return replace(reading, free=reading.free | {what})


def _odd(stated) -> Iterator[LogMistake]:
    """Readings without a name or correction, which a named reading must beat."""
    for name, what, verb, similar in ODD_UNITS:
        # Units that a header states are wrong less often, so these mistakes cost more then.
        slot = f"unit of {name}"
        extra = STATED * bool(stated.get(SLOT_CHANNELS[slot][0]))
        # Usual wrong factors that belong to no unit.
        for factor, cost in ODD_FACTORS.items():
            apply = _factor_of(name, factor)
            message = f"{what} must be multiplied by {factor:.3g}"
            yield LogMistake(slot, cost + extra, apply, None, message, None, (similar,))
        # Factors of any size, with a wide prior of their logarithm.
        message = f"{what} {verb} in an unknown unit, or badly scaled"
        slab = Slab(name, 1.5)
        yield LogMistake(
            slot, 8.0 + extra, lambda reading: reading, None, message, slab, (similar,)
        )
    # An angle between the grid and the heading looks the same as an error of the heading.
    yield LogMistake(
        "turned",
        6.5,
        lambda r: _freed(r, "angle"),
        None,
        TURNED,
        None,
        ("the heading is off by that angle",),
    )
    axes = lambda r: _freed(_freed(r, "angle"), "axes")  # noqa: E731
    yield LogMistake("axes turned", 8.5, axes, None, AXES_TURNED)
