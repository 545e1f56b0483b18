"""Logs too poor to tell a cause from another: slow rows, seconds instead of minutes, channels that nobody logged."""

from dataclasses import replace

import numpy as np

POSITION = ("time", "north", "east", "heading")
VELOCITY = ("surge", "sway", "yaw_rate")
WIND = ("wind_speed", "wind_from")
LEFT_OUT = {"no_velocity": VELOCITY, "no_velocity_no_wind": (*VELOCITY, *WIND)}
STREAM = 7919  # keeps what is drawn here apart from what the truth draws


def poorer(case, *, every=1, seconds=None, since=None, channels=None):
    """A drawn log of which less was recorded, and what of its answer is left in it.

    Parameters
    ----------
    case : truth.Case
    every : int
        Rows from one that is kept to the next.
    seconds : float, optional
        Length of the part that is kept, from a drawn row on. [s]
    since : float, optional
        First time that is kept: what the ship sails after the log is kept too. [s]
    channels : "position", "no_velocity", "no_velocity_no_wind" or "half", optional
        Keeps time, position and heading alone; these with thrusters and wind; with thrusters; with a drawn half of all
        other channels.

    Returns
    -------
    truth.Case
        Faults of rows or channels that are not kept are no longer in the answer.
    """
    rng = np.random.default_rng([STREAM, case.seed, *case.kind.encode()])
    rows = _rows(case.log["time [s]"].to_numpy(), every, seconds, since, rng)
    kept = _channels(list(case.log), channels, rng)
    log = case.log.loc[rows, kept].reset_index(drop=True)
    span, roles = (log["time [s]"].min(), log["time [s]"].max()), {_role(name) for name in kept}
    answer = [one for one in case.answer if _is_in(one, span, roles)]
    return replace(case, log=log, answer=answer, truth=case.truth.iloc[: len(log)], healthy=None)


def _rows(time, every, seconds, since, rng):
    """Which rows are kept: every so many, of a part of the log."""
    rows = np.arange(rng.integers(every), len(time), every)
    if since is not None:
        rows = rows[time[rows] >= since]
    if seconds is None:
        return rows
    start = rng.uniform(time[0], time[-1] - seconds)
    return rows[(time[rows] >= start) & (time[rows] <= start + seconds)]


def _channels(names, which, rng):
    """Which columns are kept, in their order."""
    if which == "position":
        return [name for name in names if _role(name) in POSITION]
    if which in LEFT_OUT:
        return [name for name in names if _role(name) not in LEFT_OUT[which]]
    if which == "half":
        others = [name for name in names if _role(name) not in POSITION]
        left_out = set(rng.choice(others, len(others) // 2, replace=False))
        return [name for name in names if name not in left_out]
    return names


def _is_in(answer, span, roles):
    """Whether a hidden effect is in what is kept of a log."""
    in_time = not answer.segments or any(
        start <= span[1] and end >= span[0] for start, end in answer.segments
    )
    return (
        in_time
        and (not answer.channels or bool(set(answer.channels) & roles))
        and answer.onset <= span[1]
    )


def _role(name):
    return name.split(" [")[0]
