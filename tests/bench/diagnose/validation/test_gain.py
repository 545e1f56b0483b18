"""At night: named causes predict ordinary logs of forty minutes better than the bias observer."""

import numpy as np
import pytest
from diagnose.validation.test_gain import diagnosed, model, system, twin

from shipcosim.diagnose.validation.gain import compare, rms
from shipcosim.diagnose.validation.split import HORIZONS


@pytest.mark.parametrize("kind", ["trial", "work"])
def test_ordinary_logs_of_forty_minutes_gain_beyond_the_bias_observer(diagnosed, kind):
    shares = []
    for cause in ("current", "thrust_loss", "wave_drift", "wind_scale", "tow"):
        twin, faulty = (
            compare(*diagnosed(cause, one, kind, 2010, 40)[:2]).errors for one in (True, False)
        )
        rival, after, possible = (
            rms(errors, "position", model)
            for errors, model in ((faulty, "bias_observer"), (faulty, "extended"), (twin, "plain"))
        )
        shares.append((rival - after) / (rival - possible))
    assert np.median(shares) > 0.9
    assert HORIZONS[-1] == 60.0
