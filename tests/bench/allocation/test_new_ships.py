"""What the consequence analysis says of ships made from a few numbers, against each loss simulated.

`python -m tests.bench.allocation.test_new_ships [seed]` prints what docs/reports/allocation.md says of them.
"""

import os
import sys
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from typer.testing import CliRunner

import shipcosim
from shipcosim.cli.app import app

SHIPS = {
    "a catamaran's square hull": ("azimuths", "12 m", "6 m", "0.8 m"),
    "a workboat": ("azimuths", "25 m", "8 m", "2.5 m"),
    "a supply vessel": ("azimuths", "60 m", "14 m", "4.5 m"),
    "a large one": ("azimuths", "120 m", "24 m", "7 m"),
    "two screws, two tunnels": ("screws", "90 m", "20 m", "6 m"),
}
"""Propulsion, length, breadth and draught; all else is estimated."""
WINDS = (5.0, 8.0, 10.0)  # m/s
FAILS = 200.0  # s
HELD = 1.25  # share that the alarms of the analysis ask for
DIRECTIONS = range(0, 360, 30)  # deg


def outcomes(propulsion, length, breadth, draught, seed=7) -> list[dict]:
    """What was said before each loss, and how far she is off after it; without those of a ship that was off before."""
    with TemporaryDirectory() as folder:
        before = Path.cwd()
        os.chdir(folder)
        try:
            Path("scenarios").mkdir()
            sizes = ["--length", length, "--breadth", breadth, "--draught", draught]
            made = ["new", "ship", "tern", *sizes, "--propulsion", propulsion, "--yes"]
            assert CliRunner().invoke(app, made).exit_code == 0
            return [row for row in _simulated(propulsion, seed) if row["before"] < 5.0]
        finally:
            os.chdir(before)


def _simulated(propulsion, seed):
    units = ("port", "starboard", "bow", *["stern"] * (propulsion == "screws"))
    cases = list(product(WINDS, DIRECTIONS, range(len(units))))
    variations = [
        {
            "environment.wind_speed": speed,
            "environment.wind_from": f"{at} deg",
            "environment.waves_from": f"{at} deg",
            "environment.significant_wave_height": 0.007 * speed**2,
            "environment.seed": seed,
            "events": [{"time": FAILS, "override": {f"{units[unit]}.failed": True}}],
        }
        for speed, at, unit in cases
    ]
    found = shipcosim.simulate_many(
        scenario="tern", variations=variations, reduce=_reduced, stop_time=600.0
    )
    for number, (_, _, unit) in enumerate(cases):
        one = {name: float(found[name].values[number]) for name in found if name != "error"}
        yield one | {name: one[f"{name}_without_{unit + 1}"] for name in ("share", "force_share")}


def _reduced(table):
    time = table["time"].values
    before = (time > 0.5 * FAILS) & (time < FAILS)
    late = time > 2.0 * FAILS
    off = np.hypot(table["vessel.x"].values, table["vessel.y"].values)
    psi = table["vessel.psi"].values
    said = {
        f"{name}_without_{unit}": table[f"consequences.{name}_without_{unit}"].values[before][-1]
        for name, unit in product(("share", "force_share"), range(1, 5))
    }
    return said | {
        "before": off[before].max(),
        "late_off": off[late].max(),
        "late_turned": np.degrees(np.abs(np.arctan2(np.sin(psi), np.cos(psi))))[late].max(),
    }


def counts(rows: list[dict]) -> dict[str, int]:
    """Losses, headings lost, of these not foretold, foretold and kept, positions lost that were said to be held."""
    lost = [row["late_turned"] > 10.0 for row in rows]
    warned = [row["share"] < HELD for row in rows]
    pairs = list(zip(lost, warned, strict=True))
    return {
        "losses": len(rows),
        "heading lost": sum(lost),
        "not foretold": pairs.count((True, False)),
        "foretold and kept": pairs.count((False, True)),
        "position lost unforetold": sum(
            row["late_off"] > 5.0 and row["force_share"] >= HELD for row in rows
        ),
    }


@pytest.mark.parametrize("ship", SHIPS)
def test_what_is_lost_was_foretold(ship):
    found = counts(outcomes(*SHIPS[ship]))
    assert found["losses"] >= 90
    assert found["not foretold"] <= 3  # the most of the seeds 7 and 11
    assert found["position lost unforetold"] == 0


if __name__ == "__main__":
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 7
    for name, ship in SHIPS.items():
        shown = "  ".join(f"{key} {value}" for key, value in counts(outcomes(*ship, seed)).items())
        print(f"{name}: {shown}")
