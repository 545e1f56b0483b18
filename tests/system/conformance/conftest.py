"""What the conformance tests have in common."""

import importlib.util

import c_fmus
import pytest
from conformance.cases import cases


@pytest.fixture(autouse=True)
def compiler(request, needs):
    """What a C compiler is needed for is left out where there is none."""
    name = getattr(request.node, "callspec", None) and request.node.callspec.params.get("name")
    if name and cases()[name].needs_compiler and c_fmus.compiler() is None:
        needs("a C compiler")


@pytest.fixture(scope="module")
def stated(root):
    """Verdicts that the page states, by engine and feature."""
    script = root / "docs" / "generators" / "write_interoperability.py"
    spec = importlib.util.spec_from_file_location("write_interoperability", script)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.recorded(module.PAGE.read_text(encoding="utf-8"))
