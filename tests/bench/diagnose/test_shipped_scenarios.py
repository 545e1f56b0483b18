"""Runs of the shipped scenarios as logs: nothing is named but the current and the waves that the weather has.

The system that they are compared with knows the wind and no other weather. Failures and sensors of a scenario are none
of the log: it has what the thrusters did and where the ship was.
"""

import tomllib
from pathlib import Path

import pytest

import shipcosim as sc

SCENARIOS = Path(__file__).resolve().parents[3] / "scenarios"


def weather(name):
    """Values that a scenario sets, by name; None of a scenario of another ship."""
    scenario = tomllib.loads((SCENARIOS / f"{name}.toml").read_text(encoding="utf-8"))
    if (scenario["system"], scenario.get("parameters")) != ("gunnerus_dp", "gunnerus-33m9"):
        return None
    return scenario.get("set", {})


def scenarios():
    files = sorted(SCENARIOS.rglob("*.toml"))
    names = [file.relative_to(SCENARIOS).with_suffix("").as_posix() for file in files]
    return [name for name in names if weather(name) is not None]


@pytest.mark.parametrize("name", scenarios())
def test_nothing_is_named_that_is_not_there(name, tmp_path):
    there = weather(name)
    right = set()
    if there.get("environment.current_speed"):
        right |= {"current", "current_varying"}
    if there.get("environment.significant_wave_height"):
        right |= {"wave_drift"}
    run = sc.run(name, out=tmp_path / "run").table
    diagnosis = sc.diagnose(run, out=tmp_path / "diagnosis")
    assert {finding.cause for finding in diagnosis.findings} <= right
    assert diagnosis.verdict != "named" or diagnosis.findings


PLANTED = {
    ("port.thrust_loss", 0.25): "thrust_loss",
    ("tunnel.thrust_loss", 0.15): "thrust_loss",
    ("port.azimuth_offset", 0.17): "azimuth_offset",
    ("vessel.wind_load_scale", 1.5): "wind_scale",
    ("vessel.mass_scale", 1.25): "mass",
    ("vessel.cross_flow_scale", 1.6): "crossflow",
}
"""A number that a run gets otherwise, beside the current of its scenario: its cause."""


@pytest.mark.parametrize("planted", PLANTED)
def test_a_number_that_a_run_had_otherwise_is_named(planted, tmp_path):
    number, value = planted
    run = sc.run("four_corner", set={number: value}, out=tmp_path / "run").table
    diagnosis = sc.diagnose(run, out=tmp_path / "diagnosis")
    assert {finding.cause for finding in diagnosis.findings} == {"current", PLANTED[planted]}
