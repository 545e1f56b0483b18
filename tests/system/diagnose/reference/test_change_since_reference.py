"""What has changed since a reference is said with both sizes."""

import json

import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.finding import Finding, ParameterEstimate
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.reference.change_since_reference import with_sizes_at_reference
from shipcosim.report.diagnosis.words import finding_text, size_rows


@pytest.fixture(scope="module")
def since():
    """Findings with the sizes that the reference holds of them."""

    def found(*findings):
        return with_sizes_at_reference(findings, twin.model(), ships.reference(), read_catalogue())

    return found


def test_a_loss_has_what_it_was_at_the_reference_and_what_it_is_now(since):
    lost = Finding("thrust_loss", "port", parameters={"loss": ParameterEstimate(0.12, 0.01, "1")})
    (found,) = since(lost)
    number = next(one for one in ships.reference().numbers if one.name == "port.thrust_loss")
    before = found.at_reference["loss"]
    assert (before.estimate, before.std) == (
        pytest.approx(number.estimate),
        pytest.approx(number.std),
    )
    assert json.loads(json.dumps(found.as_json()))["at_reference"]["loss"]["std"] == pytest.approx(
        number.std
    )
    ((name, size),) = size_rows(found)
    assert name == "loss" and size.endswith(" → 0.120 ± 0.010")
    assert "at the reference: loss" in finding_text(found)


def test_an_angle_is_in_the_units_of_the_catalogue(since):
    turned = Finding(
        "azimuth_offset", "port", parameters={"offset": ParameterEstimate(9.0, 0.3, "deg")}
    )
    (found,) = since(turned)
    number = next(one for one in ships.reference().numbers if one.name == "port.azimuth_offset")
    assert found.at_reference["offset"].std == pytest.approx(57.29578 * number.std, rel=1e-6)
    assert found.at_reference["offset"].unit == "deg"


def test_weather_and_faults_of_the_log_have_no_size_at_the_reference(since):
    current = Finding(
        "current",
        parameters={
            "north": ParameterEstimate(0.2, 0.01, "m/s"),
            "east": ParameterEstimate(0.0, 0.01, "m/s"),
        },
    )
    for found in since(current, Finding("gap", kind="data")):
        assert not found.at_reference and "at_reference" not in found.as_json()
