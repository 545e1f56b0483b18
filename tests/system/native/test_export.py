"""FMUs with their models in C, as a user makes and runs them: what they refuse, what they say, where they run."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu

from shipcosim.errors import ShipcosimError
from shipcosim.fmi import Parameter
from shipcosim.fmi.export.builder import build_fmu
from shipcosim.native import Untraceable
from shipcosim.native.export import checking, packing
from shipcosim.native.export.packing import build_native_fmu
from shipcosim.native.export.targets import targets_of

NEWCOMER = '''
from math import pi

from shipcosim.fmi import Fmu, FmuError, Input, Output, Parameter
from shipcosim.models.core.maths import sin, where


class Winch(Fmu):
    """A winch as somebody writes one who has never heard of compilers."""

    wanted = Input("m", "length to reach")
    braked = Input("1", "the brake is on", start=False)
    length = Output("m", "length that is out")
    turns = Output("1", "whole turns of the drum", start=0)
    is_slack = Output("1", "nothing pulls", start=True)
    speed_max = Parameter(1.5, "m/s", "largest speed", minimum=0.0)
    radius = Parameter(0.4, "m", "of the drum", minimum=0.01)
    layers = Parameter(3, "1", "layers of rope", minimum=1)
    gear = Parameter("slow", "1", "slow or fast")
    spooling = Parameter(True, "1", "the drum has a spooling device")

    def start(self):
        if self.gear not in ("slow", "fast"):
            raise FmuError(f"there is no gear '{self.gear}'")
        if self.radius * self.layers > 5.0:
            raise ValueError(f"a drum of {self.radius * self.layers:.3g} m in {self.layers} layers is too thick")
        self.factor = 2.0 if self.gear == "fast" else 1.0
        self.history = [0.0, 0.0, 0.0]
        self.length = 0.0

    def step(self, t, h):
        most = self.factor * self.speed_max * h
        change = min(max(self.wanted - self.length, -most), most)
        self.history = [*self.history[1:], change]
        self.length = where(self.braked, self.length, self.length + change)
        if self.spooling:
            self.length += 1e-3 * h * sin(2.0 * pi * t) / self.layers
        self.turns = int(self.length // (2.0 * pi * self.radius))
        self.is_slack = sum(self.history) == 0.0
'''


@pytest.fixture
def written(tmp_path):
    """written(name, script) -> folder of an FMU."""

    def written(name, script):
        folder = tmp_path / "fmus" / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.py").write_text(script)
        return folder

    return written


@pytest.fixture
def winch(written, tmp_path):
    """The newcomer's FMU in Python and in C."""
    folder = written("winch", NEWCOMER)
    return build_fmu(folder, tmp_path / "python"), build_native_fmu(folder, tmp_path / "native")


def said(fmu, **values):
    """What an FMU logs where it fails to start with some parameters."""
    told = []
    with pytest.raises(Exception, match="fmi2|FMU|status"):
        simulate_fmu(
            str(fmu),
            stop_time=0.1,
            step_size=0.05,
            start_values=values,
            logger=lambda *a: told.append(a[-1]),
        )
    (text, *_) = [one.decode() if isinstance(one, bytes) else one for one in told if b"t = " in one]
    return text


def test_what_a_newcomer_writes_is_the_same_in_c(winch):
    times = np.linspace(0.0, 5.0, 101)
    rows = [(t, 4.0 * np.sin(t), t > 3.0) for t in times]
    given = np.array(rows, dtype=[("time", float), ("wanted", float), ("braked", bool)])
    python, native = (
        simulate_fmu(
            str(fmu), stop_time=5.0, step_size=0.05, output_interval=0.05, input=given,
            start_values={"speed_max": 1.1, "layers": 4},
        )
        for fmu in winch
    )  # fmt: skip
    assert (
        python.dtype == native.dtype
        and np.ptp(python["length"]) > 1.0
        and np.ptp(python["turns"]) > 0
    )
    for name in python.dtype.names:
        np.testing.assert_array_equal(python[name], native[name], err_msg=name)


def test_a_native_fmu_is_valid_and_describes_the_same_variables(winch):
    descriptions = []
    for fmu in winch:
        assert validate_fmu(str(fmu)) == []
        with zipfile.ZipFile(fmu) as archive:
            descriptions.append(ElementTree.fromstring(archive.read("modelDescription.xml")))
            files = archive.namelist()
    assert {"sources/all.c", "modelDescription.xml"} <= set(files)
    assert not [name for name in files if "python" in name.lower() or name.startswith("resources/")]
    parts = (
        "ModelVariables",
        "UnitDefinitions",
        "ModelStructure",
        "DefaultExperiment",
        "LogCategories",
    )
    for part in parts:
        one, other = (ElementTree.tostring(d.find(part)) for d in descriptions)
        assert one.split() == other.split(), part
    assert descriptions[0].get("guid") != descriptions[1].get("guid")
    assert descriptions[1].find("CoSimulation").get("needsExecutionTool") == "false"


@pytest.mark.parametrize(
    "values",
    [
        {"radius": 0.001},
        {"radius": -1.0, "speed_max": -2.0},
        {"layers": 0},
        {"radius": 2.5, "layers": 7},
    ],
    ids=str,
)
def test_what_it_refuses_it_refuses_in_the_words_of_python(winch, values):
    python, native = (said(fmu, **values) for fmu in winch)
    assert "parameter '" in python or "too thick" in python
    assert native.replace("winch_native", "") == python


def test_a_text_that_is_not_in_the_code_is_refused_by_name(winch):
    text = said(winch[1], gear="fast")
    assert (
        "this native FMU was built with gear = 'slow', and not for 'fast': build it again" in text
    )


def test_a_text_of_an_example_is_in_the_code(written, tmp_path):
    fmu = build_native_fmu(written("winch", NEWCOMER), tmp_path, [{"gear": "fast"}])
    fast, slow = (
        simulate_fmu(
            str(fmu), stop_time=1.0, step_size=0.05, start_values={"gear": gear, "wanted": 9.0}
        )["length"][-1]
        for gear in ("fast", "slow")
    )
    assert fast == pytest.approx(2.0 * slow, rel=1e-2)


def test_what_is_no_arithmetic_stays_in_python_with_its_line(written, tmp_path):
    script = NEWCOMER.replace(
        "self.length = 0.0\n", "self.length = float(len(open('/etc/hosts').read()))\n"
    )
    with pytest.raises(Untraceable, match=r"winch.py, line \d+: it calls .*open"):
        build_native_fmu(written("winch", script), tmp_path)
    assert not list(tmp_path.glob("*.fmu"))


def test_a_build_that_differs_from_python_is_refused_with_variable_and_step(
    written, tmp_path, monkeypatch
):
    source = packing.source_of_model
    changed = lambda *a: source(*a).replace("(2.0)", "(2.0000001)").replace("* 0.001", "* 0.0011")  # noqa: E731
    monkeypatch.setattr(packing, "source_of_model", changed)
    with pytest.raises(Untraceable, match=r"in step \d+ length is .* in C and .* in Python"):
        build_native_fmu(written("winch", NEWCOMER.replace("1e-3 * h", "h * 0.001")), tmp_path)
    assert not list(tmp_path.glob("*.fmu"))


def test_random_parameters_stay_within_their_bounds():
    variable = Parameter(1.0, "m", "a length", minimum=0.999, maximum=1.001)
    variable.name = "a"
    cls = type("Cls", (), {"variables": (variable,)})
    random = np.random.default_rng(3)
    drawn = [checking._near(cls, {}, random)["a"] for _ in range(200)]
    assert min(drawn) == 0.999 and max(drawn) == 1.001 and len(set(drawn)) > 2


def test_a_platform_that_is_none_is_refused_with_the_nearest():
    assert targets_of("linux, windows") == ["linux", "windows"]
    with pytest.raises(ShipcosimError, match="windows"):
        targets_of("window")


NUMERIC = '''
import numpy as np

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Numeric(Fmu):
    """What models ask NumPy for at the start."""

    x = Input("1", "a number")
    solved = Output("1", "of equations")
    inverse = Output("1", "generalised")
    table = Output("1", "interpolated")
    sum_of_normals = Output("1", "of random numbers")
    last_normal = Output("1", "of them")
    last_uniform = Output("1", "another")
    seed = Parameter(1, "1", "of random numbers", minimum=0)
    a = Parameter(1.3, "1", "in a matrix")
    b = Parameter(-0.4, "1", "in a matrix")

    def start(self):
        matrix = np.array([[self.a, 0.2, 0.0, 1.0], [self.b, 2.0, 0.1, 0.0], [0.0, self.a, 3.0, self.b], [1, 0, 0, 2]])
        self.solved = float(np.linalg.solve(matrix @ matrix, np.array([1.0, 2.0, self.a, 0.5]))[2])
        self.inverse = float(np.linalg.pinv(matrix[:, :2] * self.b, rcond=1e-6)[1, 2] + np.linalg.inv(matrix)[3, 1])
        xs = np.cumsum(np.array([0.0, 1.0, self.a, 2.0]))
        self.table = float(np.interp(np.array([0.7, self.a]), xs, np.array([0.0, self.b, 4.0, 1.0]))[1])
        random = np.random.default_rng((7, self.seed))
        normals = random.standard_normal(3000)
        self.sum_of_normals, self.last_normal = float(normals.sum()), float(normals[-1])
        self.last_uniform = float(random.uniform(2.0, 5.0, 10)[-1])

    def step(self, t, h):
        self.solved += h * self.x
'''


def test_matrices_tables_and_random_numbers_of_a_start_are_those_of_numpy(written, tmp_path):
    folder = written("numeric", NUMERIC)
    python, native = (
        build_fmu(folder, tmp_path / "python"),
        build_native_fmu(folder, tmp_path / "native"),
    )
    for seed, a in ((0, 1.0), (1, 1.3), (2**31 - 1, 0.7)):
        one, other = (
            simulate_fmu(
                str(fmu), stop_time=0.1, step_size=0.05, start_values={"seed": seed, "a": a}
            )
            for fmu in (python, native)
        )
        for name in ("last_normal", "last_uniform"):
            assert one[name][0] == other[name][0]
        for name in ("solved", "inverse", "table", "sum_of_normals"):
            assert one[name][0] == pytest.approx(other[name][0], rel=1e-12)
    assert one["last_normal"][0] != 0.0


def test_a_count_that_shapes_the_state_is_refused_and_another_example_brings_it(written, tmp_path):
    script = """
from shipcosim.fmi import Fmu, Output, Parameter


class Delay(Fmu):
    \\"\\"\\"Repeats itself after some steps.\\"\\"\\"

    value = Output("1", "what is given out")
    # Near a change of the count, which the random parameters of a build's check reach.
    latency = Parameter(0.224, "s", "how late", minimum=0.05)

    def start(self):
        self.queue = (0.0,) * round(self.latency / 0.05)

    def step(self, t, h):
        self.queue = (*self.queue[1:], t)
        self.value = self.queue[0]
"""
    folder = written("delay", script.replace('\\"', '"'))
    alone, both = (
        build_native_fmu(folder, tmp_path / name, examples)
        for name, examples in (("alone", [{}]), ("both", [{}, {"latency": 0.4}]))
    )
    assert "compiled for another value of latency: take" in said(alone, latency=0.4)
    found = simulate_fmu(str(both), stop_time=1.0, step_size=0.05, start_values={"latency": 0.4})[
        "value"
    ]
    assert found[-1] == pytest.approx(1.0 - 0.4, abs=1e-9)
