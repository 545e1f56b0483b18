"""The DP loop of the 82.7 m vessel in array form, all worlds at once, with dead reckoning in it.

Components exchange as in the co-simulation of `osv_gnss_loss`, each going from t to t + h with what the others showed
at t, so a run is that of the FMUs; a test compares the two.
"""

from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from ships import parameters

from shipcosim.learn.dead_reckoning import worlds
from shipcosim.learn.dead_reckoning.worlds import Record
from shipcosim.models.allocation import fixed_angles
from shipcosim.models.control import filtered_pid
from shipcosim.models.control.pid import Desired
from shipcosim.models.core.kinematics import to_ned
from shipcosim.models.core.motion import Motion
from shipcosim.models.core.sampling import samples_due
from shipcosim.models.environment import waves, weather
from shipcosim.models.environment.wave_loads import drift_table
from shipcosim.models.environment.wave_motion import wave_response
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.outage import Measured
from shipcosim.models.propulsion import mapped
from shipcosim.models.ship import sensors, vessel
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters

H = worlds.STEP
STILL = Desired(*(0.0,) * 9)


def osv(kind, component=""):
    """Parameters of the true ship: those of her files, changed as `worlds.SHIP` and `worlds.SENSORS` say."""
    made, changes = parameters(kind, "osv", component), worlds.SHIP | worlds.SENSORS
    component = component or {"SensorParameters": "sensors"}.get(kind.__name__, "vessel")
    given = {
        name.partition(".")[2]: one
        for name, one in changes.items()
        if name.startswith(f"{component}.")
    }
    return replace(
        made, **{name: _plain(one) for name, one in given.items() if hasattr(made, name)}
    )


def _plain(value):
    """Amounts in deg and deg/s as numbers."""
    return np.radians(float(value.split()[0])) if isinstance(value, str) else value


class Ship(NamedTuple):
    """What the ship shows the others."""

    motion: Motion
    drift: tuple
    waves: Motion
    wind: tuple
    water: tuple


class Loop:
    """All components, of as many worlds as are given."""

    def __init__(self, given, laws, rides_on):
        zero = np.zeros(len(given))
        self.laws, self.rides_on = laws, rides_on
        self.hull, self.table = (
            osv(HullParameters),
            drift_table(osv(vessel.DriftParameters).drift_table),
        )
        self.wind, self.mast = osv(WindParameters), osv(MastParameters)
        self.pid_law = parameters(filtered_pid.FilteredPidParameters, "osv")
        self.units = [osv(mapped.MapParameters, name) for name in worlds.UNITS]
        self.allocation = parameters(fixed_angles.FixedAngleParameters, "osv", "allocator")
        self.layout = fixed_angles.design(self.allocation)
        self._draw(given)
        self.air, self.current = self._air(0.0), weather.water_velocity(self.means)
        self.ship = self._seen(0.0, Motion(*(zero,) * 6))
        self.instruments = osv(sensors.SensorParameters)
        self.instruments = replace(self.instruments, seed=np.array([world.seed for world in given]))
        failures = self._failures(False)
        self.sensors = sensors.start(
            0.0, self._truth(), failures, parameters=self.instruments, mast=self.mast
        )
        self.commands = [zero for _ in self.units]
        self.loads = [
            mapped.mapped_loads(zero, zero, zero, zero, thruster=unit)[2:] for unit in self.units
        ]
        self.taken = 1
        self.reckoned = {
            name: law.start(self._measured(), design=design) for name, (law, design) in laws.items()
        }
        self._shown(self._measured(), 0.0)
        self.pid = filtered_pid.at_rest(*self._fed())
        self.allocated = fixed_angles.at_rest((zero, zero, zero), parameters=self.allocation)

    def _draw(self, given):
        """Weather and biases of the worlds."""
        column = {
            name: np.array([getattr(world, name) for world in given])
            for name in given[0].__dataclass_fields__
        }
        speed, towards = column["wind_speed"], column["wind_from"]
        turn = abs((towards[:, 1] - towards[:, 0] + np.pi) % (2.0 * np.pi) - np.pi)
        self.weather = replace(
            weather.EnvironmentParameters(),
            wind_speed_rate=abs(speed[:, 1] - speed[:, 0]) / worlds.TRANSITION,
            wind_turn_rate=turn / worlds.TRANSITION,
            seed=column["seed"],
        )
        self.setpoints = speed[:, 1], towards[:, 1], column["current_speed"], column["current_to"]
        self.means = weather.EnvironmentState(speed[:, 0], towards[:, 0], *self.setpoints[2:])
        sea = column["wave_height"], column["wave_period"], towards[:, 1]
        self.sea = waves.components(*sea, 3.3 + 0.0 * sea[0], column["seed"])
        self.bias, self.compass_error = column["position_bias"].T, column["compass_error"]

    def _air(self, t):
        return weather.air_velocity(t, self.means, gust_scale=1.0, seed=self.weather.seed)

    def _seen(self, t, motion):
        """What the ship shows at t, in the air and water that she was given last."""
        box = dict(length=self.hull.length, breadth=self.hull.breadth, draught=self.hull.draught)
        drift, moved = wave_response(t, *motion[:5], self.sea, self.table, **box)
        wind = apparent_wind(motion.psi, motion.u, motion.v, *self.air)
        return Ship(
            motion,
            drift,
            moved,
            wind,
            vessel.through_water(motion.psi, motion.u, motion.v, *self.current),
        )

    def _truth(self):
        both = zip(self.ship.motion, self.ship.waves, strict=True)
        return sensors.Truth(*(low + wave for low, wave in both), *self.ship.wind)

    def _failures(self, lost):
        first = sensors.ReferenceFailure(lost=lost, north=self.bias[0], east=self.bias[1])
        healthy, compass = (
            sensors.SensorFailures(),
            sensors.CompassFailure(offset=self.compass_error),
        )
        return sensors.SensorFailures(
            (first, *healthy.positions[1:]), (compass, healthy.compasses[1])
        )

    def _measured(self):
        given = self.sensors.telegrams
        x, y, u, v, valid = given.positions[0]
        psi, air = given.compasses[0].psi, given.wind
        return Measured(x, y, u, v, valid + 0.0 * x, psi, air[0], air[1], tuple(self.commands))

    def _shown(self, measured, t):
        """Place that the controller is given, at t."""
        state, since, works = (
            self.reckoned[self.rides_on],
            t - (self.taken - 1.0),
            measured.valid > 0.5,
        )
        north, east = to_ned(measured.psi, state.u, state.v)
        self.x_hat = np.where(works, measured.x, state.x + since * north)
        self.y_hat = np.where(works, measured.y, state.y + since * east)

    def _fed(self):
        return self.x_hat, self.y_hat, self.sensors.telegrams.compasses[0].psi

    def step(self, t, lost):
        """All components from t to t + H."""
        h, motion = H, self.ship.motion
        means = weather.step(h, self.means, *self.setpoints, parameters=self.weather)
        loads = [
            wind_loads(*apparent_wind(*motion[2:5], *self.air), wind=self.wind),
            self.ship.drift,
            *self.loads,
        ]
        moved = vessel.step(
            motion,
            *(sum(one) for one in zip(*loads, strict=True)),
            *self.current,
            h,
            hull=self.hull,
        )
        ship = self._seen(t + h, moved)
        measured, fed, flow = self._measured(), self._fed(), (*self.ship.water, motion.r)
        allocated = fixed_angles.step(
            self.allocated,
            (self.pid.tau_X, self.pid.tau_Y, self.pid.tau_N),
            (True,) * 6,
            h,
            parameters=self.allocation,
            design=self.layout,
        )
        commands, thrusts = list(self.commands), list(self.loads)
        for number, unit in enumerate(self.units):
            asked = mapped.mapped_command(self.allocated.thrusts[number], thruster=unit)
            commands[number] = mapped.commanded(commands[number], asked, h, thruster=unit)
            thrust = mapped.mapped_thrust(commands[number], thruster=unit)
            thrusts[number] = mapped.mapped_loads(thrust, *flow, thruster=unit)[2:]
        if self.taken < samples_due(t, 1.0):
            self.taken = samples_due(t, 1.0)
            self.reckoned = {
                name: law.step(self.reckoned[name], measured, 1.0, design=design)
                for name, (law, design) in self.laws.items()
            }
        self.pid = filtered_pid.step(self.pid, fed, STILL, h, parameters=self.pid_law)
        self.sensors = sensors.step(
            t,
            self.sensors,
            self._truth(),
            self._failures(lost),
            parameters=self.instruments,
            mast=self.mast,
        )
        self.ship, self.allocated, self.means, self.commands, self.loads = (
            ship,
            allocated,
            means,
            commands,
            thrusts,
        )
        self._shown(measured, t + h)
        self.air, self.current = self._air(t + h), weather.water_velocity(means)

    def row(self):
        """What is recorded."""
        found = self._measured()._asdict()
        found |= {f"command_{k}": one for k, one in enumerate(found.pop("commands"), 1)}
        second = self.sensors.telegrams.positions[1]
        found |= {f"asked_{k}": one for k, one in enumerate(self.allocated.thrusts, 1)}
        found |= {
            "second_x": second.x,
            "second_y": second.y,
            "x_hat": self.x_hat,
            "y_hat": self.y_hat,
        }
        ship = self.ship
        state = self.reckoned[self.rides_on]
        found |= {
            "lost_for": state.lost_for,
            "sea": state.sea,
            "reckoned_x": state.x,
            "reckoned_y": state.y,
        }
        return found | {
            "true_x": ship.motion.x + ship.waves.x,
            "true_y": ship.motion.y + ship.waves.y,
        }

    def run(self, first, last, losses=()):
        """From one second to another: a record with a sample a second, the last one included.

        Parameters
        ----------
        first, last : int
            [s]
        losses : sequence of two floats
            From when to when GNSS is lost. [s]
        """
        rows, every = [], round(1.0 / H)
        for k in range(first * every, last * every + 1):
            if k % every == 0:
                rows.append(self.row())
            if k < last * every:
                self.step(k * H, any(lost <= k * H < found for lost, found in losses))
        zero = 0.0 * rows[0]["x"]
        found = {name: np.stack([row[name] + zero for row in rows], -1) for name in rows[0]}
        reckoned = {
            name: found[name]
            for name in ("x_hat", "y_hat", "lost_for", "sea", "reckoned_x", "reckoned_y")
        }
        return Record(
            {name: found[name] for name in worlds.MEASURED},
            found["true_x"],
            found["true_y"],
            reckoned,
        )

    def fork(self, rides_on):
        """The same from here on with another law in the loop."""
        other = copy(self)
        other.rides_on = rides_on
        return other
