"""Faults that are in the log only: wrong clocks, gaps, lags, frames, signs and swapped channels.

A draw gives an effect whose answer names segments and channels; `true_times` and `spoil` do it to a log.
"""

import numpy as np

from truth.effects import Answer, Effect, draw_size, either
from truth.plant import to_earth
from truth.sensors import ROLES

KNOT = 1852.0 / 3600.0
NAVIGATION = ("north", "east", "heading", "surge", "sway", "yaw_rate")
THRUSTER_CHANNELS = ("port_rpm", "port_azimuth", "starboard_rpm", "starboard_azimuth", "tunnel_rpm")
FRAMES = {
    "velocity_earth": ("surge", "sway"),
    "velocity_knots": ("surge", "sway"),
    "wind_over_ground": ("wind_speed", "wind_from"),
    "wind_from_north": ("wind_from",),
    "wind_knots": ("wind_speed",),
    "rate_radians": ("yaw_rate",),
}
SWAPS = (
    ("port_rpm", "port_azimuth", "starboard_rpm", "starboard_azimuth"),
    ("port_azimuth", "starboard_azimuth"),
    ("surge", "sway"),
    ("north", "east"),
)
SIGNS = (
    "surge",
    "sway",
    "yaw_rate",
    "east",
    "tunnel_rpm",
    "port_azimuth",
    "starboard_azimuth",
    "wind_from",
)
GAPS = ("interpolated", "held", "missing", "empty")


def part_of(rng, seconds):
    """The whole log (three times in five), or 30 to 60 % of it."""
    if rng.random() < 0.6:
        return ()
    length = int(rng.uniform(0.3, 0.6) * seconds)
    start = int(rng.uniform(0, seconds - length))
    return ((start, start + length),)


def draw_lag(cause, channels):
    def draw(rng, size, minutes):
        return Effect(
            Answer(cause, None, {"lag": float(draw_size(cause, rng, size))}, (), channels)
        )

    return draw


def draw_clock(rng, size, minutes):
    """One segment of 180 to 400 s, or two of 120 to 200 s, with at least 60 s between them."""
    rate, seconds = float(1.0 + either(rng) * draw_size("clock", rng, size)), 60 * minutes
    lengths = rng.uniform(180, 400, 1) if rng.random() < 0.5 else rng.uniform(120, 200, 2)
    return Effect(Answer("clock", None, {"rate": rate}, segments(rng, lengths, seconds), ("time",)))


def segments(rng, lengths, seconds, apart=60):
    """Segments of these lengths in random places of the log, none near another or the ends, in whole seconds."""
    free = np.sort(
        rng.uniform(0, seconds - np.sum(lengths) - apart * (len(lengths) + 1), len(lengths))
    )
    starts = free + apart + np.concatenate([[0.0], np.cumsum(np.asarray(lengths) + apart)[:-1]])
    return tuple((int(a), int(a + length)) for a, length in zip(starts, lengths, strict=True))


def draw_gap(rng, size, minutes):
    how = str(rng.choice(GAPS))
    parts = segments(rng, rng.uniform(25, 90, rng.integers(1, 4)), 60 * minutes)
    channels = (
        NAVIGATION if how in ("interpolated", "held") and rng.random() < 0.5 else tuple(ROLES)
    )
    return Effect(Answer("gap", None, {}, parts, channels, note=how))


def draw_frame(rng, size, minutes):
    how = str(rng.choice(tuple(FRAMES)))
    return Effect(Answer("frame", None, {}, part_of(rng, 60 * minutes), FRAMES[how], note=how))


def draw_swap(rng, size, minutes):
    return Effect(
        Answer(
            "channel_swap", None, {}, part_of(rng, 60 * minutes), SWAPS[rng.integers(len(SWAPS))]
        )
    )


def draw_sign(rng, size, minutes):
    return Effect(Answer("sign", None, {}, part_of(rng, 60 * minutes), (str(rng.choice(SIGNS)),)))


def draw_wrap(rng, size, minutes):
    """Where they are is known when the log is written; see `wrapped`."""
    return Effect(
        Answer("heading_wrap", None, {}, (), ("heading",)), {"samples": int(rng.integers(1, 5))}
    )


DRAW = {
    "navigation_lag": draw_lag("navigation_lag", NAVIGATION),
    "thruster_lag": draw_lag("thruster_lag", THRUSTER_CHANNELS),
    "clock": draw_clock,
    "gap": draw_gap,
    "frame": draw_frame,
    "channel_swap": draw_swap,
    "sign": draw_sign,
    "heading_wrap": draw_wrap,
}


def true_times(times, answers):
    """True times at which navigation, thrusters and wind of each row were sampled.

    Parameters
    ----------
    times : (rows,) array
        As logged. [s]
    answers : sequence of Answer

    Returns
    -------
    tuple of three (rows,) arrays
        [s]
    """
    clock, late = times.astype(float), {"navigation_lag": 0.0, "thruster_lag": 0.0}
    for answer in answers:
        if answer.cause == "clock":
            for start, end in answer.segments:
                clock = clock + (answer.parameters["rate"] - 1) * np.clip(
                    times - start, 0, end - start
                )
        elif answer.cause in late:
            late[answer.cause] = answer.parameters["lag"]
    return clock - late["navigation_lag"], clock - late["thruster_lag"], clock


def inside(times, parts):
    """Which rows a fault is in, (rows,) bool; no parts are all rows."""
    if not parts:
        return np.ones(times.size, bool)
    return np.any([(times >= start) & (times <= end) for start, end in parts], axis=0)


def spoil(channels, times, effect):
    """Channels with a fault of the log put in.

    Parameters
    ----------
    channels : dict
        Role to (rows,) array, unwrapped.
    times : (rows,) array
        [s]
    effect : Effect

    Returns
    -------
    tuple
        Channels; which rows are left (rows,) bool; the answer, with the segments that only the log tells.
    """
    answer, rows = effect.answer, np.ones(times.size, bool)
    hit = inside(times, answer.segments)
    if answer.cause == "gap":
        channels, rows = gap(channels, hit, answer)
    elif answer.cause == "frame":
        channels = blend(channels, frame(channels, answer.note), hit)
    elif answer.cause == "channel_swap":
        channels = blend(channels, swap(channels, answer.channels), hit)
    elif answer.cause == "sign":
        channels = blend(channels, {role: -channels[role] for role in answer.channels}, hit)
    elif answer.cause == "heading_wrap":
        channels, parts = wrapped(channels, times, effect.shape["samples"])
        answer = answer._replace(segments=parts)
    return channels, rows, answer


def told_of(pieces):
    """The answer of a log from those of its consecutive parts: only of a heading each has segments of its own."""
    first, *more = pieces
    if first.cause != "heading_wrap":
        return first
    return first._replace(segments=sum((piece.segments for piece in more), first.segments))


def blend(channels, changed, hit):
    """Channels with the changed ones in the rows that are hit."""
    return channels | {
        role: np.where(hit, values, channels[role]) for role, values in changed.items()
    }


def gap(channels, hit, answer):
    """Data lost in the rows that are hit: rows missing, empty, held or interpolated over."""
    if answer.note == "missing":
        return channels, ~hit
    index, good = np.arange(hit.size), np.flatnonzero(~hit)
    changed = {}
    for role in answer.channels:
        values = channels[role]
        if answer.note == "empty":
            changed[role] = np.where(hit, np.nan, values)
        elif answer.note == "held":
            changed[role] = values[np.maximum.accumulate(np.where(hit, 0, index))]
        else:
            changed[role] = np.interp(index, good, values[good])
    return channels | changed, np.ones(hit.size, bool)


def frame(channels, how):
    """The channels of a frame fault, as they should not be."""
    heading = np.radians(channels["heading"])
    if how == "velocity_earth":
        return dict(
            zip(
                ("surge", "sway"),
                to_earth(heading, channels["surge"], channels["sway"]),
                strict=True,
            )
        )
    if how == "velocity_knots":
        return {role: channels[role] / KNOT for role in ("surge", "sway")}
    if how == "wind_knots":
        return {"wind_speed": channels["wind_speed"] / KNOT}
    if how == "wind_from_north":
        return {"wind_from": channels["wind_from"] + channels["heading"]}
    if how == "rate_radians":
        return {"yaw_rate": np.radians(channels["yaw_rate"])}
    towards = np.radians(channels["wind_from"] + 180.0)
    north, east = to_earth(heading, *to_earth(towards, channels["wind_speed"], 0.0))
    v_north, v_east = to_earth(heading, channels["surge"], channels["sway"])
    north, east = north + v_north, east + v_east
    return {
        "wind_speed": np.hypot(north, east),
        "wind_from": np.degrees(np.arctan2(east, north)) + 180.0,
    }


def swap(channels, which):
    """Channels exchanged: two with each other, or all of port with all of starboard."""
    other = dict(zip(which, (*which[len(which) // 2 :], *which[: len(which) // 2]), strict=True))
    return {role: channels[other[role]] for role in which}


def wrapped(channels, times, samples):
    """Heading as interpolated over 0/360 between its wrapped values, `samples` long, at each passage through north."""
    heading = np.mod(channels["heading"], 360.0)
    parts, k = [], 1
    while k < heading.size - samples - 1:
        if (
            abs(heading[k] - heading[k - 1]) > 180.0
            and abs(heading[k + samples] - heading[k - 1]) > 180.0
        ):
            share = np.arange(1, samples + 1) / (samples + 1)
            heading[k : k + samples] = heading[k - 1] + share * (
                heading[k + samples] - heading[k - 1]
            )
            parts.append((float(times[k]), float(times[k + samples - 1])))
            k += samples
        k += 1
    return channels | {"heading": heading}, tuple(parts)
