"""Thrusters that hit one another: the ship of the diagnosis loses the thrust that the system's own FMU takes."""

import numpy as np

import shipcosim as sc
from shipcosim.diagnose.ship.inputs import Inputs
from shipcosim.diagnose.ship.ship_of_system import ship_model_of
from shipcosim.diagnose.ship.thrusters import thruster_loads


def test_loads_are_those_of_the_run_slipstreams_included():
    model = ship_model_of(sc.read("four_azimuths").checked())
    assert sorted(model.slipstreams.numbers) == sorted(model.thrusters)
    run = sc.run("allocation/four_azimuths", stop_time=60.0).table
    units = {
        name: (run[f"{name}.rpm"].values / 60.0, run[f"{name}.azimuth"].values)
        for name in model.thrusters
    }
    inputs = Inputs(run["time"].values, units, None, None)
    motion = [run[f"vessel.{name}"].values for name in ("u_r", "v_r", "r")]
    shares = [model.slipstreams.share(name, units) for name in model.thrusters]
    assert min(map(np.min, shares)) < 0.9  # something is lost
    for name in model.thrusters:
        surge, sway, _ = thruster_loads(name, inputs, *motion, model)
        lost = np.hypot(surge - run[f"{name}.tau_X"], sway - run[f"{name}.tau_Y"])
        assert np.sqrt(np.mean(lost**2)) < 0.01 * np.sqrt(np.mean(run[f"{name}.thrust"] ** 2))
