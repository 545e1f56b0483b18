"""An input outside the range that its FMU states is a remark, however its value comes to be."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

from shipcosim.cosim import RunOptions, engines_missing, simulate
from shipcosim.series import make_table

LOW, HIGH = -1.0, 2.0
OTHERS = [name for name in ("libcosim", "ecos") if name not in engines_missing()]
SEVERAL = settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
NUMBERS = some.one_of(some.sampled_from([LOW, HIGH, 0.0]), some.floats(-4.0, 4.0))


def remarks_of(system, scenario, **options):
    table = simulate(system, scenario, RunOptions(**options))
    return [text for text in json.loads(table.attrs["remarks"]) if "states a range" in text]


def is_outside(value):
    return not LOW - 1e-9 <= value <= HIGH + 1e-9


@SEVERAL
@given(values=some.lists(NUMBERS, min_size=2, max_size=4))
def test_of_a_table(bounded, make_scenario, values):
    table = make_table(np.linspace(0.0, 1.0, len(values)), [("u", np.array(values), "1", "")])
    remarks = remarks_of(bounded, make_scenario(1.0, 1.0 / 6.0), inputs=table)
    assert len(remarks) == any(map(is_outside, values))
    if remarks:
        worst = max(values, key=lambda value: max(LOW - value, value - HIGH))
        assert f"b.u: {worst:.6g} at " in remarks[0] and "-1 to 2" in remarks[0]


@SEVERAL
@given(value=NUMBERS)
def test_of_an_event(bounded, make_scenario, value):
    event = {"time": 0.5, "override": {"b.u": value}}
    assert len(remarks_of(bounded, make_scenario(events=[event]))) == is_outside(value)


@SEVERAL
@given(
    start=NUMBERS,
    factor=some.sampled_from([1.0, -2.0, 0.25]),
    engine=some.sampled_from(["fmpy", "native", *OTHERS]),
)
def test_of_a_connection(make_system, make_scenario, start, factor, engine):
    change = f'<ssc:LinearTransformation factor="{factor}"/>'
    system = make_system(
        {"a": ("integrator", {"y_start": start}), "b": "bounded"}, [f"a.y -> b.u|{change}"]
    )
    remarks = remarks_of(system, make_scenario(), engine=engine)
    assert len(remarks) == is_outside(factor * start)


@pytest.fixture
def bounded(make_system):
    return make_system({"b": "bounded"}, ["u -> b.u"], {"u": ("input", "Real", "")})
