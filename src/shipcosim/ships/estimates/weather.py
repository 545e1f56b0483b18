"""Loads of wind and waves on a ship from her dimensions, as the tables that the vessel takes.

References
----------
Blendermann, Parameter identification of wind loads on ships, J. Wind Eng. Ind. Aerodyn. 51, 1994, table and formulae as
in Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed., Wiley, 2021, ch. 10. Maruo, and
Faltinsen, Sea Loads on Ships and Offshore Structures, Cambridge, 1990, ch. 5: a wave that a wall reflects.
"""

from math import cos, exp, pi, radians, sin

from shipcosim.models.core.constants import GRAVITY
from shipcosim.ships.estimates.estimate import EstimatedNumber, within

AIR = 1.225  # kg/m3
_TABLE = """
car carrier                    | 0.95 0.55 0.60 0.80
cargo ship, loaded             | 0.85 0.65 0.55 0.40
cargo ship, containers on deck | 0.85 0.55 0.50 0.40
container ship, loaded         | 0.90 0.55 0.55 0.40
destroyer                      | 0.85 0.60 0.65 0.65
diving support vessel          | 0.90 0.60 0.80 0.55
drilling vessel                | 1.00 0.85 0.925 0.10
ferry                          | 0.90 0.45 0.50 0.80
fishing vessel                 | 0.95 0.70 0.70 0.40
gas tanker                     | 0.70 0.60 0.65 0.50
offshore supply vessel         | 0.90 0.55 0.80 0.55
passenger liner                | 0.90 0.40 0.40 0.80
research vessel                | 0.85 0.55 0.65 0.60
speed boat                     | 0.90 0.55 0.60 0.60
tanker, loaded                 | 0.70 0.90 0.55 0.40
tanker, in ballast             | 0.70 0.75 0.55 0.40
tender                         | 0.85 0.55 0.55 0.65
"""
BLENDERMANN = {
    kind.strip(): tuple(map(float, numbers.split()))
    for kind, numbers in (line.split("|") for line in _TABLE.strip().splitlines())
}
"""Kind of ship: drag across, along with wind from ahead, from astern, and the cross-force parameter."""
USUAL_KIND = "offshore supply vessel"


def front_area(breadth: float) -> EstimatedNumber:
    """Area above water, seen from ahead.

    Parameters
    ----------
    breadth : float
        Overall. [m]

    Returns
    -------
    EstimatedNumber
        [m2]
    """
    return within(0.9 * breadth**2, 0.4, "0.9 B^2, as of small work ships; assumed")


def side_area(length: float) -> EstimatedNumber:
    """Area above water, seen from the side.

    Parameters
    ----------
    length : float
        Between perpendiculars. [m]

    Returns
    -------
    EstimatedNumber
        [m2]
    """
    return within(0.18 * length**2, 0.4, "0.18 L^2, as of small work ships; assumed")


def wind_table(
    kind: str, front: float, side: float, centre_x: float, length: float
) -> EstimatedNumber:
    """Wind loads over the squared apparent wind speed, every ten degrees.

    Parameters
    ----------
    kind : str
        One of `BLENDERMANN`.
    front, side : float
        Areas above water, from ahead and from the side. [m2, m2]
    centre_x : float
        Centre of the side area forward of midships. [m]
    length : float
        Over all, or between perpendiculars. [m]

    Returns
    -------
    EstimatedNumber
        Rows "angle X Y N". [deg, N.s2/m2, N.s2/m2, N.s2/m]

    Notes
    -----
    With the angle g from the bow, CX = -C_l cos g/D, Y = -q A_L C_t sin g/D, D = 1 - d/2 (1 - C_l A_F/(C_t A_L))
    sin² 2g, and the force across acts at s_L + 0.18 L (π/2 - g).
    """
    across, ahead, astern, delta = BLENDERMANN[kind]
    # One row every ten degrees, by symmetry from bow to stern.
    rows = []
    for angle in range(0, 181, 10):
        g = radians(angle)
        # Drag along the ship differs for wind from ahead and from astern.
        along = ahead if angle < 90 else astern
        # D = 1 - d/2 (1 - C_l A_F / (C_t A_L)) sin^2 2g.
        share = along * front / side / across
        divisor = 1.0 - 0.5 * delta * (1.0 - share) * sin(2.0 * g) ** 2
        # Loads per squared wind speed: 1/2 rho A C.
        X = -0.5 * AIR * front * along * cos(g) / divisor
        Y = -0.5 * AIR * side * across * sin(g) / divisor
        # The lateral force acts at s_L + 0.18 L (pi/2 - g).
        N = Y * (centre_x + 0.18 * length * (0.5 * pi - g))
        rows.append(
            f"{angle} " + " ".join(f"{0.0 if abs(load) < 1e-9 else load:.6g}" for load in (X, Y, N))
        )
    return EstimatedNumber(
        "; ".join(rows),
        0.0,
        f"Blendermann 1994, {kind}, A_F {front:.4g} m2, A_L {side:.4g} m2, s_L {centre_x:.3g} m",
    )


def drift_table(length: float, breadth: float, draught: float, density: float) -> EstimatedNumber:
    """Mean wave drift loads over the squared amplitude, of the part of the wave that the hull reflects.

    Parameters
    ----------
    length, breadth, draught : float
        Of the hull. [m]
    density : float
        Of the water. [kg/m3]

    Returns
    -------
    EstimatedNumber
        Rows "omega heading X Y N". [rad/s, deg, N/m2, N/m2, N/m]

    Notes
    -----
    Reflected is what runs above the keel, 1 - exp(-2 k T) of the wave's energy. No yaw moment. Crude: the loads of a
    ship that moves in waves of her own length are up to twice as large or half.
    """
    # Drift loads by wave frequency and heading.
    rows = []
    for omega in (0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.5, 2.0, 2.6):
        # Share of the wave above the keel; k = omega^2/g in deep water.
        reflected = 1.0 - exp(-2.0 * omega**2 / GRAVITY * draught)
        # Load per metre of a reflecting wall, 1/2 rho g a^2, over the squared amplitude.
        scale = 0.5 * density * GRAVITY * reflected**2
        for heading in range(0, 181, 30):
            c = cos(radians(heading))
            s = sin(radians(heading))
            # The load on a wall is proportional to the squared cosine of the angle to its normal.
            X = scale * breadth * c * abs(c)
            Y = scale * length * s * s
            rows.append(f"{omega:g} {heading} {round(X, 3) + 0.0:g} {round(Y, 3) + 0.0:g} 0")
    return EstimatedNumber(
        "; ".join(rows),
        0.0,
        "reflection above the keel, Faltinsen 1990, ch. 5; a factor of two either way",
    )
