"""Power over the exact static optimum in wind from all around: the request that balances the mean wind, held.

`.venv/bin/python tests/bench/allocation/rose.py [law ...]` prints the ratio for 24 directions at 8 and 12 m/s, and for
12 directions in the loop (`held`, 10 m/s) the power over that of fixed angles, with changes of cones and reversals.
"""

import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
if __name__ == "__main__":  # as a test its folders are on the path already
    sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[2])]

from ships import parameters  # noqa: E402

import shipcosim  # noqa: E402
from allocation.laws import LAWS  # noqa: E402
from allocation.loops import loads  # noqa: E402
from allocation.optimum import best  # noqa: E402
from shipcosim.models.allocation.power import PowerParameters  # noqa: E402
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters  # noqa: E402
from shipcosim.models.environment.wind_loads import (  # noqa: E402
    WindParameters,
    apparent_wind,
    wind_loads,
)

SPEEDS = (8.0, 12.0)  # m/s
DIRECTIONS = np.arange(0.0, 360.0, 15.0)  # deg, wind from, ship heading north
HELD = 240.0  # s: a change of cones is over by then
STEP = 0.1  # s


def balance(speed: float, wind_from: np.ndarray) -> np.ndarray:
    """Loads, (n, 3), that balance the mean wind from some directions [m/s, rad]. [N, N, N.m]"""
    rows = []
    for angle in wind_from:
        air = apparent_wind(0.0, 0.0, 0.0, -speed * np.cos(angle), -speed * np.sin(angle))
        rows.append(wind_loads(*air, wind=parameters(WindParameters)))
    return -np.array(rows, float)


def held_power(law: str, tau: tuple) -> float:
    """Power at the end of a request that is held from rest, or infinite where it is not met. [W]"""
    one = LAWS[law]()
    commands = one.step(tau, (True, True, True), STEP)
    for _ in range(round(HELD / STEP)):
        commands = one.step(tau, (True, True, True), STEP)
    missed = np.abs(np.array(tau) - loads(np.array(commands.thrusts), np.array(commands.azimuths)))
    if (missed > (5.0, 5.0, 50.0)).any():
        return np.inf
    ship, full = parameters(AllocationParameters), parameters(PowerParameters)
    most = ship.azimuth_thrust_max, ship.azimuth_thrust_max, ship.tunnel_thrust_max
    shares = np.abs(commands.thrusts) / np.array(most)
    return float(np.sum(np.array(full.largest) * shares**1.5))


def ratios(law: str, speed: float) -> np.ndarray:
    """Power over that of the exact static optimum, for each of `DIRECTIONS`. [1]"""
    tau = balance(speed, np.radians(DIRECTIONS))
    least = best(tau).power
    return np.array([held_power(law, tuple(row)) for row in tau.tolist()]) / least


def in_the_loop(law: str) -> dict[str, np.ndarray]:
    """Mean electrical power, changes of cones and reversals of the azimuths from 150 to 600 s, for 12 directions."""
    weather = [
        {"environment.wind_speed": 10.0, "environment.wind_from": at}
        for at in np.radians(DIRECTIONS[::2])
    ]
    found = shipcosim.simulate_many(
        scenario="held",
        variations=weather,
        stop_time=600.0,
        components={"allocator": law},
        reduce=_after_start,
    )
    return {name: found[name].values for name in ("power", "changes", "reversals")}


def _after_start(table):
    late = table.sel(time=slice(150.0, None))
    changes = reversals = 0
    for unit in ("port", "starboard"):
        ahead = np.cos(late[f"allocator.{unit}_azimuth_cmd"].values) > 0.0
        changes += np.sum(ahead[1:] != ahead[:-1])
        astern = late[f"allocator.{unit}_thrust_cmd"].values < 0.0
        reversals += np.sum(astern[1:] != astern[:-1])
    power = sum(late[f"{unit}.power"].values for unit in ("port", "starboard", "tunnel"))
    return {"power": power.mean(), "changes": float(changes), "reversals": float(reversals)}


if __name__ == "__main__":
    fixed = in_the_loop("allocator")["power"]
    for law in sys.argv[1:] or ["optimal_allocator"]:
        loop = in_the_loop(law)
        ratio = loop["power"] / fixed
        print(
            f"{law} in the loop: {1.0 - loop['power'].sum() / fixed.sum():.3f} less than fixed angles"
        )
        print("  " + " ".join(f"{value:.2f}" for value in ratio))
        print(
            f"  most changes {loop['changes'].max():.0f}, reversals {loop['reversals'].max():.0f}"
        )
        for speed in SPEEDS:
            found = ratios(law, speed)
            print(f"{law}, {speed:g} m/s: mean {found.mean():.3f}, worst {found.max():.3f}")
            print("  " + " ".join(f"{value:.2f}" for value in found))
