"""The page of a capability says what was computed, how it is to be read, and what it rests on."""

import re

import pytest

from shipcosim.capability import capability_of, notation, read_vessel
from shipcosim.capability.conditions import CONDITIONS
from shipcosim.library import build_stale
from shipcosim.report.capability.page import render
from shipcosim.ships import read_ship
from shipcosim.ssp import read_system


@pytest.fixture(scope="module")
def capability(root):
    system = read_system(root / "ssp" / "gunnerus_dp", fmus=[build_stale(root)])
    return capability_of(read_vessel(system, read_ship(root / "ssp" / "ships" / "gunnerus-33m9")))


@pytest.fixture(scope="module")
def file(capability, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(render(capability), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def page(file):
    return file.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def figures(page, data_of):
    return data_of(page)


def test_notation_conditions_and_origin_are_on_the_page(page, capability):
    assert notation(capability) in page
    for condition in CONDITIONS:
        assert f">{condition.wind_speed:g} m/s<" in page
    assert (
        "from memory" in page and "student implementation" in page and "no class document" in page
    )


def test_bow_is_up_and_directions_go_clockwise(figures):
    polar = figures[0]["layout"]["polar"]["angularaxis"]
    assert (polar["rotation"], polar["direction"]) == (90, "clockwise")


def test_curves_are_the_numbers_and_closed(figures, capability):
    intact, single, worst = figures[0]["data"]
    assert intact["theta"][0] == 0.0 and intact["theta"][-1] == 360.0
    assert (
        intact["r"][:-1] == capability.numbers()[0].tolist() and intact["r"][-1] == intact["r"][0]
    )
    assert single["r"][:-1] == capability.worst(most_lost=1).tolist()
    assert worst["r"][:-1] == capability.worst().tolist()


def test_every_direction_and_assumed_particular_is_in_a_table(page):
    assert len(re.findall(r"<tr><td class=\"tight\">\d+°</td>", page)) == 36
    assert "assumed: length times draught" in page


@pytest.mark.parametrize("width", [1280, 500])
def test_every_figure_is_drawn_and_no_text_lies_over_another(shown_at, file, width):
    page = shown_at(file, width)
    assert page.errors() == [] and page.requests() == []
    places, drawn = page.ask(
        "return ['.plot', '.plot.js-plotly-plot'].map(s => document.querySelectorAll(s).length)"
    )
    assert places == drawn == 4
    assert (
        page.collisions() == [] and page.ask("return document.documentElement.scrollWidth") <= width
    )


def test_page_is_small(file):
    assert file.stat().st_size < 1.5e6


PAPER = "return [...document.querySelectorAll('.plot')].map(p => p._fullLayout.paper_bgcolor)"
LIGHT, DARK = "#ffffff", "#182028"


def test_the_switch_turns_page_and_figures_and_the_next_page_remembers(shown_at, file):
    page = shown_at(file, 1280, "light")
    assert set(page.ask(PAPER)) == {LIGHT} and page.text("#scheme") == "Dark"
    page.ask("document.getElementById('scheme').click()")
    page.wait("return document.body.dataset.drawn === 'all'")
    assert set(page.ask(PAPER)) == {DARK} and page.text("#scheme") == "Light"
    again = shown_at(file, 1280, "light")
    assert set(again.ask(PAPER)) == {DARK}
    again.ask("document.getElementById('scheme').click()")
    assert set(shown_at(file, 1280, "dark").ask(PAPER)) == {DARK}, "the system is followed again"


def test_paper_is_light_and_the_screen_is_dark_again_afterwards(shown_at, file):
    page = shown_at(file, 500, "dark")
    page.ask("dispatchEvent(new Event('beforeprint'))")
    assert set(page.ask(PAPER)) == {LIGHT}, "at once: nobody waits for paper"
    widths = page.ask(
        "return [...document.querySelectorAll('.plot')].map(p => [p.clientWidth, p._fullLayout.width])"
    )
    assert all(place == drawn > 500 for place, drawn in widths), (
        "as wide as paper, not as the screen"
    )
    page.ask("dispatchEvent(new Event('afterprint'))")
    page.wait("return document.body.dataset.drawn === 'all'")
    assert set(page.ask(PAPER)) == {DARK}
