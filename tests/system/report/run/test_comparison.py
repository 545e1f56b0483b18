"""Two runs on one page: both drawn, laid over each other in time, and their differences said."""

import json

import numpy as np
import pytest
import xarray as xr

import shipcosim
from shipcosim.errors import ShipcosimError
from shipcosim.report.run.comparison import compared, differences, lay_over
from shipcosim.results.comparison import RunComparison
from shipcosim.series import make_table


def boat(north=0.0, turn=0.0, start=0.0, stop=100.0, **start_values):
    """A boat that sails 1 m/s north, set off to the side and turned."""
    time = np.arange(start, stop + 0.25, 0.5)
    signals = {
        "boat.x": (time + north, "m"),
        "boat.y": (0.0 * time, "m"),
        "boat.psi": (np.radians(turn) + 0.0 * time, "rad"),
        "bow.thrust": (1000.0 + 10.0 * time, "N"),
        "bow.rpm": (0.0 * time + 50.0, "rpm"),
    }
    table = xr.Dataset(
        {k: ("time", v, {"units": u}) for k, (v, u) in signals.items()}, {"time": time}
    )
    known = {"boat.length": 20.0, "boat.breadth": 5.0} | start_values
    return table.assign_attrs(start_values=json.dumps(known))


def write_comparison(tables, names, path):
    """Write the page of two runs; return what it says first, and the differences."""
    comparison = compared(tables, names)
    RunComparison(names, tables).page().save(path)
    return comparison.page.outcome, comparison.differences


def test_two_runs_give_two_outlines_each_in_its_colour(browse, tmp_path):
    write_comparison(
        (boat(), boat(north=3.0, turn=10.0)), ("calm", "windy"), tmp_path / "report.html"
    )
    page = browse(tmp_path / "report.html")
    items = page.ask(
        "scene.time = 40; scene.paint(); return scene.drawn.filter(item => item.what === 'hull')"
    )
    hulls = {item["run"]: item for item in items}
    assert hulls["calm"]["position"] == pytest.approx([40.0, 0.0], abs=0.02)
    assert hulls["windy"]["position"] == pytest.approx([43.0, 0.0], abs=0.02)
    assert hulls["windy"]["heading"] == pytest.approx(10.0, abs=0.05)
    assert hulls["calm"]["colour"] != hulls["windy"]["colour"]
    assert page.panels()["North [m]"] == ["calm", "windy"]
    assert "3.00 m apart" in page.text("#verdict")
    # What stays the same in both is said with both values.
    assert "Heading 0 deg calm, 10 deg windy" in page.text(".constant")
    assert page.errors() == []


def test_differences_are_those_between_the_runs_and_the_largest_is_found():
    other = boat(north=3.0)
    other["boat.y"][120] = 7.0
    found = {one.signal: one for one in differences(lay_over((boat(), other), ("a", "b")))}
    assert set(found) == {"boat.x", "boat.y"}
    assert (found["boat.x"].rms, found["boat.x"].largest) == (
        pytest.approx(3.0),
        pytest.approx(3.0),
    )
    assert (found["boat.y"].largest, found["boat.y"].time) == (7.0, 60.0)


def test_angles_differ_the_short_way_round():
    (one,) = differences(lay_over((boat(turn=179.0), boat(turn=-179.0)), ("a", "b")))
    assert one.signal == "boat.psi" and one.largest == pytest.approx(2.0)


def test_same_run_does_not_differ(tmp_path):
    outcome, found = write_comparison((boat(), boat()), ("a", "b"), tmp_path / "report.html")
    assert outcome.word == "SAME" and found == []


def test_other_steps_and_units_do_not_make_a_difference():
    """A straight line sampled elsewhere is the same line; thrust in kN is that in N."""
    coarse = boat().isel(time=slice(None, None, 4))
    coarse["bow.thrust"] = coarse["bow.thrust"] / 1000.0
    coarse["bow.thrust"].attrs["units"] = "kN"
    assert differences(lay_over((boat(), coarse), ("a", "b"))) == []


def test_runs_of_other_lengths_are_compared_where_both_are(tmp_path):
    pair = lay_over((boat(), boat(stop=60.0)), ("long", "short"))
    assert np.isnan(pair.shown[1]["boat.x"].values[-1]) and differences(pair) == []


def test_runs_without_a_common_time_start_together_and_the_page_says_so(browse, tmp_path):
    write_comparison(
        (boat(), boat(start=500.0, stop=600.0)), ("first", "later"), tmp_path / "report.html"
    )
    page = browse(tmp_path / "report.html")
    assert "later is moved by -500 s" in page.text("#remarks")
    hulls = page.ask(
        "scene.time = 20; scene.paint(); return scene.drawn.filter(item => item.what === 'hull')"
    )
    assert [hull["position"][0] for hull in hulls] == pytest.approx([20.0, 520.0], abs=0.02)


def test_a_time_may_be_there_twice_as_at_an_event():
    times = np.array([0.0, 1.0, 1.0, 2.0])
    tables = [make_table(times, [("a.x", times + off, "m", "")]) for off in (0.0, 0.5)]
    (one,) = differences(lay_over(tuple(tables), ("a", "b")))
    assert (one.rms, one.largest) == (0.5, 0.5)


def test_start_values_that_differ_are_listed(browse, tmp_path):
    tables = boat(**{"bow.gain": 1.0, "bow.time": 2.0}), boat(**{"bow.gain": 1.5, "bow.time": 2.0})
    write_comparison(tables, ("a", "b"), tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    details = page.ask("return document.getElementById('details').textContent")
    assert "bow.gain" in details and "1.5" in details and "bow.time" not in details


def test_ships_of_other_names_are_compared_too(browse, tmp_path):
    other = boat(north=3.0)
    other = other.rename({f"boat.{axis}": f"hull.{axis}" for axis in ("x", "y", "psi")})
    write_comparison((boat(), other), ("a", "b"), tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    page.ask("scene.time = 40; scene.paint()")
    cells = page.ask(
        "return [...document.getElementById('scene-figures').rows[1].cells].map(c => c.textContent)"
    )
    assert cells == ["North [m]", "40.00", "43.00", "+3.00"]
    assert page.ask("return document.getElementById('scene-vessel').hidden")


def test_of_systems_without_a_ship_what_differs_is_drawn_of_both_runs(browse, tmp_path):
    time = np.arange(0.0, 10.0)
    names = [f"part.{letter}" for letter in "abcdefgh"]
    tank = xr.Dataset({name: ("time", time, {"units": "m"}) for name in names}, {"time": time})
    other = tank.assign({"part.h": tank["part.h"] * 2.0})
    write_comparison((tank, other), ("dry", "wet"), tmp_path / "report.html")
    page = browse(tmp_path / "report.html")
    drawn = "return [...document.querySelectorAll('#choices input:checked')].map(box => box.value)"
    assert page.ask(drawn) == ["dry: part.h", "wet: part.h"]


def test_runs_with_nothing_in_common_are_refused(tmp_path):
    other = boat().rename({name: f"other.{name}" for name in boat().data_vars})
    with pytest.raises(ShipcosimError, match="no signal in common"):
        write_comparison((boat(), other), ("a", "b"), tmp_path / "report.html")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf, -1e308])
@pytest.mark.parametrize("row", [0, 1, 2])
def test_a_number_that_one_run_lacks_is_a_difference(tmp_path, odd, row):
    values = np.array([1e308, 1e308, 1e308])
    other = values.copy()
    other[row] = odd
    tables = [make_table(np.arange(3.0), [("a.x", v, "m", "")]) for v in (values, other)]
    for pair in (tables, tables[::-1]):
        outcome, _ = write_comparison(tuple(pair), ("A", "B"), tmp_path / "page.html")
        assert outcome.word == "DIFFER"
    for table in tables:
        outcome, _ = write_comparison((table, table), ("A", "B"), tmp_path / "page.html")
        assert outcome.word == "SAME"


@pytest.mark.parametrize("largest", [1e30, 1e40, 1e308, np.inf])
@pytest.mark.parametrize("rows", [slice(0, 1), slice(5, None), slice(None)])
def test_a_ship_that_is_nowhere_at_times_has_a_page(tmp_path, largest, rows):
    table = boat()
    table["boat.y"].values[rows] = largest
    outcome, _ = write_comparison((table, table), ("A", "B"), tmp_path / "page.html")
    assert outcome.word == "SAME"


def test_the_page_of_two_ships_is_not_wider_than_the_window(browse, tmp_path):
    calm = shipcosim.run("gust", stop_time=2.0)
    rough = shipcosim.run("gust", stop_time=2.0, set={"environment.wind_speed": 12.0})
    page = browse(shipcosim.report(calm, rough).page().save(tmp_path / "report.html"))
    assert page.ask("return document.documentElement.scrollWidth <= innerWidth")
    # Below the compasses nothing reaches out of its instrument.
    inside = """return [...document.querySelectorAll('#scene-compasses .instrument')].every((one) =>
        one.querySelector('table').getBoundingClientRect().right <= one.getBoundingClientRect().right)"""
    assert page.ask(inside)
