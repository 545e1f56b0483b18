"""The nameless rival: a small network learns the acceleration that the ship's model misses, and is worth its gain.

Trained on the rows that the diagnosis' own gain trains on, and judged on the same predictions 60 s ahead.
"""

import numpy as np
import torch

from shipcosim.diagnose.inference.linearisation import linearise
from shipcosim.diagnose.inference.predictions import missing
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.validation.gain import compare, gain
from shipcosim.diagnose.validation.split import in_rows
from shipcosim.models.core.motion import Motion
from trial.tools import system, with_drift

HIDDEN, EPOCHS, PATIENCE = 24, 600, 60
RATE, DECAY = 3e-3, 1e-3
SMOOTH = 21  # rows over which the missing acceleration is averaged for training


def with_network(path):
    """The tool of the set ``drift`` with the network beside, under DP and in the drift: ``network_m`` of its gains."""
    return with_drift(path, missed)


def gains(path):
    """Root mean square position errors after 60 s, of the gain entry with the network beside.

    Parameters
    ----------
    path : path
        Of a log.

    Returns
    -------
    dict or None
        `gain` of the diagnosis and ``network_m``; None where the log is too short for a gain.
    """
    basis = find_causes(path, system()).basis
    comparison = compare(basis.problem, basis.fit)
    if comparison is None:
        return None
    off = missed(basis.problem, comparison)
    return gain(comparison.errors) | {"network_m": float(np.sqrt((off**2).mean()))}


def missed(problem, comparison):
    """Position errors after 60 s of the plain model with a network, on the predictions of a comparison, (s,) array."""
    plain = comparison.predictors["plain"]
    network = trained(problem, plain, comparison.train)
    last = in_rows(plain.record)[-1]
    found = predicted(plain, comparison.rows, network, last)
    return missing(readings(found, plain.model), comparison.seen, comparison.rows + last)[
        "position"
    ]


def features(motion, inputs):
    """State and inputs, (..., m) array."""
    columns = [
        10.0 * motion.u,
        10.0 * motion.v,
        100.0 * motion.r,
        np.cos(motion.psi),
        np.sin(motion.psi),
    ]
    for n, azimuth in inputs.units.values():
        thrust = n * np.abs(n)
        columns += [thrust * np.cos(azimuth), thrust * np.sin(azimuth)]
    if inputs.wind_speed is not None:
        pressure, relative = inputs.wind_speed**2 / 50.0, inputs.wind_from - motion.psi
        columns += [pressure * np.cos(relative), pressure * np.sin(relative)]
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def trained(problem, plain, train):
    """Function from features to accelerations in surge, sway and yaw.

    Parameters
    ----------
    problem : IdentificationProblem
        Prepared.
    plain : Predictor
        Of the model without a cause.
    train : (n,) bool array
        The last fifth of these rows decides when to stop.

    Returns
    -------
    callable
    """
    torch.manual_seed(1)
    step = (
        linearise(problem.motion, problem.record, problem.model, []).driven[:, 3:6, 0]
        / problem.record.step
    )
    kernel = np.ones(SMOOTH) / SMOOTH
    missed = np.stack([np.convolve(-axis, kernel, "same") for axis in step.T], axis=1)
    rows = np.flatnonzero(train[:-1] & problem.record.usable[:-1])
    here = Motion(*(value[:-1] for value in problem.motion))
    inputs, scale = features(here, plain.record.inputs(plain.model))[rows], missed[rows].std(axis=0)
    centre, width = inputs.mean(axis=0), inputs.std(axis=0) + 1e-9
    net = torch.nn.Sequential(
        torch.nn.Linear(inputs.shape[1], HIDDEN), torch.nn.Tanh(), torch.nn.Linear(HIDDEN, HIDDEN), torch.nn.Tanh(),
        torch.nn.Linear(HIDDEN, 3),
    )  # fmt: skip
    x = torch.tensor((inputs - centre) / width, dtype=torch.float32)
    y = torch.tensor(missed[rows] / scale, dtype=torch.float32)
    _fit(net, x, y, round(0.8 * len(rows)))

    def acceleration(given):
        with torch.no_grad():
            return scale * net(torch.tensor((given - centre) / width, dtype=torch.float32)).numpy()

    return acceleration


def _fit(net, x, y, cut):
    """Train on the first rows, keep the weights that are best on the others."""
    optimizer = torch.optim.AdamW(net.parameters(), lr=RATE, weight_decay=DECAY)
    best, kept, waited = np.inf, None, 0
    for _ in range(EPOCHS):
        optimizer.zero_grad()
        torch.nn.functional.mse_loss(net(x[:cut]), y[:cut]).backward()
        optimizer.step()
        with torch.no_grad():
            now = float(torch.nn.functional.mse_loss(net(x[cut:]), y[cut:]))
        waited += 1
        if now < best:
            best, kept, waited = (
                now,
                {name: value.clone() for name, value in net.state_dict().items()},
                0,
            )
        if waited > PATIENCE:
            break
    net.load_state_dict(kept)


def predicted(plain, rows, network, steps):
    """Open loop from some rows on, by the plain model with the network's acceleration; half-step Runge-Kutta.

    Returns
    -------
    Motion
        After so many rows.
    """
    record, model, h = plain.record, plain.model, plain.record.step
    here, half = (record.inputs(model, share) for share in (0.0, 0.5))
    motion = Motion(*(value[rows] for value in plain.motion))
    for k in range(steps):
        first = _rates(motion, _at(here, rows + k), model, network)
        middle = Motion(
            *(value + 0.5 * h * rate for value, rate in zip(motion, first, strict=True))
        )
        second = _rates(middle, _at(half, rows + k), model, network)
        motion = Motion(*(value + h * rate for value, rate in zip(motion, second, strict=True)))
    return motion


def _rates(motion, inputs, model, network):
    rates, extra = motion_rates(motion, inputs, model), network(features(motion, inputs))
    return rates._replace(
        u=rates.u + extra[..., 0], v=rates.v + extra[..., 1], r=rates.r + extra[..., 2]
    )


def _at(inputs, rows):
    units = {name: tuple(series[rows] for series in pair) for name, pair in inputs.units.items()}
    wind = (
        None if series is None else series[rows] for series in (inputs.wind_speed, inputs.wind_from)
    )
    return Inputs(inputs.time[rows], units, *wind)
