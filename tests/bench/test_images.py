"""At night: the picture of the measured trials is as its command makes it now."""

import pytest
from test_images import MOST, images


def test_picture_of_the_measured_trials_is_as_its_command_makes_it_now(images, shared, tmp_path):
    kept = images.path_of("sea_trials_2022").read_bytes()
    assert images.difference(kept, images.fresh("sea_trials_2022", tmp_path)) <= MOST, "run write_sea_trials.py"
