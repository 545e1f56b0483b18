"""A log as a system replays it, and as the system extended by a diagnosis does: `replay_log`."""

from dataclasses import dataclass

import numpy as np

from shipcosim.diagnose.checked_log import checked
from shipcosim.diagnose.extension.extend import signals_of
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.remarks import handled
from shipcosim.diagnose.log.runs import LogSource
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.validation.cosimulation import Replayed
from shipcosim.diagnose.validation.tracks import (
    Tracks,
    errors_of,
    fitting_horizon,
    tracks_by_systems,
)
from shipcosim.options import CountProgress
from shipcosim.ssp import AnyPath, System

_TURNED = 15.0
"""Error of the heading at the end of a prediction, above which a log may be of another ship. [deg] Nine runs of a ship
in weather from calm to rough, whose current a log does not tell, are off by 0.7 to 5.1 deg, logs of other ships by 26 to
60 deg."""
_MORE_TURNED = 1.5
"""The same over what a ship that keeps her heading is off. Assumed."""
_DRIFTED = 1.5
"""Error of the position over the time of a prediction, which no current that is left out makes. [m/s] Assumed."""
_FEWEST = 3
"""Predictions by which a log is judged. Assumed."""


@dataclass(frozen=True)
class LogReplay:
    """A log as systems replay it.

    Attributes
    ----------
    tracks : Tracks
    faults : tuple of Finding
        Of the log, corrected or cut out before.
    remarks : tuple of str
        What the log lacks, and what was handled in it.
    system : System
        The plain one.
    """

    tracks: Tracks
    faults: tuple[Finding, ...]
    remarks: tuple[str, ...]
    system: System


def replay_log(
    log: LogSource,
    systems: dict[str, System],
    channels: AnyPath | None = None,
    *,
    horizon: float | None = None,
    progress: CountProgress | None = None,
) -> LogReplay:
    """Predict a log piece by piece with some systems.

    Parameters
    ----------
    log : path or xarray.Dataset
        As for `shipcosim.diagnose`.
    systems : dict of str to System
        By name. The first is the plain ship; the others may have what an extension inserts.
    channels : path, optional
        Channel file.
    horizon : float, optional
        Length of each prediction; one that fits the craft and the log if not given. [s]
    progress : callable, optional
        Called with (predictions done, predictions in all).

    Raises
    ------
    ShipcosimError
        Data or systems that cannot be used.
    """
    first = next(iter(systems.values()))
    checked_log = checked(read_measurements(log, first, channels))
    record = record_of(checked_log.repaired, checked_log.ship)
    seconds = fitting_horizon(record, checked_log.ship) if horizon is None else horizon
    replayed = {name: Replayed(system, _signals(system)) for name, system in systems.items()}
    tracks = tracks_by_systems(record, checked_log.ship, replayed, seconds, progress)
    remarks = (*_misfit(tracks), *record.remarks, *handled(checked_log.log))
    return LogReplay(tracks, checked_log.faults, remarks, first)


def _misfit(tracks: Tracks) -> tuple[str, ...]:
    """A remark where all systems move otherwise than the log by more than weather makes a ship move."""
    # A ship that lies still is at the end of a prediction where she was at its start.
    end = tracks.horizon
    start = {
        name: predicted.isel(time=[0]).assign_coords(time=[end])
        for name, predicted in tracks.predicted.items()
    }
    off = errors_of(tracks, (1.0,))
    still = errors_of(Tracks(end, tracks.measured, start), (1.0,)).assign_coords(after=off["after"])
    turns = off["heading"] > np.maximum(_TURNED, _MORE_TURNED * still["heading"])
    is_other = (turns | (off["position"] > _DRIFTED * end)) & (off["position"] > still["position"])
    (first, *_) = tracks.predicted.values()
    if not is_other.all() or first.sizes["segment"] < _FEWEST:
        return ()
    shown = [
        f"{e['heading'][-1, 0]:.0f} deg and {e['position'][-1, 0]:.3g} m" for e in (off, still)
    ]
    return (
        f"The log does not fit this ship: {end:.0f} s after its starts the simulation is off by {shown[0]}, "
        f"a ship that lies still by {shown[1]}. Is it the log of another ship, or of thrusters under wrong names?",
    )


def _signals(system: System) -> dict[str, str] | None:
    """By role, what the instruments show that a diagnosis inserted; None of a system without them."""
    needed = set(Instruments().errors)
    inserted = next(
        (name for name, part in system.components.items() if needed <= set(part.variables)),
        None,
    )
    return None if inserted is None else signals_of(inserted, "_meas")
