"""The hull of a ship file as parameters of the vessel."""

from math import sqrt
from pathlib import Path

from shipcosim.errors import Problem
from shipcosim.models.core.constants import GRAVITY
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
    p = ship.particulars
    m = ship.mass
    needed = ["length", "breadth", "draught"] + (["hull_breadth"] if p.hulls > 1 else [])
    missing = [name for name in needed if getattr(p, name) is None]
    if missing:
        message = f"nothing says {', '.join(missing)}."
        problems.append(
            Problem(f"{where}: particulars", message, 'Write, for example, length = "28.9 m".')
        )
    # Mass, displacement or block coefficient: one of them is needed.
    heavy = m.mass or p.displacement
    no_weight = heavy is None and p.block_coefficient is None
    if no_weight:
        remedy = "Give mass.mass, particulars.displacement or particulars.block_coefficient."
        problems.append(Problem(f"{where}: mass", "nothing says how heavy she is.", remedy))
    if missing or no_weight:
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
    numbers = Numbers("vessel", f"{file}: hull", file.parent, ship.source, problems)
    numbers.coefficients(ship.hull)
    p = ship.particulars
    for name in ("length", "breadth", "draught", "water_density"):
        numbers.give(name, getattr(p, name))
    _inertia(numbers, ship.mass, p, form)
    _resistance(numbers, ship, form)
    _across(numbers, ship, form)
    _linear(numbers, ship, form)
    _weather(numbers, ship, form)
    return numbers.entries


def _inertia(numbers: Numbers, m: Inertia, p: Particulars, form: HullDimensions) -> None:
    """Mass, inertia, added mass."""
    # Mass: given, or from the displaced volume.
    numbers.give("mass", m.mass or p.displacement)
    numbers.estimate("mass", EstimatedNumber(form.mass, 0.05 * form.mass, "rho C_B L B T"))
    mass = float(numbers.entries["mass"].value)
    numbers.give("centre_of_gravity_x", m.centre_of_gravity_x)
    centre = number(m.centre_of_gravity_x)
    # Inertia: given, from a gyration radius, or by the rule of a quarter length.
    gyradius = m.yaw_gyradius
    if gyradius is not None:
        # Tolerance of m k^2: 2 m k times that of k.
        tolerance = 2.0 * mass * gyradius.value * (gyradius.tolerance or 0.0)
        # Steiner's theorem moves it from the centre of gravity to midships.
        value = mass * (gyradius.value**2 + centre**2)
        numbers.give("inertia_yaw", Given(value, tolerance, gyradius.origin))
    numbers.give("inertia_yaw", m.inertia_yaw)
    numbers.estimate("inertia_yaw", inertia_yaw(mass, form.length, number(p.breadth), centre))
    # Added mass: as given, else by formulae.
    numbers.give("A11", m.added_surge)
    numbers.give("A22", m.added_sway)
    for name in ("A26", "A62"):
        numbers.give(name, m.added_sway_yaw)
    numbers.give("A66", m.added_yaw)
    numbers.estimates(added_masses(form))


def _resistance(numbers: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    # Damping coefficients of the file replace an estimate.
    stated = ship.resistance
    if any(name in numbers.entries for name in ALONG):
        return
    # One point of a speed trial gives the quadratic damping.
    if stated.resistance is not None and stated.speed is not None:
        square = stated.speed.value**2
        share = (stated.resistance.tolerance or 0.0) / square
        numbers.give(
            "X_uu", Given(-stated.resistance.value / square, share, stated.resistance.origin)
        )
        return
    # Else Holtrop and Mennen, with any data of the hull that the file has.
    surface = stated.wetted_surface.value if stated.wetted_surface else None
    factor = stated.form_factor.value if stated.form_factor else None
    numbers.estimate("X_uu", drag_coefficient(form, surface, factor))


def _across(numbers: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Cross-flow drag and manoeuvring derivatives, estimated if the file has none of them."""
    numbers.give("cross_flow_drag", ship.drag.cross_flow)
    # The coefficients of a hull belong together: mixing given and estimated ones would be wrong.
    if ACROSS & set(ship.hull):
        return
    numbers.estimate("cross_flow_drag", cross_flow_drag(form))
    # The derivatives hold for single hulls only.
    if form.hulls == 1:
        numbers.estimates(manoeuvring_derivatives(form, float(numbers.entries["A22"].value)))


def _linear(numbers: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Linear damping near rest, of the axes of which the file has no coefficient."""
    # One that the file gives holds at all speeds, where an estimated one fades: never both.
    names = CONTRIBUTIONS["linear_damping"][1]
    if set(names) & set(ship.hull):
        return
    value = {
        name: float(numbers.entries[name].value)
        for name in ("mass", "A11", "A22", "inertia_yaw", "A66")
    }
    damping = linear_damping(
        form,
        value["mass"] + value["A11"],
        value["mass"] + value["A22"],
        value["inertia_yaw"] + value["A66"],
    )
    if set(ALONG) & set(ship.hull):
        damping.pop("X_u")
    if ACROSS & set(ship.hull):
        for name in names[1:]:
            damping.pop(name)
    if len(damping) > 1:
        numbers.estimates(damping)


def _weather(numbers: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    # Wind: a table, none, or Blendermann's formulae.
    w = ship.wind
    numbers.give("wind_load_scale", w.scale)
    if w.table is None:
        _wind(numbers, ship, form)
    elif w.table == NONE:
        numbers.estimate(
            "wind_table", EstimatedNumber("0 0 0 0; 180 0 0 0", 0.0, "none, by the ship file")
        )
    else:
        numbers.table("wind_table", w.table)
    # Waves: a table, none, or reflection at the hull.
    if ship.waves.table is None:
        breadth = number(ship.particulars.breadth)
        numbers.estimate(
            "drift_table", drift_table(form.length, breadth, form.draught, form.density)
        )
    elif ship.waves.table == NONE:
        numbers.estimate("drift_table", EstimatedNumber(_NO_WAVES, 0.0, "none, by the ship file"))
    else:
        numbers.table("drift_table", ship.waves.table)


def _wind(numbers: Numbers, ship: ShipFile, form: HullDimensions) -> None:
    """Blendermann's wind loads with given or estimated areas."""
    w = ship.wind
    breadth = number(ship.particulars.breadth)
    # Areas: given, or usual for her dimensions.
    both = (w.front_area, front_area(breadth)), (w.side_area, side_area(form.length))
    front, side = (float(area.value) if given is None else given.value for given, area in both)
    table = wind_table(w.kind or USUAL_KIND, front, side, number(w.side_centre_x), form.length)
    unknown = [estimate for given, estimate in both if given is None]
    source = table.source + "".join(f"; {estimate.source}" for estimate in unknown)
    numbers.estimate("wind_table", table._replace(source=source))
    # Estimated areas make the load less certain.
    share = 0.2 if not unknown else 0.45
    numbers.estimate(
        "wind_load_scale",
        EstimatedNumber(1.0, share, "1; the tolerance is of the coefficients and the areas"),
    )
