"""The thrusters of a ship file as parameters of their FMUs, and as the DP sees them."""

from dataclasses import dataclass
from math import cos, pi, sin, sqrt
from pathlib import Path

from shipcosim.errors import Problem
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
        # Effect of one newton at its place: (cos a, sin a, x sin a - y cos a).
        c = cos(self.direction)
        s = sin(self.direction)
        return c, s, self.x * s - self.y * c

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
    for one in thrusters:
        own = Numbers(
            FMU_OF[one.kind], f"{file}: thruster {one.name}", file.parent, source, problems
        )
        # Coefficients with the FMU's names come first.
        own.coefficients(one.coefficients)
        # A tunnel lies on the centreline; all others need both coordinates.
        needed = ("x",) if isinstance(one, Tunnel) else ("x", "y")
        if missing := [name for name in needed if getattr(one, name) is None]:
            found = f"nothing says {' and '.join(missing)}."
            problems.append(
                Problem(own.where, found, 'x is forward of midships, y to starboard: x = "-12 m".')
            )
            continue
        # For a rudder, x is the place of the propeller.
        if one.kind == "rudder":
            own.give("propeller_x", one.x)
        else:
            for name in needed:
                own.give(name, getattr(one, name))
        unit = _made(one, own, form, alone=sum(t.kind == one.kind for t in thrusters) == 1)
        if unit is not None:
            units.append(unit)
    return units


def _made(one: Thruster, own: Numbers, form: HullDimensions, alone: bool) -> ShipThruster | None:
    """A thruster of any kind."""
    if isinstance(one, FixedPropeller):
        return _fixed(one, own, form)
    if isinstance(one, Azimuth):
        return _azimuth(one, own, form)
    if isinstance(one, Tunnel):
        return _tunnel(one, own, form)
    if isinstance(one, ThrustMap):
        return _mapped(one, own)
    return _rudder(one, own, form, alone)


def _unit(
    one: Thruster,
    own: Numbers,
    least: float,
    most: float,
    rate: float,
    direction: float,
    screw: Screw | None = None,
) -> ShipThruster:
    place = number(one.x), number(one.y)
    return ShipThruster(
        name=one.name,
        kind=one.kind,
        fmu=own.fmu,
        x=place[0],
        y=place[1],
        direction=direction,
        least=least,
        most=most,
        rate=rate,
        entries=own.entries,
        screw=screw,
        group=one.group,
    )


def _screw(
    one: FixedPropeller | Azimuth | Tunnel | PropellerWithRudder,
    own: Numbers,
    form: HullDimensions,
    kind: str,
) -> Screw | None:
    """Propeller of a thruster, missing data estimated; None and a problem if that fails."""
    # Diameter, and power or thrust, are the least that an estimate needs.
    if one.diameter is None or (one.power is None and one.thrust is None):
        missing = "diameter" if one.diameter is None else "power or thrust"
        remedy = 'Give diameter and power, power = "500 kW"; thrust at the bollard and rpm where they are known.'
        own.problems.append(Problem(own.where, f"nothing says {missing}.", remedy))
        return None
    D = one.diameter.value
    density = form.density
    # Missing thrust from power by DNV-ST-0111, or missing power from thrust by its inverse.
    usual = bollard_thrust(kind, D, number(one.power)) if one.power else None
    thrust = one.thrust.value if one.thrust else float(usual.value if usual else 0.0)
    of_kind = float(bollard_thrust(kind, 1.0, 1000.0 / 0.95).value)
    power = one.power.value if one.power else 1000.0 / D / 0.95 * (thrust / of_kind) ** 1.5
    # Missing speed from a usual thrust coefficient.
    rpm = one.rpm.value if one.rpm else float(shaft_speed(kind, D, thrust, density).value)
    return Screw(kind=kind, diameter=D, power=power, thrust=thrust, rpm=rpm, density=density)


def _said(one: FixedPropeller | Azimuth | Tunnel) -> str:
    """Names the parts of a propeller's thrust and speed that are estimated."""
    parts = [] if one.thrust else ["thrust by DNV-ST-0111"]
    parts += [] if one.rpm else ["speed by a usual thrust coefficient"]
    parts += [] if one.power else ["power by DNV-ST-0111"]
    return ", ".join(parts)


def _share(one: FixedPropeller | Azimuth | Tunnel) -> float:
    """Relative tolerance of the thrust at a shaft speed, larger for estimates."""
    return 0.05 + (0.0 if one.thrust else 0.15) + (0.0 if one.rpm else 0.15)


def _fixed(one: FixedPropeller, own: Numbers, form: HullDimensions) -> ShipThruster | None:
    # Limits of thrust ahead and astern, as given or usual.
    own.give("direction", one.direction)
    direction = number(one.direction)
    most = number(one.thrust)
    least = -number(one.thrust_astern, ASTERN["open"] * most)
    # With given coefficients, thrust is their value times the squared speed.
    if "coefficient_ahead" in own.entries and one.rpm is not None:
        square = (one.rpm.value * pi / 30.0) ** 2
        astern = own.entries.get("coefficient_astern")
        most = float(own.entries["coefficient_ahead"].value) * square
        least = -(float(astern.value) * square if astern else 0.0)
    # No propeller is needed where the thrust is commanded or its coefficients are known.
    if one.command == "thrust" or "coefficient_ahead" in own.entries:
        return _unit(one, own, least, most, most / RISE, direction)
    # Else estimate coefficients from the propeller: thrust over squared shaft speed.
    screw = _screw(one, own, form, "open")
    if screw is None:
        return None
    least = -number(one.thrust_astern, ASTERN["open"] * screw.thrust)
    speed = screw.rpm * pi / 30.0
    source = f"thrust over squared speed at {screw.thrust:.4g} N, {screw.rpm:.4g} rpm; {_said(one)}".rstrip(
        "; "
    )
    own.estimate("coefficient_ahead", within(screw.thrust / speed**2, _share(one), source))
    astern = source if one.thrust_astern else f"0.7 of ahead; {source}"
    own.estimate("coefficient_astern", within(-least / speed**2, 0.1 + _share(one), astern))
    # Advance speed at which thrust vanishes at full shaft speed.
    zero = ZERO_THRUST["open"] * screw.thrust_coefficient * screw.rpm / 60.0 * screw.diameter
    own.estimate(
        "speed_loss", within(1.0 / zero, 0.3, "no thrust at the advance ratio 2.4 KT of full speed")
    )
    return _unit(one, own, least, screw.thrust, screw.thrust / RISE, direction, screw)


def _azimuth(one: Azimuth, own: Numbers, form: HullDimensions) -> ShipThruster | None:
    # A duct changes thrust and losses.
    kind = "ducted" if one.ducted else "open"
    screw = _screw(one, own, form, kind)
    if screw is None:
        return None
    # Diameter and thrust from the file, else by DNV-ST-0111.
    own.give("diameter", one.diameter)
    own.estimate("water_density", EstimatedNumber(form.density, 0.0, "that of the ship's water"))
    least = -number(one.thrust_astern, ASTERN[kind] * screw.thrust)
    if not own.give("thrust_max", one.thrust):
        own.estimate("thrust_max", within(screw.thrust, 0.15, "DNV-ST-0111"))
    own.estimate(
        "thrust_min",
        within(least, 0.15, "as given" if one.thrust_astern else f"{ASTERN[kind]} of ahead"),
    )
    # Open-water curves, motor and drive.
    own.estimates(curves(screw) | drive(screw, number(one.rise_time, RISE)))
    # A factor 1 on the thrust carries its tolerance for the diagnosis.
    own.estimate(
        "thrust_scale",
        EstimatedNumber(
            1.0, _share(one), f"1; {_said(one) or 'the curve through the bollard point'}"
        ),
    )
    if not own.give("azimuth_rate", one.turning_rate):
        own.estimate("azimuth_rate", EstimatedNumber(TURNING, 0.0, "10 deg/s; assumed"))
    own.estimate(
        "side_force_coefficient",
        EstimatedNumber(0.8, 0.3, "momentum drag of a ducted unit; assumed for others"),
    )
    # The DP holds azimuths outwards, so that they can give sway force and yaw moment.
    outwards = HALF_TURN if number(one.y) > 0.0 else -HALF_TURN
    return _unit(
        one, own, least, screw.thrust, screw.thrust / number(one.rise_time, RISE), outwards, screw
    )


def _tunnel(one: Tunnel, own: Numbers, form: HullDimensions) -> ShipThruster | None:
    screw = _screw(one, own, form, "tunnel")
    if screw is None:
        return None
    # Thrust and torque over squared speed.
    source = f"{screw.thrust:.4g} N at {screw.rpm:.4g} rpm; {_said(one)}".rstrip("; ")
    own.estimate("thrust_coefficient", within(screw.thrust / screw.rpm**2, _share(one), source))
    own.estimate(
        "torque_coefficient",
        within(screw.torque / screw.rpm**2, 0.1, f"{screw.power:.4g} W at that speed"),
    )
    # Tunnels lose thrust with forward speed.
    own.estimate(
        "speed_loss", EstimatedNumber(0.207, 0.1, "1/e left at 2.2 m/s, typical of bow tunnels")
    )
    # The same limits to both sides.
    own.estimate("thrust_max", within(screw.thrust, 0.1, source))
    own.estimate("thrust_min", within(-screw.thrust, 0.1, source))
    own.estimates(drive(screw, number(one.rise_time, RISE)))
    rate = screw.thrust / number(one.rise_time, RISE)
    return _unit(one, own, -screw.thrust, screw.thrust, rate, 0.5 * pi, screw)


def _mapped(one: ThrustMap, own: Numbers) -> ShipThruster | None:
    # Map from a CSV file, or rows in the ship file.
    if isinstance(one.table, str):
        own.table("thrust_table", one.table)
    else:
        rows = "; ".join(f"{command:g} {thrust:g}" for command, thrust in one.table)
        origin = own.source or "given in the ship file"
        columns = ("command [1]", "thrust [N]")
        own.entries["thrust_table"] = Quantity(
            rows, "1", 0.0, origin, columns, f"{own.where}: table"
        )
    for name in ("direction", "time_constant", "speed_loss"):
        own.give(name, getattr(one, name))
    if "thrust_table" not in own.entries:
        return None
    # Limits for the DP: both ends of the map.
    try:
        made = MapParameters(x=0.0, y=0.0, thrust_table=str(own.entries["thrust_table"].value))
        least = within_map(-LARGE, thruster=made)
        most = within_map(LARGE, thruster=made)
    except (ValueError, IndexError) as error:
        remedy = "Rows of command and thrust in N, at least two, both increasing."
        own.problems.append(Problem(own.where, f"{error}", remedy))
        return None
    # A map that gives thrust only to one side has 0 as its other limit.
    least = min(float(least), 0.0)
    most = max(float(most), 0.0)
    return _unit(one, own, least, most, max(most, -least) / RISE, number(one.direction))


def _rudder(
    one: PropellerWithRudder, own: Numbers, form: HullDimensions, alone: bool
) -> ShipThruster | None:
    if one.diameter is None:
        own.problems.append(
            Problem(own.where, "nothing says diameter.", 'Give that of the propeller: "5.8 m".')
        )
        return None
    # Propeller: KT from thrust and speed, else a usual value behind a ship.
    D = one.diameter.value
    density = form.density
    x = number(one.x)
    own.give("diameter", one.diameter)
    own.estimate("water_density", EstimatedNumber(density, 0.0, "that of the ship's water"))
    KT = USUAL_KT["open"] - 0.05
    if one.thrust is not None and one.rpm is not None:
        KT = one.thrust.value / (density * (one.rpm.value / 60.0) ** 2 * D**4)
    # KT = KT0 (1 - 0.75 J/J0 - 0.25 J^2/J0^2), as for other open propellers.
    zero = ZERO_THRUST["open"] * KT
    for name, value in (("k0", KT), ("k1", -0.75 * KT / zero), ("k2", -0.25 * KT / zero**2)):
        own.estimate(
            name,
            within(
                value, 0.2, "form of the Wageningen B series, KT 0.30 unless thrust and rpm say it"
            ),
        )
    # Area by DNV's rule; span from a usual aspect ratio of 1.8.
    area = (
        rudder_area(form)
        if one.rudder_area is None
        else EstimatedNumber(one.rudder_area.value, 0.0, "")
    )
    if not own.give("rudder_area", one.rudder_area):
        own.estimate("rudder_area", area)
    span = number(one.rudder_span, sqrt(1.8 * float(area.value)))
    # The rudder stands half a diameter behind the propeller.
    if not own.give("rudder_x", one.rudder_x):
        own.estimate(
            "rudder_x",
            EstimatedNumber(x - 0.5 * D, 0.1 * D, "half a diameter behind the propeller"),
        )
    # Wake, deduction and interaction with the hull, by regressions.
    own.estimates(
        propeller_and_rudder(
            form, single=alone, span=span, area=float(area.value), covered=D / span
        )
    )
    # The DP does not use it: there is no thrust command. Its power says at which speeds the shaft can turn.
    screw = _screw(one, own, form, "open") if one.power or one.thrust else None
    return _unit(one, own, 0.0, 0.0, 0.0, 0.0, screw)
