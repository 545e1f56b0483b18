"""Possible mislabels of a channel, and their corrections."""

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from shipcosim.diagnose.finding import Finding, Segment, log_fault
from shipcosim.diagnose.log.checks.samples import noise_of, quantum
from shipcosim.diagnose.log.degree_size import local_plane
from shipcosim.diagnose.log.roles import POSITION, VELOCITY
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.numerics import finite

THRUSTER_LABELS = ("channel_swap", "sign")
"""What can be wrong of the labels of what drives thrusters."""
DRIVES = ("_rpm", "_thrust", "_azimuth")
"""How roles of what drives a thruster end."""
KNOT = 1852.0 / 3600.0  # m/s
WIND = ("wind_speed", "wind_from")
ANGLES = ("heading", "wind_from")
CHANNEL_UNITS = {
    VELOCITY: {
        "m/s": 1.0,
        "kn": KNOT,
        "km/h": 1.0 / 3.6,
        "ft/s": 0.3048,
        "mph": 0.44704,
        "cm/s": 0.01,
        "mm/s": 1e-3,
    },
    POSITION: {"m": 1.0, "km": 1e3, "ft": 0.3048, "nmi": 1852.0, "cm": 0.01, "mm": 1e-3},
    ("heading",): {"deg": 1.0, "rad": float(np.degrees(1.0))},
    ("yaw_rate",): {
        "deg/s": 1.0,
        "rad/s": float(np.degrees(1.0)),
        "deg/min": 1.0 / 60.0,
        "rpm": 6.0,
    },
}
"""Units in which channels can be, and their size in the role's unit, which comes first."""
TURNED = "north and east are turned against heading and velocities"
AXES_TURNED = "surge and sway are turned against the ship"


@dataclass(frozen=True)
class Mislabel:
    """A fault of labels.

    Attributes
    ----------
    cause : str
        ``"sign"``, ``"channel_swap"``, ``"frame"`` or ``"channel_lag"``.
    channels : tuple of str
        Roles of the channels that it concerns.
    sentence : str
        What it says of the log; the note of a finding.
    undo : callable
        From the log, a dict of arrays by role in their units, to the channels as they should be.
    scale : float or None
        For units: what the channels must be multiplied by.
    """

    cause: str
    channels: tuple[str, ...]
    sentence: str
    undo: Callable[[dict], dict] = field(compare=False)
    scale: float | None = None


def negative(role: str) -> Mislabel:
    """A channel with the other sign; an angle stays within a full turn."""
    return Mislabel("sign", (role,), f"{role} has the other sign", partial(_negated, role))


def _negated(role, log):
    return {role: np.mod(-log[role], 360.0) if role in ANGLES else -log[role]}


def exchanged(pairs: Sequence[tuple[str, str]]) -> Mislabel:
    """Channels of two thrusters that are exchanged, by pairs of roles."""
    channels = tuple(role for side in zip(*pairs, strict=True) for role in side)
    names = " and ".join(" with ".join(pair) for pair in pairs)
    undo = partial(_swapped, pairs)
    return Mislabel("channel_swap", channels, f"{names} are swapped", undo)


def swap_of(first: str, other: str) -> Mislabel:
    """Two channels exchanged."""
    undo = partial(_swapped, [(first, other)])
    return Mislabel("channel_swap", (first, other), f"{first} and {other} are swapped", undo)


def _swapped(pairs, log):
    return {a: log[b] for a, b in pairs} | {b: log[a] for a, b in pairs}


def mislabel_of_unit(channels: tuple[str, ...], unit: str, stated: str) -> Mislabel:
    """Channels of CHANNEL_UNITS in a unit other than the one that they were read in."""
    units = CHANNEL_UNITS[channels]
    verb = "are" if len(channels) > 1 else "is"
    return _in_unit(
        channels,
        units[unit] / units[stated],
        f"{' and '.join(channels)} {verb} in {unit}, not {stated}",
    )


def _in_unit(roles, scale, sentence):
    return Mislabel("frame", roles, sentence, partial(_scaled, roles, scale), scale)


def _scaled(roles, scale, log):
    return {role: scale * log[role] for role in roles}


def _turned_to_body(roles, north, east, heading):
    cosine = np.cos(np.radians(heading))
    sine = np.sin(np.radians(heading))
    return dict(
        zip(roles, (cosine * north + sine * east, cosine * east - sine * north), strict=True)
    )


def velocity_frame(first: str, second: str) -> Mislabel:
    """Velocities over the earth in the columns of the ship's: the first is towards north, or towards east."""
    message = f"surge and sway are the velocity towards {first} and {second}"
    return Mislabel("frame", VELOCITY, message, partial(_from_earth, first, second))


def _from_earth(first, second, log):
    towards = {first: log["surge"], second: log["sway"]}
    return _turned_to_body(VELOCITY, towards["north"], towards["east"], log["heading"])


def _from_degrees(log):
    """Positions in m about the first fix, from degrees of latitude and longitude; WGS 84."""
    return dict(zip(POSITION, local_plane(log["north"], log["east"])[:2], strict=True))


def turned_grid(angle: float) -> Mislabel:
    """Positions in a grid that is turned against heading and velocities, clockwise by some degrees."""
    return Mislabel("frame", POSITION, TURNED, partial(_turned_back, POSITION, angle))


def turned_axes(angle: float) -> Mislabel:
    """Surge and sway along axes that are turned against the ship's, clockwise by some degrees."""
    # Along axes turned clockwise, the same velocity is turned anticlockwise.
    return Mislabel("frame", VELOCITY, AXES_TURNED, partial(_turned_back, VELOCITY, -angle))


def _turned_back(roles, angle, log):
    along, across = roles
    return _turned_to_body(roles, log[along], log[across], angle)


def late(channels: tuple[str, ...], others: tuple[str, ...], seconds: float) -> Mislabel:
    """Channels that come some seconds later than others."""
    verb = "come" if len(channels) > 1 else "comes"
    message = f"{' and '.join(channels)} {verb} {seconds:.1f} s later than {' and '.join(others)}"
    return Mislabel("channel_lag", channels, message, partial(_earlier, channels, seconds))


def _earlier(roles, seconds, log):
    """Channels as they come some seconds later; NaN beyond the end."""
    time = log["time"]
    moved = {}
    for role in roles:
        has_value = np.isfinite(log[role])
        values = log[role][has_value]
        values = np.unwrap(values, period=360.0) if role in ANGLES else values
        values = np.interp(time + seconds, time[has_value], values, right=np.nan)
        moved[role] = np.mod(values, 360.0) if role in ANGLES else values
    return moved


def _from_bow(log):
    return {"wind_from": np.mod(log["wind_from"] - log["heading"], 360.0)}


def _apparent(log):
    """Apparent wind from the wind over ground, its direction relative to the bow, and the ship's velocity."""
    # Apparent wind from ahead and from starboard: wind over ground plus the ship's velocity.
    ahead = log["wind_speed"] * np.cos(np.radians(log["wind_from"])) + log["surge"]
    aside = log["wind_speed"] * np.sin(np.radians(log["wind_from"])) + log["sway"]
    return {
        "wind_speed": np.hypot(ahead, aside),
        "wind_from": np.mod(np.degrees(np.arctan2(aside, ahead)), 360.0),
    }


def _apparent_from_north(log):
    """Apparent wind of a log with its direction from north."""
    return _apparent(log | _from_bow(log))


def _from_east(log):
    return {"heading": np.mod(90.0 - log["heading"], 360.0)}


HEADING_FROM_EAST = Mislabel(
    "frame", ("heading",), "heading is counted counter-clockwise from east", _from_east
)
POSITION_IN_DEGREES = Mislabel(
    "frame", POSITION, "north and east are degrees of latitude and longitude", _from_degrees
)
POSITION_LABELS = (
    swap_of("north", "east"),
    swap_of("surge", "sway"),
    *(negative(role) for role in ("north", "east", "surge", "sway")),
    velocity_frame("north", "east"),
    mislabel_of_unit(VELOCITY, "kn", "m/s"),
    mislabel_of_unit(VELOCITY, "m/s", "kn"),
)
WIND_LABELS = (
    negative("wind_from"),
    Mislabel(
        "frame", ("wind_from",), "wind_from is counted from north, not from the bow", _from_bow
    ),
    Mislabel("frame", WIND, "the wind is the wind over ground, not the apparent wind", _apparent),
    Mislabel(
        "frame",
        WIND,
        "the wind is the wind over ground, from north, not the apparent wind",
        _apparent_from_north,
    ),
    _in_unit(("wind_speed",), KNOT, "wind_speed is in kn, not m/s"),
    _in_unit(("wind_speed",), 1.0 / KNOT, "wind_speed is in m/s, not kn"),
)


def drive_channels(thruster: str, log: Container[str]) -> list[str]:
    """Roles of what drives a thruster in a log, its speed or thrust first."""
    return [thruster + drive for drive in DRIVES if thruster + drive in log]


def possible(labels: Iterable[Mislabel], log: Container[str]) -> list[Mislabel]:
    """Those of some mislabels whose channels a log has."""
    return [label for label in labels if all(role in log for role in label.channels)]


def finding_of(mislabel: Mislabel, probability: float, segment: Segment | None = None) -> Finding:
    """The finding that a log has a mislabel, in a segment (from, to) [s] or throughout."""
    segments = (segment,) if segment else ()
    fault = log_fault(mislabel.cause, mislabel.channels, mislabel.sentence, segments, probability)
    return replace(fault, mislabel=mislabel)


def undone(
    log: dict[str, np.ndarray], mislabel: Mislabel, segments: Sequence[Segment]
) -> dict[str, np.ndarray]:
    """The log, a dict of arrays by role with `time`, with a mislabel undone in some segments, or throughout.

    What was rounded away in a unit that is too large is lost: such a channel is NaN there.
    """
    changed = mislabel.undo(log)
    here = inside(log["time"], segments)
    # A unit that was too large left only rounding: no factor brings the signal back.
    if mislabel.scale is not None:
        changed = {
            role: np.nan * v if _is_rounded_away(log[role][here]) else v
            for role, v in changed.items()
        }
    return log | {role: np.where(here, values, log[role]) for role, values in changed.items()}


def _is_rounded_away(values):
    """Whether a channel's noise is less than half its resolution, so that errors of rounding do not average out."""
    values = finite(values)
    noise = noise_of(values) if len(values) > 2 else 0.0
    return bool(noise <= 0.5 * quantum(values))
