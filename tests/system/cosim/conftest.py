"""Small FMUs and systems made of them."""

import sys
import textwrap
from pathlib import Path

import pytest

from shipcosim.fmi.export.builder import build_fmu
from shipcosim.scenario import Scenario
from shipcosim.ssp import read_fmu, read_system

HEAD = "from shipcosim.fmi import Fmu, Input, Output, Parameter\n\n\n"
SOURCES = {
    "lag": '''
        class Lag(Fmu):
            """First-order lag, exact over a step."""

            u = Input("1", "what it follows")
            y = Output("1", "output")
            y_start = Parameter(0.0, "1", "output at the start")
            time_constant = Parameter(1.0, "s", "time constant")

            def start(self):
                self.y = self.y_start

            def step(self, t, h):
                import math

                self.y += (self.u - self.y) * -math.expm1(-h / self.time_constant)
        ''',
    "integrator": '''
        class Integrator(Fmu):
            """Integral of a held input."""

            u = Input("1", "rate")
            y = Output("1", "integral")
            y_start = Parameter(0.0, "1", "integral at the start")

            def start(self):
                self.y = self.y_start

            def step(self, t, h):
                self.y += h * self.u
        ''',
    "gain": '''
        class Gain(Fmu):
            """Output straight from the input."""

            u = Input("1", "input")
            y = Output("1", "factor times input plus offset")
            factor = Parameter(1.0, "1", "factor", tunable=True)
            offset = Parameter(0.0, "1", "offset")

            def start(self):
                self.y = self.factor * self.u + self.offset

            def step(self, t, h):
                self.start()
        ''',
    "bounded": '''
        class Bounded(Fmu):
            """States a range of its input, and computes outside it all the same."""

            u = Input("1", "input", minimum=-1.0, maximum=2.0)
            y = Output("1", "the input")

            def step(self, t, h):
                self.y = self.u
        ''',
    "clock": '''
        class Clock(Fmu):
            """Puts out the time, the number of steps and whether that is odd."""

            time = Output("1", "time at the end of the step")
            count = Output("1", "steps so far", start=0)
            odd = Output("1", "whether their number is odd", start=False)
            text = Output("1", "the number in words", start="none")
            step_size = Output("s", "last step")

            def step(self, t, h):
                self.time, self.step_size = t + h, h
                self.count += 1
                self.odd = self.count % 2 == 1
                self.text = f"{self.count} of them"
        ''',
    "meter": '''
        class Meter(Fmu):
            """Shows inputs of all types as numbers."""

            number = Input("1", "whole number", start=7)
            flag = Input("1", "flag", start=False)
            text = Input("1", "text", start="")
            real = Input("1", "number")
            y = Output("1", "their sum, the text by its length")
            number_seen = Output("1", "whole number", start=0)

            def start(self):
                self.number_seen = self.number
                self.y = self.number + 1000.0 * self.flag + 0.001 * len(self.text) + self.real

            def step(self, t, h):
                self.start()
        ''',
    "failing": '''
        class Failing(Fmu):
            """Fails in the way and at the time that it is told to."""

            how = Parameter("raise", "1", "raise, start, stop or warn")
            when = Parameter(0.5, "s", "time of the step in which it fails")
            y = Output("1", "time at the end of the step")

            def start(self):
                if self.how == "start":
                    raise ValueError("50%s of the start is wrong")

            def step(self, t, h):
                import os
                import signal

                self.y = t + h
                if t > self.when - 1e-9:
                    if self.how == "raise":
                        raise ValueError("50%s of it is wrong")
                    if self.how == "stop":
                        signal.raise_signal(signal.SIGINT)
                    if self.how == "warn":
                        self.log("100% full", "warning")
        ''',
    "shaft": '''
        class Shaft(Fmu):
            """Takes and gives values in units of its own."""

            speed = Input("rad/s", "speed")
            angle = Input("deg", "angle")
            rpm = Output("rpm", "speed times ten")
            torque = Output("N.m", "torque")

            def start(self):
                self.rpm = 10.0 * self.speed
                self.torque = self.angle

            def step(self, t, h):
                self.start()
        ''',
}


@pytest.fixture(scope="session")
def fmus(tmp_path_factory):
    """Folder with the FMUs, each built when it is asked for."""
    folder = tmp_path_factory.mktemp("fmus")

    def build(name):
        if not (folder / f"{name}.fmu").exists():
            source = tmp_path_factory.mktemp("source") / f"{name}.py"
            source.write_text(HEAD + textwrap.dedent(SOURCES[name]))
            build_fmu(source, folder)
        return folder

    return build


@pytest.fixture
def make_system(fmus, tmp_path):
    """Function that makes a system of FMUs.

    Components are {name: FMU or (FMU, start values) or (FMU, start values, step size)}, connections lines
    "a.y -> b.u" with an optional transformation, connectors of the system {name: (kind, type, attributes)}.
    """

    def make(components, connections=(), connectors=None):
        parts = {
            name: part if isinstance(part, tuple) else (part,) for name, part in components.items()
        }
        folder = [fmus(part[0]) for part in parts.values()][-1]
        file = tmp_path / "SystemStructure.ssd"
        file.write_text(_ssd(parts, connections, connectors or {}, folder), encoding="utf-8")
        (tmp_path / "resources").mkdir(exist_ok=True)
        return read_system(file, fmus=[folder])

    return make


@pytest.fixture
def make_scenario():
    """Function that makes a scenario from the keys of a scenario file."""

    def make(stop_time=1.0, step_size=0.1, **more):
        return Scenario.model_validate({"stop_time": stop_time, "step_size": step_size} | more)

    return make


TYPES = {float: "Real", int: "Integer", bool: "Boolean", str: "String"}


def _ssd(parts, connections, connectors, folder):
    lines = [
        '<ssd:SystemStructureDescription name="small" version="1.0"',
        ' xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"',
        ' xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"',
        ' xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">',
        '<ssd:System name="small"><ssd:Connectors>',
        *(
            f'<ssd:Connector name="{n}" kind="{k}"><ssc:{t} {a}/></ssd:Connector>'
            for n, (k, t, a) in connectors.items()
        ),
        "</ssd:Connectors><ssd:Elements>" if connectors else "<ssd:Elements>",
        *(_component(folder, name, *part) for name, part in parts.items()),
        "</ssd:Elements>",
        "<ssd:Connections>" if connections else "",
        *(_connection(line) for line in connections),
        "</ssd:Connections>" if connections else "",
        "</ssd:System></ssd:SystemStructureDescription>",
    ]
    text = "\n".join(lines)
    return text if connectors else text.replace("<ssd:Connectors>", "", 1)


BINDING = (
    "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
    '<ssv:ParameterSet name="p" version="1.0"><ssv:Parameters>{}</ssv:Parameters></ssv:ParameterSet>'
    "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
)
HINT = (
    '<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">'
    '<osp:StepSizeHint xmlns:osp="https://opensimulationplatform.com/SSP" value="{}"/>'
    "</ssc:Annotation></ssd:Annotations>"
)


def _component(folder, name, fmu, start=None, step_size=None):
    connectors = "".join(
        f'<ssd:Connector name="{v.name}" kind="{v.causality}"><ssc:{v.type}/></ssd:Connector>'
        for v in read_fmu(folder / f"{fmu}.fmu").variables.values()
    )
    values = "".join(
        f'<ssv:Parameter name="{n}"><ssv:{TYPES[type(v)]} value="{str(v).lower() if isinstance(v, bool) else v}"/>'
        "</ssv:Parameter>"
        for n, v in (start or {}).items()
    )
    return (
        f'<ssd:Component name="{name}" source="resources/{fmu}.fmu"><ssd:Connectors>{connectors}</ssd:Connectors>'
        + (BINDING.format(values) if values else "")
        + (HINT.format(step_size) if step_size else "")
        + "</ssd:Component>"
    )


def _connection(line):
    ends, _, transformation = line.partition("|")
    (source, target) = (end.strip().rpartition(".") for end in ends.split("->"))
    names = "".join(
        f' {which}{part}="{value}"'
        for which, (element, _, connector) in (("start", source), ("end", target))
        for part, value in (("Element", element), ("Connector", connector))
        if value
    )
    return f"<ssd:Connection{names}>{transformation.strip()}</ssd:Connection>"


STOCK = """
import helper
from pythonfmu import Fmi2Slave, Fmi2Causality, Real


class Stock(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = 0.0
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, t, h):
        self.y = EXPRESSION
        return True
"""


@pytest.fixture
def pythonfmu_code(tmp_path):
    """Function: a system of two FMUs, stock and other, as PythonFMU builds them from a script, without our shell."""
    from pythonfmu.builder import FmuBuilder

    def make(script, connections=(), helpers=("", ""), **options):
        (tmp_path / "resources").mkdir(exist_ok=True)
        for name, helper in zip(("stock", "other"), helpers, strict=True):
            folder = tmp_path / name
            folder.mkdir()
            (folder / "helper.py").write_text(helper)
            (folder / "model.py").write_text(script)
            built = FmuBuilder.build_FMU(
                folder / "model.py", folder, project_files={folder / "helper.py"}, **options
            )
            Path(built).rename(tmp_path / "resources" / f"{name}.fmu")
            for module in ("helper", "model"):
                sys.modules.pop(module, None)
        file = tmp_path / "SystemStructure.ssd"
        parts = {"stock": ("stock",), "other": ("other",)}
        file.write_text(_ssd(parts, connections, {}, tmp_path / "resources"), encoding="utf-8")
        return read_system(file)

    return make


@pytest.fixture
def pythonfmu_system(pythonfmu_code):
    """Function: the same, whose output is an expression, which can use each one's own module `helper`."""
    return lambda expression, *helpers: pythonfmu_code(
        STOCK.replace("EXPRESSION", expression), helpers=helpers or ("", "")
    )
