"""The steps of a manoeuvre in words."""

import numpy as np

from shipcosim.diagnose.experiment.manoeuvres import Manoeuvre
from shipcosim.report.theme.numbers import plain, span


def manoeuvre_steps(manoeuvre: Manoeuvre) -> list[tuple[str, str]]:
    """Steps of a manoeuvre with their times, and what ship or thruster does, in order of time.

    Parameters
    ----------
    manoeuvre : Manoeuvre
        Of the diagnosis' library.

    Returns
    -------
    list of (str, str)
    """
    # Legs of the ship, except where she drifts freely.
    steps: list[tuple[float, float, str]] = []
    start = 0.0
    before = (0.0, 0.0, 0.0)
    for duration, *there in manoeuvre.legs:
        if not any(a <= start and start + duration <= b for a, b in manoeuvre.free):
            steps.append((start, start + duration, _leg(tuple(there), before)))
        start = start + duration
        before = tuple(there)
    # Pushes of single thrusters, with their force and direction.
    for push in manoeuvre.pushes:
        angles = [round(float(np.degrees(angle))) for angle in push.azimuth]
        towards = (
            f", turned from {angles[0]} to {angles[1]}° off the bow"
            if angles[0] != angles[1]
            else ""
        )
        force = f"{'−' * (push.force < 0.0)}{plain(abs(push.force) / 1e3, 2)} kN"
        doing = f"{push.thruster} pushes with {force} along its axis"
        steps.append((push.start, push.end, doing + towards))
    # Free drift may end with the manoeuvre.
    steps += [
        (a, min(b, start), "DP off, thrusters idle, the ship drifts") for a, b in manoeuvre.free
    ]
    return [(span(a, b), doing) for a, b, doing in sorted(steps, key=lambda entry: entry[:2])]


def _leg(there: tuple[float, ...], before: tuple[float, ...]) -> str:
    """A leg in words: where the ship goes, seen from her start position and heading."""
    if there == before:
        return "hold position and heading"
    # Position relative to the start, then the turn, each only if it changes.
    ahead, across, turned = there
    words = [f"{abs(ahead):.0f} m {'ahead' if ahead > 0.0 else 'astern'}"] if ahead else []
    words += [f"{abs(across):.0f} m to {'starboard' if across > 0.0 else 'port'}"] if across else []
    moved = there[:2] != before[:2]
    text = f"move to {' and '.join(words) or 'the start'}" if moved else ""
    if turned != before[2]:
        text += f"{', ' if text else ''}turn to {np.degrees(turned):.0f}° clockwise of the first heading"
    return text
