"""Experiment design: every manoeuvre of the library is simulated in array form, and scored by what it separates."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import combinations
from typing import Any

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
3 nats ahead, the distance at which causes are told apart, in 94 of 100 logs, and more than 3 behind in 1 of 500.
"""
_MOST = 4  # rivals that are compared
_ABOUT = 1.5  # times the shortest: about as short
_ASTRAY = 0.5  # lengths that a ship may be off her track
_ROOM = 3.0  # lengths that a ship may get away from where she started


@dataclass(frozen=True)
class ExperimentDesign:
    """A manoeuvre that tells causes apart which the log could not."""

    manoeuvre: str
    minutes: float
    separates: tuple[tuple[str, str], ...]


def design_experiment(
    problem: IdentificationProblem,
    fit: Fit,
    rivals: Sequence[Fit],
    manoeuvres: Sequence[Manoeuvre] | None = None,
) -> ExperimentDesign | None:
    """A manoeuvre that is expected to tell a fit and its rivals apart.

    Of those that separate all pairs, one of the shortest; among manoeuvres about as short the one with most nats per
    minute for its closest pair.

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
        It names the pairs that it separates. Where no manoeuvre separates all pairs, the one that separates most; None
        where none separates any.
    """
    fits = [fit, *rivals][:_MOST]
    manoeuvres = list(
        manoeuvres or library(problem.model, cannot_turn(problem.record, problem.model))
    )
    with threadpool_limits(1):
        apart = separations(problem, fits, manoeuvres)
    # Expected log-evidence for each manoeuvre and pair; then how many pairs it separates.
    pairs = list(combinations(range(len(fits)), 2))
    told = np.array(
        [[apart[min(a, b), max(a, b)][i] for a, b in pairs] for i in range(len(manoeuvres))]
    )
    count = (told >= CLEAR).sum(1)
    least = np.nan_to_num(told, nan=-np.inf).min(1, initial=np.inf)
    if not count.max(initial=0):
        return None
    # Among manoeuvres that separate most pairs, take a short one with most evidence per minute.
    minutes = np.array([one.minutes for one in manoeuvres])
    able = np.flatnonzero(count == count.max())
    short = able[minutes[able] <= _ABOUT * minutes[able].min()]
    best = max(short, key=lambda i: least[i] / minutes[i])
    names = [differing(fits[a], fits[b]) for a, b in pairs]
    separates = tuple(name for name, value in zip(names, told[best], strict=True) if value >= CLEAR)
    return ExperimentDesign(manoeuvres[best].name, round(float(minutes[best]), 1), separates)


def differing(one: Any, other: Any) -> tuple[str, str]:
    """What two sets of causes, with their `hypotheses`, do not share."""
    a, b = ([hypothesis.label for hypothesis in fit.hypotheses] for fit in (one, other))
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
    known = library(problem.model, cannot_turn(problem.record, problem.model))
    return next((one for one in known if one.name == design.manoeuvre), None)


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
    models = [_fitted_ship(fit) for fit in fits]
    motions, records, through = _simulated(problem, models, manoeuvres)
    noise = sized(problem.noise, step_for(problem.model) / problem.record.step)
    known = _shared_columns(fits)
    ends = [rows_of(one, records[0].step) for one in manoeuvres]
    found = {pair: np.full(len(manoeuvres), np.inf) for pair in combinations(range(len(fits)), 2)}
    for a, (motion, record) in enumerate(zip(motions, records, strict=True)):
        # The instruments show the true motion without noise, as expected values are wanted.
        measured = np.moveaxis(rows_first(readings(motion, models[a])), 0, -2)
        record = replace(record, measured=measured)
        right = linearise(motion, record, models[a], [])
        tolerated = linearise(motion, record, _in_true_wind(problem.model), known)
        # Innovations of each other fit on this truth, filtered with its columns.
        for b in range(len(fits)):
            if b != a:
                there = _beside(fits[b], models[b], motion, record, right, tolerated, known)
                white = innovations(there, noise, record).white
                pair = min(a, b), max(a, b)
                # The evidence that it loses; the smaller of both being true counts.
                gains = [_missed(white[:end, i], fits[b].covariance) for i, end in enumerate(ends)]
                found[pair] = np.minimum(found[pair], np.where(through[a], gains, np.nan))
    return found


def _in_true_wind(model: ShipModel) -> ShipModel:
    """The ship in a wind that is given over ground."""
    return replace(model, wind_is_true=True)


def _fitted_ship(fit: Fit) -> ShipModel:
    """The ship of a fit: its causes, and all known numbers at their most likely."""
    # Shift all numbers of the fit by its posterior mean.
    return _in_true_wind(fit.model.with_values(moved(fit.columns, fit.left, fit.model.get)))


def _shared_columns(fits):
    """Columns of known numbers of all fits, each once."""
    found = {}
    for fit in fits:
        for column in fit.columns:
            found.setdefault(_key(column), column)
    own = {_key(c) for fit in fits for c in _own(fit)}
    return [column for key, column in found.items() if key not in own]


def _own(fit):
    turned = paths_of(fit.hypotheses)
    turned |= {path for s in fit.hypotheses for path in s.definition.companions}
    return [column for column in fit.columns if column.gives_way(turned)]


def _key(column):
    return tuple(sorted(column.changes.items()))


def _beside(fit, model, motion, record, right, tolerated, known):
    """The problem of a fit on a motion by another truth: what it misses more than the truth, and all its columns."""
    shared = [_key(column) for column in known]
    own = [column for column in fit.columns if _key(column) not in shared]
    # Difference of what both models miss: only what the wrong model adds.
    mine = linearise(motion, record, model, own)
    mine.driven[..., 0] -= right.driven[..., 0]
    mine.seen[..., 0] -= right.seen[..., 0]
    both = beside(mine, tolerated)  # missed, own, all known
    order = {key: i for i, key in enumerate([*map(_key, own), *shared], start=1)}
    return both.chosen([order[_key(column)] for column in fit.columns])


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
    found = []
    # Distance off the track and from the start, in ship lengths.
    off = np.hypot(motion.x - track.x, motion.y - track.y) / length
    far = np.hypot(motion.x - track.x[:, :1], motion.y - track.y[:, :1]) / length
    for i, one in enumerate(manoeuvres):
        rows = slice(0, rows_of(one, dp.h))
        near = _ROOM if one.free or one.pushes else _ASTRAY
        found.append((off[i, rows] < near).all() and (far[i, rows] < _ROOM).all())
    return np.array(found)
