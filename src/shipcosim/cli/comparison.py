"""What `shipcosim compare` takes and says."""

import math
from collections.abc import Sequence

from rich.text import Text

from shipcosim.cli.console import say_outcome
from shipcosim.cli.tables import print_table
from shipcosim.cli.terminal import make_console
from shipcosim.cosim.compare import OURS, Comparison, Difference, Signal
from shipcosim.cosim.engines.registry import ENGINES, OWN, engines_missing
from shipcosim.results.studies import EngineComparison


def not_compared() -> list[str]:
    """What a comparison will not do, known before anything runs: engines that are not installed."""
    missing = engines_missing()
    said = [f"{name} is not compared: {problem}" for name, problem in missing.items()]
    if len(missing) == len(ENGINES) - len(OWN):
        said.append(
            "No other engine is installed: what follows is the step-size error of ours alone."
        )
    return said


def print_comparison(comparison: EngineComparison) -> None:
    """Table of signals, then what did not run, what explains differences, and the verdict."""
    console = make_console(soft_wrap=True)
    others = [name for name in comparison.seconds if name != OURS]
    # What decides stands first: columns that do not fit are left out at the end.
    head = ["signal", "unit", "of range", "at t [s]", "agree", *others]
    head += ["half the step", "of range", "range"]
    print_table(console, _rows(comparison, others), head)
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


def _rows(comparison: Comparison, others: Sequence[str]) -> list[list[Text]]:
    """Rows of the table; those of signals that differ are red."""
    return [
        [
            Text(cell, style="red" if signal.worst > comparison.tolerance else "")
            for cell in _row(signal, others)
        ]
        for signal in comparison.signals
    ]


def _row(signal: Signal, others: Sequence[str]) -> list[str]:
    found = [signal.engines.get(name, Difference(math.nan, math.nan, math.nan)) for name in others]
    worst = max(
        found, key=lambda d: math.inf if math.isnan(d.relative) else d.relative, default=None
    )
    cells = [signal.name, signal.unit]
    cells += (
        ["", ""]
        if worst is None
        else [f"{worst.relative:.1e}", f"{worst.time:.6g}" if worst.largest else ""]
    )
    groups = (
        "all"
        if len(signal.agreeing) == 1
        else " | ".join(" = ".join(group) for group in signal.agreeing)
    )
    step = signal.step
    by_half = ["not tried", ""] if step is None else [f"{step.largest:.1e}", f"{step.relative:.1e}"]
    largest = [f"{difference.largest:.1e}" for difference in found]
    return [*cells, groups, *largest, *by_half, f"{signal.range:.4g}"]
