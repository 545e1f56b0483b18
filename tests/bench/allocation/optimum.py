"""The exact static optimum on this ship: what every law's power is measured by, and what the ship can hold at all."""

import numpy as np
from ships import parameters

from allocation.laws import UNITS
from allocation.measures import SECTOR
from shipcosim.models.allocation.power import PowerParameters
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.allocation.sqp import AllocatedThruster
from shipcosim.models.allocation.static_optimum import Optimum, static_optimum
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads

CONES = ((-SECTOR[0], SECTOR[0]), (SECTOR[1], 2.0 * np.pi - SECTOR[1]))
MET = 1.0, 10.0  # N, N.m: what the optimum may miss of a request that counts as attainable
TURNS = np.radians(10.0)  # rad/s; the static optimum asks only whether a unit turns


def best(tau: np.ndarray, without: str | None = None) -> Optimum:
    """Optimum for loads, (n, 3), of the ship's thrusters; astern force comes from a unit turned astern."""
    ship, full = parameters(AllocationParameters), parameters(PowerParameters)
    turning = dict(
        least=0.0, least_degraded=0.0, most=ship.azimuth_thrust_max, first=-np.pi, last=np.pi
    )
    turning |= dict(
        azimuth_rate=TURNS, price=full.azimuth_full_power / ship.azimuth_thrust_max**1.5
    )
    most, beam = ship.tunnel_thrust_max, 0.5 * np.pi
    reversing = dict(least=-most, least_degraded=-most, most=most, first=beam, last=beam)
    reversing |= dict(azimuth_rate=0.0, price=full.tunnel_full_power / most**1.5)
    units = {
        "port": AllocatedThruster(x=ship.port_x, y=ship.port_y, thrust_rate=np.inf, **turning),
        "starboard": AllocatedThruster(
            x=ship.starboard_x, y=ship.starboard_y, thrust_rate=np.inf, **turning
        ),
        "tunnel": AllocatedThruster(x=ship.tunnel_x, y=0.0, thrust_rate=np.inf, **reversing),
    }
    left = [units[name] for name in UNITS if name != without]
    return static_optimum(tau, left, [CONES] * len(left), yaw_lever=ship.yaw_lever)


def met(found: Optimum) -> np.ndarray:
    """Whether the optimum gives the load, (n,)."""
    return (np.abs(found.missed[:, :2]) < MET[0]).all(-1) & (np.abs(found.missed[:, 2]) < MET[1])


def held_without(unit: str, speed: float = 10.0, wind_from: float = 0.25 * np.pi) -> bool:
    """Whether the thrusters balance the mean wind on the ship, heading north, without one of them. [m/s, rad]"""
    air = -speed * np.cos(wind_from), -speed * np.sin(wind_from)
    load = wind_loads(*apparent_wind(0.0, 0.0, 0.0, *air), wind=parameters(WindParameters))
    return bool(met(best(-np.array([load]), unit))[0])
