"""The allocators of paper I: extreme learning machines, trained from a recorded exercise of the thrusters.

NumPy alone: random weights, one pseudo-inverse.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper I; Huang, Zhu,
Siew, Extreme learning machine: a new learning scheme of feedforward neural networks, IJCNN, 2004.
"""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from shipcosim.learn.datasets import digest
from shipcosim.learn.results import Trained
from shipcosim.learn.training import Progress
from shipcosim.series import read_table

RECORD = Path(__file__).with_name("paper_i_exercise.csv.gz")
"""The exercise: 7800 rows at 20 Hz of the load that all thrusters give, and their commands. Written by
docs/generators/write_exercise.py from a run of scenarios/paper_i/exercise.toml."""
UNITS = 6
NEURONS = 20
SEED = 1
HELD_OUT = 0.1
DIGITS = 1e-15
"""Cutoff of a pseudo-inverse to the digits of its numbers. [1]"""
NOTES = (
    "The paper does not print these points, so they are chosen here. Inputs are divided by their largest size in the"
    " exercise. Weights of the hidden layer are uniform in -1 to 1, its biases in 0 to 1, as in the code of the"
    " method's authors. The time of full thrust between the ramps is chosen too.",
    "With five signals, units 5 and 6 get one command. For allocator 1 this is the same network as with six signals:"
    " each output has its own weights, and those of units 5 and 6 have the same targets.",
    "Of the rows 10 % are held out, drawn at random as in the paper. Their neighbours at 20 Hz are trained on. The"
    " exercise never shows two thrusters at work together, except for the two main propellers.",
)


@dataclass(frozen=True)
class PaperITraining:
    """One variant.

    Parameters
    ----------
    description : str
        One line.
    cutoff : float
        Singular values below this share of the largest are left out of the pseudo-inverse. [1]
    """

    description: str
    cutoff: float = DIGITS


_OF = "Allocators 1 and 2 of paper I, 82.7 m vessel"
RECIPES = {
    "paper-i": PaperITraining(f"{_OF}, as printed"),
    "paper-i-cutoff": PaperITraining(
        f"{_OF}, singular values below 1 % of the largest left out", cutoff=0.01
    ),
}


def read_exercise() -> tuple[np.ndarray, np.ndarray]:
    """The recorded exercise.

    It is a table with `tau_X`, `tau_Y`, `tau_N` and `command_1` to `command_6`.

    Returns
    -------
    tuple of (n, 3) and (n, 6) array
        Loads and commands. [N, N, N.m; rpm, deg]
    """
    table = read_table(RECORD)
    # Loads are the inputs, commands the targets: the network inverts the exercise.
    loads = np.stack([table[f"tau_{axis}"].values for axis in "XYN"], axis=-1)
    return loads, np.stack(
        [table[f"command_{unit}"].values for unit in range(1, UNITS + 1)], axis=-1
    )


def samples(
    loads: np.ndarray, commands: np.ndarray, allocator: int, signals: int
) -> tuple[np.ndarray, np.ndarray]:
    """Inputs and targets of an allocator.

    Parameters
    ----------
    loads, commands : (n, 3), (n, 6) array
        The exercise. [N, N, N.m; rpm, deg]
    allocator : int
        1: inputs are the loads; 2: the commands of the row before as well.
    signals : int
        6, or 5 for one command to units 5 and 6.

    Returns
    -------
    tuple of (n, 3 or 3 + signals) and (n, signals) array
        Inputs, targets. [N, N, N.m, units of the commands]
    """
    targets = commands[:, :signals]
    # Allocator 2 also sees the commands of the row before; zero before the first row.
    before = np.vstack([np.zeros(signals), targets[:-1]])
    return (loads if allocator == 1 else np.hstack([loads, before])), targets


def fitted(
    inputs: np.ndarray,
    targets: np.ndarray,
    *,
    neurons: int = NEURONS,
    seed: int = SEED,
    cutoff: float = DIGITS,
) -> dict:
    """An extreme learning machine: random hidden layer, output weights by the pseudo-inverse.

    Parameters
    ----------
    inputs, targets : (n, inputs), (n, outputs) array
        What it is trained on.
    neurons, seed : int
        Of the hidden layer. [1]
    cutoff : float
        Of the singular values, over the largest. [1]

    Returns
    -------
    dict of str to array
        `scale`, `hidden`, `bias`, `output`, as `models.allocation.extreme_learning.Network` has them.
    """
    # Inputs over their largest size, so that sigmoids are not saturated.
    rng = np.random.default_rng(seed)
    scale = np.abs(inputs).max(axis=0)
    # The hidden layer is random and stays so (Huang et al.).
    network = {
        "scale": scale,
        "hidden": rng.uniform(-1.0, 1.0, (neurons, inputs.shape[1])),
        "bias": rng.random(neurons),
    }
    # Output weights by least squares: H^+ T, with small singular values left out.
    inverse = np.linalg.pinv(hidden_layer(network, inputs), rcond=cutoff)
    return network | {"output": (inverse @ targets).T}


def hidden_layer(network: dict, inputs: np.ndarray) -> np.ndarray:
    """Outputs of the hidden neurons.

    Parameters
    ----------
    network : dict of str to array
        With `scale`, `hidden`, `bias`.
    inputs : (n, inputs) array
        Inputs.

    Returns
    -------
    (n, neurons) array
        Between 0 and 1. [1]
    """
    return 1.0 / (
        1.0 + np.exp(-(inputs / network["scale"] @ network["hidden"].T + network["bias"]))
    )


def train(recipe: PaperITraining, progress: Progress) -> Trained:
    """Train both allocators with both numbers of signals.

    Parameters
    ----------
    recipe : PaperITraining
        The variant.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights and report.
    """
    # Ranges of the commands in the exercise: beyond them the thrust stays constant.
    loads, commands = read_exercise()
    arrays: dict[str, np.ndarray] = {"least": commands.min(axis=0), "most": commands.max(axis=0)}
    settings: dict = {"hidden neurons": NEURONS, "cutoff of the pseudo-inverse": recipe.cutoff}
    # Both allocators, each with six and with five signals.
    for done, (allocator, signals) in enumerate(((1, 6), (1, 5), (2, 6), (2, 5))):
        progress(done, 4)
        inputs, targets = samples(loads, commands, allocator, signals)
        # The paper reports the training time, so it is measured here.
        start = time.perf_counter()
        network = fitted(inputs, targets, cutoff=recipe.cutoff)
        seconds = time.perf_counter() - start
        arrays |= {f"{allocator}.{signals}.{name}": array for name, array in network.items()}
        # Errors by output, and by number of neurons, as the paper's tables.
        named = f"allocator {allocator}, {signals} signals"
        settings[f"{named}: RMSE on the exercise by output"] = _rounded(
            _rmse(network, inputs, targets)
        )
        settings[f"{named}: RMSE held out, over the range, by neurons"] = _by_neurons(
            inputs, targets, recipe.cutoff
        )
        settings[f"{named}: time of one training (s)"] = round(seconds, 3)
    return Trained(arrays, recipe.description, SEED, _about(loads, commands), settings, (), NOTES)


def _rmse(network, inputs, targets):
    return np.sqrt(
        ((hidden_layer(network, inputs) @ network["output"].T - targets) ** 2).mean(axis=0)
    )


def _by_neurons(inputs, targets, cutoff):
    """Held-out error over the range of the commands, mean over outputs, by number of neurons."""
    # Hold out 10 % of the rows at random, as in the paper.
    held = np.random.default_rng(SEED).random(len(inputs)) < HELD_OUT
    errors = {}
    for neurons in (5, 10, 20, 40, 80):
        network = fitted(inputs[~held], targets[~held], neurons=neurons, cutoff=cutoff)
        errors[neurons] = float(
            (_rmse(network, inputs[held], targets[held]) / np.ptp(targets, axis=0)).mean()
        )
    return ", ".join(f"{neurons}: {error:.2g}" for neurons, error in errors.items())


def _rounded(values):
    return [float(f"{value:.3g}") for value in values]


def _about(loads, commands):
    return {
        "rows, at 20 Hz": len(loads),
        "exercise": "each thruster alone, main propellers together: to full ahead, full astern, stop, at its rates",
        "largest load (N, N, N.m)": _rounded(np.abs(loads).max(axis=0)),
        "least command (rpm, deg)": _rounded(commands.min(axis=0)),
        "most command (rpm, deg)": _rounded(commands.max(axis=0)),
        "SHA-256 of the exercise": digest(np.hstack([loads, commands])),
    }
