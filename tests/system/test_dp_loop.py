"""The DP loop: against its FMUs stepped one by one by hand, and whether she holds on many seeds."""

import importlib.util
import math

import numpy as np
import pytest
from dp_runs import MODERATE, simulate
from ships import equipped


@pytest.fixture(scope="module")
def fmus(root):
    """Makes the class of an FMU."""

    def load(name):
        path = root / "fmus" / name / f"{name}.py"
        spec = importlib.util.spec_from_file_location(f"fmu_{name}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return next(
            c for c in vars(module).values() if isinstance(c, type) and c.__module__ == spec.name
        )

    return load


WAVES = ("wave_height", "wave_period", "wave_from", "wave_peak_enhancement", "wave_seed")
UNITS = ("port", "starboard", "tunnel")
LOADS = ("tau_X", "tau_Y", "tau_N")
SHIP = ("x", "y", "psi", "u", "v", "r")
FLOW = ("u_r", "v_r", "r")
WATER = ("wind_north", "wind_east", "current_north", "current_east")
APPARENT = ("apparent_wind_speed", "apparent_wind_from")
MEASURED = (
    *(f"{name}_{i}_meas" for i in (1, 2, 3) for name in ("x", "y", "u", "v")),
    *(f"position_{i}_valid" for i in (1, 2, 3)),
    *(f"{name}_meas" for name in ("psi_1", "psi_2", "r", "wind_speed", "wind_from")),
    *("compass_1_valid", "compass_2_valid", "wind_valid"),
    *(f"{name}_time_meas" for name in ("position", "heading", "wind")),
)
DESIRED = ("x_d", "y_d", "psi_d", "x_d_dot", "y_d_dot", "r_d", "x_d_ddot", "y_d_ddot", "r_d_dot")
CONNECTIONS = [
    *(("environment", name, "vessel", name) for name in (*WATER, *WAVES)),
    *(
        (unit, load, "vessel", f"{load}_{i}")
        for i, unit in enumerate(("port", "starboard", "tunnel"), 1)
        for load in LOADS
    ),
    *(("vessel", name, unit, name) for unit in ("port", "starboard") for name in FLOW),
    ("vessel", "u_r", "tunnel", "u_r"),
    *(("allocator", f"{unit}_thrust_cmd", unit, "thrust_cmd") for unit in UNITS),
    *(("allocator", f"{unit}_azimuth_cmd", unit, "azimuth_cmd") for unit in ("port", "starboard")),
    *((unit, "available", "allocator", f"{unit}_available") for unit in UNITS),
    *(
        ("vessel", name, "sensors", name)
        for name in (*SHIP, *(f"{name}_wave" for name in SHIP), *APPARENT)
    ),
    *(("sensors", name, "controller", name) for name in MEASURED),
    *(("reference", name, "controller", name) for name in DESIRED),
    *(("allocator", load, "controller", f"{load}_allocated") for load in LOADS),
    *(("controller", f"{load}_cmd", "allocator", f"{load}_cmd") for load in LOADS),
]


def stepped_one_by_one(fmus, inputs, parameters, seconds, h=0.05):
    """Components after each step of a Jacobi exchange, from `fmus`, the FMUs by name."""
    for component, name, value in (*parameters, *inputs):
        setattr(fmus[component], name, value)

    def exchange():
        values = [getattr(fmus[source], name) for source, name, _, _ in CONNECTIONS]
        for value, (_, _, target, name) in zip(values, CONNECTIONS, strict=True):
            setattr(fmus[target], name, value)

    for _ in range(4):
        for fmu in fmus.values():
            fmu.start()
        exchange()
    for k in range(round(seconds / h)):
        for fmu in fmus.values():
            fmu.step(k * h, h)
        exchange()
        yield fmus


def test_runs_follow_the_fmus_stepped_one_by_one(fmus):
    components = {
        name: fmus(name)()
        for name in ("environment", "vessel", "sensors", "reference", "allocator")
    }
    components |= {name: fmus("azimuth_thruster")() for name in ("port", "starboard")}
    components |= {"tunnel": fmus("tunnel_thruster")(), "controller": fmus("dp_controller")()}
    for name in set(components) - {"environment"}:
        equipped(components[name], name)
    values = MODERATE | {"reference.x_set": 20.0}
    inputs = [(*name.split("."), value) for name, value in values.items()]
    seeds = [("environment", "seed", 3), ("sensors", "seed", 103)]
    run = simulate([3, 8], values, record=SHOWN, stop_time=60.0)
    rows = [
        [
            float(getattr(components[name.split(".")[0]], name.split(".")[1]))
            for name in run
            if name != "time"
        ]
        for components in stepped_one_by_one(components, inputs, seeds, 60.0)
    ]
    for name, expected in zip(
        [name for name in run if name != "time"], np.array(rows).T, strict=True
    ):
        span = np.ptp(expected) or 1.0
        np.testing.assert_allclose(
            run[name][1:, 0] / span, expected / span, atol=1e-9, err_msg=name
        )


SHOWN = (
    *(f"vessel.{name}" for name in SHIP),
    *(f"environment.{name}" for name in WATER),
    *(f"{unit}.{name}" for unit in UNITS for name in ("thrust", "rpm", "saturated")),
    *(f"sensors.{name}" for name in MEASURED),
    *("reference.x_d", "reference.y_d", "reference.psi_d"),
    *(f"controller.{name}_hat" for name in (*SHIP, "wave_frequency")),
    *(f"controller.{load}_cmd" for load in LOADS),
    *(
        "controller.positions_used",
        "controller.compass_1_rejected",
        "controller.dead_reckoning_time",
    ),
    *(f"allocator.{unit}_thrust_cmd" for unit in UNITS),
    *("allocator.port_azimuth_cmd", "allocator.starboard_azimuth_cmd", "allocator.saturated"),
)


def test_ship_is_held_in_moderate_weather():
    run = simulate([1, 2, 3], MODERATE, stop_time=120.0, every=10)
    late = run["time"] > 60.0
    assert np.hypot(run["vessel.x"], run["vessel.y"])[late].max() < 0.6
    assert np.abs(run["vessel.psi"][late]).max() < math.radians(1.0)
    assert not run["allocator.saturated"].any()


def test_half_the_step_changes_the_track_by_less_than_5_cm():
    values = MODERATE | {"reference.x_set": 20.0}
    coarse = simulate([1, 2], values, stop_time=100.0, every=20)
    fine = simulate([1, 2], values, stop_time=100.0, h=0.025, every=40)
    assert (
        np.hypot(coarse["vessel.x"] - fine["vessel.x"], coarse["vessel.y"] - fine["vessel.y"]).max()
        < 0.05
    )
