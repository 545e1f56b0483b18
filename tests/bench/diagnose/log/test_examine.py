"""At night: the labels that `make test` tries throughout a log alone, in a part of it."""

import pytest
from diagnose.log.test_examine import IN_A_PART, LABELS, PART, check_label


@pytest.mark.parametrize("fault", sorted(set(LABELS) - set(IN_A_PART)))
def test_a_channel_mislabelled_in_a_part_is_named_and_put_right(fault):
    check_label(fault, PART)
