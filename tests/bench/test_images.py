"""At night: pictures are as their commands make them now."""

import pytest
from test_images import MOST, images


def test_picture_of_the_measured_trials_is_as_its_command_makes_it_now(images, shared, tmp_path):
    kept = images.path_of("sea_trials_2022").read_bytes()
    assert images.difference(kept, images.fresh("sea_trials_2022", tmp_path)) <= MOST, (
        "run write_sea_trials.py"
    )


@pytest.mark.parametrize(
    "name", ["four_corner", "capability", "diagnosis", "study", "dp-loop", "dp-sensors"]
)
def test_picture_is_as_its_command_makes_it_now(images, name, tmp_path):
    kept = images.path_of(name).read_bytes()
    assert images.difference(kept, images.fresh(name, tmp_path)) <= MOST, (
        "run docs/generators/write_images.py"
    )
