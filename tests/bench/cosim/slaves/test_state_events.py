"""At night: state events of model exchange over many more directions, levels, rates and steps."""

import pytest
from cosim.slaves import test_state_events as few
from cosim.slaves.test_state_events import VERSIONS, run_of
from hypothesis import settings


def with_more(test, cases):
    """A test of `make test` with five times as many cases."""
    more = settings(max_examples=30, deadline=None)(cases(test.hypothesis.inner_test))
    return pytest.mark.parametrize("version", VERSIONS)(more)


test_a_thermostat_stays_between_its_levels = with_more(
    few.test_a_thermostat_stays_between_its_levels, few.THERMOSTATS
)
test_every_comparison_changes_where_the_level_is_passed = with_more(
    few.test_every_comparison_changes_where_the_level_is_passed, few.LEVELS
)
test_two_indicators_at_once_are_both_seen = with_more(
    few.test_two_indicators_at_once_are_both_seen, few.PAIRS
)
test_an_indicator_that_comes_back_within_a_step_is_seen = with_more(
    few.test_an_indicator_that_comes_back_within_a_step_is_seen, few.WINDOWS
)
test_a_block_sticks_and_slips_as_its_equations_say = with_more(
    few.test_a_block_sticks_and_slips_as_its_equations_say, few.BLOCKS
)
