"""Size of a degree on the earth, and fixes in a plane."""

import numpy as np

from shipcosim.angles import wrap_series

EQUATORIAL_RADIUS = 6378137.0  # [m, 1] WGS 84
ECCENTRICITY_SQUARED = 6.69437999014e-3


def metres_per_degree(latitude: float) -> tuple[float, float]:
    """Length of a degree of latitude and of one of longitude. [m]

    Parameters
    ----------
    latitude : float
        [deg]
    """
    sine = np.sin(np.radians(latitude))
    cosine = np.cos(np.radians(latitude))
    # Radii of curvature of the ellipsoid: along the meridian,
    # and across it times the cosine of the latitude.
    curvature = 1.0 - ECCENTRICITY_SQUARED * sine**2
    meridian = EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED) / curvature**1.5
    return float(np.radians(meridian)), float(
        np.radians(EQUATORIAL_RADIUS / np.sqrt(curvature) * cosine)
    )


def local_plane(latitude: np.ndarray, longitude: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """North and east of fixes in a plane about the first of them, and its row; NaN where there is no fix.

    Parameters
    ----------
    latitude, longitude : (n,) array
        [deg]
    """
    fixes = np.flatnonzero(np.isfinite(latitude) & np.isfinite(longitude))
    first = int(fixes[0]) if len(fixes) else 0
    meridian, parallel = metres_per_degree(float(latitude[first]))
    # The longitude is wrapped, for tracks over the date line.
    east = parallel * wrap_series(longitude - longitude[first])
    return meridian * (latitude - latitude[first]), east, first
