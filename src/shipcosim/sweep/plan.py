"""The runs of a study, laid out over factors and samples, made one by one when needed."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from shipcosim import __version__, library
from shipcosim.cosim.master.result import fingerprint, hashes, start_values
from shipcosim.scenario import (
    Event,
    Scenario,
    units_of,
)
from shipcosim.scenario.model import Value
from shipcosim.ssp import System
from shipcosim.sweep.levels import Level
from shipcosim.sweep.quantities import Measure
from shipcosim.sweep.sampling import Samples
from shipcosim.sweep.study_model import Study

Swapped = tuple[tuple[str, str], ...]
"""Components and the FMUs that they run in place of their own."""


@dataclass(frozen=True)
class PlannedRun:
    """A run: what differs from the part that all runs share.

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
    """Description of a column of the tables."""

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
    samples : Samples or None
        Crossed with the factors.
    planned : float
        Stop time of the scenario's file, for which its expectations were written. [s]
    """

    study: Study
    scenario: Scenario
    systems: Mapping[Swapped, System]
    levels: Sequence[Sequence[Level]]
    measures: tuple[Measure, ...] = ()
    samples: Samples | None = None
    planned: float = 0.0

    def __len__(self) -> int:
        return prod(self.shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of levels of each factor, then of samples; the last one changes fastest."""
        sizes = tuple(len(levels) for levels in self.levels)
        return sizes if self.samples is None else (*sizes, len(self.samples.numbers))

    @property
    def system(self) -> System:
        """The system of runs that swap nothing of their own."""
        return next(iter(self.systems.values()))

    def run(self, number: int) -> PlannedRun:
        """The run with a number."""
        # The number of a run determines its levels, as in an array with one axis per factor.
        places = (
            [int(place) for place in np.unravel_index(number, self.shape)] if self.shape else []
        )
        values: dict[str, Value] = {}
        columns: dict[str, Value] = {}
        events: list[Event] = []
        swapped: dict[str, str] = {}
        stop_time = None
        # Later factors replace values of earlier ones; their events add up.
        for factor, levels, place in zip(self.study.factor, self.levels, places, strict=False):
            level = levels[place]
            columns[factor.name] = level.label
            values |= level.values
            events += level.events
            swapped |= level.components
            stop_time = level.stop_time if level.stop_time is not None else stop_time
        if self.samples is not None:
            columns["sample"] = places[-1]
            at_fork = {}
            # A sampled value acts from the start, or together with all others in one event at the fork.
            sampled = self.samples.values(places[-1])
            for column, value in zip(self.samples.columns, sampled, strict=True):
                columns[column.name] = value
                target = at_fork if column.at_fork else values
                target.update(dict.fromkeys(column.signals, value))
            if at_fork:
                events.append(Event(time=self.study.fork_at or 0.0, override=at_fork))
        return PlannedRun(
            number, columns, values, tuple(events), tuple(sorted(swapped.items())), stop_time
        )

    def scenario_of(self, run: PlannedRun) -> Scenario:
        """The scenario of a run, without its start values."""
        if not run.events and run.stop_time is None:
            return self.scenario
        events = [*self.scenario.events, *run.events]
        stop_time = self.scenario.stop_time if run.stop_time is None else run.stop_time
        return self.scenario.model_copy(update={"events": events, "stop_time": stop_time})

    def alone(self, number: int) -> Scenario:
        """The scenario of a run with all its changes, and the scenario's expectations."""
        run = self.run(number)
        scenario = self.scenario_of(run)
        changed = {
            "set": {**scenario.set, **run.values},
            "components": scenario.components | dict(run.swapped),
        }
        return scenario.model_copy(update=changed)

    def input_of(self, run: PlannedRun) -> dict[str, Any]:
        """The full input of a run: ``shipcosim.run(Scenario(**input))`` runs it alone."""
        # Only what differs is made anew; there may be millions of runs.
        content = dict(self._common_input)
        if run.swapped:
            content["components"] = self._portable_components(dict(run.swapped))
        content["set"] = {**self.scenario.set, **run.values}
        if run.events:
            content["events"] = [
                *content["events"],
                *(event.model_dump(exclude_defaults=True) for event in run.events),
            ]
        if run.stop_time is not None:
            content["stop_time"] = run.stop_time
        return {name: value for name, value in content.items() if value not in ({}, [], None)}

    @cached_property
    def _common_input(self) -> dict[str, Any]:
        """The part that the inputs of all runs share."""
        scenario = self.scenario
        # Parameter sets by name where the system has them, else by path.
        of_system = scenario.system_path / "resources"
        pairs = zip(scenario.parameters, scenario.parameter_paths, strict=True)
        sets = [name if path.parent == of_system else str(path.resolve()) for name, path in pairs]
        return {
            "system": _portable(scenario, scenario.system, "system", scenario.system_path),
            "parameters": sets,
            "components": self._portable_components({}),
            "set": {},
            "events": [event.model_dump(exclude_defaults=True) for event in scenario.events],
            "stop_time": scenario.stop_time,
            "step_size": scenario.step_size,
            "output_interval": scenario.output_interval,
        }

    def _portable_components(self, swapped: Mapping[str, str]) -> dict[str, str]:
        together = self.scenario.components | dict(swapped)
        return {name: _portable(self.scenario, fmu) for name, fmu in together.items()}

    @cached_property
    def columns(self) -> list[ColumnOf]:
        """Columns of the table of runs, except for its number, error and input."""
        # Columns in the order of the table: factors, samples, quantities. Units come from the
        # signals.
        unit_of = units_of(self.system)
        columns = []
        for factor, levels in zip(self.study.factor, self.levels, strict=True):
            signals = list(levels[0].values) or [
                name for event in levels[0].events for name in event.override
            ]
            unit = None if factor.cases or factor.seeds else unit_of(signals[0])
            labels = [level.label for level in levels] if factor.cases else None
            name = "deg" if factor.directions else unit.name if unit else None
            columns.append(ColumnOf(factor.name, "factor", name, ", ".join(factor.signal), labels))
        if self.samples is not None:
            columns.append(ColumnOf("sample", "sample", description="number of the sample"))
            signals = [(column, ", ".join(column.signals)) for column in self.samples.columns]
            columns += [
                ColumnOf(column.name, "sample", column.unit, text) for column, text in signals
            ]
        return columns + [
            ColumnOf(measure.name, "quantity", measure.unit, measure.description)
            for measure in self.measures
        ]

    @cached_property
    def duration(self) -> float:
        """Simulated time of all runs. [s]"""
        # Each factor with its own ends multiplies the runs; those without keep the ends so far.
        ends = [self.scenario.stop_time]
        for levels in self.levels:
            of_factor = [level.stop_time for level in levels]
            if any(end is not None for end in of_factor):
                ends = [
                    level_end if level_end is not None else end
                    for end in ends
                    for level_end in of_factor
                ]
            else:
                ends = [end for end in ends for _ in of_factor]
        return float(sum(ends)) * (1 if self.samples is None else len(self.samples.numbers))

    def digest(self, engine: str) -> str:
        """Hash of everything that determines the table of runs."""
        # Summaries and views are made from the table, so they may change without new runs.
        ignored = {"description", "summary", "view"}
        of_systems = [
            (key, fingerprint(system), hashes(system), start_values(system))
            for key, system in self.systems.items()
        ]
        of_inputs = {name: signal.start for name, signal in self.system.inputs.items()}

        def plain(value: Any) -> Any:
            return value.model_dump() if isinstance(value, Event) else str(value)

        # Versions, study, scenario, FMUs and wiring: if any of them changes, old results are not
        # used.
        facts = [
            __version__,
            engine,
            self.study.model_dump(exclude=ignored, exclude_defaults=True),
            self.scenario.model_dump(exclude={"description"}),
            [[level.__dict__ for level in levels] for levels in self.levels],
            None if self.samples is None else self.samples.facts,
            of_systems,
            of_inputs,
        ]
        return hashlib.sha256(json.dumps(facts, default=plain, sort_keys=True).encode()).hexdigest()

    @property
    def rows_per_track_row(self) -> int:
        """Rows of a run for each row of its track."""
        row = self.scenario.output_interval or self.scenario.step_size
        tracks = self.study.tracks
        return max(1, round(tracks.interval / row)) if tracks is not None and tracks.interval else 1


def _portable(scenario: Scenario, name: str, kind: str = "fmu", path: Path | None = None) -> str:
    """A name known anywhere in the project, else the absolute path."""
    if library.named(kind, name, scenario.project) is not None:
        return name
    file = path or Path(name)
    return str(file.resolve()) if file.exists() else name
