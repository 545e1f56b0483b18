"""Two projects: one as small as one can be, with one FMU, one system, one scenario; and a copy of the real one."""

import os
import shutil
from functools import cache
from types import SimpleNamespace

import pytest
from typer.main import get_command
from typer.testing import CliRunner

import shipcosim as sc
from shipcosim.cli import app
from shipcosim.library import build_stale

FMU = '''
"""Lag that can fail on demand."""

import time
from pathlib import Path

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Lag(Fmu):
    """First-order lag."""

    u = Input("m", "input", start=1.0)
    y = Output("m", "output")
    time_constant = Parameter(1.0, "s", "time constant", minimum=0.01)
    fails_at = Parameter(1e9, "s", "time from which its step raises")
    pause = Parameter(0.0, "s", "time that a step takes on the clock")

    def start(self):
        self.y = 0.0

    def step(self, t, h):
        if t >= self.fails_at:
            raise ValueError("the pump has run dry")
        if self.pause:
            Path("stepping").touch()
            time.sleep(self.pause)
        self.y += h / self.time_constant * (self.u - self.y)
'''

SSD = """<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="tank" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
  <ssd:System name="tank">
    <ssd:Connectors>
      <ssd:Connector name="level_set" kind="input"><ssc:Real unit="m"/></ssd:Connector>
    </ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="lag" type="application/x-fmu-sharedlibrary" source="resources/lag.fmu">
        <ssd:Connectors>
          <ssd:Connector name="u" kind="input"><ssc:Real unit="m"/></ssd:Connector>
          <ssd:Connector name="y" kind="output"><ssc:Real unit="m"/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startConnector="level_set" endElement="lag" endConnector="u"/>
    </ssd:Connections>
  </ssd:System>
</ssd:SystemStructureDescription>
"""

SCENARIO = """description = "Filling a tank"
system    = "tank"
stop_time = 5.0
step_size = 0.1

[set]
"lag.time_constant" = 0.5

[[expect]]
signal = "lag.y"
near   = 1.0
within = 0.05
during = [4.0, 5.0]
"""


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Folder of the project, which is the working folder of the test."""
    files = {
        "fmus/lag/lag.py": FMU,
        "ssp/tank/SystemStructure.ssd": SSD,
        "scenarios/fill.toml": SCENARIO,
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    return tmp_path


SHORT = """description = "One second of stationkeeping"
system      = "gunnerus_dp"
parameters  = "gunnerus-33m9"
stop_time   = 1.0
step_size   = 0.05

[set]
"environment.wind_speed" = 8.0

[[events]]
time     = 0.5
override = { "reference.x_set" = 1.0 }

[[expect]]
signal = "vessel.x"
near   = 0.0
within = 5.0
"""


@pytest.fixture(scope="session")
def built(root):
    """Folder of the project's FMUs, up to date."""
    return build_stale(root)


@pytest.fixture(scope="session")
def linked(built, tmp_path_factory):
    """Copy of the project's FMUs, to which `gunnerus` has links: they are 30 MB."""
    return shutil.copytree(built, tmp_path_factory.mktemp("linked") / "fmus")


def stamps(folder):
    """What changes with the content or the rights of files, by name."""
    found = {path.name: path.stat() for path in folder.iterdir()}
    return {name: (stat.st_mode, stat.st_size, stat.st_mtime_ns) for name, stat in found.items()}


@pytest.fixture
def gunnerus(root, linked, tmp_path, monkeypatch):
    """Copy of the project to break things in, with the scenario `short`; it is the working folder of the test.

    The FMUs in build/fmus are links to files of other tests: who changes one removes it first.
    """
    left_out = shutil.ignore_patterns("__pycache__")
    for name in ("fmus", "ssp"):
        shutil.copytree(root / name, tmp_path / name, ignore=left_out)
    before = stamps(linked)
    shutil.copytree(linked, tmp_path / "build" / "fmus", copy_function=os.link)
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "short.toml").write_text(SHORT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    yield tmp_path
    assert stamps(linked) == before, "a test has changed an FMU of the others"


put_together = cache(get_command)
"""Our command as the runner calls it: to put it together takes longer than most calls."""


@pytest.fixture
def call():
    """Function that calls the command: its exit code, stdout and stderr."""

    def call(*arguments):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("typer.testing._get_command", put_together, raising=False)
            result = CliRunner().invoke(app, [str(a) for a in arguments], prog_name="shipcosim")
        assert result.exception is None or isinstance(result.exception, SystemExit), (
            result.exception
        )
        return SimpleNamespace(code=result.exit_code, out=result.stdout, err=result.stderr)

    return call


@pytest.fixture
def six_minutes():
    """Function that writes the first six minutes of the example log: enough to name the same cause."""

    def write(path):
        log = sc.read_log("gunnerus_log").table
        sc.write_table(log.isel(time=slice(0, 361)), path)

    return write
