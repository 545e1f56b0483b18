"""Samples without a measurement: missing, held or filled rows, and headings interpolated across north."""

from dataclasses import dataclass

import numpy as np

from shipcosim.angles import unwrap_series, wrap_series
from shipcosim.diagnose.finding import Finding, Segment, log_fault
from shipcosim.diagnose.log.roles import NAVIGATION
from shipcosim.diagnose.log.thresholds import (
    CHANGES,
    END_DISTANCE,
    FASTER,
    FEWEST_CONSTANT,
    FEWEST_GAP_ROWS,
    FEWEST_LEAPS,
    FEWEST_OTHERS,
    LEAP,
    LONGEST_WRAP,
    MOST_FLAGGED,
    NEAR_NORTH,
    NO_TURN,
    NOISE_SEEN,
    RUN_CHANCE,
    SHORTEST_GAP,
)
from shipcosim.diagnose.numerics import (
    finite,
    noise_by_differences,
    normal_size,
    root_mean_square,
    runs,
)

LIFELESS = "values never change, while others say that they should: not used"
LEAPING = "the ship leaps many times faster than she goes"
NO_ROWS = "there are no rows"
NO_VALUES = "there are no values"
HELD = "values are held"
STRAIGHT = "values are interpolated"
GROUPS = (
    ("north", "east"),
    ("heading",),
    ("surge", "sway"),
    ("yaw_rate",),
    ("wind_speed", "wind_from"),
)


@dataclass(frozen=True)
class _Run:
    """Rows in which a group of channels is not usable, with the reason."""

    first: int
    last: int
    channels: tuple[str, ...]
    kind: str


def gaps(log: dict) -> list[Finding]:
    """Where data was lost: rows missing or empty, values held, or drawn as a straight line between two others.

    Parameters
    ----------
    log : dict of (n,) arrays
        `time` [s], increasing, and roles in their units, as logged.
    """
    time = log["time"]
    # Rows that are missing.
    runs = _missing(log)
    # Rows in which the whole navigation is empty, held or interpolated; other channels may follow.
    everywhere = list(_flat_runs(log, tuple(role for role in NAVIGATION if role in log)))
    runs += [_with_followers(log, run) for run in everywhere]
    # The same for groups of channels and for single ones, where what they belong to is not lost as a whole.
    singles = tuple((role,) for group in GROUPS if len(group) > 1 for role in group)
    for group in GROUPS + singles:
        others = [*everywhere, *(run for run in runs if group[0] in run.channels)]
        for run in _flat_runs(log, tuple(role for role in group if role in log)):
            if not any(_overlap(run, other) for other in others):
                runs.append(run)
    # Leaps of the position, which lost rows leave when a logger closes the gap.
    runs += _leaps(log)
    # Gaps of the same channels and kind are one finding.
    step = np.median(np.diff(time))
    segments: dict[tuple[tuple[str, ...], str], list[Segment]] = {}
    for run in runs:
        inner = step if run.kind == NO_ROWS else 0.0
        segment = (float(time[run.first] + inner), float(time[run.last] - inner))
        segments.setdefault((run.channels, run.kind), []).append(segment)
    return [
        log_fault("gap", channels, kind, tuple(sorted(where)))
        for (channels, kind), where in segments.items()
    ]


def held_segments(time: np.ndarray, values: np.ndarray) -> tuple[Segment, ...]:
    """Segments in which a channel holds the value that it holds longest, for longer than chance makes it. [s]

    Parameters
    ----------
    time, values : (n,) arrays
        [s], and the channel, NaN where there is no value.
    """
    whole = np.isfinite(values)
    time = time[whole]
    values = values[whole]
    if len(time) < FEWEST_CONSTANT:
        return ()
    least = max(FEWEST_GAP_ROWS, int(SHORTEST_GAP / np.median(np.diff(time))))
    spans = list(_long_runs(np.diff(values) == 0.0, least))
    longest = max(spans, key=lambda span: span[1] - span[0], default=(0, 0))
    return tuple(
        (float(time[first]), float(time[last]))
        for first, last in spans
        if values[first] == values[longest[0]]
    )


def lifeless(log: dict) -> list[Finding]:
    """Channels of the navigation that never change, although other channels show motion.

    Parameters
    ----------
    log : dict of (n,) arrays
        As in `gaps`.
    """
    constant = [role for role in NAVIGATION if role in log and is_constant(log[role])]
    # Motion that other channels show: change of position, turning, and speed.
    alive = {role for role in NAVIGATION if role in log and _changes(log[role])}
    moved = bool(alive & {"north", "east"})
    turned = "heading" in log and _changes(
        np.degrees(np.unwrap(np.radians(finite(log["heading"]))))
    )
    sailed = bool(alive & {"surge", "sway"})
    # A channel should change if the one that is its integral or rate does.
    should = {
        "surge": moved,
        "sway": moved and turned,
        "yaw_rate": turned,
        "north": sailed,
        "east": sailed,
        "heading": "yaw_rate" in alive,
    }
    roles = tuple(role for role in constant if should[role])
    whole = ((float(log["time"][0]), float(log["time"][-1])),)
    return [log_fault("gap", roles, LIFELESS, whole)] if roles else []


def is_constant(values: np.ndarray) -> bool:
    """Whether enough values of a channel are there, and all are the same."""
    values = finite(values)
    is_one = len(values) >= FEWEST_CONSTANT and np.ptp(values) == 0.0
    return (
        is_one and len(np.unique(np.signbit(values))) == 1
    )  # zeros of both signs are what a coarse unit leaves


def _changes(values):
    """Whether a channel changes by much more than its noise and resolution."""
    values = finite(values)
    if len(values) < FEWEST_CONSTANT:
        return False
    return bool(np.ptp(values) > CHANGES * (noise_of(values) + quantum(values)))


def noise_of(values: np.ndarray) -> float:
    """Standard deviation of white noise with the second differences of a channel."""
    return root_mean_square(noise_by_differences(values, 2))


def _leaps(log):
    """Rows between which the ship would go many times faster than she does: lost rows, drawn together or over."""
    roles = ("north", "east", "surge", "sway")
    if not all(role in log for role in roles):
        return
    north, east, surge, sway = (log[role] for role in roles)
    steps = np.diff(log["time"])
    speed = np.hypot(surge, sway)
    # Way made between rows, against the larger of both reported speeds times the step.
    went = np.hypot(np.diff(north), np.diff(east))
    travelled = np.maximum(speed[1:], speed[:-1]) * steps
    # Usual scatter between both, but not below the resolution of the position.
    usual = (
        np.nanquantile(np.abs(went - travelled), 0.9)
        if np.isfinite(went - travelled).any()
        else np.inf
    )
    usual = max(
        usual, np.hypot(quantum(north), quantum(east))
    )  # between two steps of its resolution no ship leaps
    with np.errstate(invalid="ignore"):
        leaping = went > LEAP * (travelled + usual)
    for first, last in runs(leaping):
        if last - first >= FEWEST_LEAPS:
            yield _Run(int(first), int(last), roles[:2] + ("heading",), LEAPING)


def _missing(log):
    time = log["time"]
    steps = np.diff(time)
    # A gap is a step of more than some rows, and longer than the shortest gap in time.
    lost = (steps > SHORTEST_GAP) & (steps > (FEWEST_GAP_ROWS + 0.5) * np.median(steps))
    every = tuple(role for role in log if role != "time")
    return [_Run(int(row), int(row) + 1, every, NO_ROWS) for row in np.flatnonzero(lost)]


def _overlap(first, other):
    shared = min(first.last, other.last) - max(first.first, other.first)
    return shared > 0.5 * min(first.last - first.first, other.last - other.first)


def _flat_runs(log, roles):
    """Runs in which all channels of a group are empty, held or straight for longer than chance makes them."""
    if not roles:
        return
    time = log["time"]
    values = np.column_stack([log[role] for role in roles])
    # Empty rows.
    for first, last in runs(np.all(np.isnan(values), axis=1)):
        if time[last - 1] - time[first] >= SHORTEST_GAP and last - first >= FEWEST_GAP_ROWS:
            yield _Run(first, last - 1, roles, NO_VALUES)
    # Second differences below the channels' resolution mark straight
    # or held values. A channel without values there does not count.
    bends = np.column_stack([_bend(log[role], role) for role in roles])
    limits = [_straight(log[role], role) for role in roles]
    straight = ((bends <= limits) | np.isinf(bends)).all(axis=1) & np.isfinite(bends).any(axis=1)
    least = max(FEWEST_GAP_ROWS, int(SHORTEST_GAP / np.median(np.diff(time))) - 2)
    # Only runs longer than chance makes them, and long enough in time, are lost data. They are
    # unusual only where noise is seen: a channel too coarse to show it is straight in calm water.
    held = np.r_[(values[1:] == values[:-1]).all(axis=1), False]
    # Held values end exactly where they change, and tell where a coarse channel is mostly straight.
    flat = list(_long_runs(straight | held, least))
    stuck = list(_long_runs(held, least))
    others = np.ones(len(time), bool)
    for first, last in [*stuck, *flat]:
        others[first:last] = False
    noise = {role: _noise(log[role][others], role) for role in roles}
    if not any(noise[role] > NOISE_SEEN * quantum(log[role][others]) for role in roles):
        return
    # Where a channel has few digits, its resolution at the value that is held counts.
    stuck = [
        (first, last)
        for first, last in stuck
        if any(noise[r] > NOISE_SEEN * _to_next_level(log[r], log[r][first]) for r in roles)
    ]
    kept_runs = []
    for first, last in [*stuck, *flat]:
        kind = _kind(values[first:last])
        last = min(last + (kind == STRAIGHT), len(time) - 1)  # rows of the line, both ends included
        run = _Run(first + 1, last - (kind == STRAIGHT), roles, kind)
        is_long = time[last] - time[first] >= SHORTEST_GAP
        if is_long and not any(_overlap(run, other) for other in kept_runs):
            if len(roles) > 2 or _is_line(log, roles, first, last):
                kept_runs.append(run)
    yield from kept_runs


def _noise(values, role):
    """Noise of a channel by differences that motion makes smaller, and noise does not; 0 where it is motion."""
    values = finite(values)
    if len(values) < FEWEST_CONSTANT:
        return np.inf
    if role == "heading" or role.endswith("_from"):
        values = np.degrees(unwrap_series(np.radians(values)))
    # Second differences of white noise change their sign from row to row (correlation -2/3), those of a motion do not.
    bends = noise_by_differences(values, 2)
    usual = np.median(np.abs(bends))
    tame = np.clip(bends, -3.0 * usual, 3.0 * usual)
    if np.mean(tame[1:] * tame[:-1]) > -np.mean(tame**2) / 3.0:
        return 0.0
    return min(normal_size(bends), normal_size(noise_by_differences(values, 4)))


def _to_next_level(values, value):
    """Distance of a value from the nearest other one of its channel."""
    apart = np.abs(finite(values) - value)
    return apart[apart > 0.0].min(initial=np.inf)


def _kind(values):
    change = np.diff(values, axis=0)
    return HELD if np.mean(np.nanmax(np.abs(change), axis=1, initial=0.0) > 0.0) < 0.2 else STRAIGHT


def _is_line(log, roles, first, last):
    """Whether each channel of the group is one straight line throughout, other than zero."""
    # Straight line between the inner ends of the run, against which each sample is compared.
    share = np.linspace(0.0, 1.0, last - first + 1)[1:-1]
    for role in roles:
        values = log[role][first : last + 1]
        line = values[1] + share * (values[-2] - values[1])
        off = np.nanmax(np.abs(values[1:-1] - line), initial=0.0)
        if off > 0.5 * _straight(log[role], role) or np.mean(values[1:-1] != 0.0) < 0.5:
            return False
    return True


def _bend(values, role):
    """Size of the second difference from each row on; angles the short way round."""
    bend = np.diff(values, n=2)
    if role == "heading" or role.endswith("_from"):
        bend = wrap_series(bend)
    return np.r_[np.where(np.isnan(bend), np.inf, np.abs(bend)), np.inf, np.inf]


def _straight(values, role):
    """Largest bend of a straight line after rounding: two of the channel's smallest steps."""
    # Rounding bends a straight line by up to two of its smallest steps.
    bends = _bend(values, role)
    usual = np.median(finite(bends)) if np.isfinite(bends).any() else 0.0
    return 2.02 * quantum(values) + 1e-3 * usual


def quantum(values: np.ndarray) -> float:
    """Resolution of a channel: the smallest step between its values above rounding errors; 0 if it is fine."""
    # Smallest step between levels. A channel in which most values differ has no visible resolution.
    levels = np.unique(finite(values))
    steps = np.diff(levels)
    steps = steps[steps > 1e-9 * (np.abs(levels).max(initial=0.0) + 1e-300)]
    return float(np.quantile(steps, 0.01)) if len(steps) and len(steps) < 0.8 * len(values) else 0.0


def _long_runs(flags, least):
    """Runs of at least some rows, and longer than chance makes them, by how often flags follow flags in other runs.

    None where flags are what is usual, as in a channel of coarse resolution.
    """
    # Short runs show how often flags follow each other by chance, in a geometric distribution.
    spans = runs(flags)
    lengths = np.diff(spans, axis=1)[:, 0]
    ordinary = lengths[lengths < least]
    others = len(flags) - lengths[lengths >= least].sum()
    # If most rows are flagged, flags are ordinary for this channel.
    if others < FEWEST_OTHERS * len(flags) or ordinary.sum() > MOST_FLAGGED * others:
        return
    # Chance that a flag follows a flag; the constants keep it defined without any short run.
    chance = ((ordinary - 1).sum() + 0.2) / (ordinary.sum() + 2.0)
    for (first, last), length in zip(spans, lengths, strict=True):
        # Expected number of runs of this length by chance.
        if length >= least and len(flags) * chance ** (length - 1) < RUN_CHANCE:
            yield int(first), int(last)


def _with_followers(log, run):
    """The run, with the other channels too where these are empty, held or straight for the whole time."""
    others = [role for role in log if role not in (*run.channels, "time")]
    inner = slice(run.first, run.last + 1)
    # The other channels join only if all of them are flat, and only those that change elsewhere.
    flat = [
        role
        for role in others
        if _follows(log[role][inner], role, run.kind, _straight(log[role], role))
    ]
    moving = [role for role in flat if _range(log[role]) > 0.0]
    return _Run(
        run.first,
        run.last,
        (*run.channels, *(moving if len(flat) == len(others) else ())),
        run.kind,
    )


def _range(values):
    values = finite(values)
    return np.ptp(values) if len(values) else 0.0


def _follows(inner, role, kind, limit):
    if kind == NO_VALUES:
        return bool(np.isnan(inner).all())
    if kind == HELD:
        return not np.nanmax(np.abs(np.diff(inner)), initial=0.0) > 0.0
    bends = _bend(inner, role)
    return bool((finite(bends) <= 1.5 * limit).all())


def wraps(log: dict) -> list[Finding]:
    """Samples of the heading that were interpolated the long way round between both sides of north."""
    if "heading" not in log:
        return []
    time = log["time"]
    heading = log["heading"]
    bad = np.zeros(len(heading), bool)
    fine = quantum(heading)
    # Change from row to row that is no turn of this craft, however agile she is. [deg]
    change = np.abs(wrap_series(np.diff(finite(heading))))
    faster = max(NO_TURN, FASTER * float(np.quantile(change, 0.6))) if len(change) else NO_TURN
    full = np.where(
        np.abs(heading) <= fine, heading + 360.0, heading
    )  # 359.98 rounded is written as 0.0
    # Try each number of samples between a row before and a row after the crossing of north; once more without those
    # that were there, as one between two others looks like a turn.
    for between in 2 * [*range(1, min(LONGEST_WRAP, len(heading) - 2) + 1)]:
        crossing = np.zeros(len(heading) - between - 1, bool)
        turning = np.abs(wrap_series(np.diff(np.where(bad, np.nan, heading))))
        # 0 may stand for 360 at either end.
        for a, b in ((heading, heading), (full, heading), (heading, full)):
            ends = a[: -between - 1], b[between + 1 :]
            crossing |= _long_way(
                time, heading, *ends, np.nan_to_num(turning), 3.0 + 2.0 * fine, faster
            )
        for row in np.flatnonzero(crossing):
            bad[row + 1 : row + 1 + between] = True
    # The same where the rows at the ends are missing.
    bad |= _round_south(log, faster)
    segments = tuple((float(time[first]), float(time[last - 1])) for first, last in runs(bad))
    note = "samples lie on the long way round between both sides of north"
    return [log_fault("heading_wrap", ("heading",), note, segments)] if segments else []


def _long_way(time, heading, a, b, turning, tolerance, faster):
    """Where the samples between a and b, both near north and on its two sides, lie on the line through south.

    Some of them may be missing.
    """
    n = len(a)
    between = len(heading) - len(a) - 1
    # Both ends are near each other across north, but far
    # apart as numbers, farther than the craft can turn.
    crossing = (
        (np.abs(b - a) > 180.0)
        & (np.abs(wrap_series(b - a)) < 45.0)
        & (np.abs(b - a) > faster * (between + 1))
    )
    # The craft must not be turning as fast as this right before and after it.
    noise = np.minimum(
        np.r_[0.0, turning[: n - 1]], np.r_[turning[between + 1 :], 0.0]
    )  # before a, after b
    crossing &= np.abs(b - a) > 2.0 * noise * (between + 1)
    some = np.zeros(n, bool)
    # Every sample between them must lie on the straight line of the numbers.
    for k in range(1, between + 1):
        share = (time[k : n + k] - time[:n]) / (time[between + 1 :] - time[:n])
        here = heading[k : n + k]
        some |= np.isfinite(here)
        crossing &= ~(np.abs(here - (a + (b - a) * share)) >= tolerance)
    return crossing & some


def _round_south(log, faster):
    """Samples of the same kind where those at the ends are missing: far from north between some on both sides of it.

    They come and go within a few rows, much faster than the ship turns.
    """
    bad = np.zeros(len(log["heading"]), bool)
    # Only rows with a heading, in (-180, 180], so that north is 0.
    with_heading = np.flatnonzero(np.isfinite(log["heading"]))
    time = log["time"][with_heading]
    heading = wrap_series(log["heading"][with_heading])
    change = np.abs(wrap_series(np.diff(heading)))
    longest = (2 * LONGEST_WRAP + 1.5) * np.median(np.diff(log["time"]))
    # Short excursions to the south between headings on both sides of north.
    for first, last in runs(np.abs(heading) > NEAR_NORTH):
        if first == 0 or last == len(with_heading) or time[last] - time[first - 1] > longest:
            continue
        if (
            heading[first - 1] * heading[last] < 0.0
            and max(change[first - 1], change[last - 1]) > faster
        ):
            first -= (
                first > 1 and change[first - 2] > faster
            )  # samples near north may lie on the line too
            last += last < len(change) and change[last] > faster
            bad[with_heading[first:last]] = True
    return bad


def outliers(log: dict) -> dict[str, np.ndarray]:
    """Single samples far off their neighbours, by role of the navigation: (n,) arrays of bool."""
    return {role: _far_off(log[role], role == "heading") for role in NAVIGATION if role in log}


def _far_off(values, is_angle):
    """Samples that are far from both neighbours on the same side, while those agree; at an end, far from all others."""
    if not np.isfinite(np.diff(values)).any():
        return np.zeros(len(values), bool)
    # Robust scale of the changes: median absolute deviation plus resolution.
    change = np.diff(values)
    if is_angle:
        change = wrap_series(change)
    usual = normal_size(change - np.nanmedian(change)) + quantum(values) + 1e-12
    # A spike is far from both neighbours, in opposite directions, and the neighbours agree.
    before = change[:-1]
    after = change[1:]
    with np.errstate(invalid="ignore"):
        spike = (np.minimum(np.abs(before), np.abs(after)) > 12.0 * usual) & (
            np.abs(before + after) < 6.0 * usual
        )
    far = np.r_[False, spike & (before * after < 0.0), False]
    # An end has one neighbour only: it must be far outside the range of all other values.
    for end in () if is_angle or len(values) < 4 else (0, -1):
        others = np.delete(values, end)
        low = np.nanmin(others, initial=np.inf)
        high = np.nanmax(others, initial=-np.inf)
        far[end] = high > low and abs(values[end] - 0.5 * (low + high)) > END_DISTANCE * (
            high - low
        )
    return far
