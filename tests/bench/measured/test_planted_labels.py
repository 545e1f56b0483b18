"""At night: wrong labels planted in each log of real craft, in all rows and in every fifth."""

import pytest
from measured.test_planted_labels import LOGS, check_planted


@pytest.mark.parametrize("stride", [1, 5])
@pytest.mark.parametrize(("craft", "name"), LOGS)
def test_planted_labels_are_named_and_nothing_else(craft, name, stride, tmp_path):
    check_planted(craft, name, stride, tmp_path)
