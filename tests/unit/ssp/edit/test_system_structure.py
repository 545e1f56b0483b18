"""Changes of a system arrive where they should, and wrong ones are refused at once and leave nothing behind."""

import pickle

import pytest

from shipcosim.errors import ShipcosimError
from shipcosim.ssp import check_system, new, read, read_system, write_ssv
from shipcosim.ssp.edit.write import parameter

ITEMS = '<Item name="off" value="1"/><Item name="on" value="2"/>'
TYPES = f'<SimpleType name="Mode"><Enumeration>{ITEMS}</Enumeration></SimpleType>'


@pytest.fixture
def plant(shop):
    """A hull with a thruster, a set in a file and one inline."""
    shop.fmu(
        "hull",
        "input force Real m",
        "input speed Real m/s",
        "output x Real m",
        "parameter mass Real km min=0",
        "parameter seed Integer",
        "parameter mode Enumeration declaredType=Mode",
        types=TYPES,
    )
    shop.fmu(
        "thruster",
        "input cmd Real deg",
        "output thrust Real m",
        "output temperature Real K",
        "parameter gain Real",
    )
    elements = shop.component("hull", "hull", "input force", "output x")
    elements += shop.component("thruster", "thruster", "output thrust")
    write_ssv(
        shop.folder / "resources/ship.ssv",
        "ship",
        [parameter("hull.mass", 2000.0, "m", "a guess", tolerance=5.0)],
    )
    binding = '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/ship.ssv"/></ssd:ParameterBindings>'
    shop.ssd(elements, shop.connection("thruster.thrust", "hull.force"), head=binding)
    return shop


@pytest.fixture
def system(plant):
    return read(plant.folder)


def refused(action, *arguments, **keywords):
    with pytest.raises(ShipcosimError) as caught:
        action(*arguments, **keywords)
    return str(caught.value)


def written(system, tmp_path):
    """The system that a fresh reader finds after writing, and the text of its SSD."""
    system.write(tmp_path / "written")
    ssd = (tmp_path / "written/SystemStructure.ssd").read_text(encoding="utf-8")
    return read_system(tmp_path / "written"), ssd


def test_looking_at_a_system(system):
    assert repr(system) == "<SystemStructure 'test': 2 components, 1 connections>"
    assert system.elements == ["hull", "thruster"]
    assert system.connections == [("thruster.thrust", "hull.force")]
    assert system.connectors("hull") == {"force": "input", "x": "output"}
    assert system.components["hull"].fmu.variables["mass"].unit == "km"
    assert dict(system.parameters) == {"hull.mass": 2.0}


def test_a_graph_has_every_component_and_the_inputs_that_each_feeds(system):
    system.add_connector("order", "input", unit="deg")
    system.connect("order", "thruster.cmd")
    assert system.to_dot().splitlines() == [
        "digraph {",
        "  node [shape=box];",
        '  "hull";',
        '  "thruster";',
        '  "thruster" -> "hull" [label="force"];',
        '  "test" -> "thruster" [label="cmd"];',
        "}",
    ]


def test_reading_what_is_no_system_is_refused(shop, tmp_path):
    (tmp_path / "x.ssd").write_text('<?xml version="1.0"?>\n<a/>')
    assert "Its outermost element is <a>." in refused(read, tmp_path / "x.ssd")
    assert "There is no such file or folder." in refused(read, tmp_path / "y.ssp")


# parameters


def test_a_value_is_changed_where_it_stands_in_the_fmus_unit(system, tmp_path):
    system.parameters["hull.mass"] = 3
    after, ssd = written(system, tmp_path)
    assert after.components["hull"].start == {"mass": 3.0}
    assert "ssv:ParameterSet" not in ssd
    text = (tmp_path / "written/resources/ship.ssv").read_text(encoding="utf-8")
    assert '<ssv:Real value="3.0" unit="km"/>' in text
    assert "a guess" not in text and "tolerance" not in text  # they were the old value's


def test_the_files_that_were_read_stay_as_they_are(system, plant):
    before = (plant.folder / "resources/ship.ssv").read_bytes()
    system.parameters["hull.mass"] = 3.0
    assert (plant.folder / "resources/ship.ssv").read_bytes() == before


def test_a_new_value_goes_to_its_components_own_set(system, tmp_path):
    system.parameters["thruster.gain"] = 2.0
    system.parameters["hull.seed"] = 5
    system.parameters["hull.mode"] = 2
    after, ssd = written(system, tmp_path)
    assert after.components["thruster"].start == {"gain": 2.0}
    assert after.components["hull"].start == {"mass": 2.0, "seed": 5, "mode": 2}
    assert '<ssv:Enumeration value="on"/>' in ssd
    assert ssd.count("<ssv:ParameterSet ") == 2


def test_several_values_at_once_end_as_one_by_one_or_none_of_them(system, tmp_path):
    values = {"thruster.gain": 2.0, "hull.seed": 5, "hull.mode": 2, "hull.mass": 3}
    one_by_one = system.copy()
    for name, value in values.items():
        one_by_one.parameters[name] = value
    system.parameters.update(values)
    assert written(system, tmp_path / "a")[1] == written(one_by_one, tmp_path / "b")[1]
    assert dict(system.parameters) == dict(one_by_one.parameters)
    wrong = {"hull.mass": 4.0, "hull.sed": 1}
    assert "no variable 'sed'" in refused(system.parameters.update, wrong)
    assert system.parameters["hull.mass"] == 3.0


def test_a_value_with_a_unit_is_converted_and_keeps_what_is_said_of_it(system, tmp_path):
    system.set("hull.mass", 5e3, "m", description="weighed", tolerance=0.1)
    assert system.parameters["hull.mass"] == 5.0
    written(system, tmp_path)
    text = (tmp_path / "written/resources/ship.ssv").read_text(encoding="utf-8")
    assert 'description="weighed"' in text and '<tolerance value="0.1"/>' in text


def test_a_set_that_is_bound_twice_is_not_changed(plant):
    elements = plant.component("one", "hull") + plant.component("two", "hull")
    prefixed = "".join(
        f'<ssd:ParameterBinding source="resources/hull.ssv" prefix="{name}."/>'
        for name in ("one", "two")
    )
    write_ssv(plant.folder / "resources/hull.ssv", "hull", [parameter("mass", 1.0, "km")])
    plant.ssd(elements, head=f"<ssd:ParameterBindings>{prefixed}</ssd:ParameterBindings>")
    system = read(plant.folder)
    system.parameters["one.mass"] = 7.0
    assert dict(system.parameters) == {"one.mass": 7.0, "two.mass": 1.0}


def test_a_value_that_a_mapping_sets_is_overridden(plant):
    plant.ssm('<ssm:MappingEntry source="hull.mass" target="hull.mass"/>')
    mapping = '<ssd:ParameterMapping source="resources/names.ssm"/>'
    binding = f'<ssd:ParameterBinding source="resources/ship.ssv">{mapping}</ssd:ParameterBinding>'
    plant.ssd(
        plant.component("hull", "hull"),
        head=f"<ssd:ParameterBindings>{binding}</ssd:ParameterBindings>",
    )
    system = read(plant.folder)
    assert system.parameters["hull.mass"] == 2.0
    system.parameters["hull.mass"] = 9.0
    assert system.checked().components["hull"].start == {"mass": 9.0}


def test_a_systems_input_has_a_start_value(system):
    system.add_connector("course", "input", unit="deg")
    system.connect("course", "thruster.cmd")
    system.parameters["course"] = 90.0
    assert system.checked().inputs["course"].start == 90.0
    assert "course" in system.parameters


def test_without_a_value_the_fmus_holds_again(system):
    del system.parameters["hull.mass"]
    assert system.parameters["hull.mass"] == 0.0  # the FMU's
    assert "hull.mass" not in system.parameters
    assert "hull.seed: The system does not set it." in refused(
        system.parameters.__delitem__, "hull.seed"
    )


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "hull.mas",
            1.0,
            "hull has no variable 'mas'. It has: force, mass, mode, seed, speed, x. Did you mean 'mass'?",
        ),
        (
            "hul.mass",
            1.0,
            "There is no component or connector 'hul'. There is: hull, thruster. Did you mean 'hull'?",
        ),
        ("hull.mass", -1.0, "hull.mass cannot be -1 km. Allowed: at least 0 km."),
        ("hull.mass", True, "the value is Boolean, hull.mass is Real."),
        ("hull.mass", float("nan"), "nan is not a finite number."),
        ("hull.mass", [1.0], "[1.0] is no value."),
        ("hull.seed", 1.5, "the value is Real, hull.seed is Integer."),
        (
            "hull.mode",
            "onn",
            "The enumeration has no item 'onn'. It has: off, on. Did you mean 'on'?",
        ),
        ("hull.x", 1.0, "hull.x is of causality output, a value that the FMU calculates."),
    ],
)
def test_values_that_do_not_fit_are_refused_at_once(system, name, value, message):
    assert message in refused(system.parameters.__setitem__, name, value)
    assert dict(system.parameters) == {"hull.mass": 2.0}


def test_a_unit_of_another_quantity_is_refused(system):
    assert "A value in s, but hull.mass is in km." in refused(system.set, "hull.mass", 1.0, "s")


def test_sets_are_bound_and_unbound(system, plant, tmp_path):
    write_ssv(tmp_path / "light.ssv", "light", [parameter("hull.mass", 1.0, "km")])
    system.bind(tmp_path / "light.ssv")
    assert system.parameters["hull.mass"] == 1.0
    system.unbind("resources/ship.ssv")
    after, _ = written(system, tmp_path)
    assert after.components["hull"].start == {"mass": 1.0}
    message = refused(system.unbind, "resources/lihgt.ssv")
    assert (
        "It is not bound there. There is: resources/light.ssv. Did you mean 'resources/light.ssv'?"
        in message
    )
    assert "There is no such file" in refused(system.bind, "nowhere.ssv")


# components and connections


def test_a_component_gets_its_connectors_and_units_from_the_fmu(system, plant, tmp_path):
    system.add_component("hull_2", plant.folder / "resources/hull.fmu", step_size=0.2)
    after, ssd = written(system, tmp_path)
    assert system.connectors("hull_2") == {"force": "input", "speed": "input", "x": "output"}
    assert after.components["hull_2"].step_size == 0.2
    block = ssd[ssd.index('name="hull_2"') :]
    assert 'source="resources/hull.fmu"' in ssd and '<ssc:Real unit="m/s"/>' in block
    assert '<ssc:Unit name="m/s">\n      <ssc:BaseUnit m="1" s="-1"/>' in block


def test_an_enumeration_comes_along_with_its_items(system, plant, tmp_path):
    system.add_component("hull_2", plant.folder / "resources/hull.fmu", kinds=("parameter",))
    _, ssd = written(system, tmp_path)
    assert '<ssc:Enumeration name="mode"/>' in ssd and '<ssc:Item name="on" value="2"/>' in ssd


def test_a_unit_that_means_something_else_in_the_ssd_is_left_to_the_fmu(plant, tmp_path):
    odd = '<ssd:Units><ssc:Unit name="m"><ssc:BaseUnit s="1"/></ssc:Unit></ssd:Units>'
    plant.ssd(plant.component("hull", "hull"), rest=odd)
    system = read(plant.folder)
    system.add_component("other", plant.folder / "resources/thruster.fmu")
    system.connect("other.thrust", "hull.force")
    assert system.checked().connections[0].factor == 1.0


def test_fmus_of_one_name_and_different_content_live_side_by_side(system, tmp_path, shop):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (folder / "resources").mkdir()
    other = type(shop)
    workshop = other.__new__(other)
    workshop.folder = folder
    fmu = workshop.fmu("hull", "input only Real m")
    system.add_component("other", fmu)
    after, _ = written(system, tmp_path)
    assert after.components["other"].fmu.path.name == "hull_2.fmu"
    assert list(after.components["other"].fmu.variables) == ["only"]
    assert "mass" in after.components["hull"].fmu.variables


def test_an_fmu_is_packed_once_for_all_its_components(system, plant, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    fmu = (plant.folder / "resources/hull.fmu").rename(tmp_path / "elsewhere/boat.fmu")
    with system.changes():
        system.remove("hull")
        system.add_component("one", fmu)
        system.add_component("two", fmu)
    after, _ = written(system, tmp_path)
    assert {part.fmu.path.name for part in after.components.values()} == {
        "boat.fmu",
        "thruster.fmu",
    }
    fmu.unlink()
    assert "The file 'resources/boat.fmu' does not exist." in refused(system.checked)


def test_what_runs_can_go_to_another_process(system):
    checked = system.checked()
    assert pickle.loads(pickle.dumps(checked)) == checked


def test_a_connection_declares_what_it_needs_and_starts_at_its_source(system, tmp_path):
    system.connect("hull.speed", "thruster.temperature", suppress_unit_conversion=True)
    after, ssd = written(system, tmp_path)
    assert (after.connections[-1].source, after.connections[-1].target) == (
        ("thruster", "temperature"),
        ("hull", "speed"),
    )
    assert '<ssd:Connector name="speed" kind="input">' in ssd
    assert 'startElement="thruster" startConnector="temperature"' in ssd


def test_a_transformation_comes_after_the_conversion_of_units(system):
    system.connect("hull.x", "thruster.cmd", suppress_unit_conversion=True, factor=2.0, offset=1.0)
    assert (system.checked().connections[-1].factor, system.checked().connections[-1].offset) == (
        2.0,
        1.0,
    )


@pytest.mark.parametrize(
    ("source", "target", "message"),
    [
        (
            "thruster.thrst",
            "hull.speed",
            "thruster has no output 'thrst'. It has: temperature, thrust.",
        ),
        (
            "truster.thrust",
            "hull.speed",
            "There is no element 'truster' in test. There is: hull, thruster.",
        ),
        (
            "thruster.thrust",
            "hull.force",
            "A second connection into hull.force. It gets thruster.thrust already",
        ),
        (
            "thruster.temperature",
            "hull.speed",
            "thruster.temperature is in K, hull.speed in m/s; these cannot be",
        ),
        ("thruster.thrust", "hull.x", "both give a value, and neither takes one."),
        (
            "thruster.thrust",
            "hull.seed",
            "thruster.thrust (output) cannot feed hull.seed (parameter).",
        ),
    ],
)
def test_connections_that_make_no_sense_are_refused_at_once(system, source, target, message):
    assert message in refused(system.connect, source, target)
    assert system.connections == [("thruster.thrust", "hull.force")]
    assert system.connectors("hull") == {
        "force": "input",
        "x": "output",
    }  # nothing is left of the try


def test_disconnected_in_either_order_or_all_of_one(system):
    system.connect("hull.x", "hull.speed", suppress_unit_conversion=True)
    assert len(system.connections) == 2
    system.disconnect("hull.force", "thruster.thrust")
    assert system.connections == [("hull.x", "hull.speed")]
    system.disconnect("hull.x")
    assert system.connections == []
    message = refused(system.disconnect, "hull.x", "hull.force")
    assert "hull.x -> hull.force: There is no such connection." in message


def test_what_is_removed_takes_its_connections_values_and_fmu_along(system, tmp_path):
    system.parameters["thruster.gain"] = 2.0
    system.remove("hull")
    after, ssd = written(system, tmp_path)
    assert (
        list(after.components) == ["thruster"]
        and after.connections == ()
        and "<ssd:Connections" not in ssd
    )
    assert dict(system.parameters) == {"thruster.gain": 2.0}
    assert not (tmp_path / "written/resources/hull.fmu").exists()
    assert "hull.mass" not in (tmp_path / "written/resources/ship.ssv").read_text(encoding="utf-8")
    found = check_system(tmp_path / "written")
    assert found and not any("hull" in problem.found for problem in found)


def test_connections_and_values_follow_a_new_name(system, tmp_path):
    system.rename("hull", "ship")
    after, _ = written(system, tmp_path)
    assert after.components["ship"].start == {"mass": 2.0}
    assert system.connections == [("thruster.thrust", "ship.force")]
    assert "The name is taken." in refused(system.rename, "ship", "thruster")
    assert "There is no such element or connector." in refused(system.rename, "hull", "x")
    assert "It is named by the FMU." in refused(system.rename, "ship.force", "f")


def test_a_prefix_and_a_mapping_follow_a_new_name(plant, real):
    plant.ssv(real("mass", "1", "km"))
    plant.ssm('<ssm:MappingEntry source="hull.mass" target="hull.mass"/>')
    mapping = '<ssd:ParameterMapping source="resources/names.ssm"/>'
    first = f'<ssd:ParameterBinding source="resources/ship.ssv">{mapping}</ssd:ParameterBinding>'
    second = '<ssd:ParameterBinding source="resources/numbers.ssv" prefix="hull."/>'
    for bindings, value in ((first, 2.0), (second, 1.0)):
        plant.ssd(
            plant.component("hull", "hull"),
            head=f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>",
        )
        system = read(plant.folder)
        system.rename("hull", "ship")
        assert system.checked().components["ship"].start == {"mass": value}
        system.remove("ship")
        assert system.checked().components == {}


# nested systems, several changes as one, the experiment


def test_a_nested_system_is_built_connected_renamed_and_removed(system, plant, tmp_path):
    system.add_system("inner")
    system.add_component("inner.hull", plant.folder / "resources/hull.fmu")
    system.add_connector("inner.push", "input", unit="m")
    system.add_connector("inner.way", "output", unit="km")
    system.connect("inner.push", "inner.hull.force")
    system.connect("inner.hull.x", "inner.way")
    system.disconnect("thruster.thrust", "hull.force")
    system.connect("thruster.thrust", "inner.push")
    system.connect("inner.way", "hull.force")
    system.parameters["inner.hull.mass"] = 4.0
    after, _ = written(system, tmp_path)
    assert [(c.source, c.target, c.factor) for c in after.connections] == [
        (("inner.hull", "x"), ("hull", "force"), 1.0),
        (("thruster", "thrust"), ("inner.hull", "force"), 1.0),
    ]
    assert after.components["inner.hull"].start == {"mass": 4.0}
    assert "is in another system than the other end" in refused(
        system.connect, "hull.x", "inner.hull.speed"
    )
    system.rename("inner.push", "shove")
    system.rename("inner", "core")
    assert ("thruster.thrust", "core.shove") in system.connections
    assert ("core.shove", "core.hull.force") in system.connections
    assert system.parameters["core.hull.mass"] == 4.0
    system.remove("core.way")
    assert ("core.way", "hull.force") not in system.connections
    system.remove("core")
    assert system.elements == ["hull", "thruster"] and system.connections == []
    assert "There is no system 'core' to put it into." in refused(system.add_system, "core.again")


def test_names_with_dots_are_understood(shop):
    shop.fmu("part", "output body.x Real m", "input body.u Real m")
    shop.ssd(shop.component("a.b", "part", "output body.x") + shop.component("c", "part"))
    system = read(shop.folder)
    system.connect("a.b.body.x", "c.body.u")
    assert system.checked().connections[0].source == ("a.b", "body.x")


def test_several_changes_are_taken_as_one(system, plant):
    with system.changes():
        system.connect(
            "hull.x", "hull.force", suppress_unit_conversion=True
        )  # a second one, for the moment
        system.disconnect("thruster.thrust")
    assert system.connections == [("hull.x", "hull.force")]


def test_all_of_several_changes_are_undone_if_one_is_wrong(system, plant):
    with pytest.raises(ShipcosimError), system.changes():
        system.parameters["hull.mass"] = 8.0
        system.add_component("more", plant.folder / "resources/hull.fmu")
        system.connect("thruster.thrust", "hull.force")
    assert system.elements == ["hull", "thruster"] and system.parameters["hull.mass"] == 2.0


def test_a_system_with_faults_can_be_read_and_repaired(plant):
    plant.ssd(
        plant.component("hull", "hull", "input force", "input nothing"),
        plant.connection("gone.y", "hull.force"),
    )
    system = read(plant.folder)
    assert len([problem for problem in system.check() if problem.severity == "error"]) == 2
    assert "hull.fmu has no input 'nothing'" in refused(system.write, plant.folder / "x.ssp")
    system.parameters["hull.mass"] = 3.0  # does not make it worse
    system.disconnect("gone.y")
    system.remove("hull.nothing")
    assert system.checked().components["hull"].start == {"mass": 3.0}


def test_times_are_written_and_the_step_for_everybody_who_states_one(plant, tmp_path):
    other = '<ssc:Annotation type="oms"><FixedStepMaster stepSize="0.5"/></ssc:Annotation>'
    experiment = f'<ssd:DefaultExperiment stopTime="9"><ssd:Annotations>{other}</ssd:Annotations></ssd:DefaultExperiment>'
    plant.ssd(plant.component("hull", "hull"), rest=experiment)
    system = read(plant.folder)
    assert (system.start_time, system.stop_time, system.step_size) == (0.0, 9.0, 0.5)
    system.start_time, system.stop_time, system.step_size = 1.0, 12.0, 0.25
    after, ssd = written(system, tmp_path)
    assert (
        after.experiment.start_time,
        after.experiment.stop_time,
        after.experiment.step_size,
    ) == (1.0, 12.0, 0.25)
    assert 'stepSize="0.25"' in ssd and '<osp:FixedStepAlgorithm baseStepSize="0.25"/>' in ssd
    assert "must be positive" in refused(setattr, system, "step_size", -0.1)


def test_a_copy_is_changed_independently(system):
    twin = system.copy()
    twin.parameters["hull.mass"] = 7.0
    twin.remove("thruster")
    assert system.parameters["hull.mass"] == 2.0 and system.elements == ["hull", "thruster"]
    assert twin.checked().components["hull"].start == {"mass": 7.0}


def test_an_empty_system_is_a_system(tmp_path):
    system = new("nothing")
    system.write(tmp_path / "nothing.ssp")
    assert read(tmp_path / "nothing.ssp").elements == []
