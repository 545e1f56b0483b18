"""How the form of a ship's loads may differ from her model's: functions around it, each a handful of numbers.

Drag along the hull, the wind load over the angle, and the thrust that the hull takes are the model's times one plus a
few smooth functions, with numbers of their own here. Damping over speed, added mass and a tunnel's thrust under way are
numbers that the model has, less well known than their tolerances say. The sizes here are those of scale 1; how far the
form of one ship differs is learnt.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, make_dataclass
from functools import cached_property
from typing import Any

import numpy as np

from shipcosim.models.core.constants import GRAVITY
from shipcosim.models.core.maths import Arithmetic, cos, sin
from shipcosim.models.core.motion import Load
from shipcosim.models.core.parameters import quantity
from shipcosim.models.propulsion.tunnel import TunnelParameters
from shipcosim.models.ship.hull import HullParameters

_NEUTRAL = "neutral"
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(12)  # along the hull, over half its length
_DEGREES = (1, 2, 3)
_SHAPES = np.polynomial.legendre.legvander(_PLACES, max(_DEGREES))
_HARMONICS = (0, 1, 2)
FROUDE_UNDER_WAY = 0.25


def _along(degree: int) -> float:
    means = f"cross-flow drag along the hull: share of the Legendre polynomial of degree {degree}, 1 at the bow"
    return quantity(0.0, "1", means, _NEUTRAL)


@dataclass(frozen=True, kw_only=True)
class _LoadDeviation:
    @cached_property
    def acts(self) -> bool:
        """Whether any of it is not neutral."""
        return any(np.any(getattr(self, item.name)) for item in fields(self))


@dataclass(frozen=True, kw_only=True)
class HullForm(_LoadDeviation):
    """Drag along the hull, over the model's."""

    cross_flow_1: float = _along(1)
    cross_flow_2: float = _along(2)
    cross_flow_3: float = _along(3)


def _harmonics() -> list[tuple[str, int, str]]:
    """Name, order and function of each harmonic of the wind's angle."""
    return [
        (f"{f}_{k}" if k else "mean", k, f)
        for k in _HARMONICS
        for f in ("cos", "sin")
        if k or f == "cos"
    ]


def _round(axis: str, name: str) -> tuple[str, type, float]:
    means = f"wind load {axis} over the angle that it comes from: share of the harmonic {name}"
    return f"{axis}_{name}", float, quantity(0.0, "1", means, _NEUTRAL)


WindForm = make_dataclass(
    "WindForm",
    [_round(axis, name) for axis in "XYN" for name, *_ in _harmonics()],
    bases=(_LoadDeviation,),
    frozen=True,
    kw_only=True,
)
"""Wind load over the angle, over the model's, for each of X, Y and N."""


def _lost(where: str) -> float:
    return quantity(0.0, "1", f"share of the thrust lost at the hull {where}", _NEUTRAL)


@dataclass(frozen=True, kw_only=True)
class ThrusterForm(_LoadDeviation):
    """Thrust that a thruster loses at the hull beyond the model's, by where it pushes to, whoever made it."""

    across: float = _lost("by one that pushes athwartships; proportional to the squared sine")
    to_starboard: float = _lost(
        "by one that pushes to starboard, gained to port; proportional to the sine"
    )
    astern: float = _lost("by one that pushes astern; none ahead, half of it athwartships")
    under_way: float = _lost(f"at Froude number {FROUDE_UNDER_WAY}; proportional to the speed")


def form_of(thruster: str) -> str:
    """Place of the numbers of a thruster's form."""
    return f"{thruster}.form"


ALONG = {
    1: 0.15,
    2: 0.15,
    3: 0.10,
}  # of the drag coefficient, by degree; assumed: sections of ships differ by +-30 %
CROSS_FLOW_LEVEL = 0.09  # of all sections together: the mean of five independent ones of +-30 %
LEVEL = 0.12  # of resistance and of other damping as a whole; assumed
ROUND = {
    0: 0.05,
    1: 0.05,
    2: 0.045,
}  # of the wind load, by order; Blendermann 1994: +-15 % between similar ships
WIND_LEVEL = 0.05  # of X, Y and N alike
ADDED_MASS = 0.15  # water that remembers is, in slow motion, an added mass; assumed
LIFT = 0.2  # of its size and of its arm; assumed
LINEAR = 0.2  # linear damping over the quadratic one at these speeds; assumed
FROUDE_AHEAD = 0.06
FROUDE_ACROSS = 0.018
LOST = {
    "across": 0.06,
    "to_starboard": 0.03,
    "astern": 0.05,
}  # of a unit that turns; Dang and Laheij 2004: to 10 %
DEDUCTION = 0.03  # of the thrust of any thruster but a tunnel's, whatever its direction: thrust deduction; assumed
UNDER_WAY = 0.1  # of the thrust, at FROUDE_UNDER_WAY: wake and thrust deduction; assumed
SPEED_LOSS = 0.1  # s2/m2 on a ship of 33.9 m, of a tunnel's thrust; half of (1/2.2)^2
_OF_LENGTH = 33.9


def form_sizes(
    parts: Mapping[str, Any], vessel: str, drives: Mapping[str, tuple[str, ...]]
) -> dict[str, float]:
    """How far each number of a ship's form may be off, of scale 1.

    Parameters
    ----------
    parts : mapping of str to dataclass
        Parameter sets of the ship by place.
    vessel : str
        Name of the ship's component.
    drives : mapping of str to tuple of str
        What a log should have of each thruster.

    Returns
    -------
    dict of str to float
        Standard deviation by ``place.name``, in the number's unit.
    """
    # Cross-flow drag along the hull and wind load over the angle.
    hull = parts["hull"]
    sizes = {f"hull_form.cross_flow_{degree}": size for degree, size in ALONG.items()}
    sizes |= {
        f"wind_form.{axis}_{name}": ROUND[order]
        for axis in "XYN"
        for name, order, _ in _harmonics()
    }
    # Coefficients of the hull, and the level of the wind load.
    sizes |= {f"{vessel}.{name}": size for name, size in _hull_sizes(hull).items() if size > 0.0}
    sizes[f"{vessel}.wind_load_scale"] = WIND_LEVEL
    # Tunnel thrusters lose thrust with speed; others by
    # thrust deduction, and by direction if they turn.
    for name in drives:
        if isinstance(parts[name], TunnelParameters):
            sizes[f"{name}.speed_loss"] = SPEED_LOSS * _OF_LENGTH / hull.length
            continue
        sizes[f"{name}.thrust_loss"] = DEDUCTION
        lost = LOST if "azimuth" in drives[name] else {}
        sizes |= {
            f"{form_of(name)}.{where}": size
            for where, size in (lost | {"under_way": UNDER_WAY}).items()
        }
    return sizes


def form_functions(
    parts: Mapping[str, Any], vessel: str, drives: Mapping[str, tuple[str, ...]]
) -> dict[str, dict[str, float]]:
    """Functions of a ship's form in words, each with its numbers and how much one adds to its mean square.

    Parameters
    ----------
    parts, vessel, drives
        As for `form_sizes`.

    Returns
    -------
    dict of str to dict of str to float
        By function and ``place.name``: mean over the hull or round the circle of the squared share of the model's
        function that the number makes, over the squared number. [1 over the number's unit squared]
    """
    # Mean square of a Legendre polynomial of degree k is 1 / (2 k + 1).
    level = abs(parts["hull"].cross_flow_drag)
    hull = f"{vessel}."
    functions = {
        "drag across the hull, along her length": {
            f"hull_form.cross_flow_{k}": 1 / (2 * k + 1) for k in _DEGREES
        }
    }
    if level:
        functions["drag across the hull, along her length"] |= {
            f"{hull}cross_flow_drag": 1.0 / level**2
        }
    # The mean square of a harmonic is 1/2, of a constant 1; a third for each of X, Y and N.
    functions["wind load over the angle"] = {f"{hull}wind_load_scale": 1.0} | {
        f"wind_form.{axis}_{name}": (0.5 if order else 1.0) / 3.0
        for axis in "XYN"
        for name, order, _ in _harmonics()
    }
    # Mean squares of the loss functions over all directions of the thrust.
    for name in drives:
        if "azimuth" in drives[name]:
            mean = {"across": 3 / 8, "to_starboard": 1 / 2, "astern": 3 / 8}
            of_form = {f"{form_of(name)}.{where}": share for where, share in mean.items()}
            functions[f"thrust of {name}, over its direction"] = {
                f"{name}.thrust_loss": 1.0
            } | of_form
    return functions


def _hull_sizes(hull: HullParameters) -> dict[str, float]:
    """Standard deviations of the hull's numbers: coefficients by a share of their size, linear damping by the quadratic
    one."""
    # Added mass, lift and damping coefficients: a share of their size.
    stds = {
        name: ADDED_MASS * abs(getattr(hull, name)) for name in ("A11", "A22", "A26", "A62", "A66")
    }
    stds |= {name: LIFT * abs(getattr(hull, name)) for name in ("lift", "lift_x")}
    coefficients = [item.name for item in fields(hull) if item.name[:2] in ("X_", "Y_", "N_")]
    stds |= {name: LEVEL * abs(getattr(hull, name)) for name in coefficients}
    stds["cross_flow_drag"] = CROSS_FLOW_LEVEL * abs(hull.cross_flow_drag)
    # Linear damping is compared with the quadratic one at usual speeds, which follow Froude's law.
    speed, side = (
        froude * np.sqrt(GRAVITY * hull.length) for froude in (FROUDE_AHEAD, FROUDE_ACROSS)
    )
    half = 0.5 * hull.length
    strength = _strength(hull)
    # Quadratic damping at this speed, as linear damping: in
    # surge by its coefficient, in sway and yaw by strips.
    stds["X_u"] += LINEAR * speed * abs(hull.X_uu)
    stds["Y_v"] += LINEAR * side * strength * hull.length
    stds["N_r"] += LINEAR * side / half * strength * half**4 / 2.0
    return {name: float(size) for name, size in stds.items()}


def _strength(hull: HullParameters) -> Arithmetic:
    """Half of density, draught and drag coefficient of the sections; of 1, where the hull has no such drag. [kg/m2]"""
    if "cross_flow" in hull.contributions:
        half, k = hull.strips
        return k / half
    of_sway = abs(hull.quadratic[1])
    return of_sway / hull.length if np.any(of_sway) else 0.5 * hull.water_density * hull.draught


def cross_flow_form(v_r: Arithmetic, r: Arithmetic, hull: HullParameters, form: HullForm) -> Load:
    """What cross flow loads more than the model has, by Gauss' quadrature over the hull.

    Parameters
    ----------
    v_r, r : (...) array
        Sway velocity through the water and yaw rate. [m/s, rad/s]
    hull : HullParameters
    form : HullForm

    Returns
    -------
    tuple of three, like v_r
        X, Y, N. [N, N, N.m]
    """
    # Strips at the Gauss points over half the length; the weights add up to 2.
    half = 0.5 * hull.length
    Y = 0.0 * v_r
    N = 0.0 * v_r
    strength = _strength(hull) * half
    for place, weight, shapes in zip(_PLACES, _WEIGHTS, _SHAPES, strict=True):
        # Relative change of the drag coefficient of the strip, and its cross flow v + x r.
        share = sum(getattr(form, f"cross_flow_{k}") * shapes[k] for k in _DEGREES)
        flow = v_r + place * half * r
        load = -strength * weight * share * abs(flow) * flow
        Y = Y + load
        N = N + place * half * load
    return 0.0 * v_r, Y, N


def wind_factors(wind_from: Arithmetic, form: object) -> Load:
    """Factors on the model's wind load, by the angle that the wind comes from.

    Parameters
    ----------
    wind_from : (...) array
        From the bow. [rad]
    form : WindForm

    Returns
    -------
    tuple of three, like wind_from
        On X, Y and N. [1]
    """
    factors = []
    # Factor 1 plus a Fourier series in the wind angle, for each axis.
    for axis in "XYN":
        factor = 1.0 + 0.0 * wind_from
        for name, order, function in _harmonics():
            share = getattr(form, f"{axis}_{name}")
            if np.any(share):
                factor = factor + share * (cos if function == "cos" else sin)(order * wind_from)
        factors.append(factor)
    return tuple(factors)


def thrust_kept(
    rpm: Arithmetic, azimuth: Arithmetic, u_r: Arithmetic, length: float, form: ThrusterForm
) -> Arithmetic:
    """Factor on the model's load of a thruster, by where it pushes to and how fast the ship goes.

    Parameters
    ----------
    rpm, azimuth : (...) array
        Of the thruster; of the first only the sign counts, as one that runs astern pushes the other way. [-, rad]
    u_r : (...) array
        Surge velocity through the water. [m/s]
    length : float
        Of the ship. [m]
    form : ThrusterForm

    Returns
    -------
    like u_r
        [1]
    """
    # Direction in which the thruster pushes, with the sign of its speed.
    way = np.sign(rpm)
    ahead = way * cos(azimuth)
    starboard = way * sin(azimuth)
    lost = (
        form.across * starboard * starboard
        + form.to_starboard * starboard
        + 0.5 * form.astern * (1.0 - ahead)
    )
    # Loss under way in proportion to the speed, relative to a fixed Froude number.
    fast = FROUDE_UNDER_WAY * np.sqrt(GRAVITY * length)
    return 1.0 - lost - form.under_way * abs(u_r) / fast
