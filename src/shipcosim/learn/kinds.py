"""Components that can be trained: one line each."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from shipcosim.learn import paper_i, paper_v
from shipcosim.learn.dead_reckoning import recipes as dead_reckoning
from shipcosim.learn.docking import training as docking
from shipcosim.learn.prediction import training as drift
from shipcosim.learn.results import Trained, write_trained
from shipcosim.learn.training import Progress


@dataclass(frozen=True)
class Kind:
    """A component that can be trained.

    Parameters
    ----------
    description : str
        One line for users.
    train : callable
        Trains it from scratch: takes a function that is told how far it is.
    """

    description: str
    train: Callable[[Progress], Trained]


def _kinds(
    recipes: Mapping[str, Any], train: Callable[[Any, Progress], Trained]
) -> dict[str, Kind]:
    """A kind for each recipe of a module."""
    return {
        name: Kind(recipe.description, partial(train, recipe)) for name, recipe in recipes.items()
    }


ALLOCATORS: Mapping[str, Kind] = {
    **_kinds(paper_v.RECIPES, paper_v.train),
    **_kinds(paper_i.RECIPES, paper_i.train),
}
"""Allocators by the name that `shipcosim train allocator --kind NAME` takes; the first is the default."""

DRIFT: Mapping[str, Kind] = {
    **_kinds({"ours": drift.OURS}, partial(drift.train, drift.ours)),
    **_kinds({"paper-iv": drift.PAPER_IV}, partial(drift.train, drift.as_paper_iv)),
}
"""Drift predictors by the name that `shipcosim train drift --kind NAME` takes; the first is the default."""

DEAD_RECKONING: Mapping[str, Kind] = {
    name: Kind(description, partial(dead_reckoning.train, name))
    for name, description in dead_reckoning.KINDS.items()
}
"""Dead reckoning by the name that `shipcosim train dead-reckoning --kind NAME` takes; the first is the default."""

DOCKING: Mapping[str, Kind] = {
    **_kinds({"ours": docking.OURS}, partial(docking.train, docking.learn_ours)),
    **_kinds({"paper-iii": docking.PAPER_III}, partial(docking.train, docking.learn_paper_iii)),
}
"""Predictors of dockings by the name that `shipcosim train docking --kind NAME` takes; the first is the default."""
COMPONENTS: Mapping[str, Mapping[str, Kind]] = {
    "allocator": ALLOCATORS,
    "drift": DRIFT,
    "dead-reckoning": DEAD_RECKONING,
    "docking": DOCKING,
}
"""What `shipcosim train` takes."""


def train(component: str, name: str, folder: Path, progress: Progress) -> list[Path]:
    """Train a component from scratch, and write its weights and report.

    Parameters
    ----------
    component : str
        One of `COMPONENTS`.
    name : str
        One of its kinds.
    folder : Path
        Where to; it exists.
    progress : callable
        Called with how many steps are done, and of how many at most.

    Returns
    -------
    list of Path
        NAME.npz, NAME.json and NAME.md.
    """
    # Time by the clock and of the processor: the report states both.
    clock = time.perf_counter()
    processor = time.process_time()
    trained = COMPONENTS[component][name].train(progress)
    return write_trained(
        trained, folder, name, time.perf_counter() - clock, time.process_time() - processor
    )
