"""Draws docs/images/allocation.png: the four-corner test with several allocators, after figures 6 to 10 of paper V.

Run `python docs/generators/write_allocation.py` after an allocator, the loop or the scenario has changed; a run takes
half a minute alone on a core.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from shipcosim.cosim import simulate
from shipcosim.library import build_stale
from shipcosim.scenario import read_scenario
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs" / "images" / "allocation.png"
LAWS = {
    "allocator": "#8a8f98",
    "extended_allocator": "#c8632b",
    "optimal_allocator": "#2a78b8",
}
"""Those for this ship: the network of paper V is for the one of 28.9 m."""
UNITS = ("port", "starboard", "tunnel")
MEAN = 60  # rows of half a second that power and losses are averaged over


def run(law):
    """Table of the four-corner test with an allocator."""
    scenario = read_scenario(ROOT / "scenarios" / "four_corner.toml")
    folder = build_stale(ROOT)
    parts = {"allocator": Path(folder) / f"{law}.fmu"}
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[folder], components=parts)
    return simulate(system, scenario)


def averaged(values):
    """Moving mean over `MEAN` rows, cut off at both ends."""
    return np.convolve(values, np.ones(MEAN) / MEAN, "same")


def curves(table):
    """What the panels below the track draw: values by title."""
    time, off = table.time.values, [table[f"vessel.{a}"].values - table[f"reference.{a}_d"].values for a in "xy"]
    found = {"distance from the reference [m]": np.hypot(*off)}
    for unit in UNITS:
        found[f"thrust, {unit} [kN]"] = table[f"{unit}.thrust"].values / 1e3
    for unit in UNITS[:2]:
        angle = np.degrees(np.unwrap(table[f"{unit}.azimuth"].values))
        found[f"angle, {unit} [deg]"] = angle
    found["power, mean of 30 s [kW]"] = averaged(table["allocator.thruster_power"].values) / 1e3
    missed = np.hypot(table["allocator.slack_X"].values, table["allocator.slack_Y"].values)
    found["force missed, mean of 30 s [N]"] = averaged(missed)
    return time, found


def draw(path, tables):
    """The picture of runs by their allocator."""
    figure, axes = plt.subplots(5, 2, figsize=(11.0, 13.0), layout="constrained")
    track, *panels = axes.flat
    for law, table in tables.items():
        look = dict(color=LAWS[law], linewidth=1.1, label=law)
        track.plot(table["vessel.y"], table["vessel.x"], **look)
        time, found = curves(table)
        for panel, (title, values) in zip(panels, found.items(), strict=False):
            panel.plot(time, values, **look)
            panel.set_title(title, fontsize=9, loc="left")
    track.set_title("track [m], north up", fontsize=9, loc="left")
    track.set_aspect("equal", "datalim")
    track.legend(fontsize=8)
    for panel in axes.flat:
        panel.grid(True, color="#eeeeee", linewidth=0.6)
        panel.tick_params(labelsize=8)
    for panel in panels[len(found) :]:
        panel.remove()
    panels[-2].set_yscale("symlog", linthresh=10.0)
    for panel in axes[-1]:
        panel.set_xlabel("time [s]", fontsize=8)
    figure.savefig(path, dpi=90)


if __name__ == "__main__":
    draw(PICTURE, {law: run(law) for law in LAWS})
