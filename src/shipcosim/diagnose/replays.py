"""A log as a system replays it, and as the system extended by a diagnosis does: `replay_log`."""

from dataclasses import dataclass

from shipcosim.diagnose.checked_log import checked
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.log.remarks import handled
from shipcosim.diagnose.log.runs import LogSource
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.diagnose.ship.inputs import CHANNELS, record_of
from shipcosim.diagnose.ship.instruments import Instruments
from shipcosim.diagnose.validation.cosimulation import Replayed
from shipcosim.diagnose.validation.tracks import Tracks, fitting_horizon, tracks_by_systems
from shipcosim.options import CountProgress
from shipcosim.ssp import AnyPath, System

_SHOWN = dict(zip(CHANNELS, ("x", "y", "psi", "u", "v", "r"), strict=True))


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
    known = checked(read_measurements(log, first, channels))
    record = record_of(known.repaired, known.ship)
    seconds = fitting_horizon(record, known.ship) if horizon is None else horizon
    replayed = {name: Replayed(system, _signals(system)) for name, system in systems.items()}
    tracks = tracks_by_systems(record, known.ship, replayed, seconds, progress)
    return LogReplay(tracks, known.faults, (*record.remarks, *handled(known.log)), first)


def _signals(system: System) -> dict[str, str] | None:
    """By role, what the instruments show that a diagnosis inserted; None of a system without them."""
    needed = set(Instruments().errors)
    own = next(
        (name for name, part in system.components.items() if needed <= set(part.variables)),
        None,
    )
    return None if own is None else {role: f"{own}.{name}_meas" for role, name in _SHOWN.items()}
