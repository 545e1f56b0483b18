"""The seconds of each component and phase, on both of our engines."""

import json

import pytest

import shipcosim
from shipcosim.cosim.profile import MASTER, PHASES, Profile, rows_of
from shipcosim.errors import ShipcosimError
from shipcosim.native import is_installed

ENGINES = [
    "fmpy",
    pytest.param("native", marks=pytest.mark.skipif(not is_installed(), reason="no compiler")),
]


@pytest.mark.parametrize("engine", ENGINES)
def test_each_component_has_its_steps_and_the_master_the_rest(engine):
    run = shipcosim.run("held", until=5.0, engine=engine, profile=True)
    spent = dict(rows_of(run.table.attrs["profile"]))
    assert {MASTER, *run.system.components} == set(spent)
    step, load = PHASES.index("step"), PHASES.index("load")
    assert all(seconds[step] > 0.0 for name, seconds in spent.items() if name != MASTER)
    assert spent[MASTER][load] > 0.0 and spent[MASTER][step] == 0.0
    # Counting changes no result.
    plain = shipcosim.run("held", until=5.0, engine=engine)
    assert "profile" not in plain.table.attrs
    assert plain.table.drop_attrs().identical(run.table.drop_attrs())


def test_a_phase_in_another_counts_once():
    profile = Profile()
    with profile.during("a", "load"), profile.during("b", "load"):
        pass
    profile.add("a", "load", 1.0)
    seconds = {name: found for name, _, found in json.loads(profile.as_json())}
    assert set(seconds) == {"a", "b"} and 1.0 <= seconds["a"] < 1.1


def test_other_engines_refuse_it():
    with pytest.raises(ShipcosimError, match="does not know profile"):
        shipcosim.run("held", engine="libcosim", profile=True)
