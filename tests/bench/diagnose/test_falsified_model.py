"""At night: the effect hidden in the model instead of the log: a wrong number of the system is found at its place.

`make test` has wrong numbers in `diagnose.test_file_numbers`, the thrust of the tunnel among them.
"""

from xml.sax.saxutils import quoteattr

import pytest

import shipcosim as sc
from shipcosim.diagnose.pipeline import find_causes
from shipcosim.ssp import read_system
from truth import draw

SEED, MINUTES = 17, 20
SSV = """<?xml version="1.0" encoding="UTF-8"?>
<ssv:ParameterSet version="1.0" name="falsified"
  xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">
<ssv:Parameters>{}</ssv:Parameters></ssv:ParameterSet>
"""


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("healthy") / "log.csv"
    draw("trial", SEED, causes=0, minutes=MINUTES).save(path)
    return path


@pytest.fixture
def falsified(root, tmp_path):
    """Function from factors on the system's numbers to the system with them."""

    def change(factors):
        place, fmus = root / "ssp" / "gunnerus_open", [root / "build" / "fmus"]
        right, lines = read_system(place, fmus=fmus), []
        for path, factor in factors.items():
            component, name = path.split(".")
            value = factor * right.components[component].start_value(name)
            lines.append(
                f'<ssv:Parameter name={quoteattr(path)}><ssv:Real value="{value}"/></ssv:Parameter>'
            )
        file = tmp_path / "falsified.ssv"
        file.write_text(SSV.format("".join(lines)), encoding="utf-8")
        return read_system(place, [file], fmus=fmus)

    return change


def named(diagnosis):
    return [(finding.cause, finding.component) for finding in diagnosis.findings]


def test_a_wrong_coefficient_of_the_tunnel_is_found_there(log, falsified):
    diagnosis = find_causes(log, falsified({"tunnel.thrust_coefficient": 1.4}))
    assert named(diagnosis) == [("thrust_loss", "tunnel")]
    assert diagnosis.findings[0].parameters["loss"].estimate == pytest.approx(
        1.0 - 1.0 / 1.4, abs=0.06
    )


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
