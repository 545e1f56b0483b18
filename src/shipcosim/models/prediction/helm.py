"""Predict the motion of a hand-steered ship by her equations of motion, with levers and wheel held.

References
----------
Skulstad, Data-based modelling of ships for motion prediction and control allocation, NTNU, 2021, paper III: "A Hybrid
Approach to Motion Prediction for Ship Docking", Sec. III-B. Current and waves are left out there, and wind is held.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.integrate import midpoint_motion
from shipcosim.models.core.kinematics import load_at, moved, to_body, to_ned, velocity_at
from shipcosim.models.core.maths import Arithmetic, clip, cos, hypot, sin
from shipcosim.models.core.motion import Load, Motion, Triple, Vector
from shipcosim.models.core.parameters import quantity, required, required_table
from shipcosim.models.environment.wind_loads import WindParameters, apparent_wind, wind_loads
from shipcosim.models.prediction.predictor_inputs import air_velocity
from shipcosim.models.propulsion.propeller import (
    PropellerParameters,
    bollard_speed,
    propeller_loads,
)
from shipcosim.models.ship.hull import HullParameters
from shipcosim.models.ship.mast import MastParameters, wind_from_mast
from shipcosim.models.ship.vessel import accelerations, through_water

SMOOTHING = 3
"""Samples, one a second, over which heading and velocity at the start are averaged. [1] Paper IV has three seconds."""
LONGEST = 30
"""How far ahead is predicted. [s] Paper III."""


@dataclass(frozen=True, kw_only=True)
class HelmParameters:
    """Two equal azimuth thrusters, one at each side, and a bow tunnel, in the predictor's model."""

    x: float = required("m", "position of the azimuths forward")
    y: float = required("m", "position of the port azimuth to starboard", maximum=0.0)
    diameter: float = required("m", "propeller diameter of an azimuth", minimum=0.01)
    thrust_polynomial: str = required_table(
        ("end [deg]", "k0 [1]", "k1 [1]", "k2 [1]", "k3 [1]"),
        "KT of an azimuth's propeller, as its own parameter",
    )
    torque_polynomial: str = required_table(
        ("end [deg]", "k0 [1]", "k1 [1]", "k2 [1]", "k3 [1]"),
        "KQ of an azimuth's propeller, as its own parameter",
    )
    thrust_factors: str = required_table(
        ("angle [deg]", "factor [1]"),
        "factors on CT of an azimuth's propeller, as its own parameter",
    )
    torque_factors: str = required_table(
        ("angle [deg]", "factor [1]"),
        "factors on CQ of an azimuth's propeller, as its own parameter",
    )
    thrust_scale_outside: float = quantity(
        1.0,
        "1",
        "factor on the thrust of an azimuth outside the first quadrant",
        "neutral",
        minimum=0.0,
    )
    side_force_coefficient: float = required(
        "1", "side force coefficient of an azimuth", minimum=0.0
    )
    thrust_rate: float = required(
        "N/s", "largest rate of the thrust command of an azimuth", minimum=0.0
    )
    azimuth_rate: float = required("rad/s", "largest rate at which an azimuth turns", minimum=0.0)
    tunnel_x: float = required("m", "position of the tunnel thruster forward")
    tunnel_thrust_coefficient: float = required(
        "N/rpm2", "thrust of the tunnel over squared motor speed", minimum=1e-9
    )
    tunnel_thrust_rate: float = required(
        "N/s", "largest rate of the tunnel's thrust command", minimum=0.0
    )
    position_age: float = quantity(
        0.0,
        "s",
        "age of a measured position, by which our law moves it on; paper III does not",
        "neutral",
        minimum=0.0,
    )

    @cached_property
    def propeller(self):
        """Propeller of an azimuth."""
        names = "diameter thrust_polynomial torque_polynomial thrust_factors torque_factors thrust_scale_outside"
        return PropellerParameters(**{name: getattr(self, name) for name in names.split()})


class Aboard(NamedTuple):
    """Values measured aboard, each a float or a (...) array.

    Parameters
    ----------
    ship : Motion
        Measured, or averaged over the last seconds.
    wind_speed, wind_from : float or (...) array
        Measured apparent wind at 10 m above the ship: speed, and direction it comes from, clockwise from the bow.
        [m/s, rad]
    thrust_cmd : tuple of three, like wind_speed
        Commanded thrust of port azimuth, starboard azimuth and tunnel. [N]
    azimuth_cmd : tuple of two, like wind_speed
        Commanded directions of the azimuths. [rad]
    rpm : tuple of three, like wind_speed
        Measured shaft speeds, of the tunnel that of its motor. [rpm]
    azimuth : tuple of two, like wind_speed
        Measured directions. [rad]
    """

    ship: Motion
    wind_speed: Arithmetic
    wind_from: Arithmetic
    thrust_cmd: Triple
    azimuth_cmd: Vector
    rpm: Triple
    azimuth: Vector


KNOWN = (
    "x_meas",
    "y_meas",
    "psi_meas",
    "u_meas",
    "v_meas",
    "r_meas",
    "wind_speed_meas",
    "wind_from_meas",
    "port_thrust_cmd",
    "port_azimuth_cmd",
    "port_rpm",
    "port_azimuth",
    "starboard_thrust_cmd",
    "starboard_azimuth_cmd",
    "starboard_rpm",
    "starboard_azimuth",
    "tunnel_thrust_cmd",
    "tunnel_rpm",
)
"""Inputs of a predictor of dockings, by name."""


def aboard_of(inputs: Mapping[str, Arithmetic], mast: MastParameters) -> Aboard:
    """Measured values aboard, from the inputs of a predictor.

    Parameters
    ----------
    inputs : mapping of str to float or (...) array
        By the names of `KNOWN`. [m, rad, m/s, N, rpm]
    mast : MastParameters
        Where the anemometer stands.

    Returns
    -------
    Aboard
        [as its fields]
    """
    ship = Motion(*(inputs[name] for name in KNOWN[:6]))
    # The wind loads refer to 10 m above the origin, the anemometer stands elsewhere.
    wind = wind_from_mast(
        inputs["wind_speed_meas"], inputs["wind_from_meas"], ship.u, ship.v, ship.r, mast=mast
    )
    return Aboard(
        ship,
        *wind,
        (inputs["port_thrust_cmd"], inputs["starboard_thrust_cmd"], inputs["tunnel_thrust_cmd"]),
        (inputs["port_azimuth_cmd"], inputs["starboard_azimuth_cmd"]),
        (inputs["port_rpm"], inputs["starboard_rpm"], inputs["tunnel_rpm"]),
        (inputs["port_azimuth"], inputs["starboard_azimuth"]),
    )


def moved_on(ship: Motion, age: float) -> Motion:
    """The ship with her measured position moved on by its age, at the present velocity.

    Parameters
    ----------
    ship : Motion
        As measured.
    age : float
        Of the place. [s]

    Returns
    -------
    Motion
        [as its fields]
    """
    north, east = to_ned(ship.psi, ship.u, ship.v)
    return ship._replace(x=ship.x + age * north, y=ship.y + age * east)


Start = tuple[tuple[Arithmetic, Arithmetic, Arithmetic, Arithmetic], ...]
"""Latest heading, surge and sway velocity and yaw rate, the newest last, at most `SMOOTHING` of them."""


def remembered(before: Start, ship: Motion) -> Start:
    """Samples to average at the start of a prediction, with the newest one.

    Parameters
    ----------
    before : tuple of tuples of four
        A second ago; empty at the start. [rad, m/s, m/s, rad/s]
    ship : Motion
        As measured now.

    Returns
    -------
    tuple of tuples of four
        [rad, m/s, m/s, rad/s]
    """
    return (*before, ship[2:])[-SMOOTHING:]


def smoothed(latest: Start, ship: Motion) -> Motion:
    """The measured ship, with heading and velocity averaged over the latest samples.

    Parameters
    ----------
    latest : tuple of tuples of four
        As `remembered` gives them. [rad, m/s, m/s, rad/s]
    ship : Motion
        As measured now.

    Returns
    -------
    Motion
        The place is that of now.
    """
    # Headings are averaged as deviations from the newest one, since they wrap.
    share = 1.0 / len(latest)
    psi = wrap(ship.psi + share * sum(wrap(start[0] - ship.psi) for start in latest))
    u, v, r = (share * sum(start[k] for start in latest) for k in (1, 2, 3))
    return Motion(ship.x, ship.y, psi, u, v, r)


def thruster_loads(
    aboard: Aboard, water: Vector, *, helm: HelmParameters
) -> Callable[[float], Callable[[Arithmetic, Arithmetic, Arithmetic], Load]]:
    """Load of the thrusters over time and the ship's velocity through the water, while their commands stay put.

    Thrust and direction run from what shaft speed and direction give now to the commanded values, at their largest rates.
    Once a drive has reached its command, it keeps that thrust at any speed.

    Parameters
    ----------
    aboard : Aboard
        Inputs of the predictor now.
    water : tuple of two floats or (...) arrays
        Velocity of the ship through the water now, forward and to starboard. [m/s]
    helm : HelmParameters
        The thrusters.

    Returns
    -------
    callable
        ``loads(t)(u_r, v_r, r)`` gives the load after t seconds. [N, N, N.m]
    """
    # The tunnel now gives what its measured speed says, T = c n |n|.
    tunnel_now = helm.tunnel_thrust_coefficient * aboard.rpm[2] * abs(aboard.rpm[2])
    units = [_azimuth(aboard, k, y, water, helm) for k, y in enumerate((helm.y, -helm.y))]

    def loads(t):
        # Thrusts move from their present values to the commands at their largest rates.
        tunnel = moved(tunnel_now, aboard.thrust_cmd[2], t * helm.tunnel_thrust_rate)
        port, starboard = (unit(t) for unit in units)

        def at(u_r, v_r, r):
            X_p, Y_p, N_p = port(u_r, v_r, r)
            X_s, Y_s, N_s = starboard(u_r, v_r, r)
            return X_p + X_s, Y_p + Y_s + tunnel, N_p + N_s + helm.tunnel_x * tunnel

        return at

    return loads


def _azimuth(aboard, k, y, water, helm):
    """Load of one azimuth over time and velocity, as `azimuth.azimuth_loads` without losses."""
    n = aboard.rpm[k] / 60.0
    azimuth = aboard.azimuth[k]
    # The unit's own velocity through the water, by surge, sway and yaw, along its axis.
    u, v = velocity_at(helm.x, y, water[0], water[1], aboard.ship.r)
    thrust_now, _ = propeller_loads(
        cos(azimuth) * u + sin(azimuth) * v, n, propeller=helm.propeller
    )
    # Shaft speed in excess of the bollard speed, since the ship has way on. It is kept.
    beyond = n - bollard_speed(
        thrust_now, propeller=helm.propeller
    )  # faster than at bollard, for the way that she has
    # The azimuth turns the shorter way, at its largest rate.
    turn = wrap(aboard.azimuth_cmd[k] - azimuth)
    D = helm.diameter
    side_factor = -helm.side_force_coefficient * helm.propeller.water_density * D * D

    def load(t):
        thrust = moved(thrust_now, aboard.thrust_cmd[k], t * helm.thrust_rate)
        angle = azimuth + clip(turn, -t * helm.azimuth_rate, t * helm.azimuth_rate)
        # Side force F_s = -c ρ D² (V + |n| D) u_s: momentum drag of the water taken along.
        wash = D * abs(bollard_speed(thrust, propeller=helm.propeller) + beyond)
        s = sin(angle)
        c = cos(angle)

        # Thrust and direction are fixed in time; the side force follows the velocity within a step.
        def at(u_r, v_r, r):
            u, v = velocity_at(helm.x, y, u_r, v_r, r)
            u_s = c * v - s * u
            side = side_factor * (hypot(u, v) + wash) * u_s
            return load_at(helm.x, y, thrust * c - side * s, thrust * s + side * c)

        return at

    return load


def predict(
    aboard: Aboard,
    current: Vector = (0.0, 0.0),
    left: Load = (0.0, 0.0, 0.0),
    *,
    hull: HullParameters,
    wind: WindParameters,
    helm: HelmParameters,
    seconds: int = LONGEST,
) -> tuple[Motion, ...]:
    """Predict the motion of the ship by her equations of motion.

    Parameters
    ----------
    aboard : Aboard
        Her state now; wind and commands, which are held.
    current : tuple of two floats or (...) arrays
        Velocity of the water north and east, as estimated; paper III has none. [m/s]
    left : tuple of three, like current
        Load in body axes that nothing else explains, as estimated; paper III has none. [N, N, N.m]
    hull, wind, helm : HullParameters, WindParameters, HelmParameters
        The ship's model of herself.
    seconds : int
        How far ahead. [s]

    Returns
    -------
    tuple of Motion
        One a second.

    Notes
    -----
    Midpoint rule with steps of one second, thrusters at the middle of each.
    """
    ship = aboard.ship
    # The air's velocity over ground is held, not the apparent wind, which changes with her motion.
    air = air_velocity(aboard)
    x, y, psi, _, _, r = ship
    # Hull loads depend on the velocity through the water, so it is integrated.
    u_r, v_r = through_water(psi, ship.u, ship.v, *current)
    loads = thruster_loads(aboard, (u_r, v_r), helm=helm)
    motions = []
    for second in range(seconds):
        # Loads at the middle of each second: second-order accuracy with one step a second.
        rates = _rates(loads(second + 0.5), psi + 0.5 * r, current, air, left, hull, wind)
        x, y, psi, u_r, v_r, r = midpoint_motion(rates, x, y, psi, u_r, v_r, r, 1.0, *current)
        psi = wrap(psi)
        u_c, v_c = to_body(psi, *current)
        motions.append(Motion(x, y, psi, u_r + u_c, v_r + v_c, r))
    return tuple(motions)


def _rates(thrusters, heading, current, air, left, hull, wind):
    """Rates of the velocity through the water at a heading, as in `vessel.accelerations`."""
    u_c, v_c = to_body(heading, *current)

    def rates(u_r, v_r, r):
        blown = wind_loads(*apparent_wind(heading, u_r + u_c, v_r + v_c, *air), wind=wind)
        X, Y, N = thrusters(u_r, v_r, r)
        tau = X + blown[0] + left[0], Y + blown[1] + left[1], N + blown[2] + left[2]
        return accelerations(u_r, v_r, r, *tau, hull=hull)

    return rates
