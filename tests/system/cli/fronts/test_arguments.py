"""Every option of a command is an argument of its call, by its name or by the one listed here."""

import importlib
import inspect
import math

import numpy as np
import pytest

import shipcosim as sc
from shipcosim.calls.arguments import in_seconds, mapping
from shipcosim.errors import ShipcosimError
from shipcosim.options import RunKeywords
from shipcosim.scenario import Event

COMMANDS = (
    "run",
    "simulate",
    "sweep",
    "compare",
    "check",
    "diagnose",
    "replay",
    "sea_trials",
    "calibrate",
    "capability",
)
OTHER_NAMES = {
    "settings": "set",
    "effects": "causes",
    "failure": "failures",
    "ssp": "system",
    "data": "log",
    "every": "output_interval",
}
OF_THE_TERMINAL = {"debug", "as_json", "number", "serve", "port", "junit", "quiet"}
"""How a command prints, and what it does beside its call: `StudyResult.run(number)` is another call."""


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_of_a_command_is_an_argument_of_its_call(name):
    command = getattr(importlib.import_module(f"shipcosim.cli.commands.{name}"), name)
    call = getattr(sc, name)
    taken = set(inspect.signature(getattr(call, "__wrapped__", call)).parameters)
    if "options" in taken:
        taken |= set(RunKeywords.__annotations__)
    # `--scenario` of `simulate` is a scenario of OSP, which the call takes as its scenario.
    names = {"events": "scenario"} if name == "simulate" else {}
    options = set(inspect.signature(command).parameters) - OF_THE_TERMINAL
    asked = {(OTHER_NAMES | names).get(option, option) for option in options}
    assert asked <= taken, f"{name}: the call lacks {asked - taken}"


@pytest.mark.parametrize("value", [np.float32(2.5), np.int64(3), np.bool_(True), np.str_("a")])
def test_numbers_of_numpy_are_those_of_python(value):
    (taken,) = mapping("set", {"lag.u": value}).values()
    (held,) = Event(time=0.0, override={"lag.u": value}).override.values()
    assert type(taken) in (float, int, bool, str) and taken == held == value


@pytest.mark.parametrize("given", [5, "a.u=1", [("a.u", 1)], {1: 2}, {None: 1}])
def test_settings_are_a_mapping_of_names(given):
    with pytest.raises(ShipcosimError, match="Give a dict"):
        mapping("set", given)


@pytest.mark.parametrize("value", [10**400, np.float32("inf"), math.nan, -math.inf, True])
def test_a_time_is_a_finite_number(value):
    with pytest.raises(ShipcosimError, match="until = .* is no time"):
        in_seconds({"until": value}, ["until"])


@pytest.mark.parametrize("value", [2, np.float32(2.0), np.int64(2), "2 s"])
def test_a_time_is_a_number_of_python(value):
    assert type(in_seconds({"until": value}, ["until"])["until"]) is float
