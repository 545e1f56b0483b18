"""Parameters of one component: given by the ship file, else estimated by formulae."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from shipcosim.errors import Problem, capitalised, suggestion
from shipcosim.ships.entries import Quantity, table_entry
from shipcosim.ships.estimates.estimate import EstimatedNumber
from shipcosim.ships.given import PLAIN, Given, given_in_unit
from shipcosim.ships.kinds import metadata_of

ESTIMATED = "estimated: "
"""First words of the origin of a number that a formula gave."""


@dataclass
class Numbers:
    """Parameters of a component as they are found.

    Attributes
    ----------
    fmu : str
        FMU that the component is.
    where : str
        File and section, for messages.
    folder : Path
        Folder of the file, for its tables.
    source : str
        Where numbers come from that do not say it themselves.
    problems : list of Problem
        Gets what is wrong.
    entries : dict of str to Quantity
        What was found.
    """

    fmu: str
    where: str
    folder: Path
    source: str
    problems: list[Problem]
    entries: dict[str, Quantity] = field(default_factory=dict)

    def give(self, name: str, given: Given | None) -> None:
        """Take a number from the file, if it has one."""
        if given is None:
            return
        # Origin: the number's own, else that of the file.
        origin = given.origin or self.source or PLAIN
        unit = metadata_of(self.fmu)[name]["unit"]
        more = given.tolerance or 0.0, origin, (), f"{self.where}: {name}", given.uncertainty
        self.entries[name] = Quantity(given.value, unit, *more)

    def estimate(self, name: str, estimate: EstimatedNumber) -> None:
        """Take an estimate where no value is given."""
        if name in self.entries:
            return
        about = metadata_of(self.fmu)[name]
        origin = f"{ESTIMATED}{estimate.source}"
        where = f"{self.where}: {name}"
        self.entries[name] = Quantity(
            estimate.value, about["unit"], estimate.tolerance, origin, about["columns"], where
        )

    def estimates(self, estimates: dict[str, EstimatedNumber]) -> None:
        """Take all estimates for which no value is given."""
        for name, estimate in estimates.items():
            self.estimate(name, estimate)

    def table(self, name: str, file: str) -> None:
        """Take a table from a CSV file next to the ship file."""
        entry = table_entry(self.folder / file, f"{self.where}: {name}", self.problems)
        if entry is not None:
            self.entries[name] = entry

    def coefficients(self, coefficients: dict[str, Any]) -> None:
        """Take parameters that the file gives under the FMU's own names."""
        declared = metadata_of(self.fmu)
        for name, value in coefficients.items():
            if name not in declared:
                self.problems.append(
                    Problem(
                        f"{self.where}.{name}",
                        "There is no such number.",
                        suggestion(name, declared),
                    )
                )
            elif isinstance(value, dict) and "table" in value:
                self.table(name, str(value["table"]))
            else:
                try:
                    self.give(name, given_in_unit(value, declared[name]["unit"]))
                except ValueError as error:
                    sentence = capitalised(str(error))
                    self.problems.append(Problem(f"{self.where}.{name}", sentence))
