"""What else could be done with the same log: inverse dynamics with BIC, PySINDy on the residual, a nameless network.

Each gets the nominal ship and the repaired log that the diagnosis gets, and answers in its terms, so that the trial
scores it alike: `python tests/bench/trial run --tool rivals.regressions:inverse_dynamics --into results/bic.jsonl`.
The network names nothing; it is only compared by the gain.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from trial.tools import system

from shipcosim.diagnose.hypotheses.catalogue import read_catalogue, suspects
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.result import Candidate, Diagnosis, Estimate, Finding
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.model import Motion, motion_rates, plant_of, shown

SMOOTH = 4.0  # s, standard deviation of the Gaussian that measurements and model are smoothed with
SHARE = 0.2  # of a typical effect, for differences
ROUNDS = 4
STRONG = 6.0  # difference in BIC; Kass and Raftery 1995, "strong"
THRESHOLD = 0.4  # of a typical effect, below which sparse regression drops a term
RIDGE = 0.05


@dataclass(frozen=True)
class Problem:
    """A log as accelerations that the ship's model does not explain.

    Attributes
    ----------
    record, plant, motion
        As the diagnosis has them; the motion is smoothed and differentiated, so is the model's acceleration.
    scale : (3,) array
        Standard deviation of what is not explained without a cause, by axis.
    suspects : list of Suspect
    faults : tuple of Finding
        Of the data, found beforehand by the project's own examination.
    """

    record: object
    plant: object
    motion: object
    scale: object
    suspects: list
    faults: tuple


def problem_of(path):
    """Read and repair a log as the diagnosis does."""
    log = read_log(path)
    faults = tuple(examine(log))
    clean = repaired(log, faults)
    plant = replace(plant_of(system()), span=(float(clean["time"][0]), float(clean["time"][-1])))
    record = record_of(clean, plant)
    motion = first_motion(record, plant, SMOOTH)
    problem = Problem(record, plant, motion, np.ones(3), list(suspects(read_catalogue(), plant)), faults)
    scale = missing_acceleration(problem, {}).reshape(3, -1).std(axis=1)
    return replace(problem, scale=scale)


def missing_acceleration(problem, values):
    """Measured minus modelled acceleration over `scale`, of the rows where all is known, one axis after the other."""
    plant, seen, h = problem.plant.with_values(values), problem.motion, problem.record.step
    motion = Motion(*(2.0 * value - other for value, other in zip(seen, shown(seen, plant), strict=True)))
    here = Motion(*(value[:-1] for value in motion))
    modelled = motion_rates(here, problem.record.drivers(plant), plant)
    known = problem.record.known[:-1]
    rows = [
        (np.gradient(getattr(motion, name), h)[:-1] - gaussian_filter1d(getattr(modelled, name), SMOOTH / h))[known]
        / scale
        for name, scale in zip("uvr", problem.scale, strict=True)
    ]
    return np.concatenate(rows)


def slopes(problem, knobs, values):
    """Change of the missing acceleration per typical size of each knob."""
    columns = []
    for knob in knobs:
        now, by = values.get(knob.paths[0], knob.neutral), SHARE * knob.typical
        up, down = (
            missing_acceleration(problem, values | dict.fromkeys(knob.paths, now + way * by)) for way in (1.0, -1.0)
        )
        columns.append((up - down) / (2.0 * SHARE))
    return np.stack(columns, axis=1)


@dataclass(frozen=True)
class Regression:
    """Causes fitted by least squares: values of the numbers they turn, standard deviations by knob, BIC."""

    suspects: tuple
    values: dict
    std: dict
    bic: float


def regression(problem, chosen, values=None):
    """Gauss-Newton from neutral.

    Parameters
    ----------
    problem : Problem
    chosen : tuple of Suspect
    values : dict of str to float, optional
        To start from.

    Returns
    -------
    Regression
    """
    knobs, values, std = [knob for suspect in chosen for knob in suspect.knobs], dict(values or {}), {}
    for _ in range(ROUNDS if knobs else 0):
        J, missing = slopes(problem, knobs, values), missing_acceleration(problem, values)
        step = np.linalg.lstsq(J, -missing, rcond=None)[0]
        for knob, by in zip(knobs, step, strict=True):
            now = values.get(knob.paths[0], knob.neutral)
            values |= dict.fromkeys(knob.paths, float(np.clip(now + by * knob.typical, *knob.bounds)))
        deviations = np.sqrt(np.diag(np.linalg.pinv(J.T @ J)) * missing.var())
        std = {knob.paths[0]: float(d * knob.typical) for knob, d in zip(knobs, deviations, strict=True)}
    missing = missing_acceleration(problem, values)
    n = missing.size
    return Regression(tuple(chosen), values, std, n * math.log(float(missing @ missing) / n) + len(knobs) * math.log(n))


def inverse_dynamics(path, most=2):
    """The causes with the lowest BIC in a regression of the missing acceleration; one after another while it falls.

    Parameters
    ----------
    path : path
        Of a log.
    most : int
        Causes.

    Returns
    -------
    Diagnosis
    """
    problem = problem_of(path)
    best, rivals = regression(problem, ()), []
    for _ in range(most):
        others = [suspect for suspect in problem.suspects if suspect not in best.suspects]
        tried = [regression(problem, (*best.suspects, suspect), best.values) for suspect in others]
        tried.sort(key=lambda one: one.bic)
        if tried[0].bic > best.bic - STRONG:
            break
        best, rivals = tried[0], [one for one in tried if one.bic < tried[0].bic + STRONG]
    findings = [_finding(suspect, best.values, best.std) for suspect in best.suspects]
    if len(rivals) > 1:
        alike = tuple(Candidate(one.suspects[-1].cause, one.suspects[-1].component, 1 / len(rivals)) for one in rivals)
        return Diagnosis("ambiguous", (*problem.faults, *findings[:-1]), indistinguishable=alike)
    return _named(problem, findings)


def sparse_regression(path):
    """PySINDy's sequentially thresholded least squares; the library holds what each number would do to the residual.

    Parameters
    ----------
    path : path
        Of a log.

    Returns
    -------
    Diagnosis
    """
    import pysindy

    problem = problem_of(path)
    library = [suspect for suspect in problem.suspects if suspect.effect.law != "turning"]  # holds the steady current
    knobs = [knob for suspect in library for knob in suspect.knobs]
    optimizer = pysindy.STLSQ(threshold=THRESHOLD, alpha=RIDGE)
    found = optimizer.fit(slopes(problem, knobs, {}), -missing_acceleration(problem, {})).coef_.ravel()
    sizes = {knob.paths: size for knob, size in zip(knobs, found, strict=True)}
    findings = []
    for suspect in library:
        values = {k.paths[0]: k.neutral + k.typical * sizes[k.paths] for k in suspect.knobs}
        if any(sizes[knob.paths] for knob in suspect.knobs):
            findings.append(_finding(suspect, values, {}))
    return _named(problem, findings)


def _named(problem, findings):
    found = (*problem.faults, *findings)
    return Diagnosis("named" if found else "consistent", found)


def _finding(suspect, values, std):
    estimates = {
        knob.name: Estimate(
            values[knob.paths[0]] * knob.factor, std.get(knob.paths[0], 0.0) * abs(knob.factor), knob.unit
        )
        for knob in suspect.knobs
    }
    return Finding(suspect.cause, suspect.component, parameters=estimates)
