"""The generators of the reference, which lie in docs."""

import importlib

import pytest


@pytest.fixture(scope="session")
def generator(root):
    """Function that imports a module of docs/generators by its name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(root / "docs" / "generators"))
        yield importlib.import_module
