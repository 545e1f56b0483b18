"""FMU classes as plain objects, without FMI."""

import math
from dataclasses import dataclass

import pytest

from shipcosim.fmi import Fmu, FmuError, Input, Output, Parameter, Parameters
from shipcosim.models.core.parameters import quantity, required, required_table


@dataclass(frozen=True)
class Hull:
    mass: float = quantity(500e3, "kg", "mass", "assumed", tolerance=10e3, minimum=1.0)
    table: str = quantity("0 1; 10 2", "1", "table", "assumed")


class Ship(Fmu):
    """Ship that is pushed."""

    force = Input("N", "push")
    failed = Input("1", "does not move", start=False)
    speed = Output("m/s", "speed")
    limit = Parameter(10.0, "m/s", "largest speed", maximum=20.0)
    hull = Parameters(Hull)
    old_hull = Parameters(Hull, prefix="old_")

    def start(self):
        self.speed = 0.0

    def step(self, t, h):
        if not self.failed:
            self.speed = min(self.limit, self.speed + h * self.force / self.hull.mass)


def test_a_class_works_as_a_plain_object():
    ship = Ship()
    ship.force = 1e6
    ship.start()
    ship.step(0.0, 0.5)
    assert ship.speed == 1.0


def test_variables_are_inputs_outputs_parameters_in_the_order_of_declaration():
    names = [variable.name for variable in Ship.variables]
    assert names == ["force", "failed", "speed", "limit", "mass", "table", "old_mass", "old_table"]
    assert [variable.type for variable in Ship.variables[:2]] == ["Real", "Boolean"]
    mass = Ship.variables[4]
    assert (mass.unit, mass.description, mass.origin) == ("kg", "mass", "assumed")
    assert (mass.tolerance, mass.minimum) == (10e3, 1.0)


def test_a_group_is_made_of_the_values_set_before_the_start():
    ship = Ship()
    ship.mass = 1e6
    assert (ship.hull.mass, ship.old_hull.mass) == (1e6, 500e3)
    ship.mass = 2e6
    ship.start()
    assert ship.hull == Hull(mass=2e6)


def test_the_start_is_computed_again_where_a_value_has_changed_and_only_there():
    class Counting(Ship):
        def start(self):
            hulls.append(self.hull)
            self.speed = self.force / self.hull.mass

    hulls, ship = [], Counting()
    ship.enter_initialization_mode()
    for force, failed, mass in (
        (1e6, False, 5e5),
        (1e6, False, 5e5),
        (2e6, False, 5e5),
        (2e6, True, 5e5),
        (2e6, True, 1e6),
    ):
        ship.set_boolean([1], [failed])
        ship.real_setter((0,))([force])
        ship.set_real([4], [mass])
        assert ship.get_real([2]) == [force / mass]
    ship.exit_initialization_mode()
    assert [hull.mass for hull in hulls] == [5e5, 5e5, 5e5, 1e6] and hulls[0] is hulls[1] is hulls[
        2
    ]


def test_two_objects_share_no_value():
    one, other = Ship(), Ship()
    one.force = 3.0
    assert other.force == 0.0


def test_subclasses_inherit_variables_and_may_change_a_start_value():
    class Tug(Ship):
        limit = Parameter(5.0, "m/s", "largest speed")

    assert [variable.name for variable in Tug.variables] == [
        variable.name for variable in Ship.variables
    ]
    assert Tug().limit == 5.0 and Ship().limit == 10.0


def test_what_the_shell_cannot_serve_is_refused_when_the_class_is_made():
    def make(**members):
        return type("Bad", (Fmu,), members)

    with pytest.raises(TypeError, match="start"):
        make(hull=Parameters(Hull), mass=Input("kg", "mass"), __init__=lambda self: None)
    with pytest.raises(TypeError, match="mass twice"):
        make(hull=Parameters(Hull), mass=Input("kg", "mass"))
    with pytest.raises(TypeError, match="messages"):
        make(messages=Input("1", "messages"))
    with pytest.raises(TypeError, match=r"write 2\.0"):
        Parameter(2, "s", "time")
    with pytest.raises(ValueError, match="below its minimum"):
        Parameter(2.0, "s", "time", minimum=3.0)
    with pytest.raises(ValueError, match="not a finite"):
        Input("s", "time", start=math.nan)
    with pytest.raises(TypeError, match="frozen"):
        Parameters(dataclass(type("Loose", (), {})))


def test_bounds_of_parameters_hold_at_initialisation():
    ship = Ship("port")
    ship.limit, ship.mass = 30.0, 0.0
    ship.enter_initialization_mode()
    with pytest.raises(FmuError) as caught:
        ship.exit_initialization_mode()
    text = str(caught.value)
    assert (
        "port" in text
        and "'limit' is 30, above its maximum 20 [m/s]" in text
        and "'mass' is 0, below" in text
    )


def test_messages_are_printf_formats_that_name_the_component():
    ship = Ship("port")
    ship.log("half of 100 %", "warning")
    assert (
        ship.messages[0].msg == "port at t = 0 s: half of 100 %%" and ship.messages[0].status == 1
    )


@pytest.mark.parametrize("value", [None, "fast", math.inf])
def test_an_output_that_is_no_finite_number_is_named(value):
    class Odd(Ship):
        def step(self, t, h):
            self.speed = value

    with pytest.raises(FmuError, match="'speed' is"):
        Odd().do_step(0.0, 0.1)


def test_outputs_whose_sum_overflows_are_finite_nevertheless():
    class Big(Fmu):
        a = Output("1", "big", start=1.5e308)
        b = Output("1", "big", start=1.5e308)

        def step(self, t, h):
            pass

    assert Big().do_step(0.0, 0.1)


def test_integers_that_fmi_cannot_hold_are_refused():
    class Count(Fmu):
        n = Output("1", "count", start=2**31 - 1)

        def step(self, t, h):
            self.n += 1

    count = Count()
    assert count.get_integer([0]) == [2**31 - 1]
    count.do_step(0.0, 0.1)
    with pytest.raises(FmuError, match="32-bit"):
        count.get_integer([0])
    count.n = 1.5
    with pytest.raises(FmuError, match="whole"):
        count.get_integer([0])


def test_a_value_reference_of_another_type_is_refused():
    with pytest.raises(FmuError, match="Integer"):
        Ship().get_integer([0])
    with pytest.raises(FmuError, match="99"):
        Ship().set_real([99], [1.0])


@dataclass(frozen=True, kw_only=True)
class Unit:
    diameter: float = required("m", "diameter", minimum=0.1)
    astern: float = required("N", "thrust astern", maximum=0.0)
    loss: float = quantity(0.0, "1", "loss", "neutral")
    curve: str = required_table(("J [1]", "KT [1]"), "rows 'J KT'")


class Screw(Fmu):
    """Propeller of some ship."""

    thrust = Output("N", "thrust")
    speed = Parameter(float, "rpm", "largest speed")
    unit = Parameters(Unit)

    def step(self, t, h):
        self.thrust = self.unit.diameter


LEFT_OUT = {"speed": 1e30, "diameter": 1e30, "astern": -1e30, "curve": ""}


def test_what_describes_a_ship_starts_at_a_value_that_is_none_within_its_bounds():
    starts = {variable.name: variable.start for variable in Screw.variables if variable.required}
    assert starts == LEFT_OUT
    assert not next(variable for variable in Screw.variables if variable.name == "loss").required


def test_an_fmu_refuses_to_start_and_names_all_that_was_left_out():
    screw = Screw("port")
    with pytest.raises(
        FmuError,
        match=r"port at t = 0 s: parameters left out.*: speed \[rpm\], diameter \[m\], astern \[N\], curve\.",
    ):
        screw.enter_initialization_mode()
        screw.exit_initialization_mode()
    with pytest.raises(ValueError, match=r"left out.*diameter \[m\], astern \[N\], curve"):
        _ = screw.unit
    screw.diameter, screw.astern, screw.curve = 2.0, 0.0, "0 1"
    with pytest.raises(FmuError, match=r"parameters left out.*: speed \[rpm\]\."):
        screw.exit_initialization_mode()
    screw.speed = 100.0
    screw.exit_initialization_mode()
    screw.step(0.0, 1.0)
    assert screw.thrust == 2.0
