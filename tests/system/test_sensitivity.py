"""The sensitivity page: it speaks of all doubtful numbers of the ship, and what makes it runs."""

import pytest

pytest.importorskip("matplotlib", reason="draws the pictures of the page")


@pytest.fixture(scope="module")
def sensitivity(root):
    """The command's module."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(root / "docs" / "generators" / "validation"))
    import sensitivity

    yield sensitivity
    patch.undo()


def test_the_page_has_every_doubtful_number_with_its_sources(sensitivity, root):
    text = (root / "docs" / "generated" / "sensitivity.md").read_text(encoding="utf-8")
    doubts = sensitivity.doubts()
    assert {doubt.name for doubt in doubts} >= {
        "cross_flow_drag",
        "thrust_scale_outside",
        "side_force_astern",
    }
    for row in sensitivity.rows_of_doubts():
        assert f"| {' | '.join(row)} |".replace("| ", "|").replace(" |", "|") in text.replace(
            "| ", "|"
        ).replace(" |", "|")


def test_doubtful_numbers_of_both_azimuths_are_one(sensitivity):
    (astern,) = (doubt for doubt in sensitivity.doubts() if doubt.name == "side_force_astern")
    assert astern.settings(0.71) == {
        "port.side_force_astern": 0.71,
        "starboard.side_force_astern": 0.71,
    }
    assert (astern.value, astern.ends) == (1.0, (0.71,))


def test_less_cross_flow_lets_the_current_push_less(sensitivity):
    """12 s of the scenario with each of its values: the runs that the page is made of."""
    (drag,) = (doubt for doubt in sensitivity.doubts() if doubt.name == "cross_flow_drag")
    found = sensitivity.numbers(("current_turn",), 12.0, [drag])
    assert set(found) == {("as it is", 0.0), ("another seed", 0.0)} | {
        (drag.name, c) for c in (0.6, 1.0)
    }
    for results in found.values():
        assert 0.0 < results["current_turn"]["footprint"] <= results["current_turn"]["error"] < 5.0
    assert found["as it is", 0.0] != found[drag.name, 0.6]


def test_page_and_pictures_are_made_of_any_numbers(sensitivity, monkeypatch, tmp_path):
    import common

    monkeypatch.setattr(common, "PICTURES", tmp_path)
    values = {"footprint": 0.5, "error": 1.0, "heading": 0.6, "power": 40.0, "drift": 300.0}
    cases = [("as it is", 0.0), ("another seed", 0.0)]
    cases += [("cross_flow_drag", c) for c in sensitivity.CROSS_FLOW[:-1]] + [
        ("torque_scale", 0.85)
    ]
    found = {case: {name: values for name in sensitivity.SCENARIOS} for case in cases}
    sensitivity.draw(found)
    assert {file.name for file in tmp_path.iterdir()} == {
        "sensitivity.svg",
        "sensitivity_cross_flow.svg",
    }
    assert "(+0 %)" in sensitivity.page(found)
