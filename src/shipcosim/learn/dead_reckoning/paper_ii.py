"""The networks of paper II: velocity from wind and thrusters.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper II.
"""

from dataclasses import dataclass

import numpy as np
import torch

from shipcosim.learn.dead_reckoning.motion_filter import measured_at
from shipcosim.learn.dead_reckoning.worlds import Record
from shipcosim.learn.networks import Arrays, Recurrent, arrays_of
from shipcosim.learn.training import Progress, Schedule, fit, repeatable
from shipcosim.models.prediction import velocity_network as law

FULL_POWER = np.array([1.2e6, 0.9e6, 3.0e6])
FULL_COMMAND = np.array([204.0, 276.0, 28.7])
"""Full power and command of bow tunnel, stern tunnel, main propeller. [W, rpm, rpm, deg] As ssp/ships/osv has them; a
test holds it."""
INPUTS = {
    "surge": ("wind angle", "wind speed", "main power", "main action"),
    "sway": ("wind angle", "wind speed", "bow power", "stern power"),
}
"""What the paper keeps, of Table III above 0.4."""
BATCH = 64
HELD_OUT = 0.1


@dataclass(frozen=True)
class PaperIITraining:
    """One kind of networks.

    Parameters
    ----------
    description : str
        One line for users.
    recurrent : bool
        LSTM, else one layer of sigmoids.
    width, learning_rate : tuple of a number for surge and one for sway
        Units, and of Adam. [1]
    seed, patience, most_epochs : int
        As `Schedule`. [1]
    """

    description: str
    recurrent: bool = True
    width: tuple[int, int] = (43, 26)
    learning_rate: tuple[float, float] = (0.0070, 0.0165)
    seed: int = 1
    patience: int = 8
    most_epochs: int = 60


RECIPES = {
    "paper-ii": PaperIITraining(
        "Dead reckoning of paper II: LSTM of 43 units for surge and 26 for sway"
    ),
    "paper-ii-single-layer": PaperIITraining(
        "Dead reckoning of paper II with a single layer of 55 sigmoids for surge and 93 for sway",
        recurrent=False,
        width=(55, 93),
        learning_rate=(0.005, 0.005),
    ),
}
NOTES = (
    "The paper does not print the points of this list, so they are chosen here. Adam has mini-batches of 64 samples."
    " Early stopping looks at the tenth of the samples that the paper validates with: the last of each world. The LSTM"
    " sees the ten samples one after the other, from an empty memory. The learning rates of the single layer are"
    " chosen, and how power follows from the command.",
    "Widths and learning rates of the LSTM are those that the paper's search found. The search is not repeated.",
)


class SingleLayer(torch.nn.Module):
    """A hidden layer of sigmoids over all samples of all inputs."""

    def __init__(self, inputs: int, width: int):
        super().__init__()
        self.hidden = torch.nn.Linear(inputs * law.HISTORY, width)
        self.dense = torch.nn.Linear(width, 1)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Standardised velocity (n, 1, 1) of histories (n, samples, inputs)."""
        return self.dense(torch.sigmoid(self.hidden(x.flatten(1))))[:, None]


def features_of(record: Record) -> np.ndarray:
    """Inputs that the paper considers, over records.

    Parameters
    ----------
    record : Record
        Of (worlds, n) arrays.

    Returns
    -------
    (worlds, n, 9) array
        By `velocity_network.FEATURES`.
    """
    samples = [measured_at(record, k, record.measured["valid"]) for k in range(record.x.shape[1])]
    # One sample at a time, as the predictor computes its features aboard.
    return np.stack([law.features(sample, FULL_POWER, FULL_COMMAND) for sample in samples], axis=1)


def trained(
    recipe: PaperIITraining, record: Record, progress: Progress
) -> tuple[Arrays, list[dict]]:
    """Networks of both velocities, trained from scratch.

    Parameters
    ----------
    recipe : PaperIITraining
        How.
    record : Record
        Of (worlds, n) arrays, with GNSS.
    progress : callable
        Called with how many mini-batches are done, and of how many at most.

    Returns
    -------
    tuple of dict of str to array, and list of dict
        Weights as `velocity_network.design` reads them; losses by epoch, of surge and then of sway.
    """
    # Train surge and sway one after the other; each uses the inputs that paper II selects.
    features = features_of(record)
    networks = {"full_power": FULL_POWER, "full_command": FULL_COMMAND}
    epochs = []
    for number, (axis, name) in enumerate((("surge", "u"), ("sway", "v"))):
        velocity = record.measured[name]

        def progress_of(done: int, total: int, number: int = number) -> None:
            progress(number * total + done, 2 * total)

        arrays, losses = _trained_axis(
            recipe, number, features, velocity, INPUTS[axis], progress_of
        )
        networks |= {f"{axis}.{key}": array for key, array in arrays.items()}
        epochs += [{"network": number + 1} | loss for loss in losses]
    return networks, epochs


def _trained_axis(recipe, number, features, velocity, names, progress):
    """Network of one velocity: its arrays by name, and its losses."""
    # Standardise inputs and velocity; the scales are stored with the weights.
    inputs = np.array([law.FEATURES.index(name) for name in names])
    mean = features[..., inputs].mean((0, 1))
    std = features[..., inputs].std((0, 1))
    scale = float(velocity.mean()), float(velocity.std())
    # Each sample sees the HISTORY samples before it; the velocity is the one after them.
    x = np.lib.stride_tricks.sliding_window_view(
        (features[..., inputs] - mean) / std, law.HISTORY, axis=1
    )
    x = x[:, :-1].swapaxes(2, 3)
    y = ((velocity - scale[0]) / scale[1])[:, law.HISTORY :]
    # Hold out the last tenth of each world, in time order: neighbours must not leak into training.
    kept = round((1.0 - HELD_OUT) * y.shape[1])
    rng = np.random.default_rng(recipe.seed)
    batches = _batches(x[:, :kept], y[:, :kept], rng)
    held_out = _batches(x[:, kept:], y[:, kept:], rng)
    width = recipe.width[number]
    rate = recipe.learning_rate[number]
    # Train on the squared error of the velocity after the last sample.
    with repeatable(recipe.seed):
        network = (
            Recurrent(len(names), width, 1, 1)
            if recipe.recurrent
            else SingleLayer(len(names), width)
        )
        schedule = Schedule(recipe.seed, rate, recipe.patience, recipe.most_epochs)

        def losses(batch):
            return {"squared error": ((network(batch[0])[:, -1, 0] - batch[1]) ** 2).mean()}

        epochs = fit(network, losses, batches, held_out, schedule, progress)
    # Weights together with the scales, as the predictor needs them.
    plain = {"inputs": inputs, "mean": mean, "std": std}
    plain |= {"velocity_mean": np.array(scale[0]), "velocity_std": np.array(scale[1])}
    return plain | _weights(network), epochs


def _batches(x, y, rng):
    """Mini-batches in random order."""
    # One long list of samples over all worlds, then shuffled.
    x = x.reshape(-1, *x.shape[2:])
    y = y.reshape(-1)
    order = rng.permutation(len(y))
    parts = np.array_split(order, max(1, len(y) // BATCH))
    return [
        (torch.from_numpy(x[part]).float(), torch.from_numpy(y[part]).float()) for part in parts
    ]


def _weights(network):
    if isinstance(network, Recurrent):
        return {
            name.removeprefix("net."): array for name, array in arrays_of(network, "net").items()
        }
    # Weights of the single layer, under the names that the predictor reads.
    layers = {"hidden": network.hidden, "dense": network.dense}
    return {
        f"{name}.{key}": getattr(layer, kind).detach().numpy().copy()
        for name, layer in layers.items()
        for key, kind in (("weights", "weight"), ("bias", "bias"))
    }
