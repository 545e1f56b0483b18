"""The card of a measured log."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from xarray import Dataset

from shipcosim.diagnose.finding import Finding
from shipcosim.report.diagnosis.words import title_of, where
from shipcosim.report.notebook.card import Card
from shipcosim.report.theme.numbers import finite, plain
from shipcosim.report.theme.views import Block, Fact, Outcome, Table


def log_card(
    name: str,
    table: Dataset,
    faults: Sequence[Finding],
    remarks: Sequence[str],
    draw: Callable[[], str] | None,
) -> Card:
    """Channels with their ranges, faults, remarks and the track.

    Parameters
    ----------
    name : str
        Of the log.
    table : xarray.Dataset
        As `read_log` gives it.
    faults : sequence of Finding
        That the channels show.
    remarks : sequence of str
    draw : function, optional
        Of the track, as SVG; None without a position.
    """
    time = table["time"].values
    span = f"{len(time)} rows, {plain(float(np.nanmin(time)))} to {plain(float(np.nanmax(time)))} s"
    steps = np.diff(finite(time))
    facts = (Fact("Rows", span), Fact("Usual step", f"{plain(float(np.median(steps)))} s"))
    rows = [(title_of(fault), where(fault), fault.sentence) for fault in faults]
    return Card(
        title=name,
        facts=facts,
        outcome=_outcome(faults),
        blocks=(
            Block("Faults", Table(rows)),
            Block("Channels", Table(_channels(table), ("", "unit", "least", "largest", "missing"))),
            Block("Remarks", lines=remarks),
        ),
        draw=draw,
    )


def _outcome(faults: Sequence[Finding]) -> Outcome:
    if not faults:
        return Outcome("plain", "LOG", "Its channels show no fault by themselves.")
    many = "One fault" if len(faults) == 1 else f"{len(faults)} faults"
    return Outcome(
        "faulty",
        "FAULTY",
        f"{many} show in the channels by themselves; a diagnosis corrects what it can.",
    )


def _channels(table: Dataset) -> Sequence[Sequence[str]]:
    """Each channel with its unit, its range and the share of rows without a value."""
    rows = []
    for name, variable in table.data_vars.items():
        values = np.asarray(variable.values, float)
        numbers = finite(values)
        ends = (
            (plain(float(numbers.min())), plain(float(numbers.max())))
            if len(numbers)
            else ("–", "–")
        )
        lost = 1.0 - len(numbers) / max(len(values), 1)
        rows.append(
            (
                str(name),
                variable.attrs.get("units", ""),
                *ends,
                f"{100 * lost:.1f} %" if lost else "",
            )
        )
    return rows
