"""The package as a library: cheap to import, and a system runs in a line."""

import re
import subprocess
import sys

import pytest

import shipcosim as sc
from shipcosim.options import RunKeywords, RunOptions

RAMP = '''
from shipcosim.fmi import Fmu, Input, Output, Parameter


class Ramp(Fmu):
    """Rises at a rate."""

    more = Input("m/s", "added to the rate")
    height = Output("m", "height")
    rate = Parameter(1.0, "m/s", "rate")

    def step(self, t, h):
        self.height += h * (self.rate + self.more)
'''


@pytest.fixture(scope="module")
def ramp(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ramp")
    (folder / "ramp.py").write_text(RAMP)
    return sc.build_fmu(folder / "ramp.py", folder)


@pytest.fixture
def system(ramp):
    system = sc.new("climb")
    system.add_component("ramp", ramp)
    system.parameters["ramp.rate"] = 2.0
    return system


def refused(*arguments, **keywords):
    with pytest.raises(sc.ShipcosimError) as caught:
        sc.simulate(*arguments, **keywords)
    return str(caught.value)


def test_every_public_name_is_there_and_nothing_is_imported_before():
    code = (
        "import sys, shipcosim as sc; loaded = {name.partition('.')[0] for name in sys.modules};"
        "assert not loaded & {'numpy', 'lxml', 'pydantic', 'xarray', 'fmpy'}, loaded;"
        "assert set(sc.__all__) <= set(dir(sc)); [getattr(sc, name) for name in sc.__all__]"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'shipcosim' has no attribute 'simulat'"):
        sc.simulat  # noqa: B018


def test_an_fmu_does_not_carry_the_library(ramp):
    import zipfile

    with zipfile.ZipFile(ramp) as archive:
        carried = {name.partition("/shipcosim/")[2] for name in archive.namelist()}
    assert "__init__.py" in carried
    assert not any(name.startswith(("ssp/", "cosim/", "report/", "scenario")) for name in carried)


def test_a_system_runs_in_a_line(system):
    table = sc.simulate(system, stop_time=1.0, step_size=0.1, output_interval=0.5)
    assert table["time"].values.tolist() == [0.0, 0.5, 1.0]
    assert table["ramp.height"].values == pytest.approx([0.0, 1.0, 2.0])
    assert table["ramp.height"].attrs["units"] == "m"


def test_start_values_and_events_come_as_keywords(system):
    events = [{"time": 0.5, "override": {"ramp.more": -2.0}}]
    table = sc.simulate(system, stop_time=1.0, step_size=0.1, set={"ramp.rate": 4.0}, events=events)
    assert table["ramp.height"].values[[5, 10]] == pytest.approx([2.0, 3.0])
    assert system.parameters["ramp.rate"] == 2.0


def test_the_default_experiment_says_what_nobody_else_does(system, tmp_path):
    system.stop_time, system.step_size = 2.0, 0.5
    system.write(tmp_path / "climb.ssp")
    assert sc.simulate(tmp_path / "climb.ssp")["ramp.height"].values[-1] == pytest.approx(4.0)
    assert sc.simulate(system.checked(), stop_time=1.0).sizes["time"] == 3


def test_a_scenario_runs_alone_and_with_what_is_added(system, tmp_path):
    system.write(tmp_path / "ssp" / "climb")
    (tmp_path / "scenarios").mkdir()
    scenario = tmp_path / "scenarios" / "fast.toml"
    scenario.write_text(
        'system = "climb"\nstop_time = 1.0\nstep_size = 0.25\n[set]\n"ramp.rate" = 8.0\n'
    )
    assert sc.simulate(scenario=scenario)["ramp.height"].values[-1] == pytest.approx(8.0)
    table = sc.simulate(scenario=sc.read_scenario(scenario), stop_time=2.0, set={"ramp.more": 1.0})
    assert table["ramp.height"].values[-1] == pytest.approx(18.0)
    assert sc.simulate(system, scenario, set={"ramp.rate": 0.0})["ramp.height"].values[-1] == 0.0


def test_a_run_stops_keeps_its_state_and_continues_from_there(system, tmp_path):
    course = {"stop_time": 12.0, "step_size": 0.5, "start_time": 10.0}
    whole = sc.simulate(system, **course)
    first = sc.simulate(system, until=11.0, store=tmp_path / "at11.state", **course)
    rest = sc.simulate(system, resume=tmp_path / "at11.state", stop_time=12.0, step_size=0.5)
    assert whole["time"].values.tolist() == [10.0, 10.5, 11.0, 11.5, 12.0]
    assert first["ramp.height"].values.tolist() == whole["ramp.height"].values[:3].tolist()
    assert rest["ramp.height"].values.tolist() == whole["ramp.height"].values[2:].tolist()


def test_what_makes_no_sense_is_refused(system):
    assert "system is missing. Give a system or a scenario." in refused()
    assert "step_size is missing." in refused(system, stop_time=1.0)
    assert "stop_time = 'long'." in refused(system, stop_time="long", step_size=0.1)
    assert "is no multiple of the step size 0.1 s" in refused(system, stop_time=1.05, step_size=0.1)
    assert "The event does nothing." in refused(
        system, stop_time=1.0, step_size=0.1, events=[{"time": 0.0}]
    )
    assert "ramp has no variable 'rat'." in refused(
        system, stop_time=1.0, step_size=0.1, set={"ramp.rat": 1.0}
    )


def test_keywords_of_a_run_are_its_options():
    """But for `start_time`, whose default is the system's; times may be texts with a unit."""
    keywords, options = as_written(RunKeywords), as_written(RunOptions)
    options |= {
        name: options[name].replace("float", "float | str") for name in ("until", "timeout")
    }
    assert keywords == {name: hint for name, hint in options.items() if name != "start_time"}


def as_written(record):
    return {
        name: getattr(hint, "__forward_arg__", hint)
        for name, hint in record.__annotations__.items()
    }


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), [1.0], {"s": 1}])
@pytest.mark.parametrize("name", ["start_time", "until", "max_gap", "timeout"])
def test_a_time_that_is_none_is_refused_by_name(name, wrong):
    more = {
        "timeout": {"isolate": True},
        "max_gap": {"inputs": sc.simulate("gunnerus_open", stop_time=0.1, step_size=0.1).table},
    }
    with pytest.raises(sc.ShipcosimError, match=f"{name} = .* is no time"):
        sc.simulate(
            "gunnerus_open", stop_time=1.0, step_size=0.1, **{name: wrong}, **more.get(name, {})
        )


WRONG_KINDS = [
    ("engine", 3, "engine = 3. Give a text"),
    ("engine", [], "engine = .* Give a text"),
    ("parameters", [3], "parameters: 3 is neither a path nor a name"),
    ("parameters", 3, "parameters = 3. Give a path or name or a list"),
    ("parameters", b"x.ssv", "parameters = b'x.ssv'. Give a path or name or a list"),
    ("record", 3.5, "record = 3.5. Give a path or name or a list"),
    ("events", 3, "events = 3. Give a list"),
    ("events", sc.Scenario, "events = .* Give a list"),
    ("realtime", "fast", "realtime = 'fast'. Give a number"),
    ("realtime", True, "realtime = True. Give a number"),
    ("realtime", 10**400, "is no pace. Give a positive number"),
    ("out", 3, "out = 3. Give a path or name"),
    ("out", b"results", "out = b'results'. Give a path or name"),
    ("scenario", 5, "scenario = 5. Give a path or name or a Scenario"),
    ("inputs", "table.csv", "inputs = 'table.csv'. Give a Dataset, as of shipcosim.read_table"),
    ("inputs", {"port_rpm": [1.0]}, "inputs = .* Give a Dataset, as of shipcosim.read_table"),
    ("progress", 5, "progress = 5. Give a function"),
    ("resume", 5, "resume = 5. Give a Snapshot or a text or a path"),
    ("store", [], r"store = \[\]. Give a function or a text or a path"),
    ("force", "no", "force = 'no'. Give True or False"),
    ("isolate", 1, "isolate = 1. Give True or False"),
]


@pytest.mark.parametrize(("argument", "wrong", "message"), WRONG_KINDS)
def test_an_argument_of_a_wrong_type_is_refused_by_name(argument, wrong, message):
    with pytest.raises(sc.ShipcosimError, match=message):
        sc.simulate("gunnerus_open", **{"stop_time": 1.0, "step_size": 0.1, argument: wrong})


@pytest.mark.parametrize("folders", [[5], b"fmus", 5])
def test_folders_of_fmus_that_are_none_are_refused(folders):
    with pytest.raises(sc.ShipcosimError, match="fmus"):
        sc.run("gust", stop_time=0.1, fmus=folders)


@pytest.mark.parametrize("failures", [[5], b"bus", [None, "port"]])
def test_failures_that_are_no_names_are_refused(failures):
    with pytest.raises(sc.ShipcosimError, match="neither a path nor a name|b'bus'. Give a list"):
        sc.capability(failures=failures)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sc.judge(None, "gust"), "judge(): table = None. Give a Dataset"),
        (lambda: sc.new(3), "new(): name = 3. Give a text."),
        (lambda: sc.write_table(3, "x.csv"), "write_table(): table = 3. Give a Dataset"),
        (lambda: sc.write_report("x.html", "x.html"), "write_report(): table = 'x.html'."),
        (lambda: sc.build_fmu(3, "out"), "build_fmu(): source = 3. Give a path"),
        (lambda: sc.parameter("a.b", object), "a.b: found <class 'object'>. Give a number"),
        (lambda: sc.report(1, 2), "report(): first = 1. Give a path"),
        (lambda: sc.run(None), "run(): scenario = None. Give a path"),
    ],
)
def test_every_public_call_refuses_a_wrong_type_in_a_sentence(call, message):
    with pytest.raises(sc.ShipcosimError, match=re.escape(message)):
        call()


def test_only_what_is_public_is_offered():
    assert not [name for name in dir(sc) if name.startswith("_") and name != "__version__"]
    assert not {"Any", "ModuleType", "CallableRoom", "TYPE_CHECKING"} & set(dir(sc))


def test_an_argument_that_is_none_is_as_good_as_left_out():
    """Callers pass on what their own callers left out."""
    alone = sc.simulate("gunnerus_open", stop_time=0.1, step_size=0.1)
    nothing = dict.fromkeys(("events", "record", "engine", "timeout", "progress", "force", "order"))
    same = sc.simulate("gunnerus_open", stop_time=0.1, step_size=0.1, **nothing)
    assert same.table.identical(alone.table)


@pytest.mark.parametrize("count", [-1, 2.0, "2", True])
def test_a_count_is_a_whole_number_that_is_not_negative(count):
    """A negative one hung, or left out the last runs of a study."""
    words = " = .* Give a whole number from 0 on"
    with pytest.raises(sc.ShipcosimError, match="workers" + words):
        sc.simulate_many("gunnerus_open", variations=[{}], stop_time=0.1, workers=count)
    with pytest.raises(sc.ShipcosimError, match="at_most" + words):
        sc.sweep("wind_limits", at_most=count)
