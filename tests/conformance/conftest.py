"""What the conformance tests have in common."""

import c_fmus
import pytest
from conformance.cases import cases


@pytest.fixture(autouse=True)
def compiler(request, needs):
    """What a C compiler is needed for is left out where there is none."""
    name = getattr(request.node, "callspec", None) and request.node.callspec.params.get("name")
    if name and cases()[name].needs_compiler and c_fmus.compiler() is None:
        needs("a C compiler")
