"""Draws docs/images/docking.png: error by horizon for each docking, and a way in with predictions, after paper III.

Run `python docs/generators/write_docking.py` after docs/generated/docking.json has changed, which
`python tests/bench/docking --held-out --write` measures.
"""

import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NUMBERS, PICTURE = (
    ROOT / "docs" / "generated" / "docking.json",
    ROOT / "docs" / "images" / "docking.png",
)
COLOURS = {"kinetic": "#c8632b", "paper III": "#7a6bb0", "ours": "#2f77b5"}
TITLES = {"familiar": "familiar harbours", "unseen": "unseen harbours"}


def draw(path, found):
    """The picture of what the bench found."""
    figure, axes = plt.subplots(
        1, 3, figsize=(13.0, 4.4), layout="constrained", width_ratios=(1.0, 1.0, 1.3)
    )
    most = 1.05 * max(np.max(found["error_m"][kind]["ours"]) for kind in TITLES)
    for panel, kind in zip(axes, TITLES, strict=False):
        _errors(panel, found["error_m"][kind])
        panel.set_ylim(0.0, max(most, panel.get_ylim()[1]))
        panel.set_title(f"{TITLES[kind]}; thin: ours, each docking", fontsize=9)
    axes[0].set_ylabel("mean error of the place [m]", fontsize=9)
    _way(axes[2], found["track"])
    for panel in axes:
        panel.tick_params(labelsize=8)
        panel.spines[["top", "right"]].set_visible(False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def _errors(panel, found):
    """Errors by horizon: of each docking by ours, and means of the predictors."""
    seconds = np.arange(1, 31)
    for one in found["ours"]:
        panel.plot(seconds, one, color="0.75", linewidth=0.7)
    for name, colour in COLOURS.items():
        panel.plot(seconds, np.mean(found[name], axis=0), color=colour, linewidth=2.0, label=name)
    panel.set_xlabel("seconds ahead", fontsize=9)
    panel.legend(fontsize=8, frameon=False)


def _way(panel, track):
    """The last way in, and predictions of 30 s every 45 s."""
    x, y = np.array(track["x"]), np.array(track["y"])
    near = int(np.argmax(np.hypot(x, y) < 700.0))
    panel.plot(y[near:], x[near:], color="0.3", linewidth=1.0, label="true way")
    for name in ("kinetic", "ours"):
        label = f"{name}, 30 s"
        for start, (north, east) in zip(track["starts"], track[name], strict=True):
            if start >= near:
                panel.plot(east, north, color=COLOURS[name], linewidth=1.6, label=label)
                panel.plot(east[-1], north[-1], ".", color=COLOURS[name], markersize=5)
                label = None
    panel.set_aspect("equal", adjustable="datalim")
    panel.set_xlabel("east [m]", fontsize=9)
    panel.set_ylabel("north [m]", fontsize=9)
    panel.set_title(f"predictions every 45 s, docking {track['seed']:.0f}", fontsize=9)
    panel.legend(fontsize=8, frameon=False)


if __name__ == "__main__":
    draw(PICTURE, json.loads(NUMBERS.read_text(encoding="utf-8")))
