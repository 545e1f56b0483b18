"""At night: the labels that `make test` tries throughout a log alone, in a part of it; and the other way round."""

import pytest
from diagnose.log.test_examine import IN_A_PART, LABELS, PART, THROUGHOUT, check_label
from diagnose.logs import measured, table

from shipcosim.diagnose.log.checks.examine import examine


@pytest.mark.parametrize("fault", sorted(set(LABELS) - set(IN_A_PART)))
def test_a_channel_mislabelled_in_a_part_is_named_and_put_right(fault):
    check_label(fault, PART)


@pytest.mark.parametrize("fault", sorted(set(LABELS) - set(THROUGHOUT)))
def test_a_channel_mislabelled_throughout_is_named_and_put_right(fault):
    check_label(fault)


def test_another_right_log_gives_no_finding():
    assert examine(table(measured(seed=2))) == []
