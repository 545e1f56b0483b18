"""Tables that feed inputs: two rows of one time are a jump, held and linear, at any step and place."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipcosim.cosim.master.inputs import input_values
from shipcosim.errors import ShipcosimError
from shipcosim.series import make_table
from shipcosim.ssp import Signal, System


def fed(clock, values, times, how):
    table = make_table(np.array(clock), [("u", np.array(values), "", "")])
    table["u"].attrs["interpolation"] = how
    system = System("one", "one.ssd", {}, inputs={"u": Signal("u", "Real")})
    return input_values(table, system, np.array(times))["u"]


@given(
    place=st.sampled_from([0.0, 0.1, 0.5, 0.75, 1.0]),
    step=st.sampled_from([0.05, 0.1, 0.25]),
    before=st.sampled_from([-1.0, 0.0, 2.0]),
    after=st.sampled_from([0.0, 3.0]),
    how=st.sampled_from(["held", "linear"]),
)
@settings(max_examples=60, deadline=None)
def test_two_rows_of_one_time_are_a_jump(place, step, before, after, how):
    times = np.arange(round(1.0 / step) + 1) * step
    clock = [0.0] * (place > 0.0) + [place, place] + [1.0] * (place < 1.0)
    values = [before] * (place > 0.0) + [before, after] + [after] * (place < 1.0)
    found = fed(clock, values, times, how)
    assert np.allclose(found, np.where(times >= place - 1e-9, after, before))


def test_three_rows_of_one_time_and_times_that_go_back_are_refused():
    for clock in ([0.0, 0.5, 0.5, 0.5, 1.0], [0.0, 0.6, 0.5, 0.7, 1.0]):
        with pytest.raises(ShipcosimError, match="Times have to grow"):
            fed(clock, range(5), [0.0, 0.5, 1.0], "held")


@given(
    kind=st.sampled_from(["Integer", "Boolean", "Enumeration"]),
    value=st.one_of(
        st.integers(-(2**31), 2**31 - 1),
        st.sampled_from([-1.0, 2.0, 0.5, 2.0**31, -(2.0**31) - 1.0, 1e12, 1e300]),
    ),
)
@settings(max_examples=60, deadline=None)
def test_a_value_that_an_input_cannot_hold_is_refused(kind, value):
    table = make_table(np.array([0.0, 1.0]), [("u", np.array([0.0, value]), "", "")])
    system = System("one", "one.ssd", {}, inputs={"u": Signal("u", kind)})
    low, high = (0, 1) if kind == "Boolean" else (-(2**31), 2**31 - 1)
    if low <= value <= high and value == round(value):
        assert input_values(table, system, np.array([0.0, 1.0]))["u"].tolist() == [0, value]
        return
    with pytest.raises(
        ShipcosimError, match=f"feeds an input of type {kind}: whole numbers from {low} to"
    ):
        input_values(table, system, np.array([0.0, 1.0]))
