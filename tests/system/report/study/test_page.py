"""The page of a study as a browser shows it, and what its views say."""

import threading

import numpy as np
import pandas as pd
import pytest
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from shipcosim.errors import Problem, ShipcosimError
from shipcosim.report.study import StudyTables, render
from shipcosim.report.study.page import page_of
from shipcosim.report.study.server import study_server


@pytest.fixture(scope="module")
def tables(study_of):
    return study_of(6)


@pytest.fixture(scope="module")
def file(tables, tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "report.html"
    path.write_text(render(tables), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def shown(tables):
    return page_of(tables)


@pytest.fixture
def page(shown_at, file):
    return shown_at(file, 1280)


def chosen(page):
    """Numbers of the chosen runs."""
    page.ask("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return set(page.ask("return Array.from(study.chosen, row => Math.round(study.runs[row]))"))


def drag(page, element, start, end):
    """Drag over a canvas from one place to another. [px]"""
    page.ask("arguments[0].scrollIntoView({block: 'center'})", element)
    half = [element.size["width"] / 2, element.size["height"] / 2]
    first, last = (
        [int(at - h) for at, h in zip(place, half, strict=True)] for place in (start, end)
    )
    moves = ActionChains(page.driver).move_to_element_with_offset(element, *first).click_and_hold()
    moves.move_to_element_with_offset(element, *last).release().perform()


# ---- what it says


def test_heading_says_what_it_found_with_numbers(shown, tables):
    summary = tables.summary
    worst = summary.loc[summary["excursion_90"].idxmax()]
    assert f"{worst['excursion_90']:.3g} m" in shown.outcome.sentence
    assert f"wind {worst['wind']:g} m/s, {worst['lost']}" in shown.outcome.sentence
    assert f"{(tables.runs['error'] != '').sum()} of 648 runs failed" in shown.outcome.sentence
    assert shown.outcome.word == "648 runs"


def test_failed_runs_are_listed_with_their_error(shown, tables):
    ((text, runs),) = shown.errors
    failed = tables.runs[tables.runs["error"] != ""]
    assert text == failed["error"].iloc[0] and len(runs) == len(failed)
    assert list(runs) == failed["run"].tolist()


def test_quantities_name_the_factor_that_they_vary_with(shown):
    rows = {row[0]: row for row in shown.quantities.rows}
    assert rows["power"][1] == "kW" and rows["power"][-1].startswith("wind (")
    assert "seed" not in rows["power"][-1] and "seed" not in rows["excursion"][-1]


def test_polar_is_the_table_with_bow_up_and_closed(shown, tables):
    (polar,) = (figure for figure in shown.plots if "polar" in figure.layout)
    axis = polar.layout["polar"]["angularaxis"]
    assert (axis["rotation"], axis["direction"]) == (90, "clockwise")
    curve = next(trace for trace in polar.traces if trace["name"] == "port lost")
    expected = tables.tables["worst"].query("lost == 'port lost'").sort_values("direction")
    assert curve["theta"] == [*range(0, 360, 30), 0]
    assert curve["r"][:-1] == pytest.approx(expected["excursion_90"].tolist(), rel=1e-4)
    static = next(trace for trace in polar.traces if trace["name"] == "static")
    assert (
        static["line"]["color"]
        == next(t for t in polar.traces if t["name"] == "intact")["line"]["color"]
    )


def test_distribution_counts_runs_that_never_get_there_and_leaves_failed_ones_out(shown, tables):
    figure = next(figure for figure in shown.plots if "time_to_3_m" in figure.title)
    curve = next(trace for trace in figure.traces if trace["name"] == "port lost")
    runs = tables.runs.query("lost == 'port lost' and error == ''")
    assert curve["y"][-1] == pytest.approx(runs["time_to_3_m"].notna().mean(), rel=1e-4)


def test_bars_have_the_intervals_of_their_table(shown):
    figure = next(figure for figure in shown.plots if figure.traces[0]["type"] == "bar")
    first, total = figure.traces
    assert (first["name"], total["name"]) == ("first_order", "total")
    assert first["x"] == [0.42, 0.2, 0.11, 0.02] and first["error_x"]["array"] == pytest.approx(
        [0.05] * 4
    )


def test_means_of_runs_have_a_named_interval(tables):
    view = {"kind": "bars", "category": "wind", "value": "held", "series": "lost", "table": "runs"}
    figure = page_of(with_views(tables, view)).plots[0]
    assert "Wilson" in figure.note
    some = tables.runs.query("wind == 12 and lost == 'port lost'")["held"].dropna()
    assert figure.traces[2]["x"][2] == pytest.approx(some.astype(float).mean(), rel=1e-4)


def test_front_of_what_shall_be_large_is_at_the_other_end(tables):
    view = {"kind": "pareto", "quantities": ["excursion", "power"], "largest": ["power"]}
    front = page_of(with_views(tables, view)).plots[0].traces[1]
    assert front["y"][-1] == pytest.approx(tables.runs["power"].max() / 1e3, rel=1e-4)
    assert np.all(np.diff(front["x"]) >= 0) and np.all(np.diff(front["y"]) >= 0)


def test_tracks_are_counted_beyond_their_circles(shown, tables):
    (view,) = shown.tracks
    intact = tables.runs.query("lost == 'intact'")["run"]
    tracks = tables.tracks[tables.tracks["run"].isin(intact)]
    start = tracks.groupby("run")[["vessel.x", "vessel.y"]].transform("first")
    distance = np.hypot(
        tracks["vessel.x"] - start["vessel.x"], tracks["vessel.y"] - start["vessel.y"]
    )
    farthest = distance.groupby(tracks["run"]).max()
    found = view.data["series"][0]
    assert found["label"] == "intact" and found["count"] == tracks["run"].nunique()
    assert [shares[-1] for shares in found["beyond"]] == pytest.approx(
        [(farthest > r).mean() for r in (5, 10, 25)], abs=1e-3
    )
    assert sum(found["cells"]) == len(tracks)
    assert max(view.data["hull"][0]) == pytest.approx(33.9 / 2) and view.data["toScale"]


def with_views(made, *views, **parts):
    """The study with other views, and other tables."""
    about = {**made.about, "study": {**made.study, "view": list(views)}}
    return StudyTables(**vars(made) | {"about": about} | parts)


def test_view_that_cannot_be_drawn_says_why_and_the_others_are(tables):
    bad = [
        {"kind": "polar", "angle": "directon", "radius": "excursion_90"},
        {"kind": "bars", "category": "lost", "value": "held", "table": "nothing"},
        {"kind": "pareto", "quantities": ["excursion"]},
        {"kind": "sunburst"},
    ]
    good = {"kind": "scatter", "x": "current", "y": "excursion"}
    page = page_of(with_views(tables, *bad, good))
    assert len(page.plots) == 1 and len(page.remarks) == 4
    assert "no column 'directon'" in page.remarks[0] and "no table 'nothing'" in page.remarks[1]
    bare = page_of(with_views(tables, {"kind": "tracks"}, tracks=None))
    assert "No tracks were kept" in bare.remarks[0]


def test_same_study_makes_the_same_page(study_of, file, tmp_path):
    (tmp_path / "again.html").write_text(render(study_of(6)), encoding="utf-8")
    assert (tmp_path / "again.html").read_bytes() == file.read_bytes()


# ---- how it looks


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (500, "dark")])
def test_everything_is_drawn_and_no_text_lies_over_another(shown_at, file, width, scheme):
    page = shown_at(file, width, scheme)
    assert page.errors() == [] and page.requests() == []
    places, drawn = page.ask(
        "return ['.plot', '.plot.js-plotly-plot'].map(s => document.querySelectorAll(s).length)"
    )
    assert places == drawn == 6
    assert (
        page.collisions() == [] and page.ask("return document.documentElement.scrollWidth") <= width
    )
    assert page.ask(CANVAS_COLLISIONS) == []


CANVAS_COLLISIONS = """
const found = [];
for (const boxes of Object.values(study.boxes)) boxes.forEach((a, k) => boxes.slice(k + 1).forEach((b) => {
  const apart = a.right - 2 < b.left || b.right - 2 < a.left || a.bottom - 2 < b.top || b.bottom - 2 < a.top;
  if (!apart) found.push([a.text, b.text]);
}));
const names = [...document.querySelectorAll("#parallel .axes span")].map((e) => e.getBoundingClientRect());
names.slice(1).forEach((box, k) => { if (names[k].right > box.left + 1) found.push("names of axes"); });
return found;
"""


def test_page_is_small(file):
    assert file.stat().st_size < 1.0e6


def test_canvases_turn_dark_and_are_light_on_paper(shown_at, file):
    page = shown_at(file, 1280, "dark")
    ink = "const c = document.getElementById('scatter'); return report.colour('card')"
    assert page.ask(ink) == "#182028"
    before = page.ask("return document.querySelector('#parallel canvas').toDataURL()")
    page.ask("dispatchEvent(new Event('beforeprint'))")
    paper = page.ask("return document.querySelector('#parallel canvas').toDataURL()")
    assert paper != before and page.ask(ink) == "#ffffff"
    page.ask("dispatchEvent(new Event('afterprint'))")
    page.wait("return document.body.dataset.drawn === 'all'")
    assert page.ask(ink) == "#182028"


def test_texts_from_files_stay_texts(tables, browse, tmp_path):
    evil = "<img src=x onerror=\"document.title='owned'\">"
    runs = tables.runs.copy()
    runs["lost"] = runs["lost"].replace("intact", evil)
    runs["error"] = runs["error"].where(runs["error"] == "", evil)
    study = {**tables.study, "description": evil, "factor": [{"name": evil, "values": [evil]}]}
    hostile = StudyTables(
        **vars(tables)
        | {
            "runs": runs,
            "about": {**tables.about, "study": study},
            "command": f"shipcosim sweep {evil}",
        }
    )
    (tmp_path / "evil.html").write_text(render(hostile), encoding="utf-8")
    page = browse(tmp_path / "evil.html")
    page.ask("study.show(0)")
    assert page.errors() == [] and page.ask("return document.images.length") == 0
    assert (
        page.text("h1") == evil
        and evil in page.text("#run")
        and "owned" != page.ask("return document.title")
    )


# ---- choosing runs


def test_drag_along_an_axis_chooses_a_range_in_table_lines_and_dots(page, tables):
    axis = next(one for one in page.ask("return study.axes()") if one["name"] == "excursion")
    canvas = page.driver.find_element(By.CSS_SELECTOR, "#parallel canvas")
    middle = (axis["top"] + axis["bottom"]) / 2
    drag(page, canvas, (axis["x"], middle), (axis["x"], axis["top"] - 2))
    low = page.ask("return study.ranges.get('excursion')")[0]
    expected = set(tables.runs["run"][tables.runs["excursion"] >= low])
    assert chosen(page) == expected and 0 < len(expected) < 100
    assert page.text("#count") == f"{len(expected)} of 648 runs are chosen"
    assert page.ask("return +document.getElementById('rows').getAttribute('aria-rowcount')") == len(
        expected
    )
    ActionChains(page.driver).move_to_element_with_offset(
        canvas, int(axis["x"] - canvas.size["width"] / 2), 0
    ).click().perform()
    assert len(chosen(page)) == 648


def test_drag_over_dots_chooses_on_both_axes(page, tables):
    page.ask(
        "for (const [id, v] of [['across', 'current'], ['up', 'power']]) {"
        " const s = document.getElementById(id); s.value = v; s.dispatchEvent(new Event('change')); }"
    )
    canvas = page.driver.find_element(By.ID, "scatter")
    drag(page, canvas, (120, 60), (380, 220))
    ranges = dict(page.ask("return [...study.ranges]"))
    a, b = ranges["current"]
    c, d = (1e3 * end for end in ranges["power"])
    expected = set(tables.runs.query("@a <= current <= @b and @c <= power <= @d")["run"])
    found = chosen(page)
    assert (
        0 < len(expected) < 648 and len(found ^ expected) <= 2
    )  # the page holds powers to a ten-thousandth
    page.driver.find_element(By.ID, "all").click()
    assert len(chosen(page)) == 648


def test_levels_filter_and_the_quantities_follow(page, tables):
    page.ask("document.querySelector('.filters').open = true")
    for text in ("bow lost", "port lost"):
        page.driver.find_element(By.XPATH, f"//button[@data-level and text()='{text}']").click()
    page.driver.find_element(By.XPATH, "//div[@data-column='wind']//button[text()='12']").click()
    some = tables.runs.query("lost != 'intact' and wind == 12")
    assert chosen(page) == set(some["run"])
    row = page.ask(
        "return [...document.querySelectorAll('#quantities tr')].map(r => [...r.cells].map(c => c.innerText))"
    )
    found = {cells[0]: cells[1:] for cells in row}
    assert float(found["excursion [m]"][0]) == pytest.approx(some["excursion"].median(), abs=0.01)
    assert found["held"][0] == f"{100 * some['held'].dropna().astype(bool).mean():.0f} % yes"


def test_table_sorts_both_ways_with_what_has_no_value_last(page, tables):
    head = page.driver.find_element(
        By.XPATH, "//table[@id='rows']//th/button[starts-with(text(), 'time_to_3_m')]"
    )
    first = "return document.querySelector('#rows tr[data-row] button').innerText"
    page.ask("arguments[0].scrollIntoView({block: 'center'})", head)
    head.click()
    assert int(page.ask(first)) == tables.runs.loc[tables.runs["time_to_3_m"].idxmin(), "run"]
    head = page.driver.find_element(
        By.XPATH, "//table[@id='rows']//th/button[starts-with(text(), 'time_to_3_m')]"
    )
    head.click()
    assert int(page.ask(first)) == tables.runs.loc[tables.runs["time_to_3_m"].idxmax(), "run"]


def test_row_shows_its_command_which_can_be_copied_and_its_page_where_there_is_one(page):
    page.ask("document.querySelectorAll('#rows tr[data-row]')[2].children[1].click()")
    assert "shipcosim sweep dp_weather --run 3" in page.text("#run") and "Run 3" in page.text(
        "#run"
    )
    assert page.ask("return document.querySelector('#run a')") is None
    page.ask("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.driver.find_element(By.XPATH, "//div[@id='run']//button[text()='Copy']").click()
    page.wait("return window.copied === 'shipcosim sweep dp_weather --run 3'")
    page.ask("document.querySelectorAll('#rows tr[data-row]')[3].children[1].click()")
    assert (
        page.ask("return document.querySelector('#run a').getAttribute('href')")
        == "run-4/report.html"
    )


def test_failed_run_shows_its_error(page, shown):
    page.driver.find_element(By.CSS_SELECTOR, "#failed button[data-run]").click()
    assert shown.errors[0][0] in page.text("#run") and f"Run {shown.errors[0][1][0]}" in page.text(
        "#run"
    )


# ---- many runs


@pytest.fixture(scope="module")
def large(study_of, tmp_path_factory):
    path = tmp_path_factory.mktemp("large") / "report.html"
    path.write_text(render(study_of(300, with_tracks=False)), encoding="utf-8")
    return path


def test_tens_of_thousands_of_runs_do_not_freeze_the_page(large, shown_at):
    page = shown_at(large, 1280)
    assert large.stat().st_size < 1.6e6
    assert page.ask("return study.count") == 32_400
    assert page.ask("return document.querySelectorAll('#rows tr').length") < 60
    page.wait("return !study.moving && study.lines === 3000")
    page.ask("document.querySelector('.rows-scroll').scrollTop = 1e9")
    page.ask("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert page.ask(
        "return [...document.querySelectorAll('#rows tr[data-row]')].pop().dataset.row"
    ) == str(page.ask("return study.count - 1"))


def test_page_without_room_for_all_keeps_failed_runs_and_says_what_it_lacks(
    tables, tmp_path, browse, monkeypatch
):
    monkeypatch.setattr("shipcosim.report.study.page.BYTES_FOR_RUNS", 4000)
    (tmp_path / "thin.html").write_text(render(tables), encoding="utf-8")
    page = browse(tmp_path / "thin.html")
    assert "holds 500 of 648 runs" in page.text("#thinning")
    failed = tables.runs["run"][tables.runs["error"] != ""].tolist()
    assert page.ask("return report.data.failed.map((row) => study.runs[row])") == failed
    assert page.text(".rows tbody tr:nth-child(2)").split()[:4] == ["power", "kW", "52.6", "100"], (
        "of all runs"
    )


# ---- odd studies


@pytest.mark.parametrize("count", [0, 1, 2])
def test_studies_of_hardly_any_run_have_a_page(study_of, browse, tmp_path, count):
    tables = study_of(1)
    few = {
        "runs": tables.runs.head(count),
        "summary": tables.summary.head(0),
        "tracks": None,
        "tables": {},
    }
    (tmp_path / "few.html").write_text(
        render(with_views(tables, *tables.study["view"], **few)), encoding="utf-8"
    )
    page = browse(tmp_path / "few.html")
    assert page.errors() == [] and page.text("#count") == f"{count} of {count} runs are chosen"


def test_study_whose_runs_all_failed_has_a_page(study_of, browse, tmp_path):
    tables = study_of(1)
    runs = tables.runs.assign(
        error="vessel: no", excursion=np.nan, power=np.nan, time_to_3_m=np.nan, held=None
    )
    (tmp_path / "failed.html").write_text(
        render(with_views(tables, runs=runs, summary=pd.DataFrame())), encoding="utf-8"
    )
    page = browse(tmp_path / "failed.html")
    assert page.errors() == [] and "108 of 108 runs failed" in page.text("#verdict")


# ---- with a server


@pytest.fixture
def served(file):
    """A server whose simulations leave a small page; run 2 fails."""

    def simulate(run):
        if run == 2:
            raise ShipcosimError(
                Problem("vessel", "step to 312.4 s failed.", "Choose a shorter step.")
            )
        folder = file.parent / f"run-{run}"
        folder.mkdir(exist_ok=True)
        (folder / "report.html").write_text(f"<title>Page of run {run}</title>")

    server = study_server(file.parent, range(1, 649), simulate)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
    thread.start()
    yield server
    server.shutdown()
    server.server_close()


def test_one_click_simulates_a_run_and_opens_its_page(chromium, served):
    chromium.get(served.url)
    page = BrowserPage(chromium)
    page.wait("return document.body.dataset.server === 'yes'")
    here = chromium.current_window_handle
    page.ask("document.querySelector('.rows-scroll').scrollIntoView({block: 'center'})")
    chromium.find_element(By.CSS_SELECTOR, "#rows button[data-run='7']").click()
    page.wait("return document.querySelector('#run .state').innerText === 'Run 7 is simulated.'")
    (other,) = {*chromium.window_handles} - {here}
    chromium.switch_to.window(other)
    page.wait("return document.title === 'Page of run 7'")
    chromium.close()
    chromium.switch_to.window(here)
    chromium.find_element(By.CSS_SELECTOR, "#rows button[data-run='2']").click()
    page.wait(
        "return document.querySelector('#run .state').innerText.includes('step to 312.4 s failed')"
    )
    assert chromium.window_handles == [here]
    severe = [
        entry["message"] for entry in chromium.get_log("browser") if entry["level"] == "SEVERE"
    ]
    assert all("run/2" in message for message in severe), "nothing but the run that failed"


class BrowserPage:
    """What the tests of a served page ask."""

    def __init__(self, driver):
        self.ask = driver.execute_script

    def wait(self, script):
        from selenium.webdriver.support.ui import WebDriverWait

        WebDriverWait(self, 20.0).until(lambda page: page.ask(script))
