"""Checks of a scenario: alone, and against the system that it runs."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from math import ceil, floor
from typing import TYPE_CHECKING

import numpy as np

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, suggestion
from shipcosim.scenario.amounts import amount_complaints, units_of
from shipcosim.scenario.locations import Keys, problem_at
from shipcosim.scenario.model import Event, Expectation, Scenario, Value
from shipcosim.scenario.plausible import odd_values
from shipcosim.scenario.signals import chosen
from shipcosim.units import UnitError, is_amount, number_in, steps_in, whole_steps

if TYPE_CHECKING:
    from shipcosim.ssp import System

MOST_STEPS = 1e8
"""Steps of a run; the times of more than these would hardly fit into memory."""
SHORTEST_STEP = 1e-9
"""Of a run, as in libcosim: times are whole numbers of it. [s]"""


def check_files(scenario: Scenario) -> list[Problem]:
    """Find missing files of a scenario: its system, parameter sets and components' FMUs."""
    # Without a system nothing else can be checked.
    if not scenario.system:
        return [
            problem_at(
                scenario,
                ("system",),
                "the scenario names no system.",
                suggestion("", _systems(scenario)),
            )
        ]
    system = scenario.system_path
    problems = []
    if not system.exists() and "#" not in scenario.system:
        available = _systems(scenario)
        message = f"there is no system '{scenario.system}', by this name or beside the scenario."
        return [problem_at(scenario, ("system",), message, suggestion(scenario.system, available))]
    # Parameter sets in the system's resources or next to the scenario.
    for name, path in zip(scenario.parameters, scenario.parameter_paths, strict=True):
        if not path.exists():
            available = [file.stem for file in (system / "resources").glob("*.ssv")]
            message = f"there is no parameter set '{name}', in {system / 'resources'} or beside the scenario."
            problems.append(
                problem_at(scenario, ("parameters",), message, suggestion(name, available))
            )
    # FMUs are looked for, not built.
    for name, fmu in scenario.components.items():
        try:
            scenario.model_copy(update={"components": {name: fmu}}).component_paths(build=False)
        except ShipcosimError as error:
            message = f"there is no FMU '{fmu}', by this name or beside the scenario."
            problems.append(
                problem_at(scenario, ("components", name), message, error.problems[0].remedy)
            )
    return problems


def _systems(scenario: Scenario) -> list[str]:
    return list(library.names("system", scenario.project))


def step_times(step_size: float, first: int, last: int, start_time: float = 0.0) -> np.ndarray:
    """Times of the steps from one number to another, both included.

    Parameters
    ----------
    step_size, start_time : float
        Length of a step, and time of step 0. [s, s]
    first, last : int
        Numbers of the steps.

    Returns
    -------
    (last - first + 1,) array
        Times. [s]

    Examples
    --------
    >>> step_times(0.05, 0, 3).tolist()
    [0.0, 0.05, 0.1, 0.15]

    A run that starts on a step of another one has the same times:

    >>> step_times(0.05, 0, 1, start_time=0.15).tolist() == step_times(0.05, 3, 4).tolist()
    True
    """
    # As a fraction, so that 0.05 s times 3 is 0.15 s and no error accumulates.
    step = Fraction(step_size).limit_denominator(10**12)
    # Count from time 0: a run that starts on a step of another has the same times.
    before = whole_steps(start_time, step_size)
    if before is None:
        return start_time + step_times(step_size, first, last)
    return (
        np.arange(before + first, before + last + 1)
        * float(step.numerator)
        / float(step.denominator)
    )


def check_times(scenario: Scenario, start_time: float = 0.0) -> Iterator[Problem]:
    """Find times of a scenario that miss its steps, which count from `start_time` [s], or lie after its end."""
    for complaint in time_complaints(scenario, start_time):
        yield problem_at(scenario, *complaint)


def time_complaints(
    scenario: Scenario, start_time: float = 0.0
) -> Iterator[tuple[Keys, str, str, str]]:
    """Problems with the times of a scenario whose run starts at a time [s]: (keys, found, remedy, severity)."""
    step = scenario.step_size
    stop = scenario.stop_time
    # Too many steps would fill the memory before anything runs.
    if (stop - start_time) / step > MOST_STEPS:
        message = (
            f"stop_time = {stop:g} s takes {(stop - start_time) / step:.3g} steps of {step:g} s."
        )
        yield (
            ("stop_time",),
            message,
            f"At most {MOST_STEPS:,.0f} are done: take larger steps or stop earlier.",
            "error",
        )
        return
    if step < SHORTEST_STEP:
        yield (
            ("step_size",),
            f"step_size = {step:g} s.",
            f"Take {SHORTEST_STEP:g} s or more.",
            "error",
        )
        return
    # Every time in the file must fall on a step.
    times: list[tuple[Keys, float]] = [
        (("stop_time",), stop),
        (("output_interval",), scenario.output_interval or step),
        *((("events", number, "time"), event.time) for number, event in enumerate(scenario.events)),
    ]
    for keys, time in times:
        since = 0.0 if keys[0] == "output_interval" else start_time
        count = whole_steps(time - since, step)
        # No step at all is wrong for lengths of time, but an event may be at 0.
        if count is None or (count == 0 and keys[0] != "events"):
            message = f"{keys[-1]} = {time:g} s is no multiple of the step size {step:g} s."
            nearest = since + max(1, round(steps_in(time - since, step))) * step
            message = message.replace(" s.", f" s after {since:g} s.") if since else message
            yield keys, message, f"The nearest would be {nearest:g} s.", "error"
        elif keys[0] == "output_interval" and whole_steps(stop - start_time, time) is None:
            last = start_time + floor(steps_in(stop - start_time, time)) * time
            message = f"{stop - start_time:g} s are no multiple of {time:g} s: the last row is at {last:g} s."
            yield keys, message, "What comes after it is neither kept nor judged.", "remark"
        elif keys[0] == "events" and time >= stop:
            # An event at or after the end has no effect: worth a remark.
            yield (
                keys,
                f"the event at {time:g} s never acts: the run ends at {stop:g} s.",
                "",
                "remark",
            )
    yield from _window_complaints(scenario, start_time)


def _window_complaints(
    scenario: Scenario, start_time: float
) -> Iterator[tuple[Keys, str, str, str]]:
    """Problems with the windows of expectations, as `time_complaints`."""
    interval = scenario.output_interval or scenario.step_size
    stop = scenario.stop_time
    for number, expect in enumerate(scenario.expect):
        window = expect.during
        if not window:
            continue
        keys = ("expect", number, "during")
        first, last = (steps_in(time - start_time, interval) for time in window)
        # A window before the start is never judged, in no run.
        if window[0] < start_time:
            message = f"during = {window} begins before the run, at {start_time:g} s."
            yield keys, message, "Let it begin there or later.", "error"
        # One beyond the end is judged only as far as the run goes.
        elif window[1] > stop:
            message = f"during = {window} reaches beyond the end of the run at {stop:g} s."
            yield keys, message, "", "remark"
        # One between two rows has nothing to judge.
        elif floor(last + ROUNDING) < ceil(first - ROUNDING):
            message = (
                f"during = {window} lies between two rows: the run has one every {interval:g} s."
            )
            yield keys, message, "Let it include one.", "error"


ROUNDING = 1e-6
"""Share of a step by which times in a file may miss it."""


def check_parameters(scenario: Scenario, system: System) -> Iterator[Problem]:
    """Find required ship parameters without a value, in all components."""
    # Values come from the scenario or from a connection.
    fed = system.feeding
    for component in system.components.values():
        if missing := [
            name
            for name in component.left_out
            if f"{component.name}.{name}" not in scenario.set and (component.name, name) not in fed
        ]:
            units = {name: component.variables[name].unit for name in missing}
            names = ", ".join(f"{name} [{unit}]" if unit else name for name, unit in units.items())
            yield Problem(
                f"{system.file}: {component.name}",
                f"parameters left out, which have no value of their own: {names}.",
                "Give them, as a ship's parameter set does.",
            )


def check_scenario(scenario: Scenario, system: System, start_time: float = 0.0) -> list[Problem]:
    """Problems of the events and expectations of a scenario with a system.

    Parameters
    ----------
    scenario : Scenario
        Checked in itself.
    system : System
        That it runs. Start values are checked by `shipcosim.ssp.with_values`.
    start_time : float
        Of the run. [s]
    """
    # Times and parameters first; then events and expectations, each at its line.
    problems = [*check_times(scenario, start_time), *check_parameters(scenario, system)]
    wrong_changes = [
        problem_at(scenario, ("events", number, verb, signal), *complaint)
        for number, event in enumerate(scenario.events)
        for verb, signal, *complaint in event_complaints(event, system)
    ]
    # Odd values are only checked once the events themselves are right.
    problems += wrong_changes or [*odd_values(scenario, system), *_replaced_changes(scenario)]
    changed = {signal for event in scenario.events for _, signal, _ in event.changes}
    problems += _record_problems(scenario, system, changed)
    for number, expect in enumerate(scenario.expect):
        complaints = expectation_complaints(expect, system, changed)
        problems += [
            problem_at(scenario, ("expect", number, key), *complaint)
            for key, *complaint in complaints
        ]
    return problems


def _record_problems(
    scenario: Scenario, system: System, changed: Collection[str]
) -> Iterator[Problem]:
    """Find signals that a run is to keep and does not record."""
    if not scenario.record.signals:
        return
    reasons = {
        name: _expect_complaint(system, name, changed)
        for component, variable in system.all_variables()
        for name in [f"{component.name}.{variable.name}"]
    }
    recorded = [name for name, reason in reasons.items() if reason is None]
    for wanted in scenario.record.signals:
        try:
            chosen([*recorded, *system.inputs, *system.outputs], [wanted])
        except ShipcosimError as error:
            [missing] = error.problems
            reason = reasons.get(wanted) or (f"{wanted}: {missing.found}", missing.remedy)
            yield problem_at(scenario, ("record", "signals"), *reason)


def expectation_complaints(
    expect: Expectation, system: System, changed: Collection[str] = ()
) -> list[tuple[str, str, str]]:
    """Problems of an expectation with a system: (key, found, remedy).

    Parameters
    ----------
    expect : Expectation
    system : System
        That runs.
    changed : collection of str
        Signals that events change.
    """
    # Units can be compared only if all signals exist.
    complaints = [
        c for signal in expect.signals if (c := _expect_complaint(system, signal, changed))
    ]
    return [("signal", *complaint) for complaint in complaints] or list(
        amount_complaints(expect, units_of(system))
    )


def _replaced_changes(scenario: Scenario) -> Iterator[Problem]:
    """Remarks on changes of a signal in whose place another one comes at the same time."""
    by_time = sorted(enumerate(scenario.events), key=lambda numbered: numbered[1].time)
    earlier: dict[str, tuple[float, Keys]] = {}
    for number, event in by_time:
        for verb, signal, _ in event.changes:
            before = earlier.get(signal)
            if before is not None and before[0] == event.time:
                time, keys = before
                yield problem_at(
                    scenario,
                    keys,
                    f"the {keys[2]} of {signal} at {time:g} s has no effect.",
                    f"A later {verb} at the same time takes its place. Keep one of them.",
                    "remark",
                )
            earlier[signal] = event.time, ("events", number, verb, signal)


def event_complaints(event: Event, system: System) -> Iterator[tuple[str, str, str, str]]:
    """Problems of an event with a system: (verb, signal, found, remedy)."""
    for verb, signal, value in event.changes:
        if complaint := _event_complaint(system, verb, signal, value):
            yield verb, signal, *complaint


def _event_complaint(
    system: System, verb: str, signal: str, value: Value | None
) -> tuple[str, str] | None:
    """Problem of a change of a signal, as (found, remedy), or None."""
    # The signal must exist, as an input of the system or a variable of a component.
    try:
        component, name = system.split(signal)
    except ShipcosimError as error:
        return error.problems[0].found, error.problems[0].remedy
    if component is None and name not in system.inputs:
        return (
            f"'{signal}' is no input of the system.",
            f"Inputs: {', '.join(system.inputs) or 'none'}.",
        )
    # Type of the signal, and whether it may change during a run.
    target = system.described(component, name)
    kind = target.kind
    items = target.items
    if component is not None:
        variable = system.components[component].variables[name]
        may_change = variable.causality in ("input", "output") or (
            variable.causality,
            variable.variability,
        ) == (
            "parameter",
            "tunable",
        )
        if not may_change:
            remedy = "Events change inputs, outputs and tunable parameters; [set] sets parameters before the start."
            return f"'{signal}' is a {variable.variability} {variable.causality}.", remedy
    # An amount with a unit must be convertible; any other value must fit the type.
    if kind == "Real" and is_amount(value):
        return _unit_complaint(system, verb, signal, value, (component, name))
    # FMI's integers have 32 bits, or say how many they have.
    is_plain = kind == "Integer" and (component is None or variable.type == "Integer")
    if is_plain and isinstance(value, (int, float)) and not -(2**31) <= value < 2**31:
        message = f"{verb} of '{signal}' with {value:.15g}: too large for an Integer."
        return message, f"Give one from {-(2**31)} to {2**31 - 1}."
    if verb != "reset" and not _fits(value, kind, items, verb):
        listed = f" Its items are {', '.join(items)}." if items else ""
        message = f"{verb} of '{signal}' with {value!r}: the signal is {kind or None}."
        return message, f"{_WANTED.get(kind, 'It cannot be changed.')}{listed}"
    return None


def _unit_complaint(
    system: System, verb: str, signal: str, value: str, end: tuple[str | None, str]
) -> tuple[str, str] | None:
    try:
        number_in(value, system.unit_of(*end), difference=verb == "bias")
    except UnitError as error:
        return f"{verb} of '{signal}': {error.found}", error.remedy
    return None


_WANTED = {
    "Real": "A number is needed.",
    "Integer": "A whole number is needed.",
    "Boolean": "Override it with true or false.",
    "Enumeration": "Override it with the name or number of an item.",
}


def _fits(value: Value | None, kind: str, items: Mapping[str, int], verb: str) -> bool:
    if kind == "Boolean":
        return isinstance(value, bool) and verb == "override"
    if kind == "Enumeration":
        return verb == "override" and (value in items or value in items.values())
    if isinstance(value, bool):
        return False
    if kind == "Integer":
        return isinstance(value, (int, float)) and value == int(value)
    return kind == "Real" and isinstance(value, (int, float))


def _expect_complaint(
    system: System, signal: str, changed: Collection[str]
) -> tuple[str, str] | None:
    """Reason why a signal will not be in the table, as (found, remedy), or None."""
    try:
        component, name = system.split(signal)
    except ShipcosimError as error:
        return error.problems[0].found, error.problems[0].remedy
    # Inputs of the system and changed signals are always recorded.
    if component is None or signal in changed:
        return None
    variable = system.components[component].variables[name]
    # A connected input repeats its source and is not recorded.
    feeding = next((c.source for c in system.connections if c.target == (component, name)), None)
    if variable.causality == "input" and feeding is not None:
        source = ".".join(filter(None, feeding))
        return (
            f"'{signal}' is not recorded: it is what {source} puts out.",
            f"Take {source} instead.",
        )
    # Only inputs and outputs that are numbers are recorded.
    if variable.causality not in ("input", "output") or variable.kind == "String":
        return (
            f"'{signal}' is not recorded: it is a {variable.kind} {variable.causality}.",
            "Outputs and inputs are.",
        )
    return None
