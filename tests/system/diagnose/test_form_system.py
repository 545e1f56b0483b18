"""A ship of another form: the system with those of its numbers that FMUs have predicts rows kept from them better."""

import json

import numpy as np
import pytest
from diagnose import twin

import shipcosim
from shipcosim.ssp import read_system
from truth import draw


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return found_in("trial", tmp_path_factory)  # a ship that holds her place: at night


def found_in(kind, tmp_path_factory, minutes=20):
    folder = tmp_path_factory.mktemp("form")
    draw(kind, 703, causes=0, form=1.0, minutes=minutes).save(folder / "log.csv")
    open_sea = str(twin.ROOT / "ssp" / "gunnerus_open")
    return folder, shipcosim.diagnose(str(folder / "log.csv"), open_sea, out=str(folder / "found"))


def test_the_form_is_written_as_a_system_that_predicts_better(found):
    folder, diagnosis = found
    assert diagnosis.verdict == "form"
    form = json.loads(json.dumps(diagnosis.as_json()))["form"]
    assert form["system_m"] < form["before_m"]
    assert diagnosis.extension.ssp.parent == folder / "found"
    extended = read_system(str(diagnosis.extension.ssp))
    for name, value in diagnosis.extension.values.items():
        component, _, number = name.rpartition(".")
        assert extended.components[component].start_value(number) == pytest.approx(value)
    assert np.isfinite(diagnosis.baseline["position_error_m"]).all()


def test_numbers_of_the_day_are_not_in_it(found):
    _, diagnosis = found
    assert diagnosis.extension.values and not any(
        name.startswith(("water", "instruments")) for name in diagnosis.extension.values
    )
