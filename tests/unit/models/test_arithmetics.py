"""Every public model function gives the same in floats, NumPy arrays and torch tensors.

To add a function, add a case: the function, some rows of its scalar arguments, and what it takes besides. A function
whose docstring speaks of an "array or tensor" and that is in no case fails the last test.
"""

import importlib
import inspect
import pkgutil
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
import pytest
from ships import parameters

import shipcosim.models
from shipcosim import angles
from shipcosim.models.allocation import (
    box_qp,
    cones,
    consequences,
    extended,
    extreme_learning,
    fixed_angles,
    monitor,
    optimal,
    power,
    sqp,
    units,
)
from shipcosim.models.allocation import pseudo_inverse as allocation
from shipcosim.models.allocation.power import PowerParameters
from shipcosim.models.allocation.units import Allocated
from shipcosim.models.control import (
    compass_voting,
    filtered_pid,
    observer,
    position_voting,
    reference,
    steering_trial,
    voting,
    wave_filter,
)
from shipcosim.models.control import pid as control
from shipcosim.models.core import integrate, interpolation, kinematics, maths, memoize
from shipcosim.models.core.motion import Motion
from shipcosim.models.environment import (
    current,
    gusts,
    harbour,
    sinusoids,
    wave_loads,
    wave_motion,
    waves,
)
from shipcosim.models.environment import earth_fixed_loads as earth
from shipcosim.models.environment import wind_loads as wind
from shipcosim.models.prediction import (
    controlled,
    dead_reckoning,
    motion_filter,
    outage,
    own_model,
    own_record,
    predictor_inputs,
    regions,
    surroundings,
)
from shipcosim.models.propulsion import (
    azimuth,
    drive,
    fixed,
    interaction,
    mapped,
    propeller,
    rudder,
    slipstream,
    tunnel,
)
from shipcosim.models.propulsion.failures import Failures
from shipcosim.models.ship import hull, instruments, mast, rough_form, vessel
from shipcosim.models.ship.sensor_messages import Fix, Heading, Telegrams, Wind

SHORT = parameters(hull.HullParameters, "gunnerus-28m9", "vessel")
LONG = parameters(hull.HullParameters, "gunnerus-33m9", "vessel")
PORT = parameters(azimuth.AzimuthParameters, "gunnerus-33m9", "port")
LOSSES = dict(
    thrust_loss=0.1, reverse_loss=0.2, azimuth_offset=0.1, rpm_offset=5.0, interaction_loss=0.3
)
LOSSY = replace(PORT, **LOSSES)
TUNNEL = parameters(tunnel.TunnelParameters)
TANKER = parameters(hull.HullParameters, "kvlcc2", "vessel")
STERN = parameters(rudder.PropellerRudderParameters, "kvlcc2")
MAPPED = mapped.MapParameters(
    x=-0.4, y=0.3, thrust_table="-1 -28; 0 0; 1 55", speed_loss=0.1, time_constant=0.5
)
BERTH = dict(
    harbour=harbour.HarbourParameters(
        wind_shelter=0.5, tide_shelter=0.6, channel=0.4, river_speed=0.5
    )
)
LAYOUT = fixed_angles.FixedAngleParameters(
    **{"x_1": -20.0, "y_1": -3.0, "thrust_min_1": -6e4, "thrust_max_1": 9e4, "thrust_rate_1": 1e6},
    **{"x_2": -20.0, "y_2": 3.0, "thrust_min_2": -6e4, "thrust_max_2": 9e4, "thrust_rate_2": 1e6},
    **{
        "x_3": 22.0,
        "azimuth_3": 1.6,
        "thrust_min_3": -4e4,
        "thrust_max_3": 4e4,
        "thrust_rate_3": 1e6,
    },
    yaw_lever=22.0,
)
ROW = interaction.InteractionParameters(
    y_1=-2.0, diameter_1=1.9, y_2=2.0, diameter_2=1.9, x_3=20.0, diameter_3=1.5
)
TURNING = parameters(optimal.OptimalParameters)
TURNING_DESIGN = optimal.design(TURNING)
TURNING_ROWS = [
    (f, 2e3, -1e3, X, Y, N, on)
    for f, X, Y, N in ((1e3, 5e3, -4e3, 2e4), (5e3, 9e3, 7e4, 1e5), (2e3, -2e5, 0.0, 9e5))
    for on in (True, False)
]
TURNING_UNITS = optimal.OptimalUnitsParameters(
    **{"x_1": -20.0, "y_1": -3.0, "thrust_max_1": 9e4, "thrust_rate_1": 1e3, "azimuth_rate_1": 0.2},
    **{"x_2": -20.0, "y_2": 3.0, "thrust_max_2": 9e4, "thrust_rate_2": 1e3, "azimuth_rate_2": 0.2},
    **{
        "x_3": 22.0,
        "azimuth_3": 1.6,
        "thrust_min_3": -3e4,
        "thrust_max_3": 4e4,
        "thrust_rate_3": 1e3,
    },
    yaw_lever=22.0,
)
EXTENDED = parameters(extended.ExtendedParameters)
SIDE = replace(parameters(fixed.FixedParameters, "otter"), speed_loss=0.2, direction=0.3)
ERRORS = dict(heading_bias=0.05, lever_x=3.0, lever_y=-1.0, velocity_scale=1.1)
SEA = waves.components(0.5, 6.0, 0.3, 3.3, 1)
DRIFT = wave_loads.drift_table(parameters(vessel.DriftParameters).drift_table)
BOX = dict(length=33.9, breadth=9.6, draught=2.7)
XS, YS = (-1.0, 0.0, 0.5, 2.0), (3.0, -1.0, 4.0, 4.0)
EVEN = interpolation.even_table(np.linspace(-1.0, 1.0, 4), np.array(YS), np.array(XS))

ANGLES = [(-3.0,), (-pi / 2,), (0.0,), (0.4,), (3.1,)]
PAIRS = [(0.3, -0.2), (-1.0, 1.0), (2.0, 2.5), (0.4, 0.4)]
WATER = [
    (0.5, 0.1, 0.01),
    (-0.4, 0.3, -0.05),
    (3.0, -0.2, 0.03),
    (0.0, 0.0, 0.0),
    (1.0, 0.1, 0.0),
    (0.0, 0.01, 0.1),
]
SHIP = [(1.0, -2.0, 3.1, 2.0, 0.3, 0.05), (0.0, 0.0, -1.0, -0.2, -0.1, -0.01)]


@dataclass(frozen=True)
class Case:
    """A function, rows of scalar arguments, how they are put together, and what stays the same."""

    function: object
    rows: list
    arrange: object = lambda *row: row
    constants: dict = field(default_factory=dict)

    def __call__(self, *row):
        return flat(self.function(*self.arrange(*row), **self.constants))

    def __str__(self):
        return f"{self.function.__module__.rpartition('.')[2]}.{self.function.__name__}"


ROUGH = rough_form.RoughFormParameters(
    strip_factors="-1 1.3; 0 1; 1 0.8",
    cross_flow_power=1.9,
    drag_power=2.1,
    wind_factors="0 1 1 1; 90 1.1 0.9 1.2; 360 1 1 1",
    memory_sway=0.2,
)
DP_SHIP, NOISE, UNITS = (
    parameters(observer.DpShip),
    parameters(observer.ObserverParameters),
    parameters(allocation.AllocationParameters),
)
LOOP = [
    (1.0, -2.0, 3.0, 0.1, -0.2, 0.02, 3.0, 2.0, 2.9, 0.2, -0.1, 0.01, 0.1, 0.0, -0.1),
    (9.0, 8.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.5),
]
POWER, WATCH = parameters(PowerParameters), monitor.MonitorParameters()
OBSERVER = dict(ship=DP_SHIP, parameters=NOISE, design=observer.design(DP_SHIP, NOISE))
AHEAD = dict(
    horizons=(10.0, 20.0), longest_step=2.0, hull=LONG, wind=parameters(wind.WindParameters)
)
LEARNED = parameters(extreme_learning.ExtremeLearningParameters, "osv")
LAYER = extreme_learning.Network(
    scale=(1e5, 1e5, 1e6, *(30.0,) * 6),
    hidden=tuple(tuple(0.1 * ((3 * i + 7 * j) % 11 - 5) for i in range(9)) for j in range(4)),
    bias=(0.1, 0.4, -0.2, 0.0),
    output=tuple(tuple(40.0 * ((5 * i + 3 * j) % 7 - 3) for i in range(4)) for j in range(6)),
    least=(-40.0,) * 6,
    most=(50.0,) * 6,
)
PLAIN = parameters(filtered_pid.FilteredPidParameters, "osv")
AHEAD_LOOP = controlled.ControlLoop(
    parameters(reference.ReferenceParameters),
    DP_SHIP,
    parameters(control.ControlParameters),
    parameters(allocation.AllocationParameters),
    allocation.design(parameters(allocation.AllocationParameters)),
    parameters(controlled.ObserverAhead),
)
ASSUMED = parameters(surroundings.SurroundingsParameters)
RECKONING = motion_filter.FilterNumbers(
    **dict(
        bow=2e-7,
        stern=1e-7,
        ahead=4e-5,
        astern=5e-5,
        surge_time=40.0,
        sway_time=30.0,
        wind_surge_1=-1e-5,
    ),
    **dict(
        wind_surge_3=1e-6,
        wind_sway_1=-4e-5,
        wind_sway_3=-2e-6,
        position_by_position=0.1,
        position_by_velocity=0.2,
    ),
    **dict(
        velocity_by_position=0.01,
        velocity_by_velocity=0.05,
        load_by_position=1e-4,
        load_by_velocity=5e-4,
    ),
    **dict(
        position_in_sea=1.0, velocity_in_sea=0.5, load_in_sea=2.0, load_time=100.0, mean_time=200.0
    ),
)
REGION = outage.Region((0.0, 30.0, 60.0), (0.5, 1.0, 2.0), 3.0)
AROUND = dict(hull=LONG, wind=parameters(wind.WindParameters), ship=DP_SHIP, parameters=ASSUMED)
REQUESTS = [(5e3, -4e3, 2e4), (9e3, 7e4, 1e5), (-2e5, 0.0, 9e5)]


def of_vessel(*row):
    return Motion(*row[:6]), *row[6:]


def of_thruster(*row):
    return drive.Thruster(*row[:5], False, 0.0), *row[5:]


def of_failing_thruster(*row):
    """The last number says which failures there are, bit by bit; a quarter of rates and power is left with some."""
    bits = [row[-1] // 2**i % 2 > 0.5 for i in range(6)]
    share = maths.where(row[-1] > 0.5, 0.25, 1.0)
    thruster, *inputs = of_thruster(*row[:-1])
    return thruster, *inputs, Failures(*bits, share, 1e5 * share)


def of_reference(*row):
    return reference.ReferenceState(*row[:12]), row[12:15]


def of_trial(*row):
    return steering_trial.TrialState(*row[:13]), 2.0, row[13:], 0.5


def of_observer(*row):
    return (
        observer.StateEstimate(*row, 0.8, 30.0, 0.7),
        observer.Measurement(Motion(*row[3:9]), row[8], 1.0),
        row[9:12],
    )


def of_control(*row):
    return (
        control.ControlState(*row[:6]),
        observer.StateEstimate(*row),
        control.Desired(*row[6:]),
        row[3:6],
    )


def of_filtered_pid(*row):
    return filtered_pid.FilteredPidState(*row[:12]), row[12:15], control.Desired(*row[3:12])


def of_allocation(*row):
    state = Allocated(row[:3], (-0.8, 0.8, 1.6), *row[:3], False)
    return state, row[3:6], (True, row[6], True)


def of_layout(*row):
    state = Allocated((*row[:3], *(0.0 * row[0],) * 3), (0.1,) * 6, *row[:3], False)
    return state, row[3:6], (True, row[6], True, True, True, True)


def of_turning(*row):
    """Port, starboard and tunnel at angles of their intervals, with a price of each load."""
    zero = 0.0 * row[0]
    state = sqp.Turned(
        row[:3],
        (zero + 0.9, zero + 2.1, zero + 0.5 * pi),
        *row[:3],
        False,
        (zero + 1.0, zero, zero),
    )
    return state, row[3:6], (True, row[6], True)


def of_cones(*row):
    state, tau, available = of_turning(*row)
    return cones.cones_at_rest(state, tau, design=TURNING_DESIGN), tau, available


def of_turning_units(*row):
    state, tau, (_, on, _) = of_turning(*row)
    zero = 0.0 * row[0]
    state = state._replace(
        thrusts=(*row[:3], zero, zero, zero), azimuths=(*state.azimuths, zero, zero, zero)
    )
    state = cones.cones_at_rest(state, tau, design=optimal.design(TURNING_UNITS))
    return state, tau, (True, on, True, True, True, True)


def of_program(*row):
    directions = ((1.0, 0.2, 3.0), (0.1, 1.0, -2.0), (-0.3, 0.4, 5.0), (0.6, -0.8, 1.0))
    return (
        row[:3],
        [box_qp.Command(*d, 1.0 + row[3], row[4], -0.5, 1.5) for d in directions],
        (1e-3, 1e-3, 1e-2),
    )


def of_learned(*row):
    zero = 0.0 * row[0]
    state = extreme_learning.Commanded(
        (zero,) * 6, (zero,) * 6, *(zero,) * 4, tuple(0.01 * one for one in row[:3]) * 2
    )
    return state, row[3:6], (True, row[6], True, True, True, True)


def of_monitor(*row):
    """Deviations of all units, a time already beyond, and an error of the ship."""
    state = monitor.MonitorState(5.9, *(row[1] for _ in range(5)))
    return state, (row[0],) * 3, (True, True, False), (row[2], -row[2]), (1e4 * row[2], 0.0)


def of_known(*row):
    ship = Motion(*row)
    return predictor_inputs.Known(
        ship, (4e3 * ship.u, -3e3, 1e4), (1e3, 2e3, -3e4), 8.0 + ship.v, ship.r - 2.0, 0.7
    )


def of_surroundings(*row):
    start = of_known(*row)
    return surroundings.unknown(start, hull=AROUND["hull"], parameters=ASSUMED), start


def of_outage(*row):
    """What is aboard, with and without GNSS."""
    x, y, psi, u, v, r = row
    valid = 1.0 * (x > 0.5)
    return outage.Measured(
        x, y, u, v, valid, psi, 5.0 + u, r - 2.0, (60.0 * u, -20.0, v, 3.0, 9.0 * u, -4.0 * u)
    )


def of_reckoning(*row):
    zero = 0.0 * row[0]
    return motion_filter.State(
        *row[:2], *row[3:5], 1e-3, -2e-3, 5e-4, zero, 0.01 + zero, 20.0 * (row[0] < 0.5)
    ), of_outage(*row)


def of_prediction(*row):
    start = of_known(*row)
    return start, surroundings.Surroundings(
        -6.0, 3.0, 0.2, -0.1, 2e2, 5e2 + 0.0 * start.ship.u, 1e3, (), (1e2, 2e2, 3e3)
    )


def of_loop(*row):
    """On the way to a place, with the wind half believed."""
    start, around = of_prediction(*row)
    wanted = control.Desired(*(0.9 * value for value in row[:3]), 0.1, 0.0, 0.01, -1e-3, 0.0, 1e-4)
    goal = row[0] + 5.0, row[1], row[2] + 0.5
    return start._replace(desired=wanted, goal=goal, wave_frequency=1.0 + 0.1 * row[3]), around


def of_fixes(*row):
    return tuple(Fix(*row[i : i + 2], 0.2, -0.1, 1.0 + 0.0 * row[i]) for i in (0, 2, 4))


def of_positions(*row):
    """The telegrams after others, when one of them has moved."""
    before = position_voting.start(0.0, of_fixes(*(0.5 * value for value in row[:6])))
    before = before._replace(
        trusted_at=-row[9], memory=row[:6], north_shift=row[6], east_shift=row[7]
    )
    return 0.0, before, of_fixes(*row), Motion(*row[6:9], 0.2, -0.1, 0.0), 0.0 * row[0], 1.0


def of_compasses(*row):
    before = compass_voting.start(tuple(Heading(0.9 * psi, 1.0 + 0.0 * psi) for psi in row[:2]))
    given = tuple(Heading(psi, 1.0 + 0.0 * psi) for psi in row[:2])
    return before._replace(apart=row[4]), given, row[2], row[3], 0.0 * row[0], 0.1


def of_voting(*row):
    headings = tuple(Heading(psi, 1.0 + 0.0 * psi) for psi in row[6:8])
    return Telegrams(
        of_fixes(*row), headings, row[8], Wind(row[9], row[7], 1.0 + 0.0 * row[9]), 0.0, 0.0, 0.0
    )


def of_votes(*row):
    """Voting that has gone on for 2 s, and the estimate."""
    state = voting.start(0.0, of_voting(*row), **AIR)
    estimate = observer.StateEstimate(*row[6:], *(0.0 * row[0],) * 11)
    later = of_voting(*(1.01 * value for value in row))._replace(
        position_time=2.0, heading_time=2.0, wind_time=2.0
    )
    return voting.step(2.4, state, later, estimate, parameters=voting.VotingParameters(), **AIR)


def of_votes_alone(*row):
    return of_votes(*row)[:1]


FIXES = [
    (0.1, 0.2, -0.1, 0.1, 0.2, -0.2, 0.0, 0.1, 0.3, 0.0),
    (0.1, 0.2, -0.1, 0.1, 7.0, -0.2, 0.0, 0.1, 0.3, 0.0),
    (9.1, 0.2, 9.2, 0.1, 9.4, -0.2, 0.0, 0.1, 3.1, 0.5),
    (9.1, 0.2, 9.2, 0.1, 9.4, -0.2, 0.0, 0.1, 3.1, 90.0),
]
BELIEF, MAST = (
    voting.VotingParameters(),
    mast.MastParameters(mast_x=3.0, mast_y=-1.0, mast_height=15.0),
)
AIR = dict(mast=MAST, wind=parameters(wind.WindParameters))
CASES = [
    *(
        Case(f, [(8.0, -2.0, *w) for w in WATER], constants=dict(mast=MAST))
        for f in (mast.wind_at_mast, mast.wind_from_mast)
    ),
    Case(position_voting.start, FIXES, lambda *row: (0.0, of_fixes(*row))),
    Case(position_voting.step, FIXES, of_positions, dict(parameters=BELIEF)),
    Case(
        position_voting.faded,
        FIXES,
        lambda *row: (of_positions(*row)[1], 0.1),
        dict(parameters=BELIEF),
    ),
    Case(
        compass_voting.start,
        PAIRS,
        lambda *row: (tuple(Heading(psi, 1.0 + 0.0 * psi) for psi in row),),
    ),
    Case(
        compass_voting.step,
        [(3.1, -3.1, 0.01, 3.12, 0.0), (0.3, 0.5, 0.0, 0.3, 0.2)],
        of_compasses,
        dict(parameters=BELIEF),
    ),
    Case(voting.start, FIXES, lambda *row: (0.0, of_voting(*row)), AIR),
    Case(of_votes, FIXES),
    Case(voting.measurement, FIXES, of_votes_alone),
    Case(
        voting.dead_reckoning_time,
        FIXES,
        lambda *row: (4.0, *of_votes_alone(*row)),
        dict(parameters=BELIEF),
    ),
    *(Case(getattr(maths, name), ANGLES) for name in ("sin", "cos", "exp", "floor")),
    Case(angles.wrap, ANGLES),
    *(Case(getattr(maths, name), PAIRS) for name in ("atan2", "hypot", "minimum", "maximum")),
    Case(maths.sqrt, [(0.3,), (4.0,)]),
    Case(maths.clip, [(0.3, -1.0, 0.2), (0.1, -1.0, 0.2), (-3.0, -1.0, 0.2)]),
    Case(maths.where, [(True, 0.3, 0.7), (False, 0.3, 0.7)]),
    Case(
        interpolation.interp,
        [(-2.0,), (-1.0,), (0.3,), (0.5,), (5.0,)],
        constants=dict(xs=XS, ys=YS),
    ),
    Case(maths.number, ANGLES),
    Case(maths.row_of, [(0.3, 1.0), (-0.2, 2.0)], arrange=lambda x, y: ((x, y), 1)),
    Case(maths.sincos, ANGLES),
    Case(interpolation.interp_even, [(-1.0,), (0.3,), (1.0,)], constants=dict(table=EVEN)),
    Case(
        interpolation.interp_columns, [(-2.0,), (0.3,), (5.0,)], arrange=lambda x: (x, XS, YS, XS)
    ),
    Case(integrate.rk4, PAIRS, arrange=lambda x, y: (lambda x, y: (y, -maths.sin(x)), (x, y), 0.1)),
    Case(
        integrate.rk4_pair,
        PAIRS,
        arrange=lambda x, y: (lambda x, y: (y, -maths.sin(x)), x, y, 0.1, (), (), ()),
    ),
    Case(integrate.euler, PAIRS, arrange=lambda x, y: ((x, y), (y, -maths.sin(x)), 0.1)),
    *(
        Case(rule, SHIP, arrange=lambda *row: (lambda u, v, r: (r * v, -r * u, 0.1 * v), *row, 0.1))
        for rule in (integrate.rk4_motion, integrate.midpoint_motion)
    ),
    Case(kinematics.to_ned, [(0.4, 1.0, -2.0), (-2.0, 0.3, 0.1)]),
    Case(kinematics.to_body, [(0.4, 1.0, -2.0), (-2.0, 0.3, 0.1)]),
    Case(kinematics.eta_dot, [(0.4, 1.0, -2.0, 0.1), (-2.0, 0.3, 0.1, 0.0)]),
    Case(kinematics.moved, [(3.0, -3.0, 0.1), (0.1, 0.3, 0.5), (-3.0, 3.0, 0.1)]),
    Case(kinematics.turned, [(3.0, -3.0, 0.1), (0.1, 0.3, 0.5), (-3.0, 3.0, 0.1)]),
    Case(kinematics.velocity_at, [(-14.0, 2.0, 1.0, 0.2, 0.1), (13.0, 0.0, 1.0, 0.2, -0.1)]),
    Case(kinematics.load_at, [(-14.0, 2.0, 1e3, 2e3), (13.0, 0.0, 1e3, -2e3)]),
    *(Case(hull.hull_loads, WATER, constants=dict(hull=ship)) for ship in (LONG, SHORT, TANKER)),
    *(Case(load, WATER, constants=dict(hull=SHORT)) for load, _ in hull.CONTRIBUTIONS.values()),
    Case(vessel.accelerations, [(*w, 1e3, -2e3, 3e4) for w in WATER], constants=dict(hull=LONG)),
    Case(vessel.through_water, [(0.4, 1.0, -0.2, 0.3, 0.1), (-3.0, 0.0, 0.2, -0.3, 0.1)]),
    Case(
        vessel.at_present,
        [(*s, 1e3, -2e3, 3e4, 0.3, -0.4) for s in SHIP],
        of_vessel,
        dict(hull=SHORT),
    ),
    Case(
        vessel.step,
        [(*s, 1e3, -2e3, 3e4, 0.3, -0.4) for s in SHIP],
        of_vessel,
        dict(h=0.5, hull=SHORT),
    ),
    Case(rough_form.form_loads, WATER, constants=dict(hull=LONG, form=ROUGH)),
    Case(
        rough_form.memory_loads,
        [(*w, *w[::-1]) for w in WATER],
        lambda *row: (row[:3], row[3:]),
        dict(h=0.5, hull=LONG, form=ROUGH),
    ),
    Case(
        rough_form.rough_wind_loads,
        [(8.0, -2.0), (5.0, 0.0), (3.0, 3.14)],
        constants=dict(wind=parameters(wind.WindParameters), form=ROUGH),
    ),
    Case(wind.apparent_wind, [(0.4, 1.0, -0.2, -8.0, 3.0), (-3.0, 0.0, 0.2, 5.0, 6.0)]),
    *(
        Case(wind.wind_loads, [(8.0, -2.0), (5.0, 0.0), (3.0, 3.14)], constants=dict(wind=vane))
        for vane in (
            parameters(wind.WindParameters),
            replace(parameters(wind.WindParameters), apparent_wind_offset=0.2),
        )
    ),
    Case(
        propeller.propeller_loads,
        [(*p,) for p in PAIRS] + [(0.0, 0.0), (1.0, 0.0)],
        constants=dict(propeller=PORT),
    ),
    Case(propeller.bollard_speed, [(5e3,), (-5e3,), (0.0,)], constants=dict(propeller=PORT)),
    Case(propeller.bollard_torque, [(2.0,), (-2.0,), (0.0,)], constants=dict(propeller=PORT)),
    Case(drive.at_rest, ANGLES),
    Case(
        drive.powers,
        [(2.0, 0.0, 0.0, 0.0, 5e3), (-2.0, 0.0, 0.0, 0.0, 5e3), (0.0, 0.0, 0.0, 0.0, 1e3)],
        of_thruster,
        dict(drive=PORT),
    ),
    Case(
        azimuth.azimuth_step,
        [
            (0.5, 100.0, 900.0, 3.0, 500.0, 2e4, -3.0, *w, bits)
            for w in WATER
            for bits in (0.0, 1.0, 2.0, 12.0, 48.0)
        ],
        of_failing_thruster,
        dict(h=0.05, unit=PORT),
    ),
    Case(
        slipstream.slipstream_share,
        [(-1.0, 2.0, a, n) for a in (-2.0, 0.4) for n in (90.0, 0.0, -5.0)],
        constants=dict(width=0.4),
    ),
    Case(interaction.tandem_share, [(1.0,), (8.0,)]),
    Case(interaction.kept_share, [(0.2, 0.3, 0.5), (-3.0, 0.6, 2.0), (0.0, 0.3, 1.0)]),
    Case(
        interaction.thrust_shares,
        [(1.3, 0.2, -3.0, 5.0, 4.0, -2.0), (-1.6, 1.6, 0.1, 1.0, 0.0, 9.0)],
        lambda *row: ((*row[:3], *row[:3]), (*row[3:], *row[3:])),
        dict(unit_pairs=interaction.pairs(ROW)),
    ),
    *(
        Case(azimuth.azimuth_given, [(n, 0.4) for n in (2.0, -1.0)], constants=dict(unit=unit))
        for unit in (PORT, LOSSY)
    ),
    *(
        Case(
            azimuth.azimuth_replay,
            [(n, 0.4, *w) for n in (2.0, -1.0) for w in WATER],
            constants=dict(unit=unit),
        )
        for unit in (PORT, LOSSY)
    ),
    *(
        Case(
            azimuth.azimuth_loads,
            [(n, 0.0, 0.0, 0.4, 0.0, *w, 1.6, 70.0) for n in (2.0, -1.0) for w in WATER],
            of_thruster,
            dict(unit=unit),
        )
        for unit in (PORT, LOSSY)
    ),
    Case(
        tunnel.tunnel_step,
        [(9.0, 10.0, 900.0, 1.6, 50.0, 2e4, 1.0, bits) for bits in (0.0, 1.0, 2.0, 4.0, 16.0)],
        of_failing_thruster,
        dict(h=0.05, tunnel=TUNNEL),
    ),
    Case(tunnel.tunnel_replay, [(9.0,), (-20.0,)], constants=dict(tunnel=TUNNEL)),
    Case(tunnel.tunnel_loads, [(9.0, 0.0, 0.0, 1.6, 0.0, 0.5)], of_thruster, dict(tunnel=TUNNEL)),
    Case(
        fixed.fixed_loads,
        [
            (F, n, *w)
            for F, n in ((30.0, 0.0), (-20.0, 0.0), (0.0, 60.0), (0.0, -50.0))
            for w in WATER
        ],
        constants=dict(thruster=SIDE),
    ),
    Case(
        fixed.shaft_speed,
        [(30.0, 0.0), (-20.0, 0.0), (0.0, 60.0), (10.0, -50.0), (0.0, 0.0)],
        constants=dict(thruster=SIDE),
    ),
    Case(extreme_learning.at_rest, REQUESTS, lambda *row: (row,), dict(parameters=LEARNED)),
    Case(
        extreme_learning.step,
        [(0.0, 1e3, 0.0, X, Y, N, on) for X, Y, N in REQUESTS for on in (True, False)],
        of_learned,
        dict(h=0.05, parameters=LEARNED, design=LAYER),
    ),
    Case(
        extreme_learning.evaluate,
        [(*row, 20.0, -30.0, 4.0, 0.0, 1.0, 9.0) for row in REQUESTS],
        lambda *row: (LAYER, row),
    ),
    Case(filtered_pid.at_rest, [(1.0, -2.0, 3.0)]),
    Case(
        filtered_pid.errors,
        [(1.0, -2.0, 3.0, *LOOP[0][:9])],
        lambda *row: (filtered_pid.at_rest(*row[:3]), control.Desired(*row[3:])),
    ),
    Case(filtered_pid.step, LOOP, of_filtered_pid, dict(h=0.05, parameters=PLAIN)),
    Case(mapped.mapped_thrust, [(-2.0,), (-0.4,), (0.0,), (0.7,)], constants=dict(thruster=MAPPED)),
    Case(mapped.within_map, [(-50.0,), (0.0,), (70.0,)], constants=dict(thruster=MAPPED)),
    Case(mapped.mapped_step, [(3.0, 10.0), (-5.0, 0.0)], constants=dict(h=0.1, thruster=MAPPED)),
    Case(mapped.mapped_command, [(-50.0,), (0.0,), (7.0,)], constants=dict(thruster=MAPPED)),
    Case(
        mapped.commanded,
        [(0.3, 0.4), (0.3, -1.0), (0.0, 1.0)],
        constants=dict(h=0.1, thruster=replace(MAPPED, command_rate=2.0)),
    ),
    Case(
        mapped.mapped_loads,
        [(F, *w) for F in (30.0, -20.0, 0.0) for w in WATER],
        constants=dict(thruster=MAPPED),
    ),
    Case(fixed_angles.at_rest, REQUESTS, lambda *row: (row,), dict(parameters=LAYOUT)),
    Case(
        fixed_angles.step,
        [(0.0, 1e3, 0.0, X, Y, N, on) for X, Y, N in REQUESTS for on in (True, False)],
        of_layout,
        dict(h=0.5, parameters=LAYOUT, design=fixed_angles.design(LAYOUT)),
    ),
    Case(
        optimal.step,
        TURNING_ROWS,
        of_cones,
        dict(h=0.5, parameters=TURNING, design=TURNING_DESIGN),
    ),
    Case(
        consequences.held_share,
        [(X, Y, N) for _, _, _, X, Y, N, _ in TURNING_ROWS],
        lambda *tau: (tau, (1.0, 0.0, 1.0)),
        dict(units=TURNING_DESIGN.balance.units),
    ),
    Case(sqp.power_step, TURNING_ROWS, of_turning, dict(h=0.05, design=TURNING_DESIGN)),
    Case(
        sqp.is_within,
        [(0.1, 0.0, 1.0), (1.2, 0.0, 1.0), (1.0 + 1e-12, 0.0, 1.0)],
        lambda *row: row,
        {},
    ),
    Case(sqp.resting, [(1.0, -2.0, 0.4)], lambda *tau: (tau,), dict(azimuths=(0.1, 0.2))),
    Case(optimal.at_rest, [(1.0, -2.0, 0.4)], lambda *tau: (tau,), dict(parameters=TURNING)),
    Case(
        optimal.step,
        TURNING_ROWS,
        of_turning_units,
        dict(h=0.5, parameters=TURNING_UNITS, design=optimal.design(TURNING_UNITS)),
    ),
    Case(
        optimal.at_rest,
        [(1.0, -2.0, 0.4)],
        lambda *tau: (tau,),
        dict(parameters=TURNING_UNITS),
    ),
    Case(
        box_qp.solve,
        [(1.0, 2.0, 3.0, 0.1, 0.2), (9.0, -2.0, 3.0, 0.5, 1.0), (0.0, 0.0, 50.0, 0.0, 9.0)],
        of_program,
    ),
    Case(
        rudder.propeller_in_wake,
        [(n, *w) for n in (9.0, -4.0, 0.0) for w in WATER],
        constants=dict(unit=STERN),
    ),
    Case(
        rudder.rudder_normal_force,
        [
            (0.4, T, u, 0.1, r)
            for T in (40.0, -10.0, 0.0)
            for u in (0.7, -0.2, 0.0)
            for r in (0.1, -0.1)
        ],
        constants=dict(unit=STERN),
    ),
    Case(
        rudder.propeller_rudder_loads,
        [(n, 0.3, *w) for n in (9.0, -4.0) for w in WATER],
        constants=dict(unit=STERN),
    ),
    Case(gusts.gust, [(8.0,), (12.0,)], lambda mean: (7.0, mean, 3)),
    Case(gusts.gust_std, [(8.0,), (12.0,)]),
    Case(waves.elevation, PAIRS, lambda x, y: (7.0, x, y, SEA)),
    Case(wave_loads.drift, [s[:3] for s in SHIP], lambda *s: (7.0, *s, SEA, DRIFT)),
    Case(wave_loads.mean_drift, ANGLES, lambda psi: (psi, SEA, DRIFT)),
    Case(wave_motion.wave_response, [s[:5] for s in SHIP], lambda *s: (7.0, *s, SEA, DRIFT), BOX),
    Case(
        reference.critically_damped,
        [(2.0, -0.3, 0.01)],
        lambda *e: (13.0, *e),
        dict(frequency=0.05),
    ),
    Case(reference.at_rest, [(1.0, -2.0, 0.4)]),
    Case(
        reference.step,
        LOOP,
        of_reference,
        dict(h=0.05, parameters=replace(parameters(reference.ReferenceParameters), speed_max=0.3)),
    ),
    *(
        Case(
            steering_trial.step,
            [
                (1.0, -2.0, 3.0, 3.0, 0.1, 0.3, 1.0, 1.0, 5.0, 1.0, 1.0, 0.1, 0.0, 4.0, 1.0, -3.0),
                (0.0, 0.0, 0.4, 2.4, 0.1, 2.0, -1.0, 2.0, 5.0, 1.0, 1.0, 0.1, 0.2, 4.0, 1.0, 2.5),
            ],
            of_trial,
            dict(parameters=steering_trial.SteeringTrialParameters(check=check, order_time=begun)),
        )
        for check, begun in ((0.0, 0.0), (0.2, 1.0), (0.2, 9.0))
    ),
    Case(
        wave_filter.filter_at,
        [(0.45,), (0.9,), (2.0,)],
        constants=dict(table=OBSERVER["design"].filters),
    ),
    Case(observer.step, LOOP, of_observer, OBSERVER),
    Case(
        control.step,
        LOOP,
        of_control,
        dict(h=0.1, ship=DP_SHIP, parameters=parameters(control.ControlParameters)),
    ),
    Case(
        allocation.step,
        [(0.0, 1e3, 0.0, X, Y, N, on) for X, Y, N in REQUESTS for on in (True, False)],
        of_allocation,
        dict(h=0.5, parameters=UNITS, design=allocation.design(UNITS)),
    ),
    Case(extended.at_rest, REQUESTS, lambda *row: (row,), dict(parameters=EXTENDED)),
    Case(
        extended.step,
        [(0.0, 1e3, 0.0, X, Y, N, on) for X, Y, N in REQUESTS for on in (True, False)],
        of_allocation,
        dict(h=0.5, parameters=EXTENDED, design=extended.design(EXTENDED)),
    ),
    Case(units.unit_effect, [(10.0, 2.0, 0.4)]),
    Case(units.no_thrust, [(1.0, -2.0, 0.4)], lambda *tau: (tau,), dict(azimuths=(0.1, 0.2))),
    Case(
        units.load, [(1e3, -2e3)], lambda *f: (f,), dict(effect=((1.0, 0.0, 2.0), (0.0, 1.0, -5.0)))
    ),
    Case(
        units.missed,
        [(1e3, 0.0, 2.0)],
        lambda *tau: (tau,),
        dict(thrusts=(1e3, -2e3), effect=((1.0, 0.0, 2.0), (0.0, 1.0, -5.0))),
    ),
    Case(units.slack, [(1e3, 0.0, 2.0), (0.0, -5.0, 0.0)], lambda *row: (row, (0.0, 0.0, 2.0))),
    Case(
        units.used_shares,
        [(1e4, -1e4, 0.0), (-3e4, 6e4, -2e4)],
        lambda *row: (row,),
        dict(least=(-3e4, -3e4, -2e4), most=(6e4, 6e4, 2e4)),
    ),
    Case(
        units.thruster_power,
        [(0.1, 0.9, 0.0), (1.0, 0.5, 0.2)],
        lambda *row: (row,),
        dict(full=(1e5, 1e5, 2e5)),
    ),
    Case(
        power.granted_power,
        [(0.1, 0.9, 0.0, 1e5, 2e5), (0.0, 0.0, 0.0, 0.0, 1e9)],
        lambda *row: (row[:3], row[3:]),
        dict(parameters=POWER),
    ),
    Case(
        power.thrust_shares,
        [(1e5, 2e4, 0.0), (1e9, 3e5, 1.0)],
        lambda *row: (row,),
        dict(parameters=POWER),
    ),
    Case(monitor.at_rest, [(1.0,)]),
    Case(
        monitor.deviation,
        [(5e3, 9e3, 0.3, 0.4), (0.0, 0.0, 3.1, -3.1), (1e3, -1e3, 0.0, 1.0)],
        lambda *row: (row[:2], row[2:]),
        dict(thrust_tolerance=3e3, azimuth_tolerance=0.2),
    ),
    Case(
        monitor.step,
        [(0.0, 1.0, 0.5), (1.4, 7.0, 5.0), (2.0, 0.0, 0.0), (0.5, 3.0, 3.0)],
        of_monitor,
        dict(h=0.5, parameters=WATCH),
    ),
    Case(
        monitor.alarms,
        [(0.0, 5.0, 6.0, 1.0, 2.0, 3.0)],
        lambda *row: (monitor.MonitorState(*row),),
        dict(parameters=WATCH),
    ),
    Case(predictor_inputs.air_velocity, SHIP, lambda *row: (of_known(*row),)),
    Case(
        regions.own_errors,
        SHIP,
        lambda *row: ((0.1, 0.01), Motion(*row), Motion(*(0.9 * value for value in row)), 1.0),
        dict(regions=regions.RegionParameters()),
    ),
    Case(
        regions.widening,
        [(0.2, 0.05, -1.0), (0.1, 0.0, 5.0), (0.4, 0.02, 50.0)],
        lambda *row: (row[:2], row[2]),
        dict(regions=regions.RegionParameters(later_position_share=0.6)),
    ),
    Case(motion_filter.start, SHIP, lambda *row: (of_outage(*row),), dict(design=RECKONING)),
    Case(motion_filter.step, SHIP, of_reckoning, dict(h=1.0, design=RECKONING)),
    Case(outage.radius, [(0.0, 0.01), (25.0, 0.2), (90.0, 0.1)], constants=dict(region=REGION)),
    Case(
        surroundings.unknown,
        SHIP,
        lambda *row: (of_known(*row),),
        dict(hull=AROUND["hull"], parameters=ASSUMED),
    ),
    Case(surroundings.step, SHIP, of_surroundings, dict(h=1.0, **AROUND)),
    Case(dead_reckoning.predict, SHIP, of_prediction, AHEAD),
    Case(
        dead_reckoning.advance,
        SHIP,
        lambda *row: ((*row, row[3] - 0.1, row[4] + 0.2), (1e3, 2e3, -3e4), of_prediction(*row)[1]),
        dict(h=1.5, hull=LONG, wind=AHEAD["wind"]),
    ),
    Case(controlled.predict, SHIP, of_loop, dict(loop=AHEAD_LOOP, **AHEAD)),
    Case(observer.pace, [(0.5,), (1.0,), (3.0,)], constants=dict(full_frequency=1.1)),
    Case(
        reference.resumed,
        [(1.0, -2.0, 0.4, 0.1, 0.0, 0.01, -1e-3, 0.0, 1e-4)],
        lambda *row: (row,),
        dict(parameters=parameters(reference.ReferenceParameters)),
    ),
    Case(
        vessel.carried,
        [(*ship, 0.3, -0.1) for ship in SHIP],
        of_vessel,
        dict(hull=replace(parameters(hull.HullParameters), current_acceleration=0.3)),
    ),
    Case(earth.onset, [(3.0,), (8.0,), (20.0,)], constants=dict(onset_time=5.0, ramp_time=10.0)),
    Case(earth.earth_force, [(0.4, 1e3, -2e3), (-2.0, 0.0, 0.0)], constants=dict(x=-17.0)),
    Case(
        earth.drift_force,
        [(0.4, 1e3, -2e3), (-2.0, 3e3, 2e3), (0.0, 0.0, 0.0)],
        constants=dict(yaw_arm=-1.5),
    ),
    Case(
        current.varying_current,
        [
            (t, *ends)
            for t in (-5.0, 30.0, 99.0)
            for ends in ((0.3, 0.0, -0.3, 0.1), (0.0, 0.0, 0.2, -0.2))
        ],
        constants=dict(time_start=0.0, time_end=60.0),
    ),
    *(
        Case(
            function,
            [(0.0, 0.0, -5.0, 3.0), (200.0, -80.0, 0.0, 0.4), (-40.0, 900.0, 0.1, 0.0)],
            constants=BERTH,
        )
        for function in (harbour.local_wind, harbour.local_current)
    ),
    *(
        Case(function, SHIP, constants=ERRORS)
        for function in (instruments.readings, instruments.true_motion)
    ),
]


def flat(values):
    """Nested tuples and lists as one list."""
    if isinstance(values, (tuple, list)):
        return [item for value in values for item in flat(value)]
    return [values]


def by_floats(case):
    return np.array([[float(value) for value in case(*row)] for row in case.rows])


@pytest.mark.parametrize("case", CASES, ids=str)
def test_arrays_give_what_floats_give(case):
    found = case(*(np.array(column) for column in zip(*case.rows, strict=True)))
    found = np.stack([np.broadcast_to(value, len(case.rows)) for value in found], axis=-1)
    np.testing.assert_allclose(found.astype(float), by_floats(case), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_tensors_give_what_floats_give(case):
    torch = pytest.importorskip("torch")
    columns = (np.array(column) for column in zip(*case.rows, strict=True))
    found = case(*(torch.as_tensor(column) for column in columns))
    found = np.stack(
        [np.broadcast_to(np.asarray(value), len(case.rows)) for value in found], axis=-1
    )
    np.testing.assert_allclose(found.astype(float), by_floats(case), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_gradients_are_finite_even_at_rest(case):
    torch = pytest.importorskip("torch")
    columns = [torch.as_tensor(np.array(column)) for column in zip(*case.rows, strict=True)]
    columns = [
        column.requires_grad_() if column.is_floating_point() else column for column in columns
    ]
    values = [
        value for value in case(*columns) if isinstance(value, torch.Tensor) and value.requires_grad
    ]
    if values:
        sum(value.sum() for value in values).backward()
    gradients = [column.grad for column in columns if column.grad is not None]
    assert all(torch.isfinite(gradient).all() for gradient in gradients)


def test_every_function_that_promises_tensors_is_among_the_cases():
    covered = {case.function for case in CASES} | {
        waves.components
    }  # no scalars: test_waves compares them
    covered |= {maths.is_single, maths.repeat, maths.times, memoize.kept}  # know no arithmetic
    covered |= {maths.library_of}  # tells the arithmetics apart
    covered |= {
        waves.phase_angle,
        waves.waves_like,
        wave_loads.drift_at,
    }  # parts of those that are cases
    # vectors and records: test_own_record compares them
    covered |= {own_record.begin, own_record.step, own_record.predict}
    covered |= {own_record.weights, own_record.mixed}
    covered |= {
        own_model.thrust_told,
        own_model.delivered,
        own_model.wind_and_thrust_error,
        own_model.damping_error,
        own_model.wash_of,
        own_model.moved,
    }
    covered |= {drive.drive_step}  # by the steps of both thrusters
    covered |= {propeller.loads_at}  # by propeller_loads
    # By the steps of the allocators.
    covered |= {allocation.solved, allocation.missing_units, allocation.within_limits}
    covered |= {box_qp.multipliers_of, maths.where_all, units.is_missed}
    covered |= {sinusoids.column, sinusoids.total, sinusoids.tensors_if_any}
    missing = [
        f"{name}.{function.__name__}" for name, function in promising() if function not in covered
    ]
    assert not missing


def promising():
    """Public functions of the models that speak of tensors, with their module."""
    for module in pkgutil.walk_packages(shipcosim.models.__path__, "shipcosim.models."):
        module = importlib.import_module(module.name)
        for name, function in inspect.getmembers(module, inspect.isfunction):
            own = function.__module__ == module.__name__ and not name.startswith("_")
            if own and "array or tensor" in (function.__doc__ or ""):
                yield module.__name__.rpartition(".")[2], function
