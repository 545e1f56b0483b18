"""Samples: values drawn at random, or spread evenly, over distributions of scipy.stats."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.errors import ShipcosimError, error_at, imported, suggestion
from shipcosim.scenario import units_of
from shipcosim.sweep.levels import Levels
from shipcosim.sweep.study_model import Distribution, Sample, Study
from shipcosim.units import UnitError, number_in

if TYPE_CHECKING:
    from shipcosim.ssp import System

EVERY = ".*"
"""Ends the name of all parameters of a component with a tolerance."""
EDGE = 2.0**-53
"""Smallest probability of a sample, so that an unbounded distribution gives finite numbers."""


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
        In the units of the signals; NaN where a search has not proposed them yet.
    bounds : (columns, 3) array or None
        Of a search: least, largest and present value.
    library : str
        Version of the library on which the proposals of a search depend.
    """

    columns: tuple[SampledColumn, ...]
    numbers: np.ndarray
    bounds: np.ndarray | None = None
    library: str = ""

    @property
    def facts(self) -> Any:
        """Everything that the values depend on, beside the study."""
        return (
            self.numbers.tolist() if self.bounds is None else [self.bounds.tolist(), self.library]
        )

    def values(self, number: int) -> list[float | int]:
        """Values of a sample, in the order of the columns.

        Raises
        ------
        ShipcosimError
            If it has not been proposed yet.
        """
        row = self.numbers[number].tolist()
        if any(map(isnan, row)):
            raise error_at(
                f"trial {number}",
                "It has not been proposed yet.",
                "Run the study so far: each generation follows from the one before.",
            )
        return [
            round(v) if column.is_whole else v for v, column in zip(row, self.columns, strict=True)
        ]


def samples_of(study: Study, levels: Levels, system: System) -> Samples | None:
    """Samples of a study, or None. Problems go to `levels`.

    Raises
    ------
    ShipcosimError
        If a library is missing.
    """
    sample = study.sample
    if sample is None:
        return None
    with imported("sample", "Samples come from SciPy, which is missing."):
        import scipy  # noqa: F401
    lines = [
        line
        for key, distribution in sample.of.items()
        for line in _lines(sample, levels, system, key, distribution)
    ]
    # Each column maps probabilities to values (inverse transform sampling).
    quantiles = [_quantiles(levels, system, *line) for line in lines]
    usable = [quantile for quantile in quantiles if quantile is not None]
    if len(usable) < len(quantiles) or not usable:
        return None
    # Points in the unit cube, by the chosen method; kept off 0 and 1, where a normal distribution
    # is infinite.
    spread = np.clip(_spread(sample.method, sample.runs, len(usable), study.seed), EDGE, 1.0 - EDGE)
    numbers = np.column_stack([of(spread[:, i]) for i, (_, of) in enumerate(usable)])
    samples = Samples(tuple(column for column, _ in usable), numbers)
    # Only the extremes can break a bound.
    _check_ends(levels, samples, [key for key, _, _ in lines])
    return samples


def _lines(
    sample: Sample, levels: Levels, system: System, key: str, distribution: Distribution
) -> Iterator[tuple[str, str, Distribution]]:
    """Key, name and distribution of each column of a line; ``vessel.*`` gives one per tolerance."""
    if not key.endswith(EVERY):
        yield key, key, distribution
        return
    keys = ("sample", "of", key)
    group = key.removesuffix(EVERY)
    if not distribution.tolerance or distribution.name or distribution.also:
        levels.complain(
            keys,
            f"'{key}' stands for each parameter with a tolerance.",
            "It takes tolerance = true, and neither name nor also.",
        )
        return
    # All parameters with a tolerance, except those that have a line of their own.
    component = system.components.get(levels.signals_of(key)[0].removesuffix(EVERY))
    names = [f"{group}.{name}" for name in component.tolerances] if component else []
    if not names:
        of_tolerances = [f"{c.name}{EVERY}" for c in system.components.values() if c.tolerances]
        levels.complain(
            keys, f"No parameter set states a tolerance of {key}.", suggestion(key, of_tolerances)
        )
    in_lines = {
        signal
        for line, each in sample.of.items()
        for name in (line, *each.also)
        for signal in levels.signals_of(name)
    }
    yield from (
        (key, name, distribution) for name in names if in_lines.isdisjoint(levels.signals_of(name))
    )


def _quantiles(
    levels: Levels, system: System, key: str, name: str, stated: Distribution
) -> tuple[SampledColumn, Callable[[np.ndarray], np.ndarray]] | None:
    """A column of samples, and its quantile function; None with a problem."""
    keys = "sample", "of", key
    signals = [signal for each in (name, *stated.also) for signal in levels.signals_of(each)]
    # Samples are drawn in their own unit and converted linearly to that of the signal.
    try:
        component, variable = system.split(signals[0])
        for other in signals[1:]:
            system.split(other)
        unit = units_of(system)(signals[0])
        scale, shift = _conversion(stated.unit, unit)
        of = _with_tolerance(system, signals[0]) if stated.tolerance else _distribution(stated)
    except UnitError as error:
        levels.complain(keys, error.found, error.remedy)
    except ShipcosimError as error:
        for problem in error.problems:
            levels.complain(keys, problem.found, problem.remedy)
    else:
        kind = (
            "Real" if component is None else system.components[component].variables[variable].kind
        )
        is_whole = kind == "Integer"
        column = SampledColumn(
            stated.name or name,
            tuple(signals),
            unit.name if unit else None,
            is_whole,
            stated.at_fork,
        )
        return column, lambda shares: scale * of(shares) + shift
    return None


def _conversion(spelling: str | None, unit: Any) -> tuple[float, float]:
    """Factor and offset from a unit to that of a signal."""
    if spelling is None:
        return 1.0, 0.0
    # Two values determine the linear conversion.
    zero, unity = (number_in(f"{value} {spelling}", unit) for value in (0.0, 1.0))
    return unity - zero, zero


def _distribution(stated: Distribution) -> Callable[[np.ndarray], np.ndarray]:
    """Quantile function of a distribution of scipy.stats."""
    from scipy import stats

    kinds = stats.rv_continuous, stats.rv_discrete
    # Check name and shape parameters here: scipy's own errors do not name the line.
    names_of_scipy = [name for name in dir(stats) if isinstance(getattr(stats, name), kinds)]
    if stated.distribution not in names_of_scipy:
        raise error_at(
            "",
            f"scipy.stats has no distribution '{stated.distribution}'.",
            suggestion(str(stated.distribution), names_of_scipy),
        )
    distribution = getattr(stats, str(stated.distribution))
    needed = (distribution.shapes or "").replace(",", " ").split()
    allowed = [*needed, "loc"] + ([] if isinstance(distribution, stats.rv_discrete) else ["scale"])
    if unknown := [name for name in stated.shape if name not in allowed]:
        raise error_at("", f"unknown key '{unknown[0]}'.", suggestion(unknown[0], allowed))
    if missing := [name for name in needed if name not in stated.shape]:
        raise error_at(
            "", f"'{missing[0]}' is missing.", f"{stated.distribution} has: {', '.join(allowed)}."
        )
    # Wrong parameters show as values that are not finite.
    if not np.isfinite(distribution.ppf([EDGE, 0.5, 1.0 - EDGE], **stated.shape)).all():
        numbers = ", ".join(f"{name} = {value:g}" for name, value in stated.shape.items())
        raise error_at(
            "",
            f"{stated.distribution} with {numbers or 'no numbers'}.",
            "These numbers make no distribution, or one without finite values.",
        )
    return lambda shares: distribution.ppf(shares, **stated.shape)


def _with_tolerance(system: System, signal: str) -> Callable[[np.ndarray], np.ndarray]:
    """Quantile function of the normal distribution about the start value, with its tolerance."""
    from scipy.stats import norm

    component, name = system.split(signal)
    tolerances = {} if component is None else system.components[component].tolerances
    if name not in tolerances:
        with_tolerance = [f"{c.name}.{n}" for c in system.components.values() for n in c.tolerances]
        raise error_at(
            "",
            f"No parameter set states a tolerance of {signal}.",
            suggestion(signal, with_tolerance),
        )
    return lambda shares: norm.ppf(
        shares, loc=system.start_value(component, name), scale=tolerances[name]
    )


def _check_ends(levels: Levels, samples: Samples, lines: Sequence[str]) -> None:
    """Check the extremes of each column against bounds and types."""
    for i, (key, column) in enumerate(zip(lines, samples.columns, strict=True)):
        for row in (int(np.argmin(samples.numbers[:, i])), int(np.argmax(samples.numbers[:, i]))):
            value = samples.values(row)[i]
            keys = ("sample", "of", key)
            if column.at_fork:
                levels.at_fork(column.signals, value, keys)
            else:
                levels.checked(dict.fromkeys(column.signals, value), keys)


def _spread(method: str, runs: int, parameters: int, seed: int) -> np.ndarray:
    """Points in the unit cube, (samples, parameters).

    References
    ----------
    Saltelli et al., Variance based sensitivity analysis of model output, Comput. Phys. Commun. 181, 2010: blocks of
    parameters + 2 samples for first-order and total Sobol indices.
    """
    from scipy.stats import qmc

    if method == "random":
        return np.random.default_rng(seed).random((runs, parameters))
    with warnings.catch_warnings():
        # Of a number of runs that is no power of two: less even, not wrong.
        warnings.simplefilter("ignore")
        if method == "saltelli":
            with imported("sample.method", "saltelli comes from SALib, which is missing."):
                from SALib.sample import sobol
            problem = salib_problem(parameters)
            return sobol.sample(problem, runs, calc_second_order=False, seed=seed)
        design = qmc.Sobol if method == "sobol" else qmc.LatinHypercube
        return design(parameters, rng=seed).random(runs)


def salib_problem(parameters: int) -> dict[str, Any]:
    """Parameters of the unit cube in SALib's form."""
    names = [str(number) for number in range(parameters)]
    return {"num_vars": parameters, "names": names, "bounds": [[0.0, 1.0]] * parameters}
