"""The command `diagnose` with several logs of one ship: what they say together, and each."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.diagnosis import DEFAULT_SYSTEM, FILES, check_inputs, finding_table, shown_progress
from shipcosim.cli.project import find_system

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
    """Diagnose several logs of one ship together, and write diagnosis.json.

    Parameters
    ----------
    logs : sequence of Path
    folder : Path
        Gets diagnosis.json.
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
    from shipcosim.cli.results import staged
    from shipcosim.diagnose.joint_pipeline import find_common_causes
    from shipcosim.diagnose.reference.reference import read_reference

    check_inputs(logs, channels, effects)
    known = None if reference is None else read_reference(reference)
    ship = system_of(find_system(system or DEFAULT_SYSTEM, "--system"))
    with shown_progress("") as show, staged(folder, FILES) as stage:
        found = find_common_causes(list(logs), ship, channels, effects, show, known)
        text = json.dumps(found.as_json(), indent=2, ensure_ascii=False, allow_nan=False)
        (stage / "diagnosis.json").write_text(text + "\n", encoding="utf-8")
    return found


def print_joint(found: JointDiagnosis, folder: Path, as_json: bool) -> None:
    """What was found, on stdout."""
    from rich.console import Console
    from rich.text import Text

    from shipcosim.cli.console import shown_path, style_of

    if as_json:
        print(json.dumps(found.as_json(), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    console.print(Text(found.verdict, style=style_of(found.verdict)), Text(f"by {len(found.logs)} logs together"))
    for heading, findings in (("All logs", found.findings), *((n, one.findings) for n, one in found.logs.items())):
        console.print()
        console.print(Text(heading if heading == "All logs" else f"{heading} by itself", style="bold"))
        console.print(finding_table(findings) or Text("nothing"))
    console.print()
    console.print(f"All of it: {shown_path(folder / 'diagnosis.json')}", markup=False)
