"""Regions around docking predictions that hold the ship in 90 % of cases: conformal, by horizon.

References
----------
As `models.prediction.regions`.
"""

import numpy as np

from shipcosim.angles import wrap
from shipcosim.learn.docking.inputs import Replay, ahead
from shipcosim.learn.docking.predictions import Places, Predicted, own_record
from shipcosim.learn.regions import conformal
from shipcosim.models.prediction import docking

HORIZONS = (10, 20, 30)
"""Horizons of the regions. [s]"""


def misses(places: Places, after: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Distances and headings by which predictions miss at `HORIZONS`: two (3, m, n) arrays. [m, rad]"""
    position = []
    heading = []
    for horizon in HORIZONS:
        x, y, psi = places[horizon - 1]
        position.append(np.hypot(after["x"][horizon] - x, after["y"][horizon] - y))
        heading.append(abs(wrap(after["psi"][horizon] - psi)))
    return np.stack(position), np.stack(heading)


def measured_later(replay: Replay) -> dict[str, np.ndarray]:
    """Where she was later by her own measurements: `Replay.later` with places averaged over three seconds.

    A single place is 0.2 m off north and east, as much as a prediction of 10 s; three leave 0.1 m, which stands for the
    slow error of the receiver, that no comparison with itself shows.
    """
    # Average the targets over three seconds; both ends keep their single measurement.
    later = dict(replay.later)
    for name in ("x", "y"):
        values = later[name][0]
        mean = (values[:, :-2] + values[:, 1:-1] + values[:, 2:]) / 3.0
        later[name] = ahead(np.concatenate((values[:, :1], mean, values[:, -1:]), axis=1))
    return later


def calibrated(predicted: Predicted, replay: Replay) -> np.ndarray:
    """Widths for `docking.regions`, from dockings that no other choice used.

    The quantile is that of all starts of all dockings. Starts within a docking are no independent cases, so with few
    dockings the share of other dockings scatters about 0.9; the level 0.9 (1 + 1/m) of m independent cases was too much
    on the dockings of the choices, where regions had 96 to 98 %. Misses are those against `measured_later`.
    """
    # The predictor's recent errors widen its regions; here by a factor relative to ordinary errors.
    errors = own_record(predicted.places, replay)
    after = measured_later(replay)
    # Ordinary errors: the medians over all starts.
    ordinary = [float(np.median(error)) for error in errors]
    factors = [row[0] for row in docking.regions(np.array([*np.ones(6), *ordinary]), errors)]
    widths = []
    # Score = error over factor. Its quantile at rank ceil(0.9 n) is the width (split conformal).
    for scores, factor in zip(misses(predicted.places, after), factors, strict=True):
        for miss in scores:
            widths.append(conformal(miss / factor))
    return np.array([*widths, *ordinary])
