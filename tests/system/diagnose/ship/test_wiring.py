"""Connections of a system that are not what their names say are seen, and put right."""

import numpy as np
import pytest

import shipcosim as sc
from shipcosim.diagnose.extension.extend import extend
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.ship.dynamics import loads
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.wiring import put_right
from shipcosim.models.core.motion import Motion


@pytest.fixture
def structure(root):
    return sc.read(root / "ssp" / "gunnerus_open", fmus=[root / "build" / "fmus"])


def crossed(structure):
    """The port unit's surge force in sway, the other way round; starboard driven by port's speed, backwards."""
    with structure.changes():
        structure.disconnect("port.tau_X", "vessel.tau_X_1")
        structure.disconnect("port.tau_Y", "vessel.tau_Y_1")
        structure.connect("port.tau_X", "vessel.tau_Y_1", factor=-1.0)
        structure.connect("port.tau_Y", "vessel.tau_X_1")
        structure.disconnect("starboard.rpm_in")
        structure.connect("port_rpm", "starboard.rpm_in", factor=-1.0)
    return structure


def about(model):
    """Loads of a ship at rest with both azimuths at work."""
    units = {"port": (2.0, 0.5), "starboard": (1.0, -0.2), "tunnel": (8.0, 0.0)}
    return loads(Motion(*np.zeros(6)), Inputs(0.0, units, None, None), model)


def test_a_system_wired_as_named_has_no_wiring_of_its_own(structure):
    assert ship_model_of(structure.checked()).wiring is None


def test_loads_and_speeds_go_where_the_system_sends_them(structure):
    plain = about(ship_model_of(structure.checked()))
    model = ship_model_of(crossed(structure).checked())
    found = about(model)
    X, Y, N = plain["port"]
    np.testing.assert_allclose(found["port"], (Y, -X, N), rtol=1e-12)
    assert found["starboard"][0] < 0.0 < plain["starboard"][0]
    assert found["tunnel"] == plain["tunnel"]
    assert model.wiring.odd == {
        "port": "its load reaches vessel as X: Y, Y: -1 X, N: N",
        "starboard": "its rpm comes from -1 times port_rpm",
    }


def test_one_thruster_after_the_other_is_put_right(structure):
    wiring = ship_model_of(crossed(structure).checked()).wiring
    assert set(put_right(wiring, "port").odd) == {"starboard"}
    assert put_right(put_right(wiring, "port"), "starboard") is None


def test_the_extended_system_is_wired_as_named(structure, tmp_path):
    findings = [Finding("connection", name, "physics", 0.99, {}) for name in ("port", "starboard")]
    extension = extend(crossed(structure), findings, tmp_path)
    assert ship_model_of(sc.read(extension.ssp).checked()).wiring is None
