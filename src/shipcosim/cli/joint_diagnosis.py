"""The command `diagnose` with several logs of one ship: what they say together, and each, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.diagnosis import say_sections
from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.reference.joint_result import JointDiagnosis


def print_joint(found: JointDiagnosis, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import style_of
    from shipcosim.report.joint.words import outcome

    console = make_console(soft_wrap=True)
    verdict = outcome(found)
    console.print(Text(verdict.word, style=style_of(found.verdict)), Text(verdict.sentence))
    say_sections(console, _sections(found), folder)


def _sections(found):
    """Headings of the summary with their content; nothing where there is none."""
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.report.diagnosis.gain_section import craft_table
    from shipcosim.report.diagnosis.testability import VISIBLE, visible_rows
    from shipcosim.report.diagnosis.words import title
    from shipcosim.report.joint.words import (
        cause_rows,
        discrepancy_rows,
        error_rows,
        fault_rows,
        log_rows,
        next_steps,
    )
    from shipcosim.report.theme.views import Table

    extension = found.extension
    extended = (
        str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    )
    silent = ", ".join(title(name).lower() for name in found.not_testable)
    head = ("log", "after", "position", "with causes", "heading", "with causes", "")
    errors = error_rows(found)
    return [
        ("Wrong, largest first", list(discrepancy_rows(found))),
        ("Faults of the data in common", list(fault_rows(found))),
        ("Causes in common", list(cause_rows(found))),
        ("Learned of the craft", craft_table(found.craft)),
        ("Errors by log", Table(errors, head)),
        (
            "Each log by itself: verdict, own faults, causes",
            [row[:4] for row in log_rows(found)],
        ),
        ("All logs together could not have shown", Text(silent) if silent else None),
        (VISIBLE, None if found.findings else list(visible_rows(found.smallest_visible))),
        ("Remarks", Text("\n".join(found.remarks), style="yellow") if found.remarks else None),
        ("What to do next", Text("\n".join(f"- {step}" for step in next_steps(found, extended)))),
    ]
