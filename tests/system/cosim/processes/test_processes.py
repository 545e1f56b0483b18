"""Components in processes of their own: the results stay the same, and what one of them does hurts no other."""

import gc
import io
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import c_fmus
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.cosim import RunError, RunOptions, simulate
from shipcosim.cosim.master.component import set_start_values
from shipcosim.cosim.processes.child import Garbled, receive, send
from shipcosim.cosim.processes.remote_slave import IsolatedInstances
from shipcosim.cosim.slaves.slave import SlaveError
from shipcosim.errors import ShipcosimError
from shipcosim.fmi.export.builder import build_fmu

pytestmark = pytest.mark.skipif(
    os.name != "posix", reason="the ways to end a process are those of POSIX"
)

DANGEROUS = '''
import ctypes
import os
import signal
import sys
import time

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Fatal:
    def __str__(self):
        os._exit(5)


class Dangerous(Fmu):
    """Does what it is told to, at a time that it is told."""

    how = Parameter("", "1", "what to do")
    when = Parameter(0.5, "s", "time of the step")
    u = Input("1", "nothing")
    y = Output("1", "time at the end of the step")
    count = Output("1", "steps so far", start=0)
    odd = Output("1", "whether that is odd", start=False)
    text = Output("1", "steps so far in words", start="none")

    def start(self):
        if self.when < 0.0:
            self.act()

    def step(self, t, h):
        self.y = t + h
        self.count += 1
        self.odd = self.count % 2 == 1
        self.text = Fatal() if self.how == "text" and self.count == 3 else f"{self.count} of them"
        if abs(t - self.when) < 1e-9:
            self.act()

    def act(self):
        if self.how == "signal":
            os.kill(os.getpid(), signal.SIGSEGV)
        if self.how == "read":
            ctypes.string_at(0)
        if self.how == "abort":
            os.write(2, b"something is badly wrong\\n")
            os.abort()
        if self.how == "leave":
            os._exit(3)
        if self.how == "fork":
            if os.fork() == 0:
                time.sleep(600.0)
            os._exit(4)
        if self.how == "hang":
            print("hanging")
            time.sleep(600.0)
        if self.how == "raise":
            raise ValueError("50%s of it is wrong")
        if self.how == "interrupt":
            os.kill(os.getpid(), signal.SIGINT)
        if self.how == "print":
            print("said by Python", flush=False)
            print("said as error", file=sys.stderr)
            os.write(1, "said by the system: \\u00f8\\n".encode())
            os.write(1, b"\\xff without end")
        if self.how == "flood":
            for line in range(3000):
                print("line", line)
        if self.how == "garbage":
            for end in (0, 1, 2):
                os.write(1, b"\\x01\\x00\\x00\\x00\\x00\\x00\\x00\\x00" * 1000)
        if self.how == "pipes":
            for pipe in range(1, 50):
                try:
                    os.write(pipe, b"\\x1b[31m 12345")
                except OSError:
                    pass
        if self.how == "exit":
            ctypes.CDLL(None).exit(0)
        if self.how == "child" and os.fork() == 0:
            os.execvp("sleep", ["sleep", "600.125"])
        if self.how == "close":
            os.closerange(3, 100)
        if self.how == "warn":
            self.log("100% full", "warning")
'''
FALLING = """
#define NX 1
#define NZ 0
#define STATES {0}
static void start(M* m) {}
static void equations(M* m) {
  m->r[1] = 1.0;
  if (m->time > 0.35 && m->time < 0.45) printf("it was nice\\n");
  if (m->time > 0.45) {
    if (m->i[0] == 1) *(volatile int*)0 = 1;
    if (m->i[0] == 2) for (;;) {}
    if (m->i[0] == 3) abort();
  }
}
static void indicators(M* m, double* z) {}
static void event(M* m) {}
static int completed(M* m) { return 0; }
"""
VARIABLES = [
    ("x", 0, "output", "Real", None),
    ("speed", 1, "output", "Real", None),
    ("how", 0, "input", "Integer", 0),
]


@pytest.fixture(scope="module")
def dangerous(fmus, tmp_path_factory):
    """The FMU of that name in the folder of the others."""
    source = tmp_path_factory.mktemp("source") / "dangerous.py"
    source.write_text(DANGEROUS)
    return build_fmu(source, fmus("clock"))


@pytest.fixture(scope="module")
def falling(fmus, needs):
    """An FMU that was made from C."""
    if c_fmus.compiler() is None:
        needs("a C compiler")
    description = c_fmus.describe("falling", "2.0", VARIABLES, ("CoSimulation",), 1, 0)
    return c_fmus.build(fmus("clock"), "falling", "2.0", FALLING, description)


@pytest.fixture
def system(make_system, dangerous):
    """Function: a system with one component that does something, fed by one that does not."""
    return lambda how, when=0.5: make_system(
        {"clock": "clock", "engine": ("dangerous", {"how": how, "when": when})},
        ["clock.time -> engine.u"],
    )


LIMIT = 5.0  # s: a component that works answers within it on a busy machine too


def same(one, other):
    assert list(one) == list(other) and one.attrs == other.attrs
    for name in ("time", *one):
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


# results


PARTS = {
    "plant": ("integrator", {"y_start": 0.3}),
    "law": ("gain", {"factor": -0.9, "offset": 0.123}),
    "slow": ("lag", {"time_constant": 1.3}, 0.2),
    "clock": "clock",
    "meter": "meter",
}
LINKS = ["plant.y -> law.u", "law.y -> plant.u", "plant.y -> slow.u", "clock.count -> meter.number"]
LINKS += ["clock.odd -> meter.flag", "clock.text -> meter.text", "push -> meter.real"]
EVENTS = [{"time": 0.4, "override": {"law.y": 0.5, "push": 2.0}}, {"time": 1.2, "reset": ["law.y"]}]


def test_results_are_the_same_to_the_last_digit(make_system, make_scenario):
    """All types, a loop, a slow component, events; in the other order, and the DP ship, at night."""
    check_same_digits(make_system, make_scenario, "gauss-seidel")


def check_same_digits(make_system, make_scenario, order):
    system, scenario = (
        make_system(PARTS, LINKS, {"push": ("input", "Real", "")}),
        make_scenario(2.4, 0.1, events=EVENTS),
    )
    same(
        simulate(system, scenario, RunOptions(order=order)),
        simulate(system, scenario, RunOptions(order=order, isolate=True)),
    )


def test_a_stored_run_goes_on_from_processes_to_processes_and_back(make_system, make_scenario):
    few = {name: PARTS[name] for name in ("plant", "law", "meter")}
    links = ["plant.y -> law.u", "law.y -> plant.u", "push -> meter.real"]
    system, scenario = (
        make_system(few, links, {"push": ("input", "Real", "")}),
        make_scenario(2.4, 0.1, events=EVENTS),
    )
    whole, stored = simulate(system, scenario), []
    simulate(system, scenario, RunOptions(until=0.8, store=stored.append, isolate=True))
    simulate(system, scenario, RunOptions(until=0.8, store=stored.append))
    assert stored[0] == stored[1]
    for isolate in (False, True):
        rest = simulate(system, scenario, RunOptions(resume=stored[0], isolate=isolate))
        assert all(
            rest[name].values.tobytes() == whole[name].values[8:].tobytes() for name in whole
        )


# crashes


# A signal and the C library's exit in place of a wrong address and Python's: at night.
@pytest.mark.parametrize(
    "how, said",
    [
        ("read", "Its process was ended in DoStep by signal 11, Segmentation fault."),
        ("abort", "by signal 6, Aborted. It printed last:\nsomething is badly wrong"),
        ("leave", "Its process ended itself in DoStep, with exit code 3."),
        ("pipes", "the FMU writes into files that it did not open. It was ended."),
        ("close", "Its process ended itself in DoStep, with exit code 1."),
        ("fork", "Its process ended itself in DoStep, with exit code 4."),
        ("hang", f"Its process gave no answer to DoStep within {LIMIT:g} s and was ended."),
    ],
)
def test_a_component_that_goes_down_is_named_and_the_rows_before_are_there(
    system, make_scenario, how, said
):
    check_fallen(system, make_scenario, how, said)


def check_fallen(system, make_scenario, how, said):
    with pytest.raises(RunError) as error:
        simulate(system(how), make_scenario(1.0, 0.1), RunOptions(isolate=True, timeout=LIMIT))
    assert str(error.value).startswith("engine: failed in the step from t = 0.5 s. ")
    assert said in str(error.value)
    table = error.value.table
    assert table.attrs["complete"] == 0 and np.allclose(table["time"], np.arange(6) * 0.1)
    assert table["clock.count"].values.tolist() == list(range(6))


def test_a_slow_component_failed_in_the_step_in_which_it_did(make_system, make_scenario, dangerous):
    system = make_system(
        {"engine": ("dangerous", {"how": "read", "when": 0.6}, 0.3), "after": "gain"}
    )
    with pytest.raises(
        RunError, match="engine: failed in the step from t = 0.6 s. Its process was ended"
    ):
        simulate(system, make_scenario(1.2, 0.1), RunOptions(isolate=True))


def test_one_that_goes_down_at_the_start_is_named_too(system, make_scenario):
    with pytest.raises(
        RunError, match="engine: failed at the start. Its process was ended in .* by signal 11"
    ) as error:
        simulate(system("signal", -1.0), make_scenario(1.0, 0.1), RunOptions(isolate=True))
    assert error.value.table.sizes["time"] == 0


def test_the_same_holds_for_an_fmu_made_from_c(falling, make_system, make_scenario):
    """What it has printed into the buffer of C in the steps before does not go down with it."""
    said = "signal 11, Segmentation fault. It printed last:\nit was nice"
    check_fallen_in_c(make_system, make_scenario, 1, said)


def check_fallen_in_c(make_system, make_scenario, how, said):
    system = make_system({"clock": "clock", "stone": ("falling", {"how": how})})
    with pytest.raises(RunError, match="stone: failed in the step from t = 0.4 s.*") as error:
        simulate(system, make_scenario(1.0, 0.1), RunOptions(isolate=True, timeout=LIMIT))
    assert said in str(error.value)
    assert error.value.table["stone.x"].values[-1] == pytest.approx(0.4)


def test_one_that_goes_down_when_its_text_is_read_is_named_by_the_connection(
    make_system, dangerous, make_scenario
):
    system = make_system(
        {"engine": ("dangerous", {"how": "text"}), "meter": "meter"}, ["engine.text -> meter.text"]
    )
    with pytest.raises(RunError) as error:
        simulate(system, make_scenario(1.0, 0.1), RunOptions(isolate=True))
    said = str(error.value)
    assert said.startswith(
        "engine.text -> meter.text: its value cannot be passed on. Its process ended itself"
    )
    assert error.value.table["engine.count"].values.tolist() == [0, 1, 2]


def test_a_start_value_that_is_refused_is_said_where_it_was_set(make_system):
    system = make_system({"slow": "lag"})
    component = system.components["slow"]
    with IsolatedInstances(system, LIMIT) as instances:
        slave = instances.instance_of(component)
        with pytest.raises(
            SlaveError, match="slow at t = 0 s: parameter 'time_constant' was set to nan"
        ):
            set_start_values(slave, [(component.fmu.variables["time_constant"], float("nan"))])


def test_what_goes_wrong_without_a_crash_is_said_in_the_same_words(system, make_scenario):
    said = []
    for isolate in (False, True):
        with pytest.raises(RunError) as error:
            simulate(system("raise"), make_scenario(1.0, 0.1), RunOptions(isolate=isolate))
        said.append(str(error.value))
    assert said[0] == said[1] and "50%s of it is wrong" in said[0] and "dangerous.py" in said[0]


@pytest.mark.parametrize("how", ["garbage", "warn", "interrupt"])
def test_what_would_confuse_a_run_does_not(system, make_scenario, how):
    table = simulate(system(how), make_scenario(1.0, 0.1), RunOptions(isolate=True))
    assert table["engine.count"].values.tolist() == list(range(11))
    assert ("100% full" in table.attrs["remarks"]) == (how == "warn")


# what is printed


def test_what_components_print_is_shown_with_their_names(system, make_scenario, capfd):
    simulate(system("print"), make_scenario(1.0, 0.1), RunOptions(isolate=True))
    out, err = capfd.readouterr()
    assert out == ""
    lines = ["said by Python", "said as error", "said by the system: \u00f8", "\ufffd without end"]
    assert sorted(err.splitlines()) == sorted(f"[engine] {line}" for line in lines)


def test_a_flood_of_prints_is_cut(system, make_scenario, capfd):
    simulate(system("flood"), make_scenario(1.0, 0.1), RunOptions(isolate=True))
    lines = capfd.readouterr().err.splitlines()
    assert lines[999:] == [
        "[engine] line 999",
        "[engine] prints more than 1000 lines; no more are shown",
    ]


# around it


def processes(parent):
    """Processes of components that a process has started: (pid, command line)."""
    found = subprocess.run(
        ["ps", "-ww", "-o", "pid=,args=", "--ppid", str(parent)], capture_output=True, text=True
    ).stdout
    listed = [line.split(maxsplit=1) for line in found.splitlines()]
    return [(int(pid), command) for pid, command in listed if "cosim.processes.child" in command]


@given(noise=st.binary(min_size=1, max_size=64))
@settings(max_examples=200, deadline=None)
def test_bytes_before_an_answer_are_never_taken_for_one(noise):
    """They are seen at the mark, or, where they begin as it does, at what follows."""
    pipe = io.BytesIO()
    send(pipe, (True, None, []))
    answer = pipe.getvalue()
    with pytest.raises((Garbled, EOFError)):
        receive(io.BytesIO(noise + answer))
    assert receive(io.BytesIO(answer)) == (True, None, [])


@pytest.mark.parametrize("how", ["read", "", "pipes"])
def test_nothing_is_left_behind(system, make_scenario, how, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    part, descriptors = (
        system(how),
        len(os.listdir("/proc/self/fd")) if sys.platform == "linux" else 0,
    )
    try:
        simulate(part, make_scenario(1.0, 0.1), RunOptions(isolate=True))
    except RunError:
        pass
    gc.collect()
    assert not processes(os.getpid()) and not os.listdir(tmp_path / "temporary")
    assert threading.active_count() == 1
    if sys.platform == "linux":
        assert len(os.listdir("/proc/self/fd")) <= descriptors


def test_what_a_component_has_started_ends_with_it(system, make_scenario):
    table = simulate(system("child"), make_scenario(1.0, 0.1), RunOptions(isolate=True))
    assert table["engine.count"].values[-1] == 10
    left = subprocess.run(["pgrep", "-f", "^sleep 600.125"], capture_output=True, text=True).stdout
    assert not [pid for pid in left.split() if is_running(pid)]


RUN = """
import sys
from shipcosim.cosim import Interrupted, RunOptions, simulate
from shipcosim.scenario import Scenario
from shipcosim.ssp import read_system
try:
    system, scenario = read_system(sys.argv[1], fmus=[sys.argv[2]]), Scenario(stop_time=1.0, step_size=0.1)
    simulate(system, scenario, RunOptions(isolate=True))
except Interrupted as stop:
    print("interrupted after", stop.table.sizes["time"], "rows")
"""


@pytest.fixture
def hanging(system, tmp_path):
    """A run in another process whose component hangs."""
    files = tmp_path / "SystemStructure.ssd", system("hang").components["engine"].fmu.path.parent
    run = subprocess.Popen(
        [sys.executable, "-c", RUN, *files],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert run.stderr.readline() == "[engine] hanging\n"
    yield run
    run.kill()
    run.communicate()


def test_a_second_ctrl_c_ends_a_run_whose_component_hangs(hanging):
    """The first one waits for the component, as it does without processes of their own."""
    hanging.send_signal(signal.SIGINT)
    time.sleep(0.3)
    assert hanging.poll() is None
    hanging.send_signal(signal.SIGINT)
    assert hanging.communicate(timeout=120.0) == ("interrupted after 6 rows\n", "")
    assert hanging.returncode == 0


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends children with their parent")
def test_a_component_that_hangs_does_not_outlive_a_run_that_is_killed(hanging):
    children = [pid for pid, _ in processes(hanging.pid)]
    assert len(children) == 2
    hanging.kill()
    hanging.wait()
    deadline = time.monotonic() + 60.0
    while any(map(is_running, children)) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not any(map(is_running, children))


def is_running(pid):
    """Whether a process is there and not only waits for its parent to ask how it ended."""
    found = subprocess.run(
        ["ps", "-o", "stat=", "-p", str(pid)], capture_output=True, text=True
    ).stdout.strip()
    return bool(found) and not found.startswith("Z")


def test_other_engines_refuse_it(system, make_scenario):
    with pytest.raises(
        ShipcosimError, match="does not know isolate. The engines 'fmpy' and 'native' do."
    ):
        simulate(system(""), make_scenario(1.0, 0.1), RunOptions(engine="libcosim", isolate=True))


@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan"), float("inf")])
def test_what_is_no_time_limit_is_refused(system, make_scenario, limit):
    with pytest.raises(ShipcosimError, match="is no time limit"):
        simulate(system(""), make_scenario(1.0, 0.1), RunOptions(isolate=True, timeout=limit))
