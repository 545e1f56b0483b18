"""A project with one small FMU, which can fail and end its process on demand, and a scenario for studies."""

from pathlib import Path

import pytest
from sweep.projects import built_project, work_in

FMU = '''
"""Lag that can fail, and end its process, on demand."""

import os
import random
import time

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Lag(Fmu):
    """First-order lag with noise."""

    u = Input("m", "input", start=1.0)
    y = Output("m", "output")
    time_constant = Parameter(1.0, "s", "time constant", minimum=0.01)
    noise = Parameter(0.0, "m", "largest noise")
    seed = Parameter(1, "1", "seed of the noise")
    fails_above = Parameter(1e9, "m", "input above which its step raises")
    ends_above = Parameter(1e9, "m", "input above which its process ends")
    pause = Parameter(0.0, "s", "time that its start takes on the clock")

    def start(self):
        self.y = 0.0
        self.random = random.Random(self.seed)
        time.sleep(self.pause)

    def step(self, t, h):
        if self.u > self.ends_above:
            os._exit(1)
        if self.u > self.fails_above:
            raise ValueError("the pump has run dry")
        self.y += h / self.time_constant * (self.u - self.y) + self.noise * self.random.uniform(-1.0, 1.0)
'''
SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="tank" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssd:System name="tank">
    <ssd:Elements>
      <ssd:Component name="lag" type="application/x-fmu-sharedlibrary" source="resources/lag.fmu"/>
      <ssd:Component name="other" type="application/x-fmu-sharedlibrary" source="resources/lag.fmu"/>
    </ssd:Elements>
  </ssd:System>
</ssd:SystemStructureDescription>
"""
SCENARIO = """
system    = "tank"
stop_time = 2.0
step_size = 0.1

[set]
"lag.noise" = 0.01

[[expect]]
signal  = "lag.y"
at_most = 2.5
"""
STUDY = """
scenario = "filling"

[[factor]]
name   = "level"
signal = "lag.u"
values = ["100 cm", 2.0, 3.0]

[[factor]]
name  = "seed"
seeds = 4

[[quantity]]
name   = "highest"
signal = "lag.y"
reduce = "maximum"

[[quantity]]
name = "held"
scenario_expectations = true

[[summary]]
name      = "mean"
quantity  = "highest"
over      = "seed"
statistic = "mean"

[[summary]]
name      = "share"
quantity  = "held"
over      = "seed"
statistic = "share"
"""


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    files = {
        "fmus/lag/lag.py": FMU,
        "ssp/tank/SystemStructure.ssd": SSD,
        "scenarios/filling.toml": SCENARIO,
        "studies/levels.toml": STUDY,
    }
    return built_project(tmp_path_factory.mktemp("studies"), files)


@pytest.fixture
def project(built, tmp_path, monkeypatch):
    """Folder of the project, as the working folder; studies and results are those of the test alone."""
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "levels.toml").write_text(STUDY)
    return work_in(tmp_path, built, monkeypatch)


@pytest.fixture
def study(project):
    """Function that writes a study of this text over the one of the project, and gives its path."""

    def write(text, name="own") -> Path:
        path = project / "studies" / f"{name}.toml"
        path.write_text(text)
        return path

    return write
