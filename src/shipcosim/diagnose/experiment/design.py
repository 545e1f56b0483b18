"""Experiment design: every manoeuvre of the library is simulated in array form, and scored by what it separates.

The score of a manoeuvre is one for DP and for sea trials: the log-evidence by which the right one of two sets of causes
is expected to lead, half of the squared Mahalanobis distance between what they predict. `prescribed` chooses by it. The
manoeuvres are two libraries: tracks under DP here, orders to a ship under way in `sea_trials.manoeuvres`.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from shipcosim.diagnose.experiment.manoeuvres import (
    Manoeuvre,
    cannot_turn,
    library,
    planned,
    rows_of,
    sized,
    step_for,
    true_wind,
)
from shipcosim.diagnose.hypotheses.catalogue import paths_of
from shipcosim.diagnose.inference.fitting import Fit, IdentificationProblem
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import linearise, moved, rows_first
from shipcosim.diagnose.inference.parts import beside
from shipcosim.diagnose.ship.dynamics import with_steady_current
from shipcosim.diagnose.ship.inputs import part_of
from shipcosim.diagnose.ship.measured_motion import at_rows, readings
from shipcosim.diagnose.ship.model import ShipModel
from shipcosim.diagnose.ship.track_keeping import DpController, kept_on_track
from shipcosim.models.core.motion import Motion

CLEAR = 10.0
"""Expected difference in log-evidence that separates two causes. [nats]

A difference expected to be d varies with a standard deviation of sqrt(2 d): at 10 nats the right cause ends more than
3 nats ahead, the distance at which causes are separated, in 94 of 100 logs, and more than 3 behind in 1 of 500.
"""
MOST_SETS = 4
"""Sets of causes that are compared. [1]"""
_ABOUT = 1.5  # times the shortest: about as short
_ASTRAY = 0.5  # lengths that a ship may be off her track
_ROOM = 3.0  # lengths that a ship may get away from where she started


@dataclass(frozen=True)
class ExperimentDesign:
    """A manoeuvre that separates causes that the log could not separate."""

    manoeuvre: str
    minutes: float
    separates: tuple[tuple[str, str], ...]


class TellingFeature(NamedTuple):
    """The feature of a manoeuvre that tells two sets apart best.

    Attributes
    ----------
    name : str
        With the side that it is sailed to.
    difference : float
        By the second set less by the first, in `unit`.
    spread : float
        Standard deviation with which it is predicted and repeats, in `unit`.
    unit : str
        ``"%"`` or ``"deg"``.
    """

    name: str
    difference: float
    spread: float
    unit: str


@dataclass(frozen=True)
class Separation:
    """Evidence on sets of causes that a manoeuvre would give.

    Attributes
    ----------
    manoeuvre : str
    minutes : float
        Of a sea trial to both sides, with their approaches.
    nats : dict of (int, int) to float
        By places of two sets: log-evidence by which the right one is expected to lead; NaN where the ship does not get
        through. [nats]
    read : bool
        Whether manoeuvres of this kind are sought in logs.
    telling : dict of (int, int) to TellingFeature
        Of a sea trial.
    """

    manoeuvre: str
    minutes: float
    nats: dict[tuple[int, int], float]
    read: bool = True
    telling: dict[tuple[int, int], TellingFeature] = field(default_factory=dict)

    @property
    def least(self) -> float:
        """Evidence between the closest pair. [nats]"""
        return min(self.nats.values())

    def clear(self, wanted: Collection[tuple[int, int]]) -> dict[tuple[int, int], float]:
        """Pairs that it separates clearly, with their nats."""
        return {pair: nats for pair, nats in self.nats.items() if pair in wanted and nats >= CLEAR}


def prescribed(
    separations: Sequence[Separation], sets: Sequence[Any]
) -> tuple[ExperimentDesign, ...]:
    """The fewest manoeuvres to sail next: each clearly separates the most of the pairs that are left.

    Among those of equal use one that is sought in logs comes first. Then one of the shortest is taken: among
    manoeuvres about as short the one with most nats per minute for its closest pair.

    Parameters
    ----------
    separations : sequence of Separation
    sets : sequence
        Sets of causes, with their `hypotheses`, as they were compared.

    Returns
    -------
    tuple of ExperimentDesign
        Empty where no manoeuvre separates any pair.
    """
    left = set(separations[0].nats) if separations else set()
    chosen = []
    while left:
        # Greedy cover: those that separate most of the pairs that remain.
        most = max(len(separation.clear(left)) for separation in separations)
        if not most:
            break
        able = [separation for separation in separations if len(separation.clear(left)) == most]
        able = [separation for separation in able if separation.read] or able
        # Of the shortest the one with most evidence per minute.
        longest = _ABOUT * min(separation.minutes for separation in able)
        short = [separation for separation in able if separation.minutes <= longest]
        best = max(
            short, key=lambda separation: min(separation.clear(left).values()) / separation.minutes
        )
        separated = best.clear(left)
        separates = tuple(differing(sets[a], sets[b]) for a, b in separated)
        chosen.append(ExperimentDesign(best.manoeuvre, best.minutes, separates))
        left = left - separated.keys()
    return tuple(chosen)


def design_experiment(
    problem: IdentificationProblem,
    fit: Fit,
    rivals: Sequence[Fit],
    manoeuvres: Sequence[Manoeuvre] | None = None,
) -> ExperimentDesign | None:
    """A manoeuvre that is expected to tell a fit and its rivals apart.

    Parameters
    ----------
    problem : IdentificationProblem
        Of the log.
    fit : Fit
        The best.
    rivals : sequence of Fit
        Those that the log cannot tell from it.
    manoeuvres : sequence of Manoeuvre, optional
        Default: the library for the case's ship.

    Returns
    -------
    ExperimentDesign or None
        The first of those that `prescribed` chooses, with the pairs that it separates; None where none separates any.
    """
    fits = [fit, *rivals][:MOST_SETS]
    manoeuvres = list(
        manoeuvres or library(problem.model, cannot_turn(problem.record, problem.model))
    )
    with threadpool_limits(1):
        apart = separations(problem, fits, manoeuvres)
    computed = [
        Separation(
            manoeuvre.name,
            round(float(manoeuvre.minutes), 1),
            {pair: float(nats[i]) for pair, nats in apart.items()},
        )
        for i, manoeuvre in enumerate(manoeuvres)
    ]
    return next(iter(prescribed(computed, fits)), None)


def differing(first: Any, other: Any) -> tuple[str, str]:
    """Causes that two sets, with their `hypotheses`, do not share."""
    a, b = ([hypothesis.label for hypothesis in fit.hypotheses] for fit in (first, other))
    only_a, only_b = (
        " + ".join(x for x in mine if x not in yours) for mine, yours in ((a, b), (b, a))
    )
    return only_a or "nothing more", only_b or "nothing more"


def manoeuvre_of(
    design: ExperimentDesign | None, problem: IdentificationProblem
) -> Manoeuvre | None:
    """The manoeuvre of the library that a design prescribes, step by step."""
    if design is None:
        return None
    manoeuvres = library(problem.model, cannot_turn(problem.record, problem.model))
    return next((manoeuvre for manoeuvre in manoeuvres if manoeuvre.name == design.manoeuvre), None)


def separations(
    problem: IdentificationProblem, fits: Sequence[Fit], manoeuvres: Sequence[Manoeuvre]
) -> dict[tuple[int, int], np.ndarray]:
    """How far apart manoeuvres would bring the log-evidence of fits.

    Each fit in turn is the truth; the others may take whatever values their posterior from the log allows, as may all
    known numbers.

    Parameters
    ----------
    problem : IdentificationProblem
    fits : sequence of Fit
    manoeuvres : sequence of Manoeuvre

    Returns
    -------
    dict of (int, int) to (c,) array
        By places of two fits, lower first: the expected difference by manoeuvre, the smaller of both being true;
        NaN where the ship does not get through. [nats]
    """
    # Each fit's ship sails every manoeuvre in turn as the truth.
    # She has the fit's causes, and all known numbers at their most likely.
    models = [
        _in_true_wind(fit.model.with_values(moved(fit.columns, fit.left, fit.model.get)))
        for fit in fits
    ]
    motions, records, through = _simulated(problem, models, manoeuvres)
    noise = sized(problem.noise, step_for(problem.model) / problem.record.step)
    shared = _shared_columns(fits)
    ends = [rows_of(manoeuvre, records[0].step) for manoeuvre in manoeuvres]
    gains_by_pair = {
        pair: np.full(len(manoeuvres), np.inf) for pair in combinations(range(len(fits)), 2)
    }
    for a, (motion, record) in enumerate(zip(motions, records, strict=True)):
        # The instruments show the true motion without noise, as expected values are wanted.
        measured = np.moveaxis(rows_first(readings(motion, models[a])), 0, -2)
        record = replace(record, measured=measured)
        right = linearise(motion, record, models[a], [])
        tolerated = linearise(motion, record, _in_true_wind(problem.model), shared)
        # Innovations of each other fit on this truth, filtered with its columns.
        for b in range(len(fits)):
            if b != a:
                there = _linear_problem(
                    fits[b], models[b], motion, record, right, tolerated, shared
                )
                white = innovations(there, noise, record).white
                pair = min(a, b), max(a, b)
                # The evidence that it loses; the smaller of both being true counts.
                gains = [_missed(white[:end, i], fits[b].covariance) for i, end in enumerate(ends)]
                gains_by_pair[pair] = np.minimum(
                    gains_by_pair[pair], np.where(through[a], gains, np.nan)
                )
    return gains_by_pair


def _in_true_wind(model: ShipModel) -> ShipModel:
    """The ship in a wind that is given over ground."""
    return replace(model, wind_is_true=True)


def _shared_columns(fits):
    """Columns of known numbers of all fits, each once."""
    columns = {}
    for fit in fits:
        for column in fit.columns:
            columns.setdefault(column.key, column)
    of_causes = set()
    for fit in fits:
        turned = paths_of(fit.hypotheses)
        turned |= {
            path for hypothesis in fit.hypotheses for path in hypothesis.definition.companions
        }
        of_causes |= {column.key for column in fit.columns if column.gives_way(turned)}
    return [column for key, column in columns.items() if key not in of_causes]


def _linear_problem(fit, model, motion, record, right, tolerated, common):
    """The problem of a fit on a motion by another truth: what it misses more than the truth, and all its columns."""
    shared = [column.key for column in common]
    of_fit = [column for column in fit.columns if column.key not in shared]
    # Difference of what both models miss: only what the wrong model adds.
    mine = linearise(motion, record, model, of_fit)
    mine.driven[..., 0] -= right.driven[..., 0]
    mine.seen[..., 0] -= right.seen[..., 0]
    both = beside(mine, tolerated)  # missed, own, all known
    order = {column.key: i for i, column in enumerate([*of_fit, *common], start=1)}
    return both.chosen([order[column.key] for column in fit.columns])


def _missed(white, covariance):
    """Log-evidence that a fit loses on expected innovations, after its columns have explained what they can. [nats]"""
    # Residual sum of squares after the columns take up what the posterior covariance allows.
    rows = white.reshape(-1, white.shape[-1])
    products = rows.T @ rows
    L = np.linalg.cholesky(covariance + 1e-12 * np.eye(len(covariance)))
    G = L.T @ products[1:, 1:] @ L
    g = L.T @ products[1:, 0]
    return 0.5 * float(products[0, 0] - g @ np.linalg.solve(np.eye(len(G)) + G, g))


def _simulated(problem, models, manoeuvres):
    """Motions and records of every manoeuvre by every ship, and whether she gets through; lists by ship."""
    # Start where the log ends, in its mean wind.
    x, y, psi = (float(value[-1]) for value in problem.motion[:3])
    start = float(problem.record.time[-1]), x, y, psi
    wind = true_wind(problem.record, problem.motion, problem.model)
    dp = DpController(
        _in_true_wind(problem.model),
        step_for(problem.model),
        cannot_turn(problem.record, problem.model),
    )
    # Plan the tracks, then simulate all ships on all manoeuvres under DP control at once.
    track, record, held = planned(manoeuvres, dp, start, wind)
    motions = []
    records = []
    through = []
    many = len(manoeuvres)
    ships = _side_by_side(models, start[0], len(manoeuvres))
    times = (len(models), 1)
    side_by_side = replace(
        record,
        units={
            name: tuple(np.tile(series, times) for series in pair)
            for name, pair in record.units.items()
        },
        wind=None
        if record.wind is None
        else tuple(np.tile(series, times) for series in record.wind),
    )
    held = {name: np.tile(where, times) for name, where in held.items()}
    tracks = Motion(*(np.tile(value, times) for value in track))
    motion, units = kept_on_track(ships, many * len(models), tracks, side_by_side, dp, held=held)
    for i in range(len(models)):
        part = slice(i * many, (i + 1) * many)
        motions.append(at_rows(motion, part))
        here = part_of(units, part)
        records.append(replace(record, units=here))
        through.append(keeps_track(motions[-1], track, manoeuvres, dp))
    return motions, records, through


def _side_by_side(models, time, many):
    """One ship model with the numbers of several as arrays, each repeated: to simulate ships side by side."""
    # Numbers that differ between the models become arrays over the ships.
    models = [with_steady_current(model, time) for model in models]
    values = {}
    for name, part in models[0].parts.items():
        place = models[0].vessel if name in ("hull", "wind") else name
        for item in fields(part) if name != "instruments" else ():
            each = [getattr(model.parts[name], item.name) for model in models]
            if len(set(each)) > 1:
                values[f"{place}.{item.name}"] = np.repeat(each, many)
    return models[0].with_values(values)


def keeps_track(
    motion: Motion, track: Motion, manoeuvres: Sequence[Manoeuvre], dp: DpController
) -> np.ndarray:
    """Whether the ship keeps near her track, and in the area where she drifts or is pushed. (c,)"""
    length = dp.model.length
    keeps = []
    # Distance off the track and from the start, in ship lengths.
    off = np.hypot(motion.x - track.x, motion.y - track.y) / length
    far = np.hypot(motion.x - track.x[:, :1], motion.y - track.y[:, :1]) / length
    for i, manoeuvre in enumerate(manoeuvres):
        rows = slice(0, rows_of(manoeuvre, dp.h))
        near = _ROOM if manoeuvre.free or manoeuvre.pushes else _ASTRAY
        keeps.append((off[i, rows] < near).all() and (far[i, rows] < _ROOM).all())
    return np.array(keeps)
