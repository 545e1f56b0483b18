"""What each of several logs shows in a diagnosis or calibration by all: rows and figures by log."""

import math
from collections.abc import Mapping
from dataclasses import replace

from shipcosim.diagnose.reference.joint_result import JointDiagnosis
from shipcosim.diagnose.reference.log_errors import LogErrors
from shipcosim.diagnose.result import Diagnosis
from shipcosim.report.diagnosis.track_figures import track_figure
from shipcosim.report.diagnosis.words import listed, title, told
from shipcosim.report.theme import palette
from shipcosim.report.theme.figures import bars
from shipcosim.report.theme.numbers import metres, plain
from shipcosim.report.theme.views import Figure, Figures, Table

TRACKS = 3
"""Logs whose tracks are all shown; of more the longest."""
LOOKS = {
    "before": ("as the system is", palette.VERMILLION),
    "after": ("{}", palette.BLUE),
    "floor": ("with this log fitted too", palette.FAINT),
}
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
    looks = _looks(errors, after)
    head = [f"{channel}, {name}" for channel in CHANNELS for name, _ in looks.values()]
    rows = []
    for log, one in errors.items():
        horizons = " / ".join(f"{horizon:.2g}" for horizon in one.horizon)
        cells = []
        for sizes, unit in zip((one.position, one.heading), CHANNELS.values(), strict=True):
            for label in looks:
                by_horizon = " / ".join(plain(value, 2) for value in sizes.get(label, ()))
                cells.append(f"{by_horizon} {unit}".replace(" °", "°") if by_horizon else "–")
        fitted_on = _fitted_on(one) if "after" in one.position else ""
        rows.append((log, f"{horizons} s", *cells, fitted_on))
    return Table(rows, ("Log", "After", *head, "Numbers by"), tuple(range(2 + len(head))))


def _looks(errors: Mapping[str, LogErrors], after: str) -> dict[str, tuple[str, str]]:
    """Name and colour of the ships that any log was predicted by."""
    found = {label for one in errors.values() for label in one.position}
    return {
        label: (name.format(after), colour)
        for label, (name, colour) in LOOKS.items()
        if label in found
    }


def _fitted_on(one: LogErrors) -> str:
    """Logs that the ship after has her numbers from."""
    many = len(one.fitted_on) > 2
    text = "all other logs" if many else ", ".join(one.fitted_on) or "its first part"
    own = listed([title(cause).lower() for cause in one.own]) if one.own else ""
    if not own:
        return text
    return f"{text}; {own} by this log itself" if one.fitted_on else f"{own} by this log itself"


def log_table(found: Diagnosis) -> Table:
    """Rows for each log alone: verdict, faults, causes, largest discrepancy, error; empty for a single log."""
    if not isinstance(found, JointDiagnosis):
        return Table(())
    rows = []
    for name, one in found.logs.items():
        faults = [fault.sentence or told(fault) for fault in found.own_faults(name)]
        causes = [told(finding, found.causes) for finding in one.physics]
        first = one.discrepancies[0].what if one.discrepancies else "none"
        said = ("; ".join(texts) or "none" for texts in (faults, causes))
        rows.append((name, one.verdict, *said, first, error_after(one)))
    head = ("Log", "Verdict", "Faults of its own", "Causes", "Largest discrepancy", "Error")
    return Table(rows, head, (0, 5))


def error_after(found: Diagnosis) -> str:
    """Position error of the simulation after the longest horizon."""
    base = found.baseline
    if not base:
        return "not measured"
    return f"{metres(base['position_error_m'][-1])} after {base['horizon_s'][-1]:.4g} s"


def error_figures(errors: Mapping[str, LogErrors], after: str = WITH_CAUSES) -> Figures:
    """Errors after the longest horizon by log, in position and heading; arguments as for `error_table`."""
    figures = []
    layout = {"barmode": "group", "xaxis": {"type": "category"}}
    names = [f"{log}, {one.horizon[-1]:.2g} s" for log, one in errors.items()]
    for channel, unit in CHANNELS.items() if errors else ():
        traces = []
        every = [getattr(one, channel.lower()) for one in errors.values()]
        for label, (name, colour) in _looks(errors, after).items():
            last = [sizes.get(label, (math.nan,))[-1] for sizes in every]
            traces.append(bars(name, names, last, colour, unit))
        figures.append(Figure(f"{channel} error by log", unit, tuple(traces), layout))
    return tuple(figures)


def track_figures(errors: dict[str, LogErrors]) -> Figures:
    """Tracks of the logs, or where there are many of the longest."""
    longest = sorted(
        errors, key=lambda name: -errors[name].tracks.predicted["before"].sizes["segment"]
    )
    names = list(errors) if len(errors) <= TRACKS else longest[:1]
    return tuple(
        replace(track_figure(errors[name].tracks), title=f"Track, {name}") for name in names
    )
