"""The thrusters of a ship file as parameters of their FMUs, and as the DP sees them."""

from dataclasses import dataclass
from math import pi, sqrt
from pathlib import Path

from shipcosim.errors import Problem
from shipcosim.models.allocation.units import unit_effect
from shipcosim.models.propulsion.mapped import MapParameters, within_map
from shipcosim.ships.entries import Quantity
from shipcosim.ships.estimates.estimate import EstimatedNumber, within
from shipcosim.ships.estimates.hull import HullDimensions
from shipcosim.ships.estimates.propulsion import (
    ASTERN,
    USUAL_KT,
    ZERO_THRUST,
    Screw,
    bollard_thrust,
    curves,
    drive,
    shaft_speed,
)
from shipcosim.ships.estimates.rudder import propeller_and_rudder, rudder_area
from shipcosim.ships.file import (
    Azimuth,
    FixedPropeller,
    Propeller,
    PropellerWithRudder,
    Thruster,
    ThrustMap,
    Tunnel,
    number,
)
from shipcosim.ships.kinds import FMU_OF
from shipcosim.ships.numbers import Numbers

LARGE = 1e30
RISE = 10.0  # s; rad/s
TURNING = 10.0 * pi / 180.0
HALF_TURN = 0.25 * pi


@dataclass(frozen=True, kw_only=True)
class ShipThruster:
    """A thruster with its parameters, and its limits for the DP.

    Attributes
    ----------
    name, kind, fmu : str
        Of its component; of the ship file; FMU that it is.
    x, y, direction : float
        Place, and the direction that the DP holds it at, clockwise from the bow. [m, m, rad]
    least, most, rate : float
        Limits of its thrust for the DP; 0 where nothing says how much it gives. [N, N, N/s]
    entries : dict of str to Quantity
        Its parameters.
    screw : Screw or None
        Its propeller, where diameter, power, thrust and speed are known or estimated.
    group : int
        Thrusters of one group fail together, as on one bus; 0: it is in none.
    """

    name: str
    kind: str
    fmu: str
    x: float
    y: float
    direction: float
    least: float
    most: float
    rate: float
    entries: dict[str, Quantity]
    screw: Screw | None = None
    group: int = 0

    @property
    def effect(self) -> tuple[float, float, float]:
        """Load of one newton: X, Y, N. [1, 1, m]"""
        return unit_effect(self.x, self.y, self.direction)

    @property
    def azimuth_rate(self) -> float:
        """Largest turning rate; 0 for a fixed direction. [rad/s]"""
        return float(self.entries["azimuth_rate"].value) if self.kind == "azimuth" else 0.0


def units_of_ship(
    thrusters: list[Thruster],
    form: HullDimensions,
    source: str,
    file: Path,
    problems: list[Problem],
) -> list[ShipThruster]:
    """Make all thrusters with all their parameters.

    Parameters
    ----------
    thrusters : list of Thruster
        Of the ship file.
    form : HullDimensions
        The hull.
    source : str
        Where numbers come from that do not say it.
    file : Path
        The ship file.
    problems : list of Problem
        Gets what is missing.
    """
    units = []
    for thruster in thrusters:
        numbers = Numbers(
            FMU_OF[thruster.kind],
            f"{file}: thruster {thruster.name}",
            file.parent,
            source,
            problems,
        )
        # Coefficients with the FMU's names come first.
        numbers.coefficients(thruster.coefficients)
        # A tunnel lies on the centreline; all others need both coordinates.
        needed = ("x",) if isinstance(thruster, Tunnel) else ("x", "y")
        if missing := [name for name in needed if getattr(thruster, name) is None]:
            message = f"nothing says {' and '.join(missing)}."
            problems.append(
                Problem(
                    numbers.where, message, 'x is forward of midships, y to starboard: x = "-12 m".'
                )
            )
            continue
        # For a rudder, x is the place of the propeller.
        if thruster.kind == "rudder":
            numbers.give("propeller_x", thruster.x)
        else:
            for name in needed:
                numbers.give(name, getattr(thruster, name))
        unit = _made(
            thruster, numbers, form, alone=sum(t.kind == thruster.kind for t in thrusters) == 1
        )
        if unit is not None:
            units.append(unit)
    return units


def _made(
    thruster: Thruster, numbers: Numbers, form: HullDimensions, alone: bool
) -> ShipThruster | None:
    """A thruster of any kind."""
    if isinstance(thruster, FixedPropeller):
        return _fixed(thruster, numbers, form)
    if isinstance(thruster, Azimuth):
        return _azimuth(thruster, numbers, form)
    if isinstance(thruster, Tunnel):
        return _tunnel(thruster, numbers, form)
    if isinstance(thruster, ThrustMap):
        return _mapped(thruster, numbers)
    return _rudder(thruster, numbers, form, alone)


def _unit(
    thruster: Thruster,
    numbers: Numbers,
    least: float,
    most: float,
    rate: float,
    direction: float,
    screw: Screw | None = None,
) -> ShipThruster:
    return ShipThruster(
        name=thruster.name,
        kind=thruster.kind,
        fmu=numbers.fmu,
        x=number(thruster.x),
        y=number(thruster.y),
        direction=direction,
        least=least,
        most=most,
        rate=rate,
        entries=numbers.entries,
        screw=screw,
        group=thruster.group,
    )


def _screw(
    thruster: Propeller,
    numbers: Numbers,
    form: HullDimensions,
    kind: str,
) -> Screw | None:
    """Propeller of a thruster, missing data estimated; None and a problem if that fails."""
    # Diameter, and power or thrust, are the least that an estimate needs.
    if thruster.diameter is None or (thruster.power is None and thruster.thrust is None):
        missing = "diameter" if thruster.diameter is None else "power or thrust"
        remedy = 'Give diameter and power, power = "500 kW"; thrust at the bollard and rpm where they are known.'
        numbers.problems.append(Problem(numbers.where, f"nothing says {missing}.", remedy))
        return None
    D = thruster.diameter.value
    density = form.density
    # Missing thrust from power by DNV-ST-0111, or missing power from thrust by its inverse.
    usual = bollard_thrust(kind, D, number(thruster.power)) if thruster.power else None
    thrust = thruster.thrust.value if thruster.thrust else float(usual.value if usual else 0.0)
    of_kind = float(bollard_thrust(kind, 1.0, 1000.0 / 0.95).value)
    power = (
        thruster.power.value if thruster.power else 1000.0 / D / 0.95 * (thrust / of_kind) ** 1.5
    )
    # Missing speed from a usual thrust coefficient.
    rpm = thruster.rpm.value if thruster.rpm else float(shaft_speed(kind, D, thrust, density).value)
    return Screw(kind=kind, diameter=D, power=power, thrust=thrust, rpm=rpm, density=density)


def _estimated_parts(thruster: Propeller) -> str:
    """Names the parts of a propeller's thrust and speed that are estimated."""
    parts = [] if thruster.thrust else ["thrust by DNV-ST-0111"]
    parts += [] if thruster.rpm else ["speed by a usual thrust coefficient"]
    parts += [] if thruster.power else ["power by DNV-ST-0111"]
    return ", ".join(parts)


def _share(thruster: Propeller) -> float:
    """Relative tolerance of the thrust at a shaft speed, larger for estimates."""
    return 0.05 + (0.0 if thruster.thrust else 0.15) + (0.0 if thruster.rpm else 0.15)


def _fixed(thruster: FixedPropeller, numbers: Numbers, form: HullDimensions) -> ShipThruster | None:
    # Limits of thrust ahead and astern, as given or usual.
    numbers.give("direction", thruster.direction)
    direction = number(thruster.direction)
    most = number(thruster.thrust)
    least = -number(thruster.thrust_astern, ASTERN["open"] * most)
    # With given coefficients, thrust is their value times the squared speed.
    if "coefficient_ahead" in numbers.entries and thruster.rpm is not None:
        square = (thruster.rpm.value * pi / 30.0) ** 2
        astern = numbers.entries.get("coefficient_astern")
        most = float(numbers.entries["coefficient_ahead"].value) * square
        least = -(float(astern.value) * square if astern else 0.0)
    # No propeller is needed where the thrust is commanded or its coefficients are known.
    if thruster.command == "thrust" or "coefficient_ahead" in numbers.entries:
        return _unit(thruster, numbers, least, most, most / RISE, direction)
    # Else estimate coefficients from the propeller: thrust over squared shaft speed.
    screw = _screw(thruster, numbers, form, "open")
    if screw is None:
        return None
    least = -number(thruster.thrust_astern, ASTERN["open"] * screw.thrust)
    speed = screw.rpm * pi / 30.0
    source = f"thrust over squared speed at {screw.thrust:.4g} N, {screw.rpm:.4g} rpm; {_estimated_parts(thruster)}".rstrip(
        "; "
    )
    numbers.estimate("coefficient_ahead", within(screw.thrust / speed**2, _share(thruster), source))
    astern = source if thruster.thrust_astern else f"0.7 of ahead; {source}"
    numbers.estimate(
        "coefficient_astern", within(-least / speed**2, 0.1 + _share(thruster), astern)
    )
    # Advance speed at which thrust vanishes at full shaft speed.
    zero = ZERO_THRUST["open"] * screw.thrust_coefficient * screw.rpm / 60.0 * screw.diameter
    numbers.estimate(
        "speed_loss", within(1.0 / zero, 0.3, "no thrust at the advance ratio 2.4 KT of full speed")
    )
    return _unit(thruster, numbers, least, screw.thrust, screw.thrust / RISE, direction, screw)


def _azimuth(thruster: Azimuth, numbers: Numbers, form: HullDimensions) -> ShipThruster | None:
    # A duct changes thrust and losses.
    kind = "ducted" if thruster.ducted else "open"
    screw = _screw(thruster, numbers, form, kind)
    if screw is None:
        return None
    # Diameter and thrust from the file, else by DNV-ST-0111.
    numbers.give("diameter", thruster.diameter)
    numbers.estimate(
        "water_density", EstimatedNumber(form.density, 0.0, "that of the ship's water")
    )
    least = -number(thruster.thrust_astern, ASTERN[kind] * screw.thrust)
    numbers.give("thrust_max", thruster.thrust)
    numbers.estimate("thrust_max", within(screw.thrust, 0.15, "DNV-ST-0111"))
    numbers.estimate(
        "thrust_min",
        within(least, 0.15, "as given" if thruster.thrust_astern else f"{ASTERN[kind]} of ahead"),
    )
    # Open-water curves, motor and drive.
    numbers.estimates(curves(screw) | drive(screw, number(thruster.rise_time, RISE)))
    # A factor 1 on the thrust carries its tolerance for the diagnosis.
    numbers.estimate(
        "thrust_scale",
        EstimatedNumber(
            1.0,
            _share(thruster),
            f"1; {_estimated_parts(thruster) or 'the curve through the bollard point'}",
        ),
    )
    numbers.give("azimuth_rate", thruster.turning_rate)
    numbers.estimate("azimuth_rate", EstimatedNumber(TURNING, 0.0, "10 deg/s; assumed"))
    numbers.estimate(
        "side_force_coefficient",
        EstimatedNumber(0.8, 0.3, "momentum drag of a ducted unit; assumed for others"),
    )
    # The DP holds azimuths outwards, so that they can give sway force and yaw moment.
    outwards = HALF_TURN if number(thruster.y) > 0.0 else -HALF_TURN
    return _unit(
        thruster,
        numbers,
        least,
        screw.thrust,
        screw.thrust / number(thruster.rise_time, RISE),
        outwards,
        screw,
    )


def _tunnel(thruster: Tunnel, numbers: Numbers, form: HullDimensions) -> ShipThruster | None:
    screw = _screw(thruster, numbers, form, "tunnel")
    if screw is None:
        return None
    # Thrust and torque over squared speed.
    source = f"{screw.thrust:.4g} N at {screw.rpm:.4g} rpm; {_estimated_parts(thruster)}".rstrip(
        "; "
    )
    numbers.estimate(
        "thrust_coefficient", within(screw.thrust / screw.rpm**2, _share(thruster), source)
    )
    numbers.estimate(
        "torque_coefficient",
        within(screw.torque / screw.rpm**2, 0.1, f"{screw.power:.4g} W at that speed"),
    )
    # Tunnels lose thrust with forward speed.
    numbers.estimate(
        "speed_loss", EstimatedNumber(0.207, 0.1, "1/e left at 2.2 m/s, typical of bow tunnels")
    )
    # The same limits to both sides.
    numbers.estimate("thrust_max", within(screw.thrust, 0.1, source))
    numbers.estimate("thrust_min", within(-screw.thrust, 0.1, source))
    numbers.estimates(drive(screw, number(thruster.rise_time, RISE)))
    rate = screw.thrust / number(thruster.rise_time, RISE)
    return _unit(thruster, numbers, -screw.thrust, screw.thrust, rate, 0.5 * pi, screw)


def _mapped(thruster: ThrustMap, numbers: Numbers) -> ShipThruster | None:
    # Map from a CSV file, or rows in the ship file.
    if isinstance(thruster.table, str):
        numbers.table("thrust_table", thruster.table)
    else:
        rows = "; ".join(f"{command:g} {thrust:g}" for command, thrust in thruster.table)
        origin = numbers.source or "given in the ship file"
        columns = ("command [1]", "thrust [N]")
        numbers.entries["thrust_table"] = Quantity(
            rows, "1", 0.0, origin, columns, f"{numbers.where}: table"
        )
    for name in ("direction", "time_constant", "speed_loss"):
        numbers.give(name, getattr(thruster, name))
    if "thrust_table" not in numbers.entries:
        return None
    # Limits for the DP: both ends of the map.
    try:
        made = MapParameters(x=0.0, y=0.0, thrust_table=str(numbers.entries["thrust_table"].value))
        least = within_map(-LARGE, thruster=made)
        most = within_map(LARGE, thruster=made)
    except (ValueError, IndexError) as error:
        remedy = "Rows of command and thrust in N, at least two, both increasing."
        numbers.problems.append(Problem(numbers.where, f"{error}", remedy))
        return None
    # A map that gives thrust only to one side has 0 as its other limit.
    least = min(float(least), 0.0)
    most = max(float(most), 0.0)
    return _unit(
        thruster, numbers, least, most, max(most, -least) / RISE, number(thruster.direction)
    )


def _rudder(
    thruster: PropellerWithRudder, numbers: Numbers, form: HullDimensions, alone: bool
) -> ShipThruster | None:
    if thruster.diameter is None:
        numbers.problems.append(
            Problem(numbers.where, "nothing says diameter.", 'Give that of the propeller: "5.8 m".')
        )
        return None
    # Propeller: KT from thrust and speed, else a usual value behind a ship.
    D = thruster.diameter.value
    density = form.density
    x = number(thruster.x)
    numbers.give("diameter", thruster.diameter)
    numbers.estimate("water_density", EstimatedNumber(density, 0.0, "that of the ship's water"))
    KT = USUAL_KT["open"] - 0.05
    if thruster.thrust is not None and thruster.rpm is not None:
        KT = thruster.thrust.value / (density * (thruster.rpm.value / 60.0) ** 2 * D**4)
    # KT = KT0 (1 - 0.75 J/J0 - 0.25 J^2/J0^2), as for other open propellers.
    zero = ZERO_THRUST["open"] * KT
    for name, value in (("k0", KT), ("k1", -0.75 * KT / zero), ("k2", -0.25 * KT / zero**2)):
        numbers.estimate(
            name,
            within(
                value, 0.2, "form of the Wageningen B series, KT 0.30 unless thrust and rpm say it"
            ),
        )
    # Area by DNV's rule; span from a usual aspect ratio of 1.8.
    numbers.give("rudder_area", thruster.rudder_area)
    usual = rudder_area(form)
    numbers.estimate("rudder_area", usual)
    area = number(thruster.rudder_area, float(usual.value))
    span = number(thruster.rudder_span, sqrt(1.8 * area))
    # The rudder stands half a diameter behind the propeller.
    numbers.give("rudder_x", thruster.rudder_x)
    numbers.estimate(
        "rudder_x", EstimatedNumber(x - 0.5 * D, 0.1 * D, "half a diameter behind the propeller")
    )
    # Wake, deduction and interaction with the hull, by regressions.
    numbers.estimates(
        propeller_and_rudder(form, single=alone, span=span, area=area, covered=D / span)
    )
    # The DP does not use it: there is no thrust command. Its power says at which speeds the shaft can turn.
    screw = _screw(thruster, numbers, form, "open") if thruster.power or thruster.thrust else None
    return _unit(thruster, numbers, 0.0, 0.0, 0.0, 0.0, screw)
