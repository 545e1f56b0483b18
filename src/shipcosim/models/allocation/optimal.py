"""Optimal thrust allocation: least power within all limits, for named and for numbered units.

The law is that of `sqp`; here are the units. A named azimuth has two cones of allowed angles, ahead
and astern: `cones` chooses one for each. It starts with port ahead and starboard astern: one unit
ahead and one astern can give any small load without a reversal. A numbered unit keeps its interval;
`detours` turns it the long way round.
A unit that turns runs with its least thrust or more, and reverses only where another unit
is missing. Any other unit has a fixed direction and reverses. The parameters `port_azimuth` and
`starboard_azimuth` belong to laws with fixed angles; they are not used here.
"""

from dataclasses import dataclass
from math import inf, pi

from shipcosim.models.allocation.cones import ConeChoice, cone_choices, cone_step, cones_at_rest
from shipcosim.models.allocation.consequences import Balance, BalanceParameters, units_of
from shipcosim.models.allocation.fixed_angles import FixedAngleParameters
from shipcosim.models.allocation.sqp import (
    AllocatedThruster,
    OptimalProblem,
    Turned,
    designed,
    resting,
)
from shipcosim.models.allocation.units import NamedUnits, turning_fields
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import numbered_units, quantity

_DEGREE = pi / 180.0
_SECTORS = "forbidden sectors of 80 to 100 deg to both sides, Skulstad 2021, paper V"


@dataclass(frozen=True, kw_only=True)
class TurningParameters(NamedUnits):
    """Two azimuth thrusters that turn and a tunnel thruster: limits, turning and prices."""

    port_azimuth_start: float = quantity(
        0.0, "rad", "angle of the port azimuth at the start", "as the thruster's"
    )
    starboard_azimuth_start: float = quantity(
        0.0, "rad", "the same of the starboard azimuth", "as the thruster's"
    )
    port_azimuth_first: float = quantity(
        -80 * _DEGREE, "rad", "port azimuth turns clockwise from here", _SECTORS
    )
    port_azimuth_last: float = quantity(80 * _DEGREE, "rad", "and to here", _SECTORS)
    starboard_azimuth_first: float = quantity(
        100 * _DEGREE, "rad", "starboard azimuth turns from here", _SECTORS
    )
    starboard_azimuth_last: float = quantity(260 * _DEGREE, "rad", "and to here", _SECTORS)
    azimuth_rate_max: float = quantity(
        10 * _DEGREE,
        "rad/s",
        "quickest turning of a command",
        "Skulstad 2021, paper V, Table I",
        minimum=0.0,
    )
    azimuth_thrust_least: float = quantity(
        1000.0,
        "N",
        "least thrust of an azimuth that runs",
        "tried: calm needs it to follow small loads",
        minimum=0.0,
    )
    tunnel_price: float = quantity(
        4.77,
        "1",
        "power of the tunnel thruster over that of an azimuth at the same thrust",
        "200 kW at 21.6 kN, its motor; 194 kW at 60 kN, bollard curve",
        minimum=1e-3,
    )
    turning_time: float = quantity(
        10.0,
        "s",
        "time constant of turning to the cheapest direction",
        "tried: 1 s turns twice as much",
        minimum=0.0,
    )

    @property
    def by_unit(self) -> dict[str, tuple]:
        """As of `NamedUnits`, and what belongs to turning."""
        least = self.azimuth_thrust_least
        rate = self.azimuth_rate_max
        return super().by_unit | {
            "thrust_least": (least, least, -self.tunnel_thrust_max),
            "azimuth_rate": (rate, rate, 0.0),
            # Both cones together, and thrust either way where a unit is missing, leave out little.
            "azimuth_first": (0.0, 0.0, 0.0),
            "azimuth_last": (0.0, 0.0, 0.0),
        }

    @property
    def start_azimuths(self) -> tuple:
        """Directions at the start. [rad]"""
        return self.port_azimuth_start, self.starboard_azimuth_start, 0.5 * pi

    @property
    def turning(self) -> tuple:
        """Units that turn."""
        return True, True, False

    @property
    def sectors(self) -> tuple:
        """Intervals of angles of the units; the tunnel points to starboard. [rad]"""
        port = self.port_azimuth_first, self.port_azimuth_last
        starboard = self.starboard_azimuth_first, self.starboard_azimuth_last
        return port, starboard, (0.5 * pi, 0.5 * pi)

    @property
    def prices(self) -> tuple:
        """Power over thrust^1.5, relative to an azimuth. [1]"""
        return 1.0, 1.0, self.tunnel_price


@dataclass(frozen=True, kw_only=True)
class OptimalParameters(BalanceParameters, TurningParameters):
    """Two azimuth thrusters, each with the cone of its interval and the opposite one, and a tunnel thruster."""

    azimuth_thrust_least: float = quantity(
        800.0,
        "N",
        "least thrust of an azimuth that runs",
        "tried: 500 N follow small loads in calm; 1000 N cost 14 % in head wind of 8 m/s",
        minimum=0.0,
    )
    cone_margin: float = quantity(
        0.03,
        "1",
        "share of the present cost by which other cones must be cheaper to be taken; 1: cones stay",
        "assumed: 0.05 left 9 % to be saved, 0.03 at most 3 %",
        minimum=0.0,
    )
    cone_wait: float = quantity(
        30.0, "s", "time for which other cones must be cheaper to be taken", "assumed", minimum=0.0
    )
    cone_missed_most: float = quantity(
        1000.0,
        "N",
        "force that the present cones may miss and others give; more changes them at once",
        "assumed: some 2 % of full thrust",
        minimum=0.0,
    )
    cone_wait_missed: float = quantity(
        5.0,
        "s",
        "time for which the present cones must miss more than that",
        "assumed: longer than noise and gusts",
        minimum=0.0,
    )
    cone_average: float = quantity(
        60.0, "s", "time constant of averaging what cones cost", "assumed", minimum=0.0
    )
    cone_thrust_most: float = quantity(
        15e3,
        "N",
        "most thrust of an azimuth that still changes its cone: the other units carry its load meanwhile",
        "assumed: a quarter of full thrust, given up in 15 s",
        minimum=0.0,
    )
    sectors_always: float = quantity(
        0.0,
        "1",
        "1: forbidden sectors hold always; 0: not for an azimuth while the other is missing",
        "choice: a sector keeps the wash off the other azimuth",
        minimum=0.0,
        maximum=1.0,
    )

    @property
    def choice(self) -> ConeChoice:
        """How the cones of the azimuths are chosen."""
        # An interval of half a turn or more has no opposite one.
        rows = zip(self.turning, self.sectors, strict=True)
        two = tuple(turns and last - first < pi for turns, (first, last) in rows)
        return ConeChoice(
            cone_choices(two),
            self.cone_margin,
            self.cone_wait,
            self.cone_wait_missed,
            self.cone_average,
            self.cone_missed_most,
            self.cone_thrust_most,
            self.sectors_always,
        )


def _fields(number):
    """Turning and price of a unit."""
    least = f"least thrust of unit {number} where it turns"
    power = f"power of unit {number} at its largest thrust, over that thrust; only the ratios of the units count"
    assumed = "full power goes with full thrust, assumed"
    return turning_fields(number) | {
        "thrust_least": quantity(0.0, "N", least, "none", minimum=0.0),
        "specific_power": quantity(1.0, "W/N", power, assumed, minimum=1e-9),
    }


@dataclass(frozen=True, kw_only=True)
class OptimalUnitsParameters(numbered_units(_fields), BalanceParameters, FixedAngleParameters):
    """Places, limits, turning and prices of the units."""

    yaw_lever_degraded: float = quantity(
        300.0,
        "m",
        "the same where the units left cannot hold both: position before heading",
        "assumed: beyond the levers of most ships",
        minimum=0.1,
    )
    turning_time: float = quantity(
        10.0,
        "s",
        "time constant of turning to the cheapest direction",
        "tried with two azimuths and a tunnel",
        minimum=0.0,
    )

    @property
    def turning(self) -> tuple:
        """Units that turn."""
        return tuple(rate > 0.0 for rate in self.of_units("azimuth_rate"))

    @property
    def sectors(self) -> tuple:
        """Intervals of angles of the units; an empty one does not limit. [rad]"""
        intervals = zip(self.of_units("azimuth_first"), self.of_units("azimuth_last"), strict=True)
        return tuple((first, last) if last > first else (-inf, inf) for first, last in intervals)

    @property
    def prices(self) -> tuple:
        """Power over thrust^1.5, from the power at the largest thrust. [W/N^1.5]"""
        units = map(self.of_units, ("specific_power", "thrust_min", "thrust_max"))
        return tuple(
            power * max(high, -low, 1.0) ** -0.5 for power, low, high in zip(*units, strict=True)
        )

    @property
    def choice(self) -> ConeChoice | None:
        """Units keep their interval of angles."""
        return None


def design(parameters: OptimalParameters | OptimalUnitsParameters) -> OptimalProblem:
    """Parameters in the form that the law needs.

    Parameters
    ----------
    parameters : OptimalParameters or OptimalUnitsParameters
        The units.

    Returns
    -------
    OptimalProblem
        Port, starboard and tunnel; or unit 1 to 6.

    References
    ----------
    Definition.
    """
    p = parameters
    names = ("x", "y", "azimuth", "thrust_min", "thrust_max", "thrust_rate")
    columns = map(p.of_units, (*names, "azimuth_rate", "thrust_least"))
    rows = zip(*columns, p.turning, p.sectors, p.prices, strict=True)
    units = tuple(_unit(*row) for row in rows)
    problem = designed(units, p.turning_time, p.yaw_lever, p.yaw_lever_degraded)
    balance = Balance(units_of(p), p.load_time, p.dynamic_factor)
    return problem._replace(choice=p.choice, balance=balance)


def _unit(x, y, azimuth, low, high, thrust_rate, azimuth_rate, least, turns, sector, price):
    """A unit as `sqp` needs it."""
    # A unit that turns keeps its least thrust; any other has one direction, and reverses.
    if turns:
        first, last = sector
        return AllocatedThruster(
            x, y, min(least, high), high, low, thrust_rate, first, last, azimuth_rate, price
        )
    return AllocatedThruster(x, y, low, high, low, thrust_rate, azimuth, azimuth, 0.0, price)


def at_rest(tau: Load, *, parameters: OptimalParameters | OptimalUnitsParameters) -> Turned:
    """State at the start: no thrust.

    Parameters
    ----------
    tau : tuple of three floats or (...) arrays or tensors
        Any load: it gives shape and type only. [N, N, N.m]
    parameters : OptimalParameters or OptimalUnitsParameters
        Units and their angles at the start.

    Returns
    -------
    Turned
        The state.

    References
    ----------
    Definition.
    """
    state = resting(tau, parameters.start_azimuths)
    return cones_at_rest(state, tau, design=design(parameters))


step = cone_step
