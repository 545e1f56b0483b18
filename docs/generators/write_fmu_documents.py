"""Writes what is derived from the FMUs: the table of variables in each README, and each reference.csv.

Run `python docs/generators/write_fmu_documents.py` after an FMU or a number has changed; tests compare the files
with this.

A reference result is 60 s of one component of the four-corner run: at each row the inputs it had there, and the outputs
that the FMU gives when it is started with the first row's inputs and stepped from row to row with the inputs held.
Parameters are those of the lengthened R/V Gunnerus (ssp/ships/gunnerus-33m9), her azimuth thruster on the centreline;
those of other ships of what she has not.
FMUs that do nothing with their defaults have others. An FMU that is no part of that run keeps times and inputs of its
reference.csv.
"""

import importlib.util
import sys
from pathlib import Path

import numpy as np

from shipcosim.cosim import simulate
from shipcosim.fmi.export.description import full_text, text_of
from shipcosim.library import build_stale
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.prediction.controlled import ObserverAhead
from shipcosim.scenario import read_scenario
from shipcosim.series import make_table, read_table, write_table
from shipcosim.ships import read_ship
from shipcosim.ssp import read_system

ROOT = Path(__file__).resolve().parents[2]
MARK = "## Variables\n"
DURATION, INTERVAL = 60.0, 0.5  # s
COMPONENTS = {
    "environment": "environment",
    "vessel": "vessel",
    "rough_vessel": "vessel",
    "azimuth_thruster": "port",
    "tunnel_thruster": "tunnel",
    "sensors": "sensors",
    "reference": "reference",
    "dp_controller": "controller",
    "allocator": "allocator",
    "optimal_allocator": "allocator",
    "extended_allocator": "allocator",
    "thruster_monitor": "monitor",
    "predictor": "predictor",
    "dp_predictor": "predictor",
    "drift_predictor": "predictor",
}
"""FMU: the component of gunnerus_dp whose inputs it gets."""
SHIP = "gunnerus-33m9"
ELSEWHERE = {
    "fixed_thruster": ("otter", "left"),
    "propeller_rudder": ("kvlcc2", "propeller"),
    "thruster_interaction": ("four-azimuths", "interaction"),
    "consequence_analysis": ("four-azimuths", "consequences"),
    "pid_controller": ("osv", "controller"),
    "paper_i_allocator": ("osv", "allocator"),
    "paper_v_allocator": ("thesis-28m9", "allocator"),
    "docking_predictor": ("gunnerus-28m9", "docking_predictor"),
    "helmsman": ("gunnerus-28m9", "helmsman"),
}
"""FMU that she has not: a ship and her component that it is."""
LOOP = [ReferenceParameters, ControlParameters, AllocationParameters, ObserverAhead]
OTHERS = {
    "optimal_allocator": [AllocationParameters],
    "predictor": LOOP,
    "drift_predictor": LOOP,
}
"""FMU that can take a component's place: what that component has of the ship and this one does not need."""
PARAMETERS = {
    "azimuth_thruster": {"y": 0.0, "neighbour_x": 0.0, "neighbour_y": 0.0},
    "earth_force": {
        "north": 1000.0,
        "east": 2000.0,
        "onset_time": 10.0,
        "ramp_time": 20.0,
        "x": -17.0,
    },
    "drift_force": {"north": 1500.0, "east": -1000.0, "onset_time": 5.0, "yaw_arm": -1.5},
    "varying_current": {"north_start": 0.3, "east_end": -0.2, "time_start": 10.0, "time_end": 50.0},
    "fixed_thruster": {"speed_loss": 0.1, "direction": 0.2},
    "mapped_thruster": {
        "x": -0.4,
        "y": 0.285,
        "thrust_table": "1100 -28; 1480 -1; 1520 1; 1900 55",
        "time_constant": 0.5,
        "command_rate": 40.0,
        "speed_loss": 0.1,
    },
    "fixed_angle_allocator": {
        **{
            "x_1": -27.0,
            "y_1": -3.5,
            "azimuth_1": -0.785,
            "thrust_min_1": -1.4e5,
            "thrust_max_1": 2.3e5,
        },
        **{
            "x_2": -27.0,
            "y_2": 3.5,
            "azimuth_2": 0.785,
            "thrust_min_2": -1.4e5,
            "thrust_max_2": 2.3e5,
        },
        **{"x_3": 25.0, "azimuth_3": 1.5708, "thrust_min_3": -8e4, "thrust_max_3": 8e4},
        **{"thrust_rate_1": 2.3e4, "thrust_rate_2": 2.3e4, "thrust_rate_3": 8e3, "yaw_lever": 25.0},
    },
    "optimal_units_allocator": {
        **{
            "x_1": -27.0,
            "y_1": -3.5,
            "azimuth_1": -0.785,
            "thrust_max_1": 2.3e5,
            "azimuth_rate_1": 0.2,
        },
        **{
            "x_2": -27.0,
            "y_2": 3.5,
            "azimuth_2": 2.356,
            "thrust_max_2": 2.3e5,
            "azimuth_rate_2": 0.2,
        },
        **{
            "azimuth_first_1": -1.4,
            "azimuth_last_1": 1.4,
            "azimuth_first_2": 1.74,
            "azimuth_last_2": 4.54,
        },
        **{
            "x_3": 25.0,
            "azimuth_3": 1.5708,
            "thrust_min_3": -8e4,
            "thrust_max_3": 8e4,
            "thrust_least_1": 4e3,
        },
        **{"thrust_rate_1": 2.3e4, "thrust_rate_2": 2.3e4, "thrust_rate_3": 8e3, "yaw_lever": 25.0},
    },
    "rough_vessel": {
        **{"strip_factors": "-1 1.3; 0 1; 1 0.8", "cross_flow_power": 1.9, "drag_power": 2.1},
        **{
            "wind_factors": "0 1 1 1; 90 1.1 0.9 1.2; 360 1 1 1",
            "memory_surge": 0.1,
            "memory_sway": 0.2,
        },
        **{"memory_yaw": 0.1, "memory_time": 5.0},
    },
    "harbour": {
        **{"wind_shelter": 0.6, "land_towards": 1.0, "tide_shelter": 0.5, "channel": 0.3},
        **{"river_speed": 0.5, "river_to": 2.0, "river_x": 50.0, "river_y": -30.0},
    },
    "helmsman": {
        "waypoints": "-600 -80; -200 -15; 0 -15",
        "berth_heading": 0.2,
        "look_interval": 3.0,
    },
    "instruments": {
        "heading_bias": 0.05,
        "lever_x": 3.0,
        "lever_y": -2.0,
        "velocity_scale": 1.1,
        "lag": 1.3,
    },
}
"""FMU: its parameters in its reference result that are neither the ship's nor as by default."""
LONGEST_SHOWN = 24  # characters of a start value in a table for readers


def fmu_class(name):
    """The class in fmus/<name>/<name>.py."""
    path = ROOT / "fmus" / name / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"documented_{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return next(
        c
        for c in vars(module).values()
        if isinstance(c, type) and c.__module__ == spec.name and hasattr(c, "step")
    )


def reference_tolerance(name, values):
    """By how much a signal may differ from its reference: 1e-9 of its range.

    Libraries of other platforms and processors differ in their last digits.
    """
    return 1e-9 * max(np.ptp(values), np.abs(values).max(), 1e-6)


def parameters_of(name):
    """Parameters of an FMU in its reference result, by name: the ship's where it is a component of hers."""
    kinds, found = [group.kind for group in fmu_class(name).groups], {}
    ship, component = ELSEWHERE.get(name, (SHIP, COMPONENTS.get(name)))
    if component and name != "environment":
        quantities = read_ship(ROOT / "ssp" / "ships" / ship).parameter_set(
            {component: kinds + OTHERS.get(name, [])}
        )
        known = {variable.name for variable in fmu_class(name).variables}
        found = {
            key: quantity.value for key, quantity in quantities[component].items() if key in known
        }
    return found | PARAMETERS.get(name, {})


def table_of_variables(cls):
    """The variables of an FMU class as a Markdown table.

    Parameters
    ----------
    cls : type
        Subclass of `Fmu`.

    Returns
    -------
    str
        Table with a head, one row a variable, ending in a line break.
    """
    rows = ["| variable | kind | type | unit | start | meaning |", "|---|---|---|---|---|---|"]
    for v in cls.variables:
        kind = f"tunable {v.causality}" if v.tunable else v.causality
        start = (
            "required"
            if v.required
            else ""
            if v.causality == "output" or v.start == ""
            else _shown(v.start)
        )
        rows.append(
            f"| `{v.name}` | {kind} | {v.type} | {v.unit} | {start} | {full_text(v).replace('|', '&#124;')} |"
        )
    return "\n".join(rows) + "\n"


def _shown(start):
    """A start value, cut where it is long."""
    text = text_of(start)
    return f"`{text}`" if len(text) <= LONGEST_SHOWN else f"`{text[:LONGEST_SHOWN]}` ..."


def readme(name):
    """README of an FMU with its table of variables as it should be."""
    path = ROOT / "fmus" / name / "README.md"
    text = (
        path.read_text(encoding="utf-8").partition(MARK)[0].rstrip()
        if path.is_file()
        else f"# {name}"
    )
    return f"{text}\n\n{MARK}\n{table_of_variables(fmu_class(name))}"


def four_corner():
    """Table and system of the first minute of the four-corner run."""
    scenario = read_scenario(ROOT / "scenarios" / "four_corner.toml")
    events = [event for event in scenario.events if event.time < DURATION]
    scenario = scenario.model_copy(
        update={"stop_time": DURATION, "output_interval": INTERVAL, "events": events, "expect": []}
    )
    system = read_system(scenario.system_path, scenario.parameter_paths, fmus=[build_stale(ROOT)])
    return simulate(system, scenario), system


def inputs_of(component, table, system):
    """Values of a component's inputs over a run, by name."""
    values = {}
    for name, variable in system.components[component].fmu.variables.items():
        if variable.causality == "input" and f"{component}.{name}" in table:
            values[name] = table[f"{component}.{name}"].values
    for connection in system.connections:
        if connection.target[0] == component:
            values[connection.target[1]] = table[".".join(connection.source)].values
    return values


def driven(name, times, inputs):
    """Outputs of an FMU's class under given inputs, by name: one row a time, the first after its start."""
    fmu = fmu_class(name)()
    for key, value in parameters_of(name).items():
        setattr(fmu, key, value)
    outputs = [variable for variable in fmu.variables if variable.causality == "output"]
    types = {variable.name: type(variable.start) for variable in fmu.variables}
    rows = {variable.name: np.empty(len(times), type(variable.start)) for variable in outputs}
    for row in range(len(times)):
        for key, values in inputs.items():
            setattr(fmu, key, types[key](values[row - 1 if row else 0]))
        fmu.start() if row == 0 else fmu.step(times[row - 1], times[row] - times[row - 1])
        for variable in outputs:
            rows[variable.name][row] = getattr(fmu, variable.name)
    return rows


def own_inputs(name):
    """Times and inputs in the FMU's reference.csv; without one a minute in which the inputs stay as they start."""
    path = ROOT / "fmus" / name / "reference.csv"
    if not path.is_file():
        return np.arange(0.0, DURATION + INTERVAL, INTERVAL), {}
    table = read_table(path)
    inputs = [
        variable.name for variable in fmu_class(name).variables if variable.causality == "input"
    ]
    return table["time"].values, {key: table[key].values for key in inputs if key in table}


def reference(name, table, system):
    """Reference result of an FMU: its inputs and outputs."""
    times, inputs = own_inputs(name)
    if name in COMPONENTS:
        times, inputs = table["time"].values, inputs_of(COMPONENTS[name], table, system)
    values = inputs | driven(name, times, inputs)
    about = {variable.name: variable for variable in fmu_class(name).variables}
    columns = [
        (key, values[key], about[key].unit, about[key].description)
        for key in about
        if key in values
    ]
    return make_table(times, columns)


if __name__ == "__main__":
    run, system = four_corner()
    for name in sorted(
        path.stem for path in ROOT.glob("fmus/*/*.py") if path.stem == path.parent.name
    ):
        (ROOT / "fmus" / name / "README.md").write_text(readme(name), encoding="utf-8")
        write_table(reference(name, run, system), ROOT / "fmus" / name / "reference.csv")
