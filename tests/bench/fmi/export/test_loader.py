"""At night: the loader as it is kept: compiled from the sources beside it, whole, and for old systems too."""

import importlib.util

import pytest
from fmi.export.compile_loader import compile_loader
from fmi.export.test_loader import REMEDY

from shipcosim.fmi.export.loader import SUFFIXES, loader_for


@pytest.mark.parametrize("platform", SUFFIXES)
def test_compiled_again_it_has_the_same_bytes(platform, tmp_path, needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')
    assert compile_loader(platform, tmp_path).read_bytes() == loader_for(platform).read_bytes(), (
        REMEDY
    )
