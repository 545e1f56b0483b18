"""Compiled components in a cache of their own."""

import importlib.util

import pytest


@pytest.fixture(autouse=True, scope="session")
def compiler(needs):
    if importlib.util.find_spec("ziglang") is None:
        needs("ziglang", 'Install it: pip install -e ".[native]".')


@pytest.fixture(scope="session")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def own_cache(cache, monkeypatch):
    monkeypatch.setenv("SHIPCOSIM_CACHE", str(cache))
