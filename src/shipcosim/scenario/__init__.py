"""Scenario files: what happens in a run, and what must hold."""

from shipcosim.scenario.model import (
    Event,
    Expectation,
    Scenario,
    Verdict,
    check_files,
    check_scenario,
    check_times,
    judge,
    read_scenario,
    toml_of,
    whole_steps,
)

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
    "toml_of",
    "whole_steps",
]
