"""FMUs in a program that is not Python: host.c, compiled here. Python is what a virtual environment has."""

import importlib.util
import os
import re
import subprocess
import sysconfig
import zipfile
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu

from shipcosim.cosim import export_fmu
from shipcosim.library import build_stale
from shipcosim.native.export.packing import build_native_fmu
from shipcosim.series import read_table
from shipcosim.ssp import read_system

FMUS = sorted(
    path.stem
    for path in Path(__file__).parents[3].glob("fmus/*/*.py")
    if path.stem == path.parent.name
)

NATIVE = (
    "allocator azimuth_thruster dp_controller dp_predictor drift_force earth_force environment fixed_thruster harbour "
    "mapped_thruster pid_controller predictor propeller_rudder reference sensors thruster_interaction thruster_monitor "
    "tunnel_thruster varying_current vessel"
).split()
"""FMUs that `shipcosim build --native` writes in C."""
NATIVE_IN_CI = ("reference", "tunnel_thruster")
"""Those that CI compiles; the others are compiled at night, as the vessel, which takes longest."""
FMUS_IN_CI = FMUS[::4]
"""Those whose reference result CI asks for here; through FMPy it does of all."""


@pytest.fixture(scope="session")
def program(compiled):
    """The compiled host."""
    return compiled("host.c")


class Loaded:
    """An FMU in the host: commands on it by names of variables."""

    def __init__(self, fmu, folder, name):
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(folder)
        self.description = read_model_description(str(fmu))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.name, self.folder = name, folder
        identifier = self.description.coSimulation.modelIdentifier
        self.load = [
            name,
            str(folder / f"binaries/linux64/{identifier}.so"),
            self.description.guid,
            folder.as_uri(),
        ]
        self.load[-1] += "/resources"

    def set(self, **values):
        for name, value in values.items():
            variable = self.variables[name]
            text = repr(float(value)) if variable.type == "Real" else str(value)
            yield "set", self.name, variable.type, str(variable.valueReference), text

    def get(self, *names):
        for name in names:
            yield (
                "get",
                self.name,
                self.variables[name].type,
                str(self.variables[name].valueReference),
            )

    def steps(self, count, *names, first=0, h=0.1):
        """Steps, each followed by reading variables."""
        for index in range(first, first + count):
            yield "step", self.name, repr(index * h), repr(h)
            yield from self.get(*names)

    def then(self, command, *words):
        yield command, self.name, *map(str, words)


@pytest.fixture
def loaded(tmp_path):
    """loaded(fmu, name) -> Loaded, unpacked in a folder of its own."""
    return lambda fmu, name="one": Loaded(fmu, tmp_path / f"for {name}", name)


@pytest.fixture
def host(program, only_numpy, tmp_path):
    """host(*command sequences, fmus=[...], path=..., **environment) -> lines of the host, which has to end well."""

    def host(*commands, fmus, path=only_numpy, before=(), **environment):
        lines = [
            *before,
            ["load", *(word for fmu in fmus for word in fmu.load)],
            *(line for part in commands for line in part),
        ]
        text = "".join("\t".join(line) + "\n" for line in lines)
        done = subprocess.run(
            [program], input=text, capture_output=True, text=True, cwd=tmp_path, timeout=600,
            env={"PATH": str(path), "OPENBLAS_NUM_THREADS": "1"} | environment,
        )  # fmt: skip
        assert done.returncode == 0, (done.returncode, done.stdout[-2000:], done.stderr[-2000:])
        return done.stdout.splitlines()

    return host


@pytest.fixture(scope="session")
def native(root, tmp_path_factory, needs):
    """native(name) -> path of the FMU in C, built for the parameters of its reference result."""
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')
    folder = tmp_path_factory.mktemp("native")

    def native(name):
        path = folder / f"{name}.fmu"
        if not path.is_file():
            build_native_fmu(root / "fmus" / name, folder, [documents(root).parameters_of(name)])
        return path

    return native


def refusal(lines):
    """What the one FMU of a run said before it gave no instance."""
    log, null = lines
    assert null == "one NULL"
    assert log.startswith("log host one 3 logStatusError: ")
    return log.partition("Error: ")[2]


# an FMU alone


def documents(root):
    """The module that makes reference results."""
    script = root / "docs" / "generators" / "write_fmu_documents.py"
    spec = importlib.util.spec_from_file_location("documents", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Reference:
    """The reference result of an FMU of the project: commands that drive the FMU through it, row by row."""

    def __init__(self, name, fmu, root):
        generator = documents(root)
        self.parameters, self.fmu = generator.parameters_of(name), fmu
        self._tolerance = partial(generator.reference_tolerance, name)
        self.table = read_table(root / "fmus" / name / "reference.csv")
        self.times = self.table["time"].values
        self.inputs, self.outputs = (
            [n for n, v in fmu.variables.items() if v.causality == causality and n in self.table]
            for causality in ("input", "output")
        )

    def start(self):
        yield from self.fmu.set(**self.parameters)
        yield from self._set(0)
        yield from self.fmu.then("begin")
        yield from self.fmu.get(*self.outputs)

    def rows(self, first, last):
        for row in range(first, last):
            yield from self._set(row - 1)
            yield from self.fmu.then(
                "step", self.times[row - 1], self.times[row] - self.times[row - 1]
            )
            yield from self.fmu.get(*self.outputs)

    def check(self, lines):
        """Refuse outputs that are farther from the reference than it says."""
        assert lines[0] == "one instantiated"
        found = np.array(lines[1:], dtype=float).reshape(len(self.times), len(self.outputs))
        for column, signal in enumerate(self.outputs):
            expected = self.table[signal].values.astype(float)
            np.testing.assert_allclose(
                found[:, column], expected, rtol=0.0, atol=self._tolerance(expected), err_msg=signal
            )

    def _set(self, row):
        given = {name: self.table[name].values[row] for name in self.inputs}
        kinds = {name: float if self.fmu.variables[name].type == "Real" else int for name in given}
        return self.fmu.set(**{name: kinds[name](value) for name, value in given.items()})


@pytest.mark.parametrize("name", FMUS_IN_CI)
def test_an_fmu_of_the_project_gives_its_reference_result(name, root, loaded, host):
    """As closely as through FMPy."""
    check_reference(name, root, loaded, host)


def check_reference(name, root, loaded, host):
    fmu = loaded(build_stale(root) / f"{name}.fmu")
    reference = Reference(name, fmu, root)
    reference.check(host(reference.start(), reference.rows(1, len(reference.times)), fmus=[fmu]))


@pytest.mark.parametrize("name", NATIVE_IN_CI)
def test_a_native_fmu_gives_the_reference_result_where_there_is_no_python(
    name, root, loaded, host, native
):
    check_native(name, loaded(native(name)), root, host)


def check_native(name, fmu, root, host):
    """No path, no environment, and no library of Python in the process."""
    reference = Reference(name, fmu, root)
    rows = reference.start(), reference.rows(1, len(reference.times)), [["maps", "python"]]
    *lines, found = host(*rows, fmus=[fmu], path="/nowhere", PYTHONHOME="/nowhere")
    reference.check(lines)
    assert found == "maps 0"


def test_a_state_of_a_native_fmu_goes_on_in_another_process_bit_for_bit(
    root, loaded, host, tmp_path, native
):
    check_state("reference", loaded(native("reference")), root, host, tmp_path)


def check_state(name, fmu, root, host, tmp_path):
    """The second half of a run is the same bit by bit in a process that begins with the state in the middle."""
    reference, file = Reference(name, fmu, root), tmp_path / "state"
    half, end = len(reference.times) // 2, len(reference.times)
    save = fmu.then("save", file)
    whole = host(
        reference.start(), reference.rows(1, half), save, reference.rows(half, end), fmus=[fmu]
    )
    begin = fmu.set(**reference.parameters), fmu.then("begin"), fmu.then("restore", file)
    rest = host(*begin, reference.rows(half, end), fmus=[fmu])[1:]
    assert len(rest) == (end - half) * len(reference.outputs) and rest == whole[-len(rest) :]


def test_states_of_a_native_fmu_and_of_the_one_in_python_are_told_apart(
    root, loaded, host, tmp_path, native
):
    ours, python = (
        loaded(native("reference"), "ours"),
        loaded(build_stale(root) / "reference.fmu", "python"),
    )
    reference = Reference("reference", ours, root)
    for first, second, words in (
        (ours, python, "reference_"),
        (python, ours, "native reference {"),
    ):
        file = tmp_path / f"{words.strip('{ ')}.state"
        begin = {
            fmu: (fmu.set(**reference.parameters), fmu.then("begin")) for fmu in (first, second)
        }
        host(*begin[first], first.then("save", file), fmus=[first])
        log = " ".join(host(*begin[second], second.then("restore", file), fmus=[second]))
        assert (
            "the state cannot be restored: this is a state of '" in log
            and f"wanted is one of '{words}" in log
        )


def test_native_instances_keep_to_themselves(root, loaded, host, native):
    """Two of one FMU, started together, one after the other, and with other parameters."""
    one, two = loaded(native("reference"), "one"), loaded(native("reference"), "two")

    def run(fmu, goal):
        yield from fmu.set(
            **Reference("reference", fmu, root).parameters | {"x_start": 1.0, "x_set": goal}
        )
        yield from fmu.then("begin")
        yield from fmu.steps(30, "x_d", h=1.0)

    turns = [line for pair in zip(run(one, 50.0), run(two, -20.0), strict=True) for line in pair]
    alone = host(run(one, 50.0), fmus=[one])[1:], host(run(two, -20.0), fmus=[two])[1:]
    together = host(turns, fmus=[one, two])[2:]
    assert (together[::2], together[1::2]) == alone and float(together[-1]) < 0.0 < float(
        together[-2]
    )


def test_a_state_of_an_fmu_goes_on_in_another_process_bit_for_bit(root, loaded, host, tmp_path):
    check_state("vessel", loaded(build_stale(root) / "vessel.fmu"), root, host, tmp_path)


def test_values_of_every_type_go_in_and_out_and_what_is_logged_arrives(lag, loaded, host):
    fmu = loaded(lag)
    lines = host(
        fmu.set(label="deep", seed=3, value_in=1000.0),
        fmu.then("begin"),
        fmu.steps(1, "steps", "above", "text"),
        fmu.set(mode=13),
        fmu.then("step", 0.1, 0.1),
        fmus=[fmu],
    )
    assert lines[:4] == ["one instantiated", "1", "1", "deep 0"]
    start = "log host one 3 logStatusError: one at t = 0.1 s: 100 % sure|one at t = 0.1 s: exception|Traceback"
    assert lines[-2].startswith(start)
    assert 'File "lag.py"' in lines[-2] and lines[-2].endswith("RuntimeError: 100 %s broken")
    assert lines[-1] == "step one: status 3"


def test_failures_and_warnings_are_logged_always_and_the_rest_on_demand(build, loaded, host):
    script = """
from shipcosim.fmi import Fmu, Output


class Talker(Fmu):
    y = Output("1", "nothing")

    def step(self, t, h):
        self.log(f"step {t + h:g}")
        if t == 2.0:
            self.log("soon", "warning")
"""
    fmu = loaded(build("talker", script))
    steps = [list(fmu.steps(1, first=k, h=1.0)) for k in range(4)]
    lines = host(
        fmu.then("begin"),
        steps[0],
        fmu.then("log", 1),
        steps[1],
        fmu.then("log", 0),
        *steps[2:],
        fmus=[fmu],
    )
    assert [line.partition("t = ")[2] for line in lines[1:]] == ["1 s: step 2", "2 s: soon"]


def test_names_of_folders_do_not_depend_on_the_hosts_locale(lag, host, tmp_path):
    fmu = Loaded(lag, tmp_path / "sj\u00f8 \u6d77", "one")
    fmu.load[3] = f"file://{fmu.folder}/resources"
    assert host(fmu.then("begin"), fmu.steps(2, "steps"), fmus=[fmu]) == [
        "one instantiated",
        "1",
        "2",
    ]
    assert host(fmu.then("begin"), fmu.steps(1, "steps"), fmus=[fmu], LC_ALL="C") == [
        "one instantiated",
        "1",
    ]


def test_what_an_fmu_prints_is_not_lost(build, loaded, host):
    script = """
from shipcosim.fmi import Fmu, Output


class Talker(Fmu):
    y = Output("1", "nothing")

    def step(self, t, h):
        print("said at", t)
"""
    fmu = loaded(build("talker", script))
    assert "said at 0.0" in host(fmu.then("begin"), fmu.steps(1), [["quit"]], fmus=[fmu])


def test_the_commands_of_the_page_run(root, program, only_numpy, tmp_path, needs):
    """In a folder in which the project's own are found; what they build goes elsewhere."""
    text = (root / "docs" / "portable-fmus.md").read_text(encoding="utf-8")
    commands = next(
        block
        for block in re.findall(r"```sh\n(.*?)```", text, re.DOTALL)
        if "step_thruster" in block
    )
    (tmp_path / "docs").symlink_to(root / "docs")
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "fmus").symlink_to(build_stale(root))
    path = f"{only_numpy}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["sh", "-ec", commands],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env=os.environ | {"PATH": path},
    )
    assert (done.returncode, done.stdout) == (0, "20000 N\n"), done.stderr


# finding Python


def test_an_environment_is_taken_as_it_is(build, loaded, host, only_numpy):
    """The modules that it has, and no others; by PATH, or by path or name in a variable."""
    script = """
import importlib.util
import sys

from shipcosim.fmi import Fmu, Output


class Asks(Fmu):
    prefix = Output("1", "where Python is", start="")
    found = Output("1", "what can be imported", start="")

    def step(self, t, h):
        self.prefix = sys.prefix
        names = ("numpy", "shipcosim", "pythonfmu", "pytest")
        self.found = " ".join(name for name in names if importlib.util.find_spec(name))
"""
    fmu = loaded(build("asks", script))
    expected = ["one instantiated", str(only_numpy.parent), "numpy"]
    named = [
        {"path": "/nowhere", "SHIPCOSIM_PYTHON": str(only_numpy / "python")},
        {"SHIPCOSIM_PYTHON": "python"},
    ]
    for where in ({}, *named):
        assert (
            host(fmu.then("begin"), fmu.steps(1, "prefix", "found"), fmus=[fmu], **where)
            == expected
        )


def test_where_there_is_no_python_the_logger_says_so_and_there_is_no_instance(
    lag, loaded, host, tmp_path
):
    said = refusal(host(fmus=[loaded(lag)], path=tmp_path))
    assert said.startswith(
        "there is no Python for this FMU. It needs Python 3.11 or newer, with NumPy"
    )
    assert "nothing, there is no python3 in it" in said and "SHIPCOSIM_PYTHON" in said


@pytest.mark.parametrize(
    "answer, why",
    [
        ("shipcosim 3.10 /p /lib.so NumPy -", "is Python 3.10, which is too old"),
        ("shipcosim 3.12 /p /lib.so - -", "is Python 3.12 without NumPy"),
        (
            "shipcosim 3.12 /p - NumPy -",
            "is Python 3.12 without a shared library (Debian: package libpython3.12",
        ),
        ("shipcosim 3.13 /p /lib.so NumPy t", "is Python 3.13 without a global lock"),
        ("Python 2.7", "does not answer as Python 3 does"),
        ("", "does not answer as Python 3 does"),
    ],
)
def test_a_python_that_cannot_do_it_is_named_with_the_reason(
    lag, loaded, host, tmp_path, answer, why
):
    """From PATH, and where the user has named it: then it is the only one that is tried."""
    lines = "".join(f"{word.strip('-')}\\n" for word in answer.split(" "))
    fake = tmp_path / "bin" / "python3"
    fake.parent.mkdir()
    fake.write_text(f"#!/bin/sh\nprintf '{lines}'\n")
    fake.chmod(0o755)
    assert f"|  {fake} {why}" in refusal(host(fmus=[loaded(lag)], path=fake.parent))
    assert f" SHIPCOSIM_PYTHON names|  {fake} {why}" in refusal(
        host(fmus=[loaded(lag)], SHIPCOSIM_PYTHON=str(fake))
    )


def test_a_suitable_python_later_in_path_is_found(lag, loaded, host, tmp_path, only_numpy):
    fake = tmp_path / "python3"
    fake.write_text("#!/bin/sh\nexit 1\n")
    fake.chmod(0o755)
    assert host(fmus=[loaded(lag)], path=f"{tmp_path}{os.pathsep}{only_numpy}") == [
        "one instantiated"
    ]


def test_a_library_that_is_none_of_python_does_no_harm(lag, loaded, host, tmp_path):
    library = tmp_path / "libpython3.12.so"
    library.write_text("nothing")
    fake = tmp_path / "python3"
    fake.write_text(f"#!/bin/sh\nprintf 'shipcosim\\n3.12\\n{fake}\\n{library}\\nNumPy\\n\\n'\n")
    fake.chmod(0o755)
    assert f"the library of {fake} cannot be loaded: {library}:" in refusal(
        host(fmus=[loaded(lag)], path=tmp_path)
    )


@pytest.mark.parametrize("started", ["0", "1"])
def test_python_that_the_host_has_for_itself_alone_is_used(lag, loaded, host, started, only_numpy):
    """As a plug-in of the host's would have it; there cannot be two in a process."""
    library = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("INSTSONAME")
    packages = next(only_numpy.parent.glob("lib/python*/site-packages"))
    path = {"0": {}, "1": {"PYTHONPATH": str(packages), "path": "/nowhere"}}[started]
    fmu = loaded(lag)
    lines = host(
        fmu.then("begin"),
        fmu.steps(2, "steps"),
        before=[["python", str(library), started]],
        fmus=[fmu],
        **path,
    )
    assert lines == ["one instantiated", "1", "2"]


def test_an_fmu_whose_other_binary_is_missing_says_so(lag, loaded, host):
    fmu = loaded(lag)
    (fmu.folder / "binaries" / "linux64" / "libpythonfmu-export.so").unlink()
    assert "libpythonfmu-export.so cannot be loaded: " in refusal(host(fmus=[fmu]))


# several in one process


@pytest.mark.parametrize(
    "before", [[], [["global"]]], ids=["each for itself", "for everybody's use"]
)
def test_many_fmus_side_by_side_have_their_own_code_and_state(build, sources, loaded, host, before):
    """Two versions of one FMU, two FMUs with a module of the same name, instances of one; stepped in turns."""
    script = sources.adder.format(module="amounts", name="Adder")
    fmus = [
        loaded(
            build(
                "adder",
                script,
                out=f"out{amount}",
                amounts=f"def amount():\n    return {amount}.0\n",
            ),
            name,
        )
        for name, amount in (("one", 1), ("two", 2), ("again", 1))
    ]
    fmus.append(loaded(build("other", script, amounts="def amount():\n    return 4.0\n"), "four"))
    starts = [line for fmu in fmus for line in fmu.then("begin")]
    turns = [
        line
        for k in range(3)
        for fmu in fmus
        for line in fmu.steps(1 + (fmu.name == "again"), "total", first=k)
    ]
    lines = host(
        starts,
        turns,
        *(fmu.then("free") for fmu in fmus[:2]),
        fmus[2].steps(1, "total"),
        fmus=fmus,
        before=before,
    )
    values = list(map(float, lines[4:]))
    assert sorted(lines[:4]) == sorted(f"{fmu.name} instantiated" for fmu in fmus)
    assert values == [1, 2, 1, 2, 4, 2, 4, 3, 4, 8, 3, 6, 5, 6, 12, 7]


def test_two_versions_of_shipcosim_run_side_by_side(build, loaded, host, own_shipcosim):
    script = """
from shipcosim.fmi import Fmu, Output
from shipcosim.models.amounts import amount


class Adder(Fmu):
    total = Output("1", "sum so far")

    def step(self, t, h):
        self.total += amount()
"""
    fmus = []
    for version in (1, 2):
        own_shipcosim(f"v{version}", amounts=f"def amount():\n    return {version}.0\n")
        fmus.append(loaded(build("adder", script, out=f"out{version}"), f"v{version}"))
    starts, turns = (
        (fmu.then("begin") for fmu in fmus),
        (fmu.steps(1, "total") for fmu in (*fmus, *fmus)),
    )
    assert host(*starts, *turns, fmus=fmus)[2:] == ["1", "2", "2", "4"]


def test_fmus_may_be_loaded_by_many_threads_at_once(lag, build, sources, loaded, host):
    """While none has started Python yet."""
    script = sources.adder.format(module="amounts", name="Adder")
    adder = build("adder", script, amounts="def amount():\n    return 1.0\n")
    fmus = [loaded(lag if k % 2 else adder, f"n{k}") for k in range(40)]
    lines = host(*(fmu.then("begin") for fmu in fmus), *(fmu.steps(3) for fmu in fmus), fmus=fmus)
    assert sorted(lines) == sorted(f"n{k} instantiated" for k in range(40))


def test_an_fmu_is_loaded_again_after_it_was_freed(lag, loaded, host):
    one, same = loaded(lag, "one"), loaded(lag, "same")
    lines = host(
        one.then("begin"), one.then("free"), [["load", *same.load]], same.then("begin"), fmus=[one]
    )
    assert lines == ["one instantiated", "same instantiated"]


def test_the_whole_dp_ship_as_one_fmu_gives_the_digits_that_fmpy_gets(root, loaded, host, tmp_path):
    """Ten components in one block, two of them instances of one FMU."""
    ship = read_system(root / "ssp" / "gunnerus_dp", fmus=[build_stale(root)])
    export_fmu(ship, tmp_path / "ship.fmu", step_size=0.05, check=False)
    signals, fmu = (
        ["vessel.x", "vessel.psi", "port.thrust", "predictor.x_10"],
        loaded(tmp_path / "ship.fmu"),
    )
    rows = simulate_fmu(
        str(tmp_path / "ship.fmu"),
        stop_time=2.0,
        step_size=0.05,
        output_interval=0.05,
        output=signals,
    )
    lines = host(fmu.then("begin"), fmu.steps(40, h=0.05), fmu.get(*signals), fmus=[fmu])
    assert [float(line) for line in lines if not line.startswith(("log", "one"))] == list(rows[-1])[
        1:
    ]


# state


def test_a_state_goes_to_another_process_bit_for_bit(lag, loaded, host, load, tmp_path):
    """From C host to C host and to FMPy."""
    fmu, file = loaded(lag), tmp_path / "state"
    start = [*fmu.set(value_in=1.0), *fmu.then("begin"), *fmu.steps(5)]
    whole = host(start, fmu.then("save", file), fmu.steps(20, "value", first=5), fmus=[fmu])[1:]
    assert len(whole) == 20 == len(set(whole))
    again = host(
        fmu.then("begin"), fmu.then("restore", file), fmu.steps(20, "value", first=5), fmus=[fmu]
    )[1:]
    assert again == whole
    python = load(lag).start()
    python.slave.setFMUstate(python.slave.deSerializeFMUstate(file.read_bytes()))
    assert python.step(20, first=5) == list(map(float, whole))


def test_rolled_back_and_repeated_it_gives_the_same_bits(lag, loaded, host, tmp_path):
    fmu, file = loaded(lag), tmp_path / "state"
    again = [
        line
        for _ in range(2)
        for line in (*fmu.then("restore", file), *fmu.steps(9, "value", first=1))
    ]
    lines = host(fmu.then("begin"), fmu.steps(1), fmu.then("save", file), again, fmus=[fmu])[1:]
    assert lines[:9] == lines[9:] and len(set(lines)) == 9
