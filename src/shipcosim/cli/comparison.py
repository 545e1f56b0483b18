"""What `shipcosim compare` takes and says."""

from rich.text import Text

from shipcosim.cli.console import say_outcome
from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console
from shipcosim.cosim.engines.registry import ENGINES, OWN, engines_missing
from shipcosim.errors import counted
from shipcosim.results.studies import EngineComparison

MOST_SHOWN = 30
"""Signals that the table shows beside those that differ by more than the tolerance."""


def not_compared() -> list[str]:
    """What a comparison will not do, known before anything runs: engines that are not installed."""
    missing = engines_missing()
    lines = [f"{name} is not compared: {problem}" for name, problem in missing.items()]
    if len(missing) == len(ENGINES) - len(OWN):
        lines.append(
            "No other engine is installed: what follows is the step-size error of ours alone."
        )
    return lines


def print_comparison(comparison: EngineComparison) -> None:
    """Table of the signals that differ most, then what did not run, what explains differences, and the verdict."""
    from shipcosim.report.notebook.study_cards import comparison_table

    console = make_console(soft_wrap=True)
    # Rows of signals that differ are red, and come first. The others are shown as far as a reader goes.
    table = comparison_table(comparison)
    rows = []
    differing = 0
    for signal, row in zip(comparison.signals, table.rows, strict=True):
        differs = signal.worst > comparison.tolerance
        differing += differs
        rows.append([Text(cell, style="red" if differs else "") for cell in row])
    shown = rows[: max(MOST_SHOWN, differing)]
    print_table(console, shown, table.head)
    if len(shown) < len(rows):
        left_out = counted(len(rows) - len(shown), "signal")
        console.print(f"{left_out} that differ less: --json has all.")
    for name, seconds in comparison.seconds.items():
        console.print(f"{name} ran in {seconds:.1f} s.")
    for name, why in comparison.left_out.items():
        console.print(
            Text(
                f"{name} {'failed' if name in comparison.failed else 'did not run'}: {why}",
                style="yellow",
            )
        )
    for name, remarks in comparison.remarks.items():
        for remark in remarks:
            console.print(Text(f"{name}: {remark}", style="yellow"))
    say_outcome(console, comparison.outcome)
