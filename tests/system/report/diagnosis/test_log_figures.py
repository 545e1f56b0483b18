"""The log as it is drawn."""

import numpy as np
import xarray as xr

from shipcosim.diagnose.finding import Finding
from shipcosim.report.diagnosis.log_figures import log_figures


def by_title(figures):
    return {figure.title: figure for figure in figures}


def log_of(rows=600):
    time = np.arange(rows, dtype=float)
    heading = np.mod(350.0 + 0.1 * time, 360.0)
    units = {"north": "m", "east": "m", "heading": "deg", "port_rpm": "rpm", "tunnel_rpm": "rpm"}
    values = {
        "north": time,
        "east": 2 * time,
        "heading": heading,
        "port_rpm": 0 * time + 60,
        "tunnel_rpm": time + 500,
    }
    columns = {
        name: ("time", values[name], {"units": unit, "long_name": name})
        for name, unit in units.items()
    }
    return xr.Dataset(columns, {"time": time})


def test_stretches_of_a_fault_are_shaded_in_the_panels_of_its_channels_only():
    fault = Finding("gap", kind="data", segments=((100.0, 120.0),), channels=("north",))
    panels = by_title(log_figures(log_of(), log_of(), [fault]))
    (shape,) = panels["Position"].layout["shapes"]
    assert (shape["x0"], shape["x1"]) == (100.0, 120.0)
    assert panels["Heading"].layout["shapes"] == []


def test_fault_of_the_whole_log_is_shaded_throughout():
    fault = Finding("sign", kind="data", channels=("heading",))
    (shape,) = by_title(log_figures(log_of(), log_of(), [fault]))["Heading"].layout["shapes"]
    assert (shape["x0"], shape["x1"]) == (0.0, 599.0)


def test_channel_is_drawn_as_logged_only_where_it_was_changed():
    clean = log_of()
    clean["north"][100:121] = np.nan
    (logged, north, east) = by_title(log_figures(log_of(), clean, []))["Position"].traces
    assert (logged["name"], north["name"], east["name"]) == ("north, logged", "north", "east")
    assert logged["y"][110] == 110.0 and north["y"][110] is None


def test_repaired_clock_is_drawn_over_the_time_that_was_logged():
    clean = log_of().assign_coords(logged_time=("time", 0.5 * np.arange(600.0)))
    data = by_title(log_figures(log_of(), clean, []))["Position"].traces
    assert next(trace for trace in data if trace["name"] == "east")["x"][-1] == 299.5


def test_heading_is_interrupted_where_it_passes_north():
    (trace,) = by_title(log_figures(log_of(), log_of(), []))["Heading"].traces
    assert trace["y"].count(None) == 1
    pairs = [
        (a, b) for a, b in zip(trace["y"][:-1], trace["y"][1:], strict=True) if None not in (a, b)
    ]
    assert max(abs(a - b) for a, b in pairs) < 1.0


def test_thruster_whose_speed_is_much_larger_gets_a_panel_of_its_own():
    titles = by_title(log_figures(log_of(), log_of(), []))
    assert {"Shaft speed, port", "Shaft speed, tunnel"} <= set(titles)
