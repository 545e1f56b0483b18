"""Draws the pictures of docs/reports/allocation.md: runs with several allocators, after figures 6 to 12 of paper V.

Run `python docs/generators/write_allocation.py`, with names of pictures or for all of them, after an allocator, the
loop or a scenario has changed; a run takes half a minute alone on a core.
"""

import sys
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
IMAGES = ROOT / "docs" / "images"
PAPER_V = "paper_v_allocator"
PICTURES = {
    "allocation": (
        "four_corner",
        {
            "allocator": ("allocator", None),
            "extended_allocator": ("extended_allocator", None),
            "optimal_allocator": ("optimal_allocator", None),
        },
    ),
    "allocation_k4": (
        "allocation/paper_v_stationkeeping",
        {
            "k4 = 1e-7": (PAPER_V, "paper-v"),
            "k4 = 3e-7": (PAPER_V, "paper-v-k4-3"),
            "k4 = 5e-7": (PAPER_V, "paper-v-k4-5"),
        },
    ),
}
"""Picture: scenario, and by the words of the legend the allocator and the variant of its network."""
COLOURS = ("#8a8f98", "#c8632b", "#2a78b8")
UNITS = ("port", "starboard", "tunnel")
MEAN = 60  # rows of half a second that power and losses are averaged over
SECTOR = (80.0, 100.0)  # deg to either side: forbidden


def run(name, law, variant):
    """Table of a scenario with an allocator."""
    scenario = read_scenario(ROOT / "scenarios" / f"{name}.toml")
    values = {key: value for key, value in scenario.set.items() if key != "allocator.variant"}
    if variant:
        values["allocator.variant"] = variant
    folder = build_stale(ROOT)
    parts = {"allocator": Path(folder) / f"{law}.fmu"}
    system = read_system(
        scenario.system_path, scenario.parameter_paths, fmus=[folder], components=parts
    )
    return simulate(system, scenario.model_copy(update={"set": values}))


def averaged(values):
    """Moving mean over `MEAN` rows, over fewer at both ends."""
    window = np.ones(MEAN)
    return np.convolve(values, window, "same") / np.convolve(np.ones_like(values), window, "same")


def curves(table):
    """What the panels below the first draw: values by title."""
    off = [table[f"vessel.{a}"].values - table[f"reference.{a}_d"].values for a in "xy"]
    found = {"distance from the reference [m]": np.hypot(*off)}
    for unit in UNITS:
        found[f"thrust, {unit} [kN]"] = table[f"{unit}.thrust"].values / 1e3
    for unit in UNITS[:2]:
        found[f"angle, {unit} [deg]"] = np.degrees(np.unwrap(table[f"{unit}.azimuth"].values))
    found["power, mean of 30 s [kW]"] = averaged(table["allocator.thruster_power"].values) / 1e3
    missed = np.hypot(table["allocator.slack_X"].values, table["allocator.slack_Y"].values)
    found["force missed, mean of 30 s [N]"] = averaged(missed)
    return found


def draw(path, tables):
    """The picture of runs by the words of the legend."""
    figure, axes = plt.subplots(5, 2, figsize=(11.0, 13.0), layout="constrained")
    first, *panels = axes.flat
    moves = max(np.ptp(table["reference.x_d"].values) for table in tables.values()) > 1.0
    for (label, table), colour in zip(tables.items(), COLOURS, strict=True):
        look = dict(color=colour, linewidth=1.1, label=label)
        time = table.time.values
        across = table["vessel.y"].values if moves else time
        first.plot(across, table["vessel.x"] if moves else np.degrees(table["vessel.psi"]), **look)
        found = curves(table)
        for panel, (title, values) in zip(panels, found.items(), strict=False):
            panel.plot(time, values, **look)
            panel.set_title(title, fontsize=9, loc="left")
            if title.startswith("angle"):
                shade(panel, values)
    first.set_title("track [m], north up" if moves else "heading [deg]", fontsize=9, loc="left")
    if moves:
        first.set_aspect("equal", "datalim")
    first.legend(fontsize=8)
    for panel in axes.flat:
        panel.grid(True, color="#eeeeee", linewidth=0.6)
        panel.tick_params(labelsize=8)
    for panel in panels[len(found) :]:
        panel.remove()
    panels[len(found) - 1].set_yscale("symlog", linthresh=10.0)
    for panel in panels[len(found) - 2 : len(found)]:
        panel.set_xlabel("time [s]", fontsize=8)
    figure.savefig(path, dpi=90)
    plt.close(figure)


def shade(panel, degrees):
    """Forbidden sectors between the least and the largest angle."""
    for turn in range(
        int(np.floor(degrees.min() / 180.0)), int(np.floor(degrees.max() / 180.0)) + 1
    ):
        panel.axhspan(
            SECTOR[0] + 180.0 * turn,
            SECTOR[1] + 180.0 * turn,
            color="#f3dede",
            linewidth=0.0,
            zorder=0,
        )


if __name__ == "__main__":
    for picture in sys.argv[1:] or PICTURES:
        scenario, laws = PICTURES[picture]
        draw(IMAGES / f"{picture}.png", {label: run(scenario, *law) for label, law in laws.items()})
