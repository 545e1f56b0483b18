"""At night: the compiled filter is made from the sources that stand beside it."""

import importlib.util

import pytest
from diagnose.inference.test_kalman_library import REMEDY

from shipcosim.diagnose.inference import kalman
from shipcosim.diagnose.inference.kalman.compile import TARGETS, compile_filter


@pytest.mark.parametrize("platform", TARGETS)
def test_compiled_again_it_has_the_same_bytes(platform, tmp_path, needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')
    assert (
        compile_filter(platform, tmp_path).read_bytes() == kalman.library_for(platform).read_bytes()
    ), REMEDY
