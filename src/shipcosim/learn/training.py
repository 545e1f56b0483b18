"""The training loop: mini-batches, Adam, early stopping, the same weights from the same seed."""

import copy
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch

Progress = Callable[[int, int], None]
"""Is told how many steps are done, and of how many at most."""


def part_of(progress: Progress, before: float, share: float) -> Progress:
    """Progress of one part, told as progress of the whole in thousandths.

    Parameters
    ----------
    progress : callable
        Of the whole.
    before, share : float
        Of the whole: what is done when the part begins, and the part. [1]

    Returns
    -------
    callable
        Of the part.
    """
    return lambda done, total: progress(round(1000 * (before + share * done / total)), 1000)


@dataclass(frozen=True)
class Schedule:
    """How a network is trained.

    Parameters
    ----------
    seed : int
        Seed of the weights at the start and of the order of mini-batches.
    learning_rate : float
        Of Adam. [1]
    patience : int
        Training ends when the loss on held-out data has not improved for so many epochs. [1]
    most_epochs : int
        It ends after so many in any case. [1]
    """

    seed: int = 1
    learning_rate: float = 1e-3
    patience: int = 3
    most_epochs: int = 15


@contextmanager
def repeatable(seed: int) -> Iterator[None]:
    """One thread and a fixed seed: a second training gives the same weights, bit by bit, on the same processor.

    Parameters
    ----------
    seed : int
        Of torch's generator, which initialises weights.
    """
    # One thread and no denormals: sums then have one order, and vanishing gradients stay quick.
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    torch.set_flush_denormal(
        True
    )  # gradients that vanish along a sequence are slow to compute with
    try:
        # The caller's random state is kept; only this block uses the seed.
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            yield
    finally:
        torch.set_flush_denormal(False)
        torch.set_num_threads(threads)


def fit(
    network: torch.nn.Module,
    losses: Callable[[Any], dict[str, torch.Tensor]],
    batches: Sequence[Any] | torch.Tensor,
    held_out: Sequence[Any] | torch.Tensor,
    schedule: Schedule,
    progress: Progress,
) -> list[dict[str, float]]:
    """Train a network; it is left with the weights of its best epoch.

    Parameters
    ----------
    network : torch.nn.Module
        The network; call `repeatable` around making it and this.
    losses : callable
        From a mini-batch to weighted losses by name; their sum is minimised.
    batches, held_out : sequence or tensor
        Mini-batches to train on and to decide when to stop by; what `losses` takes, by index.
    schedule : Schedule
        How to train.
    progress : callable
        Is told after each mini-batch.

    Returns
    -------
    list of dict
        For each epoch the sum of losses in training, the sum on held-out data, and each of the latter.
    """
    # The order of mini-batches has its own generator: it does not depend on the network.
    order = np.random.default_rng(schedule.seed)
    optimiser = torch.optim.Adam(network.parameters(), lr=schedule.learning_rate, fused=True)
    epochs: list[dict[str, float]] = []
    best = np.inf
    weights = copy.deepcopy(network.state_dict())
    total = schedule.most_epochs * len(batches)
    for number in range(schedule.most_epochs):
        # One epoch: a step for each mini-batch, in random order.
        trained = 0.0
        for done, index in enumerate(order.permutation(len(batches)), number * len(batches) + 1):
            trained += _descend(optimiser, sum(losses(batches[index]).values()))
            progress(done, total)
        # Judge the epoch on held-out data; keep the best weights.
        found = _held_out(losses, held_out)
        epochs.append({"training": trained / len(batches), "held out": sum(found.values())} | found)
        if epochs[-1]["held out"] < best:
            best = epochs[-1]["held out"]
            weights = copy.deepcopy(network.state_dict())
        # Stop when none of the last `patience` epochs reached the best loss.
        if best < min(epoch["held out"] for epoch in epochs[-schedule.patience :]):
            break
    network.load_state_dict(weights)
    return epochs


def _descend(optimiser, loss):
    """One step of the optimiser; the loss before it."""
    optimiser.zero_grad()
    loss.backward()
    optimiser.step()
    return float(loss.detach())


def _held_out(losses, held_out):
    """Mean of each loss over held-out mini-batches."""
    with torch.no_grad():
        found = [losses(held_out[index]) for index in range(len(held_out))]
    return {name: float(np.mean([float(one[name]) for one in found])) for name in found[0]}
