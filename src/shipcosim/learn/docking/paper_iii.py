"""The networks of paper III: an ensemble of three LSTMs with dropout for the errors of the kinetic model over 30 s.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper III.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import torch

from shipcosim.learn.docking import fitting
from shipcosim.learn.docking.fitting import tensor
from shipcosim.learn.docking.inputs import Replay
from shipcosim.learn.networks import Arrays
from shipcosim.learn.training import Epochs, Progress, repeatable
from shipcosim.models.prediction import paper_iii

RATES = (1e-4, 1e-1)
LAYERS = (1, 2)
LEAST_NODES = 10
"""What the paper searches in: learning rate, LSTM layers, nodes of a layer, from 10 to 500."""


@dataclass(frozen=True)
class PaperIIITraining:
    """How the ensemble is trained; members of 3, and what is searched in are the paper's.

    Parameters
    ----------
    description : str
        One line for users.
    seed : int
        Of search, weights and order.
    trials, trial_epochs, most_nodes : int
        Of the search: sets of numbers drawn, epochs of each, and most nodes.
    members, width, layers : int
        Networks; units of an LSTM layer and layers, as the search leaves them.
    dropout : float
        As `Recurrent`. [1]
    epochs, batch : int
        Epochs at most; dockings in a step of the optimiser.
    learning_rate, decay, noise : float
        Of Adam at the start, as the search leaves it; weight decay; noise added to inputs. [1]
    """

    description: str = (
        "The docking predictor of paper III: three LSTMs add the errors of the kinetic model"
    )
    seed: int = 3
    trials: int = 10
    trial_epochs: int = 5
    most_nodes: int = 500
    members: int = 3
    width: int = 0
    layers: int = 1
    dropout: float = 0.2
    epochs: int = 25
    batch: int = 4
    learning_rate: float = 0.0
    decay: float = 0.0
    noise: float = 0.0


def inputs_of(replay: Replay) -> np.ndarray:
    """Inputs of the networks, (m, n, 15) array."""
    return paper_iii.inputs(replay.aboard)


def targets(replay: Replay) -> np.ndarray:
    """Errors of the kinetic model: (m, n, 60) array, north in 1 to 30 s, then east. [m]"""
    # Error = measured later - predicted; time last, as outputs of the networks.
    errors = [
        replay.later[name][1:] - np.stack([motion[k] for motion in replay.kinetic])
        for k, name in enumerate(("x", "y"))
    ]
    return np.moveaxis(np.concatenate(errors), 0, -1)


def squares(given: torch.Tensor, target: torch.Tensor) -> torch.Tensor:
    """Mean square over the finite targets."""
    there = torch.isfinite(target)
    return ((given - torch.nan_to_num(target)) ** 2 * there).sum() / there.sum()


def draws(recipe: PaperIIITraining) -> list[PaperIIITraining]:
    """Settings that the search tries: uniform in the logarithms of learning rate and width."""
    rng = np.random.default_rng(recipe.seed)
    settings = []
    for _ in range(recipe.trials):
        # Logarithmic draws: both ranges span orders of magnitude.
        bounds = RATES, (LEAST_NODES, recipe.most_nodes)
        rate, nodes = (float(np.exp(rng.uniform(*np.log(bound)))) for bound in bounds)
        layers = int(rng.integers(LAYERS[0], LAYERS[1] + 1))
        # Two digits of the learning rate are enough, and readable in the report.
        settings.append(
            replace(recipe, learning_rate=float(f"{rate:.2g}"), width=round(nodes), layers=layers)
        )
    return settings


def fit(
    training: tuple[np.ndarray, np.ndarray],
    choice: tuple[np.ndarray, np.ndarray],
    recipe: PaperIIITraining,
    progress: Progress,
) -> tuple[Arrays, Epochs, list[tuple[PaperIIITraining, float]]]:
    """Search and train the ensemble.

    Parameters
    ----------
    training, choice : tuples of two arrays
        Inputs and targets, to train on and to choose by.
    recipe : PaperIIITraining
        How.
    progress : callable
        Called with how far it is, and of how much.

    Returns
    -------
    dict of str to array, list of dict, list of tuples
        As `paper_iii.ensemble_of` takes them; losses by member and epoch; what was tried, with its loss.
    """
    # Standardise inputs and targets; errors beyond the end of a record are NaN.
    mean = training[0].mean(axis=(0, 1))
    std = training[0].std(axis=(0, 1)) + 1e-9
    target_mean = np.nanmean(training[1], axis=(0, 1))
    target_std = np.nanstd(training[1], axis=(0, 1))
    # The same scales for data to train on and data to choose by.
    trained, held = (
        (tensor((x - mean) / std), tensor((y - target_mean) / target_std))
        for x, y in (training, choice)
    )
    outputs = len(target_mean)
    tried = []
    # Random search: train one member briefly with each setting, keep the one with the least loss.
    with repeatable(recipe.seed):
        for number, settings in enumerate(draws(recipe)):
            short = replace(settings, members=1, epochs=recipe.trial_epochs)
            _, epochs = fitting.fit(
                trained, held, squares, outputs, short, lambda done, total: None
            )
            tried.append((settings, min(epoch["choices"] for epoch in epochs)))
            progress(number + 1, 2 * recipe.trials)
        best = min(tried, key=lambda pair: pair[1])[0]

        def tell(done, total):
            progress(total + done, 2 * total)

        # Train the full ensemble with the best settings.
        weights, epochs = fitting.fit(trained, held, squares, outputs, best, tell)
    arrays = {"mean": mean, "std": std, "target_mean": target_mean, "target_std": target_std}
    return arrays | weights, epochs, tried


def expected(arrays: Mapping[str, np.ndarray], inputs: np.ndarray) -> np.ndarray:
    """Errors that the ensemble predicts over (m, n) inputs: (m, n, 60) array. [m]

    Each docking starts from an empty memory.
    """
    # Second by second with its memory, as the predictor runs aboard.
    ensemble = paper_iii.ensemble_of(arrays)
    memory = ()
    rows = []
    for k in range(inputs.shape[1]):
        given, memory = paper_iii.errors(inputs[:, k], memory, ensemble)
        rows.append(given)
    return np.stack(rows, axis=1)
