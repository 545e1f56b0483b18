"""The command `diagnose`: from a measured log to its findings, the extended system, the gain and the page."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from shipcosim import library
from shipcosim.cli.progress import LAST_STEP, shown_progress
from shipcosim.errors import Problem, ShipcosimError

if TYPE_CHECKING:
    from shipcosim.diagnose.finding import Finding
    from shipcosim.diagnose.result import Diagnosis

DEFAULT_SYSTEM = "gunnerus_open"
FILES = ("diagnosis.json", "report.html", "extended.ssp", "extended.ssv")


def default_folder(data: str | os.PathLike, ending: str = "") -> Path:
    """Where the results of a log go without --out.

    Examples
    --------
    >>> default_folder("logs/monday.csv.gz").as_posix()
    'results/monday'
    >>> default_folder("logs/monday.csv.gz", "-replay").as_posix()
    'results/monday-replay'
    """
    return Path("results") / f"{Path(Path(data).name.removesuffix('.gz')).stem}{ending}"


def logs_of(given: Iterable[Path]) -> list[Path]:
    """Files of measured data: paths, or names of the examples that the package ships."""
    return [path if path.exists() else library.named("example", str(path)) or path for path in given]


def diagnose_log(
    data: str | os.PathLike,
    folder: Path,
    *,
    system: str | None = None,
    channels: str | os.PathLike | None = None,
    effects: str | os.PathLike | None = None,
    reference: str | os.PathLike | None = None,
) -> Diagnosis:
    """Diagnose a log and write all that there is to say of it.

    Parameters
    ----------
    data : path
    folder : Path
        Gets diagnosis.json and report.html, and where a cause in the model was named extended.ssp and extended.ssv.
    system : str, optional
        As for `library.find`; the open Gunnerus without.
    channels, effects : path, optional
        Channel file, and folder with further causes.
    reference : path, optional
        Folder or file that a calibration left.

    Returns
    -------
    Diagnosis

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.cli.requests import system_of
    from shipcosim.diagnose.pipeline import STEPS, diagnose
    from shipcosim.diagnose.reference.reference import read_reference
    from shipcosim.report.diagnosis.page import write_diagnosis
    from shipcosim.series import write_json
    from shipcosim.staging import staged

    check_inputs([data], channels, effects)
    known = None if reference is None else read_reference(reference)
    ship = system_of(system or DEFAULT_SYSTEM, option="--system")
    with shown_progress(STEPS) as show, staged(folder, FILES) as stage:
        diagnosis = diagnose(data, ship, channels, effects, show, out=stage, reference=known)
        show(LAST_STEP)
        write_json(diagnosis.as_json(), stage / "diagnosis.json")
        write_diagnosis(diagnosis, stage / "report.html")
    if diagnosis.extension is None:
        return diagnosis
    at_home = {kind: folder / f"extended.{kind}" for kind in ("ssp", "ssv")}
    return replace(diagnosis, extension=replace(diagnosis.extension, **at_home))


def check_inputs(
    logs: Iterable[str | os.PathLike], channels: str | os.PathLike | None, effects: str | os.PathLike | None = None
) -> None:
    """Raise ShipcosimError where a file or folder that was given is not there."""
    problems = []
    for path, what in (*((log, "file of measured data") for log in logs), (channels, "channel file")):
        if path is not None and not Path(path).is_file():
            problems.append(Problem(str(path), f"There is no such {what}.", "Give the path of one."))
    if effects is not None and not Path(effects).is_dir():
        problems.append(Problem(str(effects), "There is no such folder of causes.", "Give the path of one."))
    if problems:
        raise ShipcosimError(problems)


def print_diagnosis(diagnosis: Diagnosis, folder: Path, as_json: bool) -> None:
    """What was found, on stdout."""
    from rich.console import Console
    from rich.text import Text

    from shipcosim.cli.console import shown_path, style_of
    from shipcosim.report.diagnosis.words import outcome

    if as_json:
        print(json.dumps(diagnosis.as_json(), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    verdict = outcome(diagnosis, diagnosis.causes)
    console.print(Text(verdict.word, style=style_of(diagnosis.verdict)), Text(verdict.sentence))
    for heading, content in _sections(diagnosis):
        if content is not None:
            console.print()
            console.print(Text(heading, style="bold"))
            console.print(content)
    console.print()
    console.print(f"Page: {shown_path(folder / 'report.html')}", markup=False)


def _sections(diagnosis):
    """Headings of the summary with their content; None where there is none."""
    from rich.text import Text

    from shipcosim.cli.console import shown_path
    from shipcosim.report.diagnosis.key_figures import key_figures
    from shipcosim.report.diagnosis.words import discrepancy_rows, next_steps, title

    alike = [(title(c.cause, c.component), f"{100 * c.probability:.0f} %") for c in diagnosis.indistinguishable]
    silent = ", ".join(title(name).lower() for name in diagnosis.not_testable)
    columns = diagnosis.log.measured.attrs.get("column_remarks", ()) if diagnosis.log else ()
    extension = diagnosis.extension
    extended = str(shown_path(extension.ssp)) if extension is not None and extension.values else None
    steps = "\n".join(f"- {step}" for step in next_steps(diagnosis, extended, diagnosis.causes))
    return [
        ("Wrong, largest first", table(discrepancy_rows(diagnosis))),
        ("Found", finding_table(diagnosis.findings)),
        ("This log cannot tell apart", table(alike)),
        ("Errors", table(key_figures(diagnosis))),
        ("This log could not have shown", Text(silent) if silent else None),
        ("Columns", Text("\n".join(columns)) if columns else None),
        ("Remarks", Text("\n".join(diagnosis.notes), style="yellow") if diagnosis.notes else None),
        ("What to do next", Text(steps)),
    ]


def finding_table(findings: Iterable[Finding]) -> Any:
    """Findings as a table, their parameters row by row; None without one."""
    from shipcosim.report.diagnosis.words import finding_rows

    return table(finding_rows(findings))


def table(rows: Iterable[Sequence[str]]) -> Any:
    """Rows of texts as a table without a head; None without rows."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, show_header=False)
    for row in rows:
        table.add_row(*row)
    return table if table.rows else None
