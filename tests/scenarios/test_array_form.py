"""The array form of the DP loop against the co-simulation of the FMUs."""

from dataclasses import replace

import dp_loop
import numpy as np

from shipcosim.scenario import units_of, with_numbers
from shipcosim.ssp import read_system
from shipcosim.units import number_in

WEATHER = ("wind_speed", "wind_from", "current_speed", "current_to")


def array_form(scenario, seeds, fmus):
    """The scenario's run by the array form, one variation a pair of seeds of environment and sensors."""
    unit_of = units_of(read_system(scenario.system_path, scenario.parameter_paths, fmus=[fmus]))
    scenario = with_numbers(scenario, unit_of)
    own = {name: {} for name in ("environment", "sensors")}
    for signal, value in scenario.set.items():
        component, variable = signal.split(".")
        own[component][variable] = number_in(value, unit_of(signal)) if isinstance(value, str) else value
    start = {name: own["environment"].pop(name) for name in WEATHER}
    own["environment"]["seed"], own["sensors"]["seed"] = (np.array(column) for column in zip(*seeds, strict=True))
    default = dp_loop.dp_system()
    system = replace(
        default,
        environment=replace(default.environment, **own["environment"]),
        sensors=replace(default.sensors, **own["sensors"]),
    )
    events = [(0.0, start)]
    events += [(e.time, {name.split(".")[1]: value for name, value in e.override.items()}) for e in scenario.events]
    every = round(scenario.output_interval / scenario.step_size)
    return dp_loop.simulate(
        system, events, variations=len(seeds), stop_time=scenario.stop_time, h=scenario.step_size, every=every
    )


def test_array_form_gives_the_co_simulation_over_the_whole_four_corner_run(load_scenario, run_scenario, fmus):
    """To 1e-9 of each signal's range; a signal that stands still may differ by 1e-15."""
    scenario = load_scenario("four_corner")
    table = run_scenario("four_corner")
    seeds = [(77, 78), (scenario.set["environment.seed"], scenario.set["sensors.seed"])]
    arrays = array_form(scenario, seeds, fmus)
    np.testing.assert_allclose(arrays.pop("time"), table["time"], rtol=0.0, atol=1e-9)
    assert {"vessel.x", "port.thrust", "controller.psi_hat", "allocator.saturated"} <= set(arrays)
    apart = {}
    for name, values in arrays.items():
        ours = table[name].values.astype(float)
        difference = values[:, 1] - ours
        if table[name].attrs["units"] == "rad":
            difference = np.angle(np.exp(1j * difference))
        apart[name] = np.abs(difference).max() / max(np.ptp(ours), 1e-6)
    assert max(apart.values()) < 1e-9, sorted(apart.items(), key=lambda item: -item[1])[:5]
    assert np.abs(arrays["vessel.x"][:, 0] - arrays["vessel.x"][:, 1]).max() > 0.01, "other seeds make another run"
