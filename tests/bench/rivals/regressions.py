"""What else could be done with the same log: inverse dynamics with BIC, PySINDy on the residual, a nameless network.

Each gets the nominal ship and the repaired log that the diagnosis gets, and answers in its terms, so that the trial
scores it alike: `python tests/bench/trial run --tool rivals.regressions:inverse_dynamics --into results/bic.jsonl`.
The network names nothing; it is only compared by the gain.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from shipcosim.diagnose.finding import Candidate, Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import hypotheses_of, read_catalogue
from shipcosim.diagnose.log.checks.examine import examine
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.log.repair import repaired
from shipcosim.diagnose.result import Diagnosis
from shipcosim.diagnose.ship.dynamics import motion_rates
from shipcosim.diagnose.ship.inputs import first_motion, record_of
from shipcosim.diagnose.ship.measured_motion import readings
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.models.core.motion import Motion
from trial.tools import system

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
    record, ship model, motion
        As the diagnosis has them; the motion is smoothed and differentiated, so is the model's acceleration.
    scale : (3,) array
        Standard deviation of what is not explained without a cause, by axis.
    hypotheses : list of Hypothesis
    faults : tuple of Finding
        Of the data, found beforehand by the project's own examination.
    """

    record: object
    model: object
    motion: object
    scale: object
    hypotheses: list
    faults: tuple


def problem_of(path):
    """Read and repair a log as the diagnosis does."""
    log = read_log(path)
    faults = tuple(examine(log))
    clean = repaired(log, faults)
    model = replace(
        ship_model_of(system()), span=(float(clean["time"][0]), float(clean["time"][-1]))
    )
    record = record_of(clean, model)
    motion = first_motion(record, SMOOTH)
    problem = Problem(
        record, model, motion, np.ones(3), list(hypotheses_of(read_catalogue(), model)), faults
    )
    scale = missing_acceleration(problem, {}).reshape(3, -1).std(axis=1)
    return replace(problem, scale=scale)


def missing_acceleration(problem, values):
    """Measured minus modelled acceleration over `scale`, of the rows where all is known, one axis after the other."""
    model, seen, h = problem.model.with_values(values), problem.motion, problem.record.step
    motion = Motion(
        *(2.0 * value - other for value, other in zip(seen, readings(seen, model), strict=True))
    )
    here = Motion(*(value[:-1] for value in motion))
    modelled = motion_rates(here, problem.record.inputs(model), model)
    known = problem.record.usable[:-1]
    rows = [
        (
            np.gradient(getattr(motion, name), h)[:-1]
            - gaussian_filter1d(getattr(modelled, name), SMOOTH / h)
        )[known]
        / scale
        for name, scale in zip("uvr", problem.scale, strict=True)
    ]
    return np.concatenate(rows)


def slopes(problem, parameters, values):
    """Change of the missing acceleration per typical size of each parameter."""
    columns = []
    for parameter in parameters:
        now, by = values.get(parameter.paths[0], parameter.neutral), SHARE * parameter.typical
        up, down = (
            missing_acceleration(problem, values | dict.fromkeys(parameter.paths, now + way * by))
            for way in (1.0, -1.0)
        )
        columns.append((up - down) / (2.0 * SHARE))
    return np.stack(columns, axis=1)


@dataclass(frozen=True)
class Regression:
    """Causes fitted by least squares: values of the numbers they turn, standard deviations by parameter, BIC."""

    hypotheses: tuple
    values: dict
    std: dict
    bic: float


def regression(problem, chosen, values=None):
    """Gauss-Newton from neutral.

    Parameters
    ----------
    problem : Problem
    chosen : tuple of Hypothesis
    values : dict of str to float, optional
        To start from.

    Returns
    -------
    Regression
    """
    parameters, values, std = (
        [parameter for hypothesis in chosen for parameter in hypothesis.parameters],
        dict(values or {}),
        {},
    )
    for _ in range(ROUNDS if parameters else 0):
        J, missing = slopes(problem, parameters, values), missing_acceleration(problem, values)
        step = np.linalg.lstsq(J, -missing, rcond=None)[0]
        for parameter, by in zip(parameters, step, strict=True):
            now = values.get(parameter.paths[0], parameter.neutral)
            values |= dict.fromkeys(
                parameter.paths, float(np.clip(now + by * parameter.typical, *parameter.bounds))
            )
        deviations = np.sqrt(np.diag(np.linalg.pinv(J.T @ J)) * missing.var())
        std = {
            parameter.paths[0]: float(d * parameter.typical)
            for parameter, d in zip(parameters, deviations, strict=True)
        }
    missing = missing_acceleration(problem, values)
    n = missing.size
    return Regression(
        tuple(chosen),
        values,
        std,
        n * math.log(float(missing @ missing) / n) + len(parameters) * math.log(n),
    )


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
        others = [
            hypothesis for hypothesis in problem.hypotheses if hypothesis not in best.hypotheses
        ]
        tried = [
            regression(problem, (*best.hypotheses, hypothesis), best.values)
            for hypothesis in others
        ]
        tried.sort(key=lambda one: one.bic)
        if tried[0].bic > best.bic - STRONG:
            break
        best, rivals = tried[0], [one for one in tried if one.bic < tried[0].bic + STRONG]
    findings = [_finding(hypothesis, best.values, best.std) for hypothesis in best.hypotheses]
    if len(rivals) > 1:
        alike = tuple(
            Candidate(one.hypotheses[-1].cause, one.hypotheses[-1].component, 1 / len(rivals))
            for one in rivals
        )
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
    library = [
        hypothesis for hypothesis in problem.hypotheses if hypothesis.definition.law != "turning"
    ]  # holds the steady current
    parameters = [parameter for hypothesis in library for parameter in hypothesis.parameters]
    optimizer = pysindy.STLSQ(threshold=THRESHOLD, alpha=RIDGE)
    found = optimizer.fit(
        slopes(problem, parameters, {}), -missing_acceleration(problem, {})
    ).coef_.ravel()
    sizes = {parameter.paths: size for parameter, size in zip(parameters, found, strict=True)}
    findings = []
    for hypothesis in library:
        values = {k.paths[0]: k.neutral + k.typical * sizes[k.paths] for k in hypothesis.parameters}
        if any(sizes[parameter.paths] for parameter in hypothesis.parameters):
            findings.append(_finding(hypothesis, values, {}))
    return _named(problem, findings)


def _named(problem, findings):
    found = (*problem.faults, *findings)
    return Diagnosis("named" if found else "consistent", found)


def _finding(hypothesis, values, std):
    estimates = {
        parameter.name: ParameterEstimate(
            values[parameter.paths[0]] * parameter.factor,
            std.get(parameter.paths[0], 0.0) * abs(parameter.factor),
            parameter.unit,
        )
        for parameter in hypothesis.parameters
    }
    return Finding(hypothesis.cause, hypothesis.component, parameters=estimates)
