"""At night: a wrong place of an azimuth thruster along the ship is named, with the file's number and the log's."""

import pytest
from diagnose.test_file_numbers import check_place, found


@pytest.mark.parametrize("found", [{"starboard.x": -12.4}], indirect=True)
def test_a_wrong_place_of_an_azimuth_is_named_with_both_numbers(found):
    check_place(found, "thruster_position_x", "starboard", "x")
