"""What a calibration says in words and rows."""

from __future__ import annotations

from shipcosim.diagnose.calibration_pipeline import CalibratedLog, CalibratedShip
from shipcosim.diagnose.reference.reference import KnownNumber
from shipcosim.report.theme.numbers import metres, plain


def sentence(ship: CalibratedShip) -> str:
    """What a calibration comes to, in a sentence or two."""
    count = len(ship.logs)
    logs = "1 log" if count == 1 else f"{count} logs"
    if ship.refusals:
        return f"No reference is made from {logs}: {ship.refusals[0]}"
    errors = [log.errors for log in ship.logs if log.errors]
    text = f"{len(ship.reference.numbers)} numbers of the ship are fitted to {logs}."
    if errors:
        worst = max(errors, key=lambda one: one.after[-1])
        judged = f"by the other log{'s' * (count > 2)}" if worst.fitted_on else "by its first part"
        text += (
            f" After {worst.horizon[-1]:.2g} s the simulation was {metres(worst.before[-1])} off the log, and is "
            f"{metres(worst.after[-1])} off it calibrated {judged}{', in the worst log' if len(errors) > 1 else ''}."
        )
    return text


def moved(number: KnownNumber) -> float:
    """By how many tolerances a number is moved."""
    return (number.estimate - number.nominal) / number.tolerance


def moved_rows(ship: CalibratedShip) -> list[tuple[str, ...]]:
    """Numbers of the ship, those moved by most tolerances first: name, before, after, tolerances."""
    ranked = sorted(ship.reference.numbers, key=lambda number: -abs(moved(number)))
    return [_row(number) for number in ranked]


def _row(number: KnownNumber) -> tuple[str, ...]:
    unit = "" if number.unit == "1" else f" {number.unit}"
    return (
        number.name,
        f"{plain(number.nominal, 4)} ± {plain(number.tolerance, 2)}{unit}",
        f"{plain(number.estimate, 4)} ± {plain(number.std, 2)}{unit}",
        f"{moved(number):+.1f}".replace("-", "−"),
    )


def error_rows(ship: CalibratedShip) -> list[tuple[str, ...]]:
    """Errors by log and horizon: name, horizon, before, calibrated, with this log fitted too, and what judged it."""
    return [
        (
            log.name,
            f"{horizon:.2g} s",
            *map(metres, (one.before[k], one.after[k], one.floor[k])),
            (
                f"calibrated by {', '.join(one.fitted_on)}"
                if one.fitted_on
                else "calibrated by its first part"
            ),
        )
        for log in ship.logs
        for one in [log.errors]
        if one
        for k, horizon in enumerate(one.horizon)
    ]


def log_rows(ship: CalibratedShip) -> list[tuple[str, ...]]:
    """Logs: name, faults that were repaired, weather fitted beside the ship, unmodelled errors that are left."""
    return [
        (
            log.name,
            (", ".join(fault.label for fault in log.faults) or "none"),
            _weather(log),
            _left(log),
        )
        for log in ship.logs
    ]


def _weather(log: CalibratedLog) -> str:
    parts = (
        f"{path.removeprefix('water.').replace('_', ' ')} {plain(value, 2)}"
        for path, value in log.weather.items()
    )
    return ", ".join(parts) or "as logged"


def _left(log: CalibratedLog) -> str:
    parts = (f"{kind} {gain:.0f} nats" for kind, gain in log.unmodelled.items() if gain > 0.5)
    return ", ".join(parts) or "none"


def untold(ship: CalibratedShip) -> str:
    """Numbers of which the logs say next to nothing, as a list."""
    return ", ".join(number.name for number in ship.untold)
