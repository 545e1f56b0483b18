"""Messages of sensors: the records that pass between them and the DP controller.

References
----------
Definition.
"""

from typing import NamedTuple

from shipcosim.models.core.maths import Arithmetic


class Fix(NamedTuple):
    """Message of a position reference.

    Parameters
    ----------
    x, y : float or (m,) array
        Position. [m]
    u, v : float or (m,) array
        Velocity over ground in body axes. [m/s]
    valid : float or (m,) array
        1 where the reference says that it works, else 0: then the rest is old. [1]
    """

    x: Arithmetic
    y: Arithmetic
    u: Arithmetic
    v: Arithmetic
    valid: Arithmetic


class Heading(NamedTuple):
    """Message of a compass.

    Parameters
    ----------
    psi : float or (m,) array
        Heading in [-π, π). [rad]
    valid : float or (m,) array
        1 where the compass says that it works, else 0. [1]
    """

    psi: Arithmetic
    valid: Arithmetic


class Wind(NamedTuple):
    """Message of the anemometer.

    Parameters
    ----------
    speed, wind_from : float or (m,) array
        Mean of the apparent wind at the mast, from the bow. [m/s, rad]
    valid : float or (m,) array
        1 where the anemometer says that it works, else 0. [1]
    """

    speed: Arithmetic
    wind_from: Arithmetic
    valid: Arithmetic


class Telegrams(NamedTuple):
    """Messages of all sensors at one time.

    Parameters
    ----------
    positions : tuple of three Fix
        Of the position references.
    compasses : tuple of two Heading
        Of the compasses.
    r : float or (m,) array
        Yaw rate. [rad/s]
    wind : Wind
        Of the anemometer.
    position_time, heading_time, wind_time : float
        Times at which these were sampled. [s]
    """

    positions: tuple[Fix, Fix, Fix]
    compasses: tuple[Heading, Heading]
    r: Arithmetic
    wind: Wind
    position_time: float
    heading_time: float
    wind_time: float
