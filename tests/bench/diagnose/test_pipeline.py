"""At night: from a file to a diagnosis: planted causes are named, and what cannot be tested is said."""

import pytest
from diagnose import twin
from diagnose.test_pipeline import PARAMETERS, check_planted, diagnosed

from shipcosim.diagnose.pipeline import find_causes
from shipcosim.series import write_table


def test_without_wind_in_the_log_its_causes_are_not_testable_and_that_is_said(tmp_path):
    path = tmp_path / "log.csv"
    write_table(twin.logs()["heading_bias"].drop_vars("wind_speed"), path)
    diagnosis = find_causes(path, twin.system())
    assert any("No wind in the log" in remark for remark in diagnosis.basis.problem.record.remarks)
    assert {"wind_scale", "wind_direction"} <= set(diagnosis.not_testable)


@pytest.mark.parametrize("name", [name for name in PARAMETERS if name != "current"])
def test_planted_causes_are_named_with_their_parameters(name, diagnosed):
    check_planted(name, diagnosed)
