"""From logs to the files of a calibration, and from these to what has changed since."""

import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.calibration_pipeline import calibrate, log_names
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.errors import ShipcosimError
from shipcosim.report.calibration.page import write_calibration


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A ship calibrated to two days, and the folder."""
    folder = tmp_path_factory.mktemp("calibrated")
    longer = twin.sailed({"well": ships.HER_OWN}, minutes=12.0, seed=5)["well"]
    ship = calibrate([ships.logs(3)["well"], longer], twin.system(), out=folder)
    write_calibration(ship, folder / "report.html")
    return ship, folder


def test_calibration_leaves_set_reference_and_page(made):
    ship, folder = made
    assert sorted(path.name for path in folder.iterdir()) == ["calibrated.ssv", "reference.json", "report.html"]
    assert not ship.refusals and [log.name for log in ship.logs] == ["log-1", "log-2"]
    assert "vessel.cross_flow_drag" in (folder / "report.html").read_text(encoding="utf-8")


def test_rows_that_were_not_fitted_are_predicted_better(made):
    short, longer = (log.errors for log in made[0].logs)
    assert short is None and longer is not None
    assert longer["after"][-1] < 0.8 * longer["before"][-1]


def test_a_log_is_held_against_the_ship_of_the_reference(made):
    ship, folder = made
    read = read_measurements(ships.logs(4)["lost"], twin.system(), reference=folder)
    estimates = {number.name: number.estimate for number in ship.reference.numbers}
    assert read.ship.directions and read.ship.get("vessel.mass") == estimates["vessel.mass"] != 531e3


def test_logs_have_names_of_their_own():
    assert log_names(["a/x.csv", "b/x.csv.gz", "y.nc"]) == ["x-1", "x-2", "y"]
    with pytest.raises(ShipcosimError, match="at least one"):
        log_names([])
