"""Errors of the simulation of one log, before and after, by numbers that this log did not give."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from shipcosim.diagnose.ship.inputs import Record
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.validation.tracks import (
    Tracks,
    errors_of,
    fitting_horizon,
    tracks_by_models,
)
from shipcosim.errors import ShipcosimError


@dataclass(frozen=True)
class LogErrors:
    """Errors of the simulation of one log, before and, where there is an extended system, after.

    Attributes
    ----------
    horizon : tuple of float
        Lengths of the predictions, that fit the craft's own time scales; the same for all logs. [s]
    position, heading : dict of str to tuple of float
        Root mean square errors after each by the ship ``"before"``, as the system has her; ``"after"``, with causes in
        her or calibrated; and as a ``"floor"`` fitted to this log too. [m], [deg]
    fitted_on : tuple of str
        Logs that the ship ``"after"`` has her numbers from; empty where there is none, or where it is the first part
        of this log, and the rest of it is judged.
    tracks : Tracks
    own : tuple of str
        Causes of this log's own weather, which were fitted in it.
    remark : str
        What did not work.
    misses : (3, s) array or None
        Position error of each prediction at the longest horizon: before, after, and of the ship whose every number is
        fitted to this log too. None where there is no extended system. [m]
    """

    horizon: tuple[float, ...]
    position: dict[str, tuple[float, ...]]
    heading: dict[str, tuple[float, ...]]
    fitted_on: tuple[str, ...]
    tracks: Tracks
    own: tuple[str, ...] = ()
    remark: str = ""
    misses: np.ndarray | None = field(default=None, repr=False, compare=False)

    def as_json(self) -> dict:
        """The entry ``errors`` of a log in diagnosis.json."""
        after = "after" in self.position
        return {
            "horizon_s": list(self.horizon),
            "before_m": list(self.position["before"]),
            "after_m": list(self.position["after"]) if after else None,
            "before_deg": list(self.heading["before"]),
            "after_deg": list(self.heading["after"]) if after else None,
            "fitted_on": list(self.fitted_on),
            "own_weather": list(self.own),
        }


def errors_on(tracks: Tracks, fitted_on: Sequence[str]) -> LogErrors:
    """Root mean square errors of the predictions of a log, by simulation and horizon."""
    errors = errors_of(tracks)
    shown = {
        str(simulation): errors.sel(simulation=simulation)
        for simulation in errors["simulation"].values
    }
    position, heading = (
        {
            simulation: tuple(map(float, np.atleast_1d(of[channel].values)))
            for simulation, of in shown.items()
        }
        for channel in ("position", "heading")
    )
    return LogErrors(
        tuple(map(float, errors["after"].values)), position, heading, tuple(fitted_on), tracks
    )


def errors_by_models(
    record: Record, models: Mapping[str, ShipModel], fitted_on: Sequence[str]
) -> LogErrors | None:
    """Errors of the predictions of a log by the ships ``"before"``, ``"after"`` and ``"floor"``.

    None where no stretch of the log is whole.
    """
    try:
        horizon = fitting_horizon(record, models["before"])
        return errors_on(tracks_by_models(record, models, horizon), fitted_on)
    except ShipcosimError:
        return None
