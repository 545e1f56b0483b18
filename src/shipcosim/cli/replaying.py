"""The command `replay`: the systems that it compares, its files, its summary."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim import library
from shipcosim.cli.console import print_problems, progress_of, shown_path
from shipcosim.cli.diagnosis import check_inputs
from shipcosim.errors import Problem, ShipcosimError

if TYPE_CHECKING:
    from shipcosim.diagnose.replays import LogReplay
    from shipcosim.ssp import System


def systems_of(given: str, before: str | None, parameters: Sequence[Path]) -> dict[str, System]:
    """The systems of a replay by what they are: ``before`` and ``after``, or the one alone.

    Parameters
    ----------
    given : str
        As for `library.find`.
    before : str, optional
        The other system; of an extended.ssp the one in ssp/ with its name if not given.
    parameters : sequence of Path
        Sets over those of the given system, which is then ``before`` without them.

    Raises
    ------
    ShipcosimError
        If there is no such system, or nothing of a set fits.
    """
    from shipcosim.ssp import fitting_values, with_values

    system = _read(given, "--system")
    if parameters:
        after = system
        for file in parameters:
            values, left_out = fitting_values(file, system)
            print_problems(left_out)
            after = with_values(after, values, str(file))
        return {"before": system if before is None else _read(before, "--before"), "after": after}
    if before is None and Path(given).name == "extended.ssp":
        before = _extended_from(system, given)
    return {"simulated": system} if before is None else {"before": _read(before, "--before"), "after": system}


def _read(given: str, option: str) -> System:
    from shipcosim.cli.requests import system_of

    return system_of(given, option=option)


def _extended_from(system: System, given: str) -> str:
    """Name of the system that was extended, where it is one of the project's."""
    if library.named("system", system.name) is None:
        found = f"it extends a system '{system.name}', which has no name here."
        raise ShipcosimError(Problem(given, found, "Say which one it was: --before SSP."))
    return system.name


def replay_and_save(
    log: Path, systems: dict[str, System], channels: Path | None, horizon: float | None, folder: Path
) -> LogReplay:
    """Replay a log and write page, errors and series to a folder."""
    from shipcosim.cli.results import check_targets
    from shipcosim.diagnose.replays import replay_log
    from shipcosim.diagnose.validation.tracks import errors_of
    from shipcosim.report.diagnosis.replay_page import write_replay
    from shipcosim.staging import staged

    check_inputs([log], channels)
    check_targets(folder)
    with progress_of(f"replaying {log.name}") as show:
        found = replay_log(log, systems, channels, horizon=horizon, progress=show)
    tracks = found.tracks
    facts = {name: system.name for name, system in systems.items()} | {"Predictions": f"{tracks.horizon:.0f} s"}
    with staged(folder) as stage:
        errors_of(tracks).to_dataframe().reset_index().to_csv(stage / "errors.csv", index=False)
        _series(tracks).to_netcdf(stage / "replay.nc", engine="h5netcdf")
        write_replay(found, stage / "report.html", log.name, facts)
    return found


def _series(tracks):
    """All that is drawn in one table."""
    import xarray

    parts = [tracks.measured.rename({name: f"measured_{name}" for name in tracks.measured.data_vars})]
    for name, one in tracks.predicted.items():
        own = {variable: f"{name}_{variable}" for variable in one.data_vars}
        parts.append(one.rename(own | {"time": "since_start"}))
    return xarray.merge(parts, compat="no_conflicts", join="outer")


def print_replay(replay: LogReplay, folder: Path) -> None:
    """The errors, on stdout."""
    from rich.console import Console
    from rich.table import Table

    from shipcosim.diagnose.validation.tracks import errors_of
    from shipcosim.report.diagnosis.replay_page import replay_outcome
    from shipcosim.report.diagnosis.track_figures import error_rows

    console, errors = Console(highlight=False, soft_wrap=True), error_rows(errors_of(replay.tracks))
    table = Table(*errors.head, box=None, pad_edge=False)
    for row in errors.rows:
        table.add_row(*row)
    console.print(replay_outcome(replay).sentence)
    console.print(table)
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)
