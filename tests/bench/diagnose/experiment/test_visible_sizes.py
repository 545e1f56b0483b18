"""At night: more causes of the size that is said to be visible are seen."""

import numpy as np
from diagnose.experiment.test_visible_sizes import SEEDS, shows

CAUSES = [
    ("thrust_loss", "starboard"),
    ("rpm_offset", "port"),
    ("rpm_offset", "tunnel"),
    ("wind_direction", None),
]


def test_causes_of_the_visible_size_show():
    seen = [shown for seed in SEEDS for shown in shows(seed, CAUSES).values()]
    assert np.mean(seen) >= 0.9, seen
