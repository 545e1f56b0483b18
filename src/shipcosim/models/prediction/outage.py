"""Loss of GNSS: remaining measurements, and the region that contains the ship.

A law that reckons her place is `design`, `start` and `step`, as `motion_filter` and `velocity_network` have them. Its
states have `x`, `y`, `u`, `v`, `lost_for` and `sea`.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from shipcosim.models.core.interpolation import interp
from shipcosim.models.core.maths import Arithmetic, sqrt


class Measured(NamedTuple):
    """Measurements aboard at one time.

    Parameters
    ----------
    x, y : float or (...) array or tensor
        Position by GNSS. [m]
    u, v : like x
        Velocity over ground by GNSS, in body axes. [m/s]
    valid : like x
        1 where GNSS works, 0 where it is lost: position and velocity are then not used. [1]
    psi : like x
        Heading by compass. [rad]
    wind_speed, wind_from : like x
        Apparent wind at the mast, direction it comes from, clockwise from the bow. [m/s, rad]
    commands : tuple of six, like x
        Actual commands of bow tunnels 1 and 2, stern tunnels 3 and 4 and main propellers 5 and 6, in the unit of the
        thruster's map. [1]
    """

    x: Arithmetic
    y: Arithmetic
    u: Arithmetic
    v: Arithmetic
    valid: Arithmetic
    psi: Arithmetic
    wind_speed: Arithmetic
    wind_from: Arithmetic
    commands: tuple


class Region(NamedTuple):
    """Radius of the circle around the reckoned position with the true one in 90 % of cases.

    Parameters
    ----------
    times : tuple of float
        Times since the loss, increasing. [s]
    radii : tuple of float
        Radius there, in a calm. [m]
    sea_share : float
        How much it grows with the roughness of the sea. [s/m]
    """

    times: tuple
    radii: tuple
    sea_share: float


def region_of(arrays: Mapping[str, np.ndarray]) -> Region:
    """The region from trained arrays.

    Parameters
    ----------
    arrays : mapping of str to array
        ``region.times``, ``region.radii`` and ``region.sea_share``. [s, m, s/m]

    Returns
    -------
    Region
        [as its fields]

    Raises
    ------
    KeyError
        An array is missing.

    References
    ----------
    Definition.
    """
    times, radii = (tuple(map(float, arrays[f"region.{name}"])) for name in ("times", "radii"))
    return Region(times, radii, float(arrays["region.sea_share"]))


def radius(lost_for: Arithmetic, sea: Arithmetic, *, region: Region) -> Arithmetic:
    """Radius of the region at a time since the loss.

    Parameters
    ----------
    lost_for : float or (...) array or tensor
        Time since the loss. [s]
    sea : like lost_for
        Variance of velocity by GNSS about the filtered one before the loss, mostly of waves. [m2/s2]
    region : Region
        As calibrated.

    Returns
    -------
    like lost_for
        Radius; beyond the calibrated times it grows on along the last two of them. [m]

    References
    ----------
    Calibration: Vovk, Gammerman, Shafer, Algorithmic Learning in a Random World, Springer, 2005, split conformal.
    """
    times = region.times
    radii = region.radii
    # Beyond the last time the radius grows with the last slope; max(0, t - t_n) written without a
    # branch.
    slope = (radii[-1] - radii[-2]) / (times[-1] - times[-2])
    beyond = 0.5 * (abs(lost_for - times[-1]) + lost_for - times[-1])
    # A rougher sea means less accurate velocity at the loss.
    return (interp(lost_for, times, radii) + slope * beyond) * (1.0 + region.sea_share * sqrt(sea))
