"""Energy that a hull takes from still water: damping takes it out, so a model that gains some is wrong there.

Coriolis loads of mass and added mass do no work at any velocity, whichever coefficients hold them. So the power of the
whole hull load is that of its damping.
"""

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, fields
from math import inf
from typing import Any, NamedTuple

import numpy as np

from shipcosim.errors import Problem
from shipcosim.models.core.parameters import left_out
from shipcosim.models.ship.hull import HullParameters, hull_loads

DP_SPEED = 0.5
"""Largest u and v of DP, and largest sideways speed of the bow by turning, which bounds r. Assumed. [m/s]"""
STEPS = 21
"""Values of each of u, v and r that are tried. [1]"""
ROUNDING = 1e-9
"""Share of the power of a load's parts that rounding can leave. [1]"""


class EnergyGain(NamedTuple):
    """Where a hull gains energy from still water at speeds of DP, and how much.

    Attributes
    ----------
    share : float
        Of the states of DP. [1]
    u, v, r : float
        State in which she gains most. [m/s, m/s, rad/s]
    power : float
        There. [W]
    growth : float
        Power over kinetic energy there. [1/s]
    """

    share: float
    u: float
    v: float
    r: float
    power: float
    growth: float


def turning_rate_of_dp(hull: HullParameters) -> float:
    """Largest yaw rate of DP, at which the bow moves sideways as fast as the ship may. [rad/s]"""
    return 2.0 * DP_SPEED / hull.length


def energy_gain(hull: HullParameters) -> EnergyGain | None:
    """Find states of DP in which still water drives a hull; None where it takes energy out of all.

    Parameters
    ----------
    hull : HullParameters
    """
    # A grid over all directions of motion up to the speeds of DP.
    speeds = np.linspace(-DP_SPEED, DP_SPEED, STEPS)
    rates = np.linspace(-1.0, 1.0, STEPS) * turning_rate_of_dp(hull)
    motion = np.stack([axis.ravel() for axis in np.meshgrid(speeds, speeds, rates)])
    # Power of the loads; numbers that are impossible have remarks of their own.
    with np.errstate(all="ignore"):
        powers = motion * np.stack(hull_loads(*motion, hull=hull))
    power = powers.sum(axis=0)
    gains = power > ROUNDING * np.abs(powers).sum(axis=0)
    if not gains.any():
        return None
    # Kinetic energy with the added mass, where most is gained.
    worst = int(np.argmax(np.where(gains, power, 0.0)))
    u, v, r = motion[:, worst].tolist()
    mass, inertia = hull.rigid_body
    coupling = mass * hull.centre_of_gravity_x + 0.5 * (hull.A26 + hull.A62)
    energy = 0.5 * ((mass + hull.A11) * u**2 + (mass + hull.A22) * v**2)
    energy += 0.5 * (inertia + hull.A66) * r**2 + coupling * v * r
    most = float(power[worst])
    return EnergyGain(float(gains.mean()), u, v, r, most, most / energy if energy > 0.0 else inf)


def driven_by_water(where: str, values: Mapping[str, Any]) -> Iterator[Problem]:
    """Remark on a hull that gains energy from still water at speeds of DP.

    Parameters
    ----------
    where : str
        Her file, and what stands in it.
    values : mapping
        Parameters of the vessel by name, in SI. Of a hull that is not complete nothing is said.
    """
    declared = fields(HullParameters)
    numbers = ((field.name, values.get(field.name)) for field in declared)
    given = {name: value for name, value in numbers if isinstance(value, int | float)}
    needed = {field.name for field in declared if field.default is MISSING}
    if not needed <= given.keys() or any(map(left_out, given.values())) or given["length"] <= 0.0:
        return
    hull = HullParameters(**given)
    gain = energy_gain(hull)
    if gain is None:
        return
    rate = np.degrees(turning_rate_of_dp(hull))
    message = (
        f"still water drives her in {100.0 * gain.share:.2g} % of the states of DP (u and v up to {DP_SPEED:g} m/s, r up "
        f"to {rate:.2g} deg/s). It gives her most, {gain.power:.3g} W, at u {gain.u:.2g} m/s, v {gain.v:.2g} m/s, "
        f"r {np.degrees(gain.r):.2g} deg/s. Her kinetic energy grows there by {100.0 * gain.growth:.2g} % a second."
    )
    yield Problem(
        where,
        message,
        "Still water brakes a ship: correct her damping, or add linear damping X_u, Y_v, N_r.",
        "remark",
    )
