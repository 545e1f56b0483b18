"""The closed DP loop over many variations at once: the components of the co-simulation as array functions.

Components exchange as in the co-simulation: each goes from t to t + h with what the others showed at t. So a variation
follows the run of the FMUs with the same parameters and seeds.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from ships import parameters

from shipcosim.angles import wrap
from shipcosim.models.allocation import pseudo_inverse as allocation
from shipcosim.models.allocation.pseudo_inverse import AllocationParameters
from shipcosim.models.allocation.units import Allocated
from shipcosim.models.control import observer, reference, voting
from shipcosim.models.control import pid as control
from shipcosim.models.control.observer import DpShip, ObserverParameters
from shipcosim.models.control.pid import ControlParameters
from shipcosim.models.control.reference import ReferenceParameters
from shipcosim.models.control.voting import VotingParameters
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment import wave_loads, waves
from shipcosim.models.environment import weather as environment
from shipcosim.models.environment.wave_motion import wave_response
from shipcosim.models.environment.weather import EnvironmentParameters
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.propulsion import drive
from shipcosim.models.propulsion.azimuth import AzimuthParameters, azimuth_loads, azimuth_step
from shipcosim.models.propulsion.failures import Failures
from shipcosim.models.propulsion.tunnel import TunnelParameters, tunnel_loads, tunnel_step
from shipcosim.models.ship import sensors, vessel
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters
from shipcosim.models.ship.sensors import SensorFailures, SensorParameters

NORTH_EAST = math.pi / 4.0
MODERATE = dict(significant_wave_height=0.3, peak_period=5.0, waves_from=NORTH_EAST)
ROUGH = dict(significant_wave_height=0.5, peak_period=6.0, waves_from=NORTH_EAST)
WIND_8 = dict(wind_speed=8.0, wind_from=NORTH_EAST, current_speed=0.3, current_to=math.pi)
WIND_10 = dict(wind_speed=10.0, wind_from=NORTH_EAST, current_speed=0.5, current_to=math.pi)


@dataclass(frozen=True)
class DpSystem:
    """Parameter sets of the components. Any number in them may be an (m,) array, one value per variation.

    `law` allocates: whatever has `design`, `at_rest` and `step` as the module `pseudo_inverse` has them. Its states
    have the fields of `Allocated`.
    """

    hull: HullParameters
    wind: WindParameters
    drift: vessel.DriftParameters
    port: AzimuthParameters
    starboard: AzimuthParameters
    tunnel: TunnelParameters
    sensors: SensorParameters
    reference: ReferenceParameters
    ship: DpShip
    observer: ObserverParameters
    control: ControlParameters
    known_wind: WindParameters
    allocation: AllocationParameters
    mast: MastParameters
    known_mast: MastParameters
    voting: VotingParameters = VotingParameters()
    environment: EnvironmentParameters = EnvironmentParameters()
    port_azimuth_start: float = 0.0
    starboard_azimuth_start: float = 0.0
    law: Any = allocation


def dp_system(ship: str = "gunnerus-33m9") -> DpSystem:
    """The DP loop of a ship of ssp/ships, in fair weather."""
    return DpSystem(
        parameters(HullParameters, ship),
        parameters(WindParameters, ship),
        parameters(vessel.DriftParameters, ship),
        parameters(AzimuthParameters, ship, "port"),
        parameters(AzimuthParameters, ship, "starboard"),
        parameters(TunnelParameters, ship),
        parameters(SensorParameters, ship),
        parameters(ReferenceParameters, ship),
        parameters(DpShip, ship),
        parameters(ObserverParameters, ship),
        parameters(ControlParameters, ship),
        parameters(WindParameters, ship, "controller"),
        parameters(AllocationParameters, ship),
        parameters(MastParameters, ship),
        parameters(MastParameters, ship, "controller"),
    )


def with_seeds(seeds, **environment):
    """The DP loop in a sea, one variation a seed; the sensors' seed is 100 more."""
    system, seeds = dp_system(), np.asarray(seeds)
    return replace(
        system,
        environment=replace(system.environment, seed=seeds, **environment),
        sensors=replace(system.sensors, seed=seeds + 100),
    )


class Inputs(NamedTuple):
    """What comes from outside: setpoints of reference and weather, and failures."""

    x_set: Any = 0.0
    y_set: Any = 0.0
    psi_set: Any = 0.0
    wind_speed: Any = 0.0
    wind_from: Any = 0.0
    current_speed: Any = 0.0
    current_to: Any = 0.0
    port_failed: Any = False
    starboard_failed: Any = False
    tunnel_failed: Any = False
    sensor_failures: SensorFailures = SensorFailures()


class Show(NamedTuple):
    """What the ship shows the others at one time, beside her state."""

    drift: tuple
    motion: tuple | None
    apparent_wind: tuple
    through_water: tuple


class LoopState(NamedTuple):
    """All components at one time."""

    vessel: Motion
    show: Show
    means: environment.EnvironmentState
    air: tuple
    current: tuple
    units: tuple
    loads: tuple
    available: tuple
    sensors: sensors.SensorState
    voting: voting.VotingState
    reference: reference.ReferenceState
    estimate: observer.Estimate
    control: control.ControlState
    samples: int
    allocation: Allocated


class Design(NamedTuple):
    """What is computed once per run."""

    sea: waves.Waves
    drift: wave_loads.DriftTable
    observer: observer.Design
    allocation: Any


def design(system, variations):
    """Waves, gains and inverses of a system.

    Parameters
    ----------
    system : DpSystem
    variations : int
        Number m of variations.

    Returns
    -------
    Design
    """
    e, ones = system.environment, np.ones(variations)
    sea = waves.components(
        e.significant_wave_height * ones,
        e.peak_period * ones,
        e.waves_from * ones,
        e.peak_enhancement * ones,
        e.seed * np.ones(variations, int),
    )
    return Design(
        sea,
        wave_loads.drift_table(system.drift.drift_table),
        observer.design(system.ship, system.observer),
        system.law.design(system.allocation),
    )


def start(system, design, inputs, variations):
    """The loop at t = 0: ship and reference at rest in the origin, heading north."""
    zero = np.zeros(variations)
    means = environment.EnvironmentState(*(value + zero for value in inputs[3:7]))
    air = _air(0.0, means, system)
    current = environment.water_velocity(means)
    ship = Motion(zero, zero, zero, zero, zero, zero)
    show = _show(0.0, ship, air, current, system, design)
    truth = _truth(ship, show)
    measured = sensors.start(0.0, truth, inputs.sensor_failures, parameters=system.sensors, mast=system.mast)
    votes = voting.start(0.0, measured.telegrams, mast=system.known_mast, wind=system.known_wind)
    estimate = observer.at_rest(voting.measurement(votes).motion, parameters=system.observer)
    units = (
        drive.at_rest(system.port_azimuth_start + zero),
        drive.at_rest(system.starboard_azimuth_start + zero),
        drive.at_rest(0.5 * np.pi + zero),
    )
    return LoopState(
        ship,
        show,
        means,
        air,
        current,
        units,
        _loads(units, units, show, ship, system),
        (True, True, True),
        measured,
        votes,
        reference.at_rest(zero, zero, zero),
        estimate,
        control.at_rest(votes.wind.load),
        0,
        system.law.at_rest((zero, zero, zero), parameters=system.allocation),
    )


def step(t, h, state, inputs, *, system, design):
    """The loop a step later.

    Parameters
    ----------
    t, h : float
        Time at the start, and step. [s]
    state : LoopState
    inputs : Inputs
        Held over the step.
    system : DpSystem
    design : Design
        Made of the same system by `design`.

    Returns
    -------
    LoopState
    """
    means = environment.step(h, state.means, *inputs[3:7], parameters=system.environment)
    air, current = _air(t + h, means, system), environment.water_velocity(means)
    ship = _moved(state, h, system)
    units = _driven(state, inputs, h, system)
    votes, estimate, law, samples = _controlled(t, state, system, design)
    sampled = samples_due(t + h, system.sensors.period) > samples_due(t, system.sensors.period)
    return LoopState(
        ship,
        _show(t + h, ship, state.air, state.current, system, design, sampled),
        means,
        air,
        current,
        units,
        _loads(units, state.units, state.show, state.vessel, system),
        tuple(failed is False or ~np.asarray(failed) for failed in inputs[7:10]),
        sensors.step(
            t,
            state.sensors,
            _truth(state.vessel, state.show),
            inputs.sensor_failures,
            parameters=system.sensors,
            mast=system.mast,
        ),
        votes,
        reference.step(state.reference, inputs[:3], h, parameters=system.reference),
        estimate,
        law,
        samples,
        system.law.step(
            state.allocation,
            state.control[-3:],
            state.available,
            h,
            parameters=system.allocation,
            design=design.allocation,
        ),
    )


def simulate(system, events, *, variations, stop_time, h=0.05, every=1):
    """Run the loop and record it.

    Parameters
    ----------
    system : DpSystem
    events : iterable of (float, dict)
        Times in s, and fields of `Inputs` that have these values from then on; those at 0 are the start values.
    variations : int
        Number m of variations.
    stop_time : float
        Length of the run. [s]
    h : float
        Step. [s]
    every : int
        Steps from one recorded row to the next.

    Returns
    -------
    dict of str to array
        ``"time"`` (n,) and the signals of `signals`, each (n, m), named as in the co-simulation.
    """
    events = sorted(events, key=lambda event: event[0])
    made = design(system, variations)
    inputs, rows, state = Inputs(), [], None
    for k in range(round(stop_time / h) + 1):
        t = k * h
        while events and events[0][0] <= t + 1e-9:
            inputs = inputs._replace(**events.pop(0)[1])
        state = state or start(system, made, inputs, variations)
        if k % every == 0:
            rows.append(signals(t, state, system))
        state = step(t, h, state, inputs, system=system, design=made)
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def signals(t, state, system):
    """What is recorded of a state, named ``component.variable`` as in the co-simulation."""
    zero = 0.0 * state.vessel.x
    rows = {"time": t}
    rows |= _named("vessel", "x y psi u v r", state.vessel)
    rows |= _named("environment", "wind_north wind_east current_north current_east", (*state.air, *state.current))
    for name, unit, loads in zip(("port", "starboard", "tunnel"), state.units, state.loads, strict=True):
        rows |= _named(name, "thrust rpm saturated", (loads.thrust, 60.0 * unit.n, zero + unit.saturated))
    given = state.sensors.telegrams
    for i, fix in enumerate(given.positions, 1):
        rows |= _named(
            "sensors",
            f"x_{i}_meas y_{i}_meas u_{i}_meas v_{i}_meas position_{i}_valid",
            [zero + value for value in fix],
        )
    rows |= _named("sensors", "psi_1_meas psi_2_meas", [heading.psi for heading in given.compasses])
    rows |= _named("sensors", "r_meas wind_speed_meas wind_from_meas", (given.r, *given.wind[:2]))
    desired = state.reference
    rows |= _named("reference", "x_d y_d psi_d", (desired.x, desired.y, wrap(desired.psi)))
    e, law = state.estimate, state.control
    rows |= _named("controller", "x_hat y_hat psi_hat u_hat v_hat r_hat", (e.x, e.y, wrap(e.psi), e.u, e.v, e.r))
    rows |= _said(state, zero, system)
    rows |= _named("controller", "tau_X_cmd tau_Y_cmd tau_N_cmd wave_frequency_hat", (*law[-3:], e.wave_frequency))
    a = state.allocation
    values = (*a.thrusts, a.tau_X, a.tau_Y, a.tau_N)
    rows |= _named("allocator", "port_thrust_cmd starboard_thrust_cmd tunnel_thrust_cmd tau_X tau_Y tau_N", values)
    azimuths = [zero + angle for angle in a.azimuths[:2]]
    rows |= _named("allocator", "port_azimuth_cmd starboard_azimuth_cmd", azimuths)
    return rows | {"allocator.saturated": zero + a.saturated}


def _said(state, zero, system):
    """What the controller says of its sensors."""
    votes, period = state.voting, system.observer.sample_period
    positions, compasses = votes.positions, votes.compasses
    given = (*positions.fixes, *compasses.headings)
    rejected = [zero + (one.valid > use) for one, use in zip(given, (*positions.used, *compasses.used), strict=True)]
    names = "position_1_rejected position_2_rejected position_3_rejected compass_1_rejected compass_2_rejected"
    used = zero + sum(positions.used), zero + sum(compasses.used), zero + (votes.wind.wind.valid < 0.5)
    reckoned = voting.dead_reckoning_time(max(0, state.samples - 1) * period, votes, parameters=system.voting)
    return _named("controller", names, rejected) | _named(
        "controller", "positions_used compasses_used wind_rejected dead_reckoning_time", (*used, reckoned)
    )


def _named(component, names, values):
    return {f"{component}.{name}": value for name, value in zip(names.split(), values, strict=False)}


def _air(t, means, system):
    e = system.environment
    return environment.air_velocity(t, means, gust_scale=e.gust_scale, seed=e.seed)


def _show(t, ship, air, current, system, design, sampled=True):
    """What the ship shows at t, with the air and water she was given last; motion in waves where it is sampled."""
    x, y, psi, u, v, _ = ship
    hull, motion = system.hull, None
    if sampled:
        drift, motion = wave_response(
            t, x, y, psi, u, v, design.sea, design.drift, length=hull.length, breadth=hull.breadth, draught=hull.draught
        )
    else:
        drift = wave_loads.drift(t, x, y, psi, design.sea, design.drift)
    return Show(drift, motion, apparent_wind(psi, u, v, *air), vessel.through_water(psi, u, v, *current))


def _moved(state, h, system):
    """The ship a step later, under the loads of thrusters, wind and waves."""
    ship = state.vessel
    weather = wind_loads(*apparent_wind(ship.psi, ship.u, ship.v, *state.air), wind=system.wind)
    parts = (weather, state.show.drift, *(loads[-3:] for loads in state.loads))
    return vessel.step(ship, *(sum(axis) for axis in zip(*parts, strict=True)), *state.current, h, hull=system.hull)


def _driven(state, inputs, h, system):
    """The thrusters a step later."""
    u_r, v_r = state.show.through_water
    port, starboard, tunnel = state.units
    thrusts, azimuths = state.allocation.thrusts, state.allocation.azimuths
    flow = (u_r, v_r, state.vessel.r)
    failures = [Failures(failed) for failed in (inputs.port_failed, inputs.starboard_failed, inputs.tunnel_failed)]
    return (
        azimuth_step(port, thrusts[0], azimuths[0], *flow, failures[0], h, unit=system.port),
        azimuth_step(starboard, thrusts[1], azimuths[1], *flow, failures[1], h, unit=system.starboard),
        tunnel_step(tunnel, thrusts[2], u_r, failures[2], h, tunnel=system.tunnel),
    )


def _loads(units, shown, show, ship, system):
    """Loads of the thrusters with the inflow, and the neighbour's state, that they were given last."""
    flow = (*show.through_water, ship.r)
    u_r, port, starboard = flow[0], *((unit.azimuth, 60.0 * unit.n) for unit in shown[:2])
    return (
        azimuth_loads(units[0], *flow, *starboard, unit=system.port),
        azimuth_loads(units[1], *flow, *port, unit=system.starboard),
        tunnel_loads(units[2], u_r, tunnel=system.tunnel),
    )


def _controlled(t, state, system, design):
    """Votes, estimate, control state and number of samples after those that are due at t."""
    votes, estimate, law, samples = state.voting, state.estimate, state.control, state.samples
    period = system.observer.sample_period
    allocated = state.allocation[2:5]
    while samples < samples_due(t, system.observer.sample_period):
        votes, estimate = voting.step(
            samples * period,
            votes,
            state.sensors.telegrams,
            estimate,
            parameters=system.voting,
            mast=system.known_mast,
            wind=system.known_wind,
        )
        estimate = observer.step(
            estimate,
            voting.measurement(votes),
            control.known_load(law, allocated),
            ship=system.ship,
            parameters=system.observer,
            design=design.observer,
        )
        law = control.step(
            law,
            estimate,
            state.reference,
            votes.wind.load,
            period,
            ship=system.ship,
            parameters=system.control,
        )
        samples += 1
    return votes, estimate, law, samples


def _truth(ship, show):
    """What the sensors are shown: the ship in waves, and the apparent wind; nothing where they take no sample."""
    if show.motion is None:
        return None
    return sensors.Truth(*(a + b for a, b in zip(ship, show.motion, strict=True)), *show.apparent_wind)
