"""Azimuth thrusters: from commands of thrust and direction to the loads on the ship.

Limits, drive and motor are in `drive`, the propeller in `propeller`; here is what turning adds to them.
"""

from dataclasses import dataclass
from functools import cached_property

from shipcosim.models.core.kinematics import load_at, turned, velocity_at
from shipcosim.models.core.maths import Arithmetic, hypot, pi, sincos, where
from shipcosim.models.core.parameters import acts, quantity, required
from shipcosim.models.propulsion.drive import Thruster, at_rest, drive_step
from shipcosim.models.propulsion.failures import Failures
from shipcosim.models.propulsion.propeller import (
    PropellerParameters,
    bollard_speed,
    bollard_torque,
    loads_at,
    propeller_loads,
)
from shipcosim.models.propulsion.slipstream import slipstream_share
from shipcosim.models.propulsion.thruster import LOSS, REGENERATION, Loads

_TURN = 2.0 * pi


@dataclass(frozen=True, kw_only=True)
class AzimuthParameters(PropellerParameters):
    """An azimuth thruster with its drive."""

    x: float = required("m", "position forward", share=0.0014)
    y: float = required("m", "position to starboard", tolerance=0.02)
    side_force_coefficient: float = required(
        "1", "side force coefficient: momentum drag and strut", share=0.1, minimum=0.0
    )
    side_force_astern: float = quantity(
        1.0,
        "1",
        "factor on the side force's part that goes with shaft speed, at negative speed",
        "neutral",
        minimum=0.0,
    )
    thrust_min: float = required("N", "largest thrust astern, negative", maximum=0.0)
    thrust_max: float = required("N", "largest thrust ahead", minimum=0.0)
    thrust_rate: float = required("N/s", "largest rate of the thrust command", minimum=0.0)
    azimuth_rate: float = required("rad/s", "largest rate of turning", minimum=0.0)
    rpm_max: float = required("rpm", "largest shaft speed", minimum=1.0)
    torque_max: float = required("N.m", "largest motor torque", minimum=0.0)
    power_max: float = required("W", "largest motor power", minimum=0.0)
    inertia: float = required("kg.m2", "motor, shaft, propeller and its water", minimum=1e-6)
    friction: float = required("N.m.s/rad", "friction torque over shaft speed", minimum=0.0)
    proportional_gain: float = required("N.m.s/rad", "k_p of the drive", minimum=0.0)
    integral_gain: float = required("N.m/rad", "k_i of the drive", minimum=0.0)
    regeneration: float = quantity(
        0.0, "1", REGENERATION, "neutral: diode rectifier", minimum=0.0, maximum=1.0
    )

    thrust_loss: float = quantity(0.0, "1", LOSS, "neutral", tolerance=0.01, maximum=1.0)
    reverse_loss: float = quantity(
        0.0,
        "1",
        "further loss of what is left at negative shaft speed",
        "neutral; with thrust_loss 5 % outside the first quadrant",
        tolerance=0.04,
        maximum=1.0,
    )
    azimuth_offset: float = quantity(
        0.0,
        "rad",
        "real direction of the thrust minus the given one",
        "neutral",
        tolerance=0.2 * pi / 180.0,
    )
    rpm_offset: float = quantity(
        0.0, "rpm", "given shaft speed of a replay minus the real one", "neutral", share=5e-4
    )
    angle_loss: float = quantity(
        0.0,
        "1",
        "share of the thrust lost at the hull by a unit that points athwartships; proportional to the squared sine",
        "neutral",
        maximum=1.0,
    )
    interaction_loss: float = quantity(
        0.0,
        "1",
        "share of the thrust that is lost on the axis of the neighbour's slipstream",
        "neutral",
        maximum=1.0,
    )
    interaction_width: float = quantity(
        20.0 * pi / 180.0,
        "rad",
        "angle off that axis at which 1/e of the loss is left",
        "some 20 deg, assumed",
        minimum=1e-3,
    )
    neighbour_x: float = quantity(
        0.0, "m", "position of the neighbour forward", "set by the system"
    )
    neighbour_y: float = quantity(
        0.0, "m", "position of the neighbour to starboard", "set by the system"
    )

    @cached_property
    def loses(self):
        """True if some of the propeller's thrust is lost."""
        return any(
            map(acts, (self.thrust_loss, self.reverse_loss, self.angle_loss, self.interaction_loss))
        )


def azimuth_step(
    thruster: Thruster,
    thrust_cmd: Arithmetic,
    azimuth_cmd: Arithmetic,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    failures: Failures,
    h: float,
    *,
    unit: AzimuthParameters,
) -> Thruster:
    """State of an azimuth thruster one step later.

    Parameters
    ----------
    thruster : Thruster
        State at the start.
    thrust_cmd, azimuth_cmd : like the state
        Commanded thrust and direction, which is reached the shorter way. [N, rad]
    u_r, v_r, r : like the state
        Velocity of the ship relative to the water and yaw rate. [m/s, m/s, rad/s]
    failures : Failures
        What has failed; `SOUND` if nothing has.
    h : float
        Step. [s]
    unit : AzimuthParameters
        The thruster.

    Returns
    -------
    Thruster
        State at the end.

    References
    ----------
    As `drive.drive_step` and `propeller.propeller_loads`.
    """
    # Steering first: direction towards the command at the available rate.
    azimuth = thruster.azimuth
    still = failures.stopped | failures.azimuth_frozen
    # With a reversed sensor the steering sees -azimuth: it heads for a wrong direction.
    towards = where(
        failures.azimuth_reversed, azimuth_cmd + 2.0 * azimuth, azimuth_cmd
    )  # it measures -azimuth
    azimuth = turned(
        azimuth, towards, where(still, 0.0, failures.rate_share * unit.azimuth_rate * h)
    )
    # The propeller sees the water along its new axis, real offset included.
    u_a, _ = _inflow(*sincos(azimuth + unit.azimuth_offset), u_r, v_r, r, unit)
    return drive_step(
        thruster,
        azimuth,
        thrust_cmd,
        failures,
        h,
        unit,
        loads_at(u_a, propeller=unit),
        lambda thrust: bollard_speed(thrust, propeller=unit),
        lambda n: bollard_torque(n, propeller=unit),
    )


def azimuth_replay(
    n: Arithmetic,
    azimuth: Arithmetic,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    *,
    unit: AzimuthParameters,
) -> Thruster:
    """State of an azimuth thruster at a given shaft speed and direction, for replays.

    The motor torque is that of propeller and friction at constant shaft speed.

    Parameters
    ----------
    n, azimuth : float or (...) array or tensor
        Given shaft speed and direction of positive thrust; the real ones differ by the unit's offsets. [rev/s, rad]
    u_r, v_r, r : like n
        Velocity of the ship relative to the water and yaw rate. [m/s, m/s, rad/s]
    unit : AzimuthParameters
        The thruster.

    Returns
    -------
    Thruster
        With the real shaft speed and the given direction.

    References
    ----------
    As `propeller.propeller_loads`; a constant shaft speed within the step is assumed.
    """
    # The torque holds the shaft at constant speed: propeller torque plus friction.
    thruster = azimuth_given(n, azimuth, unit=unit)
    n = thruster.n
    u_a, _ = _inflow(*sincos(azimuth + unit.azimuth_offset), u_r, v_r, r, unit)
    thrust, torque = propeller_loads(u_a, n, propeller=unit)
    return thruster._replace(
        thrust_cmd=thrust, torque=torque + unit.friction * _TURN * n, reported=thrust
    )


def azimuth_given(n: Arithmetic, azimuth: Arithmetic, *, unit: AzimuthParameters) -> Thruster:
    """As `azimuth_replay`, without command and torque, which are 0.

    Parameters
    ----------
    n, azimuth : float or (...) array or tensor
        Given shaft speed and direction of positive thrust. [rev/s, rad]
    unit : AzimuthParameters
        The thruster.

    Returns
    -------
    Thruster
        With the real shaft speed and the given direction.

    References
    ----------
    As `azimuth_replay`.
    """
    return at_rest(azimuth)._replace(n=n - unit.rpm_offset / 60.0)


def azimuth_loads(
    thruster: Thruster,
    u_r: Arithmetic,
    v_r: Arithmetic,
    r: Arithmetic,
    neighbour_azimuth: Arithmetic = 0.0,
    neighbour_rpm: Arithmetic = 0.0,
    *,
    unit: AzimuthParameters,
    propeller_thrust: Arithmetic | None = None,
    thrust_share: Arithmetic = 1.0,
) -> Loads:
    """Thrust along the axis and side force across it, F_s = -c rho D² (V + abs(n) D) u_s, with their load on the ship.

    Where n < 0, abs(n) D has the factor `side_force_astern`, 1 by default.

    The thrust is that of the propeller less its losses:
    (1 - thrust_loss) (1 - reverse_loss, where n < 0) (1 - angle_loss sin² of the azimuth)
    (1 - interaction_loss · `slipstream_share`) thrust_share.

    Parameters
    ----------
    thruster : Thruster
        State.
    u_r, v_r, r : like the state
        Velocity of the ship relative to the water and yaw rate. [m/s, m/s, rad/s]
    neighbour_azimuth, neighbour_rpm : like the state
        Direction of positive thrust and shaft speed of the unit whose slipstream can meet this one. [rad, rpm]
    unit : AzimuthParameters
        The thruster.
    propeller_thrust : like the state, optional
        Thrust of the propeller at this state and velocity, where it is known already. [N]
    thrust_share : like the state
        Share of the thrust that the slipstreams of other units leave, as `interaction.thrust_shares`. [1]

    Returns
    -------
    Loads
        Forces and load.

    References
    ----------
    Side force: nominal model, azimuth thrusters, fitted to the FMU of the unit; losses: definition. That a slipstream
    across the hull loses thrust: Dang and Laheij, Hydrodynamic aspects of steerable thrusters, DP Conference 2004; the
    squared sine is assumed.
    """
    # Velocity through the water along and across the unit's axis.
    n = thruster.n
    (s, c) = sincos(thruster.azimuth + unit.azimuth_offset)
    u_a, u_s = _inflow(s, c, u_r, v_r, r, unit)
    thrust = (
        propeller_loads(u_a, n, propeller=unit)[0] if propeller_thrust is None else propeller_thrust
    )
    # Losses act on the thrust, not on the torque: the drive does not notice them.
    if unit.loses:
        thrust = thrust * _kept(n, s, neighbour_azimuth, neighbour_rpm, unit)
    thrust = thrust * thrust_share
    # Side force F_s = -c ρ D² (V + |n| D) u_s: the water taken along is turned into the axis.
    D = unit.diameter
    wash = abs(n) * D
    if acts(unit.side_force_astern, neutral=1.0):
        wash = wash * where(n < 0.0, unit.side_force_astern, 1.0)
    side = (
        -unit.side_force_coefficient * unit.water_density * D * D * (hypot(u_a, u_s) + wash) * u_s
    )
    # From the unit's axes into those of the ship, then about her origin.
    return Loads(
        thrust, side, *load_at(unit.x, unit.y, thrust * c - side * s, thrust * s + side * c)
    )


def _inflow(s, c, u_r, v_r, r, unit):
    """Velocity of the unit through water, along and across its axis (sine s, cosine c). [m/s]"""
    u, v = velocity_at(unit.x, unit.y, u_r, v_r, r)
    return c * u + s * v, c * v - s * u


def _kept(n, s, neighbour_azimuth, neighbour_rpm, unit):
    """Share of the propeller's thrust after losses, at an azimuth with the sine s. [1]"""
    # Independent losses multiply. Each is skipped where its parameter is neutral.
    kept = (1.0 - unit.thrust_loss) * where(n < 0.0, 1.0 - unit.reverse_loss, 1.0)
    if acts(unit.angle_loss):
        kept = kept * (1.0 - unit.angle_loss * s * s)
    if not acts(unit.interaction_loss):
        return kept
    # Loss by the neighbour's slipstream, at this unit's position relative to it.
    x = unit.x - unit.neighbour_x
    y = unit.y - unit.neighbour_y
    share = slipstream_share(x, y, neighbour_azimuth, neighbour_rpm, width=unit.interaction_width)
    return kept * (1.0 - unit.interaction_loss * share)
