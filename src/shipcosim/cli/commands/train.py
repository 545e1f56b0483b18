"""The commands `shipcosim train ...`: from the name of a component to its weights and the training report."""

from pathlib import Path
from typing import Annotated

import typer

from shipcosim.cli.options import Force, out_option
from shipcosim.cli.terminal import say
from shipcosim.errors import error_at, suggestion

DEFAULT_KIND = "paper-v"
Kind = Annotated[
    str, typer.Option("--kind", metavar="NAME", help="Which; an unknown name lists them all.")
]
Out = Annotated[
    Path | None,
    out_option("Folder of weights and report. [default: results/train-NAME]"),
]


def allocator(
    kind: Kind = DEFAULT_KIND,
    out: Out = None,
    force: Force = False,
) -> None:
    """Train a neural allocator from scratch, with a fixed seed: a second training gives the same weights.

    Leaves NAME.npz, the weights, and the training report NAME.json and NAME.md. Needs torch:
    pip install "shipcosim[learn]".

    Example: shipcosim train allocator --kind paper-v
    """
    _train("allocator", kind, out, force)


def drift(
    kind: Annotated[str, typer.Option("--kind", metavar="NAME", help="ours or paper-iv.")] = "ours",
    out: Out = None,
    force: Force = False,
) -> None:
    """Train a predictor of the drift after a loss of thrust, from simulated worlds, with fixed seeds.

    Simulates the worlds first, two at a time. Leaves NAME.npz, the weights, and the training report NAME.json and
    NAME.md. Needs torch: pip install "shipcosim[learn]".

    Example: shipcosim train drift --kind ours
    """
    _train("drift", kind, out, force)


def dead_reckoning(
    kind: Kind = "motion-filter",
    out: Out = None,
    force: Force = False,
) -> None:
    """Train dead reckoning of the 82.7 m vessel from scratch, its records by co-simulation included.

    Leaves NAME.npz, the weights, and the training report NAME.json and NAME.md. Needs torch:
    pip install "shipcosim[learn]".

    Example: shipcosim train dead-reckoning --kind paper-ii
    """
    _train("dead-reckoning", kind, out, force)


def docking(
    kind: Annotated[
        str, typer.Option("--kind", metavar="NAME", help="ours or paper-iii.")
    ] = "ours",
    out: Out = None,
    force: Force = False,
) -> None:
    """Train a predictor of dockings by hand, from simulated dockings, with fixed seeds.

    Simulates the dockings first, two at a time. Leaves NAME.npz, the weights, and the training report NAME.json and
    NAME.md. Needs torch: pip install "shipcosim[learn]".

    Example: shipcosim train docking --kind ours
    """
    _train("docking", kind, out, force)


def _train(component: str, kind: str, out: Path | None, force: bool) -> None:
    """Train a component, write weights and report, and say where. Nothing is written where something is wrong."""
    from shipcosim.cli.console import progress_of, shown_path
    from shipcosim.staging import check_targets, staged

    try:
        from shipcosim import learn
    except ModuleNotFoundError as error:
        if error.name != "torch":
            raise
        raise error_at(
            "train",
            "Training needs torch, which is not installed.",
            'Install the extra `learn`: pip install "shipcosim[learn]".',
        ) from None
    kinds = list(learn.COMPONENTS[component])
    if kind not in kinds:
        raise error_at("--kind", f"There is no '{kind}'.", suggestion(kind, kinds))
    folder = out or Path("results") / f"train-{kind}"
    check_targets(folder)
    with staged(folder, force=force) as stage, progress_of(kind) as progress:
        written = learn.train(component, kind, stage, progress)
    for file in written:
        say(shown_path(folder / file.name))
