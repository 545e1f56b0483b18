"""A ship file for a craft of whom nothing is known but her length and her log: her numbers are to be learned."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from math import pi, sqrt

from shipcosim.errors import error_at
from shipcosim.models.core.constants import GRAVITY

FROUDE = 0.3
"""Froude number of the speed that all thrusters together hold. Assumed."""
_SIDES = {"port": -1.0, "left": -1.0, "starboard": 1.0, "stbd": 1.0, "right": 1.0}
_FORWARD = ("bow", "fore", "tunnel")
_ACROSS = ("bow", "lateral", "tunnel")


@dataclass(frozen=True)
class LoggedThruster:
    """A thruster by the channels of a log.

    Attributes
    ----------
    name : str
        Words in it, such as "port" and "bow", say where it is.
    drives : frozenset of str
        Its channels: ``"rpm"`` or ``"thrust"``, and ``"azimuth"`` where it turns.
    largest : float
        Largest shaft speed in the log. [rpm]
    """

    name: str
    drives: frozenset[str]
    largest: float = 0.0


def assumed_ship_text(length: float, thrusters: Iterable[LoggedThruster]) -> str:
    """Text of a ship file whose numbers follow from the length alone, all of them assumed.

    Damping is linear and takes energy out; no other load of the hull is known. A log corrects the numbers by a factor
    of three or more.

    Parameters
    ----------
    length : float
        Between perpendiculars, or over all. [m]
    thrusters : iterable of LoggedThruster

    Returns
    -------
    str

    Raises
    ------
    ShipcosimError
        A thruster whose channels no model of a thruster takes.
    """
    units = list(thrusters)
    # A hull of usual proportions; the least that the vessel takes is a draught of 0.1 m and 1 kg.m2.
    breadth, draught = 0.4 * length, max(0.1 * length, 0.1)
    mass = 0.5 * 1000.0 * length * breadth * draught
    inertia = max(mass * (0.25 * length) ** 2, 1.0)
    # She loses her way within three lengths ahead, and within one across and in yaw.
    speed = FROUDE * sqrt(GRAVITY * length)
    resistance = 1.1 * mass * speed / (3.0 * length)
    text = _TEXT.format(
        length=length,
        breadth=breadth,
        draught=draught,
        mass=mass,
        inertia=inertia,
        added_surge=0.1 * mass,
        added_sway=0.8 * mass,
        added_yaw=0.8 * inertia,
        X_u=-resistance,
        Y_v=-1.8 * mass * speed / length,
        N_r=-1.8 * inertia * speed / length,
        N_uv=0.7 * mass,
    )
    # All thrusters together hold the speed, each by the same share.
    share = resistance * speed / max(len(units), 1)
    return text + "".join(_thruster(unit, length, share) for unit in units)


def _thruster(logged: LoggedThruster, length: float, thrust: float) -> str:
    """Entry of a thruster with the place that its name says; aft on the centreline without one."""
    words = re.findall("[a-z]+", logged.name.lower())
    side = next((sign for word, sign in _SIDES.items() if word in words), 0.0)
    is_forward = any(word in words for word in _FORWARD)
    entry = {
        "name": f'"{logged.name}"',
        "x": f"{(0.4 if is_forward else -0.4) * length:.4g}",
        "y": f"{0.2 * side * length:.4g}",
    }
    if logged.drives == {"thrust"}:
        entry |= {"kind": '"fixed"', "command": '"thrust"'}
    elif logged.drives == {"rpm"}:
        # Thrust is proportional to the square of the shaft speed.
        coefficient = thrust / (max(logged.largest, 1.0) * pi / 30.0) ** 2
        both = f"coefficient_ahead = {coefficient:.4g}, coefficient_astern = {coefficient:.4g}"
        entry |= {"kind": '"fixed"', "coefficients": f"{{ {both} }}"}
    elif logged.drives == {"rpm", "azimuth"}:
        # Its diameter by a usual thrust coefficient of 0.3.
        turns = max(logged.largest, 1.0) / 60.0
        diameter = (thrust / (0.3 * 1000.0 * turns**2)) ** 0.25
        entry |= {"kind": '"azimuth"', "diameter": f"{diameter:.4g}"}
        entry |= {"thrust": f"{thrust:.4g}", "rpm": f"{60.0 * turns:.4g}"}
    else:
        raise error_at(
            f"thruster '{logged.name}'",
            f"it has {' and '.join(sorted(logged.drives))}.",
            "A thruster has its rpm, its rpm and azimuth, or its thrust along a fixed axis.",
        )
    if "azimuth" not in logged.drives and any(word in words for word in _ACROSS):
        entry["direction"] = f"{0.5 * pi:.6g}"
    return "\n[[thrusters]]\n" + "".join(f"{key} = {value}\n" for key, value in entry.items())


_TEXT = """\
# A craft of whom only the length and a log are known: all numbers are assumed, and corrected by what the log teaches.

description = "a craft learned from her log"
source = "assumed from her length"

[particulars]
length = {length:.6g}
breadth = {breadth:.4g}
draught = {draught:.4g}
water_density = 1000.0

[mass]
mass = {mass:.4g}
inertia_yaw = {inertia:.4g}
centre_of_gravity_x = 0.0
added_surge = {added_surge:.4g}
added_sway = {added_sway:.4g}
added_sway_yaw = 0.0
added_yaw = {added_yaw:.4g}

[hull]                                         # the moment N_uv takes that of the added masses in drift out again
X_u = {X_u:.4g}
Y_v = {Y_v:.4g}
N_r = {N_r:.4g}
N_uv = {N_uv:.4g}
X_uu = 0.0
Y_r = 0.0
Y_ur = 0.0
N_v = 0.0
N_ur = 0.0
cross_flow_drag = 0.0

[waves]
table = "none"
"""
