"""Writes docs/generated/dp-sensors.md, the table of the scenarios in scenarios/sensors, and a picture of two.

Run `python docs/generators/write_dp_sensors.py` after sensors, voting or controller have changed. Each row is a run of
a scenario as it stands.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np

from shipcosim.cosim import simulate
from shipcosim.library import build_stale
from shipcosim.scenario import judge, read_scenario
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "scenarios" / "sensors"
SHOWN = ("all_references_lost", "reference_drifts")
"""Scenarios in the picture."""
PAGE = ROOT / "docs" / "generated" / "dp-sensors.md"
PICTURE = ROOT / "docs" / "images" / "dp-sensors.png"
TITLE = """# What happens in each failure of a sensor

Runs of the scenarios in [scenarios/sensors](../../scenarios/sensors), after the ship has settled. \
Times count from the first failure. `python docs/generators/write_dp_sensors.py` makes this table.

"""
REJECTED = [f"position_{i}_rejected" for i in (1, 2, 3)] + [
    "compass_1_rejected",
    "compass_2_rejected",
    "wind_rejected",
]


def run(path):
    """Scenario and table of its run."""
    scenario = read_scenario(path)
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(ROOT)])
    return scenario, simulate(system, scenario)


def row(scenario, table):
    """Row of the page's table: what fails, how soon that is seen, how far off she goes."""
    failed = scenario.events[0].time
    at = {name: table[f"controller.{name}"].values > 0.5 for name in REJECTED}
    at["positions"] = table["controller.positions_used"].values < 3
    at["compasses"] = table["controller.compasses_used"].values < 2
    seen = np.any(list(at.values()), axis=0) & (table["time"].values > failed)
    late = table.sel(time=slice(failed, None))
    distance = float(np.hypot(late["vessel.x"], late["vessel.y"]).max())
    reckoned = float(table["controller.dead_reckoning_time"].max())
    turn = float(np.degrees(np.abs(late["vessel.psi"])).max())
    said = ", ".join(
        name.removesuffix("_rejected").replace("_", " ") for name in REJECTED if at[name].any()
    )
    held = all(verdict.passed for verdict in judge(table, scenario))
    found = f"{table['time'].values[np.argmax(seen)] - failed:.1f}"
    name = scenario.path.stem
    return (
        f"| [{name}](../../scenarios/sensors/{name}.toml) | {scenario.description} | {found} | {said or '-'} | "
        f"{distance:.2f} | {turn:.2f} | {reckoned:.0f} | {'yes' if held else 'NO'} |"
    )


def draw(lost, drifts, picture=PICTURE):
    """Picture: a minute without references, and one that drifts."""
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 5.0), sharex="col", height_ratios=(2, 1))
    for column, table in enumerate((lost, drifts)):
        time = table["time"]
        for i, color in zip((1, 2, 3), ("#88aacc", "#99bb88", "#cc9977"), strict=True):
            measured = table[f"sensors.x_{i}_meas"].where(
                table[f"sensors.position_{i}_valid"] > 0.5
            )
            axes[0, column].plot(time, measured, color=color, lw=0.6, label=f"reference {i}")
        axes[0, column].plot(time, table["vessel.x"], color="#111111", lw=1.4, label="ship")
        axes[0, column].plot(
            time, table["controller.x_hat"], color="#d62728", lw=1.1, label="estimate"
        )
        axes[0, column].set(ylim=(-2.0, 4.0))
        axes[1, column].step(
            time, table["controller.positions_used"], color="#1f77b4", where="post"
        )
        axes[1, column].set(xlabel="time [s]", ylim=(-0.3, 3.3), xlim=(80.0, float(time[-1])))
    axes[0, 0].set(title="all references lost from 240 to 300 s", ylabel="north [m]")
    axes[0, 1].set(title="reference 3 drifts from 120 s on")
    axes[1, 0].set(ylabel="references used")
    axes[0, 1].legend(fontsize=8, loc="lower left", ncols=3)
    figure.tight_layout()
    figure.savefig(picture, dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    runs = {path.stem: run(path) for path in sorted(SCENARIOS.glob("*.toml"))}
    columns = (
        "scenario",
        "what fails",
        "seen after s",
        "rejected",
        "farthest off m",
        "turned deg",
        "reckoned s",
        "holds",
    )
    head = f"| {' | '.join(columns)} |\n"
    rows = "\n".join(row(*one) for one in runs.values())
    text = f"{TITLE}{head}|---|---|---|---|---|---|---|---|\n{rows}\n"
    PAGE.write_text(text, encoding="utf-8")
    draw(*(runs[name][1] for name in SHOWN))
