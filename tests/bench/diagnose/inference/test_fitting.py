"""At night: planted causes that CI leaves out explain their logs best."""

import pytest
from diagnose.inference.test_fitting import IN_CI, NAMES, check_planted


@pytest.mark.parametrize("name", [name for name in NAMES if name not in IN_CI])
def test_a_planted_cause_explains_its_log_best_with_its_size(name):
    check_planted(name)
