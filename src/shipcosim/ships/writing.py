"""A new ship file from a few particulars: its text, and usual values for the rest."""

from dataclasses import dataclass, field, replace
from math import sqrt

from shipcosim.errors import error_at, suggestion
from shipcosim.models.core.constants import GRAVITY
from shipcosim.ships.estimates.hull import HullDimensions, cross_flow_drag, inertia_yaw
from shipcosim.ships.estimates.resistance import resistance
from shipcosim.ships.estimates.weather import USUAL_KIND, front_area, side_area
from shipcosim.ships.given import number_in

LAYOUTS = {
    "azimuths": "two azimuth thrusters aft, a tunnel thruster at the bow",
    "screws": "two fixed propellers, tunnel thrusters at bow and stern",
    "rudder": "one propeller with a rudder",
}
"""Usual thrusters."""
USUAL_LAYOUT = "azimuths"
ASSUMED = "assumed: usual of a ship of this size"
SHORTEST, LONGEST = 0.1, 1000.0
"""Lengths, breadths and draughts of ships, models included. [m]"""
LENGTH = 30.0
"""Of a ship of which nothing is known. [m]"""
EFFICIENCY = 0.5
USUAL_BLOCK = 0.62


class Usual(str):
    """An answer that is a usual value, not given by the user."""


@dataclass
class Answers:
    """What is known of a new ship; texts with units.

    Attributes
    ----------
    description : str
    length, breadth, draught, displacement, speed, power : str
        Between perpendiculars; ...; service speed; of all propellers together. Empty where nothing is known.
    kind : str
        Of Blendermann's table, for the wind.
    layout : str
        One of `LAYOUTS`; empty where nothing is known.
    thrusters : list of dict of str to str
        Keys of each thruster; beside those of a layout that is given, one of the same name in its place.
    """

    description: str = ""
    length: str = ""
    breadth: str = ""
    draught: str = ""
    displacement: str = ""
    speed: str = ""
    power: str = ""
    kind: str = USUAL_KIND
    layout: str = ""
    thrusters: list[dict[str, str]] = field(default_factory=list)


def usual(answers: Answers, key: str) -> str:
    """Usual value for a ship with the known numbers.

    Parameters
    ----------
    answers : Answers
    key : str
        ``"breadth"``, ``"draught"``, ``"displacement"``, ``"speed"`` or ``"power"``.

    Returns
    -------
    str
        With its unit; empty where not enough is known.

    Examples
    --------
    >>> usual(Answers(length="60 m"), "breadth"), usual(Answers(length="60 m", breadth="14 m"), "draught")
    ('14 m', '4.7 m')
    """
    if not answers.length:
        return Usual(f"{LENGTH:g} m") if key == "length" else ""
    form = _form(answers)
    if key in ("breadth", "draught"):
        return Usual(f"{getattr(form, key):.2g} m")
    if key == "displacement":
        return Usual(f"{_round(form.mass / 1000.0)} t")
    if key == "speed":
        return Usual(f"{form.speed * 3600.0 / 1852.0:.2g} kn")
    # Power from the resistance at service speed and a usual efficiency.
    return Usual(f"{_round(resistance(form) * form.speed / EFFICIENCY / 1000.0)} kW")


def _form(answers: Answers) -> HullDimensions:
    """Hull of usual proportions for the numbers that are not given."""
    L = _given(answers, "length", "m") or LENGTH
    B = _given(answers, "breadth", "m") or 1.55 * L**0.54
    T = _given(answers, "draught", "m") or B / 3.0
    # Displacement by a usual block coefficient, speed by Froude number 0.25.
    mass = _given(answers, "displacement", "kg")
    block = min(max(mass / (1025.0 * L * B * T), 0.2), 1.0) if mass else USUAL_BLOCK
    speed = _given(answers, "speed", "m/s") or 0.25 * sqrt(GRAVITY * L)
    return HullDimensions(
        length=L, breadth=B, draught=T, block=block, hulls=1, density=1025.0, speed=speed
    )


def _given(answers: Answers, key: str, unit: str) -> float | None:
    """An answer as a number, or None. Raises ValueError where it is not above 0, or no length of a ship."""
    text = getattr(answers, key)
    value = number_in(text, unit) if text else None
    if value is not None and not value > 0.0:
        raise ValueError(f"{key} = {text}. It must be greater than 0.")
    if value is not None and unit == "m" and not SHORTEST <= value <= LONGEST:
        raise ValueError(
            f"{key} = {text}. Ships have {SHORTEST:g} to {LONGEST:g} m; is the unit right?"
        )
    return value


def ship_text(answers: Answers) -> str:
    """Text of a ship file.

    Parameters
    ----------
    answers : Answers
        Main dimensions are required.

    Returns
    -------
    str

    Raises
    ------
    ShipcosimError
        With everything that is missing.
    """
    # Dimensions have no usual value without each other.
    missing = [key for key in ("length", "breadth", "draught") if not getattr(answers, key)]
    if missing:
        raise error_at(
            "new ship",
            f"nothing says {', '.join(missing)}.",
            'Give --length "60 m" and so on, or --from with a ship file.',
        )
    # Given thrusters, else usual ones for the layout; and her hull, for the estimates.
    try:
        weight = answers.displacement or usual(answers, "displacement")
        speed = answers.speed or usual(answers, "speed")
        form = _form(replace(answers, displacement=weight, speed=speed))
        given = {thruster.get("name"): thruster for thruster in answers.thrusters}
        usual_ones = [] if given and not answers.layout else _thrusters(answers)
        thrusters = [*({thruster["name"]: thruster for thruster in usual_ones} | given).values()]
    except ValueError as error:
        raise error_at("new ship", f"{error}") from None
    shown = "\n\n".join(
        "[[thrusters]]\n" + "\n".join(_line(k, v) for k, v in thruster.items())
        for thruster in thrusters
    )
    # Numbers that are estimated stand in comments, ready to be replaced.
    estimates = {
        "mass": weight,
        "gyradius": _m(sqrt(float(inertia_yaw(1.0, form.length, form.breadth, 0.0).value))),
        "trial": speed,
        "resistance": f"{_round(resistance(form) / 1000.0)} kN",
        "front": f"{_round(float(front_area(form.breadth).value))} m2",
        "side": f"{_round(float(side_area(form.length).value))} m2",
    }
    quoted = {name: f"{_quoted(value):<12}" for name, value in estimates.items()}
    return _TEXT.format(
        **quoted,
        cross_flow=f"{float(cross_flow_drag(form).value):<12.3g}",
        description=_quoted(answers.description),
        length=_line("length", answers.length),
        breadth=_line("breadth", answers.breadth),
        draught=_line("draught", answers.draught),
        weight=_line("displacement", weight),
        speed=_line("service_speed", speed),
        kind=_quoted(answers.kind),
        thrusters=shown,
    )


def thruster_from(text: str) -> dict[str, str]:
    """Keys of a thruster from ``"name=port, kind=azimuth, x=-27 m"``.

    Raises
    ------
    ShipcosimError
        If it is written otherwise.

    Examples
    --------
    >>> thruster_from("name=bow, kind=tunnel, x=25 m")
    {'name': 'bow', 'kind': 'tunnel', 'x': '25 m'}
    """
    parts = [part.partition("=") for part in text.split(",") if part.strip()]
    if not parts or not all(sign and key.strip() and value.strip() for key, sign, value in parts):
        raise error_at(
            "--thruster",
            f"found {text!r}.",
            'Write --thruster "name=bow, kind=tunnel, x=25 m, diameter=1.7 m, power=500 kW".',
        )
    return {key.strip(): value.strip() for key, _, value in parts}


def _thrusters(answers: Answers) -> list[dict[str, str]]:
    """Usual thrusters for a ship of this size."""
    layout = answers.layout or USUAL_LAYOUT
    if layout not in LAYOUTS:
        raise ValueError(f"propulsion is {layout!r}. {suggestion(layout, LAYOUTS)}")
    # Places and diameters in proportion to the dimensions.
    L, B, T = (number_in(getattr(answers, key), "m") for key in ("length", "breadth", "draught"))
    power = _given(answers, "power", "W") or number_in(usual(answers, "power"), "W")
    power /= 1000.0  # kW
    kind = Usual if isinstance(answers.power or Usual(), Usual) else str
    aft = _m(-0.45 * L)
    side = 0.25 * B
    wheel = _m(0.55 * T)
    # Bow thruster with a third of the propulsion power.
    bow = {"kind": "tunnel", "x": _m(0.4 * L), "diameter": _m(0.35 * T), "power": _kW(0.35 * power)}
    if layout == "rudder":
        place = {"name": "propeller", "kind": "rudder", "x": aft, "y": "0 m"}
        return [place | {"diameter": _m(0.65 * T), "power": kind(_kW(power))}]
    # Two equal propellers share the power.
    half = {"x": aft, "diameter": wheel, "power": kind(_kW(0.5 * power))}
    pair = {"port": _m(-side), "starboard": _m(side)}
    if layout == "screws":
        stern = bow | {"x": _m(-0.4 * L)}
        screws = [{"name": n, "kind": "fixed", "y": y} | half for n, y in pair.items()]
        return [*screws, {"name": "bow"} | bow, {"name": "stern"} | stern]
    azimuths = [
        {"name": n, "kind": "azimuth", "y": y} | half | {"ducted": "true"} for n, y in pair.items()
    ]
    return [*azimuths, {"name": "bow"} | bow]


def _m(value: float) -> str:
    return Usual(f"{value + 0.0:.3g} m")


def _kW(value: float) -> str:
    return Usual(f"{_round(max(value, 1e-3))} kW")


def _round(value: float) -> str:
    """Three significant digits, without trailing zeros."""
    return f"{float(f'{value:.3g}'):g}"


def _line(key: str, value: str) -> str:
    if isinstance(value, Usual):
        return f'{key} = {{ value = {_quoted(value)}, origin = "{ASSUMED}" }}'
    plain = value in ("true", "false") or value.replace(".", "", 1).removeprefix("-").isdigit()
    return f"{key} = {value if plain else _quoted(value)}"


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ") + '"'


_TEXT = """\
# A ship in her own words. Numbers are in SI, or texts with a unit: "28.9 m", "12 kn", "2650 t". Where one comes from
# and how well it is known: {{ value = "2650 t", tolerance = "50 t", origin = "stability booklet" }}. What is not said
# is estimated by formulae: `shipcosim check` says what. All keys: docs/your-own-ship.md.

description = {description}
source = "given to `shipcosim new ship`"       # of every number that does not say its own origin

[particulars]                                  # x forward of midships, y to starboard
{length}
{breadth}
{draught}
{weight}
{speed}

[mass]
# mass = {mass}                          # if it is not the displacement
# yaw_gyradius = {gyradius}                  # estimated: a quarter of the length

[resistance]
# speed = {trial}                         # one point of the speed trial; estimated: Holtrop and Mennen
# resistance = {resistance}                    # at that speed

[drag]
# cross_flow = {cross_flow}                    # estimated: Hoerner's curve

[wind]
kind = {kind}
# front_area = {front}                    # estimated from the breadth
# side_area = {side}                     # estimated from the length

{thrusters}
"""
