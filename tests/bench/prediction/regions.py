"""Prediction regions, calibrated in worlds of their own: by horizon and by the predictor's factors.

A predictor is an FMU. It runs alone over the records of worlds, with regions of width 1: its
outputs are then the factors by which it widens regions. The score is error over factor; the width
is its quantile. `python tests/bench/prediction/regions.py --seeds 9801:9901` prints what the regions hold there.
"""

import argparse
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]  # prediction; ships

from prediction import measuring, pages  # noqa: E402
from prediction.rivals import ROOT  # noqa: E402
from shipcosim import library  # noqa: E402
from shipcosim.angles import wrap  # noqa: E402
from shipcosim.cosim import RunOptions, simulate  # noqa: E402
from shipcosim.learn.prediction.worlds import (  # noqa: E402
    KNOWN,
    PARAMETERS,
    SYSTEM,
    TRUTH,
    Record,
)
from shipcosim.learn.regions import SHARE, conformal  # noqa: E402
from shipcosim.learn.true_ships import system_with  # noqa: E402
from shipcosim.models.prediction.regions import HORIZONS, JUST_LOST, LONG_LOST  # noqa: E402
from shipcosim.scenario import Scenario  # noqa: E402
from shipcosim.series import make_table  # noqa: E402
from shipcosim.ssp import read_system, with_values  # noqa: E402

KINDS = ("position", "heading")
STILL = 0.1
"""Speed over ground at the loss below which a ship counts as still. [m/s] Assumed: DP holds her within it."""
STRETCHES = {"1 to 5": (1, 5), "6 to 20": (6, 20), "21 to 60": (21, 60), "later": (61, 999)}
"""Classes of starts: first and last time after the loss of thrust. [s]"""

UNCALIBRATED = {
    **{f"{kind}_half_width_{horizon:.0f}": 1.0 for kind in KINDS for horizon in HORIZONS},
    **{f"{phase}_{kind}_share": 1.0 for phase in ("first", "later") for kind in KINDS},
}
"""Regions of width 1."""


@dataclass(frozen=True)
class Scores:
    """Errors of one record's predictions, against the truth, over the factors by which the predictor widens its regions.

    Parameters
    ----------
    lost_for : (m,) array
        Time from the loss of thrust to the prediction. [s]
    position, heading : (m, 3) array
        By horizon; NaN beyond the end of the record. [m, rad]
    factors : (m, 2) array
        Of position and heading. [1]
    """

    lost_for: np.ndarray
    position: np.ndarray
    heading: np.ndarray
    factors: np.ndarray


def scores(
    record: Record,
    fmu: str = "predictor",
    *,
    settings: Mapping[str, float | str | bool] | None = None,
) -> Scores:
    """Run a predictor over a record, and score its predictions after the loss of thrust.

    Parameters
    ----------
    record : Record
        Of a world.
    fmu : str
        Name of a predictor's FMU, which gets the numbers of the system's predictor.
    settings : mapping of str, optional
        Parameters of the FMU that differ from those of the system's predictor: its variant, for one.

    Returns
    -------
    Scores
        One row a second.
    """
    # Run the FMU, and keep the first row of each new prediction after the loss.
    table = _predictions(record, fmu, settings or {})
    made = np.rint(np.asarray(table[f"{fmu}.predicted_at"])).astype(int)
    kept = np.flatnonzero((made > record.lost_at) & (np.diff(made, prepend=-1) > 0))
    made = made[kept]
    position = np.full((len(kept), 3), np.nan)
    heading = np.full((len(kept), 3), np.nan)
    # Errors at each horizon; NaN where the record ends before it.
    for i, horizon in enumerate(int(h) for h in HORIZONS):
        inside = made + horizon < len(record.time)
        then = record.truth[made[inside] + horizon]
        x, y, psi = (
            np.asarray(table[f"{fmu}.{name}_{horizon}"])[kept][inside] for name in ("x", "y", "psi")
        )
        position[inside, i], heading[inside, i] = (
            np.hypot(x - then[:, 0], y - then[:, 1]),
            abs(wrap(psi - then[:, 2])),
        )
    # Regions of width 1: the output is the factor itself. It is 0 while thrust is available.
    names = f"{fmu}.position_region_10", f"{fmu}.heading_region_10"
    factors = np.column_stack([np.asarray(table[name])[kept] for name in names])
    without = factors[:, 0] > 0.0
    # One prediction a second, so the count is the time since the loss.
    lost_for = np.cumsum(without).astype(float)
    made_in = [values[without] for values in (lost_for, position, heading, factors)]
    # Score = error over factor.
    return Scores(
        made_in[0], made_in[1] / made_in[3][:, :1], made_in[2] / made_in[3][:, 1:], made_in[3]
    )


def phases(lost_for: np.ndarray) -> np.ndarray:
    """By the time since thrust was lost: 0 just after the loss, 1 in the drift, 2 in a long drift."""
    return np.digitize(lost_for, (JUST_LOST, LONG_LOST), right=True)


def within(found: Scores, widths: Mapping[str, float], kind: str) -> np.ndarray:
    """Which predictions have the truth in their region, (m, 3); NaN beyond the end of the record."""
    shares = np.array([widths[f"first_{kind}_share"], 1.0, widths[f"later_{kind}_share"]])
    limits = np.array([widths[f"{kind}_half_width_{horizon:.0f}"] for horizon in HORIZONS])
    scored = getattr(found, kind)
    held = scored <= limits * shares[phases(found.lost_for)][:, None]
    return np.where(np.isfinite(scored), held, np.nan)


def calibrated(found: Sequence[Scores]) -> dict[str, float]:
    """Widths that contain the wanted share of the cases, from worlds used for nothing else.

    Starts within a world are dependent, worlds are independent: the quantile is over all starts, at
    the level 0.9 (1 + 1/n) with n worlds.

    Parameters
    ----------
    found : sequence of Scores
        One a world.

    Returns
    -------
    dict of str to float
        Parameters of `models.prediction.regions.RegionParameters`. Each share is of all horizons together.
    """
    # Level for n independent worlds (split conformal).
    level = min(1.0, SHARE * (1.0 + 1.0 / len(found)))
    lost_for = np.concatenate([s.lost_for for s in found])
    phase = phases(lost_for)
    widths = {}
    for kind in KINDS:
        errors = np.concatenate([getattr(s, kind) for s in found])
        # Widths in the drift by horizon, and how much wider or narrower all are before and after it.
        of_drift = [conformal(scores, level) for scores in errors[phase == 1].T]
        widths |= {
            f"{kind}_half_width_{horizon:.0f}": width
            for horizon, width in zip(HORIZONS, of_drift, strict=True)
        }
        for name, which in (("first", 0), ("later", 2)):
            widths[f"{name}_{kind}_share"] = conformal(
                (errors[phase == which] / of_drift).ravel(), level
            )
    return widths


def _predictions(record: Record, fmu: str, settings: Mapping[str, float | str | bool]):
    """Table of a predictor's outputs over a record, one row a second."""
    # The predictor gets the parameters of the system's predictor that it has too.
    nominal = system_with(SYSTEM, PARAMETERS)
    system = read_system(library.find("fmu", fmu))
    known = system.components[fmu].fmu.variables
    values = {
        name: value
        for name, value in nominal.components["predictor"].start.items()
        if name in known
    }
    # Width 1 everywhere: outputs are then the bare factors.
    values |= {**UNCALIBRATED, **settings}
    system = with_values(system, {f"{fmu}.{name}": value for name, value in values.items()})
    # Feed the recorded estimates as inputs, and run the FMU alone.
    columns = [
        (name, record.known[:, i], known[name].unit or "1", name) for i, name in enumerate(KNOWN)
    ]
    scenario = Scenario(system=fmu, stop_time=float(record.time[-1]), step_size=1.0)
    return simulate(system, scenario, RunOptions(inputs=make_table(record.time, columns)))


def shares_held(
    found: Sequence[Scores], widths: Mapping[str, float], first: int, last: int
) -> list[str]:
    """Share of the truths within regions that starts of some seconds after the loss have, by kind and horizon.

    Parameters
    ----------
    found : sequence of Scores
        One a world.
    widths : mapping of str to float
        As `calibrated` gives them.
    first, last : int
        Of the starts. [s]
    """
    cells = []
    for kind in KINDS:
        of_worlds = [
            np.nanmean(
                within(one, widths, kind)[(first <= one.lost_for) & (one.lost_for <= last)], axis=0
            )
            for one in found
        ]
        share, low, high = (100.0 * one for one in pages.interval(np.array(of_worlds)))
        cells += [f"{share[k]:.0f} % ({low[k]:.0f} to {high[k]:.0f})" for k in range(len(HORIZONS))]
    return cells


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="9801:9901", help="FROM:TO of worlds")
    parser.add_argument("--into", type=Path, default=measuring.FOLDER, help="records")
    options = parser.parse_args(arguments)
    records = [
        measuring.recorded(seed, 1.0, options.into)
        for seed in range(*map(int, options.seeds.split(":")))
    ]
    at_loss = [record.truth[record.time == record.lost_at][0] for record in records]
    speeds = np.hypot(*np.array(at_loss)[:, [TRUTH.index("u"), TRUTH.index("v")]].T)
    classes = {"still": speeds < STILL, "moving": speeds >= STILL}
    learned = ROOT / "fmus/drift_predictor/weights/regions.toml"
    widths = {
        "drift_predictor": tomllib.loads(learned.read_text(encoding="utf-8"))["ours"],
        "predictor": system_with(SYSTEM, PARAMETERS).components["predictor"].start,
    }
    rows = []
    for fmu in widths:
        settings = {"own_regions": False} if fmu == "drift_predictor" else {}
        found = [scores(record, fmu, settings=settings) for record in records]
        for label, worlds in classes.items():
            chosen = [one for one, is_chosen in zip(found, worlds, strict=True) if is_chosen]
            rows += [
                (fmu, label, name, *shares_held(chosen, widths[fmu], *ends))
                for name, ends in STRETCHES.items()
                if chosen
            ]
    head = [f"{what}, {end:.0f} s" for what in ("place", "heading") for end in HORIZONS]
    print(f"{len(records)} worlds, {classes['still'].sum()} of them still at the loss")
    print(pages.table(("regions of", "at the loss", "starts", *head), rows))


if __name__ == "__main__":
    main()
