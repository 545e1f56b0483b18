"""Records of a ship file: what a naval architect writes of a ship, in TOML. See docs/your-own-ship.md."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from shipcosim.ships.estimates.weather import BLENDERMANN
from shipcosim.ships.given import Given, given_in

Length = given_in("m", least=0.0)
Place = given_in("m")
Area = given_in("m2", least=0.0)
Mass = given_in("kg", least=0.0)
Ratio = given_in("1", least=0.0)
Speed = given_in("m/s", least=0.0)
Force = given_in("N", least=0.0)
Power = given_in("W", least=0.0)
Rpm = given_in("rpm", least=0.0)
Seconds = given_in("s", least=0.0)
Angle = given_in("rad")
Coefficients = dict[str, Any]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class Particulars(_Part):
    """Main dimensions. The origin lies midships, on the centreline: x forward, y to starboard."""

    length: Length  # between perpendiculars
    breadth: Length
    draught: Length
    block_coefficient: given_in("1", least=0.0, most=1.0)
    displacement: Mass
    hulls: int = Field(default=1, ge=1, le=3)
    hull_breadth: Length  # of each of several hulls
    service_speed: Speed
    water_density: given_in("kg/m3", least=900.0, most=1100.0)


class Inertia(_Part):
    """Mass, where it lies, and the added mass of the water."""

    mass: Mass
    centre_of_gravity_x: Place
    yaw_gyradius: Length
    yaw_inertia: given_in("kg.m2", least=0.0)
    added_surge: given_in("kg")
    added_sway: given_in("kg")
    added_sway_yaw: given_in("kg.m")
    added_yaw: given_in("kg.m2")


class Resistance(_Part):
    """Resistance ahead: at a speed as measured or computed, or by formulae with what is known of the hull."""

    speed: Speed
    resistance: Force
    wetted_surface: Area
    form_factor: given_in("1", least=1.0, most=3.0)


class Drag(_Part):
    """Drag across."""

    cross_flow: given_in("1", least=0.0, most=4.0)


class Wind(_Part):
    """Wind loads: a table, or areas and a kind of ship."""

    kind: Literal[tuple(BLENDERMANN)] | None = None  # type: ignore[valid-type]
    front_area: Area
    side_area: Area
    side_centre_x: Place
    table: str | None = None
    scale: given_in("1", least=0.0)


class Waves(_Part):
    """Wave drift loads: a table; "none" leaves them out."""

    table: str | None = None


class Control(_Part):
    """How quick the ship's DP is; what is left out follows from her mass and thrust."""

    position_frequency: given_in("rad/s", least=0.0)
    heading_frequency: given_in("rad/s", least=0.0)
    position_error_max: Length


class _Thruster(_Part):
    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")
    x: Place
    y: Place
    coefficients: Coefficients = {}


class FixedPropeller(_Thruster):
    """A propeller on a shaft that does not turn, or a thruster told its force."""

    kind: Literal["fixed"]
    command: Literal["rpm", "thrust"] = "rpm"
    direction: Angle
    diameter: Length
    power: Power
    rpm: Rpm
    thrust: Force
    thrust_astern: Force


class Azimuth(_Thruster):
    """A thruster that turns, with its drive."""

    kind: Literal["azimuth"]
    diameter: Length
    power: Power
    rpm: Rpm
    thrust: Force
    thrust_astern: Force
    ducted: bool = False
    rise_time: Seconds
    turning_rate: given_in("rad/s", least=0.0)


class Tunnel(_Thruster):
    """A tunnel thruster, with its drive."""

    kind: Literal["tunnel"]
    diameter: Length
    power: Power
    rpm: Rpm
    thrust: Force
    rise_time: Seconds


class ThrustMap(_Thruster):
    """A thruster whose thrust over its command was measured."""

    kind: Literal["map"]
    direction: Angle
    table: Annotated[
        list[list[float]] | str, BeforeValidator(lambda found: found if isinstance(found, str) else _rows(found))
    ]
    unit: str = "1"
    time_constant: Seconds
    speed_loss: given_in("s/m")


class PropellerWithRudder(_Thruster):
    """A propeller and the rudder behind it."""

    kind: Literal["rudder"]
    diameter: Length
    power: Power
    rpm: Rpm
    thrust: Force
    rudder_x: Place
    rudder_area: Area
    rudder_span: Length


Thruster = Annotated[
    FixedPropeller | Azimuth | Tunnel | ThrustMap | PropellerWithRudder, Field(discriminator="kind")
]


class ShipFile(_Part):
    """A ship as her file describes her."""

    description: str = ""
    source: str = ""
    based_on: Annotated[list[str], BeforeValidator(lambda v: [v] if isinstance(v, str) else v)] = []
    systems: list[str] = []
    particulars: Particulars | None = None
    mass: Inertia = Inertia()
    resistance: Resistance = Resistance()
    drag: Drag = Drag()
    wind: Wind = Wind()
    waves: Waves = Waves()
    control: Control = Control()
    hull: Coefficients = {}
    thrusters: list[Thruster] = []


KINDS = {"fixed": FixedPropeller, "azimuth": Azimuth, "tunnel": Tunnel, "map": ThrustMap, "rudder": PropellerWithRudder}
"""Kinds of thrusters."""


def number(found: Given | None, otherwise: float = 0.0) -> float:
    """Value of what is given, or another."""
    return otherwise if found is None else found.value


def _rows(found: Any) -> Any:
    if not isinstance(found, list) or not all(isinstance(row, list) and len(row) == 2 for row in found):
        raise ValueError("found no rows of two numbers. Write [[command, thrust in N], ...], or the name of a CSV file.")
    return found
