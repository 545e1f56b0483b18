"""Writes the tables of docs/manoeuvres.md: what the manoeuvres are for Gunnerus, and what each shows of each cause.

Run `python docs/write_manoeuvres.py` after a manoeuvre, a cause or a number of the ship has changed; it takes seconds.
"""

from pathlib import Path

import numpy as np

from shipcosim.cli.project import build_stale
from shipcosim.diagnose.experiment.design import testability
from shipcosim.diagnose.experiment.manoeuvres import library
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.inference.innovations import Noise
from shipcosim.diagnose.ship.model import ship_model_of
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "manoeuvres.md"
BEGIN, END = "<!-- tables: written by docs/write_manoeuvres.py -->\n", "<!-- end of the tables -->"
WIND = 6.0, np.radians(30.0)
WHITE = np.array([0.2, 0.2, np.radians(0.1), 0.02, 0.02, np.radians(0.05)])
NOISE = Noise(WHITE, np.array([1e-3, 1e-3, 1e-4]), np.array([1e-5, 1e-5, 1e-6]))


def tables():
    """Both tables as Markdown."""
    model = ship_model_of(read_system(ROOT / "ssp" / "gunnerus_open", fmus=[build_stale(ROOT)]))
    manoeuvres = library(model)
    lines = ["| | manoeuvre | minutes |", "|---|---|---|"]
    lines += [f"| {i} | {one.name} | {one.minutes:g} |" for i, one in enumerate(manoeuvres, start=1)]
    numbers = " | ".join(str(i) for i in range(1, 1 + len(manoeuvres)))
    lines += ["", f"| cause of typical size | {numbers} |", "|---" * (1 + len(manoeuvres)) + "|"]
    found = testability(model, hypotheses_of(read_catalogue(), model), NOISE, manoeuvres, WIND)
    lines += [f"| {label.replace('_', ' ')} | {' | '.join(map(_nats, nats))} |" for label, nats in found.items()]
    return "\n".join(lines) + "\n"


def _nats(value):
    return "not sailed" if np.isnan(value) else "" if value < 1.0 else f"{value:.0f}"


if __name__ == "__main__":
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    PAGE.write_text(before + BEGIN + tables() + END + rest.split(END)[1], encoding="utf-8")
