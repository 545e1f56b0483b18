"""Draws docs/images/dead-reckoning.png: mean error by direction and sea state, after Fig. 10 of paper II.

Run `python docs/generators/write_dead_reckoning.py` after docs/generated/dead-reckoning.json has changed, which
`python tests/bench/dead_reckoning --seeds 8100:8148 --write` measures.
"""

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NUMBERS, PICTURE = (
    ROOT / "docs" / "generated" / "dead-reckoning.json",
    ROOT / "docs" / "images" / "dead-reckoning.png",
)
COLOURS = ("#9ec9e8", "#4f97cf", "#c8632b", "#7a2d12")
LAWS = {
    "motion-filter": "our filter",
    "paper-ii": "LSTM, paper II",
    "kalman": "Kalman filter, paper II",
}
ROWS = {"held": "DP keeps GNSS, as in paper II", "rides": "DP rides on dead reckoning"}


def draw(path, found):
    """The picture of what the bench found."""
    figure, axes = plt.subplots(
        2, 3, figsize=(11.0, 8.0), subplot_kw={"projection": "polar"}, layout="constrained"
    )
    for line, (key, about) in zip(axes, ROWS.items(), strict=True):
        most = np.percentile([value for name in LAWS for value in found[key][name]], 97.0)
        for panel, (name, title) in zip(line, LAWS.items(), strict=True):
            panel.set_theta_zero_location("N")
            panel.set_theta_direction(-1)
            panel.set_ylim(0.0, most)
            panel.set_title(f"{title}\n{about}", fontsize=9)
            panel.tick_params(labelsize=7)
            for state, colour in enumerate(COLOURS):
                _ring(panel, found, found[key][name], state, colour)
    axes[0, 0].legend(fontsize=7, loc="lower left", bbox_to_anchor=(-0.25, -0.15))
    figure.suptitle(
        "Mean error over a minute without GNSS [m], by where wind and waves come from", fontsize=10
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def _ring(panel, found, values, state, colour):
    """Errors of one sea state, closed to a ring."""
    rows = zip(found["direction_deg"], values, found["sea_state"], strict=True)
    points = sorted((angle, value) for angle, value, one in rows if one == state)
    angles, radii = np.array([*points, points[0]]).T
    panel.plot(np.radians(angles), radii, color=colour, linewidth=1.4, label=f"Hs {state + 1} m")


if __name__ == "__main__":
    draw(PICTURE, json.loads(NUMBERS.read_text(encoding="utf-8")))
