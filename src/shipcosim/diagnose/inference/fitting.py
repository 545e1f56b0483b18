"""Which causes explain a log: how a set of them is fitted, and what each further one would gain beside it."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shipcosim.diagnose.inference.evidence import evidence, gram
from shipcosim.diagnose.inference.innovations import innovations
from shipcosim.diagnose.inference.linearisation import beside, linearise
from shipcosim.diagnose.inference.noise import explained

DIRECTIONS = 12
ROUNDS = 5
_BENT = {"instruments.wind_lag"}  # whose effect is not linear within its tolerance, in quick gusts
_FAR = 3.0  # tolerances, beyond which nothing is linearised about
_SLOW, _STILL = 0.35, 0.05  # of the faster end: a current this slow at first sight has no direction; where it starts


@dataclass(frozen=True)
class Column:
    """One θ.

    Attributes
    ----------
    turns : dict of str to float
        By how much it changes each number at θ = 1.
    prior : float
        Standard deviation of θ.
    """

    turns: dict
    prior: float = 1.0


@dataclass(frozen=True)
class Case:
    """A log with the ship that is to explain it, and where to start.

    Attributes
    ----------
    record : Record
    plant : Plant
        With all causes neutral.
    suspects : tuple of Suspect
    noise : Noise
    motion : Motion
    base : Linear, optional
        About the ship without a cause, with the columns of `basis`.
    known_of : tuple of Suspect, optional
        Suspects whose numbers are known within a tolerance, where those are more than `suspects`.
    """

    record: Any
    plant: Any
    suspects: tuple
    noise: Any
    motion: Any
    base: Any = None
    known_of: tuple = ()

    @property
    def basis(self):
        """All known numbers, and what every suspect is first sought by."""
        return self.known(()) + [column for s in self.suspects for group in probes(s) for column in group]

    def base_of(self, columns):
        """The problem about the ship without a cause, with these columns of the basis."""
        places = {_key(column): i for i, column in enumerate(self.basis, start=1)}
        wanted = [0, *(places[_key(column)] for column in columns)]
        return self.base._replace(driven=self.base.driven[..., wanted], seen=self.base.seen[..., wanted])

    def known(self, suspects):
        """Columns of the numbers that are known within a tolerance, except those that these suspects turn."""
        taken = {path for suspect in suspects for knob in suspect.knobs for path in knob.paths}
        taken |= {path for suspect in suspects for path in suspect.effect.replaces}
        everyone = self.known_of or self.suspects
        taken |= {path for suspect in everyone for path in suspect.effect.companions}
        found = [Column({path: size}) for path, size in self.plant.tolerances.items() if path not in taken]
        for suspect in everyone:
            for knob in suspect.knobs if suspect.effect.law == "linear" else ():
                listed = all(path in self.plant.tolerances for path in knob.paths)
                if knob.tolerance > 0.0 and not listed and not taken & set(knob.paths):
                    found.append(Column(dict.fromkeys(knob.paths, knob.tolerance)))
        return found


@dataclass(frozen=True, eq=False)
class Fit:
    """A set of causes fitted to a log.

    Attributes
    ----------
    suspects : tuple of Suspect
    values, std : dict of str to float
        Of each number that they turn.
    score : float
        Log-evidence of the log with these causes, up to a constant of the log.
    columns : list of Column
        Of known numbers, then of the causes.
    linear : Linear
    products : Gram
    theta, covariance : array
        Posterior of the columns, causes about neutral.
    centre : array
        θ that they were linearised about.
    plant : Plant
    motion : Motion
    """

    suspects: tuple
    values: dict
    std: dict
    score: float
    columns: list
    linear: Any
    products: Any
    theta: Any
    covariance: Any
    centre: Any
    plant: Any
    motion: Any

    @property
    def label(self):
        return " + ".join(suspect.label for suspect in self.suspects) or "nothing"

    @property
    def left(self):
        """θ that the columns still have to explain about this fit's ship: those of known numbers."""
        return self.theta - self.centre


def prepared(case, rounds=3):
    """The case with its base: every column of the basis, about the motion smoothed without a cause."""
    motion = case.motion
    for _ in range(rounds):
        alone = linearise(motion, case.record, case.plant, [])
        motion = _smoothed(alone, innovations(alone, case.noise, case.record).white[..., 0], case, motion)
    base = linearise(motion, case.record, case.plant, [column.turns for column in case.basis])
    return replace(case, motion=motion, base=base)


def _smoothed(linear, white, case, motion):
    """The motion to linearise about next: that of the ship as the problem has her, as far as she can follow the log.

    Where she cannot, the measurements rule: jolts are as much larger as the innovations' mean square is. Otherwise a
    boat whose propeller has lost a third of its thrust is smoothed far off her track, and nothing is found about that.
    """
    misfit = (white**2).sum((0, -1)) / linear.whole.sum((0, -1))
    jolt = np.maximum(misfit, 1.0)[..., None] * np.asarray(case.noise.jolt)
    noise = replace(case.noise, jolt=jolt, walk=np.broadcast_to(case.noise.walk, jolt.shape))
    return innovations(linear, noise, case.record, motion).motion


def _key(column):
    return tuple(sorted(column.turns.items()))


def fitted(case, suspects=(), values=None, rounds=ROUNDS):
    """Fit the parameters of some causes, with all known numbers within their tolerances.

    Parameters
    ----------
    case : Case
    suspects : tuple of Suspect
    values : dict of str to float, optional
        To start from, brought within bounds.
    rounds : int
        Of linearisation.

    Returns
    -------
    Fit
    """
    values, about, motion, fit = _bounded(suspects, values or {}), {}, case.motion, None
    columns = case.known(suspects) + _own(case, suspects)
    for _ in range(rounds):
        plant = case.plant.with_values(values | about)
        linear = linearise(motion, case.record, plant, [column.turns for column in columns])
        last, fit = fit, _posterior(case, suspects, values, columns, linear, plant, motion)
        motion, values, about = fit.motion, _next(fit), _about(fit)
        moved = [abs(values[k.paths[0]] - fit.plant.get(k.paths[0])) / k.typical for s in suspects for k in s.knobs]
        if max(moved, default=0.0) < 0.02 and last and abs(fit.score - last.score) < 1.0:
            break
    return fit


def _own(case, suspects):
    """Columns of suspects, what is only known within a tolerance about them first."""
    about = [path for suspect in suspects for path in suspect.effect.companions]
    found = [Column({path: case.plant.tolerances[path]}) for path in about]
    return found + [Column(dict.fromkeys(knob.paths, knob.typical)) for s in suspects for knob in s.knobs]


def _posterior(case, suspects, values, columns, linear, plant, motion):
    """The fit about some values."""
    filtered = innovations(linear, case.noise, case.record)
    products, centre = gram(filtered), _centre(columns, plant, case.plant)
    prior = np.array([column.prior for column in columns])
    score, theta, covariance = evidence(products.products, prior, centre)
    score += float(products.free)
    values, knobs = dict(values), [knob for suspect in suspects for knob in suspect.knobs]
    deviations = np.sqrt(np.diag(covariance))[theta.size - len(knobs) :]
    std = {knob.paths[0]: float(d * knob.typical) for knob, d in zip(knobs, deviations, strict=True)}
    left = theta - centre
    white = filtered.white[..., 0] - filtered.white[..., 1:] @ left
    motion = _smoothed(explained(linear, left), white, case, motion)
    rest = (columns, linear, products, theta, covariance, centre, plant, motion)
    return Fit(tuple(suspects), values, std, score, *rest)


def _next(fit):
    """Values of the numbers at the posterior's mean, within their bounds."""
    knobs = [knob for suspect in fit.suspects for knob in suspect.knobs]
    found = dict(fit.values)
    for knob, theta in zip(knobs, fit.theta[fit.theta.size - len(knobs) :], strict=True):
        found.update(dict.fromkeys(knob.paths, float(knob.neutral + theta * knob.typical)))
    return _bounded(fit.suspects, found)


def _bounded(suspects, values):
    """Values with the numbers that some suspects turn within their bounds."""
    bounds = {path: knob.bounds for suspect in suspects for knob in suspect.knobs for path in knob.paths}
    return {path: float(np.clip(v, *bounds[path])) if path in bounds else v for path, v in values.items()}


def _about(fit):
    """What is only known within a tolerance, and does not act along a line through neutral, at the posterior's mean."""
    wanted = _BENT | {path for suspect in fit.suspects for path in suspect.effect.companions}
    found = {}
    for column, theta, centre in zip(fit.columns, fit.theta, fit.centre, strict=True):
        for path, size in column.turns.items() if wanted & set(column.turns) else ():
            found[path] = fit.plant.get(path) + size * float(np.clip(theta, -_FAR, _FAR) - centre)
    return found


def weighed(case, fit):
    """Gain in log-evidence of each suspect beside a fit, linearised once.

    Parameters
    ----------
    case : Case
    fit : Fit

    Returns
    -------
    list of (float, Suspect, dict of str to float)
        Gain, suspect, first values of the numbers that it turns; best first.
    """
    wanted = [s for s in case.suspects if s not in fit.suspects]
    added = [column for suspect in wanted for group in probes(suspect) for column in group]
    linear = beside(fit.linear, case.base_of(added))
    products = gram(innovations(linear, case.noise, case.record)).products
    return gains(products, fit.columns, fit.centre, wanted, fit.plant)


def gains(products, columns, centre, wanted, plant):
    """Gain in log-evidence of suspects, from the inner products of the log with some columns and with their probes.

    Parameters
    ----------
    products : (1 + p, 1 + p) array
        The log, then `columns`, then the probes of each wanted suspect in turn.
    columns : list of Column
    centre : array
        θ of these columns that they were linearised about.
    wanted : sequence of Suspect
    plant : Plant
        That they were linearised about.

    Returns
    -------
    list of (float, Suspect, dict of str to float)
        As `weighed`.
    """
    base = len(columns)
    prior = np.concatenate([[column.prior for column in columns], np.zeros(len(products) - 1 - base)])
    centre = np.concatenate([centre, np.zeros(prior.size - base)])
    nothing, place, found = evidence(products, prior, centre)[0], base, []
    for suspect in wanted:
        tries = []
        for group in probes(suspect):
            here = prior.copy()
            here[place : place + len(group)] = 1.0
            taken = {path for column in group for path in column.turns} | set(suspect.effect.replaces)
            here[[i for i, column in enumerate(columns) if taken & set(column.turns)]] = 0.0
            score, theta, _ = evidence(products, here, np.where(here > 0.0, centre, 0.0))
            values = {}
            for column, share in zip(group, theta[place : place + len(group)], strict=True):
                for path, size in column.turns.items():
                    values[path] = values.get(path, plant.get(path)) + share * size
            tries.append((score - nothing, values))
            place += len(group)
        gain, values = _together(tries, suspect)
        found.append((gain, suspect, values))
    return sorted(found, key=lambda entry: -entry[0])


def _together(tries, suspect):
    """Evidence of a suspect over all its directions, and the values of the best."""
    scores = np.array([score for score, _ in tries])
    best = int(scores.argmax())
    values = tries[best][1]
    if suspect.effect.law == "turning":
        north, east = values.pop("water.current_north"), values.pop("water.current_east")
        grown = values.pop("water.trend_north"), values.pop("water.trend_east")
        names = [knob.paths[0] for knob in suspect.knobs]
        ends = _one_way(np.array([north, east]), np.array([north + grown[0], east + grown[1]]))
        values = dict(zip(names, map(float, np.concatenate(ends)), strict=True))
    return float(scores[best] + np.log(np.exp(scores - scores[best]).mean())), values


def _one_way(first, last):
    """Ends of a current; one of next to nothing lies along the other: its own direction is chance, and stays."""
    sizes = np.linalg.norm(first), np.linalg.norm(last)
    if sizes[0] < _SLOW * sizes[1]:
        first = last * max(sizes[0] / sizes[1], _STILL)
    elif sizes[1] < _SLOW * sizes[0]:
        last = first * max(sizes[1] / sizes[0], _STILL)
    return first, last


def probes(suspect):
    """Groups of columns by which a suspect is first sought."""
    knobs = suspect.knobs
    if suspect.effect.law == "linear":
        return [[Column(dict.fromkeys(knob.paths, knob.typical)) for knob in knobs]]
    if suspect.effect.law == "turning":
        names = ("current_north", "current_east", "trend_north", "trend_east")
        return [[Column({f"water.{name}": knobs[0].typical}) for name in names]]
    pair, size = (knobs[0].paths[0], knobs[1].paths[0]), knobs[0].typical
    angles = 2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return [[Column(dict(zip(pair, (size * np.cos(a), size * np.sin(a)), strict=True)))] for a in angles]


def _centre(columns, plant, neutral):
    """θ of the plant that the columns were linearised about; 0 for known numbers."""
    found = np.zeros(len(columns))
    for i, column in enumerate(columns):
        path, size = next(iter(column.turns.items()))
        found[i] = (plant.get(path) - neutral.get(path)) / size
    return found
