"""The table of docs/interoperability.md is what the engines do: run again, it comes out the same."""

from conformance.cases import cases
from conformance.recording import ENGINES, RIGHT, rows


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
