"""What DNV-ST-0111 Level 1 asks of a hull and her thrusters beyond the parameters of a run."""

from math import atan

from shipcosim.ships.estimates.estimate import EstimatedNumber, within
from shipcosim.ships.estimates.hull import HullDimensions
from shipcosim.ships.estimates.weather import front_area, side_area

BOW = 0.147
"""Distance behind the stem at which the waterline has a quarter of the breadth, over the length. [1]"""


def hull_particulars(
    form: HullDimensions, breadth: float, centre_x: float
) -> dict[str, tuple[str, EstimatedNumber]]:
    """Shape and areas of a hull, as of ``capability.toml``.

    Parameters
    ----------
    form : HullDimensions
    breadth : float
        Of the whole ship. [m]
    centre_x : float
        Centre of the side area above water forward of midships. [m]

    Returns
    -------
    dict of str to (str, EstimatedNumber)
        By name: unit and number.
    """
    L = form.length
    bow = atan(0.25 * breadth / (BOW * L))
    return {
        "midship_x": ("m", EstimatedNumber(0.0, 0.0, "her origin is midships")),
        "submerged_length": ("m", within(L, 0.05, "between perpendiculars; assumed")),
        "submerged_centre_x": ("m", EstimatedNumber(0.0, 0.02 * L, "midships; assumed")),
        "bow_angle": ("rad", within(bow, 0.4, "B/4 reached 0.147 L behind the stem; assumed")),
        "waterplane_aft": ("1", EstimatedNumber(0.9, 0.08, "full aft, as work ships are; assumed")),
        "wind_area_front": ("m2", front_area(breadth)),
        "wind_area_side": ("m2", side_area(L)),
        "wind_centre_x": ("m", EstimatedNumber(centre_x, 0.05 * L, "as of the wind; assumed")),
        "current_area_side": ("m2", within(L * form.draught, 0.1, "length times draught; assumed")),
        "current_centre_x": ("m", EstimatedNumber(0.0, 0.02 * L, "midships; assumed")),
    }


def thruster_particulars(
    kind: str, diameter: float, ducted: bool
) -> dict[str, tuple[str, EstimatedNumber]]:
    """Propeller of a thruster, as of ``capability-NAME.toml``.

    Parameters
    ----------
    kind : str
        Of the ship file.
    diameter : float
        [m]
    ducted : bool
        Whether the propeller is in a nozzle.

    Returns
    -------
    dict of str to (str, EstimatedNumber)
        By name: unit and number.
    """
    # The tips of a propeller run at the base line; a tunnel lies half a diameter above it.
    height = diameter if kind == "tunnel" else 0.5 * diameter
    made = "ducted" if ducted else "open"
    drive = "shaft" if kind == "fixed" else "geared"
    return {
        "shaft_height": ("m", within(height, 0.3, "from the diameter; assumed")),
        "diameter": ("m", EstimatedNumber(diameter, 0.0, "by the ship file")),
        "propeller": ("1", EstimatedNumber(made, 0.0, "by the ship file")),
        "transmission": ("1", EstimatedNumber(drive, 0.0, "usual of this kind; assumed")),
    }
