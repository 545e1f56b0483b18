"""Built FMUs in their hosts: FMPy, a process without this package, libcosim, ecos."""

import importlib.util
import math
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from fmpy.fmi1 import FMICallException

from shipcosim.library import build_stale


def run(*code, path):
    """Run Python that finds only what is in a folder, without site packages and environment."""
    text = "\n".join([f"import sys; sys.path.append({str(path)!r})", *map(textwrap.dedent, code)])
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", text], capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture
def bare_packages(tmp_path):
    """Folder with NumPy and what FMPy needs to be the host, nothing else."""
    folder = tmp_path / "packages"
    folder.mkdir()
    for name in ("numpy", "numpy.libs", "fmpy", "attr", "attrs", "lxml", "msgpack"):
        found = importlib.util.find_spec(name.partition(".")[0])
        source = Path(found.origin).parents[1] / name
        if source.exists():
            (folder / name).symlink_to(source)
    return folder


def test_values_of_every_type_go_in_and_out(lag, load):
    host = load(lag).start(seed=5, label="deep", time_constant=4.0)
    host.set(value_in=1000.0, mode=2)
    assert (host.get("steps"), host.get("above"), host.get("text")) == (0, 0, "deep")
    host.step()
    assert (host.get("steps"), host.get("above"), host.get("text")) == (1, 1, "deep 2")


def test_outputs_follow_inputs_while_components_agree_on_the_start(lag, load):
    host = load(lag)
    host.slave.enterInitializationMode()
    for value in (1.0, 2.0, 2.0):
        host.set(value_in=value)
        assert host.get("value") == value
    host.set(value_in=3.0)
    host.slave.exitInitializationMode()
    assert host.get("value") == 3.0
    host.set(value_in=9.0)
    assert host.get("value") == 3.0


def test_a_reset_instance_starts_from_its_start_values(lag, load):
    host = load(lag).start(gain=3.0, value_in=2.0)
    first = host.step(5)
    host.slave.reset()
    host.slave.setupExperiment(startTime=0.0)
    assert host.get("gain") == 1.0
    assert host.start(gain=3.0, value_in=2.0).step(5) == first


def test_a_fork_at_time_t_goes_on_bit_for_bit(lag, load):
    host = load(lag).start(value_in=1.0)
    host.step(5)
    state = host.slave.getFMUstate()
    first = host.step(20, first=5)
    for _ in range(2):
        host.slave.setFMUstate(state)
        assert host.step(20, first=5) == first
    host.slave.freeFMUstate(state)


def test_a_state_moves_to_another_instance_and_to_another_process(
    lag, load, bare_packages, tmp_path
):
    host = load(lag, "one").start(value_in=1.0)
    host.step(5)
    state = host.slave.getFMUstate()
    data = host.slave.serializeFMUstate(state)
    expected = host.step(20, first=5)

    other = load(lag, "two").start()
    other.slave.setFMUstate(other.slave.deSerializeFMUstate(data))
    assert other.step(20, first=5) == expected

    (tmp_path / "state").write_bytes(data)
    printed = run(
        BARE_HOST.format(fmu=str(lag)),
        f"""
        slave.setFMUstate(slave.deSerializeFMUstate(open({str(tmp_path / "state")!r}, "rb").read()))
        values = []
        for index in range(5, 25):
            slave.doStep(index * 0.1, 0.1)
            values += slave.getReal([{host.variables["value"].valueReference}])
        print(repr(values))
        """,
        path=bare_packages,
    )
    assert printed.strip() == repr(expected)


BARE_HOST = """
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
description = read_model_description({fmu!r})
slave = FMU2Slave(guid=description.guid, unzipDirectory=extract({fmu!r}),
                  modelIdentifier=description.coSimulation.modelIdentifier, instanceName="component")
slave.instantiate(loggingOn=True)
slave.setupExperiment(startTime=0.0)
slave.enterInitializationMode()
slave.exitInitializationMode()
"""


def test_an_fmu_runs_where_this_package_is_not_installed(lag, bare_packages):
    printed = run(
        "before = list(sys.path)",
        BARE_HOST.format(fmu=str(lag)),
        """
        slave.doStep(0.0, 0.1)
        import importlib.util
        assert not any(importlib.util.find_spec(name) for name in ("shipcosim", "pythonfmu", "lag"))
        assert sys.path == before
        print("ran")
        """,
        path=bare_packages,
    )
    assert printed.strip() == "ran"


def test_a_state_of_another_fmu_is_refused_in_words(lag, build, sources, load):
    other = load(build("lag", sources.lag + "\n", out="other")).start()
    host = load(lag).start()
    state = host.slave.deSerializeFMUstate(other.slave.serializeFMUstate(other.slave.getFMUstate()))
    with pytest.raises(FMICallException):
        host.slave.setFMUstate(state)
    assert "the state cannot be restored: this is a state of 'lag_" in host.messages[-1][1]


def test_two_fmus_with_a_module_of_the_same_name_run_their_own(build, sources, load):
    script = sources.adder.format(module="amounts", name="Adder")
    one = load(build("one", script, amounts="def amount():\n    return 1.0\n")).start()
    two = load(build("two", script, amounts="def amount():\n    return 2.0\n")).start()
    assert (one.step(2, read="total"), two.step(2, read="total")) == ([1.0, 2.0], [2.0, 4.0])


def test_two_versions_of_one_fmu_run_side_by_side(build, sources, load):
    script = sources.adder.format(module="amounts", name="Adder")
    old = load(build("adder", script, out="old", amounts="def amount():\n    return 1.0\n")).start()
    new = load(build("adder", script, out="new", amounts="def amount():\n    return 2.0\n")).start()
    assert (old.step(2, read="total"), new.step(2, read="total")) == ([1.0, 2.0], [2.0, 4.0])


def test_instances_share_code_but_no_value_and_leave_the_hosts_path_alone(lag, load):
    before = list(sys.path)
    one, other = load(lag, "one").start(gain=2.0, value_in=1.0), load(lag, "other").start()
    assert (one.get("value"), other.get("value")) == (2.0, 0.0)
    assert sys.path == before
    assert "lag" not in sys.modules


def test_an_exception_reaches_the_user_with_traceback_component_and_time(lag, load, sources):
    host = load(lag, "port").start(mode=13)
    with pytest.raises(FMICallException):
        host.slave.doStep(1.5, 0.1)
    status, text = host.messages[-1]
    line = 1 + next(
        number for number, line in enumerate(sources.lag.splitlines()) if "raise" in line
    )
    assert status >= 3
    assert "port at t = 1.5 s: exception" in text and "100 % sure" in text
    assert f'File "lag.py", line {line}, in step\n    raise RuntimeError("100 %s broken")' in text
    assert text.endswith("RuntimeError: 100 %s broken")
    assert "slave.py" not in text


def test_source_lines_are_shown_after_the_unpacked_archive_is_gone(lag, tmp_path, load):
    load(lag)
    for source in Path(tmp_path).rglob("lag_*_code/lag.py"):
        source.unlink()
    host = load(lag).start(mode=13)
    with pytest.raises(FMICallException):
        host.step()
    assert 'raise RuntimeError("100 %s broken")' in host.messages[-1][1]


def test_an_instance_outlives_any_number_of_failed_calls(lag, load):
    host = load(lag).start()
    for _ in range(50):
        host.set(mode=13)
        with pytest.raises(FMICallException):
            host.step()
        with pytest.raises(FMICallException):
            host.set(value_in=math.nan)
        host.set(mode=0)
        host.step()
    host.slave.terminate()


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_inputs_and_parameters_that_are_not_finite_are_refused_by_name(lag, load, value):
    host = load(lag, "port")
    with pytest.raises(FMICallException):
        host.set(time_constant=value)
    assert f"port at t = 0 s: parameter 'time_constant' was set to {value}" in host.messages[-1][1]
    host.start()
    with pytest.raises(FMICallException):
        host.set(value_in=value)
    assert f"port at t = 0 s: input 'value_in' was set to {value}" in host.messages[-1][1]
    assert host.get("value_in") == 0.0


def test_an_output_that_is_not_finite_stops_the_run(lag, load):
    host = load(lag, "port").start(mode=14)
    with pytest.raises(FMICallException):
        host.slave.doStep(1.0, 0.5)
    assert "port at t = 1.5 s: output 'value' is nan" in host.messages[-1][1]


def test_fixed_parameters_are_fixed_in_the_run_and_tunable_ones_are_not(lag, load):
    host = load(lag, "port").start()
    host.set(gain=2.0)
    assert host.get("gain") == 2.0
    with pytest.raises(FMICallException):
        host.set(time_constant=3.0)
    assert "parameter 'time_constant' is fixed" in host.messages[-1][1]
    assert host.get("time_constant") == 2.0


def test_a_parameter_out_of_bounds_stops_the_initialisation(lag, load):
    host = load(lag, "port")
    with pytest.raises(FMICallException):
        host.start(time_constant=0.01)
    assert "parameter 'time_constant' is 0.01, below its minimum 0.1 [s]" in host.messages[-1][1]


def test_what_cannot_be_stored_is_said_and_the_run_goes_on(build, load):
    script = """
    from shipcosim.fmi import Fmu, Output


    class Holder(Fmu):
        value = Output("1", "value")

        def start(self):
            self.function = print

        def step(self, t, h):
            self.function("", end="")
            self.value += 1.0
    """
    host = load(build("holder", textwrap.dedent(script))).start()
    state = host.slave.getFMUstate()
    with pytest.raises(FMICallException):
        host.slave.serializeFMUstate(state)
    assert "the state cannot be stored: builtins.print is refused" in host.messages[-1][1]
    assert host.step(2) == [1.0, 2.0]


def test_failed_calls_and_new_instances_lose_no_reference(lag, bare_packages):
    """pythonfmu's binary gives up references that it does not own; without balance, memory is used twice."""
    printed = run(
        BARE_HOST.format(fmu=str(lag)),
        """
        import gc
        entry = [module for name, module in sys.modules.items() if name.startswith("lag_") and "_code" not in name][0]
        counts = []
        for failures in (0, 0, 3, 0, 30, 0):
            slave.freeInstance()
            slave.instantiate(loggingOn=False)
            for _ in range(failures):
                try:
                    slave.setReal([0], [float("nan")])
                    raise SystemExit("not refused")
                except Exception:
                    pass
            counts.append((sys.getrefcount(vars(entry)), sys.getrefcount(entry.Lag)))
        namespace, cls = zip(*counts)
        print(len(set(namespace)), len({after - before for before, after in zip(cls, cls[1:])}))
        print(sum(isinstance(item, entry.Lag) for item in gc.get_objects()))
        """,
        path=bare_packages,
    )
    assert printed.split()[-3:] == ["1", "1", "1"]  # before them, what the failures said


def test_libcosim_runs_it(lag):
    pytest.importorskip("libcosimpy", reason="libcosim is not installed", exc_type=ImportError)
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(100_000_000)
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=str(lag), instance_name="lag"))
    manipulator, observer = CosimManipulator.create_override(), CosimObserver.create_last_value()
    execution.add_manipulator(manipulator)
    execution.add_observer(observer)
    manipulator.slave_real_values(index, [0], [5.0])
    execution.step(10)
    assert observer.last_real_values(index, [0]) == [5.0]
    assert observer.last_integer_values(index, [3]) == [10]
    manipulator.slave_integer_values(index, [1], [13])
    assert not execution.step()


def test_ecos_runs_it(lag):
    try:
        import ecospy
    except (ImportError, OSError) as error:
        pytest.skip(f"ecos is not installed: {error}")
    with ecospy.EcosSimulationStructure() as structure:
        structure.add_model("lag", str(lag))
        structure.add_parameter_set("given", {"lag::gain": 2.0})
        with ecospy.EcosSimulation(step_size=0.1, structure=structure) as simulation:
            simulation.init(parameter_set="given")
            simulation.set_real("lag::value_in", 5.0)
            simulation.step(10)
            assert simulation.get_integer("lag::steps") == 10
            assert simulation.get_real("lag::gain") == 2.0
            simulation.terminate()


def given_to(names, root):
    """Parameters of the FMUs of the project as in their reference results."""
    script = root / "docs" / "generators" / "write_fmu_documents.py"
    spec = importlib.util.spec_from_file_location("documents", script)
    documents = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(documents)
    return {name: documents.parameters_of(name) for name in names}


def test_all_fmus_of_the_project_run_with_python_numpy_and_fmpy_alone(root, bare_packages):
    """For 10 s each, through FMPy's own master; nothing else of what is installed here can be found."""
    fmus = build_stale(root)
    names = sorted(
        path.parent.name for path in (root / "fmus").glob("*/*.py") if path.stem == path.parent.name
    )
    printed = run(
        f"names, folder, given = {names!r}, {str(fmus)!r}, {given_to(names, root)!r}",
        """
        import importlib.util
        from fmpy import simulate_fmu
        for name in names:
            rows = simulate_fmu(
                f"{folder}/{name}.fmu", stop_time=10.0, step_size=0.05, output_interval=0.05, start_values=given[name]
            )
            print(name, len(rows), all(abs(value) < 1e9 for row in rows.tolist() for value in row))
        absent = ("shipcosim", "pythonfmu", "scipy", "xarray", "pandas", "pydantic", "pint")
        assert not any(importlib.util.find_spec(module) for module in absent)
        """,
        path=bare_packages,
    )
    assert len(names) >= 18 and printed.splitlines() == [f"{name} 201 True" for name in names]
