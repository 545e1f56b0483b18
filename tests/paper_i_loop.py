"""The DP loop of the 82.7 m vessel in array form, with many trained networks at once: one run a network."""

from typing import NamedTuple

import numpy as np
from ships import parameters

from shipcosim.learn import paper_i
from shipcosim.models.allocation.extreme_learning import Network, evaluate
from shipcosim.models.control import filtered_pid
from shipcosim.models.control.pid import Desired
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment.wave_loads import drift_table
from shipcosim.models.environment.wave_motion import wave_response
from shipcosim.models.environment.waves import components
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.propulsion import mapped
from shipcosim.models.ship import vessel
from shipcosim.models.ship.hull import HullParameters

STEP, SETTLED, RISE, END = 0.05, 60.0, 150.0, 400.0  # s
HULL, WIND, LAW = (
    parameters(kind, "osv")
    for kind in (HullParameters, WindParameters, filtered_pid.FilteredPidParameters)
)
DRIFT = drift_table(parameters(vessel.DriftParameters, "osv").drift_table)
NAMES = ("bow_1", "bow_2", "stern_1", "stern_2", "port", "starboard")
THRUSTERS = [parameters(mapped.MapParameters, "osv", name) for name in NAMES]
RATES = np.array([[STEP * thruster.command_rate] for thruster in THRUSTERS])


class Outcome(NamedTuple):
    """Of each network: largest distance from her place [m], largest heading error [rad], share of the steps in which a
    rate is broken [1]; all after a minute."""

    distance: np.ndarray
    turned: np.ndarray
    broken: np.ndarray


def networks(allocator, variants):
    """Networks of an allocator, of these cutoffs and seeds of the hidden layer, as one whose weights are arrays."""
    inputs, targets = paper_i.samples(*paper_i.read_exercise(), allocator, 6)
    found = [paper_i.fitted(inputs, targets, seed=seed, cutoff=cutoff) for cutoff, seed in variants]
    put = {
        name: np.stack([one[name] for one in found], axis=-1)
        for name in ("scale", "hidden", "bias", "output")
    }
    return Network(**put, least=targets.min(axis=0), most=targets.max(axis=0))


def sailed(found, allocator, wind_from):
    """Wind that rises from 4 to 8 m/s and waves of 2 m from one direction: paper I's test."""
    zero = np.zeros(found.bias.shape[-1])
    ship, desired, pid = (
        Motion(*(zero,) * 6),
        Desired(*(zero,) * 9),
        filtered_pid.at_rest(zero, zero, zero),
    )
    commands, real = np.zeros((6, len(zero))), [zero] * 6
    distance, turned, broken, sea = zero, zero, zero, components(2.0, 8.0, wind_from, 3.3, 1)
    for number in range(round(END / STEP)):
        t = number * STEP
        waves = wave_response(
            t, *ship[:5], sea, DRIFT, length=HULL.length, breadth=HULL.breadth, draught=HULL.draught
        )
        measured = tuple(low + wave for low, wave in zip(ship[:3], waves[1][:3], strict=True))
        pid = filtered_pid.step(pid, measured, desired, STEP, parameters=LAW)
        seen = commands if allocator == 2 else ()
        new = np.array(evaluate(found, (pid.tau_X, pid.tau_Y, pid.tau_N, *seen)))
        speed = 8.0 if t >= RISE else 4.0
        air = -speed * np.cos(wind_from) + zero, -speed * np.sin(wind_from) + zero
        loads = [waves[0], wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, *air), wind=WIND)]
        for unit, thruster in enumerate(THRUSTERS):
            asked = np.clip(new[unit], found.least[unit], found.most[unit])
            real[unit] = mapped.commanded(real[unit], asked, STEP, thruster=thruster)
            thrust = mapped.mapped_thrust(real[unit], thruster=thruster)
            loads.append(mapped.mapped_loads(thrust, ship.u, ship.v, ship.r, thruster=thruster)[2:])
        tau = (sum(load[axis] for load in loads) for axis in range(3))
        ship = vessel.step(ship, *tau, zero, zero, STEP, hull=HULL)
        if t >= SETTLED:
            broken = broken + (np.abs(new - commands) > 1.001 * RATES).any(axis=0)
            distance = np.maximum(distance, np.hypot(ship.x, ship.y))
            turned = np.maximum(turned, np.abs(ship.psi))
        commands = new
    return Outcome(distance, turned, broken * STEP / (END - SETTLED))
