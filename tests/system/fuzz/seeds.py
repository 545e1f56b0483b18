"""Sound files of every kind, small, for a fuzzer to damage: name of the file and its bytes."""

import io
import zipfile
from functools import cache
from pathlib import Path

from conformance.cases import cases, documents
from conformance.fmus import build_part, fmu_of

CASES = (
    "ssm",
    "nested_parameters",
    "dictionary_file",
    "units",
    "other_ssd",
    "enumeration_mapping",
    "step_component",
)
"""Conformance cases that have, together, most elements of the standard."""

SCENARIO = """description = "Stationkeeping while the wind turns"
system      = "case"
parameters  = "numbers"
stop_time   = 6.0
step_size   = 0.25
output_interval = 0.5

[set]
"ramp.rate" = 2.0

[[events]]
time     = 1.5
override = { "ramp.y" = 0.785 }

[[events]]
time  = 3.0
bias  = { "ramp.y" = 1.0 }
reset = ["ramp.y"]

[[expect]]
signal = "ramp.y"
near   = 0.0
within = 1.0
during = [1.0, 6.0]
"""
HEADER = "time [s],north [m],east [m],heading [deg],surge [m/s],sway [m/s],yaw_rate [deg/s],wind_speed,port_rpm"
ROWS = [
    f"{0.5 * i},{0.1 * i},-{0.2 * i},{i % 360},0.2,-0.1,2.0,8.5,{90 + i % 3}" for i in range(200)
]
LOG = "\n".join([HEADER, *ROWS])
OSP = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <StartTime>0.0</StartTime>
  <BaseStepSize>0.25</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="ramp" source="ramp.fmu" stepSize="0.25">
      <InitialValues><InitialValue variable="rate"><Real value="2"/></InitialValue></InitialValues>
    </Simulator>
    <Simulator name="gain" source="gain.fmu"/>
    <Simulator name="other" source="gain.fmu"/>
  </Simulators>
  <Functions>
    <LinearTransformation name="line" factor="2" offset="1"/>
    <Sum name="sum" inputCount="2"/>
  </Functions>
  <Connections>
    <SignalConnection>
      <Variable simulator="ramp" name="y"/><Signal function="line" name="in"/>
    </SignalConnection>
    <SignalConnection>
      <Variable simulator="gain" name="u"/><Signal function="line" name="out"/>
    </SignalConnection>
    <SignalConnection>
      <Variable simulator="ramp" name="y"/><Signal function="sum" name="in[0]"/>
    </SignalConnection>
    <SignalConnection>
      <Variable simulator="gain" name="y"/><Signal function="sum" name="in[1]"/>
    </SignalConnection>
    <SignalConnection>
      <Variable simulator="other" name="u"/><Signal function="sum" name="out"/>
    </SignalConnection>
  </Connections>
</OspSystemStructure>
"""
EVENTS = """{"description": "two", "defaults": {"model": "gain", "action": "override"}, "events": [
  {"time": 0.5, "variable": "u", "value": 2.5},
  {"time": 1.0, "model": "gain", "variable": "u", "action": "bias", "value": -0.25},
  {"time": 1.5, "variable": "u", "action": "reset"}], "end": 2.0}
"""


@cache
def seeds():
    """Files by kind: a list of (name of the file, bytes or, for an .ssp, contents by name)."""
    found = {kind: [] for kind in ("ssp", "ssd", "ssv", "ssm", "ssb")}
    for name in CASES:
        case = cases()[name]
        texts = {file: text.encode() for file, text in documents(case).items()}
        found["ssp"].append(("system.ssp", texts | fmus(case)))
        for file, text in texts.items():
            found[Path(file).suffix[1:]].append((Path(file).name, text))
    found["fmu"] = [
        (f"{name}.fmu", zipped(contents(build_part(name)))) for name in ("ramp", "echo")
    ]
    found["toml"] = [("case.toml", SCENARIO.encode())]
    found["csv"] = [("log.csv", LOG.encode()), ("log.csv.gz", LOG.encode())]
    parts = {f"{name}.fmu": zipped(contents(build_part(name))) for name in ("ramp", "gain")}
    texts = {"OspSystemStructure.xml": OSP.encode(), "events.json": EVENTS.encode()}
    found["osp"] = [("OspSystemStructure.xml", texts | parts)]
    return found


def fmus(case):
    """Model descriptions of a case's FMUs, as archives, by name in the package."""
    made = {}
    for name, how in case.fmus.items():
        made[how.get("file", f"resources/{name}.fmu")] = zipped(contents(fmu_of(name, how)))
    return made


@cache
def contents(path):
    """The model description of an FMU and stand-ins for its binaries; nothing is run here."""
    with zipfile.ZipFile(path) as archive:
        found = {"modelDescription.xml": archive.read("modelDescription.xml")}
    return found | {"binaries/linux64/model.so": b"no binary"}


def zipped(files):
    """Bytes of an archive."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return data.getvalue()
