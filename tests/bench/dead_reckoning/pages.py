"""The page of the measures: docs/generated/dead-reckoning.md, and the numbers themselves beside it."""

from pathlib import Path

import numpy as np

PAGE = Path(__file__).resolve().parents[3] / "docs" / "generated" / "dead-reckoning.md"
NAMES = {
    "motion-filter": "our filter, learned",
    "kinetic": "the same filter, nothing learned",
    "paper-ii": "LSTM of paper II",
    "paper-ii-single-layer": "single layer of paper II",
    "kalman": "Kalman filter of paper II",
    "constant-velocity": "constant velocity",
    "last-position": "stays where she was",
}
STATES = ("Hs 1 m, 2 m/s", "Hs 2 m, 4 m/s", "Hs 3 m, 7 m/s", "Hs 4 m, 11 m/s")


def interval(values):
    """Mean and 95 % interval of the mean by resampling worlds."""
    values, rng = np.asarray(values), np.random.default_rng(1)
    means = rng.choice(values, (2000, len(values))).mean(1)
    return float(values.mean()), *np.percentile(means, [2.5, 97.5])


def page(found):
    """Markdown of what `measuring.measured` found."""
    first, last = found["seeds"][0], found["seeds"][-1]
    command = f"python tests/bench/dead_reckoning --seeds {first}:{last + 1} --write"
    about = f"{len(found['seeds'])} worlds, seeds {first} to {last}: twelve directions of each sea state. Mean distance"
    lines = [
        "# Dead reckoning through a minute without GNSS",
        "",
        f"Made by `{command}`.",
        "",
        about,
    ]
    lines += [
        "of the reckoned from the true place over the minute [m], with the 95 % interval of that mean. What they mean"
    ]
    lines += ["is on the page of [dead reckoning](../dead-reckoning.md)."]
    for title, key in (
        ("DP rides on dead reckoning", "rides"),
        ("DP keeps GNSS, as in paper II", "held"),
    ):
        lines += ["", f"## {title}", "", f"| | {' | '.join(STATES)} |", "|---" * 5 + "|"]
        for name, about in NAMES.items():
            lines.append(
                f"| {about} | {' | '.join(_cell(found, found[key][name], state) for state in range(4))} |"
            )
    return "\n".join(lines + _regions(found) + _biased(found)) + "\n"


def _of_state(found, values, state):
    return [value for value, one in zip(values, found["sea_state"], strict=True) if one == state]


def _cell(found, values, state):
    mean, low, high = interval(_of_state(found, values, state))
    return f"{mean:.2f} ({low:.2f} to {high:.2f})"


def _regions(found):
    lines = [
        "",
        "## Regions",
        "",
        "Share of cases within the 90 % region and its mean radius [m], while DP rides on it.",
    ]
    columns = list(next(iter(found["regions"].values())))
    heads = [f"after {one} s" if one.isdigit() else one for one in columns]
    lines += ["", f"| | {' | '.join(heads)} |", "|---" * (len(columns) + 1) + "|"]
    for name, row in found["regions"].items():
        cells = [f"{100 * share:.0f} %, {size:.1f}" for share, size in row.values()]
        lines.append(f"| {NAMES[name]} | {' | '.join(cells)} |")
    return lines


def _biased(found):
    about = "Forward and to starboard each, DP keeps GNSS. Our filter meets it after training; the LSTM learned from it."
    lines = [
        "",
        "## A bias of the velocities by GNSS",
        "",
        about,
        "",
        f"| | {' | '.join(STATES)} |",
        "|---" * 5 + "|",
    ]
    for name, values in found["biased"].items():
        lines.append(
            f"| {name} | {' | '.join(_cell(found, values, state) for state in range(4))} |"
        )
    return lines
