"""The command `sea-trials`: what a simulation gets wrong of a ship's manoeuvring trials, on the terminal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from shipcosim.cli.terminal import make_console

if TYPE_CHECKING:
    from shipcosim.diagnose.sea_trials.study import SeaTrialStudy


def print_study(found: SeaTrialStudy, folder: Path) -> None:
    """What was found, on stdout."""
    from rich.text import Text

    from shipcosim.cli.console import say_page, shown_path, style_of
    from shipcosim.report.sea_trials.words import outcome, told

    console = make_console(soft_wrap=True)
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
        console.print(
            f"Fitted on circles to {side}: {one.best.label}. Errors on the others, before and after:"
        )
        for name in one.before:
            unit = "deg" if name.endswith("drift") else "%"
            console.print(
                f"  {name:<28} {one.before[name]:6.1f} {one.after[name]:6.1f} {unit}", markup=False
            )
    say_page(console, folder / "report.html")
    console.print(f"Numbers: {shown_path(folder / 'sea_trials.json')}", markup=False)


def _what_separates(found: SeaTrialStudy) -> list[str]:
    """What to sail next, and for comparison what the manoeuvres of these trials would tell."""
    if not found.separations:
        return []
    rows = []
    for one in found.prescriptions:
        rows.append(f"Sail next: {one.manoeuvre}, to both sides, {one.minutes:.0f} minutes.")
        rows += [f"  tells {a} from {b}" for a, b in one.separates]
    told = {pair for one in found.prescriptions for pair in one.separates}
    rows += [
        f"No manoeuvre of the catalogue tells {a} from {b}."
        for a, b in found.pairs
        if (a, b) not in told
    ]
    return rows
