"""The runs of a study: laid out over its factors and samples, checked with the system, made one by one when needed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim import __version__, library
from shipcosim.cosim import system_of
from shipcosim.cosim.master.result import fingerprint, hashes, start_values
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import Event, Scenario, check_files, check_scenario, check_times, read_scenario, units_of
from shipcosim.scenario.model import Value
from shipcosim.ssp import System, with_values
from shipcosim.sweep.levels import Level, Levels
from shipcosim.sweep.quantities import Measure, measures_of
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.records import Study

Swapped = tuple[tuple[str, str], ...]
"""Components and the FMUs that they run in place of their own."""


@dataclass(frozen=True)
class PlannedRun:
    """A run: what it has of its own over what all have in common.

    Parameters
    ----------
    number : int
        In the plan.
    columns : mapping of str to value
        Of the table: levels of factors, sampled values.
    values : mapping of str to value
        Start values by signal.
    events : tuple of Event
        Beside those of all runs.
    swapped : tuple of (str, str)
        Components and the FMUs that they run in place of their own.
    stop_time : float or None
        Its own end. [s]
    """

    number: int
    columns: Mapping[str, Value]
    values: Mapping[str, Value]
    events: tuple[Event, ...] = ()
    swapped: Swapped = ()
    stop_time: float | None = None


@dataclass(frozen=True)
class ColumnOf:
    """What a column of the tables is."""

    name: str
    role: str
    unit: str | None = None
    description: str = ""
    labels: list[Value] | None = None


@dataclass(frozen=True)
class Plan:
    """All runs of a study.

    Parameters
    ----------
    study : Study
    scenario : Scenario
        What all runs have in common.
    systems : dict
        Checked systems with the start values of all runs, by the components that they swap.
    levels : list of list of Level
        Of each factor.
    measures : tuple of Measure
        What is kept of each run.
    """

    study: Study
    scenario: Scenario
    systems: Mapping[Swapped, System]
    levels: Sequence[Sequence[Level]]
    measures: tuple[Measure, ...] = field(default=())

    def __len__(self) -> int:
        return prod(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """How many levels each factor has; the last one changes fastest."""
        return tuple(len(levels) for levels in self.levels)

    @property
    def system(self) -> System:
        """The system of runs that swap nothing of their own."""
        return next(iter(self.systems.values()))

    def run(self, number: int) -> PlannedRun:
        """The run with a number."""
        places = np.unravel_index(number, self.shape) if self.shape else ()
        values: dict[str, Value] = {}
        columns: dict[str, Value] = {}
        events: list[Event] = []
        swapped: dict[str, str] = {}
        stop_time = None
        for factor, levels, place in zip(self.study.factor, self.levels, places, strict=True):
            level = levels[int(place)]
            columns[factor.name] = level.label
            values |= level.values
            events += level.events
            swapped |= level.components
            stop_time = level.stop_time if level.stop_time is not None else stop_time
        return PlannedRun(number, columns, values, tuple(events), tuple(sorted(swapped.items())), stop_time)

    def scenario_of(self, run: PlannedRun) -> Scenario:
        """The scenario of a run, without its start values."""
        if not run.events and run.stop_time is None:
            return self.scenario
        events = [*self.scenario.events, *run.events]
        stop_time = self.scenario.stop_time if run.stop_time is None else run.stop_time
        return self.scenario.model_copy(update={"events": events, "stop_time": stop_time})

    def alone(self, number: int) -> Scenario:
        """The scenario of a run with all that it has of its own, and what the scenario expects."""
        run = self.run(number)
        scenario = self.scenario_of(run)
        changed = {"set": {**scenario.set, **run.values}, "components": scenario.components | dict(run.swapped)}
        return scenario.model_copy(update=changed)

    def input_of(self, run: PlannedRun) -> dict[str, Any]:
        """The full input of a run, which is a scenario: ``shipcosim.run(Scenario(**input))`` runs it alone."""
        scenario = self.scenario_of(run)
        swapped = scenario.components | dict(run.swapped)
        found = {
            "system": self._named_system,
            "parameters": self._named_parameters,
            "components": {name: _portable(self.scenario, fmu) for name, fmu in swapped.items()},
            "set": {**scenario.set, **run.values},
            "events": [event.model_dump(exclude_defaults=True) for event in scenario.events],
            "stop_time": scenario.stop_time,
            "step_size": scenario.step_size,
            "output_interval": scenario.output_interval,
        }
        return {name: value for name, value in found.items() if value not in ({}, [], None)}

    @cached_property
    def columns(self) -> list[ColumnOf]:
        """Columns of the table of runs, but for its number, error and input."""
        unit_of = units_of(self.system)
        found = []
        for factor, levels in zip(self.study.factor, self.levels, strict=True):
            signals = list(levels[0].values) or [name for event in levels[0].events for name in event.override]
            unit = None if factor.case or factor.seeds else unit_of(signals[0])
            labels = [level.label for level in levels] if factor.case else None
            text = ", ".join(factor.signal)
            found.append(ColumnOf(factor.name, "factor", unit.name if unit else None, text, labels))
        return found + [ColumnOf(one.name, "quantity", one.unit, one.description) for one in self.measures]

    @cached_property
    def duration(self) -> float:
        """Simulated time of all runs. [s]"""
        ends = [self.scenario.stop_time]
        for levels in self.levels:
            own = [level.stop_time for level in levels]
            if any(end is not None for end in own):
                ends = [one if one is not None else end for end in ends for one in own]
            else:
                ends = [end for end in ends for _ in own]
        return float(sum(ends))

    def digest(self, engine: str) -> str:
        """Hash of all that the table of runs follows from."""
        ignored = {"description", "summary", "view"}
        of_systems = [
            (key, fingerprint(system), hashes(system), start_values(system)) for key, system in self.systems.items()
        ]
        of_inputs = {name: signal.start for name, signal in self.system.inputs.items()}
        facts = [
            __version__,
            engine,
            self.study.model_dump(exclude=ignored),
            self.scenario.model_dump(exclude={"description"}),
            [[level.__dict__ for level in levels] for levels in self.levels],
            of_systems,
            of_inputs,
        ]
        return hashlib.sha256(json.dumps(facts, default=_plain, sort_keys=True).encode()).hexdigest()

    @property
    def _named_system(self) -> str:
        return _portable(self.scenario, self.scenario.system, "system", self.scenario.system_path)

    @property
    def _named_parameters(self) -> list[str]:
        """Parameter sets by name where the system has them, else by path."""
        of_system = self.scenario.system_path / "resources"
        pairs = zip(self.scenario.parameters, self.scenario.parameter_paths, strict=True)
        return [name if path.parent == of_system else str(path.resolve()) for name, path in pairs]


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
    scenario = _scenario(study)
    read = system_of(scenario, build=build)
    levels = Levels(study, scenario, read)
    of_all = levels.expanded(study.set)
    for name in study.parameters:
        of_all = levels.fitting(name, ("parameters",)) | of_all
    system = with_values(read, scenario.set, str(scenario.path))
    levels = Levels(study, scenario, system)
    values = levels.checked(of_all, ("set",)) | dict(settings or {})
    events = [levels.event(event) for event in study.events]
    scenario = scenario.model_copy(update={"set": scenario.set | values, "events": [*scenario.events, *events]})
    system = with_values(system, values, "--set")
    levels = Levels(study, scenario, system)
    found = [levels.of(number) for number in range(len(study.factor))]
    measures, problems = measures_of(
        study, scenario, system, [e for one in found for level in one for e in level.events]
    )
    problems = [*levels.problems, *problems, *_of_summaries(study)]
    problems += [one for one in check_scenario(scenario, system) if one.severity == "error"]
    if problems:
        raise ShipcosimError(problems)
    systems = {swapped: _swapped(study, scenario, swapped, system, build) for swapped in _combinations(found)}
    return Plan(study, scenario, systems, found, measures)


def _scenario(study: Study) -> Scenario:
    """What all runs have in common, but for start values and events of the study."""
    try:
        path = study.scenario_path
    except ShipcosimError as error:
        found = f"There is no scenario '{study.scenario}'."
        raise ShipcosimError(problem_of(study, ("scenario",), found, error.problems[0].remedy)) from None
    scenario = read_scenario(path)
    times = {name: getattr(study, name) for name in ("stop_time", "step_size", "output_interval")}
    changed = {name: time for name, time in times.items() if time is not None}
    components = scenario.components | {name: _beside(study, fmu) for name, fmu in study.components.items()}
    scenario = scenario.model_copy(update={**changed, "components": components})
    if missing := check_files(scenario):
        raise ShipcosimError(missing)
    problems = [problem for problem in check_times(scenario) if problem.severity == "error"]
    if problems:
        keys = next(iter(changed), "scenario")
        raise ShipcosimError([problem_of(study, (keys,), one.found, one.remedy) for one in problems])
    return scenario


def _swapped(study: Study, scenario: Scenario, swapped: Swapped, system: System, build: bool) -> System:
    """The system with other FMUs in place of components' own."""
    if not swapped:
        return system
    components = scenario.components | {name: _beside(study, fmu) for name, fmu in swapped}
    scenario = scenario.model_copy(update={"components": components})
    if missing := check_files(scenario):
        raise ShipcosimError(missing)
    return with_values(system_of(scenario, build=build), scenario.set, str(study.path))


def _combinations(levels: Sequence[Sequence[Level]]) -> list[Swapped]:
    """Sets of swapped components that runs have, none where there is one without first."""
    per_factor = [list({tuple(level.components.items()) for level in one}) for one in levels]
    found = {tuple(sorted(dict(pair for part in parts for pair in part).items())) for parts in product(*per_factor)}
    return sorted(found, key=lambda one: (len(one), one))


def _beside(study: Study, fmu: str) -> str:
    """An FMU by its path where it lies beside the study, else as it is named."""
    path = study.folder / fmu
    return str(path) if path.is_file() else fmu


def _portable(scenario: Scenario, name: str, kind: str = "fmu", path: Path | None = None) -> str:
    """A name that is known anywhere in the project, else the absolute path."""
    if library.named(kind, name, scenario.project) is not None:
        return name
    found = path or Path(name)
    return str(found.resolve()) if found.exists() else name


def _of_summaries(study: Study) -> Iterator[Problem]:
    """Summaries that name what is not there."""
    quantities = [one.name for one in study.quantity]
    factors = [one.name for one in study.factor] + (["sample"] if study.sample else [])
    for number, one in enumerate(study.summary):
        if one.quantity not in quantities:
            found = f"There is no quantity '{one.quantity}'."
            yield problem_of(study, ("summary", number, "quantity"), found, suggestion(one.quantity, quantities))
        for key, names in (("over", one.over), ("along", [one.along] if one.along else [])):
            for name in names:
                if name not in factors:
                    found = f"There is no factor '{name}'."
                    yield problem_of(study, ("summary", number, key), found, suggestion(name, factors))


def _plain(value: Any) -> Any:
    """What JSON does not know, as it can be compared."""
    if isinstance(value, Event):
        return value.model_dump()
    return str(value)
