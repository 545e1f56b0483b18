"""Interaction of thrusters: thrust lost in the slipstream of another, by distance and angle.

The loss of two units one behind the other, and how it goes when the front one turns away, are measured; what is added
here is assumed: a slipstream slower than the hit unit's own takes proportionally less, several slipstreams multiply,
tunnel thrusters neither hit nor are hit, and nothing depends on the speed of the ship.

References
----------
Dang and Laheij, Hydrodynamic aspects of steerable thrusters, Dynamic Positioning Conference 2004: two equal ducted
thrusters at bollard in open water.
"""

from dataclasses import dataclass
from typing import NamedTuple

from shipcosim.angles import wrap
from shipcosim.models.core.maths import Arithmetic, atan2, hypot, minimum, pi, where
from shipcosim.models.core.parameters import numbered_units, quantity

_DEGREES = 180.0 / pi
_STILL = 1e-6  # m/s, added to a slipstream that another is compared with


def _fields(number):
    """Place and size of a unit."""
    none = "no such unit"
    size = f"propeller diameter of unit {number}; 0: there is none"
    return {
        "x": quantity(0.0, "m", f"unit {number} forward of the origin", none),
        "y": quantity(0.0, "m", f"unit {number} to starboard of the origin", none),
        "diameter": quantity(0.0, "m", size, none, minimum=0.0),
    }


@dataclass(frozen=True, kw_only=True)
class InteractionParameters(numbered_units(_fields)):
    """Positions and sizes of the units that can affect one another."""

    loss_scale: float = quantity(
        1.0, "1", "factor on all losses; 0: no interaction", "as published", minimum=0.0
    )


class Pair(NamedTuple):
    """A pair of units, one in front of the other.

    Parameters
    ----------
    front, behind : int
        Numbers of the unit whose slipstream it is and of the unit that it can hit, from 0. [1]
    bearing : float
        Direction from the front one to the other, clockwise from the bow. [rad]
    tandem : float
        Share of its thrust that the other keeps on the axis of the slipstream. [1]
    """

    front: int
    behind: int
    bearing: Arithmetic
    tandem: Arithmetic


def tandem_share(distance: Arithmetic) -> Arithmetic:
    """Share of thrust kept on the axis of an equal unit's slipstream, 1 - 0.8^((x/D)^(2/3)).

    Parameters
    ----------
    distance : float or (...) array or tensor
        Distance over propeller diameter, x/D, above 0. [1]

    Returns
    -------
    like distance
        0 to 1. [1]

    References
    ----------
    Dang and Laheij 2004, in open water.

    Examples
    --------
    Two diameters behind, two thirds are lost; ten diameters behind, a third:

    >>> [round(tandem_share(distance), 2) for distance in (2.0, 10.0)]
    [0.3, 0.65]
    """
    return 1.0 - 0.8 ** (distance ** (2.0 / 3.0))


def kept_share(off_axis: Arithmetic, tandem: Arithmetic, ratio: Arithmetic) -> Arithmetic:
    """Share of its thrust that a unit keeps beside the axis of a slipstream.

    With t on the axis and φ off it in degrees: t + (1 - t) φ³/(130/t³ + φ³); the loss times the ratio of the
    slipstreams, up to 1.

    Parameters
    ----------
    off_axis : float or (...) array or tensor
        Angle at the front unit between the axis of its slipstream and the other unit. [rad]
    tandem : like off_axis
        Share on the axis, as `tandem_share`. [1]
    ratio : like off_axis
        Speed of the slipstream over that of the hit unit's own. [1]

    Returns
    -------
    like off_axis
        0 to 1. [1]

    References
    ----------
    Angle: Dang and Laheij 2004. That the loss goes with the ratio is assumed: so does the advance number that a
    slipstream means for the unit that it hits.
    """
    # Off the axis: t + (1 - t) φ³ / (130/t³ + φ³), φ in degrees, as measured.
    cube = (abs(off_axis) * _DEGREES) ** 3
    kept = tandem + (1.0 - tandem) * cube / (130.0 / tandem**3 + cube)
    # A weak slipstream takes proportionally less, a strong one no more than measured.
    return 1.0 - (1.0 - kept) * minimum(1.0, ratio)


def pairs(parameters: InteractionParameters) -> tuple[Pair, ...]:
    """All pairs of units, each in both orders.

    Parameters
    ----------
    parameters : InteractionParameters
        Places and sizes; a unit without diameter does not exist.

    Returns
    -------
    tuple of Pair
        What `thrust_shares` needs.

    Raises
    ------
    ValueError
        Two units are in the same place.

    References
    ----------
    Definition; of unequal units the diameter is that of the front one (assumed).
    """
    units = list(zip(*(parameters.of_units(name) for name in ("x", "y", "diameter")), strict=True))
    unit_pairs = []
    # Each unit may be in front of each other one; a unit without diameter does not exist.
    for front, (x, y, diameter) in enumerate(units):
        for behind, (other_x, other_y, other) in enumerate(units):
            if front == behind or diameter <= 0.0 or other <= 0.0:
                continue
            # Distance in diameters of the front unit gives the loss on the axis.
            distance = hypot(other_x - x, other_y - y)
            if distance == 0.0:
                raise ValueError(
                    f"units {front + 1} and {behind + 1} are in the same place: x {x} m, y {y} m"
                )
            bearing = atan2(other_y - y, other_x - x)
            unit_pairs.append(Pair(front, behind, bearing, tandem_share(distance / diameter)))
    return tuple(unit_pairs)


def thrust_shares(
    azimuths: tuple, washes: tuple, *, unit_pairs: tuple[Pair, ...], loss_scale: float = 1.0
) -> tuple[Arithmetic, ...]:
    """Share of its thrust that the slipstreams of the others leave to each unit.

    Parameters
    ----------
    azimuths : tuple of floats or (...) arrays or tensors
        Directions of positive thrust, clockwise from the bow. [rad]
    washes : like azimuths
        Speeds of the slipstreams: shaft speed times diameter, negative astern. The slipstream goes opposite to the
        thrust. [m/s]
    unit_pairs : tuple of Pair
        Made by `pairs`.
    loss_scale : float
        Factor on all losses. [1]

    Returns
    -------
    tuple, like azimuths
        0 to 1, one a unit. [1]

    References
    ----------
    As `kept_share`; that several slipstreams multiply is assumed.
    """
    shares = [1.0 + 0.0 * azimuth for azimuth in azimuths]
    # The slipstream goes opposite to the thrust. Several of them multiply.
    for front, behind, bearing, tandem in unit_pairs:
        wash = washes[front]
        towards = where(wash > 0.0, azimuths[front] + pi, azimuths[front])
        # Compare the slipstreams' speeds; the small number avoids a division by zero.
        ratio = abs(wash) / (abs(washes[behind]) + _STILL)
        loss = 1.0 - kept_share(wrap(bearing - towards), tandem, ratio)
        shares[behind] = shares[behind] * (1.0 - loss_scale * loss)
    return tuple(shares)
