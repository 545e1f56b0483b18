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
    from shipcosim.report import write_comparison
    from shipcosim.series import read_table
    from shipcosim.staging import check_targets, staged

    names = _names(first, second)
    folder = out or Path("results") / f"{names[0]}-{names[1]}"
    check_targets(folder)
    tables = read_table(_table(first)), read_table(_table(second))
    with staged(folder, force=force) as stage:
        outcome, differences = write_comparison(tables, names, stage / "report.html")
    say(f"{outcome.word} {outcome.sentence}")
    for d in differences[:5]:
        say(f"  {d.signal}: {d.rms:.3g} {d.unit} rms, {d.largest:.3g} {d.unit} at {d.time:g} s")
    say(f"Page: {folder / 'report.html'}")


def _table(given: Path) -> Path:
    """The table of a run: a file, or the one in a folder of results."""
    from shipcosim.errors import error_at

    if not given.is_dir():
        return given
    for name in ("result.nc", "result.csv", "result-partial.nc", "result-partial.csv"):
        if (given / name).is_file():
            return given / name
    raise error_at(str(given), "There is no result.nc in this folder.", "Give the --out of a run.")


def _names(first: Path, second: Path) -> tuple[str, str]:
    """Short names of two runs: those of their folders or files, else A and B."""
    ways = []
    for path in (first.resolve(), second.resolve()):
        parts = list(path.parts[1:]) if path.is_dir() else [*path.parts[1:-1], path.stem]
        if len(parts) > 1 and parts[-1] in ("result", "result-partial"):
            parts.pop()
        ways.append(parts)
    for depth in (1, 2, 3):
        a, b = ("-".join(parts[-depth:]) for parts in ways)
        if a != b:
            return a, b
    return "A", "B"
