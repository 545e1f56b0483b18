"""What tests of compiled components need. They share the cache of all tests, so that nothing is compiled twice."""

import importlib.util

import pytest


@pytest.fixture(autouse=True, scope="session")
def compiler(needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')
