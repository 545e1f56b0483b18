"""What a channel can be instead of what its label says, and how to put it right."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.log.checks.samples import quantum
from shipcosim.diagnose.log.rows import inside
from shipcosim.diagnose.result import Finding

__all__ = [
    "HEADING_LABELS",
    "MISLABELS",
    "POSITION_LABELS",
    "WIND_LABELS",
    "Mislabel",
    "finding_of",
    "mislabel_in",
    "mislabel_of",
    "negative",
    "possible",
    "undone",
]

KNOT = 1852.0 / 3600.0  # m/s


@dataclass(frozen=True)
class Mislabel:
    """A fault of labels.

    Attributes
    ----------
    cause : str
        ``"sign"``, ``"channel_swap"`` or ``"frame"``.
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
    undo: Callable[[dict], dict]
    scale: float | None = None


def negative(role: str) -> Mislabel:
    """A channel with the other sign."""
    return Mislabel("sign", (role,), f"{role} has the other sign", lambda log: {role: -log[role]})


def _swapped(one, other):
    def undo(log):
        return {one: log[other], other: log[one]}

    return Mislabel("channel_swap", (one, other), f"{one} and {other} are swapped", undo)


def _in_unit(roles, scale, sentence):
    return Mislabel("frame", roles, sentence, lambda log: {role: scale * log[role] for role in roles}, scale)


def _turned_to_body(north, east, heading):
    cosine, sine = np.cos(np.radians(heading)), np.sin(np.radians(heading))
    return cosine * north + sine * east, cosine * east - sine * north


def _body_velocity(log):
    return dict(zip(("surge", "sway"), _turned_to_body(log["surge"], log["sway"], log["heading"]), strict=True))


def _from_bow(log):
    return {"wind_from": np.mod(log["wind_from"] - log["heading"], 360.0)}


def _apparent(log):
    """Apparent wind from the wind over ground, its direction relative to the bow, and the ship's velocity."""
    ahead = log["wind_speed"] * np.cos(np.radians(log["wind_from"])) + log["surge"]
    aside = log["wind_speed"] * np.sin(np.radians(log["wind_from"])) + log["sway"]
    return {"wind_speed": np.hypot(ahead, aside), "wind_from": np.mod(np.degrees(np.arctan2(aside, ahead)), 360.0)}


def _apparent_from_north(log):
    """The same, with the direction from north."""
    return _apparent(log | _from_bow(log))


VELOCITY, WIND = ("surge", "sway"), ("wind_speed", "wind_from")

HEADING_LABELS = (
    negative("yaw_rate"),
    _in_unit(("yaw_rate",), float(np.degrees(1.0)), "yaw_rate is in rad/s, not deg/s"),
    _in_unit(("yaw_rate",), float(np.radians(1.0)), "yaw_rate is in deg/s, not rad/s"),
    _in_unit(("yaw_rate",), 1.0 / 60.0, "yaw_rate is in deg/min, not deg/s"),
)
POSITION_LABELS = (
    _swapped("north", "east"),
    _swapped("surge", "sway"),
    *(negative(role) for role in ("north", "east", "surge", "sway")),
    Mislabel("frame", VELOCITY, "surge and sway are the velocity towards north and east", _body_velocity),
    _in_unit(VELOCITY, KNOT, "surge and sway are in kn, not m/s"),
    _in_unit(VELOCITY, 1.0 / KNOT, "surge and sway are in m/s, not kn"),
)
WIND_LABELS = (
    negative("wind_from"),
    Mislabel("frame", ("wind_from",), "wind_from is counted from north, not from the bow", _from_bow),
    Mislabel("frame", WIND, "the wind is the wind over ground, not the apparent wind", _apparent),
    Mislabel(
        "frame", WIND, "the wind is the wind over ground, from north, not the apparent wind", _apparent_from_north
    ),
    _in_unit(("wind_speed",), KNOT, "wind_speed is in kn, not m/s"),
    _in_unit(("wind_speed",), 1.0 / KNOT, "wind_speed is in m/s, not kn"),
)
MISLABELS = (*HEADING_LABELS, *POSITION_LABELS, *WIND_LABELS)


def possible(labels: Iterable[Mislabel], log: Container[str]) -> list[Mislabel]:
    """Those of some mislabels whose channels a log has."""
    return [label for label in labels if all(role in log for role in label.channels)]


def finding_of(mislabel: Mislabel, probability: float, segment: tuple[float, float] | None = None) -> Finding:
    """The finding that a log has a mislabel, in a segment (from, to) [s] or throughout."""
    segments = (segment,) if segment else ()
    return Finding(mislabel.cause, None, "data", probability, {}, segments, mislabel.channels, note=mislabel.sentence)


def mislabel_of(finding: Finding) -> Mislabel | None:
    """The mislabel that a finding names by its note; None where the finding is another fault."""
    return next((m for m in MISLABELS if (m.cause, m.sentence) == (finding.cause, finding.note)), None)


def mislabel_in(finding: Finding) -> Mislabel:
    """The mislabel of a finding that is one; `mislabel_of` where it can be another fault."""
    mislabel = mislabel_of(finding)
    if mislabel is None:
        raise ValueError(f"no mislabel: {finding.label}")
    return mislabel


def undone(
    log: dict[str, np.ndarray], mislabel: Mislabel, segments: Sequence[tuple[float, float]]
) -> dict[str, np.ndarray]:
    """The log, a dict of arrays by role with `time`, with a mislabel undone in some segments, or throughout.

    What was rounded away in a unit that is too large is lost: such a channel is NaN there.
    """
    changed, here = mislabel.undo(log), inside(log["time"], segments)
    if mislabel.scale is not None:
        changed = {role: np.nan * v if _is_rounded_away(log[role][here]) else v for role, v in changed.items()}
    return log | {role: np.where(here, values, log[role]) for role, values in changed.items()}


def _is_rounded_away(values):
    """Whether a channel's noise is less than half its resolution, so that errors of rounding do not average out."""
    values = values[np.isfinite(values)]
    noise = np.sqrt(np.mean(np.diff(values, n=2) ** 2) / 6.0) if len(values) > 2 else 0.0
    return bool(noise <= 0.5 * quantum(values))
