"""States of FMUs and of whole systems: read, stored, restored, continued."""

import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from ships import given_to

import shipcosim as sc
from shipcosim.cosim import RunError, RunOptions, Snapshot, read_snapshot, simulate, write_snapshot
from shipcosim.cosim.master.component import set_start_values
from shipcosim.cosim.slaves.instances import Instances
from shipcosim.cosim.slaves.slave import BUFFER_TYPES
from shipcosim.errors import ShipcosimError
from shipcosim.library import build_stale
from shipcosim.scenario import Event, read_scenario
from shipcosim.ssp import Component, read_fmu, read_system, with_values

ROOT = Path(__file__).parents[4]
FMUS = sorted(
    path.parent.name for path in (ROOT / "fmus").glob("*/*.py") if path.stem == path.parent.name
)
THREE_UNITS = {
    **{"thrust_min_1": -5.0, "thrust_max_1": 5.0, "thrust_rate_1": 0.5, "yaw_lever": 10.0},
    **{
        "x_2": 5.0,
        "azimuth_2": 1.5708,
        "thrust_min_2": -5.0,
        "thrust_max_2": 5.0,
        "thrust_rate_2": 0.5,
    },
    **{
        "x_3": -5.0,
        "azimuth_3": 1.5708,
        "thrust_min_3": -5.0,
        "thrust_max_3": 5.0,
        "thrust_rate_3": 0.5,
    },
}
"""One unit ahead and two to the side."""
NOT_NEUTRAL = {
    "drift_force": {"north": 1000.0, "onset_time": 16.0, "ramp_time": 5.0, "yaw_arm": -1.5},
    # Its loads are tenths of a newton here: thrusters of that size.
    "consequence_analysis": {f"thrust_max_{i}": 0.3 for i in range(1, 5)}
    | {"analysis_period": 1.0},
    "earth_force": {"x": -17.0, "north": 1000.0, "onset_time": 16.0, "ramp_time": 5.0},
    "fixed_angle_allocator": THREE_UNITS,
    "instruments": {"lag": 1.33},
    "mapped_thruster": {
        "x": 1.0,
        "y": 0.5,
        "thrust_table": "-1 -5; 1 5",
        "time_constant": 2.0,
        "speed_loss": 0.1,
    },
    "optimal_units_allocator": THREE_UNITS,
    "rough_vessel": {
        "strip_factors": "-1 1.3; 1 0.8",
        "memory_sway": 0.2,
        "wind_factors": "0 1 1 1; 360 1.2 1 1",
    },
    "thruster_interaction": {"x_1": 5.0, "diameter_1": 1.0, "diameter_2": 1.0},
    "thruster_monitor": {"position_limit": 0.15, "alarm_delay": 0.2},
    "varying_current": {"north_end": 0.5},
}
"""FMU: parameters without which it does nothing."""
H = 0.05


@pytest.fixture(scope="module")
def built(root):
    return build_stale(root)


class Driven:
    """An FMU alone, whose real inputs move; real outputs, or those that it has, after each step."""

    def __init__(self, fmu, instances, name="alone"):
        self.inputs = [
            v for v in fmu.variables.values() if v.causality == "input" and v.kind == "Real"
        ]
        outputs = [v for v in fmu.variables.values() if v.causality == "output"]
        kind = "Real" if any(v.kind == "Real" for v in outputs) else "Boolean"
        self.outputs = [v for v in outputs if v.kind == kind]
        self.slave = instances.instance_of(Component(name, fmu))
        changed = given_to(fmu.path.stem) | NOT_NEUTRAL.get(fmu.path.stem, {})
        known = (
            fmu.variables.keys() & changed.keys()
        )  # a component that is like others takes from them what it has
        set_start_values(self.slave, [(fmu.variables[key], changed[key]) for key in known])
        self.starts = np.array([variable.start for variable in self.inputs])
        self.given, self.seen = self.starts.copy(), np.zeros(len(self.outputs), BUFFER_TYPES[kind])
        self.set = self.slave.setter("Real", self.inputs, self.given)
        self.get, self.step = self.slave.getter(kind, self.outputs, self.seen), self.slave.stepper()
        self.slave.enter_initialisation(0.0, 1000.0)
        self.slave.exit_initialisation()

    def run(self, first, last):
        """Outputs after the steps first..last - 1, (n, outputs)."""
        rows = []
        for k in range(first, last):
            self.given[:] = self.starts + 0.1 * (
                1.0 + np.sin(0.3 * k + np.arange(len(self.starts)))
            )
            assert (self.set(), self.step(k * H, H), self.get()) == (0, 0, 0)
            rows.append(self.seen.copy())
        return np.array(rows)


@pytest.mark.parametrize("name", FMUS)
def test_rolled_back_and_repeated_an_fmu_gives_the_same_bits(built, name):
    with Instances() as instances:
        fmu = Driven(read_fmu(built / f"{name}.fmu"), instances)
        fmu.run(0, 300)
        state = fmu.slave.state()
        expected = fmu.run(300, 700)
        assert np.ptp(expected, axis=0).max() > 0.0
        for _ in range(2):
            fmu.slave.restore(state)
            assert np.array_equal(fmu.run(300, 700), expected)
        other = Driven(read_fmu(built / f"{name}.fmu"), instances, "other")
        other.slave.restore(state)
        assert np.array_equal(other.run(300, 700), expected)


def assert_same(whole, first, second):
    """The rows of a run, and those before and after it was stored: the same bits in the same columns."""
    n = first.sizes["time"] - 1
    assert list(whole) == list(first) == list(second)
    for name in ("time", *whole):
        parts = np.concatenate([first[name].values[:n], second[name].values])
        assert parts.tobytes() == whole[name].values.tobytes(), name


PARTS = {
    "plant": ("integrator", {"y_start": 0.3}),
    "law": ("gain", {"factor": -0.9, "offset": 0.123}),
    "slow": ("lag", {"time_constant": 1.3}, 0.2),
    "slower": ("lag", {"time_constant": 0.7}, 0.3),
    "clock": "clock",
    "meter": "meter",
    "gain": ("gain", {"u": 1.0}),
}
LINKS = [
    "plant.y -> law.u",
    "law.y -> plant.u",
    "plant.y -> slow.u",
    "slow.y -> slower.u",
    "clock.count -> meter.number",
    "clock.odd -> meter.flag",
    "clock.text -> meter.text",
    "push -> meter.real",
]
EVENTS = [
    {"time": 0.4, "override": {"law.y": 0.5, "push": 2.0}},
    {"time": 0.7, "bias": {"push": 1.5, "gain.u": 3.0}, "override": {"clock.odd": True}},
    {"time": 1.2, "reset": ["law.y"], "bias": {"plant.u": 0.25}},
    {"time": 1.6, "reset": ["push", "gain.u", "clock.odd", "plant.u"]},
]


@pytest.fixture
def system(make_system):
    """All types, slow components, a loop, an input from outside, one that only events change."""
    return make_system(PARTS, LINKS, {"push": ("input", "Real", "")})


@pytest.mark.parametrize("order", ["jacobi", "gauss-seidel"])
@pytest.mark.parametrize("until", [0.4, 0.7, 1.0])
def test_a_stored_run_goes_on_bit_for_bit(system, make_scenario, tmp_path, until, order):
    check_goes_on(system, make_scenario, tmp_path, until, order)  # at other times: at night


def check_goes_on(system, make_scenario, tmp_path, until, order):
    scenario, file = make_scenario(2.4, 0.1, events=EVENTS), tmp_path / "half.state"
    whole = simulate(system, scenario, RunOptions(order=order))
    first = simulate(system, scenario, RunOptions(order=order, until=until, store=file))
    assert_same(whole, first, simulate(system, scenario, RunOptions(order=order, resume=file)))


def test_a_run_may_be_stored_more_than_once_and_between_two_rows(system, make_scenario):
    scenario, stored = make_scenario(2.4, 0.1, events=EVENTS, output_interval=0.3), []
    whole = simulate(system, scenario)
    simulate(system, scenario, RunOptions(until=0.8, store=stored.append))
    simulate(system, scenario, RunOptions(until=1.4, resume=stored[0], store=stored.append))
    rest = simulate(system, scenario, RunOptions(resume=stored[1]))
    assert np.allclose(rest["time"], [1.5, 1.8, 2.1, 2.4])
    assert all(np.array_equal(rest[name], whole[name][5:]) for name in whole)


def test_what_a_file_holds_is_what_was_stored(system, make_scenario, tmp_path):
    stored, file = [], tmp_path / "half.state"
    simulate(
        system, make_scenario(2.4, 0.1, events=EVENTS), RunOptions(until=0.8, store=stored.append)
    )
    write_snapshot(stored[0], file)
    assert read_snapshot(file) == stored[0]
    assert (stored[0].time, stored[0].step) == (0.8, 8)
    large = replace(stored[0], outputs=dict.fromkeys(stored[0].outputs, -1.7e308))
    write_snapshot(large, file)
    assert read_snapshot(file) == large
    write_snapshot(stored[0], file)
    first = file.read_bytes()
    write_snapshot(read_snapshot(file), file)
    assert file.read_bytes() == first


def test_variations_fork_from_one_state(system, make_scenario):
    """The future may have other events; overrides in force stay; what lies before is not done again."""
    stored, base = (
        [],
        make_scenario(1.2, 0.1, events=[{"time": 0.2, "override": {"push": 2.0, "gain.u": 4.0}}]),
    )
    simulate(system, base, RunOptions(until=0.5, store=stored.append))
    for shift in (0.0, 1.0):
        events = [
            {"time": 0.1, "override": {"push": 99.0}},
            {"time": 0.8, "bias": {"plant.y": shift}},
        ]
        forked = simulate(
            system, make_scenario(1.8, 0.1, events=events), RunOptions(resume=stored[0])
        )
        assert np.all(forked["push"] == 2.0) and np.all(forked["gain.u"] == 4.0)
        jump = np.diff(forked["plant.y"].sel(time=[0.8, 0.9], method="nearest"))[0]
        assert abs(jump - shift) < 0.2


def test_a_table_feeds_the_rest_of_a_stored_run(system, make_scenario):
    from shipcosim.series import make_table

    times = np.linspace(0.0, 2.4, 49)
    table, scenario, stored = (
        make_table(times, [("push", np.sin(times), "", "")]),
        make_scenario(2.4, 0.1),
        [],
    )
    whole = simulate(system, scenario, RunOptions(inputs=table))
    first = simulate(system, scenario, RunOptions(inputs=table, until=0.9, store=stored.append))
    assert_same(
        whole, first, simulate(system, scenario, RunOptions(inputs=table, resume=stored[0]))
    )


def test_components_that_cannot_be_stored_are_named_before_the_run(pythonfmu_system, make_scenario):
    with pytest.raises(ShipcosimError) as error:
        simulate(pythonfmu_system("1.0"), make_scenario(), RunOptions(store=[].append))
    found = [
        (problem.where, "does not declare canGetAndSetFMUstate" in problem.found)
        for problem in error.value.problems
    ]
    assert found == [("stock", True), ("other", True)]


HIDDEN = """
from pythonfmu import Fmi2Slave, Fmi2Causality, Real


class Hidden(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.y = self.hidden = 0.0
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, t, h):
        self.hidden += h
        self.y = self.hidden
        return True
"""
OWN_STATE = """
    def _get_fmu_state(self):
        return {**super()._get_fmu_state(), "hidden": self.hidden}
"""


PART_OF_IT = """
    def _get_fmu_state(self):
        return super()._get_fmu_state()
"""


def test_a_state_that_leaves_something_out_is_not_stored(pythonfmu_code, make_scenario):
    options = {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True}
    system = pythonfmu_code(HIDDEN + PART_OF_IT, **options)
    taken = []
    for isolate in (False, True):
        with pytest.raises(RunError, match="its state is not complete") as error:
            how = RunOptions(until=0.5, store=taken.append, isolate=isolate)
            simulate(system, make_scenario(1.0, 0.1), how)
        assert error.value.table.sizes["time"] == 6 and not taken


@pytest.mark.parametrize("own", ["", OWN_STATE])
def test_what_pythonfmu_does_not_store_is_refused_or_stored_by_the_class(
    pythonfmu_code, make_scenario, own
):
    system = pythonfmu_code(HIDDEN + own, canGetAndSetFMUstate=True, canSerializeFMUstate=True)
    scenario, taken = make_scenario(1.0, 0.1), []
    options = RunOptions(until=0.5, store=taken.append)
    if not own:
        with pytest.raises(ShipcosimError, match="stores its registered variables alone"):
            simulate(system, scenario, options)
        return
    first = simulate(system, scenario, options)
    rest = simulate(system, scenario, RunOptions(resume=taken[0]))
    assert_same(simulate(system, scenario), first, rest)


@pytest.fixture
def stored(system, make_scenario) -> Snapshot:
    taken = []
    simulate(system, make_scenario(2.4, 0.1), RunOptions(until=0.5, store=taken.append))
    return taken[0]


def test_a_state_goes_on_only_in_the_system_that_it_is_of(
    system, stored, make_system, make_scenario
):
    def refused(other, scenario, said):
        with pytest.raises(ShipcosimError, match=said):
            simulate(other, scenario, RunOptions(resume=stored))

    scenario = make_scenario(2.4, 0.1)
    refused(
        with_values(system, {"law.factor": 3.0}),
        scenario,
        "law.factor was -0.9 and would now be 3.0.*An event",
    )
    refused(system, make_scenario(2.0, 0.05), "steps of 0.1 s, this one has 0.05 s")
    refused(system, make_scenario(0.5, 0.1), "would go from 0.5 s to 0.5 s")
    swapped = make_system(
        PARTS | {"gain": ("lag", {"u": 1.0})}, LINKS, {"push": ("input", "Real", "")}
    )
    refused(swapped, scenario, "gain: lag.fmu is another FMU than the one that was stored")
    refused(
        make_system({"plant": "integrator"}), scenario, "holds plant, law, .*; the system has plant"
    )


@pytest.mark.parametrize("start_time", [0.5, -1.0, "0.1 s"])
def test_a_run_that_continues_takes_no_other_start_time(system, stored, start_time):
    times = {"stop_time": 2.4, "step_size": 0.1, "resume": stored}
    with pytest.raises(ShipcosimError, match="start_time.*continues a run that started at 0 s"):
        sc.simulate(system, start_time=start_time, **times)
    sc.simulate(system, start_time=0.0, **times)


def test_what_is_no_snapshot_is_refused(stored, tmp_path):
    file = tmp_path / "half.state"
    write_snapshot(stored, file)
    whole = file.read_bytes()
    for content in (b"", b"text", whole[:-30], whole.replace(b"snapshot.json", b"snapshat.json")):
        file.write_bytes(content)
        with pytest.raises(ShipcosimError, match=r"half.state: is no snapshot of a run: .*--store"):
            read_snapshot(file)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(
            "snapshot.json", '{"schema": "shipcosim-snapshot/1", "components": [], "step": "x"}'
        )
    with pytest.raises(ShipcosimError, match="lacks or adds changes"):
        read_snapshot(file)
    with pytest.raises(ShipcosimError, match="absent.state: cannot be read: No such file"):
        read_snapshot(tmp_path / "absent.state")


def test_a_state_without_an_output_is_refused(system, stored, make_scenario):
    """The first row would show the value of the start."""
    outputs = {name: value for name, value in stored.outputs.items() if name != "plant.y"}
    with pytest.raises(ShipcosimError, match="snapshot at 0.5 s: it has no value of plant.y"):
        edited = replace(stored, outputs=outputs)
        simulate(system, make_scenario(2.4, 0.1), RunOptions(resume=edited))


@pytest.mark.parametrize("until", [0.0, 0.25, 3.0])
def test_a_run_cannot_end_just_anywhere(system, make_scenario, until):
    with pytest.raises(ShipcosimError, match="no whole number of steps|would go from 0 s to"):
        simulate(system, make_scenario(2.0, 0.1), RunOptions(until=until))


CONTINUE = """
import sys
from pathlib import Path
from shipcosim.cosim import RunOptions, simulate
from shipcosim.scenario import Scenario
from shipcosim.series import write_table
from shipcosim.ssp import read_system
folder, ssp, ssv, fmus = map(Path, sys.argv[1:])
scenario = Scenario.model_validate_json((folder / "scenario.json").read_text())
system = read_system(ssp, [ssv], fmus=[fmus])
write_table(simulate(system, scenario, RunOptions(resume=folder / "half.state")), folder / "rest.nc")
"""


def test_the_dp_ship_goes_on_in_another_process_bit_for_bit(root, built, tmp_path):
    """Noise, gusts, waves and events are on."""
    from shipcosim.series import read_table

    scenario = read_scenario(root / "scenarios" / "four_corner.toml")
    events = [
        Event(time=0.0, override={"reference.x_set": 20.0}),
        Event(time=4.05, bias={"vessel.tau_Y_4": 1e4}),
    ]
    events += [
        Event(
            time=9.0,
            override={"port.failed": True, "reference.y_set": -20.0},
            reset=["vessel.tau_Y_4"],
        )
    ]
    scenario = scenario.model_copy(
        update={"stop_time": 14.0, "output_interval": None, "events": events, "expect": []}
    )
    ssv = scenario.parameter_paths[0]
    system = read_system(scenario.system_path, [ssv], fmus=[built])
    whole = simulate(system, scenario)
    first = simulate(system, scenario, RunOptions(until=6.35, store=tmp_path / "half.state"))
    (tmp_path / "scenario.json").write_text(scenario.model_dump_json())
    files = map(str, (tmp_path, scenario.system_path, ssv, built))
    subprocess.run([sys.executable, "-c", CONTINUE, *files], check=True, timeout=600)
    assert_same(whole, first, read_table(tmp_path / "rest.nc"))
