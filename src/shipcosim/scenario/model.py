"""Scenario files: what happens in a run, and what must hold.

A scenario is data. `read_scenario` reads and checks a file, `check_scenario` holds it against a system, `judge` holds
a run's table against its expectations.
"""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainValidator,
    PrivateAttr,
    ValidationError,
    model_validator,
)

from shipcosim.errors import Problem, ShipcosimError, suggestion

if TYPE_CHECKING:
    import xarray

    from shipcosim.ssp import System

__all__ = [
    "Event",
    "Expectation",
    "Scenario",
    "Verdict",
    "check_files",
    "check_scenario",
    "check_times",
    "judge",
    "read_scenario",
    "whole_steps",
]


def _plain(value):
    if isinstance(value, float) and not np.isfinite(value):
        raise ValueError(f"{value} is not a finite number. Give one, in the variable's unit.")
    if isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"{value!r} is no value. A value is a number, true or false, or a text.")


LONGEST_LINE = 20_000
"""Characters in a line of a TOML file."""

MOST_STEPS = 1e8
"""Steps of a run; the times of more than these would hardly fit into memory."""

Value = Annotated[bool | int | float | str, PlainValidator(_plain)]
ListOfNames = Annotated[list[str], BeforeValidator(lambda names: [names] if isinstance(names, str) else names)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Event(_Part):
    """What changes at a time, in the words of OSP. An event at time t acts on the step that starts at t."""

    time: float = Field(ge=0.0, description="s")
    override: dict[str, Value] = Field({}, description="signals held at a value instead of what they would be")
    bias: dict[str, float] = Field({}, description="values added to signals")
    reset: ListOfNames = Field([], description="signals that follow their source, or their start value, again")

    @model_validator(mode="after")
    def _does_something(self):
        if not (self.override or self.bias or self.reset):
            raise ValueError("The event does nothing. It needs override, bias or reset.")
        return self

    @property
    def changes(self) -> list[tuple[str, str, Value | None]]:
        """(override, bias or reset; signal; value) of each change."""
        changes = [("override", *item) for item in self.override.items()]
        return changes + [("bias", *item) for item in self.bias.items()] + [("reset", s, None) for s in self.reset]


class Expectation(_Part):
    """What must hold of one signal, or of the distance that several span.

    Differences of signals in rad are taken the short way round.
    """

    signal: ListOfNames = Field(min_length=1)
    near: Annotated[
        list[float | str] | None, BeforeValidator(lambda v: v if isinstance(v, list) or v is None else [v])
    ] = Field(None, description="numbers, or names of signals")
    within: float | None = Field(None, gt=0.0, description="largest distance from `near`")
    at_least: float | None = None
    at_most: float | None = None
    during: Annotated[list[float], Field(min_length=2, max_length=2)] | None = Field(None, description="from, to in s")
    statistic: Literal["mean", "max", "min", "final"] | None = Field(None, description="instead of every row")

    @model_validator(mode="after")
    def _is_one_claim(self):
        limits = self.at_least is not None or self.at_most is not None
        if (self.near is None) != (self.within is None):
            raise ValueError("`near` and `within` come together.")
        if (self.near is not None) == limits:
            raise ValueError("An expectation states either near and within, or at_least and/or at_most.")
        if self.near is not None and len(self.near) != len(self.signal):
            raise ValueError(f"{len(self.signal)} signals need {len(self.signal)} values in `near`.")
        if limits and len(self.signal) > 1:
            raise ValueError("at_least and at_most take one signal.")
        if self.during and not self.during[0] <= self.during[1]:
            raise ValueError(f"during = {self.during} ends before it starts.")
        return self

    def __str__(self):
        subject = f"{self.statistic} of " if self.statistic else ""
        subject += self.signal[0] if len(self.signal) == 1 else f"({', '.join(self.signal)})"
        claims = [
            f"{word} {limit:g}" for word, limit in (("≥", self.at_least), ("≤", self.at_most)) if limit is not None
        ]
        if self.near is not None:
            target = ", ".join(v if isinstance(v, str) else f"{v:g}" for v in self.near)
            claims = [f"within {self.within:g} of {target if len(self.near) == 1 else f'({target})'}"]
        window = f" during {self.during[0]:g} to {self.during[1]:g} s" if self.during else ""
        return f"{subject} {' and '.join(claims)}{window}"

    @property
    def signals(self) -> list[str]:
        """Every signal the expectation looks at."""
        return [*self.signal, *(v for v in self.near or () if isinstance(v, str))]


class Scenario(_Part):
    """What happens: a system, its start values, events, and what must hold.

    A change is a copy: ``scenario.model_copy(update={"step_size": 0.025})``.
    """

    description: str = ""
    system: str = Field("", description="name of a folder in the project's ssp/, or a path")
    parameters: ListOfNames = Field([], description="names of parameter sets in the system's resources, or paths")
    stop_time: float = Field(gt=0.0, description="s")
    step_size: float = Field(gt=0.0, description="s")
    output_interval: float | None = Field(None, gt=0.0, description="s; every step where it is not given")
    set: dict[str, Value] = Field({}, description="start values")
    events: list[Event] = []
    expect: list[Expectation] = []
    _path: Path | None = PrivateAttr(None)

    @property
    def path(self) -> Path | None:
        """File the scenario was read from."""
        return self._path

    @property
    def name(self) -> str:
        """Name of the file, without its suffix."""
        return self._path.stem if self._path else ""

    @property
    def project(self) -> Path:
        """Folder of the project: the parent of the folder that holds the scenario."""
        return self._path.resolve().parents[1] if self._path else Path.cwd()

    @property
    def system_path(self) -> Path:
        """Where the system is: a path beside the scenario or in the project, else the folder of this name in ssp/."""
        beside = self._path.resolve().parent if self._path else Path.cwd()
        candidates = [beside / self.system, self.project / self.system]
        return next((c for c in candidates if c.exists()), self.project / "ssp" / self.system)

    @property
    def parameter_paths(self) -> list[Path]:
        """Where the parameter sets are: of this name in the system's resources, else a path beside the scenario."""
        beside = self._path.resolve().parent if self._path else Path.cwd()
        named = {name: self.system_path / "resources" / f"{name}.ssv" for name in self.parameters}
        return [path if path.exists() else beside / name for name, path in named.items()]


@dataclass(frozen=True)
class Verdict:
    """Whether an expectation holds.

    Parameters
    ----------
    expect : Expectation
        What was expected.
    passed : bool
        Whether it holds.
    worst : float
        Value farthest on the wrong side: a distance where `near` was given, else the signal. NaN without a row.
    time : float
        When. [s]
    """

    expect: Expectation
    passed: bool
    worst: float
    time: float

    def __str__(self):
        measure = "distance" if self.expect.near is not None else "value"
        found = f"worst {measure} {self.worst:.4g} at {self.time:g} s" if np.isfinite(self.time) else "no row to judge"
        return f"{'holds' if self.passed else 'FAILS'}: {self.expect} ({found})"


def read_scenario(path: str | os.PathLike) -> Scenario:
    """Read and check a scenario file.

    Raises
    ------
    ShipcosimError
        With every problem of the file: its line, what was found, what would be right.
    """
    path = Path(path)
    text = _text(path)
    try:
        content = toml_of(text)
    except ValueError as error:
        raise ShipcosimError(_no_toml(path, str(error))) from error
    try:
        scenario = Scenario.model_validate(content)
    except ValidationError as error:
        raise ShipcosimError(_problems_of(path, text, error)) from None
    scenario._path = path
    if problems := [p for p in check_times(scenario) if p.severity == "error"]:
        raise ShipcosimError(problems)
    return scenario


def toml_of(text: str) -> dict:
    """Content of a TOML text.

    Raises
    ------
    ValueError
        If it is none, or one that no reader comes to an end with: lines, brackets and numbers of thousands of parts.
    """
    if (longest := max(map(len, text.split("\n")))) > LONGEST_LINE:
        raise ValueError(f"a line has {longest} characters, at most {LONGEST_LINE} are read")
    try:
        content = tomllib.loads(text)
        too_large = any(abs(number) >= 2**64 for number in _whole_numbers(content))
    except RecursionError:
        raise ValueError("brackets or tables are nested too deep") from None
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:
        raise ValueError("a number has thousands of digits") from None
    if too_large:
        raise ValueError("a whole number has more than 64 bits")
    return content


def _whole_numbers(content):
    """All whole numbers in what a TOML text holds."""
    if isinstance(content, (dict, list)):
        for part in content.values() if isinstance(content, dict) else content:
            yield from _whole_numbers(part)
    elif isinstance(content, int):
        yield content


def _text(path):
    try:
        return path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n")
    except OSError as error:
        raise ShipcosimError(Problem(str(path), f"cannot be read: {error.strerror or error}.")) from error
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        found = f"is not UTF-8 text: byte 0x{error.object[error.start]:02x} is none of its characters."
        raise ShipcosimError(Problem(f"{path}, line {line}", found, "Save the file in UTF-8.")) from error


def _no_toml(path, message):
    """What the TOML reader says, with its line where all other messages have theirs."""
    line = re.search(r" \(at line (\d+), column \d+\)", message)
    where = f"{path}, line {line[1]}" if line else str(path)
    found = f"is no TOML: {message.replace(line[0], '') if line else message}."
    return Problem(where, found, "Scenarios are text files in TOML: keys, =, values, texts in quotes.")


def check_files(scenario: Scenario) -> list[Problem]:
    """What a scenario names and what is not there: its system, its parameter sets."""
    if not scenario.system:
        return [_at(scenario, ("system",), "the scenario names no system.", suggestion("", _systems(scenario)))]
    system, problems = scenario.system_path, []
    if not system.exists() and "#" not in scenario.system:
        known = _systems(scenario)
        found = f"there is no system '{scenario.system}', in {scenario.project / 'ssp'} or beside the scenario."
        return [_at(scenario, ("system",), found, suggestion(scenario.system, known))]
    for name, path in zip(scenario.parameters, scenario.parameter_paths, strict=True):
        if not path.exists():
            known = [file.stem for file in (system / "resources").glob("*.ssv")]
            found = f"there is no parameter set '{name}', in {system / 'resources'} or beside the scenario."
            problems.append(_at(scenario, ("parameters",), found, suggestion(name, known)))
    return problems


def _systems(scenario):
    return [ssd.parent.name for ssd in scenario.project.joinpath("ssp").glob("*/SystemStructure.ssd")]


def whole_steps(duration: float, step_size: float) -> int | None:
    """How many steps make up a duration; None if it is no whole number, to a millionth of a step.

    Examples
    --------
    >>> whole_steps(1100.0, 0.05)
    22000
    >>> whole_steps(0.12, 0.05) is None
    True
    """
    count = round(duration / step_size)
    return count if abs(duration / step_size - count) <= 1e-6 else None


def check_times(scenario: Scenario) -> Iterator[Problem]:
    """Times of a scenario that do not fall on its steps, or lie after its end."""
    step, stop = scenario.step_size, scenario.stop_time
    if stop / step > MOST_STEPS:
        found = f"stop_time = {stop:g} s takes {stop / step:.3g} steps of {step:g} s."
        remedy = f"At most {MOST_STEPS:,.0f} are done: take larger steps or stop earlier."
        yield _at(scenario, ("stop_time",), found, remedy)
        return
    times = [(("stop_time",), stop), (("output_interval",), scenario.output_interval or step)]
    times += [(("events", number, "time"), event.time) for number, event in enumerate(scenario.events)]
    for keys, time in times:
        count = whole_steps(time, step)
        if count is None or (count == 0 and keys[0] != "events"):
            found = f"{keys[-1]} = {time:g} s is no multiple of the step size {step:g} s."
            nearest = max(1, round(time / step)) * step
            yield _at(scenario, keys, found, f"The nearest would be {nearest:g} s.")
        elif keys[0] == "events" and time >= stop:
            found = f"the event at {time:g} s never acts: the run ends at {stop:g} s."
            yield _at(scenario, keys, found, severity="remark")
    for number, expect in enumerate(scenario.expect):
        if expect.during and expect.during[1] > stop:
            found = f"during = {expect.during} reaches beyond the end of the run at {stop:g} s."
            yield _at(scenario, ("expect", number, "during"), found, severity="remark")


def check_scenario(scenario: Scenario, system: System) -> list[Problem]:
    """Hold the events and expectations of a scenario against a system.

    Parameters
    ----------
    scenario : Scenario
        Checked in itself.
    system : System
        That it runs. Start values are checked by `shipcosim.ssp.with_values`.
    """
    problems = list(check_times(scenario))
    for number, event in enumerate(scenario.events):
        for verb, signal, value in event.changes:
            if complaint := _event_complaint(system, verb, signal, value):
                problems.append(_at(scenario, ("events", number, verb, signal), *complaint))
    changed = {signal for event in scenario.events for _, signal, _ in event.changes}
    for number, expect in enumerate(scenario.expect):
        for signal in expect.signals:
            if complaint := _expect_complaint(system, signal, changed):
                problems.append(_at(scenario, ("expect", number, "signal"), *complaint))
    return problems


def _event_complaint(system, verb, signal, value):
    """What is wrong with a change of a signal, as (found, remedy), or None."""
    try:
        component, name = system.split(signal)
    except ShipcosimError as error:
        return error.problems[0].found, error.problems[0].remedy
    if component is None and name not in system.inputs:
        return f"'{signal}' is no input of the system.", f"Inputs: {', '.join(system.inputs) or 'none'}."
    variable = system.inputs[name] if component is None else system.components[component].fmu.variables[name]
    kind = variable.type if component is None else variable.kind
    if component is not None and not _may_change(variable):
        remedy = "Events change inputs, outputs and tunable parameters; [set] sets parameters before the start."
        return f"'{signal}' is a {variable.variability} {variable.causality}.", remedy
    if verb != "reset" and not _fits(value, kind, variable.items, verb):
        items = f" Its items are {', '.join(variable.items)}." if variable.items else ""
        return (
            f"{verb} of '{signal}' with {value!r}: the signal is {kind}.",
            f"{_WANTED.get(kind, 'It cannot be changed.')}{items}",
        )
    return None


def _may_change(variable):
    return variable.causality in ("input", "output") or (variable.causality, variable.variability) == (
        "parameter",
        "tunable",
    )


_WANTED = {
    "Real": "A number is needed.",
    "Integer": "A whole number is needed.",
    "Boolean": "Override it with true or false.",
    "Enumeration": "Override it with the name or number of an item.",
}


def _fits(value, kind, items, verb):
    if kind == "Boolean":
        return isinstance(value, bool) and verb == "override"
    if kind == "Enumeration":
        return verb == "override" and (value in items or value in items.values())
    if isinstance(value, bool):
        return False
    if kind == "Integer":
        return isinstance(value, (int, float)) and value == int(value)
    return kind == "Real" and isinstance(value, (int, float))


def _expect_complaint(system, signal, changed):
    """Why a signal will not be in the table, as (found, remedy), or None."""
    try:
        component, name = system.split(signal)
    except ShipcosimError as error:
        return error.problems[0].found, error.problems[0].remedy
    if component is None or signal in changed:
        return None
    variable = system.components[component].fmu.variables[name]
    feeding = next((c.source for c in system.connections if c.target == (component, name)), None)
    if variable.causality == "input" and feeding is not None:
        source = ".".join(filter(None, feeding))
        return f"'{signal}' is not recorded: it is what {source} puts out.", f"Expect something of {source}."
    if variable.causality not in ("input", "output") or variable.kind == "String":
        return f"'{signal}' is not recorded: it is a {variable.kind} {variable.causality}.", "Outputs and inputs are."
    return None


def judge(table: xarray.Dataset, scenario: Scenario) -> list[Verdict]:
    """Verdict on each expectation of a scenario, in its order.

    A window without a row, or a signal that is not finite, fails.

    Raises
    ------
    ShipcosimError
        If a signal is not in the table.
    """
    missing = [
        Problem(scenario.name, f"the table has no signal '{signal}'.", suggestion(signal, map(str, table.data_vars)))
        for expect in scenario.expect
        for signal in expect.signals
        if signal not in table
    ]
    if missing:
        raise ShipcosimError(missing)
    return [_verdict(table, expect) for expect in scenario.expect]


def _verdict(table, expect):
    times = table["time"].values
    start, end = expect.during or (-np.inf, np.inf)
    tolerance = 1e-9 * max(1.0, abs(times[-1])) if len(times) else 0.0
    rows = np.flatnonzero((times >= start - tolerance) & (times <= end + tolerance))
    if len(rows) == 0:
        return Verdict(expect, False, np.nan, np.nan)
    rows, values = _reduced(rows, _values(table, expect, rows), expect.statistic)
    excess = _excess(values, expect)
    worst = int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))
    measure = values[worst, 0] if expect.near is None else np.linalg.norm(values[worst])
    return Verdict(expect, bool(excess[worst] <= 0.0), float(measure), float(times[rows[worst]]))


def _values(table, expect, rows):
    """The signals, or their differences from `near`; (n, signals)."""
    values = np.column_stack([table[s].values[rows].astype(float) for s in expect.signal])
    if expect.near is None:
        return values
    targets = [table[v].values[rows].astype(float) if isinstance(v, str) else v for v in expect.near]
    for i, (signal, target) in enumerate(zip(expect.signal, targets, strict=True)):
        values[:, i] -= target
        if table[signal].attrs.get("units") == "rad":
            values[:, i] = (values[:, i] + np.pi) % (2.0 * np.pi) - np.pi
    return values


def _reduced(rows, values, statistic):
    """Rows and values that remain after the statistic: one, or all."""
    if statistic == "mean":
        return rows[-1:], values.mean(axis=0, keepdims=True)
    if statistic == "final":
        return rows[-1:], values[-1:]
    if statistic in ("max", "min"):
        extreme = getattr(np, statistic)(values, axis=0, keepdims=True)
        return rows[np.argmax(values[:, 0] == extreme[0, 0])][None], extreme
    return rows, values


def _excess(values, expect):
    """By how much each row misses the expectation; negative where it holds."""
    if expect.near is not None:
        return np.linalg.norm(values, axis=1) - expect.within
    below = -np.inf if expect.at_least is None else expect.at_least - values[:, 0]
    above = -np.inf if expect.at_most is None else values[:, 0] - expect.at_most
    return np.maximum(below, above)


def _at(scenario, keys, found, remedy="", severity="error"):
    """Problem at a key of the scenario, with its line where the scenario came from a file."""
    path = scenario.path
    text = path.read_text(encoding="utf-8-sig") if path and path.is_file() else ""
    return Problem(_where(path or "scenario", text, keys), found, remedy, severity)


def _where(path, text, keys):
    line = _line(text, keys)
    return f"{path}, line {line}" if line else str(path)


def _line(text, keys):
    """Line of a key, or of the innermost table around it, in the text of a TOML file; 0 where there is none."""
    section, counts, depth, found = (), {}, 0, 0
    for number, line in enumerate(text.splitlines(), 1):
        here = section
        if header := re.match(r"\s*(\[\[?)\s*([\w.-]+)\s*\]", line):
            name, repeated = header[2], header[1] == "[["
            counts[name] = counts.get(name, -1) + 1
            section = here = (name, counts[name]) if repeated else (name,)
        elif key := re.match(r"""\s*(["']?)([\w.-]+)\1\s*=""", line):
            here = (*section, key[2])
        if len(here) > depth and here == tuple(keys[: len(here)]):
            depth, found = len(here), number
    return found


def _problems_of(path, text, error):
    """pydantic's findings in our words, one for each key, in the order of the file."""
    problems = {}
    for finding in error.errors():
        keys = finding["loc"]
        where = _line(text, keys), keys[: 3 if keys[0] in _PARTS else 2]
        problems.setdefault(where, Problem(_where(path, text, keys), *_found_and_remedy(finding)))
    return [problems[where] for where in sorted(problems, key=lambda where: where[0])]


def _found_and_remedy(finding):
    keys, kind = finding["loc"], finding["type"]
    part = _PARTS.get(keys[0], Scenario) if len(keys) > 1 else Scenario
    label = ".".join(str(k) for k in (keys if part is Scenario else keys[2:]))
    if kind == "extra_forbidden":
        return f"unknown key '{keys[-1]}'.", suggestion(str(keys[-1]), part.model_fields)
    if kind == "missing":
        return f"'{keys[-1]}' is missing.", ""
    if kind == "value_error":
        return str(finding["ctx"]["error"]), ""
    remedy = _REMEDIES.get(kind) or finding["msg"].replace("Input", "It", 1) + "."
    return f"{label} = {_as_toml(finding['input'])}.", remedy


def _as_toml(value):
    return json.dumps(value, ensure_ascii=False) if isinstance(value, (bool, str)) else repr(value)


_REMEDIES = {
    "string_type": "It should be a text in quotes.",
    "float_type": "It should be a number, without quotes and with a decimal point.",
    "list_type": "It should be a list: [ , ].",
    "too_short": "It takes more values than that.",
    "too_long": "It takes fewer values than that.",
}
"""What would be right, where pydantic's words would not help."""


_PARTS = {"events": Event, "expect": Expectation}
