"""The command `sea-trials`: what a simulation gets wrong of a ship's manoeuvring trials."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim import library
from shipcosim.cli.diagnosis import DEFAULT_SYSTEM, check_inputs, default_folder
from shipcosim.cli.progress import LAST_STEP, shown_progress

if TYPE_CHECKING:
    from shipcosim.diagnose.sea_trials.study import SeaTrialStudy

FILES = ("sea_trials.json", "report.html", "extended.ssp", "extended.ssv")


def study_log(
    data: str | os.PathLike,
    out: Path | None = None,
    *,
    system: str | None = None,
    channels: str | os.PathLike | None = None,
    effects: str | os.PathLike | None = None,
    orders: bool = False,
) -> tuple[SeaTrialStudy, Path]:
    """Study the sea trials of a log and write what was found.

    Parameters
    ----------
    data : path
    out : Path, optional
        Gets sea_trials.json, report.html, and where causes were found extended.ssp and extended.ssv.
        Default: results/DATA-sea-trials.
    system : str, optional
        As for `library.find`; the default one without.
    channels, effects : path, optional
        Channel file, and folder with further causes.
    orders : bool
        Whether thruster channels are orders instead of feedback.

    Returns
    -------
    tuple of SeaTrialStudy, Path
        What was found, and the folder.

    Raises
    ------
    ShipcosimError
        Input that cannot be used; nothing is written then.
    """
    from shipcosim.cli.requests import system_of
    from shipcosim.cli.results import check_targets
    from shipcosim.diagnose.extension.extend import extend
    from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
    from shipcosim.diagnose.sea_trials.study import STEPS, study
    from shipcosim.report.sea_trials.page import write_sea_trials
    from shipcosim.series import write_json
    from shipcosim.ssp import read
    from shipcosim.staging import staged

    check_inputs([data], channels, effects)
    folder = out or default_folder(data, "-sea-trials")
    check_targets(folder)
    given = library.find("system", system or DEFAULT_SYSTEM, "--system")
    with shown_progress(STEPS) as show, staged(folder, FILES) as stage:
        found = study(data, system_of(str(given)), channels, effects, show, orders=orders)
        show(LAST_STEP)
        write_json(found.as_json(), stage / FILES[0])
        facts = {"Log": Path(data).name, "System": given.name, "Thrusters": "orders" if orders else "feedback"}
        write_sea_trials(found, stage / FILES[1], facts)
        if found.findings:
            extend(read(given), found.findings, stage, catalogue=read_catalogue(effects))
    return found, folder


def print_study(found: SeaTrialStudy, folder: Path, as_json: bool) -> None:
    """What was found, on stdout."""
    from rich.console import Console
    from rich.text import Text

    from shipcosim.cli.console import shown_path, style_of
    from shipcosim.report.sea_trials.words import outcome, told

    if as_json:
        print(json.dumps(found.as_json(), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    kinds = [trial.kind for trial in found.trials]
    console.print(", ".join(f"{kinds.count(kind)} {kind}s" for kind in dict.fromkeys(kinds)))
    verdict = outcome(found)
    console.print(Text(verdict.word, style=style_of(found.verdict)), Text(verdict.sentence))
    console.print(f"  {told(found.best)}", markup=False)
    for one in found.rivals:
        console.print(f"  as likely: {told(one)}", markup=False)
    for row in _what_separates(found):
        console.print(row, markup=False)
    for side, one in found.held_out.items():
        console.print(f"Fitted on circles to {side}: {one.best.label}. Errors on the others, before and after:")
        for name in one.before:
            unit = "deg" if name.endswith("drift") else "%"
            console.print(f"  {name:<28} {one.before[name]:6.1f} {one.after[name]:6.1f} {unit}", markup=False)
    console.print(f"Page: {shown_path(folder / FILES[1])}", markup=False)
    console.print(f"Numbers: {shown_path(folder / FILES[0])}", markup=False)


def _what_separates(found: SeaTrialStudy) -> list[str]:
    """What to sail next, and for comparison what the manoeuvres of these trials would tell."""
    if not found.separations:
        return []
    rows = []
    for one in found.prescriptions:
        rows.append(f"Sail next: {one.manoeuvre}, to both sides, {one.minutes:.0f} minutes.")
        rows += [f"  tells {a} from {b}" for a, b in one.separates]
    told = {pair for one in found.prescriptions for pair in one.separates}
    rows += [f"No manoeuvre of the catalogue tells {a} from {b}." for a, b in found.pairs if (a, b) not in told]
    return rows
