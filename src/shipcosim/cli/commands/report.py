"""The command `shipcosim report`."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Force, Out
from shipcosim.cli.terminal import say


def report(
    first: Annotated[
        Path,
        typer.Argument(metavar="A", help="Results of a run: its folder, or a table (.nc, .csv)."),
    ],
    second: Annotated[Path, typer.Argument(metavar="B", help="Those of another.")],
    out: Out = None,
    force: Force = False,
) -> None:
    """Lay two runs over each other: both ships in one scene, both runs in every plot, and by how much they differ.

    Leaves report.html in results/A-B. Example: shipcosim report results/four_corner results/four_corner_rough
    """
    from shipcosim.calls.reports import names_of
    from shipcosim.calls.reports import report as lay_over

    folder = out or Path("results") / "-".join(names_of(first, second))
    result = lay_over(first, second, out=folder, force=force)
    say(f"{result.outcome.word} {result.outcome.sentence}")
    for d in result.comparison.differences[:5]:
        say(f"  {d.signal}: {d.rms:.3g} {d.unit} rms, {d.largest:.3g} {d.unit} at {d.time:g} s")
    say(f"Page: {folder / 'report.html'}")
