"""The reference: its file, what it makes of a ship, and what has changed since."""

import numpy as np
import pytest
from diagnose import twin
from diagnose.reference import ships

from shipcosim.diagnose.explanation.null_distribution import drawn_within_tolerances
from shipcosim.diagnose.explanation.search import explain
from shipcosim.diagnose.explanation.unmodelled import unmodelled_gains
from shipcosim.diagnose.explanation.verdict import judge
from shipcosim.diagnose.hypotheses.catalogue import read_catalogue
from shipcosim.diagnose.inference.problem import identification_problem
from shipcosim.diagnose.reference.calibration import (
    calibrated_to,
    causes_beside,
    likeliest_scale,
    numbers_of,
)
from shipcosim.diagnose.reference.reference import read_reference, with_reference
from shipcosim.diagnose.reference.several_logs import SeveralLogs
from shipcosim.diagnose.reference.thresholds import DAY_TO_DAY
from shipcosim.errors import ShipcosimError


@pytest.fixture(scope="module")
def known():
    """The ship as her reference knows her."""
    return with_reference(twin.model(), ships.reference())


def test_calibration_finds_the_ships_own_numbers_within_what_it_says_of_them():
    numbers = {number.name: number for number in ships.reference().numbers}
    off = [
        (numbers[name].estimate - value) / numbers[name].std
        for name, value in ships.HER_OWN.items()
    ]
    assert np.abs(off).max() < 2.5
    assert numbers["vessel.cross_flow_drag"].std < 0.5 * numbers["vessel.cross_flow_drag"].tolerance
    assert not any(name.startswith(("water.", "instruments.")) for name in numbers)


def test_tolerances_as_stated_are_enough_for_a_ship_within_them():
    assert ships.calibration().scale == 1.0
    assert likeliest_scale(ships.calibration().fit) == 1.0


def test_a_reference_is_read_as_it_was_written(tmp_path):
    reference = ships.reference()
    reference.write(tmp_path / "reference.json")
    again = read_reference(tmp_path)
    assert again.numbers == reference.numbers and again.logs == reference.logs
    np.testing.assert_allclose(again.correlation, reference.correlation, atol=1e-6)


def test_a_reference_of_another_ship_is_refused():
    reference = ships.reference()
    with pytest.raises(ShipcosimError, match="vessel.mass"):
        with_reference(twin.model().with_values({"vessel.mass": 600e3}), reference)


def test_what_is_no_reference_is_refused_with_what_is_wrong(tmp_path):
    with pytest.raises(ShipcosimError, match="no such reference"):
        read_reference(tmp_path)
    (tmp_path / "reference.json").write_text('{"schema": "shipcosim-reference/1"}')
    with pytest.raises(ShipcosimError, match="numbers"):
        read_reference(tmp_path)


def test_directions_have_the_covariance_of_the_reference_and_what_days_differ_by(known):
    reference = ships.reference()
    names, tolerances, _, covariance = numbers_of(ships.calibration().fit)
    found = np.array([[direction[name] for direction in known.directions] for name in names])
    expected = covariance + np.diag((DAY_TO_DAY * tolerances) ** 2)
    np.testing.assert_allclose(
        (found @ found.T) / np.outer(tolerances, tolerances),
        expected / np.outer(tolerances, tolerances),
        atol=1e-3,
    )
    assert known.get("vessel.mass") == next(
        n.estimate for n in reference.numbers if n.name == "vessel.mass"
    )


def test_healthy_ships_are_drawn_as_the_reference_leaves_them_uncertain(known):
    drawn = drawn_within_tolerances(known, (4000,), np.random.default_rng(0))
    variance = sum(direction["vessel.cross_flow_drag"] ** 2 for direction in known.directions)
    assert np.std(drawn.get("vessel.cross_flow_drag")) == pytest.approx(np.sqrt(variance), rel=0.05)
    assert np.ndim(drawn.get("instruments.wind_lag")) == 0


def diagnosed(ship, name, seed=4):
    problem = identification_problem(ships.logs(seed)[name], ship, read_catalogue())
    fits = explain(problem)
    return fits[0], judge(fits, lambda fit: unmodelled_gains(problem, fit))


def test_nothing_has_changed_on_another_day(known):
    assert diagnosed(known, "well")[1].verdict == "consistent"


def test_a_loss_since_is_found_more_exactly_than_without_the_reference(known):
    with_it, judgement = diagnosed(known, "lost")
    without, _ = diagnosed(twin.model(), "lost")
    assert judgement.verdict == "named"
    assert with_it.label == without.label == "thrust_loss of port"
    assert with_it.std["port.thrust_loss"] < 0.8 * without.std["port.thrust_loss"]
    before = known.get("port.thrust_loss")
    assert with_it.values["port.thrust_loss"] - before == pytest.approx(0.12, abs=0.03)


def test_a_ship_that_is_not_well_is_told():
    logs = SeveralLogs({"log": twin.problem("thrust_loss")}, is_well=True)
    assert "thrust_loss of port" in causes_beside(calibrated_to(logs))
    assert causes_beside(ships.calibration()) == {}


def test_a_current_of_the_day_is_fitted_beside_the_ship():
    found = ships.calibration("current", 3)
    assert found.fit.label == "current of current"
    assert found.fit.parts["current"].values["water.current_north"] == pytest.approx(0.2, abs=0.03)
