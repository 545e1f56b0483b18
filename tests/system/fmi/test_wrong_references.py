"""A host that asks a built FMU for variables that it has not: an error of that call, and nothing more."""

import ctypes

import pytest
from fmpy.fmi1 import FMICallException
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as some

ERROR = 3
VALUES = {"Real": 1.5, "Integer": 1, "Boolean": 1, "String": "x"}


@settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    kind=some.sampled_from(sorted(VALUES)),
    is_set=some.booleans(),
    others=some.lists(some.integers(0, 40), max_size=3),
    wrong=some.one_of(some.integers(11, 40), some.integers(2**31 - 2, 2**32 - 1)),
    where=some.integers(0, 3),
)
def test_a_wrong_value_reference_is_an_error_and_the_instance_goes_on(
    running, kind, is_set, others, wrong, where
):
    host, expected = running
    references = [*others[:where], wrong, *others[where:]]
    call = getattr(host.slave, f"{'set' if is_set else 'get'}{kind}")
    with pytest.raises(FMICallException) as raised:
        call(references, *([[VALUES[kind]] * len(references)] if is_set else []))
    assert raised.value.status == ERROR
    assert host.messages[-1][0] == ERROR
    assert f"there is no {kind} variable with value reference" in host.messages[-1][1]
    assert host.get("value") == expected


@pytest.fixture
def running(lag, load):
    host = load(lag).start(value_in=1.0)
    return host, host.step()[0]


def test_no_failure_of_a_model_is_fatal(lag, load):
    host = load(lag).start(mode=13)
    component = host.slave.component
    step = host.slave.dll.fmi2DoStep
    step.restype = ctypes.c_int
    assert step(ctypes.c_void_p(component), ctypes.c_double(0.0), ctypes.c_double(0.1), 0) == ERROR
