"""Records of dockings replayed by a docking predictor, all starts of all dockings at once in arrays."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipcosim.learn.datasets import mapped, stacked
from shipcosim.learn.docking.records import Record
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wind_loads import WindParameters
from shipcosim.models.prediction import docking, helm
from shipcosim.models.prediction.docking import Own
from shipcosim.models.prediction.helm import LONGEST, Aboard, HelmParameters
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters


@dataclass(frozen=True)
class ShipModel:
    """The ship as the predictor models her: the parameters of its FMU."""

    hull: HullParameters
    wind: WindParameters
    helm: HelmParameters
    mast: MastParameters


@dataclass(frozen=True)
class Replay:
    """Inputs of a predictor from m dockings of n seconds, before anything learned.

    Parameters
    ----------
    harbours : (m,) array
        Of the dockings. [1]
    aboard : Aboard
        What is known, in (m, n) arrays.
    start : Motion
        With heading and velocity averaged over three seconds, in (m, n) arrays.
    own : Own
        The predictor's own record, in (m, n) arrays.
    kinetic, ours : tuples of `LONGEST` Motion
        By the equations of motion from `start`, and from `own`; (m, n) arrays.
    later : dict of str to (`LONGEST` + 1, m, n) array
        x, y, psi as measured in so many seconds and moved on by the age of positions, to learn from; no numbers where
        the record ends before. [m, m, rad]
    truth : dict like later
        The same as it was, to score by.
    """

    harbours: np.ndarray
    aboard: Aboard
    start: Motion
    own: Own
    kinetic: tuple[Motion, ...]
    ours: tuple[Motion, ...]
    later: dict[str, np.ndarray]
    truth: dict[str, np.ndarray]


def replay(records: Sequence[Record], model: ShipModel) -> Replay:
    """Replay records.

    Parameters
    ----------
    records : sequence of Record
        Of one length.
    model : ShipModel
        The ship as the predictor knows her.

    Returns
    -------
    Replay
    """
    # Measurements of all dockings as (m, n) arrays, as the predictor reads them.
    measured = {name: np.stack([record.known[name] for record in records]) for name in helm.KNOWN}
    aboard = helm.aboard_of(measured, model.mast)
    # Measured positions, moved on by their age: these are the targets.
    place = helm.moved_on(aboard.ship, model.helm.position_age)
    # The state that the predictor estimates at each second.
    start, estimated = _followed(aboard, model)
    # Predict from the averaged start, and from the estimated state with its estimated load.
    laws = {"hull": model.hull, "wind": model.wind, "helm": model.helm}
    return Replay(
        np.array([record.harbour for record in records]),
        aboard,
        start,
        estimated,
        helm.predict(aboard._replace(ship=start), **laws),
        helm.predict(aboard._replace(ship=estimated.ship), left=estimated.load, **laws),
        {name: ahead(getattr(place, name)) for name in ("x", "y", "psi")},
        {
            name: ahead(np.stack([record.truth[name] for record in records]))
            for name in ("x", "y", "psi")
        },
    )


def _followed(aboard, model):
    """Averaged starts and estimated states at every second."""
    now = mapped(lambda series: series[:, 0], aboard)
    latest: helm.Start = ()
    estimate = docking.begin(now, model.helm.position_age)
    starts = []
    owns = []
    # Step through the records as the FMU does: each estimate uses only the past.
    for k in range(aboard.wind_speed.shape[1]):
        before = now
        now = mapped(lambda series, k=k: series[:, k], aboard)
        # Update the estimated load from the last second's motion.
        if k:
            estimate = docking.follow(
                estimate, before, now, hull=model.hull, wind=model.wind, helm_=model.helm
            )
        # Average heading and velocity over three seconds: noise matters over 30 s.
        latest = helm.remembered(latest, now.ship)
        starts.append(helm.smoothed(latest, now.ship))
        owns.append(estimate)
    return stacked(starts, np, 1), stacked(owns, np, 1)


def ahead(values: np.ndarray) -> np.ndarray:
    """Values in 0 to `LONGEST` seconds from each second, (`LONGEST` + 1, m, n) array from (m, n); else no numbers."""
    m, n = values.shape
    # NaN where the record ends before the horizon.
    later = np.full((LONGEST + 1, m, n), np.nan)
    for horizon in range(LONGEST + 1):
        later[horizon, :, : n - horizon] = values[:, horizon:]
    return later
