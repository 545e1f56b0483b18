"""At night: further ways to round and thin a run."""

import pytest
from diagnose.log.checks.test_coarse_logs import WAYS, check_labels


@pytest.mark.parametrize("way", WAYS[11::22])
def test_a_rounded_run_has_no_wrong_label(way):
    check_labels(way)
