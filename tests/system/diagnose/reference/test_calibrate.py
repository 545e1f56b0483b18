"""From logs to the files of a calibration, and from these to what has changed since."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.calibration_pipeline import (
    _check_usable,
    _reasons_not_to_trust,
    calibrate,
    log_names,
    steps_of,
)
from shipcosim.diagnose.compared_log import LogComparison
from shipcosim.diagnose.finding import Finding
from shipcosim.diagnose.pipeline import read_measurements
from shipcosim.diagnose.reference import calibration
from shipcosim.diagnose.reference.reference import read_reference
from shipcosim.diagnose.reference.remaining_errors import remaining_errors
from shipcosim.diagnose.reference.several_logs import SeveralLogs
from shipcosim.errors import ShipcosimError
from shipcosim.report.calibration.page import render


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A ship calibrated to two days, and the folder."""
    folder = tmp_path_factory.mktemp("calibrated")
    longer = twin.sailed({"well": ships.HER_OWN}, minutes=12.0, seed=5)["well"]
    logs, told = [ships.logs(3)["well"], longer], []
    ship = calibrate(logs, twin.system(), progress=lambda step, *_: told.append(step), out=folder)
    assert list(dict.fromkeys(told)) == list(steps_of(logs))
    (folder / "report.html").write_text(render(ship), encoding="utf-8")
    return ship, folder


def test_calibration_leaves_set_reference_and_page(made):
    ship, folder = made
    assert sorted(path.name for path in folder.iterdir()) == [
        "calibrated.ssv",
        "reference.json",
        "report.html",
    ]
    assert not ship.refusals and [log.name for log in ship.logs] == ["log-1", "log-2"]
    assert "vessel.cross_flow_drag" in (folder / "report.html").read_text(encoding="utf-8")


def test_a_log_is_predicted_better_by_numbers_that_the_other_log_gives(made):
    errors = [log.errors for log in made[0].logs]
    assert [one.fitted_on for one in errors] == [("log-2",), ("log-1",)]
    short, longer = (one.position for one in errors)
    assert (
        longer["after"][-1] < 0.8 * longer["before"][-1]
        and short["after"][-1] < short["before"][-1]
    )
    assert longer["floor"][-1] < 1.1 * longer["after"][-1]


def test_a_single_log_is_judged_on_its_last_part():
    (errors,) = remaining_errors(ships.calibration()).values()
    assert errors.fitted_on == () and len(errors.horizon) == 3
    assert all(np.isfinite(sizes).all() for sizes in errors.position.values())


def test_logs_that_cannot_show_a_ship_that_is_well_are_refused_with_why():
    misread = Finding("frame", kind="data", channels=("north",), note="one", alternatives=("two",))
    logs = {
        "open": SimpleNamespace(faults=(misread,), comparison=LogComparison()),
        "poor": SimpleNamespace(
            faults=(),
            comparison=SimpleNamespace(obstacles=("Rows 9 s apart.",)),
        ),
    }
    with pytest.raises(ShipcosimError) as raised:
        _check_usable(logs)
    assert [problem.where for problem in raised.value.problems] == ["open", "poor"]
    assert "the log does not tell" in str(raised.value)


def test_a_ship_that_a_diagnosis_calls_ill_makes_no_reference(tmp_path):
    """Wide tolerances would make a number of her own of every cause."""
    ill = twin.sailed({"ill": {"port.thrust_loss": 0.34}}, minutes=12.0, seed=6)["ill"]
    ship = calibrate([ill], twin.system(), out=tmp_path)
    assert "names thrust loss of port" in ship.refusals[0]
    assert list(tmp_path.iterdir()) == []


def test_a_reference_that_predicts_worse_than_the_system_is_refused(made):
    (log, _) = made[0].logs
    position = {"after": (1.0, 2.0, 9.0), "before": (1.0, 2.0, 3.0)}
    worse = replace(log, errors=replace(log.errors, position=position))
    (why,) = _reasons_not_to_trust([worse], {})
    assert "misses the log by 9 m. The ship as the system has her misses it by 3 m." in why
    assert _reasons_not_to_trust([log], {"monday": []}) == []


def test_a_log_is_held_against_the_ship_of_the_reference(made):
    ship, folder = made
    read = read_measurements(ships.logs(4)["lost"], twin.system(), reference=read_reference(folder))
    estimates = {number.name: number.estimate for number in ship.reference.numbers}
    assert (
        read.ship.directions and read.ship.get("vessel.mass") == estimates["vessel.mass"] != 531e3
    )


def test_logs_have_names_of_their_own():
    assert log_names(["a/x.csv", "b/x.csv.gz", "y.nc"]) == ["x-1", "x-2", "y"]
    with pytest.raises(ShipcosimError, match="at least one"):
        log_names([])


@pytest.mark.parametrize(
    ("scores", "says"),
    [
        ({0.0: 2.0, 0.5: 3.0, 1.0: 0.0, 2.0: -3.0}, 1.0),
        ({0.0: 25.0, 0.5: 12.0, 1.0: 0.0, 2.0: -9.0}, 0.0),
        ({0.0: -60.0, 0.5: -20.0, 1.0: 0.0, 2.0: 15.0}, 2.0),
    ],
)
def test_logs_that_do_not_tell_the_form_leave_it_as_uncertain_as_usual(monkeypatch, scores, says):
    """A log of stationkeeping says nothing of drag: the model's form is certain only where logs say so."""
    monkeypatch.setattr(calibration, "scores_by_scale", lambda *_: scores)
    monkeypatch.setattr(calibration, "of_scale", lambda problem, scale: scale)
    logs, gain = calibration.with_common_form(SeveralLogs({"monday": "as it is"}, is_well=True))
    assert logs.problems["monday"] == (says or "as it is") and gain == scores[says] - scores[0.0]
