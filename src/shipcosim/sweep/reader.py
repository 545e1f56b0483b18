"""Read a study file and those that it extends; problems name their line."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from shipcosim import library
from shipcosim.errors import Problem, ShipcosimError, error_at, raise_errors
from shipcosim.scenario.locations import AnyKeys, line_of, location_of
from shipcosim.scenario.reader import complaint_of, read_toml
from shipcosim.ssp import AnyPath
from shipcosim.sweep.study_model import Study

LISTS = {"factor": "name", "quantity": "name", "summary": "name", "view": "title"}
"""Lists in which a later study replaces entries of the same name."""


@dataclass
class Source:
    """Source of a study: content, files, origins.

    Parameters
    ----------
    content : dict
        All that was written, with what the study extends.
    files : list of (Path, str)
        Files and their texts, those that extend others first.
    origins : dict of str to list of (int, int)
        Of each item of a list the number of its file, and its position there.
    """

    content: dict[str, Any]
    files: list[tuple[Path, str]]
    origins: dict[str, list[tuple[int, int]]] = field(default_factory=dict)

    def location(self, keys: AnyKeys) -> str:
        """File and line of a key."""
        # An item of a list may come from an extended study; its origin is known.
        first = str(keys[0]) if keys else ""
        rest = tuple(keys[1:])
        if (
            first in self.origins
            and rest
            and isinstance(rest[0], int)
            and rest[0] < len(self.origins[first])
        ):
            number, position = self.origins[first][rest[0]]
            return location_of(*self.files[number], (first, position, *rest[1:]))
        # The most specific part of the key that has a line of its own; files that extend others
        # come first.
        for length in range(len(keys), 0, -1):
            for path, text in self.files:
                if (line := line_of(text, keys[:length])) and (
                    length == 1 or line != line_of(text, keys[: length - 1])
                ):
                    return f"{path}, line {line}"
        return str(self.files[0][0])


def read_study(path: AnyPath) -> Study:
    """Read and check a study file in itself; `shipcosim.sweep.plan` checks it with its scenario.

    Raises
    ------
    ShipcosimError
        With every problem of the file: its line, what was found, what would be right.
    """
    return study_of(_read(Path(path), ()))


def study_of(source: Source) -> Study:
    """The study of what was read.

    Raises
    ------
    ShipcosimError
        With every problem: its line, what was found, what would be right.
    """
    try:
        study = Study.model_validate(source.content)
    # A misspelt key also looks like a missing one: report the misspelling, and only one problem per
    # place.
    except ValidationError as error:
        problems = {}
        for finding in sorted(
            error.errors(), key=lambda finding: finding["type"] == "missing"
        ):  # perhaps it is misspelt
            keys = finding["loc"]
            problems.setdefault(
                keys[:3], Problem(source.location(keys), *complaint_of(finding, Study))
            )
        raise ShipcosimError(list(problems.values())) from None
    study._path = source.files[0][0]
    study._source = source
    problems = _repeated(study)
    if study.sample is not None and study.tune is not None:
        message = "A study has either [sample] or [tune]."
        problems.append(problem_of(study, ("tune",), message, "Take one out."))
    raise_errors(problems)
    return study


def problem_of(study: Study, keys: AnyKeys, message: str, remedy: str = "") -> Problem:
    """Problem at a key of a study, with its line where it was read from a file."""
    return Problem(study._source.location(keys) if study._source else study.name, message, remedy)


def _read(path: Path, before: tuple[Path, ...]) -> Source:
    text, content = read_toml(path, "Studies")
    source = Source(content, [(path, text)])
    # Remember the file and place of each list item for messages.
    source.origins = {
        name: [(0, i) for i in range(len(content[name]))]
        for name in LISTS
        if _is_list(content, name)
    }
    # The extended study lies beside this one or is known by name.
    base = content.pop("extends", None)
    if base is None:
        return source
    where = source.location(("extends",))
    resolved = path.resolve()
    if not isinstance(base, str):
        raise error_at(
            where, f"extends = {base!r}.", "Give the name or path of a study, in quotes."
        )
    neighbour = resolved.parent / base
    try:
        extended = (
            neighbour if neighbour.is_file() else library.find("study", base, near=resolved.parent)
        )
    except ShipcosimError as error:
        raise error_at(where, f"There is no study '{base}'.", error.problems[0].remedy) from None
    # Studies that extend each other in a circle would never end.
    if extended.resolve() in (resolved, *before):
        raise error_at(
            where, f"'{base}' extends this study in turn.", "Extend a study that does not."
        )
    return _over(_read(extended, (*before, resolved)), source)


def _is_list(content: dict[str, Any], name: str) -> bool:
    return isinstance(content.get(name), list) and all(
        isinstance(entry, dict) for entry in content[name]
    )


def _over(base: Source, extending: Source) -> Source:
    """Merge a study with the one that it extends."""
    files = [*extending.files, *base.files]
    shift = len(extending.files)
    # What the other study says, with the scenario that lies beside it by its path.
    anchored = dict(base.content)
    if isinstance(anchored.get("scenario"), str):
        neighbour = base.files[0][0].resolve().parent / anchored["scenario"]
        if neighbour.is_file():
            anchored["scenario"] = str(neighbour)
    content = _merged(anchored, extending.content)
    origins = {}
    # Lists merge by name: an item of the same name replaces the old one in its place, others are
    # added.
    for name in LISTS:
        if not any(_is_list(source.content, name) for source in (base, extending)):
            continue
        items = [(item, (n + shift, i)) for item, (n, i) in _items(base, name)]
        for item, origin in _items(extending, name):
            label = item.get(LISTS[name])
            same = next(
                (i for i, (old, _) in enumerate(items) if label and old.get(LISTS[name]) == label),
                None,
            )
            if same is None:
                items.append((item, origin))
            else:
                items[same] = item, origin
        content[name], origins[name] = [item for item, _ in items], [origin for _, origin in items]
    return Source(content, files, origins)


def _items(source: Source, name: str) -> list[tuple[dict[str, Any], tuple[int, int]]]:
    return list(zip(source.content.get(name, []), source.origins.get(name, []), strict=False))


def _merged(base: dict[str, Any], extending: dict[str, Any]) -> dict[str, Any]:
    """Merge tables key by key; other values are those of `extending`."""
    both = {
        n: _merged(base[n], extending[n])
        for n in base.keys() & extending.keys()
        if isinstance(base[n], dict) and isinstance(extending[n], dict)
    }
    return {**base, **extending, **both}


def _repeated(study: Study) -> list[Problem]:
    """Problems of repeated column names."""
    seen = {}
    problems = []
    # Factors, samples, searches, quantities and summaries share the columns of the tables.
    columns = [(("factor", i, "name"), factor.name) for i, factor in enumerate(study.factor)]
    for part, drawn in (("sample", study.sample), ("tune", study.tune)):
        of = drawn.of if drawn is not None else {}
        columns += [((part, "of", signal), line.name or signal) for signal, line in of.items()]
    columns += [
        (("quantity", i, "name"), quantity.name) for i, quantity in enumerate(study.quantity)
    ]
    columns += [(("summary", i, "name"), summary.name) for i, summary in enumerate(study.summary)]
    for keys, name in columns:
        if name in seen:
            message = f"'{name}' is a {seen[name]} already."
            problems.append(
                problem_of(
                    study, keys, message, "Give each column of the tables a name of its own."
                )
            )
        seen.setdefault(name, str(keys[0]))
    return problems
