"""At night: training of docking predictors repeats byte by byte."""

import numpy as np
import pytest
from learn.docking.test_predictors import learned, replayed

from shipcosim.learn.results import npz_bytes


@pytest.mark.parametrize("kind", ["ours", "paper-iii"])
def test_a_few_steps_repeat_byte_by_byte(kind, replayed):
    one, epochs = learned(kind, replayed)
    other, _ = learned(kind, replayed)
    assert npz_bytes(one) == npz_bytes(other)
    assert len(epochs) == 4 and all(np.isfinite(list(epoch.values())).all() for epoch in epochs)
