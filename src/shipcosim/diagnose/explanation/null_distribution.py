"""Null distribution of causes' gains: what they gain on healthy logs, simulated on the log's track under a DP.

Each of the healthy ships differs from the modelled one within its tolerances and has noise as in the log. Feedback
moves thrusters and weather together, and a ship that keeps still moves by its noise alone: both can look like a cause,
and here nothing is wrong that could be one.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.fitting import IdentificationProblem, prepared
from shipcosim.diagnose.inference.innovations import inner_products
from shipcosim.diagnose.inference.linearisation import SLOW_STD, SLOW_TIME, Regressor
from shipcosim.diagnose.inference.noise import waves_of
from shipcosim.diagnose.inference.screening import gains
from shipcosim.diagnose.inference.thresholds import LOST_TRACK
from shipcosim.diagnose.inference.workers import each
from shipcosim.diagnose.ship.inputs import Record, first_motion, part_of
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.track_keeping import DpController, kept_on_track
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.motion import Motion

DAMPING = ("X_u", "Y_v", "N_r", "X_uu", "Y_modvv", "N_modrr")
"""Numbers of a hull by which the water takes energy out: zero or negative."""
HEALTHY_LOGS = 50
"""Healthy logs that are simulated. Assumed."""
_AT_ONCE = 5  # healthy logs that are filtered together, to bound memory


def null_gains(
    problem: IdentificationProblem,
    motion: Motion,
    wanted: Sequence[Hypothesis],
    *,
    count: int = HEALTHY_LOGS,
) -> dict[str, np.ndarray]:
    """Gain of hypotheses on simulated healthy logs like this one.

    Parameters
    ----------
    problem : IdentificationProblem
    motion : Motion
        The log's track.
    wanted : sequence of Hypothesis
        Those that are asked for.
    count : int
        Number of healthy ships.

    Returns
    -------
    dict of str to (m,) array
        By the hypothesis's label. [nats] Ships that lose the track say nothing and are left out.
    """
    columns, products = healthy_products(problem, motion, wanted, count=count)
    return gains_of_each(products[on_track(products)], columns, wanted, problem.model.get)


def gains_of_each(
    products: np.ndarray,
    columns: Sequence[Regressor],
    wanted: Sequence[Hypothesis],
    value_of: Callable[[str], float],
) -> dict[str, np.ndarray]:
    """Gain of hypotheses on each of several logs, (m, 1 + p, 1 + p) products: by label, (m,) arrays. [nats]"""
    centre = np.zeros(len(columns))
    by_label = {hypothesis.label: [] for hypothesis in wanted}
    for product in products:
        for gain, hypothesis, _ in gains(product, columns, centre, wanted, value_of):
            by_label[hypothesis.label].append(gain)
    return {label: np.array(values) for label, values in by_label.items()}


def healthy_products(
    problem: IdentificationProblem,
    motion: Motion,
    wanted: Sequence[Hypothesis],
    *,
    count: int = HEALTHY_LOGS,
) -> tuple[list[Regressor], np.ndarray]:
    """Inner products of simulated healthy logs like this one, arguments as of `null_gains`.

    Returns
    -------
    tuple of list of Regressor, (count, 1 + p, 1 + p) array
        The known numbers; the log, these, and the screening regressors of each wanted hypothesis in turn.
    """
    # Simulate all ships at once, then filter them in batches to bound memory.
    records = healthy_records(problem, motion, count, np.random.default_rng(0))
    problem = replace(problem, hypotheses=tuple(wanted), known_of=problem.hypotheses)

    def products_of(first):
        # Each healthy log is linearised about its own smoothed motion.
        some = slice(first, first + _AT_ONCE)
        units = part_of(records.units, some)
        record = replace(records, measured=records.measured[some], units=units)
        here = prepared(replace(problem, record=record, motion=first_motion(record)), rounds=1)
        return inner_products(here.linear, problem.noise, record).products

    return problem.ship_columns(()), np.concatenate(each(products_of, range(0, count, _AT_ONCE)))


def on_track(products: np.ndarray) -> np.ndarray:
    """Which of simulated ships keep to the track, (m,) bool array: the others' innovations are far larger."""
    squares = products[:, 0, 0]
    return squares < LOST_TRACK * np.median(squares)


def healthy_records(
    problem: IdentificationProblem, motion: Motion, count: int, rng: np.random.Generator
) -> Record:
    """Logs of healthy ships that keep to a track in the log's weather.

    Parameters
    ----------
    problem : IdentificationProblem
    motion : Motion
        The track, (n,) arrays.
    count : int
        Number of ships m.
    rng : numpy.random.Generator

    Returns
    -------
    Record
        With the ships on the first axis.
    """
    # Healthy ships differ within tolerances, and are driven by the log's random accelerations.
    model = drawn_within_tolerances(problem.model, (count,), rng)
    record = problem.record
    noise = problem.noise
    jolts = (
        rng.standard_normal((record.time.size, 3, count))
        * (np.asarray(noise.jolt) * np.sqrt(record.step))[:, None]
    )
    # A DP controller keeps each ship on the logged track.
    ships, units = kept_on_track(
        model, count, motion, record, DpController(problem.model, record.step), jolts=jolts
    )
    return _logged(ships, units, problem, rng)


def drawn_within_tolerances(
    model: ShipModel, shape: tuple[int, ...], rng: np.random.Generator
) -> ShipModel:
    """Ships within the tolerances of a ship model, whose numbers are arrays of a shape."""
    # Listed uncertainties, less those that a reference covers by its directions.
    tolerances = {
        path: size for path, size in model.uncertainties.items() if path not in model.referenced
    }
    directions = [
        *model.directions,
        *({path: size} for path, size in tolerances.items() if not model.is_of_day(path)),
    ]
    values = {}
    # One standard normal draw for each direction, which may move several numbers at once.
    for direction in directions:
        share = rng.standard_normal(shape)
        for path, size in direction.items():
            values[path] = values.get(path, model.get(path)) + size * share
    # A wide tolerance reaches beyond zero, but no ship is driven by her damping.
    for path, drawn in values.items():
        if path.rpartition(".")[2] in DAMPING:
            values[path] = np.minimum(drawn, 0.0)
    return model.with_values(values)


def _logged(motion, units, problem, rng):
    """The log of the ships' motion, with the noise of the log: white, of waves, and slow in position and heading."""
    record = problem.record
    (count, n) = motion.x.shape
    # What ideal instruments show of each ship, then the noise of the log.
    measured = np.stack(
        [value.T for value in readings(motion, problem.model)], axis=-1
    )  # (n, m, 6)
    measured += rng.standard_normal(measured.shape) * np.asarray(problem.noise.white)
    measured += _shown_waves(waves_of(problem.noise, record.step, (n, count), rng), motion.psi.T)
    # Slow errors of position and heading: stationary first-order Gauss-Markov process.
    keep = np.exp(-record.step / SLOW_TIME)
    slow = SLOW_STD * rng.standard_normal((count, 3))
    for k in range(n):
        measured[k, :, :3] += slow
        slow = keep * slow + np.sqrt(1.0 - keep**2) * SLOW_STD * rng.standard_normal((count, 3))
    # The same gaps as in the log.
    measured = np.where(np.isfinite(record.measured)[:, None, :], measured, np.nan)
    return Record(
        record.time,
        np.moveaxis(measured, 1, 0),
        units,
        record.wind,
        record.usable,
        rate=record.rate,
    )


def _shown_waves(waves, psi):
    """Waves' place and velocity in the ship's axes as the channels show them, all (n, m, 6)."""
    # Turn the place from the ship's axes to north and east.
    x, y, *others = np.moveaxis(waves, -1, 0)
    return np.stack([*to_ned(psi, x, y), *others], axis=-1)
