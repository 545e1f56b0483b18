"""FMUs made for a test, and FMPy as their host."""

import ctypes
import importlib.util
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from types import SimpleNamespace

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.logging import addLoggerProxy

from shipcosim.fmi.export import builder, bundle

LAG = '''
import numpy as np

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Lag(Fmu):
    """First-order lag with noise, on which much can be tried."""

    value_in = Input("N", "what to follow")
    mode = Input("1", "what to do", start=0)
    value = Output("N", "what follows")
    steps = Output("1", "steps taken", start=0)
    above = Output("1", "value is above its limit", start=False)
    text = Output("1", "the mode in words", start="")
    time_constant = Parameter(2.0, "s", "time constant", minimum=0.1)
    gain = Parameter(1.0, "1", "factor on the input", tunable=True)
    seed = Parameter(1, "1", "seed of the noise")
    label = Parameter("plain", "1", "put before the mode")

    def start(self):
        self.rng = np.random.default_rng(self.seed)
        self.recent = {"values": np.zeros(3)}
        self.value = self.gain * self.value_in
        self.steps = 0
        self.text = self.label

    def step(self, t, h):
        if self.mode == 13:
            self.log("100 % sure")
            raise RuntimeError("100 %s broken")
        if self.mode == 14:
            self.value = float("nan")
            return
        self.recent["values"] = np.roll(self.recent["values"], 1)
        self.recent["values"][0] = self.rng.normal()
        self.value += h / self.time_constant * (self.gain * self.value_in - self.value) + self.recent["values"].sum()
        self.steps += 1
        self.above = self.value > 10.0
        self.text = f"{self.label} {self.mode}"
'''

ADDER = '''
from shipcosim.fmi import Fmu, Output
from {module} import amount


class {name}(Fmu):
    """Adds what a module beside it says."""

    total = Output("1", "sum so far")

    def step(self, t, h):
        self.total += amount()
'''


class Host:
    """One FMU in FMPy, variables by name, everything that it logs in `messages`."""

    def __init__(self, fmu, folder, name="component"):
        self.description = read_model_description(str(fmu))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages = []
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=extract(str(fmu), unzipdir=str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda _, instance, status, category, message: self.messages.append(
                (status, message.decode())
            )
        )
        self.callbacks.allocateMemory, self.callbacks.freeMemory = (
            defaultCallbacks.allocateMemory,
            defaultCallbacks.freeMemory,
        )
        addLoggerProxy(ctypes.byref(self.callbacks))
        self.slave.instantiate(callbacks=self.callbacks, loggingOn=True)
        self.slave.setupExperiment(startTime=0.0)

    def start(self, **values):
        self.set(**values)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        return self

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.slave, f"set{variable.type}")([variable.valueReference], [value])

    def get(self, name):
        variable = self.variables[name]
        value = getattr(self.slave, f"get{variable.type}")([variable.valueReference])[0]
        return value.decode() if isinstance(value, bytes) else value

    def step(self, count=1, *, first=0, h=0.1, read="value"):
        """Values after each of a number of steps."""
        values = []
        for index in range(first, first + count):
            self.slave.doStep(index * h, h)
            values.append(self.get(read))
        return values


@pytest.fixture(scope="session")
def compiled(tmp_path_factory, needs):
    """compiled(source) -> program made of a C file that stands here."""

    def compiled(source):
        if sys.platform != "linux":
            needs("Linux")
        compiler = shutil.which("cc") or shutil.which("gcc") or needs("a C compiler")
        target = tmp_path_factory.mktemp("program") / Path(source).stem
        source = Path(__file__).with_name(source)
        subprocess.run(
            [compiler, "-std=gnu11", "-w", "-o", target, source, "-ldl", "-lpthread"], check=True
        )
        return target

    return compiled


@pytest.fixture(scope="session")
def only_numpy(tmp_path_factory, needs):
    """Folder of the programs of a virtual environment in which NumPy is all there is."""
    if not sysconfig.get_config_var("Py_ENABLE_SHARED"):
        needs("a Python with a shared library")
    folder = tmp_path_factory.mktemp("only") / "numpy"
    venv.create(folder, symlinks=True)
    packages = next(folder.glob("lib/python*/site-packages"))
    installed = Path(importlib.util.find_spec("numpy").origin).parents[1]
    for name in ("numpy", "numpy.libs"):
        if (installed / name).exists():
            (packages / name).symlink_to(installed / name)
    return folder / "bin"


@pytest.fixture
def build(tmp_path):
    """build(name, script, helper=...) -> path of the FMU; other keywords are modules beside the script."""

    def build(name, script, *, out="out", folder="fmus", **beside):
        place = tmp_path / folder / name
        place.mkdir(parents=True, exist_ok=True)
        for module, text in {name: script, **beside}.items():
            (place / f"{module}.py").write_text(text)
        return builder.build_fmu(place, tmp_path / out)

    return build


@pytest.fixture
def load(tmp_path):
    """load(fmu, name) -> Host; freed and unpacked files deleted after the test."""
    hosts = []

    def load(fmu, name="component"):
        hosts.append(Host(fmu, tmp_path / f"unpacked-{len(hosts)}", name))
        return hosts[-1]

    yield load
    for host in hosts:
        host.slave.freeInstance()
        shutil.rmtree(host.slave.unzipDirectory, ignore_errors=True)


@pytest.fixture
def own_shipcosim(tmp_path, monkeypatch):
    """own_shipcosim(version, **models): builds from a copy of shipcosim that has these models."""

    def replace(version, **models):
        copy = tmp_path / version / "shipcosim"
        shutil.copytree(bundle.SHIPCOSIM, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for name, text in models.items():
            known = (copy / "models").rglob(f"{name}.py")
            next(known, copy / "models" / f"{name}.py").write_text(text)
        monkeypatch.setattr(bundle, "SHIPCOSIM", copy)

    return replace


@pytest.fixture
def lag(build):
    """FMU with a variable of every type, state, noise and two ways to fail."""
    return build("lag", LAG)


@pytest.fixture
def sources():
    """Scripts that several tests use."""
    return SimpleNamespace(lag=LAG, adder=ADDER)
