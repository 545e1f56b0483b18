"""Checks as JUnit XML and as a Markdown table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from shipcosim.errors import printable
from shipcosim.results.shown import Check

ELEMENTS = {"failed": "failure", "error": "error", "skipped": "skipped"}
"""What JUnit calls a status; a testcase without an element has passed."""
MARKS = {"passed": "✅", "failed": "❌", "error": "❌", "skipped": "⏭️"}
MOST_ROWS = 50
"""Rows of a table on GitHub, which shows no more than a megabyte a job. Failed checks come first."""


def junit_xml(name: str, checks: Sequence[Check], folder: Path | None = None) -> bytes:
    """A test suite with a testcase for each check.

    Parameters
    ----------
    name : str
        Of the suite.
    checks : sequence of Check
        What was checked.
    folder : Path, optional
        Of the results, where their pages lie.
    """
    name = printable(name)
    suite = ElementTree.Element("testsuite", name=name, tests=str(len(checks)), time="0")
    statuses = [check.status for check in checks]
    for status, counted in (("failed", "failures"), ("error", "errors"), ("skipped", "skipped")):
        suite.set(counted, str(statuses.count(status)))
    for check in checks:
        group = printable(".".join(filter(None, (name, check.group))))
        case = ElementTree.SubElement(
            suite, "testcase", classname=group, name=printable(check.name), time="0"
        )
        if check.status in ELEMENTS:
            message = printable(str(check))
            element = ElementTree.SubElement(case, ELEMENTS[check.status], message=message)
            # Viewers show either the attribute or the text, so both say it all.
            page = "" if folder is None else f"\nPage: {(folder / check.page).as_posix()}"
            element.text = message + printable(page)
    root = ElementTree.Element("testsuites")
    root.append(suite)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"


def markdown(heading: str, checks: Sequence[Check], page: str = "") -> str:
    """A heading, a row for each check with failed ones first, and where the page is."""
    bad = [check for check in checks if check.status in ("failed", "error")]
    ordered = [*bad, *(check for check in checks if check not in bad)]
    lines = [f"### {heading}", "", "| | checked | result |", "|---|---|---|"]
    for check in ordered[:MOST_ROWS]:
        cells = MARKS[check.status], f"{check.group} {check.name}".strip(), check.message
        texts = (" ".join(printable(cell).replace("|", "\\|").split()) for cell in cells)
        lines.append(f"| {' | '.join(texts)} |")
    if len(ordered) > MOST_ROWS:
        lines.append(f"| | and {len(ordered) - MOST_ROWS} more | |")
    if page:
        lines += ["", f"Page: `{page}`"]
    return "\n".join([*lines, "", ""])
