"""At night: the optimal allocator: limits that hold whatever is requested, requests that are met, and its power."""

import pytest
from models.allocation.test_optimal import keep_limits


@pytest.mark.parametrize("always", [False, True])
def test_no_limit_is_broken_on_a_million_random_requests(always):
    assert keep_limits(10_000, 100, 3, always=always) == 0
