"""At night: beside right causes that CI leaves out nothing is left."""

import pytest
from diagnose.inference.test_unmodelled import check_nothing_left


@pytest.mark.parametrize("name", ["mass", "tow", "heading_bias"])
def test_beside_the_right_cause_nothing_is_left(name):
    check_nothing_left(name)
