"""Scenario files: what happens in a run, and what must hold.

A scenario is data. `read_scenario` reads and checks a file, `check_scenario` checks a scenario against a system,
`judge` compares a run's table with the expectations.
"""

from shipcosim.scenario.amounts import units_of, with_numbers
from shipcosim.scenario.check import (
    check_files,
    check_scenario,
    check_times,
    step_times,
    time_complaints,
)
from shipcosim.scenario.judge import Verdict, judge, within_run
from shipcosim.scenario.model import Event, Expectation, Record, Scenario
from shipcosim.scenario.plausible import odd_values
from shipcosim.scenario.reader import read_scenario, toml_of

__all__ = [
    "Event",
    "Expectation",
    "Record",
    "Scenario",
    "Verdict",
    "check_files",
    "check_scenario",
    "check_times",
    "judge",
    "odd_values",
    "read_scenario",
    "step_times",
    "time_complaints",
    "toml_of",
    "units_of",
    "with_numbers",
    "within_run",
]
