"""Whether a mistake can be seen in a log at all: its effect on the true signal against noise and resolution.

Nothing of the diagnosis is used. An observer who knows the mistake, the noise and the true motion compares the change
of position with the integral of the velocity, and that of the heading with the integral of the rate: by how much does
what is logged contradict its labels, over noise?
"""

import numpy as np

from mistakes.mistakes import MISTAKES, with_mistakes

SEEN = 12.0  # [nats]: one of some three hundred readings, each of them as rare as one log in 150, is told from none
FEWEST = 6  # increments


def is_visible(log, true, name):
    """Whether a mistake, alone in a log, shows over noise; of a clock some per cent off in both relations.

    In one relation alone such a clock is what a scale of that sensor would be.

    Parameters
    ----------
    log, true : dict of (n,) arrays by role
        The right log, with noise and without.
    name : str
    """
    wrong, plain = with_mistakes(log, [name]), with_mistakes(true, [name])
    told = [_nats(of(wrong, plain), axes) for of, axes in ((_positions, 2), (_headings, 1))]
    return bool((min if MISTAKES[name].needs_both else max)(told) > SEEN)


def _positions(*logs):
    rows = _known(logs, ("north", "east", "heading", "surge", "sway"))
    return (
        []
        if rows is None
        else [_off({role: values[rows] for role, values in log.items()}) for log in logs]
    )


def _off(log):
    """Position less the way made."""
    velocity = (log["surge"] + 1j * log["sway"]) * np.exp(1j * np.radians(log["heading"]))
    return log["north"] + 1j * log["east"] - _way(log["time"], velocity)


def _headings(*logs):
    rows = _known(logs, ("heading", "yaw_rate"))
    if rows is None:
        return []
    turned = [np.degrees(np.unwrap(np.radians(log["heading"][rows]))) for log in logs]
    return [
        turn - _way(log["time"][rows], log["yaw_rate"][rows])
        for turn, log in zip(turned, logs, strict=True)
    ]


def _known(logs, roles):
    if not set(roles) <= set(logs[0]):
        return None
    return np.all([np.isfinite(log[role]) for log in logs for role in roles], axis=0)


def _way(time, velocity):
    return np.r_[0.0, np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))]


def _nats(both, axes):
    """Most that any horizon tells, of independent increments."""
    if not both:
        return 0.0
    wrong, plain = both
    noise, most, horizon = wrong - plain, 0.0, 1
    while horizon * FEWEST <= len(noise):
        effect, spread = (np.mean(np.abs(s[horizon:] - s[:-horizon]) ** 2) for s in (plain, noise))
        most = max(most, 0.5 * axes * len(noise) / horizon * effect / max(spread, 1e-30))
        horizon *= 2
    return most
