"""The command `diagnose`: what was found in a log, or in several, on the terminal."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from rich.console import Console

    from shipcosim.diagnose.result import Diagnosis


def print_diagnosis(diagnosis: Diagnosis, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import style_of
    from shipcosim.report.diagnosis.words import outcome

    console = make_console(soft_wrap=True)
    verdict = outcome(diagnosis)
    console.print(Text(verdict.word, style=style_of(diagnosis.verdict)), Text(verdict.sentence))
    _say_sections(console, _sections(diagnosis), folder)


def _say_sections(console: Console, sections: Iterable[tuple[str, Any]], folder: Path) -> None:
    """Sections that have content, a text, a table or its rows, below their headings, and where the page is."""
    from rich.text import Text

    from shipcosim.cli.console import say_page
    from shipcosim.report.theme.views import Table

    for heading, content in sections:
        content = Table(content) if isinstance(content, list) else content
        if not content or (isinstance(content, Table) and not content.rows):
            continue
        console.print()
        console.print(Text(heading, style="bold"))
        if isinstance(content, Text):
            console.print(content)
        else:
            print_table(console, content.rows, content.head)
    console.print()
    say_page(console, folder / "report.html")


def _sections(diagnosis):
    """Headings of the summary with their content: a text, a table or its rows; nothing where there is none."""
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.diagnose.reference.joint_result import JointDiagnosis
    from shipcosim.report.diagnosis.by_log import error_table, log_table
    from shipcosim.report.diagnosis.gain_section import craft_table
    from shipcosim.report.diagnosis.key_figures import key_figures
    from shipcosim.report.diagnosis.testability import VISIBLE, visible_rows
    from shipcosim.report.diagnosis.words import (
        discrepancy_rows,
        finding_rows,
        next_steps,
        title,
    )

    alike = [
        (title(c.cause, c.component), f"{100 * c.probability:.0f} %")
        for c in diagnosis.indistinguishable
    ]
    # What would have shown matters most where nothing in the ship was found; the page always has it.
    is_found = any(finding.kind == "physics" for finding in diagnosis.findings)
    names = () if diagnosis.is_assumed else diagnosis.not_testable
    silent = ", ".join(title(name).lower() for name in names)
    columns = diagnosis.log.measured.attrs.get("column_remarks", ()) if diagnosis.log else ()
    extension = diagnosis.extension
    extended = (
        str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    )
    steps = "\n".join(f"- {step}" for step in next_steps(diagnosis, extended))
    several = isinstance(diagnosis, JointDiagnosis)
    logs = "These logs" if several else "This log"
    return [
        ("Wrong, largest first", list(discrepancy_rows(diagnosis))),
        ("Found", list(finding_rows(diagnosis.findings))),
        ("Learned of the craft", craft_table(diagnosis.craft)),
        (f"{logs} cannot tell apart", alike),
        ("Errors", list(key_figures(diagnosis))),
        ("Errors by log", error_table(diagnosis.errors) if several else None),
        ("Each log by itself", [row[:4] for row in log_table(diagnosis).rows]),
        (f"{logs} could not have shown", Text(silent) if silent else None),
        (VISIBLE, None if is_found else list(visible_rows(diagnosis.smallest_visible))),
        ("Columns", Text("\n".join(columns)) if columns else None),
        ("Remarks", Text("\n".join(diagnosis.notes), style="yellow") if diagnosis.notes else None),
        ("What to do next", Text(steps)),
    ]
