"""At night: causes fitted to sea trials on one side predict those on the other."""

import pytest
from diagnose import twin
from diagnose.sea_trials.test_sea_trials import logs

from shipcosim.diagnose.sea_trials.study import STEPS, study


def test_causes_fitted_on_one_side_predict_the_other(logs):
    told = []
    found = study(logs["slowed in turns"], twin.system(), progress=told.append, orders=True)
    assert told == list(STEPS)
    assert found.verdict == "ambiguous" and set(found.held_out) == {"port", "starboard"}
    for one in found.held_out.values():
        assert not set(one.fitted_on) & set(one.judged_on)
        for feature in ("speed", "t90"):
            name = f"turning circle: {feature}"
            assert one.before[name] > 5.0 and one.after[name] < 3.0
    said = found.as_json()
    assert said["verdict"] == "ambiguous" and len(said["indistinguishable"]) == len(found.rivals)
