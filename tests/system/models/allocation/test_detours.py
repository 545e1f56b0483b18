"""Units that keep to one interval of angles: every load that the balance holds is given, whichever came before."""

from math import radians

import numpy as np

from shipcosim.models.allocation import optimal
from shipcosim.models.allocation.consequences import held_share, units_of

PLACES = ((-14.0, -2.0), (-14.0, 2.0), (14.0, -2.5), (14.0, 2.5))
H = 0.25  # s


def four_azimuths():
    """Two pairs; none may send its slipstream to the unit beside it, 60 deg wide."""
    values = {"yaw_lever": 14.0}
    for number, (x, y) in enumerate(PLACES, start=1):
        first = radians(-60.0 if y < 0.0 else -240.0)
        unit = {"x": x, "y": y, "thrust_max": 60e3, "thrust_rate": 4e3, "thrust_least": 1e3}
        unit |= {
            "azimuth_rate": radians(10.0),
            "azimuth_first": first,
            "azimuth_last": first + radians(300.0),
        }
        values |= {f"{name}_{number}": value for name, value in unit.items()}
    return optimal.OptimalUnitsParameters(**values)


def held_loads(parameters, runs, draw):
    """Loads in all directions, a tenth of what the units hold at most."""
    tau = draw.normal(size=(3, runs)) * [[1e4], [1e4], [1.4e5]]
    share = held_share(tuple(tau), (1.0,) * 6, units=units_of(parameters))
    return tau * np.minimum(share, 9.9) / 10.0


def test_every_load_is_given_after_any_other():
    parameters = four_azimuths()
    design = optimal.design(parameters)
    draw = np.random.default_rng(5)
    state = optimal.at_rest((np.zeros(50),) * 3, parameters=parameters)
    for _ in range(3):
        tau = held_loads(parameters, 50, draw)
        for _ in range(240):
            state = optimal.step(
                state, tuple(tau), (True,) * 6, H, parameters=parameters, design=design
            )
            for unit, f, angle in zip(design.units, state.thrusts, state.azimuths, strict=True):
                out = (angle < unit.first - 1e-9) | (angle > unit.last + 1e-9)
                assert unit.kind == "none" or not (out & (f != 0.0)).any()
        np.testing.assert_allclose(np.array(state[2:5]) / 14.0, tau / 14.0, atol=10.0)


def test_a_load_in_any_direction_is_given_from_rest():
    """Astern the mirrored units stand at the ends of their intervals, and each has to turn the other way round."""
    parameters = four_azimuths()
    design = optimal.design(parameters)
    angles = np.radians(np.arange(0.0, 360.0, 15.0))
    tau = 2e4 * np.cos(angles), 2e4 * np.sin(angles), 0.0 * angles
    state = optimal.at_rest(tau, parameters=parameters)
    for _ in range(200):
        state = optimal.step(state, tau, (True,) * 6, H, parameters=parameters, design=design)
    np.testing.assert_allclose(state[2:5], tau, atol=1.0)
