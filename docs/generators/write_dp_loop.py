"""Writes docs/generated/dp-loop.md, the table of margins, and the picture of loop gains and sensitivities.

Run `python docs/generators/write_dp_loop.py` after observer, control law or their parameters have changed.
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from shipcosim.models.control.margins import AXES, Delays, linear_loop, margins, open_loop
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.ships import read_ship

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests")]

from wave_suppression import wave_suppression  # noqa: E402

PAGE = ROOT / "docs" / "generated" / "dp-loop.md"
PICTURE = ROOT / "docs" / "images" / "dp-loop.png"
TITLE = """# Margins of the DP loop

By peak period of the waves and axis. `python docs/generators/write_dp_loop.py` makes this table.

"""
COLUMNS = (
    "peak period [s]",
    "axis",
    "crossover [rad/s]",
    "phase margin [deg]",
    "gain margin",
    "Ms",
    "delay margin [s]",
    "waves at the peak [dB]",
)
HEAD = f"| {' | '.join(COLUMNS)} |\n{'|---' * len(COLUMNS)}|\n"
PERIODS = (4, 5, 6, 8, 10, 12)  # s
SHOWN = {6: "-", 12: "--"}
"""Peak periods in the picture, and their line styles. [s]"""
COLORS = ("#2a78b8", "#c8632b", "#3d8f4f")


def loops():
    """Linear loop by peak period, and the control law."""
    ship = read_ship(ROOT / "ssp" / "ships" / "gunnerus-33m9")
    model, noise = (
        ship.parameters(DpShip, "controller"),
        ship.parameters(ObserverParameters, "controller"),
    )
    law = ship.parameters(ControlParameters, "controller")
    return {
        period: linear_loop(model, noise, law, Delays(), 2.0 * np.pi / period) for period in PERIODS
    }, law


def rows(found, law):
    """Rows of the table."""
    for period, loop in found.items():
        for axis, name in enumerate(AXES):
            one = margins(loop, axis)
            waves = 20.0 * np.log10(
                wave_suppression(loop, axis, np.array([2.0 * np.pi / period]), law)[0]
            )
            yield (
                f"| {period} | {name} | {one.crossover:.3f} | {np.degrees(one.phase):.0f} | {one.gain:.1f} | "
                f"{one.sensitivity:.2f} | {one.delay:.1f} | {waves:.0f} |\n"
            )


def draw(found, picture=PICTURE):
    """Picture: size and angle of the loop gain and size of the sensitivity over the frequency, by axis and sea."""
    w = np.geomspace(0.005, 2.0, 300)
    figure, axes = plt.subplots(
        3, 1, figsize=(8.0, 8.5), sharex=True, height_ratios=(3, 3, 2), layout="constrained"
    )
    for period, style in SHOWN.items():
        for axis, (name, color) in enumerate(zip(AXES, COLORS, strict=True)):
            gain = open_loop(found[period], axis, w)
            look = dict(
                color=color, linestyle=style, linewidth=1.4, label=f"{name}, waves of {period} s"
            )
            axes[0].loglog(w, np.abs(gain), **look)
            angle = np.unwrap(np.angle(gain))
            axes[1].semilogx(w, np.degrees(angle - 2.0 * np.pi * (angle[0] > 0.0)), **look)
            axes[2].semilogx(w, 1.0 / np.abs(1.0 + gain), **look)
    axes[0].set(ylabel="loop gain |L| [1]", ylim=(0.01, 100.0))
    axes[0].axhline(1.0, color="#888888", linewidth=0.8)
    axes[0].legend(fontsize=8, ncols=2)
    axes[1].set(
        ylabel="angle of L [deg]", ylim=(-360.0, -90.0), yticks=(-360, -270, -180, -140, -90)
    )
    axes[1].axhline(-180.0, color="#888888", linewidth=0.8)
    axes[1].axhline(-140.0, color="#888888", linewidth=0.8, linestyle=":")
    axes[2].set(
        ylabel="sensitivity |1/(1+L)| [1]",
        xlabel="frequency [rad/s]",
        ylim=(0.0, 2.2),
        xlim=(w[0], w[-1]),
    )
    axes[2].axhline(2.0, color="#888888", linewidth=0.8, linestyle=":")
    for part in axes:
        part.grid(True, which="both", color="#eeeeee", linewidth=0.6)
    figure.savefig(picture, dpi=110)
    plt.close(figure)


def write_dp_loop():
    """Write the table and draw the picture."""
    found, law = loops()
    PAGE.write_text(TITLE + HEAD + "".join(rows(found, law)), encoding="utf-8")
    draw(found)


if __name__ == "__main__":
    write_dp_loop()
