"""Scenario files of the Open Simulation Platform, JSON or YAML: reading and writing.

They are read as libcosim (tried: libcosimpy 0.0.6) acts: times count from the start of the run and
move up to the next step. At the end, but not before the step after the last event, every changed
signal follows its source again.
"""

import json
import math
import os
from collections.abc import Iterable, Iterator
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from shipcosim.errors import Problem, error_at, raise_errors, suggestion
from shipcosim.scenario.model import Event, Value
from shipcosim.series import write_file

KEYS = ("description", "defaults", "events", "end")
EVENT_KEYS = ("time", "model", "variable", "action", "value")
DEFAULTS = ("model", "variable", "action")
ACTIONS = ("override", "bias", "reset")
LARGEST = 16 << 20  # bytes; YAML is read slowly
LARGEST_YAML = 1 << 20
DEEPEST = 100  # brackets in brackets
FAST: Any = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
LARGEST_NUMBER = 1e300
BOOLEANS = {"true": True, "false": False}
Change = tuple[int, str, str, Value | None]  # step, action, signal, value


class OspScenario(NamedTuple):
    """Content of a file.

    Parameters
    ----------
    description : str
        Its text.
    events : list of Event
        In the order of the file; what the end takes back is the last one.
    remarks : list of Problem
        What a user should know although it stops nothing.
    """

    description: str
    events: list[Event]
    remarks: list[Problem]


def read_osp_scenario(
    path: str | os.PathLike, step_size: float, stop_time: float, start_time: float = 0.0
) -> OspScenario:
    """Read a scenario file of OSP.

    Parameters
    ----------
    path : path
        .json, .yaml or .yml.
    step_size, stop_time, start_time : float
        Of the run; the events get times on its clock. [s]

    Raises
    ------
    ShipcosimError
        With every problem of the file.
    """
    path = Path(path)
    # The file as plain data.
    content = _content(path)
    if not isinstance(content, dict):
        raise error_at(
            str(path),
            "It holds no object at its top.",
            "Right would be an object with a list 'events'.",
        )
    # All problems of the file together.
    due, remarks, problems = _changes(path, content, step_size)
    end = None
    try:
        end = None if content.get("end") is None else _seconds(content["end"], "end")
    except ValueError as error:
        problems.append(Problem(str(path), *error.args))
    raise_errors(problems)
    # Where libcosim acts unexpectedly, a remark.
    remarks += _doubts(path, due, end, step_size)
    # At the end everything returns to its source.
    due += _taken_back(due, end, step_size, stop_time - start_time)
    events = []
    for count, action, signal, value in due:
        change = [signal] if action == "reset" else {signal: value}
        time = start_time + count * step_size
        events.append(Event.model_validate({"time": time, action: change}))
    return OspScenario(str(content.get("description") or ""), events, remarks)


def _changes(
    path: Path, content: dict[str, Any], step_size: float
) -> tuple[list[Change], list[Problem], list[Problem]]:
    """Changes of all events in file order, remarks, and problems of single events."""
    # Unknown keys are ignored by libcosim: remark them.
    remarks = list(_unknown(str(path), content, KEYS))
    problems = []
    defaults = content.get("defaults") or {}
    listed = content.get("events") or []
    if not isinstance(defaults, dict) or not isinstance(listed, list):
        raise error_at(str(path), "'defaults' has to be an object, 'events' a list.")
    defaults = {name: value for name, value in defaults.items() if name in DEFAULTS}
    due = []
    # Each event alone: one faulty event does not hide the others.
    for number, given in enumerate(listed, start=1):
        place = f"{path}, event {number}"
        if not isinstance(given, dict):
            problems.append(
                Problem(
                    place, "An event has to be an object.", f"Its keys: {', '.join(EVENT_KEYS)}."
                )
            )
            continue
        remarks += _unknown(place, given, EVENT_KEYS)
        try:
            due.append(_change(given, defaults, step_size))
        except ValueError as error:
            problems.append(Problem(place, *error.args))
    return due, remarks, problems


def scenario_text(description: str, events: list[dict], end: float, suffix: str = ".json") -> str:
    """Text of a scenario file of OSP.

    Parameters
    ----------
    description : str
        One line.
    events : list of dict
        With time, model, variable, action and value, as in the file.
    end : float
        When everything that was changed follows its source again. libcosim needs it. [s]
    suffix : str
        ``".json"``, ``".yaml"`` or ``".yml"``.
    """
    content = {"description": description, "events": events, "end": end}
    if suffix == ".json":
        return json.dumps(content, indent=2, ensure_ascii=False) + "\n"
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True)


def write_osp_scenario(
    path: str | os.PathLike, description: str, events: list[dict], end: float
) -> None:
    """Write a scenario file of OSP, complete or not at all; see `scenario_text`."""
    write_file(path, scenario_text(description, events, end, Path(path).suffix.lower()).encode())


def _content(path: Path) -> Any:
    """Content of the file as dicts and lists; every scalar of YAML is a text."""
    # Text of limited size: YAML is slow to read.
    try:
        data = path.read_bytes()
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise error_at(str(path), f"Cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError:
        raise error_at(str(path), "It is not UTF-8 text.", "Save the file in UTF-8.") from None
    largest = LARGEST if path.suffix.lower() == ".json" else LARGEST_YAML
    if len(data) > largest:
        raise error_at(
            str(path), "The file is too large.", f"At most {largest >> 20} MiB are read."
        )
    # JSON as it is; YAML without deep nesting and aliases, which can grow without limit.
    try:
        if path.suffix.lower() == ".json":
            return json.loads(text, object_pairs_hook=_once)
        if max(accumulate((c in "[{") - (c in "]}") for c in text), default=0) > DEEPEST:
            raise ValueError(f"brackets are nested deeper than {DEEPEST}")
        if any(isinstance(event, yaml.AliasEvent) for event in yaml.parse(text, Loader=FAST)):
            raise ValueError("it uses an alias (*name)")
        return yaml.load(text, Loader=_Loader)
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        kind = "JSON" if path.suffix.lower() == ".json" else "YAML"
        raise error_at(
            str(path),
            f"It cannot be read as {kind}: {' '.join(str(error).split())}.",
            "Correct it there.",
        ) from None


def _once(pairs: list[tuple[Any, Any]]) -> dict[Any, Any]:
    """A mapping of pairs; raises ValueError if a name occurs twice."""
    content = dict(pairs)
    if len(content) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(
            f"'{next(name for name in names if names.count(name) > 1)}' is there twice"
        )
    return content


class _Loader(FAST):
    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        return _once(
            [
                (self.construct_object(k, deep=True), self.construct_object(v, deep=True))
                for k, v in node.value
            ]
        )


def _unknown(place: str, given: Iterable[str], allowed: Iterable[str]) -> Iterator[Problem]:
    for name in given:
        if name not in allowed:
            yield Problem(
                place, f"'{name}' is not used.", f"Known: {', '.join(allowed)}.", "remark"
            )


def _change(given: dict[str, Any], defaults: dict[str, Any], step_size: float) -> Change:
    """(step, action, signal, value) of an event; raises ValueError with found and remedy."""
    # libcosim acts at the first step at or after the time.
    if "time" not in given:
        raise ValueError("It has no time.", "Give it in seconds from the start of the run.")
    count = max(0, math.ceil(_seconds(given["time"], "time") / step_size - 1e-6))
    # The event's own keys come before the defaults.
    model, variable, action = (
        _text(given.get(name, defaults.get(name)), name) for name in DEFAULTS
    )
    if action not in ACTIONS:
        raise ValueError(f"The action '{action}' is not known.", suggestion(action, ACTIONS))
    # A reset has no value; a bias must be a number.
    value = None if action == "reset" else _value(given.get("value"))
    if action == "bias" and (isinstance(value, (str, bool))):
        raise ValueError(f"A bias of {value!r}.", "A bias is a number.")
    return count, action, f"{model}.{variable}", value


def _text(given: Any, name: str) -> str:
    if not isinstance(given, str):
        raise ValueError(f"It has no {name}, and the defaults have none.", f"Give it a {name}.")
    return given


def _seconds(given: Any, name: str) -> float:
    value = _value(given)
    if isinstance(value, (bool, str)):
        raise ValueError(f"{name} is {value!r}.", "Give it in seconds.")
    return float(value)


def _value(given: Any) -> Value:
    """A scalar by its text, as libcosim reads it, which ignores quotes."""
    if given is None or isinstance(given, (list, dict)):
        raise ValueError("It has no value.", "A value is a number, true or false.")
    value = _typed(given) if isinstance(given, str) else given
    if not isinstance(value, (bool, str)) and not abs(value) < LARGEST_NUMBER:
        raise ValueError(f"{given} is no usable number.", "Give a finite one.")
    return value


def _typed(text: str) -> Value:
    # Boolean, integer, number, else text; Python's 1_000 is no number in YAML.
    if text.lower() in BOOLEANS:
        return BOOLEANS[text.lower()]
    for convert in (int, float):
        try:
            return convert(text.replace("_", "x"))
        except ValueError:
            continue
    return text


def _doubts(
    path: Path, due: list[Change], end: float | None, step_size: float
) -> Iterator[Problem]:
    """Remarks on unexpected behaviour of libcosim."""
    # Two changes of one signal in one step: the order in libcosim is undefined.
    seen = set()
    for count, _, signal, _ in due:
        if (count, signal) in seen:
            message = f"{signal} is changed twice in the step at {count * step_size:g} s; the later one in the file acts."
            yield Problem(
                str(path), message, "libcosim takes them in any order: keep one of them.", "remark"
            )
        seen.add((count, signal))
    # Without an end libcosim takes everything back after the last event.
    if due and end is None:
        last = (max(count for count, *_ in due) + 1) * step_size
        message = f"It has no end: as in libcosim everything is taken back in the next step, at {last:g} s."
        yield Problem(str(path), message, 'Give "end", in seconds.', "remark")


def _taken_back(
    due: list[Change], end: float | None, step_size: float, duration: float
) -> Iterator[Change]:
    """Changes at the end that reset every changed signal; none if the run is over by then."""
    if not due:
        return
    # Not before the step after the last event.
    last = max(count for count, *_ in due) + 1
    count = max(last, math.ceil((end or 0.0) / step_size - 1e-6))
    # Beyond the end of the run nothing needs to be reset.
    if count * step_size < duration - 1e-9:
        for signal in dict.fromkeys(signal for _, _, signal, _ in due):
            yield count, "reset", signal, None
