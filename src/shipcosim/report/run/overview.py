"""The page of several scenarios: what happened, what must hold, measured values, verdict."""

from collections.abc import Sequence
from typing import NamedTuple

from shipcosim.report.run.page import Digest
from shipcosim.report.theme.pages import render
from shipcosim.report.theme.views import Fact, Outcome, Page
from shipcosim.series import write_file
from shipcosim.ssp import AnyPath


class ScenarioRow(NamedTuple):
    """A scenario in the table: its name, what happens, its page relative to this one, and how it went."""

    name: str
    description: str
    page: str
    digest: Digest


def overview_outcome(rows: Sequence[ScenarioRow]) -> Outcome:
    """Verdict of all scenarios together."""
    missed = [row.name for row in rows if row.digest.outcome.kind not in ("passed", "plain")]
    if missed:
        return Outcome(
            "failed",
            "FAIL",
            f"{len(missed)} of {len(rows)} scenarios miss something: {', '.join(missed)}.",
        )
    return Outcome("passed", "PASS", f"All {len(rows)} scenarios hold.")


def write_overview(rows: Sequence[ScenarioRow], path: AnyPath, *, title: str) -> None:
    """Write the page of several scenarios.

    Parameters
    ----------
    rows : sequence of ScenarioRow
        The scenarios, in the order of the table.
    path : path
        HTML file; it is there completely or not at all.
    title : str
        Its heading.

    Raises
    ------
    ShipcosimError
        If the file cannot be written.
    """
    facts = (Fact("Scenarios", str(len(rows))),)
    page = Page(title=title, facts=facts, outcome=overview_outcome(rows))
    write_file(path, render("run/templates/overview.html.jinja", page, rows=rows).encode())
