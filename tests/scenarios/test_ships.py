"""Every ship of ssp/ships sails in both systems."""

import numpy as np
import pytest
from ships import SHIPS

import shipcosim as sc
from shipcosim.cli.project import build_stale
from shipcosim.ssp import read_system


@pytest.mark.parametrize("name", SHIPS)
def test_each_ship_is_held_by_her_dp(name, root):
    """In 5 m/s of wind on the bow's side; settled after a minute and a half."""
    system = root / "ssp" / "gunnerus_dp"
    dp = read_system(system, system / "resources" / f"{name}.ssv", fmus=[build_stale(root)])
    weather = {"environment.wind_speed": 5.0, "environment.wind_from": 0.785}
    run = sc.simulate(dp, stop_time=120.0, step_size=0.05, output_interval=0.5, set=weather)
    late = run.sel(time=slice(90.0, None))
    assert np.hypot(late["vessel.x"], late["vessel.y"]).max() < 0.7
    assert np.abs(np.degrees(late["vessel.psi"])).max() < 1.5
    assert np.abs(run["tunnel.thrust"]).max() > 500.0


@pytest.mark.parametrize("name", SHIPS)
def test_each_ship_goes_ahead_where_her_thrusters_are_given(name, root):
    system = root / "ssp" / "gunnerus_open"
    ship = read_system(system, system / "resources" / f"{name}.ssv", fmus=[build_stale(root)])
    run = sc.simulate(ship, stop_time=20.0, step_size=0.05, set={"port_rpm": 100.0, "starboard_rpm": 100.0})
    assert run["vessel.u"].values[-1] > 0.5 and abs(run["vessel.v"].values[-1]) < 1e-6


@pytest.mark.parametrize("engine", ["fmpy", "libcosim", "ecos"])
def test_a_number_left_out_is_refused_with_all_others_before_any_engine_runs(engine, root):
    system = sc.read(root / "ssp" / "gunnerus_open", fmus=[build_stale(root)]).copy()
    for name in ("vessel.mass", "vessel.wind_table", "port.rpm_max"):
        del system.parameters[name]
    with pytest.raises(sc.ShipcosimError) as error:
        sc.simulate(system, stop_time=1.0, engine=engine)
    vessel, port = error.value.problems
    assert "vessel: parameters left out" in str(vessel) and "mass [kg], wind_table." in str(vessel)
    assert "port: parameters left out" in str(port) and "rpm_max [rpm]." in str(port)
    run = sc.simulate(
        system,
        stop_time=0.1,
        set={"vessel.mass": 5e5, "vessel.wind_table": "0 0 0 0; 180 0 0 0", "port.rpm_max": 200.0},
    )
    assert run["vessel.x"].size
