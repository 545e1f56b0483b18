"""A fictional supply vessel whose Level 1 results somebody else has published.

Ship, thrusters and results are those of the documents of W. Boland, Prosjektoppgave_Collab (dp_capability/models/
Descriptions, 2026), an implementation of its own. Its y is to port, ours to starboard.
"""

import numpy as np

from shipcosim.capability.particulars import Hull
from shipcosim.capability.thrust import Thruster, nominal_thrust

HULL = Hull(
    length=80.0,
    breadth=18.0,
    draught=6.0,
    midship_x=0.0,
    submerged_length=86.0,
    submerged_centre_x=-1.0,
    bow_angle=float(np.arctan(0.45)),
    waterplane_aft=0.9,
    wind_area_front=280.0,
    wind_area_side=700.0,
    wind_centre_x=12.0,
    current_area_side=490.0,
    current_centre_x=-1.5,
)


def thruster(
    name, kind, x, y, *, diameter, power, height, eta_1, eta_2=1.0, eta_m=0.93, ducted=False
):
    """A thruster of that vessel, or one like it."""
    thrust = nominal_thrust(diameter, power, eta_1, eta_2, eta_m)
    angle = 0.5 * np.pi if kind == "tunnel" else 0.0
    return Thruster(name, kind, x, y, diameter, 6.0 - height, power, ducted, thrust, thrust, angle)


_AZIMUTH = {"diameter": 3.0, "power": 2e6, "height": 1.8, "eta_1": 1200.0, "ducted": True}
_TUNNEL = {"diameter": 2.0, "power": 0.9e6, "height": 2.5, "eta_1": 900.0}
THRUSTERS = (
    thruster("AZ1", "azimuth", -40.0, -5.5, **_AZIMUTH),
    thruster("AZ2", "azimuth", -40.0, 5.5, **_AZIMUTH),
    thruster("BT1", "tunnel", 31.0, 0.0, eta_2=1.07, **_TUNNEL),
    thruster("BT2", "tunnel", 28.0, 0.0, **_TUNNEL),
)

NUMBERS = (11, 11, 9, 8, 7, 7, 6, 6, 6, 6, 7, 7, 7, 8, 8, 9, 10, 11, 11)
"""DP capability numbers of the intact vessel without losses at the skeg, weather from 0 to 180 deg every 10 deg."""
