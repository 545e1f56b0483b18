"""A compared log as an identification problem, in which causes are sought."""

from dataclasses import dataclass, replace

from shipcosim.diagnose.checked_log import CheckedLog
from shipcosim.diagnose.compared_log import ComparedLog, LogComparison
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.inference.fitting import IdentificationProblem
from shipcosim.diagnose.inference.problem import identification_problem


@dataclass(frozen=True)
class Identification(CheckedLog):
    """A checked log as an identification problem; the faults grow by those that only the ship's response shows.

    Attributes
    ----------
    problem : IdentificationProblem
        Of the repaired log: noise and linearisation about the ship without a cause.
    misconnections : tuple of Finding
        Connections of the system that the log contradicts; `ship` has them corrected.
    comparison : LogComparison
        Of simulated with measured, commanded with measured force; empty by default.
    """

    problem: IdentificationProblem
    misconnections: tuple[Finding, ...] = ()
    comparison: LogComparison = LogComparison()


def identified(checked: ComparedLog) -> Identification:
    """A compared log as an identification problem; its ship gets surrogates of third-party FMUs for this log."""
    problem = identification_problem(checked.repaired, checked.ship, checked.causes)
    ship = replace(checked.ship, third_party=problem.model.third_party)
    fields = (checked.log, ship, checked.causes, checked.faults, checked.repaired, problem)
    return Identification(*fields, comparison=checked.comparison)
