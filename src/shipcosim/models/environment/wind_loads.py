"""Wind on a ship: apparent wind, and loads from a table of coefficients."""

from dataclasses import dataclass
from functools import cached_property

from shipcosim.angles import wrap
from shipcosim.models.core.interpolation import interp_columns
from shipcosim.models.core.kinematics import to_body
from shipcosim.models.core.maths import Arithmetic, atan2, hypot, where
from shipcosim.models.core.motion import Load, Vector
from shipcosim.models.core.parameters import acts, quantity, required_table
from shipcosim.models.core.tables import columns_by_angle


@dataclass(frozen=True, kw_only=True)
class WindParameters:
    """Wind load coefficients."""

    wind_table: str = required_table(
        ("angle [deg]", "X [N.s2/m2]", "Y [N.s2/m2]", "N [N.s2/m]"),
        "rows 'angle X Y N': loads per squared apparent wind speed, N/(m/s)2, N.m/(m/s)2, by the angle it comes from "
        "relative to the bow, 0 to 180 deg, starboard",
    )
    wind_load_scale: float = quantity(
        1.0,
        "1",
        "factor on the wind loads; 1 as in the table",
        "neutral",
        tolerance=0.03,
        minimum=0.0,
    )
    apparent_wind_offset: float = quantity(
        0.0,
        "rad",
        "direction of the apparent wind as it is given minus the real one, which loads the ship",
        "neutral",
    )

    @cached_property
    def turned(self):
        """True if the wind comes from another direction than given."""
        return acts(self.apparent_wind_offset)


def apparent_wind(
    psi: Arithmetic, u: Arithmetic, v: Arithmetic, wind_north: Arithmetic, wind_east: Arithmetic
) -> Vector:
    """Wind relative to the moving ship.

    Parameters
    ----------
    psi : float or (...) array or tensor
        Heading. [rad]
    u, v : like psi
        Velocity of the ship over ground. [m/s]
    wind_north, wind_east : like psi
        Velocity of the air over ground. [m/s]

    Returns
    -------
    tuple of two, like psi
        Speed, and direction the wind comes from, clockwise from the bow. [m/s, rad in [-π, π]]

    References
    ----------
    Definition.

    Examples
    --------
    In calm air a ship that goes ahead has the wind from right ahead:

    >>> apparent_wind(0.0, 5.0, 0.0, 0.0, 0.0)
    (5.0, 0.0)
    """
    # Ship velocity minus air velocity points to where the apparent wind comes from.
    wind_u, wind_v = to_body(psi, wind_north, wind_east)
    u_r = u - wind_u
    v_r = v - wind_v
    return hypot(u_r, v_r), atan2(v_r, u_r)


def wind_loads(speed: Arithmetic, wind_from: Arithmetic, *, wind: WindParameters) -> Load:
    """Loads of the apparent wind by linear interpolation; port mirrors starboard.

    Parameters
    ----------
    speed : float or (...) array or tensor
        Apparent wind speed. [m/s]
    wind_from : like speed
        Direction it comes from as given, clockwise from the bow, in [-π, π]. [rad]
    wind : WindParameters
        Table, scale and offset.

    Returns
    -------
    tuple of three, like speed
        X, Y, N. [N, N, N.m]

    Raises
    ------
    ValueError
        The table is not one of four columns whose angles go from 0 to 180 deg.

    References
    ----------
    Blendermann, Parameter identification of wind loads on ships, J. Wind Eng. Ind. Aerodyn. 51, 1994.
    """
    # The offset corrects a wrongly logged direction: the load follows the real one.
    if wind.turned:
        wind_from = wrap(wind_from - wind.apparent_wind_offset)
    # The table has the starboard side only: X is even, Y and N are odd in the angle.
    angles, *loads = columns_by_angle(wind.wind_table, "wind table", 180.0)
    X, Y, N = interp_columns(abs(wind_from), angles, *loads)
    # Loads grow with the square of the apparent speed.
    square = wind.wind_load_scale * speed * speed
    side = where(wind_from < 0.0, -square, square)
    return square * X, side * Y, side * N
