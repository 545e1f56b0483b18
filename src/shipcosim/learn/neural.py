"""Our neural allocator: trained through a model of the thrusters, on requests of a controller.

The loss is the cost of the commands over the sequence: power and missed load. Its gradient
passes limits, rates and slipstreams back to the network, which learns effects half a minute later.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import torch

from shipcosim.learn.requests import recorded_requests
from shipcosim.learn.results import Trained, settings_of
from shipcosim.learn.training import BestWeights, Descent, Epochs, Progress, repeatable
from shipcosim.models.allocation import neural, neural_allocator
from shipcosim.models.allocation.neural import Commands, Units

EVERY = 10
"""Steps of the optimiser from one check on held-out sequences to the next."""
HELD_OUT = 6
"""Runs of each kind, the last ones, that only decide which weights are kept."""
PRECISION = torch.float64
"""Of all arithmetic. Thrusts meet a request by a linear system that is nearly singular where units point the same way:
in single precision its solution, and so the cost, depends on the processor's instructions (1.340 or 1.343)."""


@dataclass(frozen=True)
class NeuralTraining:
    """How an allocator is trained.

    Parameters
    ----------
    description : str
        One line for users.
    units : Units
        The thrusters, in vectors of NumPy.
    iterations : int
        Steps of the optimiser.
    seed : int
        Of weights and of what is drawn.
    hidden : tuple of int
        Widths of the layers between inputs and outputs.
    batch, steps, settling : int
        Sequences in a step of the optimiser, requests in a sequence, one a second, and how many of these come before
        the cost.
    learning_rate : float
        Of Adam at the start; it falls as a cosine. [1]
    missed : float
        Price of missing a hundredth of the request, in hundredths of the power that it is worth. [1]
    turning : float
        Price of all units turning at their full rates all the time, in the power that the request is worth. [1]
    """

    description: str
    units: Units
    iterations: int = 160
    seed: int = 1
    hidden: tuple[int, ...] = (48, 48)
    batch: int = 128
    steps: int = 40
    settling: int = 20
    learning_rate: float = 1e-3
    missed: float = 8.0
    turning: float = 0.02


DP_SHIP = {
    "port_x": -14.02,
    "port_y": -2.0,
    "starboard_x": -14.02,
    "starboard_y": 2.0,
    "tunnel_x": 14.48,
    "port_azimuth": -0.7853981633974483,
    "starboard_azimuth": 0.7853981633974483,
    "azimuth_thrust_min": -30e3,
    "azimuth_thrust_max": 60e3,
    "tunnel_thrust_max": 21.6e3,
    "thrust_rate_max": 1000.0,
    "yaw_lever": 14.0,
    "yaw_lever_degraded": 300.0,
}
"""The DP ship, as her files have her; a test holds it."""
POWER = (194e3, 194e3, 200e3)  # W, at the limits of thrust
DIAMETER = 1.9  # m


def _dp_ship(diameter: float) -> Units:
    parameters = neural_allocator.NeuralParameters(**DP_SHIP, azimuth_diameter=diameter)
    return neural_allocator.units_of(parameters, POWER)[0]


def _four_azimuths() -> Units:
    """As ssp/ships/four-azimuths has them."""
    places = zip((-14.02, -14.02, 11.0, 11.0), (-2.0, 2.0, -1.5, 1.5), strict=True)
    each = {"thrust_min": -30e3, "thrust_max": 60e3, "thrust_rate": 1000.0, "thrust_least": 1000.0}
    each |= {"azimuth_rate": math.radians(10.0), "diameter": DIAMETER}
    values = {f"{name}_{k}": value for k in range(1, 5) for name, value in each.items()}
    # Each azimuth may turn away from its neighbour across the centreline.
    for k, (x, y) in enumerate(places, 1):
        middle = math.copysign(0.5 * math.pi, -y)
        # The forbidden sector is as wide as its slipstream there: the half angle leaves it out.
        half = math.pi - math.atan(0.1 + DIAMETER / (2.0 * abs(y)))
        values |= {
            f"x_{k}": x,
            f"y_{k}": y,
            f"azimuth_first_{k}": middle - half,
            f"azimuth_last_{k}": middle + half,
        }
    parameters = neural_allocator.NeuralUnitsParameters(**values, yaw_lever=14.0)
    return neural_allocator.units_of(parameters, (POWER[0],) * 6)[0]


RECIPES = {
    "neural": NeuralTraining(
        "Our neural allocator of the DP ship, within the forbidden sectors of paper V",
        _dp_ship(0.0),
    ),
    "neural-slipstreams": NeuralTraining(
        "Our neural allocator of the DP ship, which knows slipstreams instead of sectors",
        _dp_ship(DIAMETER),
    ),
    "neural-four-azimuths": NeuralTraining(
        "Our neural allocator of the system four_azimuths, which knows slipstreams",
        _four_azimuths(),
    ),
}
"""Allocators by the name that `shipcosim train allocator --kind NAME` takes."""


def train(recipe: NeuralTraining, progress: Progress) -> Trained:
    """Train an allocator from scratch.

    Parameters
    ----------
    recipe : NeuralTraining
        How.
    progress : callable
        Is told how many steps are done, and of how many.

    Returns
    -------
    Trained
        Weights and report.
    """
    # Train with a fixed seed: the same weights every time on one processor.
    with repeatable(recipe.seed):
        weights, history = fit(recipe, progress)
    # Weights under the names that the allocator reads.
    arrays = {}
    for number, (matrix, offset) in enumerate(paired(weights), 1):
        arrays |= {f"{number}.weights": matrix, f"{number}.bias": offset}
    # The report says which recorded requests were used.
    runs, seeds, interval = recorded_requests()
    data = {
        "requests": "of the DP controller in weather of all kinds, docs/generators/write_requests.py",
        "runs": sum(len(kind) for kind in runs),
        "of these to choose the weights by, the last of each kind": HELD_OUT * len(runs),
        "seeds": f"{seeds.min()} to {seeds.max()}",
        "interval of the requests [s]": interval,
        "interval in training [s]": 2 * interval,
        "drawn for each sequence": "scale 0.5 to 2, mirrored or not, units missing, power short, angles at the start",
    }
    names = (
        "iterations",
        "hidden",
        "batch",
        "steps",
        "settling",
        "learning_rate",
        "missed",
        "turning",
    )
    settings = settings_of(recipe, names, "Adam, cosine schedule")
    return Trained(arrays, recipe.description, recipe.seed, data, settings, history)


def tensors(units: Units) -> Units:
    """The units in tensors of the precision of training."""
    found = {name: getattr(units, name) for name in Units._fields}
    vectors = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
    return units._replace(
        **{name: torch.tensor(value, dtype=PRECISION) for name, value in vectors.items()}
    )


def first_weights(recipe: NeuralTraining) -> list[torch.Tensor]:
    """Initial weights: small in the last layer, so that thrusters first stay where they are."""
    # Eight inputs, five more for each thruster; outputs are thrust and angle of each.
    n = len(recipe.units.x)
    sizes = (8 + 5 * n, *recipe.hidden, 2 * n)
    found = []
    for number, (k, m) in enumerate(zip(sizes[:-1], sizes[1:], strict=True), 1):
        # Weights of variance 1/k keep the signal's size from layer to layer.
        gain = 0.02 if number == len(sizes) - 1 else 1.0
        found += [
            gain * torch.randn(k, m).to(PRECISION) / math.sqrt(k),
            torch.zeros(m, dtype=PRECISION),
        ]
    return [weight.requires_grad_() for weight in found]


def paired(weights: list) -> tuple:
    """Matrix and offsets of each layer."""
    return tuple(zip(weights[::2], weights[1::2], strict=True))


def smoothed(runs: np.ndarray, interval: float) -> np.ndarray:
    """Requests with the same smoothing as in the allocator, over whole runs."""
    # First-order low-pass: share = 1 - exp(-h/T).
    found = np.empty_like(runs)
    share = 1.0 - math.exp(-interval / neural.SMOOTHING)
    found[:, 0] = runs[:, 0]
    for k in range(1, runs.shape[1]):
        found[:, k] = found[:, k - 1] + share * (runs[:, k] - found[:, k - 1])
    return found


class Sequences:
    """Sequences of requests with the state before each, drawn at random."""

    def __init__(self, recipe: NeuralTraining, held_out: bool):
        runs, _, self.interval = recorded_requests(every=2)
        part = slice(-HELD_OUT, None) if held_out else slice(None, -HELD_OUT)
        self.runs = [(kind[part], smoothed(kind[part], self.interval)) for kind in runs]
        self.recipe = recipe
        self.units = tensors(recipe.units)
        self.random = np.random.default_rng(recipe.seed + (1000 if held_out else 0))

    def draw(self) -> tuple[torch.Tensor, torch.Tensor, Commands]:
        """Requests (steps, batch, 3), availability (batch, n) and the state before."""
        # A random part of a random run for each sequence.
        r = self.random
        size = self.recipe.batch
        steps = self.recipe.steps
        rows = [self._row(*self.runs[r.integers(len(self.runs))], steps) for _ in range(size)]
        # Scale by e^-0.7 to e^0.7, and mirror half of the sequences (sway and yaw change sign).
        scale = np.exp(r.uniform(-0.7, 0.7, (size, 1, 1)))
        scale = scale * np.where(r.random((size, 1, 1)) < 0.5, [1.0, -1.0, -1.0], 1.0)
        # Time first, as the cost steps through the requests.
        tau = (
            torch.from_numpy(np.array([tau for tau, _ in rows]) * scale)
            .transpose(0, 1)
            .contiguous()
        )
        smooth = torch.from_numpy(np.array([smooth for _, smooth in rows]) * scale[:, 0])
        # Missing thrusters and a state before the first request.
        available = torch.from_numpy(self._availability(size))
        return tau, available, self._before(tau[0], smooth, available)

    def _row(self, tau, smooth, steps):
        run = self.random.integers(len(tau))
        start = self.random.integers(tau.shape[1] - steps)
        return tau[run, start : start + steps], smooth[run, start]

    def _availability(self, size):
        """All units in half of the sequences; else one is missing, in a tenth two; in a fifth less power for all."""
        r = self.random
        # Start with all thrusters available.
        n = len(self.recipe.units.x)
        found = np.ones((size, n))
        rows = np.arange(size)
        lost = r.integers(n, size=(2, size))
        # In half of the sequences one is missing, in a tenth (drawn independently) another one.
        found[rows, lost[0]] = np.where(r.random(size) < 0.5, 0.0, 1.0)
        found[rows, lost[1]] *= np.where(r.random(size) < 0.1, 0.0, 1.0)
        # In a fifth all have 30 to 100 % of their power.
        less = np.where(r.random(size) < 0.2, r.uniform(0.3, 1.0, size), 1.0)
        return found * less[:, None]

    def _before(self, tau, smooth, available):
        """Units at random angles, with thrusts that meet the first request as well as these angles allow."""
        units = self.units
        r = self.random
        # Draw angles within the allowed sector; thrusters with a fixed angle keep it.
        first = torch.clamp(units.first, min=-np.pi)
        last = torch.clamp(units.last, max=np.pi)
        last = torch.where(torch.isfinite(units.last), units.last, last)
        drawn = torch.from_numpy(r.random((len(tau), len(units.x))))
        angles = first + drawn * (last - first)
        angles = torch.where(units.turn > 0.0, angles, units.azimuth)
        # Limits of thrust shrink with availability.
        least = units.least * available
        most = units.most * available
        # Start from little thrust and iterate: effects depend on thrusts through the slipstreams.
        thrusts = torch.clamp(0.05 * most, min=least)
        for _ in range(4):
            effect = neural.effects(thrusts, angles, units=units)
            thrusts, _ = neural.completed(
                thrusts, tau, effect, least, most, torch.ones_like(thrusts), units=units
            )
        return Commands(thrusts, angles, smooth)


def cost(
    recipe: NeuralTraining, units: Units, weights: tuple, drawn: tuple, interval: float
) -> dict[str, torch.Tensor]:
    """Cost of sequences: power, missed load and turning, each over the power for their requests.

    The first requests only settle the thrusters. The objective is the mean logarithm of the sum:
    one percent less counts the same in each sequence.
    """
    # Settle without gradient: the drawn start must not count.
    tau, available, state = drawn
    with torch.no_grad():
        for request in tau[: recipe.settling]:
            state = neural.propose(
                state, request, available, interval, units=units, weights=weights
            )
    # Size of the requests, and the power to give them with the strongest thruster, P ~ T^1.5.
    tau = tau[recipe.settling :]
    size = (neural._scaled(tau, units.lever) ** 2).sum(-1).mean(0).sqrt() + 1e-3 * units.most.max()
    worth = units.full_power.max() * (size / units.most.max()) ** 1.5
    spent, missed, turned = torch.zeros(3, tau.shape[1], dtype=tau.dtype)
    # Step through the requests: each command depends on the one before.
    for request in tau:
        before = state
        state = neural.propose(state, request, available, interval, units=units, weights=weights)
        # Missed load relative to the request; 1e-5 keeps its gradient finite at zero.
        left = missing(state, request, units) / size[:, None]
        spent = spent + neural.power(state.thrusts, units=units) / worth
        missed = missed + torch.sqrt((left * left).sum(-1) + 1e-5)
        # Turning as the square of the share of the full rate; fixed thrusters do not count.
        turn = (state.azimuths - before.azimuths) / (units.turn + 1e-6) / interval
        turned = turned + (turn * turn * (units.turn > 0.0)).mean(-1)
    # Means over the sequence, with their prices.
    parts = [
        spent / len(tau),
        recipe.missed * missed / len(tau),
        recipe.turning * turned / len(tau),
    ]
    means = {
        name: part.mean()
        for name, part in zip(("power", "missed load", "turning"), parts, strict=True)
    }
    # The logarithm makes a percent count the same in weak and in strong sequences.
    return {"objective": torch.log(torch.stack(parts).sum(0)).mean()} | means


def missing(state: Commands, request: torch.Tensor, units: Units) -> torch.Tensor:
    """Load that commands leave unmet, slipstreams included, the moment over the lever. [N]"""
    effect = neural.effects(state.thrusts, state.azimuths, units=units)
    return neural._scaled(request, units.lever) - (effect @ state.thrusts[..., None])[..., 0]


def fit(recipe: NeuralTraining, progress: Progress) -> tuple[list[np.ndarray], Epochs]:
    """Fit the weights; return those with the least held-out cost, and the costs by iteration."""
    weights = first_weights(recipe)
    units = tensors(recipe.units)
    # Training sequences are drawn anew at each step; the held-out ones are drawn once.
    training = Sequences(recipe, held_out=False)
    checked = Sequences(replace(recipe, batch=256), held_out=True)
    test = checked.draw()
    # Adam with a learning rate that falls as a cosine; the gradient is clipped, since it passes many requests.
    adam = torch.optim.Adam(weights, lr=recipe.learning_rate)
    descent = Descent(adam, recipe.iterations, 1e-4, clipped=True)
    best = BestWeights(weights)
    history = []
    for number in range(recipe.iterations + 1):
        # Check on the held-out sequences now and then, and keep the best weights.
        if number % EVERY == 0 or number == recipe.iterations:
            with torch.no_grad():
                found = cost(recipe, units, paired(weights), test, checked.interval)
            history.append(
                {"iteration": number} | {name: float(value) for name, value in found.items()}
            )
            best.judge(history[-1]["objective"])
        if number < recipe.iterations:
            parts = cost(recipe, units, paired(weights), training.draw(), training.interval)
            descent.step(parts["objective"])
            progress(number + 1, recipe.iterations)
    return [one.numpy().astype(float) for one in best.kept], history
