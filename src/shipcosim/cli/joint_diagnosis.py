"""The command `diagnose` with several logs of one ship: what they say together, and each."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.diagnosis import DEFAULT_SYSTEM, FILES, check_inputs, table
from shipcosim.cli.progress import LAST_STEP, shown_progress

if TYPE_CHECKING:
    from shipcosim.diagnose.joint_pipeline import JointDiagnosis


def diagnose_logs(
    logs: Sequence[Path],
    folder: Path,
    *,
    system: str | None = None,
    channels: str | os.PathLike | None = None,
    effects: str | os.PathLike | None = None,
    reference: str | os.PathLike | None = None,
) -> JointDiagnosis:
    """Diagnose several logs of one ship together, and write all that there is to say of them.

    Parameters
    ----------
    logs : sequence of Path
    folder : Path
        Gets diagnosis.json and report.html, and where a common cause in the model was named extended.ssp and
        extended.ssv.
    system, channels, effects, reference : optional
        As for `diagnose_log`.

    Returns
    -------
    JointDiagnosis

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.cli.requests import system_of
    from shipcosim.diagnose.joint_pipeline import diagnose_jointly, steps_of
    from shipcosim.diagnose.reference.reference import read_reference
    from shipcosim.report.joint.page import write_joint
    from shipcosim.series import write_json
    from shipcosim.staging import staged

    check_inputs(logs, channels, effects)
    known = None if reference is None else read_reference(reference)
    ship = system_of(system or DEFAULT_SYSTEM, option="--system")
    with shown_progress(steps_of(logs)) as show, staged(folder, FILES) as stage:
        found = diagnose_jointly(list(logs), ship, channels, effects, show, out=stage, reference=known)
        show(LAST_STEP)
        write_json(found.as_json(), stage / "diagnosis.json")
        write_joint(found, stage / "report.html")
    if found.extension is None:
        return found
    at_home = {kind: folder / f"extended.{kind}" for kind in ("ssp", "ssv")}
    return replace(found, extension=replace(found.extension, **at_home))


def print_joint(found: JointDiagnosis, folder: Path, as_json: bool) -> None:
    """What was found, on stdout."""
    from rich.console import Console
    from rich.text import Text

    from shipcosim.cli.console import shown_path, style_of
    from shipcosim.report.joint.words import outcome

    if as_json:
        print(json.dumps(found.as_json(), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    verdict = outcome(found)
    console.print(Text(verdict.word, style=style_of(found.verdict)), Text(verdict.sentence))
    for heading, content in _sections(found):
        if content is not None:
            console.print()
            console.print(Text(heading, style="bold"))
            console.print(content)
    console.print()
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)


def _sections(found):
    """Headings of the summary with their content; None where there is none."""
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.report.diagnosis.words import title
    from shipcosim.report.joint.words import (
        cause_rows,
        discrepancy_rows,
        error_rows,
        fault_rows,
        log_rows,
        next_steps,
    )

    extension = found.extension
    extended = str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    silent = ", ".join(title(name).lower() for name in found.not_testable)
    head = ("log", "after", "position", "with causes", "heading", "with causes", "")
    errors = error_rows(found)
    return [
        ("Wrong, largest first", table(discrepancy_rows(found))),
        ("Faults of the data in common", table(fault_rows(found))),
        ("Causes in common", table(cause_rows(found))),
        ("Errors by log", table([head, *errors] if errors else [])),
        ("Each log by itself: verdict, own faults, causes", table(row[:4] for row in log_rows(found))),
        ("All logs together could not have shown", Text(silent) if silent else None),
        ("Remarks", Text("\n".join(found.remarks), style="yellow") if found.remarks else None),
        ("What to do next", Text("\n".join(f"- {step}" for step in next_steps(found, extended)))),
    ]
