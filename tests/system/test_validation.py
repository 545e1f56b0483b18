"""The numbers of docs/generated/validation.md are those of the code today, in the sections that take seconds."""

import re
from math import isclose

import pytest

pytest.importorskip("matplotlib", reason="draws the pictures of the validation")

NUMBER = re.compile(r"(?<![\w/.])[+-]?\d+(?:\.\d+)?(?:e[+-]\d+)?")
TITLES = {
    "turn": "1 The recorded",
    "trials": "2 The trials",
    "units": "3 Propeller",
    "loads": "4 Wind",
}


@pytest.fixture(scope="module")
def validate(root):
    """The command's module; the pictures go nowhere."""
    patch = pytest.MonkeyPatch()
    patch.syspath_prepend(str(root / "docs" / "generators" / "validation"))
    import common
    import validate

    patch.setattr(common, "PICTURES", None)
    yield validate
    patch.undo()


@pytest.fixture(scope="module")
def found(validate, shared, tmp_path_factory):
    """Numbers of the quick sections, computed now."""
    import common

    common.PICTURES = tmp_path_factory.mktemp("pictures")
    return validate.numbers(shared, validate.QUICK)


def sections(text):
    """Sections by title."""
    return {
        part.splitlines()[0].removeprefix("## "): part
        for part in re.split(r"(?m)^(?=## )", text)[1:]
    }


@pytest.mark.parametrize("name", TITLES)
def test_committed_page_holds_what_the_code_gives(validate, found, root, name):
    """Same words; numbers within 1 % or one unit of their last digit, for other machines' rounding."""
    page = sections((root / "docs" / "generated" / "validation.md").read_text(encoding="utf-8"))
    made = sections(validate.template())
    title = next(title for title in made if title.startswith(TITLES[name]))
    now = made[title].format_map(found)
    assert NUMBER.sub("#", page[title]) == NUMBER.sub("#", now), (
        "run docs/generators/validation/validate.py"
    )
    for old, new in zip(NUMBER.findall(page[title]), NUMBER.findall(now), strict=True):
        digit = 10.0 ** -len(old.partition("e")[0].partition(".")[2])
        exponent = 10.0 ** float(old.partition("e")[2] or 0)
        assert isclose(float(old), float(new), rel_tol=0.01, abs_tol=1.01 * digit * exponent), (
            old,
            new,
        )


def test_short_ship_ends_the_recorded_turn_where_the_parameter_sheet_found_it(found):
    assert found["turn"]["given_end"] == pytest.approx(3.3, abs=0.1)
    assert found["turn"]["given_end_heading"] == pytest.approx(1.7, abs=0.1)


def test_our_reading_of_the_log_is_that_of_the_parameter_sheet(found):
    """Speeds of the sheet, section 8.1, which someone else evaluated."""
    speeds = [found["trials"][f"trial_{rpm}"] for rpm in (110, 170, 205)]
    assert speeds == pytest.approx([7.25, 10.57, 11.87], rel=0.01)


def test_heading_and_positions_say_the_same_of_the_logs_clock(found):
    """Two independent pairs of channels; if they differed much, the clock would not be the cause."""
    assert found["trials"]["clock_low"] < 0.85
    assert found["trials"]["clock_agree"] < 0.05


def test_long_ship_is_where_the_acceptance_of_the_parameter_sheet_wants_it(found):
    """Steady diameter within 10 % on average and 15 % each, speed within 7 %."""
    trials = found["trials"]
    assert abs(trials["diameter_mean"]) < 10.0
    assert max(abs(trials["diameter_low"]), abs(trials["diameter_high"])) < 15.0
    assert max(abs(trials[f"off_{rpm}"]) for rpm in (110, 170, 205)) < 7.0


def test_power_under_way_is_that_of_a_ducted_propeller(found):
    """Within 10 % of the Ka series as the parameter sheet reads it; T V / P of the ship running free in 0.70 to 0.78.

    At the speeds of the trials it is 0.699 at 110 rpm, where the ship went faster than the model does, to 0.73.
    """
    units = found["units"]
    assert max(abs(units["power_low"]), abs(units["power_high"])) < 10.0
    assert 0.70 < units["share_free"] < 0.78
    assert 0.699 < units["share_low"] and units["share_high"] < 0.78


def test_the_command_says_what_is_missing(validate, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(validate, "SHARED", tmp_path / "shared")
    assert validate.main() == 2
    assert "needs its reference data" in capsys.readouterr().err
