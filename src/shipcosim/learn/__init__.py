"""Learned components trained from scratch: data, networks, training loop, weights, report.

The only door to torch, which comes with `pip install "shipcosim[learn]"`. What is trained is evaluated without it, by
`shipcosim.models.core.networks`. A new component is one file here with a function that returns `Trained`, and one line
in `kinds`.
"""

from shipcosim.learn.kinds import (
    ALLOCATORS,
    COMPONENTS,
    DEAD_RECKONING,
    DOCKING,
    DRIFT,
    Kind,
    train,
)
from shipcosim.learn.results import Trained, write_trained

__all__ = [
    "ALLOCATORS",
    "COMPONENTS",
    "DEAD_RECKONING",
    "DOCKING",
    "DRIFT",
    "Kind",
    "Trained",
    "train",
    "write_trained",
]
