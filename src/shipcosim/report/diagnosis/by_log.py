"""What each of several logs shows in a diagnosis or calibration by all: rows and tracks by log."""

from collections.abc import Mapping
from dataclasses import replace

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.reference.log_errors import LogErrors
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.track_figures import track_figure
from shipcosim.report.diagnosis.words import finding_text, listed, title
from shipcosim.report.theme.numbers import metres, plain
from shipcosim.report.theme.views import Figures, Table

TRACKS = 3
"""Logs whose tracks are all shown; of more the longest."""
SHIPS = {"before": "as the system is", "after": "{}", "floor": "with this log fitted too"}
"""Ships that a log is predicted by."""
CHANNELS = {"Position": "m", "Heading": "°"}
WITH_CAUSES = "with the causes"


def error_table(errors: Mapping[str, LogErrors], after: str = WITH_CAUSES) -> Table:
    """Errors by log after each horizon, in position and heading, and what the ship after has her numbers from.

    Parameters
    ----------
    errors : dict of str to LogErrors
    after : str
        How the ship after differs.
    """
    labels = {label for error in errors.values() for label in error.position}
    ships = [label for label in SHIPS if label in labels]
    head = [f"{channel}, {SHIPS[ship].format(after)}" for channel in CHANNELS for ship in ships]
    rows = []
    for log, error in errors.items():
        horizons = " / ".join(f"{horizon:.2g}" for horizon in error.horizon)
        cells = []
        for sizes, unit in zip((error.position, error.heading), CHANNELS.values(), strict=True):
            for label in ships:
                by_horizon = " / ".join(plain(value, 2) for value in sizes.get(label, ()))
                cells.append(f"{by_horizon} {unit}".replace(" °", "°") if by_horizon else "–")
        if "after" in labels:
            cells.append(_fitted_on(error) if "after" in error.position else "")
        rows.append((log, f"{horizons} s", *cells))
    # Where no ship has causes, there are no numbers whose origin is to be said.
    origin = ("Numbers by",) if "after" in labels else ()
    return Table(rows, ("Log", "After", *head, *origin))


def _fitted_on(errors: LogErrors) -> str:
    """Logs that the ship after has her numbers from."""
    many = len(errors.fitted_on) > 2
    text = "all other logs" if many else ", ".join(errors.fitted_on) or "its first part"
    causes = listed([title(cause).lower() for cause in errors.own]) if errors.own else ""
    if not causes:
        return text
    return (
        f"{text}; {causes} by this log itself"
        if errors.fitted_on
        else f"{causes} by this log itself"
    )


def log_table(diagnosis: Diagnosis) -> Table:
    """Rows for each log alone: verdict, faults, causes, largest discrepancy, error; empty for a single log."""
    if not isinstance(diagnosis, JointDiagnosis):
        return Table(())
    rows = []
    for name, log in diagnosis.logs.items():
        faults = [fault.sentence or finding_text(fault) for fault in diagnosis.own_faults(name)]
        causes = [finding_text(finding, diagnosis.causes) for finding in log.physics]
        first = log.discrepancies[0].what if log.discrepancies else "none"
        cells = ("; ".join(texts) or "none" for texts in (faults, causes))
        rows.append((name, log.verdict, *cells, first, error_after(log)))
    head = ("Log", "Verdict", "Faults of its own", "Causes", "Largest discrepancy", "Error")
    return Table(rows, head)


def error_after(diagnosis: Diagnosis) -> str:
    """Position error of the simulation after the longest horizon."""
    base = diagnosis.baseline
    if not base:
        return "not measured"
    return f"{metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:.4g} s"


def track_figures(errors: dict[str, LogErrors]) -> Figures:
    """Tracks of the logs, or where there are many of the longest."""
    longest = sorted(
        errors, key=lambda name: -errors[name].tracks.predicted["before"].sizes["segment"]
    )
    names = list(errors) if len(errors) <= TRACKS else longest[:1]
    return tuple(
        replace(track_figure(errors[name].tracks), title=f"Track, {name}") for name in names
    )
