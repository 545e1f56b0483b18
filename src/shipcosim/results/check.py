"""What a check found of files, and how it shows itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from shipcosim.errors import Problem, worth_showing
from shipcosim.results.shown import Check, Result, passed_or_failed

if TYPE_CHECKING:
    import pandas

    from shipcosim.report.notebook.card import Card


VARIABLE_KEYS = ("name", "causality", "type", "unit", "start", "description")
"""Texts of a variable."""


@dataclass(frozen=True, repr=False, eq=False)
class CheckedFiles(Result):
    """What `shipcosim.check` gives back.

    Attributes
    ----------
    files : mapping of str to tuple of Problem
        What was found of each file: errors, and remarks on what stops nothing.
    variables : mapping of str to tuple
        Of an FMU a row a variable: name, causality, type, unit, start, description.
    estimates : mapping of str to tuple
        Of a ship file a row a number that is estimated: number, value, tolerance, source.
    """

    files: Mapping[str, tuple[Problem, ...]]
    variables: Mapping[str, tuple[tuple[str, ...], ...]] = field(default_factory=dict)
    estimates: Mapping[str, tuple[tuple[str, ...], ...]] = field(default_factory=dict)

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Of all files."""
        return tuple(problem for problems in self.files.values() for problem in problems)

    @property
    def failures(self) -> tuple[Problem, ...]:
        """Problems that are errors."""
        return tuple(problem for problem in self.problems if problem.is_error)

    @property
    def passed(self) -> bool:
        """Whether no file has an error."""
        return not self.failures

    @property
    def checks(self) -> tuple[Check, ...]:
        """That each file has no error."""
        return tuple(
            Check(
                file,
                passed_or_failed(not any(problem.is_error for problem in problems)),
                "\n".join(map(str, worth_showing(problems))),
            )
            for file, problems in self.files.items()
        )

    def as_json(self) -> list[dict[str, Any]]:
        """What `shipcosim check --json` prints: an entry a file, with its problems and an FMU's variables."""
        listed = []
        for file, problems in self.files.items():
            entry: dict[str, Any] = {
                "file": file,
                "problems": [asdict(problem) for problem in problems],
            }
            if file in self.variables:
                entry["variables"] = [
                    dict(zip(VARIABLE_KEYS, row, strict=True)) for row in self.variables[file]
                ]
            listed.append(entry)
        return listed

    def to_pandas(self) -> pandas.DataFrame:
        """A row a problem: file, severity, where, found, remedy."""
        import pandas

        rows = [
            (file, problem.severity, problem.where, problem.found, problem.remedy)
            for file, problems in self.files.items()
            for problem in problems
        ]
        return pandas.DataFrame(rows, columns=["file", "severity", "where", "found", "remedy"])

    def _card(self) -> Card:
        from shipcosim.report.notebook.card import Card
        from shipcosim.report.theme.views import Block, Outcome, Table

        errors = sum(problem.is_error for problem in self.problems)
        remarks = len(self.problems) - errors
        message = (
            f"{errors or 'No'} error{'s' * (errors != 1)}"
            + f", {remarks} remark{'s' * (remarks > 1)}" * (remarks > 0)
        )
        head = ("variable", "causality", "type", "unit", "start", "meaning")
        return Card(
            title=f"Check of {', '.join(self.files)}",
            facts=(),
            outcome=Outcome("failed", "FAIL", f"{message}.")
            if errors
            else Outcome("passed", "PASS", f"{message}."),
            blocks=(
                *(
                    Block(name, lines=tuple(map(str, worth_showing(problems))))
                    for name, problems in self.files.items()
                ),
                *(
                    Block(f"Variables of {name}", Table(rows, head), folded=True)
                    for name, rows in self.variables.items()
                ),
            ),
        )
