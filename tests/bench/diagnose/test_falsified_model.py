"""At night: the effect hidden in the model instead of the log: a wrong number of the system is found at its place."""

import pytest
from diagnose.test_falsified_model import falsified, log, named

import shipcosim as sc
from shipcosim.diagnose.pipeline import find_causes


def test_a_healthy_log_fits_the_system_as_it_is(log, falsified):
    assert find_causes(log, falsified({})).verdict == "consistent"


def test_a_wrong_mass_of_the_vessel_is_found_there(log, falsified):
    diagnosis = find_causes(log, falsified({"vessel.mass": 1.25, "vessel.inertia_yaw": 1.25}))
    assert named(diagnosis) == [("mass", None)]
    assert diagnosis.findings[0].parameters["scale"].estimate == pytest.approx(0.8, abs=0.04)


def test_a_wrong_connection_is_found_there(log, root):
    structure = sc.read(root / "ssp" / "gunnerus_open", fmus=[root / "build" / "fmus"])
    with structure.changes():
        structure.disconnect("port_rpm", "port.rpm_in")
        structure.connect("starboard_rpm", "port.rpm_in")
    diagnosis = find_causes(log, structure.checked())
    assert (diagnosis.verdict, named(diagnosis)) == ("named", [("connection", "port")])
    assert diagnosis.findings[0].note == "its rpm comes from starboard_rpm"
    assert diagnosis.basis.problem.model.wiring is None
