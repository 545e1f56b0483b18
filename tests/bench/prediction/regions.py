"""Prediction regions, calibrated in worlds of their own: by horizon and by the predictor's factors.

A predictor is an FMU. It runs alone over the records of worlds, with regions of width 1: its
outputs are then the factors by which it widens regions. The score is error over factor; the width
is its quantile.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim import library
from shipcosim.angles import wrap
from shipcosim.cosim import RunOptions, simulate
from shipcosim.learn.prediction.worlds import KNOWN, PARAMETERS, SYSTEM, Record
from shipcosim.learn.regions import SHARE, conformal
from shipcosim.learn.true_ships import system_with
from shipcosim.models.prediction.regions import HORIZONS, JUST_LOST, LONG_LOST
from shipcosim.scenario import Scenario
from shipcosim.series import make_table
from shipcosim.ssp import read_system, with_values

UNCALIBRATED = {
    **{
        f"{kind}_half_width_{horizon:.0f}": 1.0
        for kind in ("position", "heading")
        for horizon in HORIZONS
    },
    **{
        f"{phase}_{kind}_share": 1.0
        for phase in ("first", "later")
        for kind in ("position", "heading")
    },
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
    phase = np.digitize(lost_for, (JUST_LOST, LONG_LOST), right=True)
    widths = {}
    for kind in ("position", "heading"):
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
