"""The table of docs/interoperability.md is what the engines do: run again, it comes out the same."""

import c_fmus
import pytest
from conformance.cases import cases
from conformance.recording import ENGINES, RIGHT, record, rows

from shipcosim.cosim import engines_missing


def test_the_page_has_a_row_for_every_feature_and_no_other(stated):
    features = [feature for _, feature, _ in rows().values()]
    assert len(set(features)) == len(features)
    for engine in ENGINES:
        assert sorted(stated[engine]) == sorted(features)


def test_our_own_master_does_all_but_the_gaps(stated):
    gaps = {case.feature for case in cases().values() if case.gap}
    assert {feature for feature, verdict in stated["shipcosim"].items() if verdict != RIGHT} == gaps


def test_no_engine_that_we_drive_is_silently_wrong(stated):
    for engine in ("shipcosim on libcosim", "shipcosim on ecos"):
        assert set(stated[engine].values()) == {"right", "refused"}


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_an_engine_does_what_the_page_says(engine, stated, needs):
    missing = engines_missing().get(engine.split()[-1])
    if missing:
        needs(engine, str(missing))
    if c_fmus.compiler() is None:
        needs("a C compiler")
    found = record(engine)
    assert {rows()[name][1]: verdict for name, (verdict, _) in found.items()} == stated[engine]
