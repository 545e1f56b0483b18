"""Several logs of one ship as one identification problem: her numbers are common, the weather is each log's own.

Each log keeps its own noise, and is linearised about its own motion. A number of the ship has one column, in which the
inner products of the logs add up; a number of the day has one for each log.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from shipcosim.diagnose.hypotheses.catalogue import Hypothesis
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.linearisation import Regressor

_SEPARATOR = "|"


def is_of_day(hypothesis: Hypothesis) -> bool:
    """Whether a cause is in the weather of one day: all its numbers are the water's.

    An instrument that is wrong, unlike what it is off within its tolerance, is wrong in all logs.
    """
    return all(path.startswith("water.") for path in hypothesis.paths)


def of_log(hypothesis: Hypothesis, name: str) -> Hypothesis:
    """A cause of the day for one log: the log's name is its component and the prefix of its numbers."""
    parameters = (
        replace(parameter, paths=tuple(f"{name}{_SEPARATOR}{path}" for path in parameter.paths))
        for parameter in hypothesis.parameters
    )
    sought = [f"{name}{_SEPARATOR}{path}" for path in hypothesis.definition.sought_by]
    definition = hypothesis.definition.model_copy(update={"sought_by": sought})
    return replace(hypothesis, definition=definition, component=name, parameters=tuple(parameters))


def is_in_one_log(hypothesis: Hypothesis) -> bool:
    """Whether a cause is of the day of one log, as `of_log` makes it."""
    return all(_SEPARATOR in path for path in hypothesis.paths)


@dataclass(frozen=True, eq=False)
class SeveralLogs:
    """Identification problems of several logs of one ship.

    Attributes
    ----------
    problems : dict of str to IdentificationProblem
        By name of the log.
    is_well : bool
        Whether nothing is wrong with the ship: only causes of the day are looked for.
    """

    problems: dict[str, IdentificationProblem]
    is_well: bool = False

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """Causes in the ship once, those of the day for each log."""
        # Causes in the ship are the same hypothesis in all
        # logs; those of the day exist once for each log.
        ship = {}
        day = []
        for name, problem in self.problems.items():
            for hypothesis in problem.hypotheses:
                if is_of_day(hypothesis):
                    day.append(of_log(hypothesis, name))
                elif not self.is_well:
                    ship.setdefault(hypothesis.label, hypothesis)
        return (*ship.values(), *day)

    def within(self, name: str, hypothesis: Hypothesis) -> Hypothesis | None:
        """A cause in the problem of one log; None if that log cannot show it."""
        # A cause of the day exists in its own log only, and there without the log's name.
        component = hypothesis.component
        if is_in_one_log(hypothesis):
            if component != name:
                return None
            component = None
        wanted = hypothesis.cause, component
        return next(
            (
                hypothesis
                for hypothesis in self.problems[name].hypotheses
                if (hypothesis.cause, hypothesis.component) == wanted
            ),
            None,
        )

    def all_within(
        self, name: str, hypotheses: Sequence[Hypothesis]
    ) -> list[tuple[Hypothesis, Hypothesis]]:
        """Causes that one log can show, each as it is in that log."""
        pairs = ((hypothesis, self.within(name, hypothesis)) for hypothesis in hypotheses)
        return [(hypothesis, in_log) for hypothesis, in_log in pairs if in_log is not None]


def values_in(name: str, values: Mapping[str, float]) -> dict[str, float]:
    """Numbers for one log: those of the ship, and those of the log's own day."""
    in_log = {}
    # Numbers with the prefix of another log are left out, the own prefix is removed.
    for path, value in values.items():
        owner, separator, number = path.rpartition(_SEPARATOR)
        if not separator or owner == name:
            in_log[number if separator else path] = value
    return in_log


@dataclass(frozen=True)
class Layout:
    """Columns of several logs in one row.

    Attributes
    ----------
    regressors : list of p Regressor
    places : dict of str to array of int
        By name of the log: where its columns are in the row.
    """

    regressors: list[Regressor]
    places: dict[str, np.ndarray]

    @property
    def prior(self) -> np.ndarray:
        """Standard deviations of the columns' θ."""
        return np.array([column.prior for column in self.regressors])

    def spread(self, name: str, products: np.ndarray) -> np.ndarray:
        """Inner products of one log, (..., 1 + p_i, 1 + p_i), its own column first, at their places among all."""
        # Row and column 0 belong to the log itself, the others move to their places in the layout.
        where = np.concatenate([[0], 1 + self.places[name]])
        size = 1 + len(self.regressors)
        spread = np.zeros((*products.shape[:-2], size, size))
        spread[..., where[:, None], where] = products
        return spread

    def together(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        """One value a column, (p,) array, from those of the logs; common columns have the same in all."""
        means = np.zeros(len(self.regressors))
        for name, of_log in values.items():
            means[self.places[name]] = of_log
        return means


def laid_out(
    of_ship: Mapping[str, Sequence[Regressor]],
    others: Sequence[tuple[str, Regressor]],
    named: Mapping[str, Sequence[str]],
) -> Layout:
    """Columns of several logs in one row: known numbers first, those of the ship common, then others by name.

    Parameters
    ----------
    of_ship : dict of str to sequence of Regressor
        By name of the log: its first columns.
    others : sequence of (str, Regressor)
        The columns behind them all, by name.
    named : dict of str to sequence of str
        By name of the log: which of these it has, in its own order.

    Returns
    -------
    Layout
    """
    # Known numbers of the ship are the same column in all logs, those of a day one for each.
    regressors: dict[object, Regressor] = {}
    for log, columns in of_ship.items():
        for column in columns:
            regressors.setdefault(_key(log, column), column)
    regressors |= dict(others)
    order = {key: place for place, key in enumerate(regressors)}
    # Place of each log's columns in the common order.
    keys = {
        log: [*(_key(log, column) for column in columns), *named[log]]
        for log, columns in of_ship.items()
    }
    return Layout(
        list(regressors.values()),
        {log: np.array([order[key] for key in log_keys], int) for log, log_keys in keys.items()},
    )


def _key(log: str, column: Regressor) -> object:
    """What tells columns of known numbers apart: those of the day by their log, too."""
    return (log, column.key) if column.is_of_day else column.key
