"""Texts and rows of a calibration."""

from __future__ import annotations

from collections.abc import Sequence

from shipcosim.diagnose.calibration_pipeline import CalibratedShip
from shipcosim.diagnose.reference.log_errors import LogErrors
from shipcosim.diagnose.reference.reference import KnownNumber
from shipcosim.report.diagnosis.by_log import error_table
from shipcosim.report.theme.numbers import metres, plain, signed
from shipcosim.report.theme.views import Block, Outcome, Table

MOST_ROWS = 12
"""Numbers that terminal and notebook show; the page has all."""


def outcome(ship: CalibratedShip) -> Outcome:
    """Whether a reference is made, and what the calibration comes to."""
    if ship.refusals:
        return Outcome("unknown", "REFUSED", sentence(ship))
    return Outcome("consistent", "CALIBRATED", sentence(ship))


def sentence(ship: CalibratedShip) -> str:
    """Result of a calibration in a sentence or two."""
    count = len(ship.logs)
    logs = "1 log" if count == 1 else f"{count} logs"
    if ship.refusals:
        return f"No reference is made from {logs}: {ship.refusals[0]}"
    errors = errors_by_log(ship).values()
    text = f"{len(ship.reference.numbers)} numbers of the ship are fitted to {logs}."
    if errors:
        worst = max(errors, key=lambda log: log.position["after"][-1])
        judged = f"by the other log{'s' * (count > 2)}" if worst.fitted_on else "by its first part"
        before, after = (metres(worst.position[label][-1]) for label in ("before", "after"))
        text += (
            f" After {worst.horizon[-1]:.2g} s the simulation was {before} off the log, and is {after} off it calibrated "
            f"{judged}{', in the worst log' if len(errors) > 1 else ''}."
        )
    return text


def blocks(ship: CalibratedShip) -> Sequence[Block]:
    """Numbers that moved most and the errors that remain, for terminal and notebook."""
    moved = Table(moved_rows(ship)[:MOST_ROWS], ("", "before", "calibrated", "by tolerances"))
    return (
        Block("Why", lines=ship.refusals),
        Block("Moved most", moved),
        Block("Errors by log", error_table(errors_by_log(ship), "calibrated")),
        Block("Remarks", lines=ship.remarks),
    )


def moved(number: KnownNumber) -> float:
    """Change of a number, in tolerances."""
    return (number.estimate - number.nominal) / number.tolerance


def moved_rows(ship: CalibratedShip) -> list[Sequence[str]]:
    """Numbers of the ship, those moved by most tolerances first: name, before, after, tolerances."""
    rows = []
    for number in sorted(ship.reference.numbers, key=lambda number: -abs(moved(number))):
        unit = "" if number.unit == "1" else f" {number.unit}"
        before = f"{plain(number.nominal, 4)} ± {plain(number.tolerance, 2)}{unit}"
        after = f"{plain(number.estimate, 4)} ± {plain(number.std, 2)}{unit}"
        rows.append((number.name, before, after, signed(moved(number))))
    return rows


def errors_by_log(ship: CalibratedShip) -> dict[str, LogErrors]:
    """Errors of the logs of which a stretch is whole."""
    return {log.name: log.errors for log in ship.logs if log.errors}


def log_rows(ship: CalibratedShip) -> list[Sequence[str]]:
    """Logs: name, faults that were repaired, weather fitted beside the ship, unmodelled errors that are left."""
    rows = []
    for log in ship.logs:
        faults = ", ".join(fault.label for fault in log.faults)
        weather = ", ".join(
            f"{path.removeprefix('water.').replace('_', ' ')} {plain(value, 2)}"
            for path, value in log.weather.items()
        )
        left = [f"{kind} {gain:.0f} nats" for kind, gain in log.unmodelled.items() if gain > 0.5]
        cells = (faults or "none", weather or "as logged", ", ".join(left) or "none")
        rows.append((log.name, *cells))
    return rows
