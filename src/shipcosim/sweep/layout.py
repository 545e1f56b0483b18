"""Make the plan of a study, checked with its scenario and system; problems name the line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from shipcosim import library
from shipcosim.cosim import system_of
from shipcosim.errors import Problem, ShipcosimError, raise_errors, suggestion
from shipcosim.scenario import (
    Scenario,
    check_files,
    check_scenario,
    read_scenario,
    time_complaints,
)
from shipcosim.scenario.locations import Keys
from shipcosim.ssp import System, settings_for, with_values
from shipcosim.ssp.flatten.swapped import WHERE
from shipcosim.sweep.levels import Level, Levels
from shipcosim.sweep.plan import Plan, Swapped
from shipcosim.sweep.quantities import measures_of
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.sampling import Samples, samples_of
from shipcosim.sweep.study_model import Study
from shipcosim.sweep.tuning import ranges_of
from shipcosim.units import whole_steps


def plan_of(study: Study, settings: Mapping[str, Any] | None = None, *, build: bool = True) -> Plan:
    """Lay out the runs of a study, checked with its system.

    Parameters
    ----------
    study : Study
    settings : mapping of str to value, optional
        Start values over those that all runs have.
    build : bool
        Build FMUs that are missing or out of date, which runs their source.

    Raises
    ------
    ShipcosimError
        With everything that does not fit together.
    """
    # The scenario with the study's own times, then the system with the study's components.
    scenario, planned = _scenario(study)
    read = _system(
        study,
        scenario,
        study.components,
        {name: ("components", name) for name in study.components},
        build,
    )
    components = scenario.components | {
        name: str(_in_study_folder(study, fmu) or fmu) for name, fmu in study.components.items()
    }
    system = with_values(read, scenario.set, str(scenario.path))
    # First check what all runs share; the levels of the factors build on it.
    levels = Levels(study, scenario, system)
    levels.check_names()
    # The order is that of precedence: parameter sets, then `set`, then the settings of the call.
    fitted = [levels.fitting(name, ("parameters",)) for name in study.parameters]
    values = {signal: value for start_values in fitted for signal, value in start_values.items()}
    values |= levels.checked(study.set, ("set",)) | settings_for(read, settings or {})
    events = [levels.event(event) for event in study.events]
    levels.check_events(events, ("events",))
    raise_errors(levels.problems)
    # Shared values and events go into the scenario, so that each run holds only what is its own.
    changed = {
        "components": components,
        "set": scenario.set | values,
        "events": [*scenario.events, *events],
    }
    scenario = scenario.model_copy(update=changed)
    system = with_values(system, values, "--set")
    # Now the factors, with the system as all runs see it.
    levels = Levels(study, scenario, system)
    factors = [levels.of(number) for number in range(len(study.factor))]
    samples = ranges_of(study, levels, system) if study.tune else samples_of(study, levels, system)
    # Quantities may name signals that only events of some level change.
    happening = [
        event for factor_levels in factors for level in factor_levels for event in level.events
    ]
    measures, problems = measures_of(study, scenario, system, happening, planned)
    problems = [*levels.problems, *problems, *_of_names(study), *_of_fork(study, scenario)]
    problems += _of_replaced(study, factors, samples)
    problems += [problem for problem in check_scenario(scenario, system) if problem.is_error]
    raise_errors(problems)
    # One checked system for each combination of swapped FMUs.
    systems = {
        swapped: _swapped(study, scenario, swapped, system, build)
        for swapped in _combinations(factors)
    }
    return Plan(study, scenario, systems, factors, measures, samples, planned)


def _scenario(study: Study) -> tuple[Scenario, float]:
    """The scenario that all runs share, and the stop time of its file. [s]"""
    try:
        path = study.scenario_path
    except ShipcosimError as error:
        message = f"There is no scenario '{study.scenario}'."
        raise ShipcosimError(
            problem_of(study, ("scenario",), message, error.problems[0].remedy)
        ) from None
    scenario = read_scenario(path)
    # Times of the study replace those of the scenario; a wrong one is reported at the study's line.
    times = {name: getattr(study, name) for name in ("stop_time", "step_size", "output_interval")}
    changed = {name: time for name, time in times.items() if time is not None}
    planned = scenario.stop_time
    scenario = scenario.model_copy(update=changed)
    raise_errors(check_files(scenario))
    if wrong := [complaint for complaint in time_complaints(scenario) if complaint[-1] == "error"]:
        keys = [keys if keys[0] in changed else tuple(changed)[:1] for keys, *_ in wrong]
        raise ShipcosimError(
            [problem_of(study, at, *one[1:3]) for at, one in zip(keys, wrong, strict=True)]
        )
    return scenario, planned


def _system(
    study: Study,
    scenario: Scenario,
    components: Mapping[str, str],
    keys: Mapping[str, Keys],
    build: bool,
) -> System:
    """A scenario's system with swapped FMUs; `keys` are the places that name them in the study."""
    problems = []
    paths = {}
    # An FMU lies beside the study or is known by name.
    for name, fmu in components.items():
        try:
            paths[name] = _in_study_folder(study, fmu) or library.find(
                "fmu", fmu, near=study.folder, build=build
            )
        except ShipcosimError as error:
            message = f"There is no FMU '{fmu}', by this name or beside the study."
            problems.append(problem_of(study, keys[name], message, error.problems[0].remedy))
    raise_errors(problems)
    try:
        return system_of(scenario, components=paths, build=build)
    # Problems with swapped FMUs are reported at their line in the study.
    except ShipcosimError as error:
        at = {f"{WHERE}, {name}": place for name, place in keys.items()}
        located = [
            problem_of(study, at[p.where], p.found, p.remedy) if p.where in at else p
            for p in error.problems
        ]
        raise ShipcosimError(located) from None


def _swapped(
    study: Study, scenario: Scenario, swapped: Swapped, system: System, build: bool
) -> System:
    """The system with the FMUs that some runs swap in."""
    if not swapped:
        return system
    # Find the cases that name these FMUs, for the line in messages.
    cases = [
        (("factor", i, "case", j, "components"), case)
        for i, factor in enumerate(study.factor)
        for j, case in enumerate(factor.case or ())
    ]
    keys = {
        name: (*place, name)
        for place, case in cases
        for name, fmu in case.components.items()
        if (name, fmu) in swapped
    }
    return with_values(
        _system(study, scenario, dict(swapped), keys, build), scenario.set, str(study.path)
    )


def _combinations(levels: Sequence[Sequence[Level]]) -> list[Swapped]:
    """Combinations of swapped components that runs have, the empty one first."""
    # Every level of a factor may meet every level of the others.
    per_factor = [list({tuple(level.components.items()) for level in one}) for one in levels]
    sets = {
        tuple(sorted(dict(pair for part in parts for pair in part).items()))
        for parts in product(*per_factor)
    }
    return sorted(sets, key=lambda entry: (len(entry), entry))


def _in_study_folder(study: Study, fmu: str) -> Path | None:
    """Path of an FMU beside the study; None if it is a name."""
    path = study.folder / fmu
    return path if path.is_file() else None


def _of_fork(study: Study, scenario: Scenario) -> Iterator[Problem]:
    """Problems of a fork: missing, or at a time that no run has."""
    waiting = [("factor", i, "at_fork") for i, factor in enumerate(study.factor) if factor.at_fork]
    sampled = study.sample.of if study.sample else {}
    waiting += [
        ("sample", "of", name, "at_fork")
        for name, distribution in sampled.items()
        if distribution.at_fork
    ]
    if study.fork_at is None:
        for keys in waiting:
            yield problem_of(
                study, keys, "The study has no fork.", 'Give its time: fork_at = "300 s".'
            )
        return
    # The fork is an event, so it must fall on a step before the end.
    count = whole_steps(study.fork_at, scenario.step_size)
    if count is None or study.fork_at >= scenario.stop_time:
        step = scenario.step_size
        stop = scenario.stop_time
        yield problem_of(
            study,
            ("fork_at",),
            f"fork_at = {study.fork_at:g} s.",
            f"It is a multiple of the step size, {step:g} s, before the end at {stop:g} s.",
        )


def _of_replaced(
    study: Study, factors: Sequence[Sequence[Level]], samples: Samples | None
) -> Iterator[Problem]:
    """Problems of factors without effect: later ones replace every value of them."""
    # From the last factor to the first: what is set in all runs by something later.
    sampled = () if samples is None else samples.columns
    replaced_by = {
        signal: column.name for column in sampled if not column.at_fork for signal in column.signals
    }
    for number in reversed(range(len(factors))):
        levels = factors[number]
        name = study.factor[number].name
        varied = {signal for level in levels for signal in level.values}
        does_more = any(level.events or level.components or level.stop_time for level in levels)
        if varied and varied <= replaced_by.keys() and not does_more:
            signal = min(varied)
            yield problem_of(
                study,
                ("factor", number),
                f"'{replaced_by[signal]}' sets {signal} too, so '{name}' changes nothing.",
                "Keep one of them.",
            )
        # A signal that only some levels set keeps its earlier value in the runs of the others.
        in_all = set.intersection(*(set(level.values) for level in levels)) if levels else set()
        replaced_by |= dict.fromkeys(in_all, name)


def _of_names(study: Study) -> Iterator[Problem]:
    """Problems of summaries and objectives that name unknown quantities or factors."""
    quantities = [quantity.name for quantity in study.quantity]
    factors = [factor.name for factor in study.factor]
    factors += ["sample"] if study.sample or study.tune else []
    # Where a name stands, what it means, and the names that there are.
    places: list[tuple[Keys, str, str, list[str]]] = []
    for number, summary in enumerate(study.summary):
        keys = ("summary", number)
        places.append(((*keys, "quantity"), "quantity", summary.quantity, quantities))
        places += [((*keys, "over"), "factor", name, factors) for name in summary.over]
        if summary.along:
            places.append(((*keys, "along"), "factor", summary.along, factors))
    for number, objective in enumerate(study.tune.objective if study.tune else ()):
        keys = ("tune", "objective", number, "quantity")
        places.append((keys, "quantity", objective.quantity, quantities))
    for keys, kind, name, names in places:
        if name not in names:
            message = f"There is no {kind} '{name}'."
            yield problem_of(study, keys, message, suggestion(name, names))
