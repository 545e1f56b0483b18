"""At night: all laws over the seeds of the page, and rivals of other projects on random requests."""

import numpy as np
import pytest

from allocation import drawn, loops, measuring, pages, table
from allocation.laws import LAWS, RIVALS, there


@pytest.mark.parametrize("law", RIVALS)
def test_every_rival_goes_through_random_and_adversarial_requests(law):
    if not there(law):
        pytest.skip(f"needs {RIVALS[law]}, which is not installed")
    asked, _ = drawn.requests(500, 5)
    found = loops.replay(law, asked, None)
    assert np.isfinite(found.thrusts).all() and np.isfinite(found.azimuths).all()


def test_limits_are_never_broken_and_the_table_is_printed():
    """All laws over the seeds of the page; what is measured already is read from results/allocation."""
    seeds = range(7200, 7208)
    found = {law: measuring.measured(law, seeds, 100_000) for law in LAWS if there(law)}
    for law, one in found.items():
        one["seconds"] = measuring.times(law, seeds)
    print("\n" + pages.page(found))
    for law in table.KEEPING:
        assert table.broken(found[law], found) == [0] * 8 and table.broken_random(
            found[law], found
        ) == [0]
