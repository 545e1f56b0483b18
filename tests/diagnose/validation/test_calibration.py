"""The set apart from the causes: a system that is given it is the ship that the log would have, but for the causes."""

import numpy as np
import pytest
from diagnose import twin
from diagnose.twin import fits

from shipcosim.diagnose.ship.model import ship_model_of
from shipcosim.diagnose.validation.calibration import calibrate
from shipcosim.diagnose.validation.gain import calibrated
from shipcosim.ssp import read_system


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Fit with a planted loss of port, what the set holds, and the ship of a system that is given it."""
    fit = next(fit for fit in fits("thrust_loss") if fit.label == "thrust_loss of port")
    path = tmp_path_factory.mktemp("set") / "calibrated.ssv"
    values = calibrate(twin.system(), fit, path)
    return (
        fit,
        values,
        ship_model_of(read_system(twin.system().file, fmus=[twin.ROOT / "build" / "fmus"], parameters=[path])),
    )


def test_a_system_with_the_set_is_the_ship_that_the_log_would_have(written):
    fit, values, ship = written
    moved, nominal = calibrated(fit), twin.model()
    assert "vessel.mass" in values and "starboard.thrust_scale" in values
    for path, value in values.items():
        assert ship.get(path) == pytest.approx(moved.get(path), rel=1e-12) and value == moved.get(path)
    assert (
        max(abs(ship.get(p) - nominal.get(p)) / nominal.tolerances[p] for p in values if p in nominal.tolerances) > 0.5
    )


def test_no_number_of_a_cause_and_none_far_beyond_its_tolerance_is_in_it(written):
    fit, values, ship = written
    assert "port.thrust_loss" not in values and ship.get("port.thrust_loss") == 0.0
    sizes = {path: size for column in fit.columns for path, size in column.changes.items()}
    assert np.max([abs(value - fit.model.get(path)) / sizes[path] for path, value in values.items()]) < 4.0
