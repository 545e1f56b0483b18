"""Writes fmus/drift_predictor/weights/regions.toml: 90 % regions of its variants, calibrated on worlds 200 to 299.

Run `python docs/generators/write_regions.py` after the weights or the models of prediction have changed; it takes half
an hour. Those of the kinetic predictor are printed, for ssp/ships/gunnerus-33m9/predictor.toml.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "tests")]

from prediction.regions import calibrated, scores  # noqa: E402
from shipcosim.learn.prediction.worlds import draw, sail_all  # noqa: E402

FILE = ROOT / "fmus" / "drift_predictor" / "weights" / "regions.toml"
SEEDS = range(200, 300)
HEAD = "# Regions with 90 % of the truths, by variant; written by docs/generators/write_regions.py, worlds 200-299.\n"


def regions(records, variant=None):
    """Parameters of the regions of a variant, or of the kinetic predictor."""
    fmu, settings = (
        ("predictor", {}) if variant is None else ("drift_predictor", {"variant": variant})
    )
    settings |= {} if variant is None else {"own_regions": False}
    return calibrated([scores(record, fmu, settings=settings) for record in records])


def section(widths):
    """The parameters as lines of TOML."""
    return "".join(f"{name} = {value:.4f}\n" for name, value in widths.items())


if __name__ == "__main__":
    worlds = sail_all(
        [draw(seed) for seed in SEEDS],
        progress=lambda done, total: print(done, total, file=sys.stderr),
    )
    print(section(regions(worlds)))
    variants = sorted(file.stem for file in FILE.parent.glob("*.npz"))
    parts = [f"\n[{variant}]\n{section(regions(worlds, variant))}" for variant in variants]
    FILE.write_text(HEAD + "".join(parts), encoding="utf-8")
