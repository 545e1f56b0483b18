"""Search for Pareto-optimal parameters: Optuna's NSGA-II, one generation at a time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.errors import imported
from shipcosim.scenario import units_of
from shipcosim.sweep.levels import Levels
from shipcosim.sweep.plan import Plan
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.sampling import SampledColumn, Samples
from shipcosim.sweep.study_model import Objective, Range, Study

if TYPE_CHECKING:
    import pandas

    from shipcosim.ssp import System

STATISTICS = {"mean": np.mean, "maximum": np.max, "minimum": np.min}


def ranges_of(study: Study, levels: Levels, system: System) -> Samples | None:
    """Samples of a search, none proposed yet; None with a problem.

    Parameters
    ----------
    study : Study
        With [tune].
    levels : Levels
        Whose problems take what is wrong.
    system : System
        Of all runs: its start values are the first trial.

    Raises
    ------
    ShipcosimError
        If Optuna is missing.
    """
    assert study.tune is not None
    with imported("tune", "The search comes from Optuna, which is missing."):
        import optuna
    made = [_range(study, levels, system, key, bounds) for key, bounds in study.tune.of.items()]
    usable = [bounds for bounds in made if bounds is not None]
    if len(usable) < len(made):
        return None
    columns, bounds = zip(*usable, strict=True)
    # All trials are reserved as NaN; each generation fills its own.
    numbers = np.full((study.tune.trials, len(columns)), np.nan)
    # Proposals depend on the version of Optuna, too.
    return Samples(columns, numbers, np.array(bounds), optuna.__version__)


def _range(
    study: Study, levels: Levels, system: System, key: str, bounds: Range
) -> tuple[SampledColumn, tuple[float, float, float]] | None:
    """Column of a line of [tune.of]: lowest, highest, present value; None with a problem."""
    signals = levels.existing([key], ("tune", "of", key))
    ends = {}
    others = levels.existing(bounds.also, ("tune", "of", key, "also"))
    if not signals:
        return None
    # Check both ends against bounds and types; values between them then fit too.
    for end, value in (("low", bounds.low), ("high", bounds.high)):
        checked = levels.checked(dict.fromkeys(signals, value), ("tune", "of", key, end))
        ends[end] = next(iter(checked.values()), None)
        levels.checked(dict.fromkeys(others, value), ("tune", "of", key, "also"))
    if None in ends.values():
        return None
    present = system.start_value(*system.split(signals[0]))
    low, high, now = (float(value) for value in (ends["low"], ends["high"], present))
    # A logarithmic range needs positive numbers, and the present value starts the search.
    if not low < high or (bounds.log and low <= 0.0):
        message = f"low = {low:g} and high = {high:g}."
        remedy = "low is the smaller one, and with log above 0."
    elif not low <= now <= high:
        message = f"{signals[0]} is {now:g} now, which is not among them."
        remedy = "Take a range that has it in."
    else:
        unit = units_of(system)(signals[0])
        is_whole = isinstance(present, int)
        column = SampledColumn(
            bounds.name or key, (*signals, *others), unit.name if unit else None, is_whole, False
        )
        return column, (low, high, now)
    levels.problems.append(problem_of(study, ("tune", "of", key), message, remedy))
    return None


class Search:
    """A search: propose a generation, take its results, propose the next.

    It follows from the study's seed and from what it is told, so that one that is told again what is on disk goes on
    as if it had not stopped.

    Parameters
    ----------
    plan : Plan
        With [tune]; its samples are filled in as they are proposed.
    """

    def __init__(self, plan: Plan):
        import optuna
        from optuna.distributions import FloatDistribution, IntDistribution

        assert (
            plan.study.tune is not None
            and plan.samples is not None
            and plan.samples.bounds is not None
        )
        self._plan = plan
        self._tune = plan.study.tune
        self._samples = plan.samples
        # Whole numbers stay whole in the proposals.
        self._among: dict[str, Any] = {}
        now = {}
        ranges = zip(plan.samples.columns, plan.samples.bounds.tolist(), strict=True)
        for (column, (low, high, value)), bounds in zip(
            ranges, self._tune.of.values(), strict=True
        ):
            kind = IntDistribution if column.is_whole else FloatDistribution
            self._among[column.name] = kind(low, high, log=bounds.log)
            now[column.name] = round(value) if column.is_whole else value
        # The seed makes the search reproducible.
        sampler = optuna.samplers.NSGAIISampler(
            population_size=self._tune.population, seed=plan.study.seed
        )
        verbosity = optuna.logging.get_verbosity()
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        try:
            spelling: Any = {"maximise": "maximize", "minimise": "minimize"}
            directions = [spelling[objective.direction] for objective in self._tune.objective]
            self._search = optuna.create_study(directions=directions, sampler=sampler)
        finally:
            optuna.logging.set_verbosity(verbosity)
        # The first trial has the present values, so that the result shows what is gained.
        self._search.enqueue_trial(now)

    def generations(self) -> Iterator[range]:
        """Trial numbers of each generation, proposed; its results must be told before the next."""
        size = self._tune.population
        trials = self._tune.trials
        for first in range(0, trials, size):
            numbers = range(first, min(first + size, trials))
            self._asked = [self._search.ask(self._among) for _ in numbers]
            for number, trial in zip(numbers, self._asked, strict=True):
                self._samples.numbers[number] = [trial.params[name] for name in self._among]
            yield numbers

    def tell(self, runs: Any) -> None:
        """Take the results of a generation.

        Parameters
        ----------
        runs : DataFrame
            Runs that are done, with `run`, `error` and quantities. A trial of which one failed, or has no value, is
            worse than any other.
        """
        # A trial's runs are those of its sample, over all levels of the other factors.
        for trial in self._asked:
            samples_of = np.unravel_index(runs["run"].to_numpy(int), self._plan.shape)[-1]
            # A failed trial gets the worst possible values, so that it has no offspring.
            objectives = _objectives(self._tune.objective, runs[samples_of == trial.number])
            worst = [
                -np.inf if objective.direction == "maximise" else np.inf
                for objective in self._tune.objective
            ]
            self._search.tell(trial, worst if objectives is None else objectives)

    def table(self, runs: Any) -> pandas.DataFrame:
        """Trials that are done.

        Parameters
        ----------
        runs : DataFrame
            The table of runs.

        Returns
        -------
        DataFrame
            `trial`, `generation`, parameters, quantities over the runs of the trial (as the objective says, else the
            mean), `runs`, `failed`; `pareto`: no other trial beats it in all objectives; `as_shipped`: the first one.
        """
        import pandas

        # Quantities are summed up as their objective does, others by their mean.
        statistics = {
            objective.quantity: STATISTICS[objective.statistic]
            for objective in self._tune.objective
        }
        best = {trial.number for trial in self._search.best_trials}
        rows = []
        for number, part in runs.groupby("sample", sort=True):
            sound = part[part["error"] == ""]
            row = {"trial": number, "generation": number // self._tune.population}
            row |= dict(zip(self._among, self._samples.numbers[number].tolist(), strict=True))
            for measure in self._plan.measures:
                values = sound[measure.name].to_numpy(float)
                is_whole = len(sound) == len(part) and np.isfinite(values).all()
                row[measure.name] = (
                    float(statistics.get(measure.name, np.mean)(values)) if is_whole else np.nan
                )
            # A trial with missing runs cannot be called optimal.
            is_best = number in best and not any(np.isnan(row[name]) for name in statistics)
            row |= {
                "runs": len(part),
                "failed": len(part) - len(sound),
                "pareto": is_best,
                "as_shipped": number == 0,
            }
            rows.append(row)
        return pandas.DataFrame(rows)


def _objectives(objectives: list[Objective], runs: Any) -> list[float] | None:
    """Objectives of a trial; None if a run failed or has no value."""
    if (runs["error"] != "").any():
        return None
    found = [
        float(STATISTICS[objective.statistic](runs[objective.quantity].to_numpy(float)))
        for objective in objectives
    ]
    return found if np.isfinite(found).all() else None
