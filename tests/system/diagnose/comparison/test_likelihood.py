"""All axes at once tell the labels of thrusters, and noise tells nothing."""

import numpy as np
import pytest
from diagnose import usv

from shipcosim.diagnose.checked_log import ReadLog, checked
from shipcosim.diagnose.comparison.commanded import commanded_by
from shipcosim.diagnose.comparison.label_hypotheses import LabelError, driven
from shipcosim.diagnose.comparison.likelihood import blocks_of, likelihood_of, smoothed
from shipcosim.diagnose.comparison.measured_force import measured_force_of
from shipcosim.diagnose.inference.problem import as_logged
from shipcosim.diagnose.log.reader import read_log
from shipcosim.diagnose.ship.inputs import record_of
from shipcosim.diagnose.ship.ship_of_system import ship_model_of


@pytest.fixture(scope="module")
def told():
    """Function from a reading of the thrusters of a small craft to its log-likelihood."""
    log = checked(ReadLog(read_log(usv.log(8.0, 11)), ship_model_of(usv.structure().checked()), {}))
    ship = as_logged(log.ship, log.repaired)
    record = record_of(log.repaired, ship)
    measured = measured_force_of(record, ship.parts["hull"].length)
    blocks = blocks_of(measured, commanded_by(record, smoothed(measured), ship), ship)

    def likelihood(units):
        commanded = driven(units, record, smoothed(measured), ship)
        return likelihood_of(
            blocks, commanded, {name: speed >= 0.0 for name, (speed, _) in units.items()}
        )

    return likelihood, record.units


@pytest.mark.parametrize("change", [("left",), ("right",), ("left", "right")])
def test_right_labels_are_likelier_than_wrong_ones(told, change):
    likelihood, units = told
    assert likelihood(units) > likelihood(LabelError(change).undo(units)) + 10.0


def test_commands_that_do_nothing_make_nothing_likelier(told):
    likelihood, units = told
    rng = np.random.default_rng(6)
    noise = {
        name: (rng.permutation(speed), direction) for name, (speed, direction) in units.items()
    }
    assert likelihood(noise) < 3.0
