"""What `shipcosim compare` takes and says."""

import json
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from shipcosim import library
from shipcosim.cli.console import WIDTH
from shipcosim.cosim.compare import OURS, Comparison, Difference, Signal
from shipcosim.cosim.engines.foreign_process import readers
from shipcosim.cosim.engines.registry import ENGINES, OWN, engines_missing
from shipcosim.errors import Problem, ShipcosimError
from shipcosim.scenario import Scenario
from shipcosim.ssp import System, osp_file, pack
from shipcosim.ssp.portability.as_interpreted import taken_by, told_set


def not_compared() -> list[str]:
    """What a comparison will not do, known before anything runs: engines that are not installed."""
    missing = engines_missing()
    said = [f"{name} is not compared: {problem}" for name, problem in missing.items()]
    if len(missing) == len(ENGINES) - len(OWN):
        said.append("No other engine is installed: what follows is the step-size error of ours alone.")
    return said


def print_comparison(comparison: Comparison, as_json: bool) -> None:
    """Table of signals, then what did not run, what explains differences, and the verdict; or all of it as JSON."""
    if as_json:
        print(json.dumps(_plain(asdict(comparison) | {"agree": comparison.agree}), indent=2, ensure_ascii=False))
        return
    console = Console(highlight=False, soft_wrap=True)
    console.width = max(console.width, WIDTH)
    console.print(_table(comparison))
    for name, seconds in comparison.seconds.items():
        console.print(f"{name} ran in {seconds:.1f} s.")
    for name, why in comparison.left_out.items():
        console.print(Text(f"{name} {'failed' if name in comparison.failed else 'did not run'}: {why}", style="yellow"))
    for name, remarks in comparison.remarks.items():
        for remark in remarks:
            console.print(Text(f"{name}: {remark}", style="yellow"))
    console.print(*_verdict(comparison))


@contextmanager
def reading(
    given: str, system: System, scenario: Scenario, parameters: Sequence[Path] | None = None
) -> Iterator[dict[str, Any]]:
    """Arguments of `compare` with which the tools read a system's file themselves.

    Parameters
    ----------
    given : str
        An .ssp, a folder with a SystemStructure.ssd, or an OspSystemStructure.xml.
    system : System
        As we read it.
    scenario : Scenario
        Its steps.
    parameters : sequence of Path, optional
        Parameter sets that are not in the file: there must be none.

    Raises
    ------
    ShipcosimError
        If it is none of these, a component runs another FMU than the file says, or something happens in the scenario.
    """
    given = library.find_any(given)
    path, fmus = Path(given), library.fmus(given)
    if parameters:
        raise ShipcosimError(Problem("--parameters", "A tool that reads the file itself does not know them."))
    if system.swapped:
        found = f"A tool that reads the file itself runs the FMU that it names for {', '.join(system.swapped)}."
        raise ShipcosimError(Problem(given, found, "Compare FMUs in place of others without --as-read."))
    if system.experiment.start_time:
        found = f"The system starts at {system.experiment.start_time:g} s, but a comparison starts at 0."
        raise ShipcosimError(Problem(given, found, "Let it start at 0."))
    with TemporaryDirectory(prefix="shipcosim-") as folder:
        if structure := osp_file(path):
            yield {"readers": readers(structure.resolve(), scenario)}
            return
        if path.is_dir():
            pack(path, fmus, Path(folder) / "system.ssp")
            packed = Path(folder) / "system.ssp"
        elif path.suffix.lower() == ".ssp":
            packed = path.resolve()
        else:
            remedy = "Give an .ssp, a folder with a SystemStructure.ssd, or an OspSystemStructure.xml."
            raise ShipcosimError(Problem(given, "The tools cannot read this themselves.", remedy))
        yield {
            "readers": readers(packed, scenario, set_name=told_set(given, fmus=fmus)),
            "taken": partial(taken_by, path=given, fmus=fmus),
        }


def _table(comparison: Comparison) -> Table:
    others = [name for name in comparison.seconds if name != OURS]
    table = Table(box=None, pad_edge=False)
    table.add_column("signal", no_wrap=True)
    headings = ["unit", "range", *others, "of range", "at t [s]", "half the step", "of range", "agree"]
    for heading in headings:
        table.add_column(heading, justify="left" if heading in ("unit", "agree") else "right", no_wrap=True)
    for signal in comparison.signals:
        table.add_row(*map(Text, _row(signal, others)), style="red" if signal.worst > comparison.tolerance else "")
    return table


def _row(signal: Signal, others: Sequence[str]) -> list[str]:
    found = [signal.engines.get(name, Difference(math.nan, math.nan, math.nan)) for name in others]
    worst = max(found, key=lambda d: math.inf if math.isnan(d.relative) else d.relative, default=None)
    cells = [signal.name, signal.unit, f"{signal.range:.4g}", *(f"{difference.largest:.1e}" for difference in found)]
    cells += ["", ""] if worst is None else [f"{worst.relative:.1e}", f"{worst.time:.6g}" if worst.largest else ""]
    groups = "all" if len(signal.agreeing) == 1 else " | ".join(" = ".join(group) for group in signal.agreeing)
    return [*cells, f"{signal.step.largest:.1e}", f"{signal.step.relative:.1e}", groups]


def _verdict(comparison: Comparison) -> tuple[Text, Text]:
    others = [name for name in comparison.seconds if name != OURS]
    if not others and not comparison.failed:
        return Text("alone", style="bold yellow"), Text("No other engine ran: only the step-size error is known.")
    differing = sum(signal.worst > comparison.tolerance for signal in comparison.signals)
    limit, n = f"{comparison.tolerance:g} of its range", len(comparison.signals)
    if comparison.agree:
        said = f"{', '.join([OURS, *others])} agree on each of the {n} signals to {limit}."
        return Text("agree", style="bold green"), Text(said)
    return Text("differ", style="bold red"), Text(f"{differing} of {n} signals differ by more than {limit}.")


def _plain(value: Any) -> Any:
    """The same with numbers that JSON does not know as texts."""
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value
