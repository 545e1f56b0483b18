"""Wrong numbers in the ship file, in logs of the independent truth: named, with the file's number and the log's."""

from functools import cache

import pytest
from diagnose import twin

from shipcosim.diagnose.pipeline import find_causes
from shipcosim.report.diagnosis.words import finding_text
from shipcosim.ssp.flatten.with_values import with_values
from truth import draw

SEED = 708
TRUE = {"tunnel.x": 14.48, "starboard.x": -14.02, "port.x": -14.02, "port.y": -2.0}


@cache
def healthy(folder):
    """A log of a ship as the file says."""
    path = folder / "healthy.csv"
    draw("trial", SEED, causes=0, minutes=12).save(path)
    return str(path)


@pytest.fixture
def found(request, tmp_path_factory):
    """What is said of the log by a file with wrong numbers."""
    log = healthy(tmp_path_factory.getbasetemp())
    return find_causes(log, with_values(twin.system(), request.param))


@pytest.mark.parametrize(
    "found, cause, component, name",
    [
        ({"tunnel.x": 12.8}, "thruster_position_x", "tunnel", "x"),
        ({"port.y": -3.1}, "thruster_position_y", "port", "y"),
        ({"port.x": -11.6, "starboard.x": -11.6}, "azimuths_position_x", None, "x"),
    ],
    indirect=["found"],
)
def test_a_wrong_place_of_a_thruster_is_named_with_both_numbers(found, cause, component, name):
    check_place(found, cause, component, name)  # of an azimuth along the ship: at night


def check_place(found, cause, component, name):
    assert found.verdict == "named"
    (finding,) = found.findings
    assert (finding.cause, finding.component) == (cause, component)
    estimate = finding.parameters[name]
    true = TRUE[f"{component or 'port'}.{name}"]
    assert estimate.estimate == pytest.approx(true, abs=0.4)
    assert f"(the file says {estimate.given:.4g} m)" in finding_text(finding)
    assert finding.as_json()["parameters"][name]["given"] == estimate.given


def test_a_thruster_that_delivers_more_than_the_file_says_is_named(tmp_path_factory):
    system = twin.system()
    least = 0.8 * system.components["tunnel"].start_value("thrust_coefficient")
    weak = with_values(system, {"tunnel.thrust_coefficient": least})
    found = find_causes(healthy(tmp_path_factory.getbasetemp()), weak)
    (finding,) = found.findings
    assert finding.label == "thrust_loss of tunnel"
    assert finding.parameters["loss"].estimate == pytest.approx(-0.25, abs=0.06)
    assert "% more thrust than its speed should give" in finding_text(finding)
