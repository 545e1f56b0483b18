"""Samples: values drawn at random, or spread evenly, over distributions of scipy.stats."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import units_of
from shipcosim.sweep.levels import Levels, start_value
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.records import Distribution, Sample, Study
from shipcosim.units import UnitError, number_in

if TYPE_CHECKING:
    from shipcosim.ssp import System

EDGE = 2.0**-53
"""Least probability that a sample has, so that a distribution without bounds gives numbers."""


@dataclass(frozen=True)
class SampledColumn:
    """A column of samples.

    Parameters
    ----------
    name : str
        Of the column.
    signals : tuple of str
        That get its values.
    unit : str or None
        Of the signals.
    is_whole : bool
        Whether they are whole numbers.
    at_fork : bool
        Whether they act at the fork, not from the start.
    """

    name: str
    signals: tuple[str, ...]
    unit: str | None
    is_whole: bool
    at_fork: bool


@dataclass(frozen=True)
class Samples:
    """Samples of a study.

    Parameters
    ----------
    columns : tuple of SampledColumn
    numbers : (samples, columns) array
        In the units of the signals.
    """

    columns: tuple[SampledColumn, ...]
    numbers: np.ndarray

    def values(self, number: int) -> list[float | int]:
        """Values of a sample, in the order of the columns."""
        row = self.numbers[number].tolist()
        return [round(v) if column.is_whole else v for v, column in zip(row, self.columns, strict=True)]


def samples_of(study: Study, levels: Levels, system: System) -> Samples | None:
    """Samples of a study; None where it has none. What is wrong is among the problems of `levels`.

    Raises
    ------
    ShipcosimError
        If a library is missing.
    """
    sample = study.sample
    if sample is None:
        return None
    check_scipy()
    quantiles = [_quantiles(study, levels, system, signal, one) for signal, one in sample.of.items()]
    usable = [one for one in quantiles if one is not None]
    if len(usable) < len(quantiles):
        return None
    spread = np.clip(SPREADS[sample.method](sample, study.seed), EDGE, 1.0 - EDGE)
    numbers = np.column_stack([of(spread[:, i]) for i, (_, of) in enumerate(usable)])
    found = Samples(tuple(column for column, _ in usable), numbers)
    _check_ends(study, levels, found)
    return found


def check_scipy() -> None:
    """Raise ShipcosimError where SciPy is missing."""
    try:
        import scipy  # noqa: F401
    except ImportError:
        remedy = "Install it: pip install 'shipcosim[sweep]'."
        raise ShipcosimError(Problem("sample", "Samples come from SciPy, which is missing.", remedy)) from None


def _quantiles(
    study: Study, levels: Levels, system: System, name: str, one: Distribution
) -> tuple[SampledColumn, Callable[[np.ndarray], np.ndarray]] | None:
    """Column of a line of [sample.of], and its values by their probabilities; None where something is wrong."""
    keys, signals = ("sample", "of", name), levels.signals_of(name)
    try:
        component, variable = system.split(signals[0])
        for other in signals[1:]:
            system.split(other)
        unit = units_of(system)(signals[0])
        scale, shift = _conversion(one.unit, unit)
        of = _with_tolerance(system, signals[0]) if one.tolerance else _distribution(one)
    except UnitError as error:
        levels.problems.append(problem_of(study, keys, error.found, error.remedy))
    except ShipcosimError as error:
        levels.problems += [problem_of(study, keys, problem.found, problem.remedy) for problem in error.problems]
    else:
        kind = "Real" if component is None else system.components[component].fmu.variables[variable].kind
        is_whole = kind == "Integer"
        column = SampledColumn(one.name or name, tuple(signals), unit.name if unit else None, is_whole, one.at_fork)
        return column, lambda shares: scale * of(shares) + shift
    return None


def _conversion(spelling: str | None, unit: Any) -> tuple[float, float]:
    """Factor and offset from a unit to that of a signal."""
    if spelling is None:
        return 1.0, 0.0
    zero, one = (number_in(f"{value} {spelling}", unit) for value in (0.0, 1.0))
    return one - zero, zero


def _distribution(one: Distribution) -> Callable[[np.ndarray], np.ndarray]:
    """Quantiles of a distribution of scipy.stats."""
    from scipy import stats

    kinds = stats.rv_continuous, stats.rv_discrete
    known = [name for name in dir(stats) if isinstance(getattr(stats, name), kinds)]
    if one.distribution not in known:
        found = f"scipy.stats has no distribution '{one.distribution}'."
        raise ShipcosimError(Problem("", found, suggestion(str(one.distribution), known)))
    distribution = getattr(stats, str(one.distribution))
    needed = (distribution.shapes or "").replace(",", " ").split()
    allowed = [*needed, "loc"] + ([] if isinstance(distribution, stats.rv_discrete) else ["scale"])
    if unknown := [name for name in one.shape if name not in allowed]:
        raise ShipcosimError(Problem("", f"unknown key '{unknown[0]}'.", suggestion(unknown[0], allowed)))
    if missing := [name for name in needed if name not in one.shape]:
        found = f"'{missing[0]}' is missing."
        raise ShipcosimError(Problem("", found, f"{one.distribution} has: {', '.join(allowed)}."))
    if not np.isfinite(distribution.ppf([EDGE, 0.5, 1.0 - EDGE], **one.shape)).all():
        found = f"{one.distribution} with {', '.join(f'{n} = {v:g}' for n, v in one.shape.items()) or 'no numbers'}."
        raise ShipcosimError(Problem("", found, "These numbers make no distribution, or one without finite values."))
    return lambda shares: distribution.ppf(shares, **one.shape)


def _with_tolerance(system: System, signal: str) -> Callable[[np.ndarray], np.ndarray]:
    """Quantiles of the normal distribution about the start value, with the tolerance that goes with it."""
    from scipy.stats import norm

    component, name = system.split(signal)
    tolerances = {} if component is None else system.components[component].tolerances
    if name not in tolerances:
        known = [f"{c.name}.{n}" for c in system.components.values() for n in c.tolerances]
        found = f"No parameter set states a tolerance of {signal}."
        raise ShipcosimError(Problem("", found, suggestion(signal, known)))
    return lambda shares: norm.ppf(shares, loc=start_value(system, signal), scale=tolerances[name])


def _check_ends(study: Study, levels: Levels, found: Samples) -> None:
    """Check the least and the largest value of each column against bounds and types."""
    for i, (name, column) in enumerate(zip(study.sample.of if study.sample else (), found.columns, strict=True)):
        for row in (int(np.argmin(found.numbers[:, i])), int(np.argmax(found.numbers[:, i]))):
            value, keys = found.values(row)[i], ("sample", "of", name)
            if column.at_fork:
                levels.at_fork(column.signals, value, keys)
            else:
                levels.checked(dict.fromkeys(column.signals, value), keys)


def _sobol(sample: Sample, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a number of runs that is no power of two: less even, not wrong
        return qmc.Sobol(len(sample.of), rng=seed).random(sample.runs)


def _latin_hypercube(sample: Sample, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    return qmc.LatinHypercube(len(sample.of), rng=seed).random(sample.runs)


def _random(sample: Sample, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((sample.runs, len(sample.of)))


def _saltelli(sample: Sample, seed: int) -> np.ndarray:
    """Saltelli's design for Sobol indices of first order and in total: runs (parameters + 2) samples."""
    try:
        from SALib.sample import sobol
    except ImportError:
        remedy = "Install it: pip install 'shipcosim[sweep]'."
        raise ShipcosimError(Problem("sample.method", "saltelli comes from SALib, which is missing.", remedy)) from None
    names = list(sample.of)
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sobol.sample(problem, sample.runs, calc_second_order=False, seed=seed)


SPREADS: dict[str, Callable[[Sample, int], np.ndarray]] = {
    "sobol": _sobol,
    "latin_hypercube": _latin_hypercube,
    "random": _random,
    "saltelli": _saltelli,
}
"""Points in the unit cube, (samples, parameters), of (sample, seed)."""
