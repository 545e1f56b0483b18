"""The expectations of a run and whether they hold, in the units that people read."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from xarray import Dataset

from shipcosim.angles import compass
from shipcosim.report.run.details import parsed
from shipcosim.report.theme.display import units_to_read
from shipcosim.report.theme.views import Outcome
from shipcosim.scenario import Expectation, Verdict


class Judged(NamedTuple):
    """An expectation as texts: whether it holds, the claim, its window, the worst value and when that was."""

    passed: bool
    expected: str
    during: str
    worst: str
    time: str


def is_complete(table: Dataset) -> bool:
    """False for a run that was interrupted. NetCDF has no booleans, a text or a number counts too."""
    return str(table.attrs.get("complete", True)).lower() not in ("false", "0")


def outcome(table: Dataset, verdicts: Sequence[Verdict]) -> Outcome:
    """Verdict of the run in one word and one sentence.

    Parameters
    ----------
    table : xarray.Dataset
        The run.
    verdicts : sequence of Verdict
        Its expectations.

    Returns
    -------
    Outcome
    """
    # What holds in every row is judged on a part of a run too, which the sentence says.
    part = table.attrs.get("judged_on")
    judged_on = f" Judged on {part}." if part and verdicts else ""
    # An interrupted run is not judged: its windows may lie beyond its end.
    missed = sum(not v.passed for v in verdicts)
    if not is_complete(table):
        end = float(table["time"].values[-1]) if table.sizes["time"] else 0.0
        return Outcome(
            "partial",
            "PARTIAL",
            f"The run ended early, at {end:g} s. Its expectations were not judged.",
        )
    # Expectations whose window the run did not reach are neither held nor missed.
    left = len(parsed(table.attrs.get("not_reached", "[]")))
    if left and not missed:
        if verdicts:
            return Outcome(
                "passed",
                "PASS",
                f"{len(verdicts)} of {len(verdicts) + left} hold, {left} not reached.{judged_on}",
            )
        return Outcome("plain", "DONE", f"None of its {left} expectations was reached.")
    if not verdicts:
        return Outcome("plain", "DONE", "Nothing was expected of this run.")
    # A missed expectation outweighs those that were not reached.
    if missed:
        return Outcome(
            "failed", "FAIL", f"{missed} of {len(verdicts)} expectations missed.{judged_on}"
        )
    all_of_them = (
        f"All {len(verdicts)} expectations hold." if len(verdicts) > 1 else "The expectation holds."
    )
    return Outcome("passed", "PASS", f"{all_of_them}{judged_on}")


def judged(verdicts: Sequence[Verdict], shown: Dataset) -> Sequence[Judged]:
    """Expectations and their verdicts in the units that people read.

    Parameters
    ----------
    verdicts : sequence of Verdict
        What was judged.
    shown : xarray.Dataset
        Table in the page's units.

    Returns
    -------
    sequence of Judged
    """
    whole = str(shown.attrs.get("judged_on", "the whole run"))
    return [_judged(verdict, shown[verdict.expect.signal[0]].attrs, whole) for verdict in verdicts]


def claims(expectations: Sequence[Expectation], table: Dataset) -> list[str]:
    """Expectations as sentences with the units that people read.

    Parameters
    ----------
    expectations : sequence of Expectation
        With plain numbers, as `shipcosim.scenario.with_numbers` gives them.
    table : xarray.Dataset
        The run. [SI]

    Returns
    -------
    list of str
    """
    # Convert each claim to the unit of the page.
    units = units_to_read(table)
    sentences = []
    for expect in expectations:
        given = table[expect.signal[0]].attrs.get("units")
        unit, factor = units.get(given, (given, 1.0))
        during = " during {:g} to {:g} s".format(*expect.during) if expect.during else ""
        sentences.append(f"{_claim(expect, unit or '', factor)}{during}")
    return sentences


def _judged(verdict: Verdict, shown_as: dict[str, Any], whole: str) -> Judged:
    expect = verdict.expect
    unit = shown_as["units"]
    factor = shown_as["factor"]
    during = "{:g}–{:g} s".format(*expect.during) if expect.during else whole
    worst = "no row"
    when = "–"
    # Without a row in its window there is no worst value.
    if np.isfinite(verdict.time):
        worst = f"{factor * verdict.worst:.3g} {unit}".rstrip()
        when = f"{verdict.time:g} s"
    return Judged(verdict.passed, _claim(expect, unit, factor), during, worst, when)


def _claim(expect: Expectation, unit: str, factor: float) -> str:
    """What is expected: 'position of vessel: (20, 0) ± 1 m', 'heading of vessel: 045 ± 1 deg'."""

    def text(value: float | str) -> str:
        if isinstance(value, str):
            return value
        return (
            compass(factor * value)
            if expect.is_heading and unit == "deg"
            else f"{round(factor * value, 4):.4g}"
        )

    # A target with tolerance.
    if expect.near is not None and isinstance(expect.within, float):
        target = ",\u00a0".join(map(text, expect.near))
        target = f"({target})" if len(expect.near) > 1 else target
        return f"{expect.subject}: {target}\u00a0±\u00a0{factor * expect.within:.3g}\u00a0{unit}".rstrip()
    # Limits to one or both sides.
    limits = {"≥": expect.at_least, "≤": expect.at_most}
    claims = ", ".join(
        f"{sign} {text(v)}\u00a0{unit}" for sign, v in limits.items() if v is not None
    )
    return f"{expect.subject} {claims}".rstrip()
