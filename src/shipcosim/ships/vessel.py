"""The hull of a ship file as parameters of the vessel."""

from math import sqrt
from pathlib import Path

from shipcosim.errors import Problem
from shipcosim.models.ship.hull import CONTRIBUTIONS
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates.estimate import EstimatedNumber
from shipcosim.ships.estimates.hull import (
    HullDimensions,
    added_masses,
    cross_flow_drag,
    inertia_yaw,
    linear_damping,
    manoeuvring_derivatives,
)
from shipcosim.ships.estimates.resistance import drag_coefficient
from shipcosim.ships.estimates.weather import (
    USUAL_KIND,
    drift_table,
    front_area,
    side_area,
    wind_table,
)
from shipcosim.ships.file import Inertia, Particulars, ShipFile, number
from shipcosim.ships.given import Given
from shipcosim.ships.numbers import Numbers

SEA_WATER = 1025.0
USUAL_FROUDE = 0.2
GRAVITY = 9.81
ALONG = ("X_u", "X_uu")
"""Coefficients of which one is enough for the resistance ahead."""
ACROSS = {name for _, names in CONTRIBUTIONS.values() for name in names} - {
    *ALONG,
    "added_mass_coriolis",
}
"""Coefficients of which one is enough for all loads in sway and yaw."""
NONE = "none"
_NO_WAVES = "0.5 0 0 0 0; 0.5 180 0 0 0; 5 0 0 0 0; 5 180 0 0 0"


def form_of(ship: ShipFile, where: str, problems: list[Problem]) -> HullDimensions | None:
    """Main particulars with a block coefficient; None where something is missing.

    Parameters
    ----------
    ship : ShipFile
    where : str
        Its file.
    problems : list of Problem
        Gets what is missing.
    """
    # Dimensions that nothing can replace.
    p = ship.particulars or Particulars()
    m = ship.mass
    needed = ["length", "breadth", "draught"] + (["hull_breadth"] if p.hulls > 1 else [])
    missing = [name for name in needed if getattr(p, name) is None]
    if missing:
        found = f"nothing says {', '.join(missing)}."
        problems.append(
            Problem(f"{where}: particulars", found, 'Write, for example, length = "28.9 m".')
        )
    # Mass, displacement or block coefficient: one of them is needed.
    heavy = m.mass or p.displacement
    if heavy is None and p.block_coefficient is None:
        remedy = "Give mass.mass, particulars.displacement or particulars.block_coefficient."
        problems.append(Problem(f"{where}: mass", "nothing says how heavy she is.", remedy))
    if missing or (heavy is None and p.block_coefficient is None):
        return None
    # Dimensions of one hull.
    L = number(p.length)
    T = number(p.draught)
    B = number(p.hull_breadth if p.hulls > 1 else p.breadth)
    density = number(p.water_density, SEA_WATER)
    # Block coefficient from the mass, where it is not given.
    filled = number(heavy) / (density * p.hulls * L * B * T)
    block = min(
        max(number(p.block_coefficient, filled), 0.05), 1.0
    )  # the check reports what cannot be
    # Usual service speed at Froude number 0.2.
    speed = number(p.service_speed, USUAL_FROUDE * sqrt(GRAVITY * L))
    return HullDimensions(
        length=L, breadth=B, draught=T, block=block, hulls=p.hulls, density=density, speed=speed
    )


def vessel_of(
    ship: ShipFile, form: HullDimensions, file: Path, problems: list[Problem]
) -> dict[str, Quantity]:
    """Parameters of the vessel, given or estimated.

    Parameters
    ----------
    ship : ShipFile
    form : HullDimensions
        Her main particulars.
    file : Path
        Her file.
    problems : list of Problem
        Gets what is wrong.
    """
    # Coefficients of the file first; each step fills in what is still missing.
    own = Numbers("vessel", f"{file}: hull", file.parent, ship.source, problems)
    own.coefficients(ship.hull)
    p = ship.particulars or Particulars()
    for name in ("length", "breadth", "draught", "water_density"):
        own.give(name, getattr(p, name))
    _inertia(own, ship.mass, ship.particulars or Particulars(), form)
    _resistance(own, ship, form)
    _across(own, ship, form)
    _linear(own, ship, form)
    _weather(own, ship, form)
    return own.entries


def _inertia(own: Numbers, m: Inertia, p: Particulars, form: HullDimensions) -> None:
    """Mass, inertia, added mass."""
    # Mass: given, or from the displaced volume.
    if not own.give("mass", m.mass or p.displacement):
        own.estimate("mass", EstimatedNumber(form.mass, 0.05 * form.mass, "rho C_B L B T"))
    mass = float(own.entries["mass"].value)
    own.give("centre_of_gravity_x", m.centre_of_gravity_x)
    centre = number(m.centre_of_gravity_x)
    # Inertia: given, from a gyration radius, or by the rule of a quarter length.
    if not own.give("inertia_yaw", m.inertia_yaw):
        gyradius = m.yaw_gyradius
        if gyradius is not None:
            # Tolerance of m k^2: 2 m k times that of k.
            tolerance = (
                None
                if gyradius.tolerance is None
                else 2.0 * mass * gyradius.value * gyradius.tolerance
            )
            # Steiner's theorem moves it from the centre of gravity to midships.
            value = mass * (gyradius.value**2 + centre**2)
            own.give("inertia_yaw", Given(value, tolerance, gyradius.origin or own.source))
        else:
            breadth = number(p.breadth)
            own.estimate("inertia_yaw", inertia_yaw(mass, form.length, breadth, centre))
    # Added mass: as given, else by formulae.
    own.give("A11", m.added_surge)
    own.give("A22", m.added_sway)
    for name in ("A26", "A62"):
        own.give(name, m.added_sway_yaw)
    own.give("A66", m.added_yaw)
    own.estimates(added_masses(form))


def _resistance(own: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    # Damping coefficients of the file replace an estimate.
    known = ship.resistance
    if any(name in own.entries for name in ALONG):
        return
    # One point of a speed trial gives the quadratic damping.
    if known.resistance is not None and known.speed is not None:
        tolerance = known.resistance.tolerance
        square = known.speed.value**2
        share = None if tolerance is None else tolerance / square
        own.give("X_uu", Given(-known.resistance.value / square, share, known.resistance.origin))
        return
    # Else Holtrop and Mennen, with any data of the hull that the file has.
    surface = known.wetted_surface.value if known.wetted_surface else None
    factor = known.form_factor.value if known.form_factor else None
    own.estimate("X_uu", drag_coefficient(form, surface, factor))


def _across(own: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Cross-flow drag and manoeuvring derivatives, estimated if the file has none of them."""
    own.give("cross_flow_drag", ship.drag.cross_flow)
    # The coefficients of a hull belong together: mixing given and estimated ones would be wrong.
    if ACROSS & set(ship.hull):
        return
    own.estimate("cross_flow_drag", cross_flow_drag(form))
    # The derivatives hold for single hulls only.
    if form.hulls == 1:
        own.estimates(manoeuvring_derivatives(form, float(own.entries["A22"].value)))


def _linear(own: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Linear damping near rest, of the axes of which the file has no coefficient."""
    # One that the file gives holds at all speeds, where an estimated one fades: never both.
    names = CONTRIBUTIONS["linear_damping"][1]
    if set(names) & set(ship.hull):
        return
    value = {
        name: float(own.entries[name].value)
        for name in ("mass", "A11", "A22", "inertia_yaw", "A66")
    }
    found = linear_damping(
        form,
        value["mass"] + value["A11"],
        value["mass"] + value["A22"],
        value["inertia_yaw"] + value["A66"],
    )
    if set(ALONG) & set(ship.hull):
        found.pop("X_u")
    if ACROSS & set(ship.hull):
        for name in names[1:]:
            found.pop(name)
    if len(found) > 1:
        own.estimates(found)


def _weather(own: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    # Wind: a table, none, or Blendermann's formulae.
    w = ship.wind
    own.give("wind_load_scale", w.scale)
    if w.table is not None and w.table != NONE:
        own.table("wind_table", w.table)
    elif w.table == NONE:
        own.estimate(
            "wind_table", EstimatedNumber("0 0 0 0; 180 0 0 0", 0.0, "none, by the ship file")
        )
    else:
        _wind(own, ship, form)
    # Waves: a table, none, or reflection at the hull.
    if ship.waves.table is not None and ship.waves.table != NONE:
        own.table("drift_table", ship.waves.table)
    elif ship.waves.table == NONE:
        own.estimate("drift_table", EstimatedNumber(_NO_WAVES, 0.0, "none, by the ship file"))
    else:
        breadth = number((ship.particulars or Particulars()).breadth)
        own.estimate("drift_table", drift_table(form.length, breadth, form.draught, form.density))


def _wind(own: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Blendermann's wind loads with given or estimated areas."""
    w = ship.wind
    breadth = number((ship.particulars or Particulars()).breadth)
    # Areas: given, or usual for her dimensions.
    both = (w.front_area, front_area(breadth)), (w.side_area, side_area(form.length))
    front, side = (float(one.value) if given is None else given.value for given, one in both)
    found = wind_table(w.kind or USUAL_KIND, front, side, number(w.side_centre_x), form.length)
    unknown = [one for given, one in both if given is None]
    source = found.source + "".join(f"; {one.source}" for one in unknown)
    own.estimate("wind_table", found._replace(source=source))
    # Estimated areas make the load less certain.
    share = 0.2 if not unknown else 0.45
    own.estimate(
        "wind_load_scale",
        EstimatedNumber(1.0, share, "1; the tolerance is of the coefficients and the areas"),
    )
