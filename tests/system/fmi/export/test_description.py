import math
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description

from shipcosim.fmi import Fmu, Input, Output, Parameter
from shipcosim.fmi.export.description import model_description

SCRIPT = '''
from dataclasses import dataclass

from shipcosim.fmi import Fmu, Input, Output, Parameter, Parameters
from shipcosim.models.core.parameters import quantity


@dataclass(frozen=True)
class Hull:
    drag: float = quantity(3.5, "N.s2/m2", "drag", "table 4", tolerance=0.5, minimum=0.0, maximum=9.0)
    inertia: float = quantity(1e6, "kg.m2", "inertia", "assumed")


class Every(Fmu):
    """All that can be described.

    The second paragraph is not for the description.
    """

    rpm = Input("rpm", "shaft speed", minimum=-200.0, maximum=200.0)
    angle = Input("deg", "angle", start=30.0)
    ready = Input("1", "ready & <willing>", start=True)
    heading = Output("rad", "heading")
    ratio = Output("1", "ratio")
    count = Output("1", "count", start=3)
    seed = Parameter(1, "1", "seed", minimum=0)
    table = Parameter("0 1; 2 3", "1", "table")
    gain = Parameter(1.0, "1", "gain", tunable=True)
    hull = Parameters(Hull)

    def step(self, t, h):
        pass
'''


@pytest.fixture
def described(build):
    path = build("every", SCRIPT)
    description = read_model_description(
        str(path), validate_variable_names=True, validate_model_structure=True
    )
    return description, {variable.name: variable for variable in description.modelVariables}


def test_variables_carry_unit_bounds_start_and_meaning(described):
    _, variables = described
    rpm, drag, seed = variables["rpm"], variables["drag"], variables["seed"]
    assert (rpm.unit, rpm.min, rpm.max, rpm.start, rpm.causality) == (
        "rpm",
        "-200.0",
        "200.0",
        "0.0",
        "input",
    )
    assert (drag.unit, drag.min, drag.max, drag.start) == ("N.s2/m2", "0.0", "9.0", "3.5")
    assert drag.description == "drag (table 4)"
    assert (seed.type, seed.min, seed.start, seed.variability, seed.initial) == (
        "Integer",
        "0",
        "1",
        "fixed",
        "exact",
    )
    assert variables["gain"].variability == "tunable"
    assert (
        variables["ready"].start == "true" and variables["ready"].description == "ready & <willing>"
    )
    assert variables["table"].start == "0 1; 2 3"
    assert (
        variables["heading"].declaredType.name == "Angle"
        and variables["heading"].displayUnit == "deg"
    )


def test_units_are_defined_by_base_units_with_factor(described):
    units = {unit.name: unit for unit in described[0].unitDefinitions}
    assert set(units) == {"rpm", "deg", "rad", "1", "N.s2/m2", "kg.m2"}
    base = units["N.s2/m2"].baseUnit
    assert (base.kg, base.m, base.s, base.rad, base.factor) == (1, -1, 0, 0, 1.0)
    assert (units["kg.m2"].baseUnit.kg, units["kg.m2"].baseUnit.m) == (1, 2)
    rpm = units["rpm"].baseUnit
    assert (rpm.s, rpm.rad) == (-1, 1) and rpm.factor == pytest.approx(2 * math.pi / 60)
    assert units["deg"].baseUnit.factor == pytest.approx(math.pi / 180)
    assert units["rad"].displayUnits[0].name == "deg"


def test_structure_lists_every_output_twice(described):
    description, _ = described
    outputs = ["heading", "ratio", "count"]
    assert [unknown.variable.name for unknown in description.outputs] == outputs
    assert [unknown.variable.name for unknown in description.initialUnknowns] == outputs
    assert all(
        unknown.dependencies == [] for unknown in description.outputs
    )  # none follows an input before a step


def test_the_head_says_what_the_fmu_is_and_can(described):
    description, _ = described
    assert description.description == "All that can be described."
    assert (
        description.generationTool.startswith("shipcosim")
        and description.generationDateAndTime is None
    )
    assert (description.license, description.author) == ("MIT", "shipcosim") and description.version
    assert float(description.defaultExperiment.stepSize) == 0.05
    abilities = description.coSimulation
    assert abilities.canGetAndSetFMUstate and abilities.canSerializeFMUstate
    assert (
        abilities.canHandleVariableCommunicationStepSize
        and not abilities.canBeInstantiatedOnlyOncePerProcess
    )


def test_tolerance_is_kept_as_annotation():
    class One(Fmu):
        """One."""

        out = Output("1", "out")
        mass = Parameter(1.0, "kg", "mass", tolerance=0.25)

    tree = ElementTree.fromstring(model_description(One, "one", "guid"))
    assert [element.get("tolerance") for element in tree.iter("Quantity")] == ["0.25"]


def test_an_unknown_unit_is_reported_with_its_variable():
    class Odd(Fmu):
        a = Input("furlong", "far")
        b = Output("1", "out")

    with pytest.raises(ValueError, match="a: unit 'furlong'"):
        model_description(Odd, "odd", "guid")
