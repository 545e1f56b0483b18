"""At night: the form of a ship that holds her place."""

import pytest
from diagnose.test_form_system import (
    found_in,
    test_numbers_of_the_day_are_not_in_it,
    test_the_form_is_written_as_a_system_that_predicts_better,
)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return found_in("hold", tmp_path_factory, minutes=30)
