"""The master against libcosim, the reference of the Open Simulation Platform: the same digits at every step."""

import shutil

import pytest

from shipcosim.cosim import simulate

libcosim = pytest.importorskip("libcosimpy.CosimExecution", reason="needs libcosim")


def libcosim_rows(folder, system, step_size, n_steps, scenario_file=None):
    """Real outputs after every step as libcosim has them: {signal: [value at h, 2 h, ...]}."""
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver

    execution = libcosim.CosimExecution.from_ssp_file(
        ssp_path=str(folder), step_size=round(step_size * 1e9)
    )
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    if scenario_file:
        manager = CosimManipulator.create_scenario_manager()
        assert execution.add_manipulator(manager) and execution.load_scenario(
            manager, str(scenario_file)
        )
    outputs = {
        name: [
            v
            for v in component.fmu.variables.values()
            if v.causality == "output" and v.kind == "Real"
        ]
        for name, component in system.components.items()
    }
    rows = {f"{name}.{v.name}": [] for name, variables in outputs.items() for v in variables}
    for _ in range(n_steps):
        assert execution.step()
        for name, variables in outputs.items():
            index = execution.slave_index_from_instance_name(name)
            values = observer.last_real_values(index, [v.value_reference for v in variables])
            for variable, value in zip(variables, values, strict=True):
                rows[f"{name}.{variable.name}"].append(value)
    return rows


LOOP = {
    "plant": ("integrator", {"y_start": 0.3}),
    "filter": ("lag", {"time_constant": 0.7, "y_start": -0.2}),
    "law": ("gain", {"factor": -0.9, "offset": 0.123}),
    "clock": "clock",
    "slow": ("lag", {"time_constant": 1.3}, 0.15),
}
CONNECTIONS = [
    "plant.y -> filter.u",
    'filter.y -> law.u | <ssc:LinearTransformation factor="1.7" offset="0.1"/>',
    "law.y -> plant.u",
    "filter.y -> slow.u",
]


@pytest.fixture
def packed(make_system, tmp_path):
    """A loop with a transformation, a slow component and one that shows the time, as libcosim and we read it."""
    system = make_system(LOOP, CONNECTIONS)
    for component in system.components.values():
        shutil.copy(component.fmu.path, tmp_path / "resources")
    return tmp_path, system


def assert_equal(table, rows, but=()):
    for signal, values in rows.items():
        if signal not in but:
            assert table[signal].values[1:].tolist() == values, signal


def test_jacobi_gives_libcosims_digits(packed, make_scenario):
    folder, system = packed
    table = simulate(system, make_scenario(15.0, 0.05))
    rows = libcosim_rows(folder, system, 0.05, 300)
    assert_equal(table, rows, but={"slow.y"})
    assert table["slow.y"].values[3::3].tolist() == rows["slow.y"][2::3]


def test_events_act_as_in_an_osp_scenario(packed, make_scenario):
    folder, system = packed
    file = folder / "events.json"
    events = [
        (0.1, "law", "u", "override", 2.5),
        (0.2, "law", "u", "bias", -0.25),
        (0.3, "law", "u", "reset", None),
        (0.4, "plant", "y", "override", 1.5),
        (0.5, "plant", "y", "bias", 0.125),
        (0.6, "plant", "y", "reset", None),
        (0.7, "law", "factor", "override", -0.4),
    ]
    listed = ", ".join(
        f'{{"model": "{m}", "variable": "{v}", "action": "{a}", "time": {t}{"" if x is None else f", #value#: {x}"}}}'
        for t, m, v, a, x in events
    )
    file.write_text(
        f'{{"description": "test", "events": [{listed}], "end": 100.0}}'.replace("#", '"')
    )
    ours = [
        {"time": t, a: [f"{m}.{v}"] if a == "reset" else {f"{m}.{v}": x}}
        for t, m, v, a, x in events
    ]
    table = simulate(system, make_scenario(1.2, 0.05, events=ours))
    assert_equal(table, libcosim_rows(folder, system, 0.05, 24, file), but={"slow.y"})
    quiet = simulate(system, make_scenario(1.2, 0.05))
    assert abs(table["filter.y"] - quiet["filter.y"]).max() > 0.05
