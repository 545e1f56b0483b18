"""At night: the table of docs/interoperability.md is what the engines do: run again, it comes out the same."""

import c_fmus
import pytest
from conformance.recording import ENGINES, record, rows

from shipcosim.cosim import engines_missing


@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_does_what_the_page_says(engine, stated, needs):
    missing = engines_missing().get(engine.split()[-1])
    if missing:
        needs(engine, str(missing))
    if c_fmus.compiler() is None:
        needs("a C compiler")
    found = record(engine)
    assert {rows()[name][1]: verdict for name, (verdict, _) in found.items()} == stated[engine]
