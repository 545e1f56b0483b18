"""An exported system runs in libcosim from its own files, and has our digits."""

import shutil
from dataclasses import replace

import pytest
from osp_execution import assert_same, rows_of

from shipcosim.cosim import simulate
from shipcosim.cosim.export.osp import osp_files, write_osp
from shipcosim.errors import ShipcosimError
from shipcosim.ssp import read_system

pytest.importorskip("libcosimpy.CosimExecution", reason="needs libcosim")

PARTS = {
    "plant": ("integrator", {"y_start": 0.1 + 0.2}),
    "filter": ("lag", {"time_constant": 0.7, "y_start": -1e-17}),
    "law": ("gain", {"factor": -0.9, "offset": 1 / 3}),
    "clock": "clock",
    "meter": (
        "meter",
        {"number": 3, "text": "two words, &lt;&amp;&gt; &quot;quoted&quot;&#10;&#9;tabbed"},
    ),
    "slow": ("lag", {"time_constant": 1.3}, 0.15),
    "free": "gain",
    "lot": ("shaft", {"angle": 12.5}),
}
CONNECTIONS = [
    "plant.y -> filter.u",
    'filter.y -> law.u | <ssc:LinearTransformation factor="1.7" offset="0.1"/>',
    "law.y -> plant.u",
    "filter.y -> slow.u",
    "clock.odd -> meter.flag",
    "set -> free.u",
    "plant.y -> shown",
]
CONNECTORS = {"set": ("input", "Real", ""), "shown": ("output", "Real", "")}
EVENTS = [
    {"time": 0.1, "override": {"law.u": 2.5, "set": 0.7}},
    {"time": 0.2, "bias": {"law.u": -0.25, "free.u": 0.1}},
    {"time": 0.3, "reset": ["law.u", "set"]},
    {"time": 0.4, "override": {"plant.y": 1.5, "meter.number": 9, "meter.flag": True}},
    {"time": 0.5, "bias": {"plant.y": 0.125, "meter.real": 0.25}},
    {"time": 0.6, "reset": ["plant.y", "meter.number", "meter.real", "free.u", "meter.flag"]},
    {"time": 0.7, "override": {"law.factor": -0.4}},
    {"time": 0.9, "reset": ["law.factor"]},
]


def test_all_kinds_of_events_transformations_and_values_run_as_here(
    make_system, make_scenario, tmp_path
):
    system = make_system(PARTS, CONNECTIONS, CONNECTORS)
    scenario = make_scenario(1.2, 0.05, events=EVENTS, set={"set": 0.4, "lot.speed": 3.0})
    remarks = write_osp(system, scenario, tmp_path / "out")
    assert (
        "inputs of the system: set" in remarks[0].found
        and "outputs of the system: shown" in remarks[1].found
    )
    table = simulate(system, scenario)
    rows = rows_of(tmp_path / "out", system, 24, tmp_path / "out" / "scenario.json")
    slow = rows.pop("slow.y")
    assert_same(table, rows)
    assert table["slow.y"].values[3::3].tolist() == slow[2::3]
    quiet = simulate(system, make_scenario(1.2, 0.05))
    assert abs(table["filter.y"] - quiet["filter.y"]).max() > 0.05


def test_what_is_exported_is_read_back_as_the_same_system(make_system, make_scenario, tmp_path):
    system = make_system(PARTS, CONNECTIONS[:5])
    write_osp(system, make_scenario(1.2, 0.05), tmp_path / "out")
    again = read_system(tmp_path / "out")
    assert {name: part.start for name, part in again.components.items()} == {
        name: part.start for name, part in system.components.items()
    }
    plain = [
        {(c.source, c.target, c.factor, c.offset) for c in one.connections}
        for one in (system, again)
    ]
    assert plain[0] == plain[1]
    assert (again.experiment.stop_time, again.experiment.step_size) == (1.2, 0.05)
    assert not (tmp_path / "out" / "scenario.json").exists()


@pytest.mark.parametrize(
    ("parts", "connections", "message"),
    [
        ({"a": "clock", "b": "meter"}, ["a.count -> b.real"], "it goes from Integer to Real"),
        (
            {"a": "clock", "b": "meter"},
            ["a.text -> b.text", "a.odd -> b.number"],
            "a.odd is Boolean",
        ),
    ],
)
def test_what_osp_cannot_say_is_refused(make_system, make_scenario, parts, connections, message):
    with pytest.raises(ShipcosimError) as error:
        osp_files(make_system(parts, connections), make_scenario(1.0, 0.1))
    assert message in str(error.value)


def test_fmus_of_one_name_get_names_of_their_own(make_system, make_scenario, fmus, tmp_path):
    system = make_system({"a": "gain", "b": "lag", "c": "integrator"})
    places = {"a": "one/x.fmu", "b": "two/x.fmu", "c": "one/x_2.fmu"}
    components = {}
    for name, place in places.items():
        component, target = system.components[name], tmp_path / place
        target.parent.mkdir(exist_ok=True)
        shutil.copy(component.fmu.path, target)
        components[name] = replace(component, fmu=replace(component.fmu, path=target))
    write_osp(replace(system, components=components), make_scenario(), tmp_path / "out")
    again = read_system(tmp_path / "out")
    assert {n: c.fmu.model_name for n, c in again.components.items()} == {
        n: c.fmu.model_name for n, c in system.components.items()
    }
