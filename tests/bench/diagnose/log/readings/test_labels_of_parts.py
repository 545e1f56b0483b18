"""At night: further labels that are wrong in a part of a short log."""

import pytest
from diagnose.log.readings.test_labels_of_parts import IN_CI, PLANTED, check_part


@pytest.mark.parametrize("note", [note for note in PLANTED if note not in IN_CI])
def test_a_wrong_label_in_a_part_of_a_minute_and_a_half_is_named_with_it(note):
    check_part(note)
