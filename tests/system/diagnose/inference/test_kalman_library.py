"""The compiled filter: from the sources that stand beside it, for all platforms, and refused where it is not."""

import sys

import pytest

from shipcosim.diagnose.inference import kalman
from shipcosim.diagnose.inference.kalman.compile import TARGETS, digest
from shipcosim.errors import ShipcosimError

REMEDY = "Run `python -m shipcosim.diagnose.inference.kalman.compile`."


@pytest.mark.parametrize("platform", TARGETS)
def test_the_filter_was_compiled_from_the_sources_that_stand_here(platform):
    assert digest(platform).encode() in kalman.library_for(platform).read_bytes(), REMEDY


def test_on_another_platform_the_error_says_for_which_there_are_filters(monkeypatch):
    kalman.library.cache_clear()
    monkeypatch.setattr(kalman.platform, "machine", lambda: "riscv64")
    with pytest.raises(ShipcosimError, match=f"{sys.platform}-riscv64.*linux-x86_64.*compile.py"):
        kalman.library()
    kalman.library.cache_clear()
