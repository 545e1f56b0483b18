"""Numbers of the static DP capability that a ship file gives or that are estimated."""

from shipcosim.ships.described import Described
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates.capability import hull_particulars, thruster_particulars
from shipcosim.ships.estimates.estimate import EstimatedNumber
from shipcosim.ships.file import number
from shipcosim.ships.numbers import ESTIMATED


def capability_entries(ship: Described) -> dict[str, dict[str, Quantity]]:
    """Numbers of a described ship that `capability.toml` and `capability-NAME.toml` may leave out.

    Parameters
    ----------
    ship : Described

    Returns
    -------
    dict of dict of Quantity
        By file and name. A thruster of which no diameter is given has none.
    """
    wind = ship.file.wind
    breadth = number(ship.file.particulars.breadth)
    hull = hull_particulars(ship.form, breadth, number(wind.side_centre_x))
    entries = {"capability": {name: _entry(*entry) for name, entry in hull.items()}}
    # Areas that the file gives come before estimates.
    for name, given in (("front", wind.front_area), ("side", wind.side_area)):
        if given is not None:
            origin = given.origin or ship.file.source
            area = Quantity(given.value, "m2", given.tolerance or 0.0, origin)
            entries["capability"][f"wind_area_{name}"] = area
    for unit, thruster in zip(ship.units, ship.file.thrusters, strict=True):
        if unit.screw is None or unit.kind == "rudder":
            continue
        screw = unit.screw
        of_unit = thruster_particulars(unit.kind, screw.diameter, screw.kind == "ducted")
        # The FMU of a fixed propeller has no limits of its own.
        if unit.kind == "fixed":
            limits = {"power": ("W", screw.power), "thrust_ahead": ("N", unit.most)}
            limits["thrust_astern"] = ("N", -unit.least)
            of_unit = of_unit | {
                name: (
                    of,
                    EstimatedNumber(value, 0.0, f"thruster {thruster.name} of the ship file"),
                )
                for name, (of, value) in limits.items()
            }
        entries[f"capability-{unit.name}"] = {name: _entry(*n) for name, n in of_unit.items()}
    return entries


def _entry(unit: str, number: EstimatedNumber) -> Quantity:
    return Quantity(number.value, unit, number.tolerance, f"{ESTIMATED}{number.source}")
