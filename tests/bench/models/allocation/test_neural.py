"""At night: our neural allocator: limits that hold whatever the network says, requests met, slipstreams made up for."""

import pytest
from models.allocation.test_neural import count_violations


@pytest.mark.parametrize("kind", ["anywhere", "back and forth", "out of reach", "nearly nothing"])
def test_no_limit_is_broken_on_a_million_requests(kind):
    for diameter in (0.0, 1.9):
        count_violations(kind, diameter, runs=2500, steps=50)
