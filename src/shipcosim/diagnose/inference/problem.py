"""The identification problem of a repaired log: which causes it could show, and how noisy it is."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from operator import itemgetter

import numpy as np
import xarray

from shipcosim.diagnose.hypotheses.catalogue import Cause, Hypothesis, hypotheses_of, parameters_of
from shipcosim.diagnose.inference.channel_noise import most_white
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem, fitted, prepared
from shipcosim.diagnose.inference.innovations import Noise, inner_products
from shipcosim.diagnose.inference.linearisation import Linear
from shipcosim.diagnose.inference.noise import first_noise, tuned
from shipcosim.diagnose.inference.parts import explained
from shipcosim.diagnose.inference.screening import screened
from shipcosim.diagnose.inference.thresholds import (
    GUST_FACTOR,
    LEAST_JOLT,
    LEAST_WHITE,
    LEFT_BY_ROWS,
    LENGTHS_PER_GYRADIUS,
    MOST_WALK,
    TUNED_BESIDE,
)
from shipcosim.diagnose.numerics import noise_by_differences, normal_size
from shipcosim.diagnose.ship.inputs import Record, first_motion, rate_of, record_of
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.surrogate_building import with_surrogates


def identification_problem(
    repaired: xarray.Dataset, ship: ShipModel, causes: dict[str, Cause], noise: Noise | None = None
) -> IdentificationProblem:
    """The identification problem of a repaired log.

    Parameters
    ----------
    repaired : xarray.Dataset
    ship : ShipModel
    causes : dict of str to Cause
    noise : Noise, optional
        Where it is known already; else it is tuned beside the cause that explains most at first sight.

    Returns
    -------
    IdentificationProblem
    """
    # The ship as this log needs it, with third-party thrusters replaced by their surrogates.
    ship = as_logged(ship, repaired)
    record = record_of(repaired, ship)
    motion = first_motion(record)
    ship = with_surrogates(ship, record, motion)
    # Hypotheses that the channels of the log cannot show are left out.
    everyone = hypotheses_of(causes, ship)
    hidden = unidentifiable(everyone, record, repaired, ship.third_party)
    if record.wind is None:
        # Tolerances of what stands for the wind, where it is unknown: the typical size of causes allowed for.
        allowed = [
            hypothesis
            for hypothesis in everyone
            if hypothesis.definition.without_wind == "allowed for"
        ]
        unknown_wind = {
            path: parameter.typical
            for parameter in parameters_of(allowed)
            for path in parameter.paths
        }
        ship = replace(ship, tolerances=ship.tolerances | unknown_wind)
    wanted = tuple(hypothesis for hypothesis in everyone if hypothesis not in hidden)
    # Noise and linear problem depend on each other: prepare with first noise, tune it, prepare
    # again.
    start = first_noise(record, ship.length) if noise is None else noise
    problem = prepared(IdentificationProblem(record, ship, wanted, start, motion))
    if noise is not None:
        return problem
    return prepared(replace(problem, noise=likeliest_noise(problem)))


def as_logged(ship: ShipModel, repaired: xarray.Dataset) -> ShipModel:
    """The ship with the log's time span, its kind of wind, and thrusters fixed where it has no direction of them."""
    return replace(
        ship,
        span=(float(repaired["time"][0]), float(repaired["time"][-1])),
        wind_is_true="wind_speed" not in repaired and "true_wind_speed" in repaired,
        fixed={
            name: angle for name, angle in ship.fixed.items() if f"{name}_azimuth" not in repaired
        },
    )


def unidentifiable(
    everyone: Sequence[Hypothesis],
    record: Record,
    repaired: xarray.Dataset,
    third_party: Collection[str] = (),
) -> list[Hypothesis]:
    """Hypotheses that a log without some channels cannot show: of wind and what acts like it, of unlogged thrusters.

    Parameters
    ----------
    everyone : sequence of Hypothesis
    record : Record
    repaired : xarray.Dataset
    third_party : collection of str
        Thrusters that the log is sure to have, whatever drives them.
    """
    # A thruster without logged speed has no input to test.
    silent = [
        name for name in record.units if f"{name}_rpm" not in repaired and name not in third_party
    ]
    return [
        s
        for s in everyone
        if s.component in silent or (record.wind is None and s.definition.without_wind != "sought")
    ]


def likeliest_noise(problem: IdentificationProblem) -> Noise:
    """Noise of maximum likelihood beside the cause that explains most at first sight, or beside none if that is likelier.

    Noise that was tuned without a large cause would absorb its effect. But beside noise that is yet too small a cause
    may only look large: on a run in waves a scale of the velocity, which makes each jolt look larger.
    """
    tried = []
    for fit in dict.fromkeys([fitted(problem), beside_likeliest(problem)]):
        # What a fit leaves is linearised once, to tune the noise and to weigh it.
        left = explained(fit.linear, fit.left).whole()
        noise = _tuned(problem, left)
        tried.append((float(inner_products(left, noise, problem.record).free), noise))
    return max(tried, key=itemgetter(0))[1]


def tuned_noise(problem: IdentificationProblem, fit: Fit) -> Noise:
    """Noise of maximum likelihood beside a fit."""
    return _tuned(problem, explained(fit.linear, fit.left).whole())


def _tuned(problem: IdentificationProblem, left: Linear) -> Noise:
    """Noise under which what is left of a log is likeliest."""
    # Bounds on random walk and channel noise stop the noise from explaining what a cause should.
    axes = np.array([1.0, 1.0, LENGTHS_PER_GYRADIUS / problem.model.length])
    most = MOST_WALK * axes
    most *= 1.0 if problem.record.wind is not None else GUST_FACTOR
    white = np.maximum(most_white(problem.record), problem.noise.white)
    return tuned(
        problem.noise,
        left,
        problem.record,
        most_walk=most,
        most_white=white,
        least_white=LEAST_WHITE,
        least_jolt=np.maximum(LEAST_JOLT * axes, _left_by_rows(problem.record)),
    )


def _left_by_rows(record: Record) -> np.ndarray:
    """White acceleration that the averages over rows leave of a run without instruments, (3,); 0 of any other log.

    Its velocities have no noise in which that would not show.
    """
    velocities = record.measured[..., 3:]
    if np.isnan(velocities).all(axis=-2).any():
        return np.zeros(3)
    noise = normal_size(noise_by_differences(velocities, 3, axis=-2), axis=-2)
    if not np.all(noise < LEAST_WHITE[3:]):
        return np.zeros(3)
    motion = first_motion(record)
    return LEFT_BY_ROWS * np.array(
        [np.abs(rate_of(speed, record)).max() for speed in (motion.u, motion.v, motion.r)]
    )


def beside_likeliest(problem: IdentificationProblem) -> Fit:
    """The fit with the cause that explains most at first sight, if it does so beyond chance."""
    fit = fitted(problem)
    # Noise tuned without it would absorb the effect of a large cause.
    gain, hypothesis, values = screened(problem, fit)[0]
    return fitted(problem, (hypothesis,), values) if gain > TUNED_BESIDE else fit
