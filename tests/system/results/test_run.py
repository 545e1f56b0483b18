"""A run as Python gives it back: read like its table, judged, drawn, and nothing written unless asked."""

import copy
import pickle
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray

import shipcosim as sc
from shipcosim.scenario import Event

SHORT = {"stop_time": 10.0, "output_interval": 0.5}


@pytest.fixture(scope="module")
def gust():
    return sc.run("gust", **SHORT)


@pytest.fixture
def empty(tmp_path, monkeypatch):
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def texts(picture):
    """All texts in a picture."""
    return [element.text for element in ElementTree.fromstring(picture.svg).iter() if element.text]


def test_a_scenario_runs_by_its_name_in_an_empty_folder_and_writes_nothing(empty):
    found = sc.run("gust", stop_time="0.1 min", until="1000 ms")
    assert found["time"].values[-1] == 1.0
    assert found.name == "gust" and found.table["time"].values[-1] == 1.0
    assert list(empty.iterdir()) == []


def test_out_gets_what_the_command_writes(empty):
    found = sc.run("gust", stop_time=1.0, out="results/gust")
    assert {path.name for path in Path("results/gust").iterdir()} == {
        "result.nc",
        "result.csv",
        "report.html",
        "predictions.csv",
        "verdict.json",
    }
    assert sc.read_table("results/gust/result.nc").equals(found.table)


def test_a_run_reads_like_its_table(gust):
    table = gust.table
    assert isinstance(table, xarray.Dataset)
    assert gust["vessel.x"].identical(table["vessel.x"]) and gust[["vessel.x"]].identical(
        table[["vessel.x"]]
    )
    assert gust.sizes == table.sizes and list(gust) == list(table) and len(gust) == len(table)
    assert "vessel.x" in gust and "vessel.nothing" not in gust
    assert gust.sel(time=5.0).identical(table.sel(time=5.0)) and gust.attrs == table.attrs
    with pytest.raises(AttributeError, match="'Dataset' object has no attribute 'vesel'"):
        gust.vesel  # noqa: B018
    with pytest.raises(sc.ShipcosimError, match="vesel.x: It is no signal .* mean 'vessel.x'"):
        gust["vesel.x"]


def test_functions_on_tables_take_a_run(gust, tmp_path):
    sc.write_table(gust, tmp_path / "gust.nc")
    sc.write_report(gust, tmp_path / "gust.html")
    assert sc.read_table(tmp_path / "gust.nc").equals(gust.table)
    assert sc.judge(gust, gust.scenario.model_copy(update={"expect": []})) == []


def test_a_run_can_be_copied(gust):
    assert copy.copy(gust).table is gust.table
    with pytest.raises(AttributeError):
        object.__new__(sc.Run).anything  # noqa: B018
    assert pickle.loads(pickle.dumps(gust.table)).equals(gust.table)


def test_text_of_a_picture_in_a_card_is_as_large_as_that_of_the_card(gust):
    """The picture is shown 400 px wide: its letters were 6 px high."""
    pytest.importorskip("matplotlib")
    sizes = {
        where: max(float(size) for size in re.findall(r"font-size: ([\d.]+)px", svg))
        for where, svg in (("card", gust._card().picture), ("alone", gust.track().svg))
    }
    width = float(re.search(r'<svg [^>]*width="([\d.]+)pt', gust._card().picture)[1])
    assert sizes["card"] * 400 / width == pytest.approx(11.0, rel=0.05)
    assert sizes["alone"] == pytest.approx(8.25)


def test_pandas_has_the_signals_over_time(gust):
    frame = gust.to_pandas()
    assert frame.index.name == "time"
    assert frame["vessel.psi [rad]"].to_numpy() == pytest.approx(gust["vessel.psi"].values)


def test_expectations_are_judged_as_the_scenario_says(tmp_path):
    text = (
        Path(sc.read_scenario("gust").path).read_text(encoding="utf-8").partition("[[expect]]")[0]
    )
    limits = '[[expect]]\nsignal = "vessel.x"\nat_most = {}\n'
    (tmp_path / "own.toml").write_text(
        text + limits.format("100.0") + limits.format("-100.0"), encoding="utf-8"
    )
    found = sc.run(tmp_path / "own.toml", **SHORT)
    assert [one.passed for one in found.expectations] == [True, False]
    assert not found.passed and "FAIL. 1 of 2 expectations missed." in repr(found)
    assert "FAILS" in found._repr_html_()


def test_expectations_beyond_a_shortened_run_are_told_and_not_judged(gust):
    assert gust.expectations == () and len(gust.not_judged) == 4
    assert gust._repr_html_().count("Not reached: ") == 4


def test_start_values_events_and_sets_go_over_the_scenarios(tmp_path):
    values = [sc.parameter("environment.wind_speed", 9.0), sc.parameter("no.where", 1.0)]
    sc.write_ssv(tmp_path / "wind.ssv", "wind", values)
    events = [{"time": 0.5, "override": {"tunnel.failed": True}}]
    found = sc.run(
        "gust",
        stop_time=1.0,
        set={"environment.seed": 7},
        parameters=tmp_path / "wind.ssv",
        events=events,
    )
    assert (
        found.scenario.set["environment.wind_speed"] == 9.0
        and found.scenario.set["environment.seed"] == 7
    )
    assert not found["tunnel.failed"][0] and found["tunnel.failed"][-1]
    assert any("no.where" in str(remark) for remark in found.remarks)


def test_signals_are_drawn_by_component_connector_and_pattern(gust):
    controller = texts(gust.plot("controller"))
    assert "tau_X_cmd" in controller and "controller [kN]" in controller
    assert {"port.thrust", "starboard.thrust", "tunnel.thrust"} <= set(texts(gust.plot("thrust")))
    assert {"tau_wind_X", "tau_hull_X"} <= set(texts(gust.plot("vessel.tau_*_X")))
    assert {"x", "y", "psi"} <= set(texts(gust.plot()))


def test_a_curve_goes_through_its_values(gust):
    """The surge speed, the least drawn lowest; points on a straight line may be left out."""
    drawing = ElementTree.fromstring(gust.plot("vessel.u").svg)
    lines = [e.get("d") for e in drawing.iter() if e.get("style", "").startswith("fill: none")]
    curve = max(lines, key=len)
    points = np.array(curve.replace("M", "").replace("L", "").split(), float).reshape(-1, 2)
    places = np.linspace(points[0, 0], points[-1, 0], gust.sizes["time"])
    drawn = np.interp(places, points[:, 0], points[:, 1])
    assert np.corrcoef(drawn, -gust["vessel.u"].values)[0, 1] > 0.9999


def test_a_picture_is_the_same_each_time_and_needs_matplotlib(gust, monkeypatch):
    assert gust.track().svg == gust.track().svg
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(sc.ShipcosimError, match=r"pip install 'shipcosim\[notebook\]'"):
        gust.track()


def test_a_card_without_matplotlib_shows_its_text_and_what_to_install(gust, monkeypatch):
    monkeypatch.setattr("shipcosim.report.notebook.card.can_draw", lambda: False)
    card = gust._repr_html_()
    assert "gunnerus_dp" in card and "<img" not in card and "shipcosim[notebook]" in card


def test_more_signals_than_can_be_seen_are_counted(gust):
    assert "more panels are not drawn: name fewer signals." in " ".join(texts(gust.plot("*")))


def test_an_unknown_signal_is_said_with_what_there_is(gust):
    with pytest.raises(sc.ShipcosimError, match="Did you mean 'controller'?"):
        gust.plot("contoller")
    with pytest.raises(sc.ShipcosimError, match="Did you mean 'vessel.psi'?"):
        gust.plot("vessel.psy")


def test_the_track_shows_where_she_was_to_be(gust):
    svg = gust.track().svg
    ElementTree.fromstring(svg)
    assert "end filled" in svg and "reference" in svg


def test_a_system_without_a_ship_has_no_track(tmp_path):
    table = xarray.Dataset({"a.b": ("time", [1.0, 2.0], {"units": "m"})}, {"time": [0.0, 1.0]})
    run = sc.Run(
        table, sc.Scenario(stop_time=1.0, step_size=1.0), sc.read("gunnerus_open").checked()
    )
    with pytest.raises(sc.ShipcosimError, match="Nothing here is a ship"):
        run.track()
    assert "<img" not in run._repr_html_() and "b" in texts(run.plot())


def test_the_card_says_what_ran_and_escapes_what_users_write(gust):
    from dataclasses import replace

    shown = replace(
        gust, scenario=gust.scenario.model_copy(update={"description": "<script>alert(1)</script>"})
    )
    assert "<script" not in shown._repr_html_() and "gunnerus_dp" in shown._repr_html_()


def test_the_page_is_that_of_the_command_and_shown_in_a_frame(gust, tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    page = gust.page()
    assert page.html.startswith("<!doctype html>") or page.html.startswith("<!DOCTYPE html>")
    assert page._repr_html_().startswith('<iframe srcdoc="') and "<script" not in page._repr_html_()
    assert page.save(tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    path = page.open()
    assert opened == [path.as_uri()]
    path.unlink()


REFUSED = {
    "keyword": (
        {"scenario": "gust", "stp_time": 3.0},
        "no keyword 'stp_time'.* Did you mean 'stop_time'",
    ),
    "nothing": ({}, "run\\(\\): Missing a required argument: 'scenario'"),
    "name": ({"scenario": "gsut"}, "There is no such scenario file.* Did you mean 'gust'"),
    "number": ({"scenario": 3}, "scenario = 3. Give a path or name or a Scenario"),
    "set": ({"scenario": "gust", "set": 3}, "set = 3"),
    "until": ({"scenario": "gust", "until": "5 kn"}, "until: '5 kn' is in kn"),
    "text": ({"scenario": "gust", "stop_time": "long"}, "stop_time = 'long'"),
    "key": ({"scenario": "gust", "events": [{"tim": 1.0}]}, "tim: There is no such key"),
    "value": ({"scenario": "gust", "set": {"vessel.mas": 1.0}}, "Did you mean 'mass'"),
    "fmus": ({"scenario": "gust", "fmus": ["none"]}, "There is no folder 'none'"),
    "bytes": ({"scenario": b"gust"}, "scenario = b'gust'. Give a path or name"),
    "empty": ({"scenario": ""}, "scenario = ''. Give a path or name"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_used_is_one_error_without_a_wall(case):
    keywords, words = REFUSED[case]
    with pytest.raises(sc.ShipcosimError, match=words) as caught:
        sc.run(**keywords)
    assert "pydantic" not in str(caught.value) and len(str(caught.value)) < 1000


@pytest.mark.parametrize("wrong", [3, 2.5, None, True, b"out", [], {}, "", ["a", "b"], object()])
def test_saving_to_what_is_no_path_is_one_error(gust, wrong):
    for save in (gust.save, gust.save_part, gust.page().save, gust.plot().save):
        with pytest.raises(
            sc.ShipcosimError, match=r"save(_part)?\(\): (folder|path) = .*Give a path or name"
        ):
            save(wrong)
    with pytest.raises(sc.ShipcosimError, match="There is no keyword 'overwrite'"):
        gust.save("out", overwrite=True)
    with pytest.raises(sc.ShipcosimError, match="Missing a required argument: 'folder'"):
        gust.save()


def test_none_is_as_good_as_left_out_wherever_there_is_a_default():
    assert (
        sc.simulate("gunnerus_open", None, stop_time=0.1, set=None, strict=None).name
        == "gunnerus_open"
    )
    with pytest.raises(sc.ShipcosimError, match="scenario = None. Give a path"):
        sc.run(None)
    with pytest.raises(sc.ShipcosimError, match="scenario = None. Give a path"):
        sc.run(scenario=None)


@pytest.mark.parametrize(
    ("record", "keywords", "words"),
    [
        (
            sc.Scenario,
            {"stop_time": -1.0, "step_size": 0.1},
            "Scenario\\(\\): stop_time = -1.0. Input should be greater",
        ),
        (sc.Scenario, {"stop_time": 1.0, "step": 0.1}, "step: There is no such key"),
        (
            sc.Scenario,
            {"stop_time": 1.0, "step_size": 0.1, "events": [{"time": 0.0}]},
            "The event does nothing",
        ),
        (Event, {"override": {"a.b": 1.0}}, "time is missing"),
    ],
)
def test_a_record_that_a_script_makes_wrong_is_one_error_too(record, keywords, words):
    with pytest.raises(sc.ShipcosimError, match=words) as caught:
        record(**keywords)
    assert "pydantic" not in str(caught.value)


def test_a_notebook_shows_the_problems_and_no_traceback():
    error = sc.ShipcosimError(
        [sc.Problem("a.toml, line 3", "x is wrong.", "Right is y."), sc.Problem("", "and z.")]
    )
    shown = error._render_traceback_()
    assert [line.strip() for line in shown[1:]] == [
        "a.toml, line 3: x is wrong. Right is y.",
        "and z.",
    ]
    assert "ShipcosimError: 2 problems" in shown[0]
