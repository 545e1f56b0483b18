"""Levels of factors: the change that each value, case or seed makes in a run."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import floor, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario import Event, units_of
from shipcosim.scenario.amounts import in_unit_of
from shipcosim.scenario.check import event_complaints
from shipcosim.scenario.locations import AnyKeys, Keys
from shipcosim.scenario.model import Value
from shipcosim.ssp import fitting_values, with_values
from shipcosim.sweep.reader import problem_of
from shipcosim.sweep.study_model import MOST_LEVELS, Case, Factor, Study
from shipcosim.units import RADIAN, UnitError, steps_in, whole_steps

if TYPE_CHECKING:
    from shipcosim.scenario import Scenario
    from shipcosim.ssp import System

LARGEST_SEED = 2**31


@dataclass(frozen=True)
class Level:
    """One value of a factor.

    Parameters
    ----------
    label : value
        Of the column.
    values : mapping of str to value
        Start values by signal, in the units of the variables.
    events : tuple of Event
        That happen besides those of all runs.
    components : mapping of str to str
        FMUs that components run in place of their own.
    stop_time : float or None
        Where the run ends. [s]
    """

    label: Value
    values: Mapping[str, Value] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    components: Mapping[str, str] = field(default_factory=dict)
    stop_time: float | None = None


class Levels:
    """Make the levels of a study's factors, and collect their problems.

    Parameters
    ----------
    study : Study
        With the factors.
    scenario : Scenario
        Of all runs.
    system : System
        Of all runs, with their start values.
    """

    def __init__(self, study: Study, scenario: Scenario, system: System):
        self._study = study
        self._scenario = scenario
        self._system = system
        self.problems: list[Problem] = []

    def complain(self, keys: AnyKeys, found: str, remedy: str = "") -> None:
        """Add a problem of what stands in the study under some keys."""
        self.problems.append(problem_of(self._study, keys, found, remedy))

    def of(self, number: int) -> list[Level]:
        """Levels of the factor with a number; each may be there once."""
        levels = self._made(number)
        labels = [level.label for level in levels]
        for i, label in enumerate(labels):
            if label in labels[:i]:
                place = ("case", i, "label") if self._study.factor[number].case else ()
                message = f"The level {label} is there twice."
                self.complain(("factor", number, *place), message, "Keep one.")
                return levels
        # Angles a whole turn apart are one direction, which would count twice.
        first: dict[float, Any] = {}
        for label in labels if self._is_angle(number) else ():
            direction = round(float(label) / tau % 1.0, 9) % 1.0
            if direction in first:
                self.complain(
                    ("factor", number),
                    f"The levels {first[direction]:g} and {label:g} rad are one direction.",
                    "Keep one.",
                )
            first.setdefault(direction, label)
        return levels

    def _is_angle(self, number: int) -> bool:
        """Whether the values of a factor are angles in rad."""
        factor = self._study.factor[number]
        signals = [signal for name in factor.signal for signal in self.signals_of(name)]
        if not signals or factor.at_fork:
            return False
        try:
            return units_of(self._system)(signals[0]) == RADIAN
        except ShipcosimError:
            return False  # a name that the system does not have is reported where it is set

    def _made(self, number: int) -> list[Level]:
        factor = self._study.factor[number]
        # Cases, directions and conditions: each sets several things at once.
        if cases := factor.cases:
            made_by = "directions" if factor.directions else "conditions"
            keys = [("case", i) if factor.case else (made_by,) for i in range(len(cases))]
            return [
                self._of_case(case, ("factor", number, *key))
                for case, key in zip(cases, keys, strict=True)
            ]
        if factor.seeds is not None:
            return self._of_seeds(factor, ("factor", number, "seeds"))
        # Listed or evenly spaced values of one or more signals.
        key = "values" if factor.values is not None else "from"
        signals = self.existing(factor.signal, ("factor", number, "signal"))
        if not signals:
            return []
        values = factor.values or self._spaced(factor, signals[0], number)
        # At the fork a value acts as an event; otherwise as a start value.
        if factor.at_fork:
            return [self.at_fork(signals, value, ("factor", number, key)) for value in values]
        settings = (
            self.checked(dict.fromkeys(signals, value), ("factor", number, key)) for value in values
        )
        return [Level(next(iter(setting.values())), setting) for setting in settings if setting]

    def checked(self, values: Mapping[str, Value], keys: AnyKeys) -> dict[str, Value]:
        """Start values in the units of their variables; empty, with a problem, if one does not fit.

        Parameters
        ----------
        values : mapping of str to value
            By signal, or by a name of the study for several.
        keys : sequence of str and int
            Where they stand in the study.
        """
        # All at once is fast; only after an error each is tried alone, to name the wrong one.
        expanded = self.expanded(values)
        try:
            system = with_values(self._system, expanded, "")
        except ShipcosimError:
            for name, value in values.items():
                self._check_value(name, value, keys)
            return {}
        return {signal: system.start_value(*system.split(signal)) for signal in expanded}

    def _check_value(self, name: str, value: Value, keys: AnyKeys) -> None:
        where = problem_of(self._study, (*keys, name), "").where
        for signal in self.signals_of(name):
            try:
                with_values(self._system, {signal: value}, where)
            except ShipcosimError as error:
                self.problems += error.problems
                return

    def check_names(self) -> None:
        """Check that the study's names are new, and stand for components."""
        components = list(self._system.components)
        for name, group in self._study.names.items():
            if name in components:
                message = f"'{name}' is a component already."
                self.complain(("names", name), message, "Give them another name.")
            for one in group:
                if one not in components:
                    message = f"There is no component '{one}'."
                    remedy = suggestion(one, components)
                    self.complain(("names", name), message, remedy)

    def at_fork(self, signals: Sequence[str], value: Value, keys: AnyKeys) -> Level:
        """Level of a value that acts as an event at the fork."""
        event = Event(time=self._study.fork_at or 0.0, override=dict.fromkeys(signals, value))
        for _, _, message, remedy in event_complaints(event, self._system):
            self.complain(keys, message, remedy)
        if not self.problems:
            value = in_unit_of(value, signals[0], units_of(self._system))
        return Level(value, events=(event,))

    # A name of the study stands for several components; each gets the value.
    def expanded(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Values by signal, where names of the study stand for several components."""
        return {signal: value for name, value in values.items() for signal in self.signals_of(name)}

    def signals_of(self, name: str) -> list[str]:
        """Signals of a name: one, or the same of several components."""
        for group, components in self._study.names.items():
            if name.startswith(f"{group}."):
                return [component + name[len(group) :] for component in components]
        return [name]

    def existing(self, names: Iterable[str], keys: AnyKeys) -> list[str]:
        """Signals of names; empty, with a problem, if one does not exist."""
        signals = [signal for name in names for signal in self.signals_of(name)]
        before = len(self.problems)
        for signal in signals:
            try:
                self._system.split(signal)
            except ShipcosimError as error:
                self.complain(keys, error.problems[0].found, error.problems[0].remedy)
        return [] if len(self.problems) > before else signals

    def _of_case(self, case: Case, keys: Keys) -> Level:
        # Order of precedence within a case: parameter sets first, then single values.
        values: dict[str, Value] = {}
        for name in case.parameters:
            values |= self.fitting(name, (*keys, "parameters"))
        values |= self.checked(case.set, (*keys, "set")) if case.set else {}
        events = [self.event(event) for event in case.events]
        self.check_events(events, (*keys, "events"))
        self._check_time(case.stop_time, (*keys, "stop_time"))
        return Level(case.label, values, tuple(events), case.components, case.stop_time)

    def event(self, event: Event) -> Event:
        """An event with the study's names replaced by components."""
        reset = [signal for name in event.reset for signal in self.signals_of(name)]
        return event.model_copy(
            update={
                "override": self.expanded(event.override),
                "bias": self.expanded(event.bias),
                "reset": reset,
            }
        )

    def fitting(self, name: str, keys: AnyKeys) -> dict[str, Value]:
        """Start values of a parameter set that fit the system."""
        # A set of the system by name, or a file beside the study.
        paths = [
            Path(self._scenario.system_path) / "resources" / f"{name}.ssv",
            self._study.folder / name,
        ]
        path = next((candidate for candidate in paths if candidate.is_file()), None)
        if path is None:
            names = [file.stem for file in paths[0].parent.glob("*.ssv")]
            names += [file.name for file in self._study.folder.glob("*.ssv")]
            self.complain(
                keys,
                f"There is no parameter set '{name}', in {paths[0].parent} or beside the study.",
                suggestion(name, names),
            )
            return {}
        try:
            return fitting_values(path, self._system)[0]
        except ShipcosimError as error:
            self.problems += error.problems
            return {}

    def check_events(self, events: Iterable[Event], keys: Keys) -> None:
        """Check the signals, values and times of events, which keys of the study name."""
        for number, event in enumerate(events):
            for verb, signal, message, remedy in event_complaints(event, self._system):
                self.complain((*keys, number, verb, signal), message, remedy)
            self._check_time(event.time, (*keys, number, "time"), may_be_zero=True)

    def _check_time(self, time: float | None, keys: AnyKeys, may_be_zero: bool = False) -> None:
        step = self._scenario.step_size
        if time is None:
            return
        # Events at time zero are allowed; an end at zero is not.
        count = whole_steps(time, step)
        if count is None or (count == 0 and not may_be_zero):
            message = f"{keys[-1]} = {time:g} s is no multiple of the step size {step:g} s."
            nearest = max(1, round(steps_in(time, step))) * step
            self.complain(keys, message, f"The nearest would be {nearest:g} s.")

    def _spaced(self, factor: Factor, signal: str, number: int) -> list[float]:
        """Evenly spaced values of a factor, ends included, in the unit of its signal."""
        unit_of = units_of(self._system)
        # A step is a difference: temperatures and the like have no offset in it.
        try:
            first, last = (in_unit_of(end, signal, unit_of) for end in (factor.start, factor.to))
            step = in_unit_of(factor.step, signal, unit_of, difference=True)
        except UnitError as error:
            self.complain(("factor", number, "from"), error.found, error.remedy)
            return []
        # Either a number of values, or a step.
        if step is None:
            return np.linspace(first, last, factor.count or 2).tolist()
        # A step in the wrong direction never arrives, and a tiny one makes more levels than memory
        # holds.
        if step == 0.0 or (last - first) / step < 0.0 or (last - first) / step > MOST_LEVELS:
            self.complain(
                ("factor", number, "step"),
                f"Steps of {factor.step} do not lead from {factor.start} to {factor.to}.",
                "Give another step.",
            )
            return []
        # A small tolerance, so that rounding does not lose the last value.
        return [first + i * step for i in range(floor((last - first) / step + 1e-9) + 1)]

    def _of_seeds(self, factor: Factor, keys: AnyKeys) -> list[Level]:
        """Levels of seeds: each signal gets its own number from study seed, level and name."""
        # Without named signals every parameter called seed is drawn anew.
        signals = (
            self.existing(factor.signal, (*keys[:2], "signal"))
            if factor.signal
            else list(seeds_of(self._system))
        )
        if not signals and not self.problems:
            self.complain(
                keys,
                "Nothing in the system has a seed: it has no parameter named seed.",
                "Name the signals: signal = [...].",
            )
        # Seeds of one level differ between signals, so that two sensors have independent noise.
        levels = []
        for level in range(1, (factor.seeds or 0) + 1):
            values = {signal: _drawn(self._study.seed, level, signal) for signal in signals}
            levels.append(Level(level, values))
        if levels:
            self.checked(levels[0].values, keys)
        return levels


def seeds_of(system: System) -> Iterator[str]:
    """Parameters that are seeds, by their name."""
    for component, variable in system.all_variables():
        is_seed = variable.name == "seed" or variable.name.endswith("_seed")
        if is_seed and variable.causality == "parameter" and variable.kind == "Integer":
            yield f"{component.name}.{variable.name}"


def _drawn(seed: int, level: int, signal: str) -> int:
    # The name enters by its checksum: a new component does not change the seeds of others.
    generator = np.random.default_rng([seed, level, zlib.crc32(signal.encode())])
    return int(generator.integers(1, LARGEST_SEED))
