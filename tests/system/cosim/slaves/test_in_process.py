"""FMUs of our shell are called without their C interface, and nobody can tell from the results."""

import json

import numpy as np
import pytest

from shipcosim.cosim import RunError, simulate
from shipcosim.cosim.slaves import library_slave
from shipcosim.cosim.slaves.instances import Instances


@pytest.fixture
def through_binary(monkeypatch):
    """Function that has all calls go through the binaries from then on."""
    return lambda: monkeypatch.setattr(library_slave, "python_object_of", lambda folder, name: None)


PARTS = {
    "plant": ("integrator", {"y_start": 0.3}),
    "law": ("gain", {"factor": -0.9}),
    "other": ("gain", {"factor": 2.5}),
    "clock": "clock",
    "meter": "meter",
}
CONNECTIONS = [
    "plant.y -> law.u",
    "law.y -> plant.u",
    "plant.y -> other.u",
    "clock.odd -> meter.flag",
    "clock.count -> meter.number",
    "clock.text -> meter.text",
]


def test_same_digits_as_through_the_binary(make_system, make_scenario, through_binary):
    system = make_system(PARTS, CONNECTIONS)
    scenario = make_scenario(5.0, 0.05, events=[{"time": 1.0, "override": {"law.u": 2.0}}])
    direct = simulate(system, scenario)
    through_binary()
    other = simulate(system, scenario)
    for name, column in direct.data_vars.items():
        np.testing.assert_array_equal(column.values, other[name].values, err_msg=name)
    assert direct.attrs == other.attrs


@pytest.mark.parametrize("how", ["raise", "start"])
def test_same_words_of_a_failure(make_system, make_scenario, through_binary, how):
    system, said = make_system({"failing": ("failing", {"how": how})}), []
    for prepare in (lambda: None, through_binary):
        prepare()
        with pytest.raises(RunError) as caught:
            simulate(system, make_scenario())
        said.append(str(caught.value))
    direct, binary = said
    assert "50%s of" in direct and "50%s of" in binary
    assert direct.splitlines()[0] == binary.splitlines()[0]


def test_same_remarks(make_system, make_scenario, through_binary):
    system = make_system({"failing": ("failing", {"how": "warn"})})
    direct = json.loads(simulate(system, make_scenario()).attrs["remarks"])
    through_binary()
    assert direct == json.loads(simulate(system, make_scenario()).attrs["remarks"])
    assert any("100% full" in text for text in direct)


def test_components_of_one_fmu_have_an_object_each(make_system):
    system = make_system({name: "gain" for name in ("a", "b")})
    with Instances() as instances:
        slaves = [instances.instance_of(component) for component in system.components.values()]
        targets = [slave.python_object for slave in slaves]
        assert [target.instance_name for target in targets] == ["a", "b"]
        again = instances.instance_of(system.components["a"])
        again.enter_initialisation(0.0, 1.0)
        variable = system.components["a"].fmu.variables["factor"]
        buffer = np.array([7.0])
        again.check("SetReal", again._exchange("Set", "Real", [variable], buffer)())
        assert again.python_object.factor == 7.0


def test_other_python_fmus_go_through_their_binary(pythonfmu_system):
    system = pythonfmu_system("1.0")
    with Instances() as instances:
        assert all(
            instances.instance_of(component)._direct is None
            for component in system.components.values()
        )
