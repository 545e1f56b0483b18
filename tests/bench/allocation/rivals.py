"""Allocators of other projects, from the package index: skadipy (GPL-3.0 or later) and quta (MIT).

They are called as their documentation shows, none of their code is here. Each function takes the ship's allocation
parameters and gives a function from a request and the step to the forces of port, starboard and tunnel, (x, y) [N].
"""

import warnings

import numpy as np

AZIMUTH_LIMITS = (
    80.0,
    100.0,
)  # deg from the bow and the stern's side: the sector between is forbidden (paper V)


def quta_with_sectors(ship):
    """quta's least squares over the choices of a front and an aft sector for each azimuth; it knows no rates."""
    from quta.allocator import MinimizePowerAllocator
    from quta.constraints import SectorConstraint
    from quta.thruster import Thruster, TransverseThruster

    front, aft = np.radians(AZIMUTH_LIMITS)
    allocator = MinimizePowerAllocator()
    for x, y in ((ship.port_x, ship.port_y), (ship.starboard_x, ship.starboard_y)):
        unit = Thruster((x, y))
        unit.add_constraint(SectorConstraint(ship.azimuth_thrust_max, -front, front))
        unit.add_constraint(SectorConstraint(ship.azimuth_thrust_max, aft, 2.0 * np.pi - aft))
        allocator.add_thruster(unit)
    allocator.add_thruster(TransverseThruster((ship.tunnel_x, 0.0), ship.tunnel_thrust_max))

    def allocate(tau, h):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return np.reshape(allocator.allocate(tau)[0], (3, 2))

    return allocate


def skadipy_quadratic_programme(ship):
    """skadipy's quadratic programme (OSQP): limits on the components of force; it knows neither sectors nor rates.

    Its other law, the reference filter with barrier functions, divides by zero at a request of zero: left out.
    """
    from pyquaternion import Quaternion
    from shapely.geometry import Point
    from skadipy.actuator import Azimuth, Fixed
    from skadipy.allocator import ForceTorqueComponent, QuadraticProgramming

    def limits(least, most):
        return {"limits": [least, most]}

    azimuths = [
        Azimuth(
            position=Point(x, y, 0.0),
            extra_attributes=limits(-ship.azimuth_thrust_max, ship.azimuth_thrust_max),
        )
        for x, y in ((ship.port_x, ship.port_y), (ship.starboard_x, ship.starboard_y))
    ]
    tunnel = Fixed(
        position=Point(ship.tunnel_x, 0.0, 0.0),
        orientation=Quaternion(axis=(0.0, 0.0, 1.0), radians=np.pi / 2.0),
        extra_attributes=limits(-ship.tunnel_thrust_max, ship.tunnel_thrust_max),
    )
    axes = [getattr(ForceTorqueComponent, axis) for axis in "XYN"]
    allocator = QuadraticProgramming(actuators=[*azimuths, tunnel], force_torque_components=axes)
    allocator.compute_configuration_matrix()

    def allocate(tau, h):
        request = np.array([[tau[0]], [tau[1]], [0.0], [0.0], [0.0], [tau[2]]], dtype=np.float32)
        found = np.ravel(allocator.allocate(tau=request)[0])
        return [(found[0], found[1]), (found[2], found[3]), (0.0, found[4])]

    return allocate
