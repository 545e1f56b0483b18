"""At night: what healthy ships miss on a log of a ship that holds her place."""

import pytest
from diagnose.validation.test_healthy_errors import (
    agreed_on,
    test_a_healthy_ship_is_predicted_as_well_as_others,
    test_a_system_that_misses_more_is_not_consistent,
)


@pytest.fixture(scope="module")
def agreed(tmp_path_factory):
    return agreed_on("hold", tmp_path_factory)
