"""What is read off a turn or a zig-zag, of the trial and of the model by the same lines."""

import numpy as np


def turn_numbers(time, psi, u, v, r, north, east):
    """Numbers of a turning circle.

    Parameters
    ----------
    time : (n,) array
        From the start of the order. [s]
    psi : (n,) array
        Heading, unwrapped. [rad]
    u, v, r : (n,) arrays
        Velocity in body axes. [m/s, m/s, rad/s]
    north, east : (n,) arrays
        Position. [m]

    Returns
    -------
    dict of str to float
        Approach speed, t90 and t180 in s, advance and tactical diameter in m, and from 180 deg of turn on speed in
        m/s, rate in deg/s (always positive) and diameter in m; NaN for what was not reached.
    """
    turned = np.abs(psi - psi[0])
    c, s = np.cos(psi[0]), np.sin(psi[0])
    ahead = (north - north[0]) * c + (east - east[0]) * s
    aside = np.abs(-(north - north[0]) * s + (east - east[0]) * c)
    steady = (turned > np.pi) & (turned < 3.0 * np.pi)
    speed, rate = np.mean(np.hypot(u, v)[steady]), abs(np.mean(r[steady]))
    return {
        "approach": float(np.hypot(u[0], v[0])),
        "t90": _when(time, turned, np.pi / 2),
        "t180": _when(time, turned, np.pi),
        "advance": _when(ahead, turned, np.pi / 2),
        "tactical": _when(aside, turned, np.pi),
        "speed": float(speed),
        "rate": float(np.degrees(rate)),
        "diameter": float(2.0 * speed / rate),
    }


def swings(time, psi, base, least):
    """Turning points of a zig-zag: times in s, and headings off the base course in deg.

    Parameters
    ----------
    time, psi : (n,) arrays
        Heading, unwrapped. [s, rad]
    base : float
        Base course. [rad]
    least : float
        Swings that stay within this of the base are no swings. [deg]
    """
    off = np.degrees(psi - base)
    far = np.sign(off) * (np.abs(off) > least)
    times, peaks = [], []
    for side in (1.0, -1.0):
        for run in np.split(
            np.arange(len(off)), np.flatnonzero(np.diff((far == side).astype(int))) + 1
        ):
            if far[run[0]] == side and 0 < run[0] and run[-1] < len(off) - 1:
                top = run[np.argmax(side * off[run])]
                times.append(time[top])
                peaks.append(off[top])
    order = np.argsort(times)
    return np.array(times)[order], np.array(peaks)[order]


def _when(values, turned, angle):
    """Value when the turn first reaches an angle, by linear interpolation; NaN if it never does."""
    rows = np.flatnonzero(turned >= angle)
    if not len(rows) or rows[0] == 0:
        return float("nan")
    k = rows[0]
    share = (angle - turned[k - 1]) / (turned[k] - turned[k - 1])
    return float(values[k - 1] + share * (values[k] - values[k - 1]))
