"""Power of the thrusters: each bus of the switchboard shares its power among its units.

A propeller with thrust T takes a power proportional to abs(T)^1.5. Each unit of a bus is granted
power in proportion to its present power, plus a little so that a unit at rest can start: the
grants of a bus add up to its available power. A grant limits the motor of the unit at once, and its
thrust in the allocation, which then asks the other units, as at any limit of thrust.
"""

from dataclasses import dataclass

from shipcosim.models.core.maths import minimum, sqrt, where
from shipcosim.models.core.motion import Triple, Vector
from shipcosim.models.core.parameters import quantity, required

_ALMOST_NONE = 1e-12  # keeps derivatives of roots finite


@dataclass(frozen=True, kw_only=True)
class PowerParameters:
    """Power of two azimuth thrusters and a tunnel thruster, and the bus that feeds each."""

    azimuth_full_power: float = required(
        "W", "power of an azimuth at its limits of thrust, at bollard", minimum=1.0
    )
    tunnel_full_power: float = required(
        "W", "power of the tunnel thruster at its limits of thrust", minimum=1.0
    )
    port_bus: float = required("1", "bus that feeds the port azimuth: 0 is A, 1 is B")
    starboard_bus: float = required("1", "bus that feeds the starboard azimuth")
    tunnel_bus: float = required("1", "bus that feeds the tunnel thruster")
    idle_share: float = quantity(
        0.02,
        "1",
        "share of its largest power that a unit counts with when it rests",
        "assumed",
        minimum=1e-6,
    )

    @property
    def largest(self):
        """Power of port, starboard and tunnel at their limits of thrust. [W]"""
        return self.azimuth_full_power, self.azimuth_full_power, self.tunnel_full_power

    @property
    def buses(self):
        """Bus of port, starboard and tunnel."""
        return self.port_bus, self.starboard_bus, self.tunnel_bus


def granted_power(
    used: Triple,
    available: Vector,
    *,
    parameters: PowerParameters,
) -> Triple:
    """Power that each unit may take.

    Parameters
    ----------
    used : tuple of three floats or (...) arrays or tensors
        Shares of their limits of thrust that port, starboard and tunnel are commanded, 0 to 1. [1]
    available : tuple of two floats or (...) arrays or tensors
        Power that buses A and B have for thrusters. [W]
    parameters : PowerParameters
        Powers and buses.

    Returns
    -------
    tuple of three, like used
        Granted powers; those of a bus add up to what it has. [W]

    References
    ----------
    Power over thrust of a propeller at bollard: abs(T)^1.5; the sharing is assumed.
    """
    # Power at the commanded thrusts, |T|^1.5, plus an idle share so that a unit at rest can start.
    wanted = [
        most * (share * sqrt(share + _ALMOST_NONE) + parameters.idle_share)
        for most, share in zip(parameters.largest, used, strict=True)
    ]
    # Sum over the units of each bus.
    on_b = [where(bus > 0.5, 1.0, 0.0) for bus in parameters.buses]
    total_b = sum(power * on for power, on in zip(wanted, on_b, strict=True))
    total_a = sum(power * (1.0 - on) for power, on in zip(wanted, on_b, strict=True))
    # Available power of each bus over what its units want.
    left_a = available[0] / (total_a + _ALMOST_NONE)
    left_b = available[1] / (total_b + _ALMOST_NONE)
    # Each unit gets its part of its bus.
    a, b, c = (
        power * (on * left_b + (1.0 - on) * left_a) for power, on in zip(wanted, on_b, strict=True)
    )
    return a, b, c


def thrust_shares(granted: Triple, *, parameters: PowerParameters) -> Triple:
    """Share of its thrust limits that each unit can give with a granted power; 1 if power does not limit.

    Parameters
    ----------
    granted : tuple of three floats or (...) arrays or tensors
        As of `granted_power`. [W]
    parameters : PowerParameters
        Powers.

    Returns
    -------
    tuple of three, like granted
        Shares, 0 to 1. [1]

    References
    ----------
    As `granted_power`.
    """
    # Invert P = P_full (T / T_max)^1.5; more power than full thrust needs is no limit.
    a, b, c = (
        minimum(1.0, (power / most + _ALMOST_NONE) ** (2.0 / 3.0))
        for power, most in zip(granted, parameters.largest, strict=True)
    )
    return a, b, c
