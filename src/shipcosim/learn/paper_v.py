"""The neural allocator of paper V as it is printed, and one trained on sequences.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, chapter 5 and
paper V: "Constrained control allocation for dynamic ship positioning using deep neural network".
"""

from dataclasses import dataclass, field
from functools import partial

import numpy as np
import torch

from shipcosim.learn.datasets import digest, independent, random_walks
from shipcosim.learn.networks import Recurrent, arrays_of
from shipcosim.learn.results import Trained
from shipcosim.learn.training import Progress, Schedule, fit, repeatable

TUNNEL_X = 13.08
AZIMUTH_X = -13.22
AZIMUTH_Y = 2.7
"""Places of the thrusters, T2 to port and T3 to starboard. [m] OSP demo case of the ship of 28.9 m, grade B."""
RANGES = np.array([10e3, 5e3, 180.0, 5e3, 180.0])
"""Ranges of F1, F2, angle 2, F3, angle 3. [N, N, deg, N, deg] Paper V, eq. 3."""
LIMITS = np.array([8e3, 4e3, 80.0, 4e3, 80.0])
"""Their limits. [N, N, deg, N, deg] Paper V, IV-A."""
RATES = np.array([1000.0, 1000.0, 10.0, 1000.0, 10.0])
"""Their quickest changes. [N/s, N/s, deg/s, N/s, deg/s] Paper V, Table I."""
SAMPLE_TIME = 1.0
"""Assumed [s]: eq. 8 takes the rates of Table I as they are for changes from one sample to the next."""
SECTORS = ((-100.0, -80.0), (80.0, 100.0))
"""Disallowed sectors of both azimuths. [deg] Paper V, III-B5."""
K = (100.0, 100.0, 0.1, 1e-7, 1e-7, 0.1)
"""Weights k0 to k5 of the losses. [1] Paper V, Table II."""
WIDTH = 64
LAYERS = 2
NAMES = ("k0 L0", "k1 L1", "k2 L2", "k3 L3", "k4 L4", "k5 L5")
NOTES = (
    "The paper does not print these points, so they are chosen here. Adam has a learning rate of 0.001 and torch's"
    " initial weights. A mini-batch of 1024 samples is 8 sequences of 128, and each begins with an empty memory. The"
    " sample time is 1 s, since equation 8 takes the rates of Table I as they are. L0 and L1 are in standardised"
    " forces, L2 and L3 in N and deg. Losses are means over a mini-batch. The decoder sees the code before it is"
    " rescaled. The weights are those of the best of at most 15 epochs.",
    "The configuration matrix is the full one, with x sin(angle); the paper prints it without.",
)


@dataclass(frozen=True)
class PaperVTraining:
    """One variant.

    Parameters
    ----------
    description : str
        One line.
    k4 : float
        Weight of the power. [1]
    walks : bool
        Trained on random walks, where the paper has independent samples.
    batches, sequences, samples : int
        Mini-batches to train on and to stop by, of so many sequences of so many samples. [1]
    seed : int
        Of all that is drawn. [1]
    share : float
        Share of the mini-batches that is trained on. [1]
    schedule : Schedule
        How it is trained.
    """

    description: str
    k4: float = K[4]
    walks: bool = False
    batches: int = 976
    sequences: int = 8
    samples: int = 128
    seed: int = 1
    share: float = 0.9
    schedule: Schedule = field(default_factory=Schedule)


_OF = "Neural allocator of paper V, 28.9 m ship"
RECIPES = {
    "paper-v": PaperVTraining(f"{_OF}, as printed: k4 = 1e-7, independent samples"),
    "paper-v-k4-3": PaperVTraining(f"{_OF}, as printed but k4 = 3e-7", k4=3e-7),
    "paper-v-k4-5": PaperVTraining(f"{_OF}, as printed but k4 = 5e-7", k4=5e-7),
    "paper-v-walks": PaperVTraining(f"{_OF}, as printed but trained on random walks", walks=True),
}


@dataclass(frozen=True)
class Data:
    """Commands and the standardised forces that they give, by mini-batch; the first `trained` are trained on."""

    commands: np.ndarray
    forces: torch.Tensor
    mean: np.ndarray
    std: np.ndarray
    trained: int


class Autoencoder(torch.nn.Module):
    """Encoder from forces to commands over their ranges, decoder back."""

    def __init__(self) -> None:
        super().__init__()
        self.encoder = Recurrent(3, WIDTH, LAYERS, len(RANGES))
        self.decoder = Recurrent(len(RANGES), WIDTH, LAYERS, 3)


def train(recipe: PaperVTraining, progress: Progress) -> Trained:
    """Train one variant from scratch.

    Parameters
    ----------
    recipe : PaperVTraining
        The variant.
    progress : callable
        Called with how far it is.

    Returns
    -------
    Trained
        Weights, data and losses.
    """
    # Draw the data and train the autoencoder; held-out mini-batches decide when to stop.
    data = data_of(recipe)
    with repeatable(recipe.schedule.seed):
        network = Autoencoder()
        loss = partial(losses, network, k4=recipe.k4, mean=_row(data.mean), std=_row(data.std))
        batches = data.forces[: data.trained]
        held_out = data.forces[data.trained :].flatten(0, 1)[None]
        epochs = fit(network, loss, batches, held_out, recipe.schedule, progress)
    # Commands with their angles in rad.
    radians = RANGES * np.array([1.0, 1.0, np.pi / 180.0, 1.0, np.pi / 180.0])
    arrays = {
        "mean": data.mean,
        "std": data.std,
        "ranges": radians,
        "sample_time": np.array(SAMPLE_TIME),
    }
    arrays |= arrays_of(network.encoder, "encoder") | arrays_of(network.decoder, "decoder")
    return Trained(
        arrays,
        recipe.description,
        recipe.seed,
        _about(recipe, data),
        _settings(recipe),
        epochs,
        NOTES,
    )


def data_of(recipe: PaperVTraining) -> Data:
    """Draw the commands and standardise their forces.

    Parameters
    ----------
    recipe : PaperVTraining
        The variant.

    Returns
    -------
    Data
        The first mini-batches are those to train on.
    """
    # Independent commands as printed, or walks within the rates.
    rng = np.random.default_rng(recipe.seed)
    size = recipe.batches * recipe.sequences, recipe.samples
    drawn = (
        random_walks(RANGES, RATES * SAMPLE_TIME, *size, rng)
        if recipe.walks
        else independent(RANGES, *size, rng)
    )
    # Standardise forces by the mini-batches for training only.
    trained = round(recipe.share * recipe.batches)
    drawn = drawn.reshape(recipe.batches, recipe.sequences, recipe.samples, len(RANGES))
    forces = generalised_force(torch.from_numpy(drawn)).numpy()
    mean = forces[:trained].mean((0, 1, 2))
    std = forces[:trained].std((0, 1, 2))
    return Data(drawn, torch.from_numpy((forces - mean) / std).float(), mean, std, trained)


def generalised_force(commands: torch.Tensor) -> torch.Tensor:
    """Force that commands give together, by the full configuration matrix.

    Parameters
    ----------
    commands : (..., 5) tensor
        F1, F2, angle 2, F3, angle 3. [N, N, deg, N, deg]

    Returns
    -------
    (..., 3) tensor
        Forward, to starboard, yaw moment. [N, N, N.m]
    """
    # tau = B(alpha) F with the full configuration matrix.
    f1, f2, a2, f3, a3 = commands.unbind(-1)
    a2 = torch.deg2rad(a2)
    a3 = torch.deg2rad(a3)
    X2 = f2 * a2.cos()
    Y2 = f2 * a2.sin()
    X3 = f3 * a3.cos()
    Y3 = f3 * a3.sin()
    # Moments: the tunnel at TUNNEL_X, azimuths at AZIMUTH_X and to both sides, N = x Y - y X.
    N = TUNNEL_X * f1 + AZIMUTH_X * (Y2 + Y3) + AZIMUTH_Y * (X2 - X3)
    return torch.stack([X2 + X3, f1 + Y2 + Y3, N], -1)


def losses(
    network: Autoencoder, forces: torch.Tensor, *, k4: float, mean: torch.Tensor, std: torch.Tensor
) -> dict[str, torch.Tensor]:
    """Weighted losses of sequences, eqs. 5 to 11 of the paper.

    Parameters
    ----------
    network : Autoencoder
        The network.
    forces : (sequences, samples, 3) tensor
        Standardised forces. [1]
    k4 : float
        Weight of the power. [1]
    mean, std : (3,) tensors
        By which forces are standardised. [N, N, N.m]

    Returns
    -------
    dict of str to tensor
        Means over all samples. [1]
    """
    # The encoder is the allocator: from force to commands over their ranges.
    code = network.encoder(forces)
    commands = code * _row(RANGES)
    # Force of these commands, standardised as the request.
    given = (generalised_force(commands) - mean) / std
    size = abs(commands)
    # Parts that the losses need: thrusts, angles, and changes from sample to sample.
    thrusts = commands[..., [0, 1, 3]]
    angles = commands[..., [2, 4]]
    changes = abs(commands[:, 1:] - commands[:, :-1])
    # Azimuths within a disallowed sector, counted; this has no gradient.
    inside = (
        torch.stack([(angles > low) & (angles < high) for low, high in SECTORS])
        .to(code.dtype)
        .sum((0, -1))
    )
    # L0 force, L1 decoder, L2 limits, L3 rates, L4 power, L5 sectors: eqs. 5 to 11 of the paper.
    terms = (
        ((forces - given) ** 2).sum(-1),
        ((forces - network.decoder(code)) ** 2).sum(-1),
        torch.relu(size - _row(LIMITS)).sum(-1),
        torch.relu(changes - _row(RATES) * SAMPLE_TIME).sum(-1),
        (abs(thrusts) ** 1.5).sum(-1),
        inside,
    )
    # k4 is the weight that the variants change.
    k = (*K[:4], k4, K[5])
    return {name: weight * term.mean() for name, weight, term in zip(NAMES, k, terms, strict=True)}


def _row(values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(np.asarray(values, dtype=np.float32))


def _about(recipe: PaperVTraining, data: Data) -> dict:
    kind = (
        "random walks, steps uniform within the rates" if recipe.walks else "independent, uniform"
    )
    return {
        "commands": f"{kind}; F1 within 10 kN, F2 and F3 within 5 kN, angles within 180 deg",
        "mini-batches to train on": data.trained,
        "mini-batches held out": recipe.batches - data.trained,
        "a mini-batch": f"{recipe.sequences} sequences of {recipe.samples} samples",
        "SHA-256 of the commands": digest(data.commands),
        "mean of the forces (N, N, N.m)": [float(f"{value:.6g}") for value in data.mean],
        "standard deviation of the forces (N, N, N.m)": [
            float(f"{value:.6g}") for value in data.std
        ],
    }


def _settings(recipe: PaperVTraining) -> dict:
    schedule = recipe.schedule
    return {
        "k0 to k5": [*K[:4], recipe.k4, K[5]],
        "network": "encoder LSTM 64, 64, dense 5; decoder LSTM 64, 64, dense 3",
        "optimiser": f"Adam, learning rate {schedule.learning_rate:g}",
        "patience": schedule.patience,
        "most epochs": schedule.most_epochs,
        "sample time (s)": SAMPLE_TIME,
    }
