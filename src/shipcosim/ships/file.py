"""Records of a ship file: what a naval architect writes of a ship, in TOML. See docs/your-own-ship.md."""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field

from shipcosim.errors import suggestion
from shipcosim.models.allocation.consequences import GROUPS
from shipcosim.ships.estimates.weather import BLENDERMANN
from shipcosim.ships.given import Given, reader

Number = Given | None
Length = Annotated[Number, reader("m", least=0.0)]
Block = Annotated[Number, reader("1", least=0.0, most=1.0)]
Mass = Annotated[Number, reader("kg", least=0.0)]
Speed = Annotated[Number, reader("m/s", least=0.0)]
Density = Annotated[Number, reader("kg/m3", least=900.0, most=1100.0)]
Place = Annotated[Number, reader("m")]
YawInertia = Annotated[Number, reader("kg.m2", least=0.0)]
AddedMass = Annotated[Number, reader("kg")]
MassLever = Annotated[Number, reader("kg.m")]
AddedInertia = Annotated[Number, reader("kg.m2")]
Force = Annotated[Number, reader("N", least=0.0)]
Area = Annotated[Number, reader("m2", least=0.0)]
Factor = Annotated[Number, reader("1", least=1.0, most=3.0)]
DragCoefficient = Annotated[Number, reader("1", least=0.0, most=4.0)]
Ratio = Annotated[Number, reader("1", least=0.0)]
Rate = Annotated[Number, reader("rad/s", least=0.0)]
Angle = Annotated[Number, reader("rad")]
Power = Annotated[Number, reader("W", least=0.0)]
Rpm = Annotated[Number, reader("rpm", least=0.0)]
Seconds = Annotated[Number, reader("s", least=0.0)]
PerSpeed = Annotated[Number, reader("s/m")]
Coefficients = dict[str, Any]


def _known_kind(kind: str | None) -> str | None:
    if kind is not None and kind not in BLENDERMANN:
        raise ValueError(f'found "{kind}". {suggestion(kind, BLENDERMANN)}')
    return kind


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class Particulars(_Part):
    """Main dimensions. The origin lies midships, on the centreline: x forward, y to starboard."""

    length: Length = None  # between perpendiculars
    breadth: Length = None
    draught: Length = None
    block_coefficient: Block = None
    displacement: Mass = None
    hulls: int = Field(default=1, ge=1, le=3)
    hull_breadth: Length = None  # of each of several hulls
    service_speed: Speed = None
    water_density: Density = None


class Inertia(_Part):
    """Mass, where it lies, and the added mass of the water."""

    mass: Mass = None
    centre_of_gravity_x: Place = None
    yaw_gyradius: Length = None
    inertia_yaw: YawInertia = None
    added_surge: AddedMass = None
    added_sway: AddedMass = None
    added_sway_yaw: MassLever = None
    added_yaw: AddedInertia = None


class Resistance(_Part):
    """Resistance ahead: measured or computed at a speed, or by formulae with known hull data."""

    speed: Speed = None
    resistance: Force = None
    wetted_surface: Area = None
    form_factor: Factor = None


class Drag(_Part):
    """Drag across."""

    cross_flow: DragCoefficient = None


class Wind(_Part):
    """Wind loads: a table, or areas and a kind of ship."""

    kind: Annotated[str | None, AfterValidator(_known_kind)] = None
    front_area: Area = None
    side_area: Area = None
    side_centre_x: Place = None
    table: str | None = None
    scale: Ratio = None


class Waves(_Part):
    """Wave drift loads: a table; "none" leaves them out."""

    table: str | None = None


class Control(_Part):
    """Natural frequencies of the ship's DP; missing ones follow from her mass and thrust."""

    position_frequency: Rate = None
    heading_frequency: Rate = None
    position_error_max: Length = None


class _Thruster(_Part):
    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")
    x: Place = None
    y: Place = None
    group: int = Field(0, ge=0, le=GROUPS)
    coefficients: Coefficients = {}


class Propeller(_Thruster):
    """A propeller and its largest power, speed and thrust."""

    diameter: Length = None
    power: Power = None
    rpm: Rpm = None
    thrust: Force = None


class FixedPropeller(Propeller):
    """A propeller on a fixed shaft, or a thruster with a commanded force."""

    kind: Literal["fixed"]
    command: Literal["rpm", "thrust"] = "rpm"
    direction: Angle = None
    thrust_astern: Force = None


class Azimuth(Propeller):
    """A thruster that turns, with its drive."""

    kind: Literal["azimuth"]
    thrust_astern: Force = None
    ducted: bool = False
    rise_time: Seconds = None
    turning_rate: Rate = None


class Tunnel(Propeller):
    """A tunnel thruster, with its drive."""

    kind: Literal["tunnel"]
    rise_time: Seconds = None


class ThrustMap(_Thruster):
    """A thruster with a measured map of thrust over command."""

    kind: Literal["map"]
    direction: Angle = None
    table: Annotated[
        list[list[float]] | str,
        BeforeValidator(lambda rows: rows if isinstance(rows, str) else _rows(rows)),
    ]
    unit: str = "1"
    time_constant: Seconds = None
    speed_loss: PerSpeed = None


class PropellerWithRudder(Propeller):
    """A propeller and the rudder behind it."""

    kind: Literal["rudder"]
    rudder_x: Place = None
    rudder_area: Area = None
    rudder_span: Length = None


Thruster = Annotated[
    FixedPropeller | Azimuth | Tunnel | ThrustMap | PropellerWithRudder, Field(discriminator="kind")
]


class ShipFile(_Part):
    """A ship as her file describes her."""

    description: str = ""
    source: str = ""
    based_on: Annotated[list[str], BeforeValidator(lambda v: [v] if isinstance(v, str) else v)] = []
    systems: list[str] = []
    particulars: Particulars = Particulars()
    mass: Inertia = Inertia()
    resistance: Resistance = Resistance()
    drag: Drag = Drag()
    wind: Wind = Wind()
    waves: Waves = Waves()
    control: Control = Control()
    hull: Coefficients = {}
    thrusters: list[Thruster] = []


KINDS = {
    "fixed": FixedPropeller,
    "azimuth": Azimuth,
    "tunnel": Tunnel,
    "map": ThrustMap,
    "rudder": PropellerWithRudder,
}
"""Kinds of thrusters."""


def number(given: Given | None, otherwise: float = 0.0) -> float:
    """Value of a given number, or a default."""
    return otherwise if given is None else given.value


def _rows(rows: Any) -> Any:
    if not isinstance(rows, list) or not all(
        isinstance(row, list) and len(row) == 2 for row in rows
    ):
        raise ValueError(
            "found no rows of two numbers. Write [[command, thrust in N], ...], or the name of a CSV file."
        )
    return rows
