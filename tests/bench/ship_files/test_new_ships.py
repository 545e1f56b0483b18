"""Ships of `new ship` hold their place in wind and current from twelve directions, and after a loss."""

import numpy as np
import pytest

import shipcosim as sc
from shipcosim.capability import read_vessel
from shipcosim.capability.compute import simulated_share
from shipcosim.capability.conditions import DYNAMIC_FACTOR, Condition
from shipcosim.library import build_stale
from shipcosim.ships import make_systems, read_ship
from shipcosim.ships.writing import Answers, ship_text, thruster_from
from shipcosim.ssp import read_system

AZIMUTH = "kind=azimuth, diameter=3.2 m, power=3000 kW, ducted=true"
PLACES = {"a1": (-68, -9), "a2": (-68, 9), "a3": (-60, 0), "f1": (58, -6), "f2": (58, 6)}
SHIPS = {
    "psv": Answers(length="82 m", breadth="20 m", draught="6.4 m", power="4600 kW"),
    "pod": Answers(
        length="45 m",
        breadth="13 m",
        draught="4.5 m",
        thrusters=[
            thruster_from("name=pod, kind=azimuth, x=-20 m, y=0 m, diameter=2.6 m, power=1800 kW"),
            thruster_from("name=bow, kind=tunnel, x=18 m, diameter=1.6 m, power=500 kW"),
        ],
    ),
    "boat": Answers(length="30 m", breadth="9 m", draught="3 m", layout="screws"),
    "drill": Answers(
        length="150 m",
        breadth="30 m",
        draught="9 m",
        thrusters=[
            thruster_from(f"name={name}, x={x} m, y={y} m, {AZIMUTH}")
            for name, (x, y) in PLACES.items()
        ],
    ),
}


@pytest.mark.parametrize("wind_from", range(0, 360, 30))
@pytest.mark.parametrize("name", SHIPS)
def test_a_new_ship_holds_her_place_from_every_direction(name, wind_from, root, tmp_path):
    fmus = [build_stale(root)]
    file = tmp_path / name / "ship.toml"
    file.parent.mkdir()
    file.write_text(ship_text(SHIPS[name]), encoding="utf-8")
    system = read_system(make_systems(file, tmp_path / "ssp", fmus)[1], fmus=fmus)
    weather = {
        "environment.wind_speed": 10.0,
        "environment.wind_from": np.radians(wind_from),
        "environment.current_speed": 0.3,
        "environment.current_to": np.radians(wind_from + 180.0),
    }
    run = sc.simulate(system, stop_time=400.0, step_size=0.1, output_interval=1.0, set=weather)
    late = run.sel(time=slice(200.0, None))
    off = float(np.hypot(late["vessel.x"], late["vessel.y"]).max())
    # No law holds her where the thrusters cannot balance the mean load.
    vessel = read_vessel(system, read_ship(file.parent))
    mean = Condition(0, 10.0, 0.01, 6.0, 0.3)
    share = simulated_share(vessel.simulated, vessel.thrusters, mean) * DYNAMIC_FACTOR
    if share[wind_from // 10] < 1.0:
        assert off > 5.0
        return
    assert off < 1.5
    assert np.abs(np.degrees(late["vessel.psi"])).max() < 2.0
