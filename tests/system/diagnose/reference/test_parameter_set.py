"""The set that a calibration leaves: a system that is given it is the ship that the logs would have."""

import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.pipeline import given_system
from shipcosim.diagnose.reference.parameter_set import with_calibrated_numbers, write_parameter_set
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.ssp import read_system


def test_a_system_with_the_set_is_the_ship_of_the_reference(tmp_path):
    reference, path = ships.reference(), tmp_path / "calibrated.ssv"
    values = write_parameter_set(twin.system(), reference, path)
    system = read_system(twin.system().file, fmus=[twin.ROOT / "build" / "fmus"], parameters=[path])
    ship = ship_model_of(system)
    assert {"vessel.mass", "starboard.thrust_scale", "vessel.wind_load_scale"} <= set(values)
    for number in reference.numbers:
        assert ship.get(number.name) == pytest.approx(number.estimate, rel=1e-12)
        if number.name in values:
            assert ship.tolerances[number.name] == pytest.approx(number.std, rel=1e-9)


def test_what_is_extended_by_what_changed_has_the_numbers_of_the_reference(tmp_path):
    reference = ships.reference()
    given = with_calibrated_numbers(given_system(twin.system()), reference, tmp_path)
    mass = next(number.estimate for number in reference.numbers if number.name == "vessel.mass")
    assert given.given.components["vessel"].start_value("mass") == pytest.approx(mass)
