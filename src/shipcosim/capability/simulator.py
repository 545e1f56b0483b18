"""Loads of the conditions by the simulator's models: wind table, hull in the current, wave drift table."""

import numpy as np
from numpy.typing import NDArray

from shipcosim.angles import wrap
from shipcosim.capability.conditions import Condition
from shipcosim.capability.vessel import Simulated
from shipcosim.models.environment.wave_loads import drift_table, mean_drift
from shipcosim.models.environment.waves import components
from shipcosim.models.environment.wind_loads import wind_loads
from shipcosim.models.ship.hull import hull_loads

PEAK_ENHANCEMENT = 1.0
"""The conditions are Pierson-Moskowitz seas."""

SEED = 1
"""Seed of the frequencies of the waves' components. Other seeds change a load by a few percent."""


def simulated_parts(
    ship: Simulated, condition: Condition, weather_from: NDArray
) -> dict[str, NDArray]:
    """Mean loads of wind, current and waves on the ship at rest, by their sources.

    Parameters
    ----------
    ship : Simulated
    condition : Condition
    weather_from : (n,) array
        Clockwise from the bow. [rad]

    Returns
    -------
    dict of (n, 3) array
        X, Y, N of ``"wind"``, ``"current"``, ``"waves"``. [N, N, N.m]
    """
    speed = condition.wind_speed
    flow = condition.current_speed
    # The waves of the condition as components; their mean drift follows from the drift table.
    sea = components(condition.wave_height, condition.wave_period, 0.0, PEAK_ENHANCEMENT, SEED)
    # The ship is at rest, so the water flows past: a current from ahead is speed ahead through
    # water.
    ahead = flow * np.cos(weather_from)
    across = flow * np.sin(weather_from)
    loads = {
        # Each model at its own axes and arguments: apparent wind, speed through water, waves
        # relative to the ship.
        "wind": wind_loads(np.full_like(weather_from, speed), wrap(weather_from), wind=ship.wind),
        "current": hull_loads(ahead, across, np.zeros_like(ahead), hull=ship.hull),
        "waves": mean_drift(-weather_from, sea, drift_table(ship.drift.drift_table)),
    }
    # One (n, 3) array per source; scalars are broadcast over the directions.
    return {name: np.stack(np.broadcast_arrays(*XYN), axis=-1) for name, XYN in loads.items()}
